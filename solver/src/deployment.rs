//! What a run gives back, whatever model computed it.

use crate::audit::Audit;
use crate::history::History;
use crate::measures::Measures;

/// The result of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Deployment {
    /// Time series, up to the end or to the moment the run stopped.
    pub history: History,
    /// What the history says, in single numbers.
    pub measures: Measures,
    /// What the history is worth.
    pub audit: Audit,
    /// How the run ended.
    pub stop: Stop,
    /// Accepted steps.
    pub steps: u64,
    /// Elements of the mesh (0 for a model without one).
    pub elements: usize,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Stop {
    /// Reached its end time.
    Done,
    /// The observer asked for an end; nothing of it is a result.
    Cancelled,
    /// Stopped short: a typed outcome, stored as such.
    Failed(Failure),
}

/// Why, when and where a run stopped short.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// Kind.
    pub kind: FailureKind,
    /// Simulated time, s.
    pub time: f64,
    /// Where: an element, a node, or the part of the model, in words.
    pub place: String,
}

/// The kinds of failure a run can end in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FailureKind {
    /// State no longer finite, or growing without bound.
    Unstable,
    /// The energy ledger left its bound.
    Drifted,
    /// The enclosed volume fell to zero or below.
    InvertedVolume,
    /// More steps than allowed, or a step too small to advance time.
    StepLimit,
    /// Film went through film.
    Interpenetrated,
}

impl FailureKind {
    /// Every kind, in the order of the documentation.
    pub const ALL: [Self; 5] = [
        Self::Unstable,
        Self::Drifted,
        Self::InvertedVolume,
        Self::StepLimit,
        Self::Interpenetrated,
    ];

    /// Name, as in the table's `status` column.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unstable => "unstable",
            Self::Drifted => "drifted",
            Self::InvertedVolume => "inverted_volume",
            Self::StepLimit => "step_limit",
            Self::Interpenetrated => "interpenetrated",
        }
    }
}

/// Watches a run. It can see and stop it; it can never change it.
pub trait Observer {
    /// Called at every sample. Returning `false` ends the run with [`Stop::Cancelled`].
    fn sample(&mut self, progress: Progress) -> bool;
}

/// Where a run stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Simulated time, s.
    pub time: f64,
    /// Simulated time at the end, s.
    pub end_time: f64,
    /// Height of the top centre, m.
    pub z_centre: f64,
    /// Gas pressure, Pa.
    pub pressure: f64,
}

/// Sees nothing, stops nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn sample(&mut self, _: Progress) -> bool {
        true
    }
}
