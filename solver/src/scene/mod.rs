//! What one run needs, resolved: no defaults left open, no units, nothing called "auto".
//!
//! A scene is plain data. Its canonical JSON is what a job id is made of, so a field added here
//! changes job ids, and a field that does not change results does not belong here.

use serde::{Deserialize, Serialize};

use crate::geometry::fold::FoldDesign;

pub mod error;
pub mod film_scene;
pub mod film_support;
pub mod inflow;
pub mod monitor_settings;
pub mod motion;
pub mod paper;
pub mod plate;
pub mod timeline;
mod validate;

/// Everything one run needs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// The capsule, as asked for; [`crate::geometry::fold::FoldPattern::new`] solves it.
    pub design: FoldDesign,
    /// The film it is made of.
    pub film: Film,
    /// The gas that deploys it.
    pub gas: GasSupply,
    /// What holds it.
    pub supports: Vec<Support>,
    /// Film against film.
    pub contact: Contact,
    /// Acceleration along z, m/s² (0 in orbit, −9.80665 standing on the ground).
    pub gravity: f64,
    /// How long the packing lid holds the capsule at its stowed height, s. Gas let in until then
    /// presses on the lid. Time 0 is the start of the run, so 0 releases at once.
    pub release_time: f64,
    /// How it is computed.
    pub solver: Solver,
    /// What is stored.
    pub outputs: Outputs,
    /// Seed of the imperfection put on the stowed shape. Models without one ignore it.
    pub seed: u64,
}

/// Film material: an isotropic membrane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Film {
    /// Young's modulus E, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio ν.
    pub poisson_ratio: f64,
    /// Density, kg/m³.
    pub density: f64,
    /// Thickness t, m.
    pub thickness: f64,
    /// Compression fraction c: 0 is the tension field, 1 the full membrane stiffness.
    pub compression: f64,
    /// Viscous damping ratio ζ.
    pub viscosity: f64,
    /// Film temperature, K; constant.
    pub temperature: f64,
}

impl Film {
    /// Mass per area, kg/m².
    pub fn area_density(&self) -> f64 {
        self.density * self.thickness
    }
}

/// The control volume's gas and all that enters or leaves it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasSupply {
    /// The gas.
    pub species: Species,
    /// Gas mass inside at time 0, kg, at film temperature (residual gas `stored`).
    pub initial_mass: f64,
    /// Inflow windows; overlapping windows add up.
    pub windows: Vec<InflowWindow>,
    /// Pressure outside, Pa.
    pub ambient_pressure: f64,
    /// Heat exchange with the film.
    pub heat_transfer: HeatTransfer,
    /// Area of the leak orifice, m².
    pub leak_area: f64,
    /// Discharge coefficient of the leak orifice.
    pub discharge_coefficient: f64,
}

/// An ideal gas.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Species {
    /// Specific gas constant R, J/(kg K).
    pub gas_constant: f64,
    /// Specific heat at constant pressure cp, J/(kg K); cv = cp − R.
    pub cp: f64,
}

/// Gas let in at a constant rate while `from ≤ t < to`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InflowWindow {
    /// Start, s.
    pub from: f64,
    /// End, s.
    pub to: f64,
    /// Mass flow rate, kg/s.
    pub rate: f64,
    /// Temperature of the gas let in, K.
    pub temperature: f64,
}

/// Heat exchange between gas and film over the film's area.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum HeatTransfer {
    /// Heat transfer coefficient h, W/(m² K); 0 is adiabatic.
    Coefficient(f64),
    /// The gas has film temperature at all times.
    Isothermal,
}

/// One support.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// Where it acts.
    pub on: SupportPlace,
    /// Which displacement components it holds: letters of "xyz", in that order.
    pub fix: String,
}

/// Where a support acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SupportPlace {
    /// All nodes of the bottom ring.
    BottomRing,
    /// All nodes of the top ring.
    TopRing,
    /// All nodes of the bottom cap, ring included.
    BottomCap,
    /// All nodes of the top cap, ring included.
    TopCap,
}

/// Contact of film with film.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Distance at which film is held apart, m; `None` leaves it to the model, which takes 0.4 of
    /// the smallest stowed gap.
    pub distance: Option<f64>,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Adhesive pull-off pressure, Pa.
    pub adhesion: f64,
}

/// Which rung of the ladder computes the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelKind {
    /// One moving mass on one gas volume: [`crate::models::piston`].
    Piston,
    /// The film itself, with contact: [`crate::models::film`].
    Film,
}

/// How the scene is computed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Solver {
    /// Model.
    pub model: ModelKind,
    /// Simulated time, s.
    pub end_time: f64,
    /// How the step is chosen.
    pub stepping: Stepping,
    /// Accepted steps after which the run stops with `step_limit`.
    pub step_limit: u64,
}

/// How a model chooses its step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Stepping {
    /// Error-controlled, with this relative tolerance a step.
    Adaptive(f64),
    /// This step, s (shortened only to land on window edges and samples).
    Fixed(f64),
    /// This share of the stable step (CFL number): for explicit models.
    Stable(f64),
}

/// What is stored of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outputs {
    /// Time between samples of the history, s. Sampling is even: k·interval, and the end.
    pub sample_interval: f64,
    /// Shapes kept of a model that has any ([`crate::output::frames`]); 0 for none.
    pub frames: u32,
    /// Thresholds of the measures and the verdict.
    pub thresholds: Thresholds,
}

/// Thresholds that turn a history into a verdict; stored with every result.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thresholds {
    /// Deployed needs V at or above this fraction of `V_ref`.
    pub deployed_volume: f64,
    /// Deployed needs `z_rim` at or above this fraction of `H_ref`.
    pub deployed_height: f64,
    /// Stalled is a mean V of the last tenth below this fraction of `V_ref`.
    pub stalled_volume: f64,
    /// A verdict whose nearest margin is under this fraction is marked `close`.
    pub close_margin: f64,
}

impl Default for Thresholds {
    fn default() -> Self {
        Self {
            deployed_volume: 0.93,
            deployed_height: 0.95,
            stalled_volume: 0.85,
            close_margin: 0.02,
        }
    }
}
