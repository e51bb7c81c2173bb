//! Events of a run: what its step controller decided, and when.

use serde::{Deserialize, Serialize};

/// A decision of the step controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// The film hardly moves from here on: longer steps.
    Quiescent,
    /// The film moves or touches again: the usual steps.
    Active,
    /// The implicit integrator takes over.
    Implicit,
    /// The explicit integrator takes over.
    Explicit,
}

impl EventKind {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Quiescent, Self::Active, Self::Implicit, Self::Explicit];

    /// Name, as in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quiescent => "quiescent",
            Self::Active => "active",
            Self::Implicit => "implicit",
            Self::Explicit => "explicit",
        }
    }

    /// Meaning, one line.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Quiescent => "the film hardly moves: longer steps from here on",
            Self::Active => "the film moves or touches again: the usual steps from here on",
            Self::Implicit => "the film moves little: implicit steps from here on",
            Self::Explicit => "the film moves: explicit steps from here on",
        }
    }
}

/// A decision and its time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Time, s.
    pub time: f64,
    /// What was decided.
    pub kind: EventKind,
}
