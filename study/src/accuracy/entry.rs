//! One entry of the table of mesh errors: the error of one measure by one method, for a kind of scene.
//!
//! ```text
//! b(x) = b_base + Σ_f s_f u_f(x)       b = ln(m/m_f);  u_f: coordinate of the feature f, [`super::coordinates`]
//! m e^−(b ± w)                         where the value m_f on the finest mesh is
//! w: the distance from b(x) that 19 of 20 runs keep, of scenes that were left out or held back
//! over the value itself:  below it at most 1 − e^−(b + w), above it at most e^(w − b) − 1, and never less than 0
//! ```
//! It is an interval about the corrected value, and the value is in it.

use billow_solver::scene::{ModelKind, Scene};
use serde::{Deserialize, Serialize};

use super::features::FEATURES;
use crate::input::keys;

/// An error that 19 of 20 runs keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativeError {
    /// Over the value on the finest mesh.
    pub of_reference: f64,
    /// Over the value of the run: how far the value on the finest mesh may be below it, and above it.
    pub of_itself: [f64; 2],
}

/// The error of one measure, for one model and mesh; or its change with an assumed value, on the one mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Model.
    pub model: ModelKind,
    /// Subdivisions: of one mesh, or of the two meshes of an extrapolated value; none for a model without mesh.
    pub meshes: Vec<u32>,
    /// Weight w of an extrapolated value, m₂ + w (m₂ − m₁) of a coarse mesh 1 and a fine mesh 2; 0 for one mesh.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub weight: f64,
    /// Bias of the base scene: logarithm of the value over that on the finest mesh.
    pub bias: f64,
    /// Change of the bias with the coordinate of each feature.
    pub slopes: [f64; FEATURES],
    /// w: the distance of a run from the bias of its scene that 19 of 20 keep; of a pair of meshes or a change likewise.
    pub width: f64,
    /// Number of runs of the regression.
    pub runs: usize,
    /// Number of scenes of the regression.
    pub scenes: usize,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

impl Entry {
    /// Bias of a scene with these coordinates.
    pub fn bias(&self, u: &[f64; FEATURES]) -> f64 {
        self.bias + self.slopes.iter().zip(u).map(|(slope, u)| slope * u).sum::<f64>()
    }

    /// How far below and above a value that with the assumed value may be, over it, in 19 of 20 runs of a scene with
    /// these coordinates.
    pub fn change(&self, u: &[f64; FEATURES]) -> [f64; 2] {
        let bias = self.bias(u);
        let (below, above) =
            (1.0 - libm::exp(bias - self.width), libm::exp(bias + self.width) - 1.0);
        [below.max(0.0), above.max(0.0)]
    }

    /// The error of 19 of 20 runs of a scene with these coordinates.
    pub fn error(&self, u: &[f64; FEATURES]) -> RelativeError {
        let (bias, width) = (self.bias(u), self.width);
        let below = 1.0 - libm::exp(-bias - width);
        let above = libm::exp(width - bias) - 1.0;
        let of_reference = libm::exp(bias + width) - 1.0;
        RelativeError {
            of_reference: of_reference.max(1.0 - libm::exp(bias - width)),
            of_itself: [below.max(0.0), above.max(0.0)],
        }
    }
}

/// How the value of a row was computed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Method {
    /// Model.
    pub model: ModelKind,
    /// Subdivisions of its mesh or meshes, coarsest first; none for a model without mesh.
    pub meshes: Vec<u32>,
}

impl Method {
    /// The method of a single run.
    pub fn of(scene: &Scene) -> Self {
        let meshes = match scene.solver.model {
            ModelKind::Film => {
                scene.design.folded().map_or(Vec::new(), |design| vec![design.subdivisions])
            }
            ModelKind::Piston | ModelKind::Storeys => Vec::new(),
        };
        Self { model: scene.solver.model, meshes }
    }

    /// Name for messages: "film, n 4".
    pub fn name(&self) -> String {
        let model = keys::model(self.model).name;
        match self.meshes.as_slice() {
            [] => model.to_owned(),
            [n] => format!("{model}, n {n}"),
            meshes => {
                let meshes: Vec<String> = meshes.iter().map(ToString::to_string).collect();
                format!("{model}, n {} extrapolated", meshes.join(" and "))
            }
        }
    }
}
