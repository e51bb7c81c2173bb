//! The injected piston, by film with every integrator and by the model piston.

use billow_solver::integrators::entry;
use billow_solver::scene::{IntegratorKind, Stepping};
use billow_study::analysis::work_precision::{Ending, SceneRuns};
use billow_study::input::value::Value;

use super::meter::{Meter, add, quantity, scene, timed};
use crate::cases::reference::number;
use crate::cases::{Result, Rig, gas};

/// CFL numbers of the injected piston: each halves the step.
const PISTON_CFL: [f64; 7] = [0.64, 0.32, 0.16, 0.08, 0.04, 0.02, 0.01];
/// Number of them at which the explicit integrator, the implicit one and the hybrid run. The last never leaves its
/// explicit steps here, so one run shows it.
const PISTON_RUNS: [(IntegratorKind, usize); 3] =
    [(IntegratorKind::Explicit, 7), (IntegratorKind::Implicit, 6), (IntegratorKind::Hybrid, 1)];
/// Tolerances of the model piston.
const TOLERANCES: [f64; 6] = [1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13];
/// Fixed steps of the model piston, s.
const FIXED_STEPS: [f64; 5] = [8e-4, 4e-4, 2e-4, 1e-4, 5e-5];

/// A plate driven by a constant inflow into vacuum, by film and by the model piston. Its start is exact to 12 digits,
/// so errors end near 1e-12.
pub(super) fn injected_piston(rig: &Rig) -> Result<SceneRuns> {
    let [end, start] = ["end", "start"].map(|key| number(&format!("injected_piston/{key}")));
    let exact = gas::injected_exact(end);
    let simulated = end - start;
    let quantities = vec![quantity("x", "m", "position at 50 ms", Some(exact))];
    let meaning = "a plate driven by a constant inflow into vacuum; the model piston has no elements: its work is steps";
    let mut scene = scene(["injected_piston", meaning], quantities, true);
    let configuration =
        |model: &str, integrator: Value, cfl: Value, [adaptive, fixed]: [Value; 2]| {
            [
                ("solver.model", model.into()),
                ("solver.integrator", integrator),
                ("solver.cfl", cfl),
                ("solver.stepping.adaptive", adaptive),
                ("solver.stepping.fixed", fixed),
            ]
        };
    let none = Value::Null;
    let pairs = PISTON_RUNS
        .iter()
        .flat_map(|(kind, count)| PISTON_CFL.iter().take(*count).map(move |cfl| (*kind, *cfl)));
    for (kind, cfl) in pairs {
        let ((mut film, height), wall) = timed(|| gas::injected(rig, kind, cfl))?;
        let meter = Meter::of(&mut film, wall);
        let integrator = entry(kind).name.into();
        let method = configuration("film", integrator, cfl.into(), [none.clone(), none.clone()]);
        add(&mut scene, method, &meter, Ending::Trusted, &[height]);
    }
    let adaptive = TOLERANCES.map(Stepping::Adaptive);
    let fixed = FIXED_STEPS.map(Stepping::Fixed);
    // A run takes less than a millisecond; the first of a process also pays for what is done once.
    let _ = gas::injected_model(Stepping::Adaptive(TOLERANCES[0]))?;
    for stepping in adaptive.into_iter().chain(fixed) {
        let control = match stepping {
            Stepping::Adaptive(tolerance) => [tolerance.into(), none.clone()],
            Stepping::Fixed(step) | Stepping::Stable(step) => [none.clone(), step.into()],
        };
        let ((steps, height), wall) = timed(|| gas::injected_model(stepping))?;
        let steps = steps as f64;
        let meter = Meter { steps, simulated, wall, ..Meter::default() };
        let method = configuration("piston", none.clone(), none.clone(), control);
        add(&mut scene, method, &meter, Ending::Trusted, &[height]);
    }
    Ok(scene)
}
