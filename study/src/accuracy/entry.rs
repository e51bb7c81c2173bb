//! One entry of the table of mesh errors: the error of one measure by one method, for a kind of scene.
//!
//! ```text
//! b(x) = b_base + Σ_f s_f u_f(x)       u_f: coordinate of the feature f, [`super::coordinates`]
//! error = |b(x)| + w      w: the distance from b(x) that 19 of 20 runs keep, of scenes that were left out
//! over the value itself:  the larger of |b ± w|/(1 + b ± w)      (the value is 1 + b ± w of that on the finest mesh)
//! ```

use billow_solver::scene::{ModelKind, Scene};
use serde::{Deserialize, Serialize};

use super::features::FEATURES;
use crate::input::keys;

/// An error that 19 of 20 runs keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativeError {
    /// Over the value on the finest mesh.
    pub of_reference: f64,
    /// Over the value of the run. Of a value that is too small it is the larger one.
    pub of_itself: f64,
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
    /// Bias of the base scene: value over that on the finest mesh, minus 1.
    pub bias: f64,
    /// Change of the bias with the coordinate of each feature.
    pub slopes: [f64; FEATURES],
    /// w: the distance of a run from the bias of its scene that 19 of 20 keep; of a pair of meshes or a change likewise.
    pub width: f64,
    /// Number of runs.
    pub runs: usize,
    /// Number of scenes.
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

    /// The error of 19 of 20 runs of a scene with these coordinates.
    pub fn error(&self, u: &[f64; FEATURES]) -> RelativeError {
        let (bias, width) = (self.bias(u), self.width);
        let end = |side: f64| (bias + side * width).abs() / (1.0 + bias + side * width);
        // Below the value 0 nothing is known of a ratio.
        let of_itself = if bias - width > -1.0 { end(-1.0).max(end(1.0)) } else { f64::INFINITY };
        RelativeError { of_reference: bias.abs() + width, of_itself }
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
            ModelKind::Film => vec![scene.design.subdivisions],
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
