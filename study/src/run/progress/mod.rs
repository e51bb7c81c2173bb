//! The progress of a run on stderr: bars on a terminal, plain lines elsewhere, nothing when quiet.

use std::io::{self, IsTerminal};
use std::num::NonZero;

use indicatif::ProgressDrawTarget;

use crate::run::event::{Event, Reporter, Silent};

mod bars;
mod lines;
mod work;

use bars::Bars;
use lines::Lines;

/// How much a command prints on stderr.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loudness {
    /// Errors only.
    Quiet,
    /// The progress of the study.
    Normal,
    /// Also every job as it ends.
    Verbose,
}

/// The reporter for this stderr, of a run with this number of threads; `None` for one per core.
pub fn reporter(loudness: Loudness, threads: Option<NonZero<usize>>) -> Box<dyn Reporter> {
    if loudness == Loudness::Quiet {
        return Box::new(Silent);
    }
    let verbose = loudness == Loudness::Verbose;
    if io::stderr().is_terminal() {
        let colour = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
        Box::new(Bars::new(ProgressDrawTarget::stderr(), colour, verbose, threads))
    } else {
        Box::new(Lines::new(io::stderr(), verbose, threads))
    }
}

/// The line of a job that ended: id, status, verdict.
fn finished_line(event: &Event) -> Option<String> {
    let Event::JobFinished { id, status, verdict, .. } = event else { return None };
    let verdict = verdict.as_ref().map(|verdict| format!(", {verdict}")).unwrap_or_default();
    Some(format!("{} {status}{verdict}", id.short()))
}

#[cfg(test)]
mod tests;
