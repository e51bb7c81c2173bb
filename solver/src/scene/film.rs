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

impl Film {
    /// This film without loss and without numerical damping, as in a static equilibrium.
    #[must_use]
    pub fn elastic(self) -> Self {
        Self { loss_factor: 0.0, numerical_damping: 0.0, ..self }
    }

    /// Mass per area ρ t, kg/m².
    pub fn area_density(&self) -> f64 {
        self.density * self.thickness
    }
}
