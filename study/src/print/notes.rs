//! Warnings about the values of a study, and notes on its results, on stderr: limits of the models, and
//! keys that a model ignores.

use core::f64::consts::PI;
use std::collections::BTreeSet;

use billow_solver::geometry::fold::FoldPattern;
use billow_solver::integrators::{self, Refusal};
use billow_solver::scene::inflow::Schedule;
use billow_solver::scene::{Film, ModelKind, Scene};

use crate::accuracy::{MeshErrors, Method, choice};
use crate::input::keys::numerical::{MESH_PARAMETER, SEED};
use crate::input::keys::{MODELS, Model};
use crate::input::value::{Value, brief_number};
use crate::job::point::Point;
use crate::study::ground::pressure_below_ambient;
use crate::study::{Study, features};

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
    let subdivisions = study.key(MESH_PARAMETER).filter(|_| !study.meshes().is_empty());
    if let Some(given) = subdivisions.filter(|key| key.value != key.key.default_value()) {
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
    lines.extend(below_ambient(study));
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
    lines.extend(need_of_bending(study));
    lines.extend(yielding_creases(study));
    if film(|film| film.compression < 1.0 && film.bending) {
        lines.push(
            "note: film.bending with film.compression below 1: the tension field already replaces the wrinkles that \
             bending would form; set film.compression to 1"
                .to_owned(),
        );
    }
    lines
}

/// The errors of values from several meshes, or why there are none.
fn of_meshes(study: &Study) -> Option<String> {
    let meshes = study.meshes();
    let [.., next, finest] = meshes[..] else { return None };
    let method = Method { model: ModelKind::Film, meshes: vec![next, finest] };
    let scenes: Vec<_> = study.points().iter().filter_map(features).collect();
    let name = method.name();
    Some(match choice(MeshErrors::shipped(), method, &scenes) {
        Ok(choice) => format!(
            "note: solver.meshes gives the errors of {name}: {}; cost {:.1} % of n 24",
            choice.errors_text(),
            100.0 * choice.cost
        ),
        Err(gap) if study.meshes().len() == 2 => {
            format!("note: two meshes give no errors here ({gap}); three meshes do")
        }
        Err(gap) => format!("note: the table of mesh errors does not cover every point ({gap})"),
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

/// Length over which gas bends film, over the bottom radius, from which on bending may change results. Between what was
/// measured: nothing beyond the seed up to 0.035, up to a tenth of the volume from 0.07 on (`docs/experiments.md`).
const LONG_BEND: f64 = 0.05;

/// The largest length over which the gas of a scene bends its film while no gas flows in, (D/p)^(1/3), m, and over the
/// bottom radius. `None` without gas, where the ambient pressure is higher, or without a pattern.
fn bend(scene: &Scene) -> Option<[f64; 2]> {
    let pattern = FoldPattern::new(&scene.design).ok()?;
    let (gas, end) = (&scene.gas, scene.solver.end_time);
    let schedule = Schedule::new(&gas.windows);
    let times = schedule.change_times().iter().copied().filter(|time| *time > 0.0 && *time < end);
    let masses = times.chain([end]).map(|time| gas.initial_mass + schedule.mass_until(time));
    let mass = masses.filter(|mass| *mass > 0.0).reduce(f64::min)?;
    let temperature = scene.film.temperature;
    let pressure = mass * gas.species.gas_constant * temperature / pattern.erected_volume()
        - gas.ambient_pressure;
    let length = libm::cbrt(scene.film.bending_stiffness() / pressure);
    (pressure > 0.0).then(|| [length, length / pattern.ring_radius(0)])
}

/// Whether bending may change the results of film, or not.
fn need_of_bending(study: &Study) -> Option<String> {
    let scenes = study.points().iter().map(|point| &point.job.scene);
    let film: Vec<_> = scenes
        .filter(|scene| scene.solver.model == ModelKind::Film)
        .map(|scene| (&scene.film, bend(scene)))
        .collect();
    let longest = |chosen: &dyn Fn(&Film, f64) -> bool| {
        let bends =
            film.iter().filter_map(|(film, bend)| bend.filter(|bend| chosen(film, bend[1])));
        bends.max_by(|a, b| a[1].total_cmp(&b[1])).map(|[length, over_radius]| {
            format!(
                "(D/p)^(1/3) is up to {} mm, {} % of the bottom radius; in the paper's capsule bending changed nothing \
                 beyond the seed up to 3.5 %, and the volume by up to a tenth from 7 % on",
                brief_number(1e3 * length),
                brief_number(100.0 * over_radius)
            )
        })
    };
    let missing = |film: &Film, bend: f64| bend >= LONG_BEND && !film.bending;
    if let Some(size) = longest(&missing) {
        return Some(format!(
            "note: bending may change results: {size}; film.bending needs film.compression 1"
        ));
    }
    let short = |(film, bend): &(&Film, Option<[f64; 2]>)| {
        film.compression < 1.0 || bend.is_some_and(|bend| bend[1] < LONG_BEND)
    };
    let size = longest(&|film, _| film.compression >= 1.0).filter(|_| film.iter().all(short))?;
    Some(format!("note: film.bending is not needed: {size}"))
}

/// Stress at which polymer film yields, Pa: that of Kapton.
const YIELD_STRESS: f64 = 69e6;

/// A note on creases that would yield: turned by θ they stress the surface of the film by E t θ/(2 L*).
fn yielding_creases(study: &Study) -> Option<String> {
    let scenes = study.points().iter().map(|point| &point.job.scene);
    let stress = |scene: &Scene| {
        let film = &scene.film;
        film.creases.map_or(0.0, |creases| {
            let rest = creases.rest_angle.unwrap_or(PI);
            let turn = rest.max(PI - rest);
            0.5 * film.youngs_modulus * film.thickness * turn / creases.length_scale
        })
    };
    let film = scenes.filter(|scene| scene.solver.model == ModelKind::Film);
    let largest = film.map(|scene| stress(scene)).fold(0.0, f64::max);
    (largest > YIELD_STRESS).then(|| {
        format!(
            "note: creases stress the surface of the film by up to {} MPa; Kapton yields at {} MPa, and creases here do \
             not yield: choose a longer creases.length_scale",
            brief_number(1e-6 * largest),
            brief_number(1e-6 * YIELD_STRESS)
        )
    })
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
