//! The draft of a scene: each value of a file in its typed field. The rows of the key tables say
//! which field ([`super::key::Key::store`]); `study` and `scene` complete the draft to what runs.

use billow_solver::geometry::fold::{Caps, Chirality, Fit, FoldDesign};
use billow_solver::scene::{
    Contact, Film, GasSupply, HeatTransfer, IntegratorKind, ModelKind, Outputs, Scene, Solver,
    Species, Stepping, Thresholds,
};

use super::words::{Named, ResidualGas, pick};
use crate::input::value::Value;

/// What the keys of a file say. Fields that no key has set yet hold NaN, 0 or nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Draft {
    /// The scene of a study's job. Windows, supports, species, step choice and release time are
    /// completed later.
    pub scene: Scene,
    /// The gas.
    pub species: SpeciesDraft,
    /// What a study lets in where a window does not say otherwise.
    pub inflow: InflowDraft,
    /// How a study's job chooses its step.
    pub stepping: SteppingDraft,
    /// What only a scene file has.
    pub film_scene: FilmSceneDraft,
}

/// A gas: a named one, its constants, or both.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SpeciesDraft {
    /// The named gas.
    pub named: Option<Species>,
    /// Specific gas constant R, J/(kg K); replaces that of the named gas.
    pub gas_constant: Option<f64>,
    /// Specific heat at constant pressure cp, J/(kg K); replaces that of the named gas.
    pub cp: Option<f64>,
}

/// Inflow and residual gas of a study.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InflowDraft {
    /// Mass flow rate of a window that gives none, kg/s.
    pub mass_flow_rate: Option<f64>,
    /// Temperature of a window that gives none, K.
    pub temperature: f64,
    /// Residual gas, kg.
    pub residual_mass: f64,
    /// How residual gas enters.
    pub residual: ResidualGas,
    /// Mass flow rate of a burst, kg/s.
    pub burst_rate: f64,
}

/// The three ways to choose a step; the model decides which one applies.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SteppingDraft {
    /// Fraction of the stable step (CFL number).
    pub cfl: f64,
    /// Relative error tolerance of one step.
    pub adaptive: Option<f64>,
    /// Fixed step, s.
    pub fixed: Option<f64>,
}

/// What only a scene file has.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FilmSceneDraft {
    /// Whether the capsule starts erected; `None` leaves it to `statics`.
    pub erected: Option<bool>,
    /// Fixed overpressure, Pa.
    pub pressure: Option<f64>,
    /// Gas inside at the start, kg.
    pub initial_mass: Option<f64>,
    /// Absolute pressure at the start, Pa.
    pub initial_pressure: Option<f64>,
    /// Temperature of the gas at the start, K.
    pub initial_temperature: Option<f64>,
    /// Whether contact is on; `None` leaves it to `statics`.
    pub contact: Option<bool>,
    /// Range of adhesion beyond the contact distance, m.
    pub adhesion_range: Option<f64>,
    /// Simulated time, s.
    pub end_time: Option<f64>,
    /// Whether static equilibrium is solved instead of motion.
    pub statics: bool,
    /// Mass damping c, 1/s.
    pub mass_damping: f64,
}

impl Draft {
    /// A draft without any value.
    pub fn empty() -> Self {
        Self {
            scene: empty_scene(),
            species: SpeciesDraft::default(),
            inflow: InflowDraft::default(),
            stepping: SteppingDraft::default(),
            film_scene: FilmSceneDraft::default(),
        }
    }
}

/// A scene without any value.
fn empty_scene() -> Scene {
    Scene {
        design: FoldDesign {
            fit: Fit::Cone,
            panels: 0,
            storeys: 0,
            bottom_radius: f64::NAN,
            top_radius: None,
            height: None,
            half_angle: None,
            alpha1_over_phi: None,
            chirality: Chirality::Same,
            stowed_height: f64::NAN,
            subdivisions: 0,
            caps: Caps::Polygon,
        },
        film: Film {
            youngs_modulus: f64::NAN,
            poisson_ratio: f64::NAN,
            density: f64::NAN,
            thickness: f64::NAN,
            compression: f64::NAN,
            numerical_damping: f64::NAN,
            temperature: f64::NAN,
            loss_factor: f64::NAN,
            loss_frequency: f64::NAN,
        },
        gas: GasSupply {
            species: Species { gas_constant: f64::NAN, cp: f64::NAN },
            initial_mass: 0.0,
            windows: Vec::new(),
            ambient_pressure: f64::NAN,
            heat_transfer: HeatTransfer::Coefficient(f64::NAN),
            leak_area: f64::NAN,
            discharge_coefficient: f64::NAN,
        },
        supports: Vec::new(),
        contact: Contact { distance: None, friction: f64::NAN, adhesion: f64::NAN },
        gravity: f64::NAN,
        release_time: 0.0,
        solver: Solver {
            model: ModelKind::Film,
            end_time: f64::NAN,
            integrator: IntegratorKind::default(),
            stepping: Stepping::Stable(f64::NAN),
            step_limit: 0,
        },
        outputs: Outputs {
            sample_interval: f64::NAN,
            frames: 0,
            thresholds: Thresholds {
                deployed_volume: f64::NAN,
                deployed_height: f64::NAN,
                stalled_volume: f64::NAN,
                near_threshold_margin: f64::NAN,
            },
        },
        seed: 0,
        imperfection_amplitude: None,
    }
}

/// A number; `None` where the key has no value.
pub(super) fn optional(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) => Some(*number),
        _ => None,
    }
}

/// A number; NaN where the key has no value.
pub(super) fn number(value: &Value) -> f64 {
    optional(value).unwrap_or(f64::NAN)
}

/// A whole number of 64 bits; 0 where the key has no value.
pub(super) fn unsigned(value: &Value) -> u64 {
    match value {
        Value::Integer(number) => u64::try_from(*number).unwrap_or_default(),
        _ => 0,
    }
}

/// A whole number of 32 bits; 0 where the key has no value. Every such key allows less than 2^32.
pub(super) fn whole(value: &Value) -> u32 {
    u32::try_from(unsigned(value)).unwrap_or_default()
}

/// True or false; `None` where the key has no value.
pub(super) fn flag(value: &Value) -> Option<bool> {
    match value {
        Value::Bool(flag) => Some(*flag),
        _ => None,
    }
}

/// Sets a field to what a word stands for. A key without a value leaves the field as it is.
pub(super) fn choose<T: Copy>(field: &mut T, table: &[Named<T>], value: &Value) {
    if let Some(chosen) = pick(table, value) {
        *field = chosen;
    }
}

/// A heat transfer coefficient, or one of its words.
pub(super) fn heat_transfer(value: &Value) -> HeatTransfer {
    match value {
        Value::Number(coefficient) => HeatTransfer::Coefficient(*coefficient),
        Value::Text(word) if word == ISOTHERMAL => HeatTransfer::Isothermal,
        _ => HeatTransfer::Coefficient(0.0),
    }
}

/// Words of `gas.heat_transfer`, with the coefficient each stands for, W/(m² K).
pub(super) const ISOTHERMAL: &str = "isothermal";
pub(super) const HEAT_TRANSFER_WORDS: &[(&str, f64)] =
    &[("adiabatic", 0.0), (ISOTHERMAL, f64::INFINITY)];
