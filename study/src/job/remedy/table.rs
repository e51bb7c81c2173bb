//! The table of remedies.

use billow_solver::integrators::dormand_prince::DEFAULT_TOLERANCE;
use billow_solver::output::outcome::{AuditKind, FailureKind};
use billow_solver::scene::{IntegratorKind, ModelKind, Solver, Stepping};

use super::{CFL_FACTOR, Change, Failure, Remedies, Remedy};
use crate::job::Status;

const SMALLER_STEP: &str =
    "a step of half the length resolves film that gas throws outward within one step";
const HYBRID: &str =
    "hybrid takes explicit steps where film hits film; the implicit method finds no step there";
const EXPLICIT: &str =
    "explicit steps bear film that hits film; the implicit method finds no step there";
const REFERENCE: &str =
    "explicit is the reference; it bears contact and stiff film that this integrator does not";
const ADAPTIVE: &str =
    "steps that follow their error are short where the fixed step is too long for the piston";

const MORE_LOSS: &str = "more loss (film.loss_factor, film.numerical_damping); it damps the motion";
const FINER_MESH: &str =
    "a finer mesh (design.subdivisions); it moves film in more detail, and costs more";
const STRETCH: &str = "less stretch: check film.youngs_modulus, film.thickness and the gas (gas.mass_flow_rate, \
                       gas.residual_gas_mass, solver.end_time); pressure times radius over E t is the strain";
const GAS: &str = "more gas before solver.end_time: gas.mass_flow_rate and the inflow windows of the strategy; their \
                   times count from the start of the run";
const FILM_MODEL: &str = "solver.model film: it bears gas supplies that storeys does not";
const START_VOLUME: &str =
    "a volume for the gas at the start: design.stowed_height, gas.residual_gas_mass";
const APART: &str =
    "layers farther apart at the start: design.stowed_height; film in one plane has no side";
const STEP_LIMIT: &str = "more steps: solver.step_limit";
const JOB_STEPS: &str = "more steps: job_limits.steps; the job resumes from its checkpoint";
const WALL_TIME: &str =
    "more time: job_limits.wall_time; the job resumes from its checkpoint, if it has one";
const MEMORY: &str =
    "a coarser mesh (design.subdivisions), more memory, or a larger job_limits.memory";
const LESS_DAMPING: &str = "less numerical damping: a smaller film.numerical_damping or solver.cfl";
const LESS_DAMPED_METHOD: &str =
    "solver.integrator explicit: it takes less energy than this integrator";

/// What can be done about a failure of a run with these settings.
pub fn remedies(failure: &Failure, solver: &Solver) -> Remedies {
    Remedies { applicable: applicable(failure, solver), proposed: proposed(failure, solver) }
}

/// Changes that leave the physics alone, the best first.
fn applicable(failure: &Failure, solver: &Solver) -> Vec<Remedy> {
    let Status::Failed(kind) = failure.status else { return Vec::new() };
    if failure.is_without_motion() || failure.used_all_steps(solver) {
        return Vec::new();
    }
    match solver.model {
        ModelKind::Film => of_film(kind, failure, solver),
        ModelKind::Piston => match solver.stepping {
            Stepping::Fixed(_) => {
                vec![Remedy { change: Change::Adaptive(DEFAULT_TOLERANCE), reason: ADAPTIVE }]
            }
            Stepping::Adaptive(_) | Stepping::Stable(_) => Vec::new(),
        },
        // A smaller step fails alike: the model itself does not bear such gas.
        ModelKind::Storeys => Vec::new(),
    }
}

/// Changes for film, the best first.
fn of_film(kind: FailureKind, failure: &Failure, solver: &Solver) -> Vec<Remedy> {
    let integrator = |kind, reason| Remedy { change: Change::Integrator(kind), reason };
    let explicit = |reason| integrator(IntegratorKind::Explicit, reason);
    match solver.integrator {
        IntegratorKind::Implicit if kind == FailureKind::StepLimit => {
            vec![integrator(IntegratorKind::Hybrid, HYBRID), explicit(EXPLICIT)]
        }
        IntegratorKind::Implicit | IntegratorKind::Xpbd => vec![explicit(REFERENCE)],
        IntegratorKind::Explicit | IntegratorKind::Hybrid => {
            // The gas takes its step in closed form: no smaller step makes its balance better.
            let is_of_film = failure.audit != Some(AuditKind::GasBalance);
            let drift = kind == FailureKind::EnergyDrift && is_of_film;
            match solver.stepping {
                Stepping::Stable(cfl) if drift || kind == FailureKind::Unstable => {
                    let change = Change::Cfl(CFL_FACTOR * cfl);
                    vec![Remedy { change, reason: SMALLER_STEP }]
                }
                Stepping::Stable(_) | Stepping::Adaptive(_) | Stepping::Fixed(_) => Vec::new(),
            }
        }
    }
}

/// What only the user can decide.
fn proposed(failure: &Failure, solver: &Solver) -> Vec<&'static str> {
    let is_film = solver.model == ModelKind::Film;
    let explicit = matches!(solver.integrator, IntegratorKind::Explicit | IntegratorKind::Hybrid);
    match failure.status {
        _ if failure.is_without_motion() => vec![GAS],
        Status::Done if failure.numerically_damped && is_film && !explicit => {
            vec![LESS_DAMPED_METHOD, FINER_MESH]
        }
        Status::Done if failure.numerically_damped => vec![LESS_DAMPING, FINER_MESH],
        Status::Failed(FailureKind::Overstretched) => vec![STRETCH],
        Status::Failed(FailureKind::StepLimit) if failure.used_all_steps(solver) => {
            vec![if failure.steps.is_some() { STEP_LIMIT } else { JOB_STEPS }]
        }
        Status::Failed(_) if solver.model == ModelKind::Storeys => vec![FILM_MODEL],
        // It was stretched far beyond its material model, and a smaller step shows it as overstretched.
        Status::Failed(FailureKind::Unstable) if failure.audit == Some(AuditKind::Stretch) => {
            vec![STRETCH]
        }
        Status::Failed(FailureKind::Unstable | FailureKind::EnergyDrift) if is_film => {
            vec![MORE_LOSS, FINER_MESH]
        }
        Status::Failed(FailureKind::InvertedVolume) if is_film => vec![START_VOLUME],
        Status::Failed(FailureKind::Interpenetrated) if is_film => vec![APART],
        Status::Timeout => vec![WALL_TIME],
        Status::OutOfMemory => vec![MEMORY],
        Status::Failed(_)
        | Status::Done
        | Status::Pending
        | Status::Infeasible
        | Status::Invalid
        | Status::Panicked
        | Status::Crashed
        | Status::Cancelled
        | Status::Paused
        | Status::NoEquilibrium => Vec::new(),
    }
}
