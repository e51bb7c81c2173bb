//! What a trial found, and what a kind of trial is.

use std::time::Duration;

use super::place::Place;
use super::random::Random;

/// What must not happen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// A finished job, or the use of the results folder, is lost.
    Lost,
    /// A finished job ran again without a reason.
    RunTwice,
    /// A wrong number was printed, or damage was called sound.
    SilentlyWrong,
    /// The final table or a history has other bits than without the trial.
    OtherBits,
    /// A panic, or an end by a signal without a message.
    Abort,
    /// A command took longer than the limit of its kind.
    Slow,
    /// A message without path or next step, a wrong exit code, an advice that does not help.
    WrongMessage,
}

impl Fault {
    /// Every fault, in the order of the columns.
    pub const ALL: [Self; 7] = [
        Self::Lost,
        Self::RunTwice,
        Self::SilentlyWrong,
        Self::OtherBits,
        Self::Abort,
        Self::Slow,
        Self::WrongMessage,
    ];

    /// Head of the column.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lost => "lost",
            Self::RunTwice => "run twice",
            Self::SilentlyWrong => "silently wrong",
            Self::OtherBits => "other bits",
            Self::Abort => "panic or abort",
            Self::Slow => "slow",
            Self::WrongMessage => "wrong message",
        }
    }
}

/// What one trial found.
#[derive(Debug, Default)]
pub struct Trial {
    /// What was done, to name the trial.
    pub what: String,
    /// Faults with a sentence each.
    pub faults: Vec<(Fault, String)>,
    /// The program reported the damage or the end; otherwise it was not disturbed.
    pub detected: bool,
    /// Why the trial was not made.
    pub skipped: Option<String>,
    /// Events to count, by name.
    pub counts: Vec<(&'static str, usize)>,
    /// The longest time that the kind measures.
    pub longest: Duration,
}

impl Trial {
    /// A trial of that name.
    pub fn new(what: impl Into<String>) -> Self {
        Self { what: what.into(), ..Self::default() }
    }

    /// Adds a fault.
    pub fn fault(&mut self, fault: Fault, text: impl Into<String>) {
        self.faults.push((fault, text.into()));
    }

    /// Counts an event.
    pub fn count(&mut self, name: &'static str, number: usize) {
        self.counts.push((name, number));
    }

    /// Takes note of a measured time.
    pub fn time(&mut self, time: Duration) {
        self.longest = self.longest.max(time);
    }
}

/// A kind of trial, prepared.
pub trait Kind: Sync {
    /// Number of trials of the whole kind.
    fn trials(&self) -> usize;

    /// Limit of a command, for the table; measured times are [`Trial::longest`].
    fn limit(&self) -> Duration;

    /// Makes one trial in an empty folder.
    fn trial(&self, number: usize, random: &mut Random, place: &Place) -> Trial;

    /// Whether trials may run at the same time.
    fn parallel(&self) -> bool {
        true
    }

    /// What the table says about the kind.
    fn note(&self) -> String {
        String::new()
    }
}
