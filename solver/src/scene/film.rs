//! Material of the film.

use serde::{Deserialize, Serialize};

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
    /// Viscous damping ratio ζ.
    pub viscosity: f64,
    /// Film temperature, K; constant.
    pub temperature: f64,
}

impl Film {
    /// Mass per area ρ t, kg/m².
    pub fn area_density(&self) -> f64 {
        self.density * self.thickness
    }
}
