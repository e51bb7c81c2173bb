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

pub mod answer;
pub mod bench;
pub mod cases;
pub mod chart;
pub mod cli;
pub mod compare;
pub mod doctor;
pub mod error;
pub mod event;
pub mod executor;
pub mod expression;
pub mod files;
#[cfg(test)]
mod fixture;
pub mod history_file;
pub mod job;
pub mod journal;
pub mod keys;
pub mod plan;
pub mod point;
pub mod progress;
pub mod provenance;
pub mod reference_file;
pub mod references;
pub mod render;
pub mod results;
pub mod row;
pub mod runner;
pub mod scene_file;
pub mod schema;
mod settings;
pub mod solve;
mod source;
pub mod statistics;
pub mod stop;
pub mod stored;
pub mod study;
pub mod study_file;
pub mod summary;
pub mod table;
pub mod units;
pub mod value;
