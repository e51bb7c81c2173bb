//! Repeats what happens to a program in use, many times: kills, signals, full disks, changed files,
//! little memory, closed streams, mutated input. It drives the program `billow` from outside, checks
//! that nothing is lost and nothing is silently wrong, and prints one table.
//!
//! ```text
//! make torture
//! cargo test --release --locked -p billow-study --test torture -- --only kill9,signals --trials 0.1
//! ```
//!
//! Every trial follows from the seed, its kind and its number. The folder of a bad trial is kept.
//! Exit code 1 if a trial is bad, 2 for a wrong option.

#![allow(clippy::disallowed_methods, reason = "the trials read and damage files directly")]

mod harness;
mod kinds;

use std::process::ExitCode;

use clap::Parser;
use harness::options::Options;

fn main() -> ExitCode {
    match harness::runner::run(&Options::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(problem) => {
            eprintln!("torture: {problem}");
            ExitCode::from(2)
        }
    }
}
