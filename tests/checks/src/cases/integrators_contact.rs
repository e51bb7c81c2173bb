//! Folded film with the integrators that must let no film pass: the first tenth of a second, every step monitored.
//!
//! ```text
//! passages = intersections = 0        monitored steps = accepted steps > 0        status: done; implicit: or step_limit
//! ```
//!
//! `implicit` may give up in a burst of packed film, where its steps would become too short. What it did until then counts.

use billow_solver::integrators::entry;
use billow_solver::models::run::{self, Unobserved};
use billow_solver::output::outcome::{FailureKind, Stop};
use billow_solver::scene::film_scene::FilmContact;
use billow_solver::scene::monitor_settings::MonitorSettings;
use billow_solver::scene::timeline::Timeline;
use billow_solver::scene::{IntegratorKind, ModelKind, paper};

use super::contact_capsule::stowed;
use super::row::worse;
use super::{Outcome, Rig, Row};

/// Simulated time, s.
const END: f64 = 0.1;
/// The integrators whose film must not pass through film.
const KINDS: [IntegratorKind; 3] =
    [IntegratorKind::Explicit, IntegratorKind::Implicit, IntegratorKind::Hybrid];

/// The paper's capsule at n 2.
pub(super) fn coarse(rig: &Rig) -> Outcome {
    every_step(rig, 2)
}

/// The same at n 4.
pub(super) fn fine(rig: &Rig) -> Outcome {
    every_step(rig, 4)
}

/// Tension field and full membrane stiffness, with each integrator.
fn every_step(rig: &Rig, subdivisions: u32) -> Outcome {
    let mut judged = Vec::new();
    for compression in [0.0, 1.0] {
        for kind in KINDS {
            judged.extend(rows(rig, subdivisions, kind, compression)?);
        }
    }
    Ok(judged)
}

fn rows(rig: &Rig, subdivisions: u32, kind: IntegratorKind, compression: f64) -> Outcome {
    let mut scene = paper::capsule(subdivisions, END);
    scene.film.compression = compression;
    (scene.solver.model, scene.solver.integrator) = (ModelKind::Film, kind);
    let monitor = MonitorSettings::EVERY_STEP;
    let mut run = stowed(rig, &scene, FilmContact { monitor, ..FilmContact::default() })?;
    run.film = rig.faulty(run.film);
    let deployment = run::run(&mut run, &Timeline::new(&scene), &mut Unobserved);
    let status = match &deployment.stop {
        Stop::Done => "done".to_owned(),
        Stop::Failed(failure)
            if kind == IntegratorKind::Implicit && failure.kind == FailureKind::StepLimit =>
        {
            format!("{} at {:.4} s", failure.kind.name(), failure.time)
        }
        Stop::Failed(failure) => {
            return Err(format!(
                "{}, c {compression}: {} at {} s: {}",
                entry(kind).name,
                failure.kind.name(),
                failure.time,
                failure.place
            ));
        }
        Stop::Cancelled => return Err("cancelled".to_owned()),
    };
    let view = run.film.view();
    let count = |counted: Option<u64>| counted.map_or(f64::NAN, |counted| counted as f64);
    let samples = deployment.history.column("intersections").iter().copied().fold(0.0, worse);
    let name = |quantity: &str| format!("{}, c {compression}: {quantity}", entry(kind).name);
    // At least one step, or the zeros below say nothing.
    let steps = (deployment.steps as f64).max(1.0);
    Ok(vec![
        Row::at_least(&name("monitored steps"), count(view.tested_steps()), steps)
            .with_note(&status),
        Row::at_most(&name("passages"), count(view.passages()), 0.0),
        Row::at_most(&name("intersections"), worse(samples, count(view.intersections())), 0.0),
    ])
}
