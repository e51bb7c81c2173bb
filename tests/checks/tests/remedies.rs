//! Cells of the map of failure: what the table of remedies applies is cured, by real runs.

use billow_checks::cases::Rig;
use billow_checks::stability::Method;
use billow_checks::stability::cell::{self, Cell, Question};
use billow_checks::stability::scenes::{self, Values};
use billow_solver::output::outcome::AuditKind;
use billow_solver::scene::{IntegratorKind, ModelKind, Solver, Stepping};
use billow_study::job::Status;
use billow_study::job::remedy::{self, Failure};
use billow_study::platform::stop::Stop;

use IntegratorKind::{Explicit, Hybrid, Implicit, Xpbd};

/// Settings of film.
fn film(integrator: IntegratorKind, step: f64) -> Solver {
    let stepping = Stepping::Stable(step);
    Solver { model: ModelKind::Film, end_time: 1.0, integrator, stepping, step_limit: u64::MAX }
}

fn failure(cell: &Cell) -> Failure {
    Failure {
        status: Status::from_name(&cell.status).unwrap(),
        audit: AuditKind::ALL.into_iter().find(|kind| kind.name() == cell.audit),
        steps: Some(cell.steps),
        hardly_moved: false,
        numerically_damped: false,
    }
}

/// Runs a cell with these settings.
fn run(scene: &str, solver: &Solver, values: &[(&str, f64)]) -> Cell {
    let scene = scenes::find(scene).unwrap();
    let mut all = Values::of(scene);
    for (name, value) in values {
        all.set(name, *value);
    }
    let method = match solver.model {
        ModelKind::Film => Method::Film(solver.integrator),
        ModelKind::Piston => Method::Piston,
        ModelKind::Storeys => Method::Storeys,
    };
    match solver.stepping {
        Stepping::Stable(cfl) => all.set("step", cfl),
        Stepping::Fixed(step) => all.set("fixed_step", step),
        Stepping::Adaptive(_) => all.set("fixed_step", 0.0),
    }
    cell::run(&Rig::default(), &Question { scene, method, values: all }, &Stop::new()).unwrap()
}

/// Runs a cell, then what the table of remedies says, until a run is done or no remedy remains.
fn cured(scene: &str, planned: Solver, values: &[(&str, f64)]) -> Vec<(Solver, String)> {
    let (mut runs, mut failures) = (Vec::new(), Vec::new());
    let mut next = Some(planned);
    while let Some(solver) = next {
        let cell = run(scene, &solver, values);
        runs.push((solver, cell.status.clone()));
        if cell.is_done() {
            break;
        }
        failures.push((solver, failure(&cell)));
        next = remedy::next(&failures).map(|(solver, _)| solver);
    }
    runs
}

/// Runs that ended with one status, and a last one that is done.
fn then_done(failed: &str, solvers: &[Solver]) -> Vec<(Solver, String)> {
    let last = solvers.len() - 1;
    let status = |index| if index == last { "done" } else { failed };
    let runs = solvers.iter().enumerate();
    runs.map(|(index, solver)| (*solver, status(index).to_owned())).collect()
}

#[test]
fn gas_that_throws_film_outward_needs_one_half_of_the_step_or_two() {
    for kind in [Explicit, Hybrid] {
        for (bar, steps) in
            [(0.3, &[0.9, 0.45][..]), (0.6, &[0.9, 0.45, 0.225]), (0.6, &[0.45, 0.225])]
        {
            let solvers: Vec<Solver> = steps.iter().map(|step| film(kind, *step)).collect();
            let runs = cured("bag", solvers[0], &[("residual_pressure", bar * 1e5)]);
            assert_eq!(runs, then_done("energy_drift", &solvers), "{bar} bar");
        }
    }
}

#[test]
fn film_that_hits_film_needs_explicit_steps() {
    for values in [
        [("speed", 200.0), ("contact_stiffness", 1.0)],
        [("speed", 1000.0), ("contact_stiffness", 100.0)],
    ] {
        let planned = film(Implicit, 0.45);
        let solvers = [planned, film(Hybrid, 0.45)];
        assert_eq!(cured("films", planned, &values), then_done("step_limit", &solvers));
        let ended = failure(&run("films", &planned, &values));
        let second = remedy::remedies(&ended, &planned).applicable[1].change.applied(&planned);
        assert_eq!(second, film(Explicit, 0.45));
        assert!(run("films", &second, &values).is_done(), "{values:?}");
    }
}

#[test]
fn failures_of_xpbd_need_the_reference() {
    let planned = film(Xpbd, 0.9);
    let runs = cured("capsule", planned, &[]);
    assert_eq!(runs, then_done("unstable", &[planned, film(Explicit, 0.9)]));
}

#[test]
fn a_piston_needs_error_controlled_steps() {
    let fixed = Solver {
        model: ModelKind::Piston,
        stepping: Stepping::Fixed(2e-3),
        ..film(Explicit, 0.45)
    };
    let adaptive = Solver { stepping: Stepping::Adaptive(1e-9), ..fixed };
    assert_eq!(cured("capsule", fixed, &[]), then_done("energy_drift", &[fixed, adaptive]));
}

#[test]
fn what_no_step_can_cure_stays_a_typed_failure() {
    // No volume for the gas.
    let runs = cured("bag", film(Explicit, 0.45), &[("flatness", 0.0)]);
    assert!(runs.len() <= 1 + remedy::MAX_REMEDIES, "{runs:?}");
    assert!(runs.iter().all(|(_, status)| status != "done"), "{runs:?}");
    // Film in one plane has no side.
    let runs = cured("films", film(Explicit, 0.45), &[("gap", 0.0), ("speed", 5.0)]);
    assert_eq!(runs, [(film(Explicit, 0.45), "interpenetrated".to_owned())]);
}
