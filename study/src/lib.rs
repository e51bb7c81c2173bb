//! Parameter studies of inflatable capsules. One JSON study file becomes jobs; every job gives one
//! history file and one table row.
//!
//! ```text
//! study file → Study → generation of Jobs → Scene → Deployment → history file + row → table
//!                ↑______ next_jobs(study, finished rows) ______|
//! ```
//!
//! **Reading order.** [`input::study_file`] (the JSON), [`study`] (its meaning), [`study::plan`] (the
//! jobs), [`run::runner`] (running them), [`store::history_file`] and [`store::table`] (what is stored).

pub mod analysis;
pub mod bench;
pub mod cases;
pub mod chart;
pub mod cli;
pub mod input;
pub mod job;
pub mod platform;
pub mod render;
pub mod run;
pub mod scene;
pub mod store;
pub mod study;
