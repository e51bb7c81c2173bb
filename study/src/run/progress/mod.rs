//! The progress of a run on stderr: bars on a terminal, plain lines elsewhere, nothing when quiet.

use std::io::{self, IsTerminal};

use indicatif::ProgressDrawTarget;

use crate::run::event::{Event, Reporter, Silent};

mod bars;
mod lines;

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

/// The reporter for this stderr.
pub fn reporter(loudness: Loudness) -> Box<dyn Reporter> {
    if loudness == Loudness::Quiet {
        return Box::new(Silent);
    }
    let verbose = loudness == Loudness::Verbose;
    if io::stderr().is_terminal() {
        let colour = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
        Box::new(Bars::new(ProgressDrawTarget::stderr(), colour, verbose))
    } else {
        Box::new(Lines::new(io::stderr(), verbose))
    }
}

/// Numbers of jobs so far.
#[derive(Debug, Clone, Copy, Default)]
struct JobCounts {
    jobs: usize,
    finished: usize,
    failed: usize,
}

impl JobCounts {
    fn add(&mut self, event: &Event) {
        match event {
            Event::GenerationStarted { jobs, finished, .. } => {
                self.jobs += jobs;
                self.finished += finished;
            }
            Event::JobFinished { status, .. } => {
                self.finished += 1;
                self.failed += usize::from(status.is_failure());
            }
            Event::JobStarted { .. } | Event::JobSample { .. } | Event::Note(_) | Event::Ended => {}
        }
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
