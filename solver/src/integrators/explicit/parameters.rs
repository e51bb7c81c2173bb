//! Everything that is constant while film moves, except the film model itself.

use nalgebra::Vector3;

use crate::collision::contact::ContactModel;
use crate::mechanics::gas::Gas;
use crate::mechanics::supports::Supports;
use crate::platform::fault_injection::{Fault, Term};
use crate::platform::simd::InstructionSet;
use crate::scene::monitor_settings::MonitorSettings;

/// CFL number where the scene gives none. Chosen: the energy ledger of the paper's capsule without
/// contact stays well inside its bound.
pub const DEFAULT_CFL: f64 = 0.45;

/// The pressure on the inside of the film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PressureLoad {
    /// Gas in the closed volume.
    Gas(Gas),
    /// A fixed overpressure, Pa, whatever the volume. The film may be open.
    Overpressure(f64),
}

/// Everything that is constant during a run, except the film model itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Pressure on the inside.
    pub pressure_load: PressureLoad,
    /// Supports.
    pub supports: Supports,
    /// Acceleration of gravity, m/s².
    pub gravity: Vector3<f64>,
    /// Numerical damping ratio ζ; the stable step depends on it.
    pub numerical_damping: f64,
    /// Mass damping c, 1/s. A capsule's scene sets 0; a film scene and [`crate::statics::Relaxation`]
    /// may set more.
    pub mass_damping: f64,
    /// CFL number: the step as a fraction of the stable step.
    pub cfl: f64,
    /// Accepted steps after which a run fails with `step_limit`.
    pub step_limit: u64,
    /// Instruction set. Every one gives the same bits.
    pub instruction_set: InstructionSet,
    /// Contact of film with film; without it film passes through film.
    pub contact: Option<ContactModel>,
    /// Settings of the tunnelling monitor; `None` switches it off.
    pub monitor: Option<MonitorSettings>,
    /// A deliberate fault: tests only.
    pub fault: Option<Fault>,
}

impl Parameters {
    /// Film without supports, gravity, numerical damping, mass damping or contact, at the default CFL
    /// number, on the widest instruction set of this machine.
    pub fn free(pressure_load: PressureLoad, nodes: usize) -> Self {
        Self {
            pressure_load,
            supports: Supports::none(nodes),
            gravity: Vector3::zeros(),
            numerical_damping: 0.0,
            mass_damping: 0.0,
            cfl: DEFAULT_CFL,
            step_limit: u64::MAX,
            instruction_set: InstructionSet::detect(),
            contact: None,
            monitor: None,
            fault: None,
        }
    }

    /// The factor a deliberate fault puts on this term; 1 without a fault.
    pub(super) fn fault_factor(&self, term: Term) -> f64 {
        self.fault.filter(|fault| fault.term == term).map_or(1.0, |fault| fault.factor)
    }
}
