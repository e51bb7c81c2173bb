//! Time integration.
//!
//! [`dormand_prince`]: Runge-Kutta of order 5(4) for small smooth systems. Film has one interface
//! ([`interface::Integrator`]) and a table of the integrators behind it ([`entry`]): a kind without a row
//! does not compile. A [`FilmSimulation`] is film with its integrator and its audit; who only looks at it
//! has a [`FilmView`].

use serde::{Deserialize, Serialize};

use crate::scene::IntegratorKind;
use crate::system::{FilmState, FilmSystem, Workspace};

mod contact_audit;
pub mod dormand_prince;
pub mod energy_accounting;
pub mod explicit;
pub mod film_audit;
pub mod film_simulation;
pub mod film_view;
pub mod hybrid;
pub mod implicit;
pub mod interface;
mod motion_audit;
mod pressure_audit;
mod virtual_displacement;

pub use film_simulation::{FilmSimulation, SimulationSettings, StoredFilm};
pub use film_view::FilmView;
pub use interface::{Advance, Budget, Computed, Integrator, Interval, StepAudit, StepMotion};

/// Everything in which integrators of film differ, but for the trait. To add one: a variant of
/// [`IntegratorKind`], a folder, and an arm of [`entry`].
#[derive(Debug)]
pub struct IntegratorEntry {
    /// Name, as in `solver.integrator`.
    pub name: &'static str,
    /// Meaning, one line.
    pub meaning: &'static str,
    /// The integrator of a state, with the workspace that evaluated it, at a CFL number.
    pub start: fn(&FilmSystem, &FilmState, Workspace, f64) -> Box<dyn Integrator>,
    /// Whether it knows Coulomb friction.
    pub has_friction: bool,
    /// Why it cannot move a system, but for friction; `None` if it can.
    pub refuses: fn(&FilmSystem) -> Option<Refusal>,
}

impl IntegratorEntry {
    /// Why it cannot move film with this friction coefficient; `None` if it can.
    pub fn refuses_friction(&self, coefficient: f64) -> Option<Refusal> {
        let refused = coefficient > 0.0 && !self.has_friction;
        refused.then_some(Refusal { unknown: "friction", allowed: "contact.friction 0" })
    }

    /// Why it cannot move a system; `None` if it can.
    pub fn refusal(&self, system: &FilmSystem) -> Option<Refusal> {
        let friction = system.contact.as_ref().map_or(0.0, |model| model.friction);
        self.refuses_friction(friction).or_else(|| (self.refuses)(system))
    }
}

/// Why an integrator cannot move a system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Refusal {
    /// What it does not know.
    pub unknown: &'static str,
    /// What is allowed instead.
    pub allowed: &'static str,
}

/// The row of an integrator.
pub const fn entry(kind: IntegratorKind) -> &'static IntegratorEntry {
    match kind {
        IntegratorKind::Explicit => &explicit::ENTRY,
        IntegratorKind::Implicit => &implicit::ENTRY,
        IntegratorKind::Hybrid => &hybrid::ENTRY,
    }
}

/// Private state of an integrator, tagged with its name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StoredIntegrator {
    /// Of [`explicit`].
    Explicit(Box<explicit::StoredExplicit>),
    /// Of [`implicit`].
    Implicit(Box<implicit::StoredImplicit>),
    /// Of [`hybrid`].
    Hybrid(Box<hybrid::StoredHybrid>),
}

impl StoredIntegrator {
    /// The integrator that it is of.
    pub fn kind(&self) -> IntegratorKind {
        match self {
            Self::Explicit(_) => IntegratorKind::Explicit,
            Self::Implicit(_) => IntegratorKind::Implicit,
            Self::Hybrid(_) => IntegratorKind::Hybrid,
        }
    }

    /// The integrator at a state and a CFL number; it continues with the same bits.
    pub fn resume(self, system: &FilmSystem, state: &FilmState, cfl: f64) -> Box<dyn Integrator> {
        match self {
            Self::Explicit(stored) => {
                Box::new(explicit::Explicit::resume(system, state, *stored, cfl))
            }
            Self::Implicit(stored) => Box::new(implicit::Implicit::resume(system, state, *stored)),
            Self::Hybrid(stored) => Box::new(hybrid::Hybrid::resume(system, state, *stored, cfl)),
        }
    }

    /// Whether it can be of this system.
    fn fits(&self, system: &FilmSystem) -> bool {
        match self {
            Self::Explicit(stored) => stored.fits(system),
            Self::Implicit(stored) => stored.fits(system),
            Self::Hybrid(stored) => stored.fits(system),
        }
    }
}
