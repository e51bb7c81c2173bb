//! What a run gives back: its history and measures, and how it ended.

use super::audit::Audit;
use super::frames::Frames;
use super::history::{History, Track};
use super::measures::Measures;

/// The result of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Deployment {
    /// Time series, up to the end or to the moment the run stopped.
    pub history: History,
    /// What was followed beside it.
    pub tracks: Vec<Track>,
    /// Shapes kept; none of a model without a shape, or where none were asked for.
    pub frames: Option<Frames>,
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

impl Deployment {
    /// The series of that name among what was followed; empty where it was not.
    pub fn followed(&self, name: &str) -> &[f64] {
        let own = self.tracks.iter().find(|track| track.name == name);
        own.map_or(&[], |track| track.values.as_slice())
    }
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
    EnergyDrift,
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
        Self::EnergyDrift,
        Self::InvertedVolume,
        Self::StepLimit,
        Self::Interpenetrated,
    ];

    /// Name, as in the table's `status` column.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unstable => "unstable",
            Self::EnergyDrift => "energy_drift",
            Self::InvertedVolume => "inverted_volume",
            Self::StepLimit => "step_limit",
            Self::Interpenetrated => "interpenetrated",
        }
    }
}
