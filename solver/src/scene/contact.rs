//! Contact of a capsule's film with itself.

use serde::{Deserialize, Serialize};

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
