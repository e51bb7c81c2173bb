//! Parameter studies of inflatable capsules: one JSON study file becomes jobs, every job leaves one
//! history file and one table row.
//!
//! ```text
//! study file → Study → generation of Jobs → Scene → Deployment → history file + row → table
//!                ↑______ next_jobs(study, finished rows) ______|
//! ```
//!
//! **Reading order.** `study_file` (what the JSON says), `study` (what it means), `plan`
//! (which jobs), `runner` (running them), `history_file` and `table` (what is left).

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
