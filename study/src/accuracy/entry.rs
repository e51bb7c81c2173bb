//! One entry of the table of mesh errors: the error of one measure by one method, for a kind of scene.
//!
//! ```text
//! b(x) = b_base + Σ_f s_f u_f(x)       u_f: coordinate of the feature f, [`super::coordinates`]
//! error = |b(x)| + k √(s² + d²)        s: scatter of single runs, d: deviation of scenes that were left out
//! with a limit m_∞:  |b(x) − (m_∞/m_ref − 1)| + √(k² (…) + U²)     U: uncertainty of m_∞, 95 %
//! ```
//! k = 1.64 holds nine of ten normal deviations.

use std::collections::BTreeMap;

use billow_solver::scene::{ModelKind, Scene};
use serde::{Deserialize, Serialize};

use super::coordinates::Coordinates;
use super::features::{FEATURE_NAMES, FEATURES, are_equal};
use crate::input::keys;

/// Normal deviations of which nine of ten are smaller, over the standard deviation.
const DEVIATIONS: f64 = 1.64;

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

    /// The relative error of nine of ten runs: against the limit if it is known, otherwise against the finest mesh.
    pub fn error(
        &self,
        values: &[f64; FEATURES],
        coordinates: &Coordinates,
        limit: Option<&Limit>,
    ) -> f64 {
        let (distance, uncertainty) =
            limit.map_or((0.0, 0.0), |limit| (limit.change, limit.uncertainty));
        let scatter = self.scatter * self.scatter + self.deviation * self.deviation;
        let width = DEVIATIONS * DEVIATIONS * scatter + uncertainty * uncertainty;
        (self.bias(values, coordinates) - distance).abs() + width.sqrt()
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
