//! What a reader should know of a study's answers, said on stderr beside them.

use billow_solver::scene::ModelKind;

use crate::study::Study;

/// Keys that decide nothing on the piston: it has no mesh, no film that can be compressed or touch
/// itself, no imperfection, and no stable step.
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
/// Keys that decide nothing on the film: its step is a share of the stable one.
const FILM_IGNORES: [&str; 2] = ["solver.stepping.adaptive", "solver.stepping.fixed"];

/// Says what the models' answers are worth, and which axes they ignore.
pub fn print(study: &Study) {
    for line in lines(study) {
        eprintln!("{line}");
    }
}

fn lines(study: &Study) -> Vec<String> {
    let has = |model| study.points().iter().any(|point| point.scene.solver.model == model);
    let mut lines: Vec<String> =
        study.late_windows().iter().map(|late| format!("note: {late}")).collect();
    let empty = |point: &&crate::study::StudyPoint| {
        let gas = &point.scene.gas;
        gas.windows.is_empty() && gas.initial_mass <= 0.0
    };
    let without = study.points().iter().filter(empty).count();
    if without > 0 {
        lines.push(format!(
            "note: {without} of {} points have no gas at all; nothing deploys them",
            study.points().len()
        ));
    }
    if has(ModelKind::Piston) {
        lines.push(
            "model piston: how fast, not whether (it cannot lock, its speeds are upper bounds); \
             README, Models"
                .to_owned(),
        );
        lines.extend(ignored(study, "piston", &PISTON_IGNORES));
    }
    if has(ModelKind::Film) {
        lines.extend(ignored(study, "film", &FILM_IGNORES));
        let stiff = |point: &crate::study::StudyPoint| {
            point.scene.solver.model == ModelKind::Film && point.scene.film.compression > 0.0
        };
        if study.points().iter().any(stiff) {
            lines.push(
                "note: film.compression above 0 is a stand-in for bending whose effect depends on \
                 the mesh; compare verdicts at design.subdivisions 5, 8 and 12, over several seeds"
                    .to_owned(),
            );
        }
    }
    lines
}

fn ignored(study: &Study, model: &str, keys: &[&str]) -> Option<String> {
    let ignored: Vec<&str> = study.parameter_paths().filter(|path| keys.contains(path)).collect();
    (!ignored.is_empty()).then(|| {
        format!(
            "note: the model {model} ignores {}; jobs that differ in nothing else give equal results",
            ignored.join(", ")
        )
    })
}
