//! The table of remedies: what is applied, what is proposed, and in which order.

use billow_solver::integrators::dormand_prince::DEFAULT_TOLERANCE;
use billow_solver::output::outcome::{AuditKind, FailureKind};
use billow_solver::scene::{IntegratorKind, ModelKind, Solver, Stepping};

use super::*;
use crate::job::Status;
use crate::job::row::{Cells, ColumnId};

/// Settings of a film model.
fn film(integrator: IntegratorKind, cfl: f64) -> Solver {
    Solver {
        model: ModelKind::Film,
        end_time: 1.0,
        integrator,
        stepping: Stepping::Stable(cfl),
        step_limit: 1000,
    }
}

fn failure(kind: FailureKind) -> Failure {
    Failure {
        status: Status::Failed(kind),
        audit: None,
        steps: Some(500),
        hardly_moved: false,
        numerically_damped: false,
    }
}

fn changes_of(failure: &Failure, solver: &Solver) -> Vec<Change> {
    remedies(failure, solver).applicable.iter().map(|remedy| remedy.change).collect()
}

#[test]
fn explicit_steps_become_smaller_where_a_smaller_step_helps() {
    for integrator in [IntegratorKind::Explicit, IntegratorKind::Hybrid] {
        let solver = film(integrator, 0.9);
        for kind in FailureKind::ALL {
            let helps = [FailureKind::Unstable, FailureKind::EnergyDrift].contains(&kind);
            let expected = if helps { vec![Change::Cfl(0.45)] } else { Vec::new() };
            assert_eq!(changes_of(&failure(kind), &solver), expected, "{kind:?}");
        }
    }
    // The gas is stepped in closed form: no step makes its balance better.
    let gas = Failure { audit: Some(AuditKind::GasBalance), ..failure(FailureKind::EnergyDrift) };
    assert!(changes_of(&gas, &film(IntegratorKind::Explicit, 0.9)).is_empty());
}

#[test]
fn other_integrators_are_replaced() {
    let explicit = Change::Integrator(IntegratorKind::Explicit);
    let hybrid = Change::Integrator(IntegratorKind::Hybrid);
    for kind in FailureKind::ALL {
        let implicit = film(IntegratorKind::Implicit, 0.45);
        let expected =
            if kind == FailureKind::StepLimit { vec![hybrid, explicit] } else { vec![explicit] };
        assert_eq!(changes_of(&failure(kind), &implicit), expected, "{kind:?}");
        let xpbd = film(IntegratorKind::Xpbd, 0.45);
        assert_eq!(changes_of(&failure(kind), &xpbd), [explicit], "{kind:?}");
    }
}

#[test]
fn only_a_fixed_step_of_the_models_without_film_has_a_remedy() {
    for kind in FailureKind::ALL {
        let of =
            |model, stepping| Solver { model, stepping, ..film(IntegratorKind::Explicit, 0.9) };
        let fixed = of(ModelKind::Piston, Stepping::Fixed(1e-3));
        let adaptive = Change::Adaptive(DEFAULT_TOLERANCE);
        assert_eq!(changes_of(&failure(kind), &fixed), [adaptive], "{kind:?}");
        let controlled = of(ModelKind::Piston, Stepping::Adaptive(1e-6));
        assert!(changes_of(&failure(kind), &controlled).is_empty(), "{kind:?}");
        let storeys = of(ModelKind::Storeys, Stepping::Stable(0.9));
        assert!(changes_of(&failure(kind), &storeys).is_empty(), "{kind:?}");
        assert!(remedies(&failure(kind), &storeys).proposed[0].contains("film"), "{kind:?}");
    }
}

#[test]
fn a_run_that_used_its_steps_or_hardly_moved_has_no_remedy_but_a_proposal() {
    for integrator in IntegratorKind::ALL {
        let solver = film(integrator, 0.45);
        for (steps, proposal) in [(Some(1000), "solver.step_limit"), (None, "job_limits.steps")] {
            let used = Failure { steps, ..failure(FailureKind::StepLimit) };
            let Remedies { applicable, proposed } = remedies(&used, &solver);
            assert!(applicable.is_empty() && proposed[0].contains(proposal), "{proposed:?}");
        }
        let still = Failure { hardly_moved: true, ..failure(FailureKind::EnergyDrift) };
        let Remedies { applicable, proposed } = remedies(&still, &solver);
        assert!(applicable.is_empty() && proposed[0].contains("more gas"), "{proposed:?}");
    }
}

#[test]
fn limits_and_damping_have_proposals_only() {
    let solver = film(IntegratorKind::Explicit, 0.45);
    for status in Status::all().filter(|status| !matches!(status, Status::Failed(_))) {
        let ended = Failure { status, ..failure(FailureKind::Unstable) };
        assert!(remedies(&ended, &solver).applicable.is_empty(), "{status}");
    }
    let damped = Failure {
        status: Status::Done,
        numerically_damped: true,
        ..failure(FailureKind::Unstable)
    };
    assert!(remedies(&damped, &solver).proposed[0].contains("numerical_damping"));
    let implicit = film(IntegratorKind::Implicit, 0.45);
    assert!(remedies(&damped, &implicit).proposed[0].contains("explicit"));
    let sound = Failure { numerically_damped: false, ..damped };
    assert_eq!(remedies(&sound, &solver), Remedies::default());
}

#[test]
fn the_next_remedy_is_that_of_the_last_failure_and_no_settings_are_tried_twice() {
    let drift = failure(FailureKind::EnergyDrift);
    let mut runs = vec![(film(IntegratorKind::Explicit, 0.8), drift)];
    let mut tried = Vec::new();
    while let Some((solver, _)) = next(&runs) {
        tried.push(solver.stepping);
        runs.push((solver, drift));
    }
    assert_eq!(tried, [0.4, 0.2, 0.1].map(Stepping::Stable));
    assert_eq!(tried.len(), MAX_REMEDIES);

    // Hybrid fails in another sense: its remedy comes before the second one of implicit.
    let planned = (film(IntegratorKind::Implicit, 0.8), failure(FailureKind::StepLimit));
    let second = next(&[planned]).unwrap().0;
    assert_eq!(second, film(IntegratorKind::Hybrid, 0.8));
    let third = next(&[planned, (second, drift)]).unwrap().0;
    assert_eq!(third, film(IntegratorKind::Hybrid, 0.4));
    // It shows that the film is too soft: no smaller step helps, explicit is not yet tried.
    let stretched = (third, failure(FailureKind::Overstretched));
    let last = next(&[planned, (second, drift), stretched]).unwrap().0;
    assert_eq!(last, film(IntegratorKind::Explicit, 0.8));
    assert_eq!(next(&[planned, (second, drift), stretched, (last, drift)]), None);
}

#[test]
fn changes_give_the_settings_again_and_read_like_keys() {
    let planned = film(IntegratorKind::Implicit, 0.45);
    let used = film(IntegratorKind::Explicit, 0.225);
    let made = changes(&planned, &used);
    let applied = made.iter().fold(planned, |solver, change| change.applied(&solver));
    assert_eq!(applied, used);
    let expected = "solver.integrator implicit -> explicit, solver.cfl 0.45 -> 0.225";
    assert_eq!(text(&made, &planned), expected);
    let json = serde_json::to_string(&made).unwrap();
    assert_eq!(json, r#"[{"solver.integrator":"explicit"},{"solver.cfl":0.225}]"#);
    assert_eq!(serde_json::from_str::<Vec<Change>>(&json).unwrap(), made);

    let fixed = Solver { model: ModelKind::Piston, stepping: Stepping::Fixed(1e-3), ..planned };
    let adaptive = Change::Adaptive(1e-9).applied(&fixed);
    let expected = "solver.stepping.fixed 0.001 s -> solver.stepping.adaptive 1e-9";
    assert_eq!(text(&changes(&fixed, &adaptive), &fixed), expected);
}

#[test]
fn a_failure_is_read_from_its_row() {
    let mut cells = Cells::new(Status::Failed(FailureKind::EnergyDrift));
    cells.set(ColumnId::StopAudit, AuditKind::EnergyLedger.name());
    cells.set(ColumnId::Steps, 7_i64);
    cells.set(ColumnId::PeakKineticEnergy, 4.9e-3);
    let expected = Failure {
        audit: Some(AuditKind::EnergyLedger),
        steps: Some(7),
        hardly_moved: true,
        ..failure(FailureKind::EnergyDrift)
    };
    assert_eq!(Failure::of(&cells), expected);
    // A row of an older version names no audit.
    cells.set(ColumnId::StopAudit, None::<String>);
    cells.set(ColumnId::PeakKineticEnergy, 1.0);
    assert_eq!(Failure::of(&cells), Failure { audit: None, hardly_moved: false, ..expected });
}
