//! The part of the film's state that contact changes.

use serde::{Deserialize, Serialize};

use super::force_law::Contact;

/// History of contact: with positions it determines the contact forces.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactState {
    /// Contacts at the last update, in the order of their pairs.
    pub contacts: Vec<Contact>,
    /// State of each plate.
    pub plates: Vec<PlateState>,
}

impl ContactState {
    /// Energy stored in contacts and plates at the last update, J.
    pub fn stored_energy(&self) -> f64 {
        let pairs: f64 = self.contacts.iter().map(|contact| contact.energy).sum();
        let plates: f64 = self.plates.iter().map(|plate| plate.energy).sum();
        pairs + plates
    }
}

/// State of a plate.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlateState {
    /// Offset o of each node, m; empty once the plate is removed.
    pub offsets: Vec<f64>,
    /// Force between film and plate along the normal of the plate, N; positive in compression.
    pub force: f64,
    /// Energy stored between plate and film, J.
    pub energy: f64,
}
