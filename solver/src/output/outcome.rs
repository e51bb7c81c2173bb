//! The result of a run: its history and measures, and how it ended.

use super::audit::Audit;
pub use super::audit_kind::AuditKind;
use super::events::Event;
pub use super::failure_kind::FailureKind;
use super::frames::Frames;
use super::history::{History, Track};
use super::measures::{self, Measures, Reference};
use crate::scene::timeline::Timeline;

/// The result of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Deployment {
    /// Time series, up to the end or to the moment the run stopped.
    pub history: History,
    /// Further time series: followed nodes and elements, contact, plates.
    pub tracks: Vec<Track>,
    /// Decisions of the step controller, in order of time.
    pub events: Vec<Event>,
    /// Stored shapes of the film; `None` for a model without a mesh, or if the scene asks for none.
    pub frames: Option<Frames>,
    /// Measures: single numbers computed from the history.
    pub measures: Measures,
    /// Audit: how far the history can be trusted.
    pub audit: Audit,
    /// How the run ended.
    pub stop: Stop,
    /// Accepted steps.
    pub steps: u64,
    /// Elements of the mesh; 0 for a model without a mesh.
    pub elements: usize,
}

impl Deployment {
    /// A run that was ended before its first sample.
    pub fn cancelled() -> Self {
        Self {
            history: History::new(),
            tracks: Vec::new(),
            events: Vec::new(),
            frames: None,
            measures: Measures::default(),
            audit: Audit::default(),
            stop: Stop::Cancelled,
            steps: 0,
            elements: 0,
        }
    }

    /// The values of the track of that name; empty if there is none.
    pub fn followed(&self, name: &str) -> &[f64] {
        let track = self.tracks.iter().find(|track| track.name == name);
        track.map_or(&[], |track| track.values.as_slice())
    }

    /// Compares the run with the static equilibria of its design: adds the measures that need them.
    pub fn judge(&mut self, reference: &Reference, timeline: &Timeline) {
        let film_stress = self.measures.film_stress.unwrap_or(0.0);
        let done = self.stop == Stop::Done;
        self.measures =
            measures::measure(&self.history, Some(reference), timeline, film_stress, done);
    }
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Stop {
    /// The run reached its end time.
    Done,
    /// The observer ended the run; nothing of it is a result.
    Cancelled,
    /// The run stopped early for this reason. The job stores it as its status.
    Failed(Failure),
}

/// Why, when and where a run stopped early.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// Kind.
    pub kind: FailureKind,
    /// The audit that ended the run.
    pub audit: AuditKind,
    /// Simulated time, s.
    pub time: f64,
    /// Where: a node, an element or a part of the model, in words.
    pub place: String,
}

impl Failure {
    /// What an audit found at this time (s) and place. The kind is that of the audit.
    pub fn new(audit: AuditKind, time: f64, place: impl Into<String>) -> Self {
        Self { kind: audit.failure_kind(), audit, time, place: place.into() }
    }
}
