//! The part of the film's state that contact changes.

use serde::{Deserialize, Serialize};

use super::force_law::Contact;

/// State of contact. Together with positions and velocities it determines all later steps.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactState {
    /// Sum over the steps of an upper bound of the largest displacement of any node, m.
    pub path_length: f64,
    /// Contacts at the last update, in the order of their pairs.
    pub contacts: Vec<Contact>,
    /// State of each plate.
    pub plates: Vec<PlateState>,
    /// Scratch memory for the next contacts.
    #[serde(skip)]
    pub(super) scratch: Vec<Contact>,
    /// Number of times that the candidates were built without history, the first included.
    pub broad_phase_rebuilds: u64,
    /// Number of collision impulses on pairs so far.
    pub collision_impulses: u64,
    /// Energy dissipated by the collision impulses of pairs and plates so far, J. The ledger's entry
    /// `friction_work` is the sum of this and [`Self::friction_dissipation`].
    pub collision_dissipation: f64,
    /// Energy dissipated by friction so far, J.
    pub friction_dissipation: f64,
}

/// State of a plate.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlateState {
    /// Offset o of each node, m.
    pub offsets: Vec<f64>,
    /// Force between film and plate along the normal of the plate, N; positive in compression.
    pub force: f64,
    /// Energy stored between plate and film, J.
    pub energy: f64,
}
