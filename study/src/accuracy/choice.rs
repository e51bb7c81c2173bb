//! Which methods keep an error, and what they cost.
//!
//! ```text
//! cost of film on n subdivisions = (n/24)³     element-steps: elements ∝ n², steps ∝ n
//! cost of an extrapolated value  = sum over its meshes
//! ```
//! The cost of a run on 24 subdivisions is 1. No clock has a part in it.

use std::collections::BTreeMap;

use billow_solver::integrators::dormand_prince::DEFAULT_TOLERANCE;
use billow_solver::models;
use billow_solver::scene::{ModelKind, Scene, Stepping};

use super::entry::Method;
use super::features::{FEATURES, Features, STEP};
use super::promised::{PROMISED, Promised};
use super::table::MeshErrors;
use crate::job::result_limit::ResultLimit;

/// Subdivisions of the mesh whose run costs 1.
const COST_MESH: f64 = 24.0;
/// Cost of a run of the piston. Measured: seconds over those of film on 24 subdivisions, results/pareto.
const PISTON_COST: f64 = 1.4e-5;
/// Cost of a run of storeys, measured alike.
const STOREYS_COST: f64 = 1.5e-4;

/// A method with its cost and its errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The method.
    pub method: Method,
    /// Its cost over that of film on 24 subdivisions.
    pub cost: f64,
    /// Relative error of each promised measure: the largest over some scenes.
    pub errors: [f64; PROMISED.len()],
    /// Why its model cannot compute one of these scenes; `None` if it can.
    pub refusal: Option<String>,
}

impl Choice {
    /// Whether its model can compute the scenes, with no error above this one.
    pub fn keeps(&self, accuracy: f64) -> bool {
        self.refusal.is_none() && self.asked().all(|error| error <= accuracy)
    }

    /// The errors of the measures for which an accuracy is asked.
    pub fn asked(&self) -> impl Iterator<Item = f64> {
        let pairs = PROMISED.iter().zip(self.errors).filter(|(promised, _)| promised.is_asked);
        pairs.map(|(_, error)| error)
    }

    /// These errors, and those of limited measures, as a text, as in `t_90_z_rim 5.5 %`.
    pub fn errors_text(&self, limits: &[ResultLimit]) -> String {
        let shown = PROMISED.iter().zip(self.errors).filter(|(promised, _)| {
            promised.is_asked || limits.iter().any(|limit| limit.measure == promised.measure)
        });
        let text = |(promised, error): (&Promised, f64)| {
            let name = promised.measure.name();
            if error.is_finite() {
                format!("{name} {:.1} %", 100.0 * error)
            } else {
                format!("{name} not known")
            }
        };
        shown.map(text).collect::<Vec<_>>().join(", ")
    }
}

/// Cost of a method over that of film on 24 subdivisions.
pub fn cost(method: &Method) -> f64 {
    let of_mesh = |n: &u32| {
        let ratio = f64::from(*n) / COST_MESH;
        ratio * ratio * ratio
    };
    match method.model {
        ModelKind::Film => method.meshes.iter().map(of_mesh).sum(),
        ModelKind::Piston => PISTON_COST,
        ModelKind::Storeys => STOREYS_COST,
    }
}

/// The features of some scenes, each once: seeds and replicates have equal ones.
///
/// # Errors
/// Why the table does not cover a scene.
fn distinct<'a>(
    table: &MeshErrors,
    scenes: &'a [(&Scene, Features)],
) -> Result<BTreeMap<[u64; FEATURES], &'a Features>, String> {
    if let Some(gap) = scenes.iter().find_map(|(scene, features)| table.gap(scene, features)) {
        return Err(gap);
    }
    let bits = |features: &Features| features.values.map(f64::to_bits);
    Ok(scenes.iter().map(|(_, features)| (bits(features), features)).collect())
}

/// One method for these scenes, all of which its model can compute.
///
/// # Errors
/// Why the table does not cover a scene.
pub fn choice(
    table: &MeshErrors,
    method: Method,
    scenes: &[(&Scene, Features)],
) -> Result<Choice, String> {
    Ok(of_method(table, method, &distinct(table, scenes)?))
}

/// A method with its largest errors over some features.
fn of_method(
    table: &MeshErrors,
    method: Method,
    distinct: &BTreeMap<[u64; FEATURES], &Features>,
) -> Choice {
    let largest = |promised| {
        let errors = distinct.values().map(|features| table.error(&method, features, &promised));
        // A method without an error of a measure promises nothing for it.
        errors
            .map(|error| error.map_or(f64::INFINITY, |error| error.of_reference))
            .fold(0.0, f64::max)
    };
    let errors = PROMISED.map(largest);
    Choice { cost: cost(&method), errors, method, refusal: None }
}

/// The methods of the table for these scenes, the cheapest first.
///
/// # Errors
/// Why the table does not cover a scene.
pub fn choices(table: &MeshErrors, scenes: &[(&Scene, Features)]) -> Result<Vec<Choice>, String> {
    let distinct = distinct(table, scenes)?;
    let refusals = [ModelKind::Piston, ModelKind::Storeys, ModelKind::Film]
        .map(|model| (model, scenes.iter().find_map(|(scene, _)| refusal(model, scene))));
    let methods = table.of_measure(PROMISED[0].measure.name()).iter();
    let methods = methods.map(|entry| Method { model: entry.model, meshes: entry.meshes.clone() });
    let mut choices: Vec<Choice> = methods
        .map(|method| {
            let of_model = refusals.iter().find(|(model, _)| *model == method.model);
            let refusal = of_model.and_then(|(_, refusal)| refusal.clone());
            Choice { refusal, ..of_method(table, method, &distinct) }
        })
        .collect();
    // Methods without runs of such scenes promise nothing.
    choices.retain(|choice| choice.errors.iter().any(|error| error.is_finite()));
    choices.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    Ok(choices)
}

/// Why a model cannot compute a scene at its default step; `None` if it can.
fn refusal(model: ModelKind, scene: &Scene) -> Option<String> {
    if scene.solver.model == model {
        return None;
    }
    let mut scene = scene.clone();
    scene.solver.model = model;
    scene.solver.stepping = match model {
        ModelKind::Piston => Stepping::Adaptive(DEFAULT_TOLERANCE),
        ModelKind::Storeys | ModelKind::Film => Stepping::Stable(STEP),
    };
    models::check(&scene).err().map(|error| error.to_string())
}
