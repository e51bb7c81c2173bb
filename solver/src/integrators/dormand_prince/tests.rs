use super::*;
use crate::output::outcome::FailureKind;

/// A mass under gravity above a floor that acts as a stiff spring; state z, v. Branch: whether the mass
/// touches the floor.
struct Bouncer {
    stiffness: f64,
}

impl System<2> for Bouncer {
    type Branch = bool;
    const GROUPS: [usize; 2] = [0, 1];

    fn rates(&self, touching: bool, y: &[f64; 2]) -> [f64; 2] {
        [y[1], -9.81 - if touching { self.stiffness * y[0] } else { 0.0 }]
    }

    fn margin(&self, touching: bool, y: &[f64; 2]) -> f64 {
        if touching { -y[0] } else { y[0] }
    }

    fn next_branch(&self, touching: bool, _: &[f64; 2]) -> bool {
        !touching
    }

    fn check(&self, y: &[f64; 2]) -> Result<(), (AuditKind, &'static str)> {
        if y[0] > -1.0 { Ok(()) } else { Err((AuditKind::Volume, "the floor")) }
    }
}

fn energy(system: &Bouncer, y: &[f64; 2]) -> f64 {
    let depth = y[0].min(0.0);
    0.5 * y[1] * y[1] + 9.81 * y[0] + 0.5 * system.stiffness * depth * depth
}

fn run(stepping: Stepping, end: f64) -> (Integrator<2, bool>, Bouncer) {
    let system = Bouncer { stiffness: 1e4 };
    let mut integrator = Integrator::new(0.0, [0.5, 1.0], false, [0.0; 2]);
    let control = Control { stepping, step_limit: 1_000_000 };
    integrator.advance(&system, end, &control, &mut |_| ()).unwrap();
    assert_eq!(integrator.time, end);
    (integrator, system)
}

#[test]
fn bounces_conserve_energy() {
    let (end, system) = run(Stepping::Adaptive(1e-10), 10.0);
    let drift = energy(&system, &end.state) / energy(&system, &[0.5, 1.0]) - 1.0;
    assert!(drift.abs() < 1e-7, "{drift:e}");
}

#[test]
fn a_kink_does_not_reduce_the_order() {
    let (reference, _) = run(Stepping::Adaptive(1e-13), 1.3);
    let error = |dt: f64| {
        let (end, _) = run(Stepping::Fixed(dt), 1.3);
        (end.state[0] - reference.state[0]).abs()
    };
    let (coarse, fine) = (error(2e-3), error(1e-3));
    let order = libm::log2(coarse / fine);
    assert!(order > 4.5 && fine < 1e-7, "order {order}, errors {coarse:e} {fine:e}");
}

#[test]
fn the_tolerance_bounds_the_error() {
    let (reference, _) = run(Stepping::Adaptive(1e-13), 1.3);
    let error = |tolerance| {
        let (end, _) = run(Stepping::Adaptive(tolerance), 1.3);
        (end.state[0] - reference.state[0]).abs()
    };
    assert!(error(1e-6) < 1e-3);
    assert!(error(1e-10) < 1e-7);
}

fn stop(system: &Bouncer, start: [f64; 2], stepping: Stepping, step_limit: u64) -> Failure {
    let mut integrator = Integrator::new(0.0, start, false, [0.0; 2]);
    let control = Control { stepping, step_limit };
    integrator.advance(system, 10.0, &control, &mut |_| ()).unwrap_err()
}

#[test]
fn failures_have_kind_place_and_time() {
    let system = Bouncer { stiffness: 1e4 };
    let limit = stop(&system, [0.5, 1.0], Stepping::Fixed(1e-3), 70);
    assert_eq!(limit.kind, FailureKind::StepLimit);
    assert!((limit.time - 0.07).abs() < 1e-12, "{limit:?}");

    let soft = Bouncer { stiffness: 1.0 };
    let fell = stop(&soft, [0.5, 0.0], Stepping::Adaptive(1e-8), 100_000);
    assert_eq!((fell.kind, fell.place.as_str()), (FailureKind::InvertedVolume, "the floor"));
    assert!(fell.time > 0.3 && fell.time < 1.0);

    let not_finite = stop(&system, [0.5, f64::NAN], Stepping::Fixed(1e-3), 100);
    assert_eq!(not_finite.kind, FailureKind::Unstable);
    let not_finite = stop(&system, [0.5, f64::INFINITY], Stepping::Adaptive(1e-8), 100);
    assert_eq!(not_finite.kind, FailureKind::Unstable);
}

/// dy/dt = y², which reaches infinity at t = 1.
struct Runaway;

impl System<1> for Runaway {
    type Branch = ();
    const GROUPS: [usize; 1] = [0];
    fn rates(&self, (): (), y: &[f64; 1]) -> [f64; 1] {
        [y[0] * y[0]]
    }
    fn margin(&self, (): (), _: &[f64; 1]) -> f64 {
        f64::INFINITY
    }
    fn next_branch(&self, (): (), _: &[f64; 1]) {}
    fn check(&self, _: &[f64; 1]) -> Result<(), (AuditKind, &'static str)> {
        Ok(())
    }
}

#[test]
fn a_pole_ends_the_run_with_a_failure() {
    let mut integrator = Integrator::new(0.0, [1.0], (), [0.0]);
    let control = Control { stepping: Stepping::Adaptive(1e-6), step_limit: 1_000_000 };
    let failure = integrator.advance(&Runaway, 2.0, &control, &mut |_| ()).unwrap_err();
    assert!(matches!(failure.kind, FailureKind::StepLimit | FailureKind::Unstable));
    assert!((failure.time - 1.0).abs() < 1e-3, "{failure:?}");
}
