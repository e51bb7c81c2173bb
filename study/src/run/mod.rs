//! Runs jobs in parallel: the runner, its events, the progress display.

pub mod event;
#[cfg(test)]
pub(crate) mod fixture;
pub mod progress;
pub mod reservation;
pub mod runner;
