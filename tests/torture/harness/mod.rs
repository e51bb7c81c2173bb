//! What all kinds of trial share: options, random numbers, the program, folders, checks, the table.

pub mod check;
pub mod journal;
pub mod options;
pub mod place;
pub mod program;
pub mod random;
pub mod runner;
pub mod studies;
pub mod tally;
pub mod trial;
