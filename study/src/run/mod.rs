//! Runs jobs in parallel: which jobs, a folder for one process, the runner, its events, the progress display, the merge of
//! what several runs stored.

pub mod event;
pub mod exclusive;
#[cfg(test)]
pub(crate) mod fixture;
pub mod merge;
pub mod progress;
pub mod reservation;
pub mod runner;
pub mod selection;
