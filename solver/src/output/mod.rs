//! The outputs of a run: history, frames, measures, energy ledger, audit, events, checkpoint.

pub mod audit;
pub mod checkpoint;
pub mod events;
pub mod frames;
pub mod history;
pub mod ledger;
pub mod measures;
pub mod outcome;
