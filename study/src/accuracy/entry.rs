//! One entry of the table of mesh errors: the error of one measure by one method, for a kind of scene.
//!
//! ```text
//! b(x) = b_base + Σ_f s_f u_f(x)       u_f: coordinate of the feature f, [`super::coordinates`]
//! error = |c| + w,  c = b(x),  w = k √(s² + d²)      s: scatter of single runs, d: deviation of scenes that were left out
//! with a limit m_∞:  c = b(x) − (m_∞/m_ref − 1),  w = √(k² (…) + U²)      U: uncertainty of m_∞, 95 %
//! over the value itself:  the larger of |c ± w|/(1 + b ± w)               (the value is 1 + b ± w of m_ref)
//! ```
//! k holds nine of ten values of Student's distribution; its degrees of freedom are the scenes less the fitted numbers.

use std::collections::BTreeMap;

use billow_solver::scene::{ModelKind, Scene};
use serde::{Deserialize, Serialize};

use super::coordinates::Coordinates;
use super::features::{FEATURE_NAMES, FEATURES, are_equal};
use super::student::nine_of_ten;
use crate::input::keys;

/// To what a measure tends as the mesh is refined.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limit {
    /// Whether a limit is known.
    pub known: bool,
    /// Limit over the value on the finest mesh, minus 1; of several scenes the mean.
    pub change: f64,
    /// Relative uncertainty of the limit, 95 %; it holds the limits of all scenes.
    pub uncertainty: f64,
    /// Observed order of convergence in the edge length; of several scenes the smallest.
    pub order: f64,
}

/// An error that nine of ten runs keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativeError {
    /// Over the value on the finest mesh.
    pub of_reference: f64,
    /// Over the value of the run. Of a value that is too small it is the larger one.
    pub of_itself: f64,
}

/// The error of one measure, for one model and mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Measure.
    pub measure: String,
    /// Model.
    pub model: ModelKind,
    /// Subdivisions: of one mesh, or of the two meshes of an extrapolated value; none for a model without mesh.
    pub meshes: Vec<u32>,
    /// Weight w of an extrapolated value, m₂ + w (m₂ − m₁) of a coarse mesh 1 and a fine mesh 2; 0 for one mesh.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub weight: f64,
    /// Bias of the base scene: value over that on the finest mesh, minus 1.
    pub bias: f64,
    /// Change of the bias with the coordinate of each feature that varies over the scenes.
    pub slopes: BTreeMap<String, f64>,
    /// Smallest and largest level of these features, SI.
    pub ranges: BTreeMap<String, [f64; 2]>,
    /// Standard deviation of single runs about the medians of their scenes, relative.
    pub scatter: f64,
    /// Root of the mean squared deviation of a scene from what all other scenes predict, relative.
    pub deviation: f64,
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
    /// Whether the features of a scene lie within those of the scenes of this entry.
    pub fn covers(&self, values: &[f64; FEATURES], coordinates: &Coordinates) -> bool {
        let base = &coordinates.base;
        FEATURE_NAMES.iter().zip(values.iter().zip(base)).all(|((name, _), (value, base))| {
            self.ranges.get(*name).map_or(are_equal(*value, *base), |[least, largest]| {
                let inside = *least <= *value && *value <= *largest;
                inside || are_equal(*value, *least) || are_equal(*value, *largest)
            })
        })
    }

    /// Bias of a scene.
    pub fn bias(&self, values: &[f64; FEATURES], coordinates: &Coordinates) -> f64 {
        let u = coordinates.of(values);
        let changes = FEATURE_NAMES.iter().zip(u).filter_map(|((name, _), u)| {
            let slope = self.slopes.get(*name)?;
            Some(slope * u)
        });
        self.bias + changes.sum::<f64>()
    }

    /// The error of nine of ten runs of a scene: against the limit if it is known, otherwise against the finest mesh.
    pub fn error(
        &self,
        values: &[f64; FEATURES],
        coordinates: &Coordinates,
        limit: Option<&Limit>,
    ) -> RelativeError {
        let (change, uncertainty) =
            limit.map_or((0.0, 0.0), |limit| (limit.change, limit.uncertainty));
        let k = nine_of_ten(self.scenes.saturating_sub(1 + self.slopes.len()));
        let scatter = self.scatter * self.scatter + self.deviation * self.deviation;
        let width = (k * k * scatter + uncertainty * uncertainty).sqrt();
        let bias = self.bias(values, coordinates);
        let distance = bias - change;
        let end = |side: f64| (distance + side * width).abs() / (1.0 + bias + side * width);
        // Below the value 0 nothing is known of a ratio.
        let of_itself = if bias - width > -1.0 { end(-1.0).max(end(1.0)) } else { f64::INFINITY };
        RelativeError { of_reference: distance.abs() + width, of_itself }
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
