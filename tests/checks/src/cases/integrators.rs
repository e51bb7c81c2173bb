//! Every integrator of film on smooth scenes: against the exact answer, within the error of its step there.
//!
//! ```text
//! |v₃/exact − 1| ≤ band          order = log2((v₁ − v₂)/(v₂ − v₃))          steps h₁ = 2 h₂ = 4 h₃
//! ```
//!
//! Bands and orders are those of `billow pareto` for the same mesh and step (`tests/reference/dynamics.json`): integrators
//! that keep them agree with each other within the sum of their errors.

use billow_solver::integrators::entry;

use super::prelude::*;
use super::row::self_convergence_order;
use super::{drum, gas, sphere_motion};

/// Level of the sphere's mesh.
const LEVEL: u32 = 2;
/// Rings of the disc's mesh.
const RINGS: u32 = 8;
/// CFL number of the implicit integrator where samples bound its steps.
const IMPLICIT_CFL: f64 = 0.45;

/// The row of an integrator: its values at four times, twice and once the step of `integrators/<scene>/<integrator>`.
fn row(
    scene: &str,
    kind: IntegratorKind,
    exact: f64,
    run: impl Fn(f64) -> Result<f64>,
) -> Result<Row> {
    let name = entry(kind).name;
    let [step, band, least] = numbers(&format!("integrators/{scene}/{name}"))[..] else {
        return Err(
            format!("integrators/{scene}/{name} in tests/reference: not three numbers").into()
        );
    };
    let values = [run(4.0 * step)?, run(2.0 * step)?, run(step)?];
    let judged = Row::new(name, values[2], exact, band);
    let order = self_convergence_order(values);
    // An error of the step below that of the mesh by far shows no order.
    Ok(if least > 0.0 { judged.with_least_order(order, least) } else { judged.with_order(order) })
}

/// The injected piston: CFL numbers; closed form.
pub(super) fn piston(rig: &Rig) -> Outcome {
    let exact = number("injected_piston/position_at_50_ms");
    let judged = IntegratorKind::ALL
        .map(|kind| row("piston", kind, exact, |cfl| Ok(gas::injected(rig, kind, cfl)?.1)));
    judged.into_iter().collect()
}

/// A step of vibrating film: CFL number, and samples a period where implicit steps end.
fn vibration_step(kind: IntegratorKind, step: f64) -> (f64, Option<f64>) {
    match kind {
        IntegratorKind::Implicit => (IMPLICIT_CFL, Some(1.0 / step)),
        IntegratorKind::Explicit | IntegratorKind::Hybrid => (step, None),
    }
}

/// The breathing sphere at its first pressure: linear equation.
pub(super) fn sphere(rig: &Rig) -> Outcome {
    let rows = rows("breathing_sphere");
    let [pressure, exact] = [rows[0][0], rows[0][1]];
    let judged = IntegratorKind::ALL.map(|kind| {
        row("sphere", kind, exact, |step| {
            let (cfl, samples) = vibration_step(kind, step);
            let interval = samples.map(|samples| 1.0 / (samples * exact));
            let (mut film, volume) =
                sphere_motion::breathing_start(rig, LEVEL, pressure, (kind, Some(cfl)))?;
            sphere_motion::breathing_frequency(&mut film, volume, interval)
        })
    });
    judged.into_iter().collect()
}

/// The first mode of the stretched disc: zeros of Bessel functions.
pub(super) fn disc(rig: &Rig) -> Outcome {
    let modes = drum::drum_modes();
    let mode = modes.first().ok_or("no mode of the stretched disc in tests/reference")?;
    let judged = IntegratorKind::ALL.map(|kind| {
        row("disc", kind, mode.frequency, |step| {
            let (cfl, samples) = vibration_step(kind, step);
            let samples = samples.unwrap_or(drum::SAMPLES);
            Ok(drum::drum(rig, mode, RINGS, (kind, cfl, samples))?.0)
        })
    });
    judged.into_iter().collect()
}
