//! Model and solution parameters of a capsule run.

use serde::{Deserialize, Serialize};

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
