//! Film of a scene with a step of any length.

use billow_solver::integrators::{FilmSimulation, SimulationSettings};
use billow_solver::models::film::{FilmRun, Rings, capsule};
use billow_solver::scene::IntegratorKind;
use billow_solver::scene::film_scene::FilmScene;
use billow_solver::scene::timeline::Timeline;

use super::Values;
use crate::cases::Rig;

/// Samples of a run.
const SAMPLES: f64 = 40.0;
/// Steps that a run may take over those of its length at the step asked for. Chosen: no method that works
/// needs more.
const MAX_STEPS: f64 = 50.0;

/// Most steps of any run. Chosen: minutes of a small scene.
const MOST_STEPS: f64 = 1e7;

/// Parts of a film.
#[derive(Default)]
pub(super) struct Parts {
    /// Factor of the modulus of each element, at most 1; empty for one material.
    pub(super) factors: Vec<f64>,
    /// Rings of a capsule.
    pub(super) rings: Option<Rings>,
}

impl Parts {
    /// The parts of a capsule.
    pub(super) fn of(rings: Rings) -> Self {
        Self { rings: Some(rings), ..Self::default() }
    }
}

/// The step that a film of a scene takes at the CFL number 1, s.
///
/// # Errors
/// What is invalid in the scene.
pub(super) fn stable_step(rig: &Rig, scene: &FilmScene) -> Result<f64, String> {
    let mut free = scene.clone();
    free.contact = None;
    free.solver.integrator = IntegratorKind::default();
    free.solver.cfl = 1.0;
    let film = rig.start(&free)?;
    Ok(film.view().next_step())
}

/// The film of a scene with an integrator and the step and contact stiffness of the values, until the end
/// time of the scene.
///
/// # Errors
/// What is invalid in the scene.
pub(super) fn prepared(
    rig: &Rig,
    mut scene: FilmScene,
    kind: IntegratorKind,
    values: &Values,
    parts: Parts,
) -> Result<(FilmRun, Timeline), String> {
    let step = values.get("step");
    let end = scene.solver.end_time;
    scene.outputs.sample_interval = end / SAMPLES;
    let shortest = stable_step(rig, &scene)? * step.min(1.0);
    let step_limit = step_limit(MAX_STEPS * (end / shortest + SAMPLES));
    scene.solver.integrator = kind;
    scene.solver.cfl = step.min(1.0);
    let film = capsule::start(&rig.on_instruction_set(&scene), &[]).map_err(|e| e.to_string())?;
    let (mut system, state, settings) = film.into_parts();
    if parts.factors.iter().any(|factor| *factor < 1.0) {
        system.model = system.model.with_stiffness(&parts.factors);
    }
    if let Some(contact) = &mut system.contact {
        contact.stiffness_per_mass *= values.get("contact_stiffness");
    }
    let settings = SimulationSettings { cfl: step, step_limit, ..settings };
    let film = FilmSimulation::new(system, settings, state.positions, state.velocities, state.gas);
    Ok((FilmRun::with(film, &scene, parts.rings), Timeline::of_film(&scene)))
}

/// A count of steps; [`MOST_STEPS`] where the stable step is not a number.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "within 1 to MOST_STEPS"
)]
fn step_limit(steps: f64) -> u64 {
    if steps.is_finite() {
        libm::ceil(steps).clamp(1.0, MOST_STEPS) as u64
    } else {
        MOST_STEPS as u64
    }
}
