//! The cheapest of all models and meshes that keeps an accuracy, from the table of mesh errors.

use crate::accuracy::choice::cost;
use crate::accuracy::features::STEP;
use crate::accuracy::{Choice, MeshErrors, Method, choices};
use crate::input::fraction::{RELATIVE_ERROR, relative_error};
use crate::input::keys;
use crate::input::value::brief_number;
use crate::job::point::Point;
use crate::platform::error::{Error, Result};
use crate::print::legend::three_meshes;
use crate::study::{Study, features};
use billow_solver::scene::ModelKind;

/// What the plan says of the accuracy that the option asks for; nothing without it.
///
/// # Errors
/// An option that is no relative error.
pub(super) fn advice(study: &Study, accuracy: Option<&str>) -> Result<Vec<String>> {
    let Some(text) = accuracy else { return Ok(Vec::new()) };
    let error = relative_error(text).ok_or_else(|| {
        Error::invalid_option("--accuracy", text, "not a relative error", RELATIVE_ERROR, "")
    })?;
    let table = MeshErrors::shipped();
    let scenes: Vec<_> = study.points().iter().filter_map(features).collect();
    if study.has_mesh() {
        let why = "the table of mesh errors has folded capsules alone";
        return Ok(vec![format!("advice: none: {why}; {}", hint(study))]);
    }
    let choices = match choices(table, &scenes) {
        Ok(choices) if choices.is_empty() => {
            return Ok(vec![format!(
                "advice: none: no runs of such scenes are known; {}",
                hint(study)
            )]);
        }
        Ok(choices) => choices,
        Err(gap) => return Ok(vec![format!("advice: none: {gap}; {}", hint(study))]),
    };
    let mut lines = vec![recommendation(study, &choices, error)];
    let mut refused: Vec<(&'static str, &str)> = choices
        .iter()
        .filter_map(|choice| {
            Some((keys::model(choice.method.model).name, choice.refusal.as_deref()?))
        })
        .collect();
    refused.dedup();
    lines.extend(
        refused.iter().map(|(model, why)| format!("{model} cannot compute these scenes: {why}")),
    );
    Ok(lines)
}

/// The cheapest method that keeps an error, with its errors, its saving and how to set it.
fn recommendation(study: &Study, choices: &[Choice], error: f64) -> String {
    let asked = format!("{} % of times, energy and final state", brief_number(100.0 * error));
    let Some(choice) = choices.iter().find(|choice| choice.keeps(error)) else {
        let possible = choices.iter().filter(|choice| choice.refusal.is_none());
        let largest = |choice: &Choice| choice.asked().fold(0.0, f64::max);
        let best = possible.min_by(|a, b| largest(a).total_cmp(&largest(b)));
        let best = best.map_or_else(String::new, |best| {
            format!(
                "; {} has the smallest errors: {}",
                best.method.name(),
                best.errors_text(study.result_limits())
            )
        });
        return format!("advice: none: no method keeps {asked}{best}");
    };
    let method = &choice.method;
    let locks = if method.meshes.is_empty() {
        "; it has no contact of film and cannot lock: it estimates times and speeds only"
    } else {
        ""
    };
    format!(
        "advice: {} keeps {asked} in 19 of 20 runs ({}; {}): {}; at solver.cfl {STEP} alone{locks}",
        method.name(),
        choice.errors_text(study.result_limits()),
        saving(study, choice.cost),
        setting(method, study),
    )
}

/// What to do where the table does not cover a study.
fn hint(study: &Study) -> String {
    let meshless = |point: &&Point| point.job.scene.solver.model != ModelKind::Film;
    match study.points().iter().find(meshless) {
        None => {
            let search = study.searched();
            let values = search.map_or_else(String::new, |(parameter, _)| {
                format!(", and a list of values of {parameter} instead of bisect")
            });
            format!(
                "run some points with {THREE_MESHES}{values}: the errors in their rows follow from the three runs, \
                 without the table",
                THREE_MESHES = three_meshes(study.has_mesh())
            )
        }
        Some(point) => {
            let model = keys::model(point.job.scene.solver.model).name;
            format!(
                "run one point with \"grid\": {{\"model\": [\"film\", \"{model}\"]}} and compare the two: \
                 billow compare STUDY --by model --base film"
            )
        }
    }
}

/// The cost of a method over that of the study as it stands.
fn saving(study: &Study, cost_of_method: f64) -> String {
    let points = study.points();
    // A point runs on each of its meshes.
    let meshes = study.meshes();
    let runs_of_one = if meshes.of_pilots { 1 } else { meshes.list.len().max(1) } as f64;
    let all: f64 = points.iter().map(|point| cost(&Method::of(&point.job.scene))).sum();
    let now = all * runs_of_one / points.len().max(1) as f64;
    if cost_of_method < now {
        format!("{:.1} times cheaper than now", now / cost_of_method)
    } else {
        format!("{:.1} times the cost of now", cost_of_method / now)
    }
}

/// What a study file must have for a method; the model only where a point has another.
fn setting(method: &Method, study: &Study) -> String {
    let mut solver = Vec::new();
    if study.points().iter().any(|point| point.job.scene.solver.model != method.model) {
        solver.push(format!("\"model\": \"{}\"", keys::model(method.model).name));
    }
    if method.meshes.len() > 1 {
        let meshes: Vec<String> = method.meshes.iter().map(ToString::to_string).collect();
        solver.push(format!("\"meshes\": [{}]", meshes.join(", ")));
    }
    let mut sections = Vec::new();
    if !solver.is_empty() {
        sections.push(format!("\"solver\": {{{}}}", solver.join(", ")));
    }
    if let [n] = method.meshes[..] {
        sections.push(format!("\"design\": {{\"subdivisions\": {n}}}"));
    }
    if sections.is_empty() { "as it is".to_owned() } else { sections.join(", ") }
}
