//! The square airbag at rest.

use billow_solver::integrators::entry;
use billow_solver::scene::IntegratorKind;
use serde_json::Value;

use super::meter::{Meter, quantity, scene, timed};
use crate::cases::{Rig, static_airbag};
use crate::exact_scenes::{ExactRun, ExactScene};
use billow_study::job::Status;

/// Cells along the side of a quarter of the airbag. With 96 the search finds another minimum, of higher energy.
const CELLS: [u32; 5] = [4, 8, 16, 32, 64];
/// Name of the search by Newton's method beside the integrators.
const STATIC_SEARCH: &str = "static search";
/// Integrators, CFL numbers and finest meshes with which the airbag is brought to rest by damped motion.
const RELAXATIONS: [(IntegratorKind, f64, u32); 4] = [
    (IntegratorKind::Explicit, 0.9, 32),
    (IntegratorKind::Implicit, 0.9, 32),
    (IntegratorKind::Hybrid, 0.9, 4),
    (IntegratorKind::Xpbd, 0.1, 16),
];

/// Two squares sewn together and inflated. No closed form is known: the finest mesh is the reference. The search by
/// Newton's method stands beside damped motion with each integrator.
pub(super) fn square_airbag(rig: &Rig) -> Result<ExactScene, String> {
    let quantities = vec![
        quantity("potential_energy", "J", "potential energy of a quarter of a sheet", None),
        quantity("height", "m", "height of the middle", None),
        quantity("volume", "m3", "enclosed volume", None),
    ];
    let mut found = scene(
        "square_airbag",
        "two squares sewn together and inflated, at rest; work is elements times Newton steps, seconds are those of the search",
        &["cells", "solver.integrator", "solver.cfl"],
        quantities,
    );
    found.per_simulated_second = false;
    for cells in CELLS {
        let ((state, _), wall) = timed(|| static_airbag::inflated(rig, cells))?;
        found.runs.push(ExactRun {
            configuration: vec![cells.into(), STATIC_SEARCH.into(), Value::Null],
            elements: state.model.elements() as f64,
            steps: f64::from(state.iterations),
            implicit: true,
            seconds: wall,
            status: Status::Done.name().to_owned(),
            values: vec![state.potential_energy, state.positions.z[0], 8.0 * state.volume],
        });
    }
    for (kind, cfl, finest) in RELAXATIONS {
        for cells in CELLS.into_iter().filter(|cells| *cells <= finest) {
            found.runs.push(relaxation(rig, cells, (kind, cfl))?);
        }
    }
    Ok(found)
}

/// The airbag brought to rest by damped motion.
fn relaxation(rig: &Rig, cells: u32, method: (IntegratorKind, f64)) -> Result<ExactRun, String> {
    let (settled, wall) = timed(|| static_airbag::relaxed(rig, cells, method))?;
    let (mut film, status, energy) = match settled {
        Ok((film, energy)) => (film, Status::Done, Some(energy)),
        Err(unsettled) => (unsettled.film, Status::Failed(unsettled.failure.kind), None),
    };
    let mut meter = Meter::default();
    meter.add(&mut film, wall);
    let (kind, cfl) = method;
    let state = film.view().state;
    let values = energy.map(|energy| vec![energy, state.positions.z[0], 8.0 * state.volume]);
    Ok(ExactRun {
        seconds: wall,
        status: status.name().to_owned(),
        ..meter.run(
            vec![cells.into(), entry(kind).name.into(), cfl.into()],
            values.unwrap_or_default(),
        )
    })
}
