//! Notes on the results of a study, on stderr: limits of the models, and keys that a model ignores.

use billow_solver::scene::ModelKind;

use crate::study::{Study, StudyPoint};

/// Keys that the piston ignores: it has no mesh, no compression or contact of the film, no imperfection,
/// and no stable step.
const PISTON_IGNORES: [&str; 8] = [
    "design.subdivisions",
    "film.compression",
    "contact.distance",
    "contact.friction",
    "contact.adhesion",
    "solver.cfl",
    "outputs.frames",
    "seed",
];
/// Keys that the film model ignores: its step is a fraction of the stable step.
const FILM_IGNORES: [&str; 2] = ["solver.stepping.adaptive", "solver.stepping.fixed"];

/// Prints the notes.
pub fn print(study: &Study) {
    for line in lines(study) {
        eprintln!("{line}");
    }
}

fn lines(study: &Study) -> Vec<String> {
    let has = |model| study.points().iter().any(|point| point.scene.solver.model == model);
    let mut lines: Vec<String> =
        study.late_windows().iter().map(|late| format!("note: {late}")).collect();
    let empty = |point: &&StudyPoint| {
        let gas = &point.scene.gas;
        gas.windows.is_empty() && gas.initial_mass <= 0.0
    };
    let without = study.points().iter().filter(empty).count();
    if without > 0 {
        lines.push(format!(
            "note: {without} of {} points have no gas and cannot deploy",
            study.points().len()
        ));
    }
    if has(ModelKind::Piston) {
        lines.push(
            "model piston: it gives times and upper bounds of speeds, not whether a capsule deploys \
             (the piston cannot lock); README, Models"
                .to_owned(),
        );
        lines.extend(ignored(study, "piston", &PISTON_IGNORES));
    }
    if has(ModelKind::Film) {
        lines.extend(ignored(study, "film", &FILM_IGNORES));
        let stiff = |point: &StudyPoint| {
            point.scene.solver.model == ModelKind::Film && point.scene.film.compression > 0.0
        };
        if study.points().iter().any(stiff) {
            lines.push(
                "note: film.compression above 0 replaces bending stiffness and its effect depends on \
                 the mesh; compare verdicts at design.subdivisions 5, 8 and 12 and several seeds"
                    .to_owned(),
            );
        }
    }
    lines
}

fn ignored(study: &Study, model: &str, keys: &[&str]) -> Option<String> {
    let ignored: Vec<&str> = study.parameter_paths().filter(|key| keys.contains(key)).collect();
    (!ignored.is_empty()).then(|| {
        format!(
            "note: the model {model} ignores {}; jobs that differ only in these keys give equal results",
            ignored.join(", ")
        )
    })
}
