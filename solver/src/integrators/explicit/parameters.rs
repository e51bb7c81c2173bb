//! What is constant while film moves, beside the film itself.

use nalgebra::Vector3;

use crate::collision::contact::ContactModel;
use crate::mechanics::gas::Gas;
use crate::mechanics::supports::Supports;
use crate::platform::fault_injection::{Fault, Term};
use crate::platform::simd::InstructionSet;
use crate::scene::monitor_settings::MonitorSettings;

/// CFL number to use where nobody asks for another: over the deployment of the paper's capsule
/// without contact it keeps the energy ledger well inside its bound.
pub const DEFAULT_CFL: f64 = 0.45;

/// What presses on the film from inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PressureLoad {
    /// Gas in the closed volume.
    Gas(Gas),
    /// This overpressure, Pa, whatever the volume; film may be open.
    Overpressure(f64),
}

/// What is constant during a run, beside the film itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// What presses from inside.
    pub interior: PressureLoad,
    /// What is held.
    pub supports: Supports,
    /// Acceleration of gravity, m/s².
    pub gravity: Vector3<f64>,
    /// ζ of the film's viscosity, for the stable step.
    pub viscosity: f64,
    /// c, 1/s: nought but in statics and where a scene asks for it.
    pub mass_damping: f64,
    /// Share of the stable step.
    pub cfl: f64,
    /// Accepted steps after which a run stops.
    pub step_limit: u64,
    /// Instruction set; the bits are the same on each.
    pub path: InstructionSet,
    /// Film against film; none lets film pass through film.
    pub contact: Option<ContactModel>,
    /// How closely passages are watched for; `None`: not at all.
    pub watch: Option<MonitorSettings>,
    /// A deliberate fault: tests only.
    pub mutation: Option<Fault>,
}

impl Parameters {
    /// Film without supports, gravity, viscosity or mass damping, at the default step.
    pub fn free(interior: PressureLoad, nodes: usize) -> Self {
        Self {
            interior,
            supports: Supports::none(nodes),
            gravity: Vector3::zeros(),
            viscosity: 0.0,
            mass_damping: 0.0,
            cfl: DEFAULT_CFL,
            step_limit: u64::MAX,
            path: InstructionSet::detect(),
            contact: None,
            watch: None,
            mutation: None,
        }
    }

    /// The factor of a term: 1 but in tests.
    pub(super) fn fault(&self, term: Term) -> f64 {
        self.mutation.filter(|mutation| mutation.term == term).map_or(1.0, |m| m.factor)
    }
}
