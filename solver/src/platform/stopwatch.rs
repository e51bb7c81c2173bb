//! The stages of a step, and an interface to time them.
//!
//! The solver reads no clock. It reports which stage begins; a [`Stopwatch`] that owns a clock measures
//! the time. No result depends on it.

/// A stage of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Strains, stresses, membrane forces on the nodes, and ∂V/∂x.
    Membrane,
    /// Volume, pressure, and the gas balance.
    Gas,
    /// Broad phase: finds the candidate pairs of contact.
    Search,
    /// Distances of candidate pairs, contact forces, and collision impulses.
    Pairs,
    /// Velocities, positions, and works.
    Update,
    /// Tunnelling monitor: whether film passed through film.
    Audit,
}

impl Stage {
    /// Every stage, in the order of a table.
    pub const ALL: [Self; 6] =
        [Self::Membrane, Self::Gas, Self::Update, Self::Search, Self::Pairs, Self::Audit];

    /// Name, as in tables and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Membrane => "membrane",
            Self::Gas => "gas",
            Self::Search => "search",
            Self::Pairs => "pairs",
            Self::Update => "update",
            Self::Audit => "audit",
        }
    }
}

/// Receives the stages of a step in order.
pub trait Stopwatch {
    /// A stage begins; the previous one has ended.
    fn begins(&mut self, stage: Stage);
}

/// Measures nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Untimed;

impl Stopwatch for Untimed {
    fn begins(&mut self, _: Stage) {}
}
