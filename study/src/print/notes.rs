//! Warnings about the values of a study, and notes on its results, on stderr: limits of the models, and
//! keys that a model ignores.

use std::collections::BTreeSet;

use billow_solver::integrators::{self, Refusal};
use billow_solver::scene::{Film, ModelKind, Scene};

use super::legend::three_meshes;
use crate::accuracy::row::{OF_CAPSULES, OF_FILM, has_error};
use crate::accuracy::{Features, MeshErrors, Method, PROMISED, choice};
use crate::analysis::answer::samples_needed;
use crate::input::keys::numerical::{MESH_PARAMETER, SEED};
use crate::input::keys::{MODELS, Model};
use crate::input::value::{Value, brief_number};
use crate::job::point::Point;
use crate::job::row::ColumnId;
use crate::job::surroundings::Surroundings;
use crate::print::count;
use crate::study::ground::pressure_below_ambient;
use crate::study::{Meshes, Study, features, meshes_text};

mod bending;

/// Prints the warnings about values of the study: before anything runs.
pub fn print_warnings(study: &Study) {
    for line in study.warnings() {
        eprintln!("{line}");
    }
}

/// Prints the notes on the file and on the points of the study.
pub fn print(study: &Study) {
    for note in study.notes() {
        eprintln!("note: {note}");
    }
    for line in of_points(study) {
        eprintln!("{line}");
    }
}

fn of_points(study: &Study) -> Vec<String> {
    let has = |model| study.points().iter().any(|point| point.job.scene.solver.model == model);
    let mut lines: Vec<String> = Vec::new();
    lines.extend(of_meshes(study));
    lines.extend(without_error(study));
    lines.extend(limits_without_error(study));
    let given = |meshes: Meshes| !meshes.list.is_empty() && !meshes.of_pilots;
    let subdivisions = study.key(MESH_PARAMETER).filter(|_| given(study.meshes()));
    if let Some(given) = subdivisions.filter(|key| {
        let default = if study.has_mesh() { Value::Integer(1) } else { key.key.default_value() };
        key.value != default
    }) {
        lines.push(format!("note: solver.meshes replaces design.subdivisions {}", given.value));
    }
    let empty = |point: &&Point| {
        let gas = &point.job.scene.gas;
        gas.windows.is_empty() && gas.initial_mass <= 0.0
    };
    let without = study.points().iter().filter(empty).count();
    if without > 0 {
        lines.push(format!(
            "note: {without} of {} points have no gas and cannot deploy",
            study.points().len()
        ));
    }
    lines.extend(without_imperfection(study));
    lines.extend(below_ambient(study));
    lines.extend(air_outside(study));
    lines.extend(refused_by_integrators(study));
    lines.extend(
        MODELS.iter().filter(|model| has(model.kind)).filter_map(|model| ignored(study, model)),
    );
    for (model, gives) in [
        (ModelKind::Piston, "model piston: it gives times and upper bounds of speeds"),
        (ModelKind::Storeys, "model storeys: it gives times and speeds"),
    ] {
        if has(model) {
            let not = "not whether a capsule deploys (it cannot lock); README, Models";
            lines.push(format!("{gives}, {not}"));
        }
    }
    let film = |of: fn(&Film) -> bool| {
        let is = |point: &Point| {
            point.job.scene.solver.model == ModelKind::Film && of(&point.job.scene.film)
        };
        study.points().iter().any(is)
    };
    if film(|film| film.compression > 0.0) {
        lines.push(
            "note: film.compression above 0 folds more easily on finer meshes: a capsule that stalls may deploy on a \
             finer mesh; compare design.subdivisions 8, 12 and 16 and several seeds"
                .to_owned(),
        );
    }
    lines.extend(single_runs(study));
    lines.extend(few_samples(study));
    lines.extend(bending::need(study));
    lines.extend(bending::yielding_creases(study));
    if film(|film| film.compression < 1.0 && film.bending) {
        lines.push(
            "note: film.bending with film.compression below 1: the tension field already replaces the wrinkles that \
             bending would form; set film.compression to 1"
                .to_owned(),
        );
    }
    lines
}

/// A warning of a search of film of which one run decides each value.
fn single_runs(study: &Study) -> Option<String> {
    if study.replicate_count() > 1 || !seed_matters(Some(study)) {
        return None;
    }
    if study.budget().is_some() {
        let text = "warning: one run stands for each point, and the smallest of single runs is partly luck; \
                    \"replicates\": {\"seed\": 5} repeats each point";
        return Some(text.to_owned());
    }
    study.searched().map(|(parameter, _)| {
        format!(
            "warning: one run decides each value of {parameter}, and another seed may move the border; \
             \"replicates\": {{\"seed\": 5}} repeats each value"
        )
    })
}

/// Samples too few for what each input makes.
fn few_samples(study: &Study) -> Option<String> {
    let (inputs, samples) = (study.sampled().len(), study.sample_count());
    let needed = samples_needed(inputs);
    (inputs > 0 && samples < needed).then(|| {
        let inputs = count(inputs, "input");
        format!("note: {samples} samples of {inputs}: the answer does not say what each input makes; it needs at least {needed}")
    })
}

/// Film from a mesh that starts as its file has it: often more even than any real one.
fn without_imperfection(study: &Study) -> Option<String> {
    let even = study.points().iter().all(|point| point.job.scene.seed == 0);
    (study.has_mesh() && even).then(|| {
        "note: the film starts as its file has it, without imperfection, and no error counts that; \"replicates\": \
         {\"seed\": 3} shows how much small differences change"
            .to_owned()
    })
}

/// The errors of values from several meshes, or why there are none.
fn of_meshes(study: &Study) -> Option<String> {
    let meshes = study.meshes();
    let [.., next, finest] = meshes.list[..] else { return None };
    if meshes.of_pilots {
        return None;
    }
    if meshes.of_file {
        return Some(format!(
            "note: each point has the values of n {finest}, with an error from n {} (grid convergence index)",
            meshes_text(&meshes.list)
        ));
    }
    let method = Method { model: ModelKind::Film, meshes: vec![next, finest] };
    let scenes: Vec<_> = study.points().iter().filter_map(features).collect();
    let name = method.name();
    Some(match choice(MeshErrors::shipped(), method, &scenes) {
        Ok(choice) => format!(
            "note: solver.meshes gives the errors of {name}: {}; cost {:.1} % of n 24",
            choice.errors_text(study.result_limits()),
            100.0 * choice.cost
        ),
        Err(gap) if meshes.list.len() == 2 => {
            format!("note: two meshes give no errors here ({gap}); three meshes do")
        }
        Err(gap) => format!("note: the table of mesh errors does not cover every point ({gap})"),
    })
}

/// Whether the mesh errors of points of one mesh are known; if not, why not and what follows.
fn without_error(study: &Study) -> Option<String> {
    let table = MeshErrors::shipped();
    let gap = |(scene, features): (&Scene, Features)| {
        let method = Method::of(scene);
        match method.model {
            ModelKind::Film => table.gap(scene, &features),
            _ => Some(format!("{OF_FILM}, not of {}", method.name())),
        }
    };
    let meshes = study.meshes();
    let points = study.points().iter().filter(|_| meshes.list.is_empty() || meshes.of_pilots);
    let mut points = points.peekable();
    points.peek()?;
    let found = if study.has_mesh() {
        Some(OF_CAPSULES.to_owned())
    } else {
        let mut points = points.filter_map(features).peekable();
        points.peek()?;
        points.find_map(gap)
    };
    let Some(gap) = found else {
        return Some("mesh error: known at each point, from the table of mesh errors".to_owned());
    };
    let known = format!("note: the mesh error of some points is not known ({gap})");
    if meshes.of_pilots {
        let meshes = meshes_text(&meshes.list);
        return Some(format!(
            "{known}; pilots give one in the end: n {meshes} of {}",
            study.pilots_are()
        ));
    }
    let limits = match study.result_limits() {
        [] => "",
        _ => "; no limit is met for certain there",
    };
    let mut points = study.points().iter();
    let remedy = if points.all(|point| point.job.scene.solver.model == ModelKind::Film) {
        three_meshes(study.has_mesh())
    } else {
        "\"solver\": {\"model\": \"film\"}"
    };
    Some(format!("{known}{limits}; {remedy} gives one"))
}

/// Limits on measures of which no error is known, whatever the scene.
fn limits_without_error(study: &Study) -> Option<String> {
    let limits = study.result_limits().iter().map(|limit| limit.measure);
    let without: Vec<&str> =
        limits.filter(|measure| !has_error(*measure)).map(ColumnId::name).collect();
    (!without.is_empty()).then(|| {
        let known: Vec<&str> = PROMISED.iter().map(|promised| promised.measure.name()).collect();
        format!(
            "note: the error of {} is not known on any mesh, so no limit on it is met for certain; it is known of {}",
            without.join(", "),
            known.join(", ")
        )
    })
}

/// A note on capsules whose gas has less than ambient pressure at the start.
fn below_ambient(study: &Study) -> Option<String> {
    let below = study.points().iter().filter_map(|point| pressure_below_ambient(&point.job.scene));
    let (count, smallest) =
        below.fold((0, f64::INFINITY), |(count, least), p| (count + 1, f64::min(least, p)));
    (count > 0).then(|| {
        format!(
            "note: {count} of {} points start with gas at {} Pa or more, below gas.ambient_pressure, which presses \
             the capsule together; residual_gas ambient fills the folds at ambient pressure",
            study.points().len(),
            brief_number(smallest)
        )
    })
}

/// What the air around the film does that no model has, at the point where it does most.
fn air_outside(study: &Study) -> Vec<String> {
    let outside = study
        .points()
        .iter()
        .filter_map(|point| Surroundings::of_scene(&point.job.scene, point.solved.as_ref()));
    let most =
        outside.fold(Surroundings { lift: 0.0, moved_mass: 0.0 }, |most, one| Surroundings {
            lift: most.lift.max(one.lift),
            moved_mass: most.moved_mass.max(one.moved_mass),
        });
    most.notes().into_iter().map(|note| format!("note: {note}")).collect()
}

/// A note on points with friction whose integrator has none: each ends as invalid.
fn refused_by_integrators(study: &Study) -> Option<String> {
    let refusal = |point: &Point| {
        let (solver, contact) = (&point.job.scene.solver, &point.job.scene.contact);
        let entry =
            (solver.model == ModelKind::Film).then(|| integrators::entry(solver.integrator))?;
        let Refusal { unknown, allowed } = entry.refuses_friction(contact.friction)?;
        Some((format!("{} has no {unknown}", entry.name), allowed))
    };
    let refused: Vec<(String, &str)> = study.points().iter().filter_map(refusal).collect();
    let reasons: BTreeSet<&str> = refused.iter().map(|(reason, _)| reason.as_str()).collect();
    let allowed: BTreeSet<&str> = refused.iter().map(|(_, allowed)| *allowed).collect();
    let list = |texts: BTreeSet<&str>| texts.into_iter().collect::<Vec<_>>().join(", ");
    (!refused.is_empty()).then(|| {
        format!(
            "note: {} of {} points will end as invalid: {}\n  next: {}, or solver.integrator explicit",
            refused.len(),
            study.points().len(),
            list(reasons),
            list(allowed)
        )
    })
}

/// Whether the seed of a study changes its results: `false` for a study of one model that ignores it.
pub fn seed_matters(study: Option<&Study>) -> bool {
    let model = study.and_then(|study| {
        let key = study.key("solver.model")?;
        let varies = study.parameter_names().contains(&key.name);
        MODELS.iter().find(|model| !varies && key.value == Value::Text(model.name.to_owned()))
    });
    model.is_none_or(|model| !model.ignores.contains(&SEED))
}

fn ignored(study: &Study, model: &Model) -> Option<String> {
    let ignored: Vec<&str> =
        study.parameter_paths().filter(|path| model.ignores.contains(path)).collect();
    (!ignored.is_empty()).then(|| {
        format!(
            "note: the model {} ignores {}; jobs that differ in nothing else give equal results",
            model.name,
            ignored.join(", ")
        )
    })
}
