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

pub mod cli;
pub mod error;
pub mod job;
pub mod plan;
pub mod study;
pub mod units;
pub mod value;
