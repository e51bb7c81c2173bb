//! The scene of a capsule.

use serde::{Deserialize, Serialize};

use super::{Contact, Film, GasSupply, Outputs, Solver, Support};
use crate::geometry::fold::FoldDesign;

/// Everything one run of a capsule needs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// The fold design as requested; [`crate::geometry::fold::FoldPattern::new`] solves it.
    pub design: FoldDesign,
    /// Material of the film.
    pub film: Film,
    /// The gas that deploys the capsule.
    pub gas: GasSupply,
    /// Supports of the film.
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
    /// ([`crate::models::film::reference_gap`]).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imperfection_amplitude: Option<f64>,
}
