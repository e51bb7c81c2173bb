//! What a step is made of, for whoever measures what each part costs.
//!
//! The solver reads no clock: it says which stage begins, and a [`Stopwatch`] that has a clock does
//! the rest. Nothing it does reaches a result.

/// A stage of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Strains, stresses, forces of the film on its nodes, oriented areas.
    Membrane,
    /// Volume to pressure, the gas and its books.
    Gas,
    /// Which pairs of film have come near.
    Search,
    /// Distances of near pairs, contacts and their forces, what keeps them apart.
    Pairs,
    /// Velocities, places, works.
    Update,
    /// Whether film went through film.
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

/// Told what a step does next.
pub trait Stopwatch {
    /// A stage begins; the one before has ended.
    fn begins(&mut self, stage: Stage);
}

/// Looks at no clock.
#[derive(Debug, Clone, Copy, Default)]
pub struct Untimed;

impl Stopwatch for Untimed {
    fn begins(&mut self, _: Stage) {}
}
