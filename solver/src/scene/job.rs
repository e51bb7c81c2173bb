//! The scene of a job: its film, gas, contact and supports, how it is solved, what is stored.

use serde::{Deserialize, Serialize};

use super::{Design, Species};

/// Everything one run needs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// A folded capsule, as requested ([`crate::geometry::fold::FoldPattern::new`] solves it), or film from a mesh.
    pub design: Design,
    /// Material of the film.
    pub film: Film,
    /// The gas that deploys the capsule.
    pub gas: GasSupply,
    /// Supports of a capsule. Those of film from a mesh belong to its nodes ([`super::MeshFilm`]).
    pub supports: Vec<Support>,
    /// Contact of film with film.
    pub contact: Contact,
    /// Acceleration along z, m/s²: 0 in orbit, −9.80665 upright on the ground.
    pub gravity: f64,
    /// Time at which the packing lid releases the capsule, s. Until then the lid limits the capsule to its
    /// stowed height, and gas presses on the lid. The run starts at time 0, so 0 releases at once.
    pub release_time: f64,
    /// Model and solution parameters.
    pub solver: Solver,
    /// What is stored.
    pub outputs: Outputs,
    /// Seed of the imperfection of the stowed shape. A model without imperfection ignores it.
    pub seed: u64,
    /// Amplitude of this imperfection, m; `None` for the default of the design
    /// ([`crate::models::film::reference_gap`]) or of the mesh ([`super::MeshFilm`]).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imperfection_amplitude: Option<f64>,
}

/// Film material: an isotropic membrane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Film {
    /// Young's modulus E, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio ν.
    pub poisson_ratio: f64,
    /// Density ρ, kg/m³.
    pub density: f64,
    /// Thickness t, m.
    pub thickness: f64,
    /// Compression fraction c: 0 for the tension field, 1 for the full membrane stiffness.
    pub compression: f64,
    /// Whether the film has bending stiffness D = E t³/(12(1−ν²)); fold lines are free to turn. Absent where not.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub bending: bool,
    /// Stiffness of the fold lines of film with bending; `None` where they turn freely.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub creases: Option<Creases>,
    /// Largest bending moment of film with bending and of its creases, for each metre of an edge, N m/m; `None` for
    /// film that does not yield.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yield_moment: Option<f64>,
    /// Numerical damping ratio ζ: of the highest mode of an element while the film carries tension. Not
    /// a property of the film; it stands here because the constants of the elements hold it.
    #[serde(rename = "viscosity")]
    pub numerical_damping: f64,
    /// Film temperature, K; constant.
    pub temperature: f64,
    /// Largest loss factor η (tan δ) of the material; 0 for film without loss.
    pub loss_factor: f64,
    /// Frequency of the largest loss factor, Hz.
    pub loss_frequency: f64,
}

/// Fold lines as elastic hinges with the stiffness D/L* (N m/rad for each metre).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Creases {
    /// L*, m.
    pub length_scale: f64,
    /// Angle between the two elements at a fold line at rest, rad, in the direction in which it is folded at the start: 0
    /// flat, π closed. `None` for the angle at the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest_angle: Option<f64>,
}

impl Film {
    /// This film without loss, yield and numerical damping, as in a static equilibrium.
    #[must_use]
    pub fn elastic(self) -> Self {
        Self { loss_factor: 0.0, numerical_damping: 0.0, yield_moment: None, ..self }
    }

    /// Bending stiffness D = E t³/(12(1−ν²)), N m.
    pub fn bending_stiffness(&self) -> f64 {
        let (t, nu) = (self.thickness, self.poisson_ratio);
        self.youngs_modulus * t * t * t / (12.0 * (1.0 - nu * nu))
    }

    /// Mass per area ρ t, kg/m².
    pub fn area_density(&self) -> f64 {
        self.density * self.thickness
    }
}

/// The gas of the control volume, its inflow, its leak, and its heat exchange.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasSupply {
    /// The gas.
    pub species: Species,
    /// Mass inside at time 0, kg, at film temperature (residual gas `stored`).
    pub initial_mass: f64,
    /// Inflow windows; overlapping windows add up.
    pub windows: Vec<InflowWindow>,
    /// Pressure outside, Pa.
    pub ambient_pressure: f64,
    /// Heat exchange with the film.
    pub heat_transfer: HeatTransfer,
    /// Area of the leak orifice, m².
    pub leak_area: f64,
    /// Discharge coefficient of the leak orifice and of the vent.
    pub discharge_coefficient: f64,
    /// A vent beside the leak.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vent: Option<Vent>,
}

/// An orifice that opens at a time, or with the overpressure, and closes again.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vent {
    /// Area when it is fully open, m².
    pub area: f64,
    /// Times between which it can be open, s.
    pub from: f64,
    /// End of these times, s.
    pub to: f64,
    /// Overpressure at which it begins to open, Pa.
    pub opens_at: f64,
    /// Overpressure at which it is fully open, Pa; 0 for a vent that does not depend on it.
    pub full_at: f64,
}

impl Vent {
    /// Open area at this overpressure (Pa), m²: proportional between both pressures, as of a relief valve.
    pub fn open_area(&self, overpressure: f64) -> f64 {
        if self.full_at <= 0.0 {
            return self.area;
        }
        let range = self.full_at - self.opens_at;
        self.area * ((overpressure - self.opens_at) / range).clamp(0.0, 1.0)
    }
}

/// Inflow at a constant mass flow rate while `from ≤ t < to`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InflowWindow {
    /// Start, s.
    pub from: f64,
    /// End, s.
    pub to: f64,
    /// Mass flow rate ṁ, kg/s. The stored name is part of job ids.
    #[serde(rename = "rate")]
    pub mass_flow_rate: f64,
    /// Inflow temperature `T_in`, K.
    pub temperature: f64,
}

/// Heat exchange between gas and film over the area of the film.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum HeatTransfer {
    /// Heat transfer coefficient h, W/(m² K); 0 is adiabatic.
    Coefficient(f64),
    /// The gas has film temperature at all times.
    Isothermal,
}

/// Contact of film with film.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Distance below which film repels film, m; `None` for the default of the design
    /// ([`crate::models::film::reference_gap`]).
    pub distance: Option<f64>,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Pull-off pressure of adhesion, Pa.
    pub adhesion: f64,
}

/// One support.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// The nodes it holds.
    pub on: SupportLocation,
    /// The displacement components it holds: letters of "xyz", in that order.
    pub fix: String,
}

/// The nodes a support holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SupportLocation {
    /// All nodes of the bottom ring.
    BottomRing,
    /// All nodes of the top ring.
    TopRing,
    /// All nodes of the bottom cap and the bottom ring.
    BottomCap,
    /// All nodes of the top cap and the top ring.
    TopCap,
}

/// The model that computes the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelKind {
    /// One moving mass on one gas volume: [`crate::models::piston`].
    Piston,
    /// Rings of film that rise, turn and widen on one gas volume: [`crate::models::storeys`].
    Storeys,
    /// The film with contact: [`crate::models::film`].
    Film,
}

impl ModelKind {
    /// Every kind, from cheap to complete.
    pub const ALL: [Self; 3] = [Self::Piston, Self::Storeys, Self::Film];
}

/// CFL number where the scene gives none. Chosen: the energy ledger of the paper's capsule without
/// contact stays well inside its bound.
pub const DEFAULT_CFL: f64 = 0.45;

/// The integrator of film.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IntegratorKind {
    /// Central differences: [`crate::integrators::explicit`].
    #[default]
    Explicit,
    /// BDF2 with Newton's method: [`crate::integrators::implicit`].
    Implicit,
    /// Explicit while film moves, implicit while it hardly does: [`crate::integrators::hybrid`].
    Hybrid,
}

impl IntegratorKind {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::Explicit, Self::Implicit, Self::Hybrid];

    /// Whether it is the one of a scene that names none. Job ids depend on this: a scene that names none
    /// keeps its id.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// Model and solution parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Solver {
    /// Model.
    pub model: ModelKind,
    /// Simulated time, s.
    pub end_time: f64,
    /// Integrator of film; other models ignore it.
    #[serde(default, skip_serializing_if = "IntegratorKind::is_default")]
    pub integrator: IntegratorKind,
    /// Choice of the time step.
    pub stepping: Stepping,
    /// Maximum number of accepted steps; a run that reaches it stops with `step_limit`.
    pub step_limit: u64,
}

/// Choice of the time step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Stepping {
    /// Error-controlled, with this relative tolerance a step.
    Adaptive(f64),
    /// This step, s; shortened only to end at breakpoints and sample times.
    Fixed(f64),
    /// This fraction of the stable step (CFL number), for explicit models.
    Stable(f64),
}

/// Maximum number of samples of a run, `end_time`/`sample_interval`. Chosen: keeps a history in memory
/// and in one file.
pub const MAX_SAMPLES: f64 = 1e6;

/// What is stored of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outputs {
    /// Time between samples of the history, s. Samples are taken at multiples of it, and at the end.
    pub sample_interval: f64,
    /// Number of frames (shapes) to keep ([`crate::output::frames`]); 0 for none.
    pub frames: u32,
    /// Thresholds of the measures and the verdict.
    pub thresholds: Thresholds,
}

/// Thresholds of the verdict; stored with every result.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thresholds {
    /// Smallest V/`V_ref` of a deployed capsule.
    pub deployed_volume: f64,
    /// Smallest `z_rim`/`H_ref` of a deployed capsule.
    pub deployed_height: f64,
    /// A capsule is stalled where the mean V/`V_ref` of the last tenth is below this.
    pub stalled_volume: f64,
    /// A verdict whose smallest margin is below this is marked `near_threshold`. The stored name is
    /// part of job ids.
    #[serde(rename = "close_margin")]
    pub near_threshold_margin: f64,
}

/// Chosen as defaults of the study keys `outputs.thresholds`.
impl Default for Thresholds {
    fn default() -> Self {
        Self {
            deployed_volume: 0.93,
            deployed_height: 0.95,
            stalled_volume: 0.85,
            near_threshold_margin: 0.02,
        }
    }
}
