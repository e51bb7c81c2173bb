//! One entry of the table of mesh errors: the error of one measure by one method, for a kind of scene.
//!
//! ```text
//! b(x) = b_base + Σ_f Δ_f(x_f)                 Δ_f: change of the bias with one feature f, linear between levels
//! error = |b(x)| + k √(s² + c² Σ_f Δ_f²)       s: scatter of single runs, c: how far features do not add up
//! with a limit m_∞:  |b(x) − (m_∞/m_ref − 1)| + √(k² (…) + U²)     U: uncertainty of m_∞, 95 %
//! ```
//! k = 1.64 holds nine of ten normal deviations.

use std::collections::BTreeMap;

use billow_solver::scene::{ModelKind, Scene};
use serde::{Deserialize, Serialize};

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
    /// Bias of the base scene: median over the seeds of the value over that on the finest mesh, minus 1.
    pub bias: f64,
    /// Change of the bias with one feature: level and change, in ascending order, the level of the base scene included.
    pub effects: BTreeMap<String, Vec<[f64; 2]>>,
    /// Standard deviation of single runs about these medians, relative.
    pub scatter: f64,
    /// Deviation of scenes that differ in several features from the sum of the changes, over the root of the sum of
    /// their squares.
    pub interaction: f64,
    /// Number of scenes from which `interaction` follows; 0 where it is assumed.
    pub checked_scenes: usize,
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
    /// Whether the scenes of this entry have the features of a scene, from which the base scene differs.
    pub fn covers(&self, values: &[f64; FEATURES], base: &[f64; FEATURES]) -> bool {
        FEATURE_NAMES.iter().zip(values.iter().zip(base)).all(|((name, _), (value, base))| {
            let within = |levels: &Vec<[f64; 2]>| {
                let ends = levels.first().zip(levels.last());
                ends.is_some_and(|(first, last)| {
                    let inside = first[0] <= *value && *value <= last[0];
                    inside || are_equal(*value, first[0]) || are_equal(*value, last[0])
                })
            };
            are_equal(*value, *base) || self.effects.get(*name).is_some_and(within)
        })
    }

    /// Bias of a scene, and the root of the sum of the squares of the changes.
    pub fn bias(&self, values: &[f64; FEATURES]) -> (f64, f64) {
        let mut bias = self.bias;
        let mut squares = 0.0;
        for ((name, _), value) in FEATURE_NAMES.iter().zip(values) {
            if let Some(levels) = self.effects.get(*name) {
                let change = interpolated(levels, *value);
                bias += change;
                squares += change * change;
            }
        }
        (bias, squares.sqrt())
    }

    /// The relative error of nine of ten runs: against the limit if it is known, otherwise against the finest mesh.
    pub fn error(&self, values: &[f64; FEATURES], limit: Option<&Limit>) -> f64 {
        let (bias, changes) = self.bias(values);
        let interaction = self.interaction * changes;
        let scatter = self.scatter * self.scatter + interaction * interaction;
        let (distance, uncertainty) =
            limit.map_or((0.0, 0.0), |limit| (limit.change, limit.uncertainty));
        let width = DEVIATIONS * DEVIATIONS * scatter + uncertainty * uncertainty;
        (bias - distance).abs() + width.sqrt()
    }
}

/// The change at a level, linear between the levels known; beyond them that of the last one.
fn interpolated(levels: &[[f64; 2]], at: f64) -> f64 {
    let above = levels.iter().position(|[level, _]| *level >= at);
    match above {
        Some(0) => levels[0][1],
        None => levels.last().map_or(0.0, |[_, change]| *change),
        Some(index) => {
            let [[x0, y0], [x1, y1]] = [levels[index - 1], levels[index]];
            y0 + (at - x0) / (x1 - x0) * (y1 - y0)
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
