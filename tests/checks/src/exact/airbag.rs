//! The square airbag at rest.

use billow_solver::integrators::entry;
use billow_solver::scene::IntegratorKind;
use billow_study::analysis::work_precision::{Ending, SceneRuns};
use billow_study::input::value::Value;
use billow_study::job::Status;

use super::meter::{Meter, add, quantity, scene, timed};
use crate::cases::{Result, Rig, static_airbag};

/// Cells along the side of a quarter of the airbag. With 96 the search finds another minimum, of higher energy.
const CELLS: [u32; 5] = [4, 8, 16, 32, 64];
/// Name of the search by Newton's method beside the integrators.
const STATIC_SEARCH: &str = "static search";
/// Integrators, CFL numbers and finest meshes with which the airbag is brought to rest by damped motion.
const RELAXATIONS: [(IntegratorKind, f64, u32); 3] = [
    (IntegratorKind::Explicit, 0.9, 32),
    (IntegratorKind::Implicit, 0.9, 32),
    (IntegratorKind::Hybrid, 0.9, 4),
];

/// Two squares sewn together and inflated. No closed form is known: the finest mesh is the reference. The search by
/// Newton's method stands beside damped motion with each integrator.
pub(super) fn square_airbag(rig: &Rig) -> Result<SceneRuns> {
    let quantities = vec![
        quantity("potential_energy", "J", "potential energy of a quarter of a sheet", None),
        quantity("height", "m", "height of the middle", None),
        quantity("volume", "m3", "enclosed volume", None),
    ];
    let meaning = "two squares sewn together and inflated, at rest; work is elements times Newton steps, seconds are those \
                   of the search";
    let mut scene = scene(["square_airbag", meaning], quantities, false);
    let method = |cells: u32, integrator: &str, cfl: Value| {
        [("cells", cells.into()), ("solver.integrator", integrator.into()), ("solver.cfl", cfl)]
    };
    for cells in CELLS {
        let (state, wall) = timed(|| static_airbag::inflated(rig, cells))?;
        let (elements, steps) = (state.model.elements() as f64, f64::from(state.iterations));
        let meter = Meter { elements, steps, implicit: true, wall, ..Meter::default() };
        let values = [state.potential_energy, state.positions.z[0], 8.0 * state.volume];
        let method = method(cells, STATIC_SEARCH, Value::Null);
        add(&mut scene, method, &meter, Ending::Trusted, &values);
    }
    for (kind, cfl, finest) in RELAXATIONS {
        for cells in CELLS.into_iter().filter(|cells| *cells <= finest) {
            let method = method(cells, entry(kind).name, cfl.into());
            let (settled, wall) = timed(|| static_airbag::relaxed(rig, cells, (kind, cfl)))?;
            match settled {
                Ok((mut film, energy)) => {
                    let meter = Meter::of(&mut film, wall);
                    let state = film.view().state;
                    let values = [energy, state.positions.z[0], 8.0 * state.volume];
                    add(&mut scene, method, &meter, Ending::Trusted, &values);
                }
                Err(mut unsettled) => {
                    let ending = Ending::Failed(Status::Failed(unsettled.failure.kind));
                    add(&mut scene, method, &Meter::of(&mut unsettled.film, wall), ending, &[]);
                }
            }
        }
    }
    Ok(scene)
}
