//! Flat sheets of film pressed together.
//!
//! ```text
//! force of sheet k on sheet k + 1 = p A         the same in every layer, at any contact distance
//! ```
//!
//! The lowest sheet lies on a plate. The highest is a rigid plane under the force p A. Each mesh is
//! shifted, so that nodes do not lie on nodes.

use billow_solver::collision::contact::{ContactModel, ContactState};

use super::prelude::*;

const LAYERS: u32 = 4;
/// Side of a sheet, m.
const SIDE: f64 = 0.3;
/// Time after which the stack is at rest, s.
const REST: f64 = 0.02;

/// A stack at this contact distance (m); neighbouring sheets are one distance apart.
fn stack(distance: f64, pressure: f64) -> FilmScene {
    let layer = |k: u32| -> Shell {
        let k = f64::from(k);
        let shift = Vector3::new(0.011 * k, 0.007 * k, distance * (k + 1.0));
        moved(sheet(5, 5, SIDE, SIDE), |x| x + shift)
    };
    let sheets: Vec<Shell> = (0..LAYERS).map(layer).collect();
    let shell = joined(&sheets);
    let (each, all) = (nodes_of(&shell) / LAYERS, nodes_of(&shell));
    let (normal, force) = (Vector3::z(), -pressure * SIDE * SIDE);
    let press = PlaneBody { normal, mass: 0.0, velocity: 0.0, force };
    let top = on_plane((all - each..all).collect(), press);
    let floor = plate(Vector3::zeros(), Vector3::z(), None);
    let mut scene = FilmScene {
        supports: vec![held((0..all).collect(), "xy"), top],
        contact: Some(FilmContact { plates: vec![floor], ..monitored_contact(distance) }),
        ..free_film(shell, Film::PAPER_ELASTIC)
    };
    scene.solver.mass_damping = 3000.0;
    scene
}

fn nodes_of(shell: &Shell) -> u32 {
    u32::try_from(shell.positions.len()).expect("under 2^32 nodes")
}

/// Mean interlayer pressure between sheet `k` and the next one, Pa.
fn between(film: &FilmView<'_>, model: &ContactModel, k: u32) -> f64 {
    let each = film.system.model.mass.len() / LAYERS as usize;
    let layer = |node: u32| node as usize / each;
    let mut state = ContactState::default();
    let contacts = film.state.contact.contacts.iter().filter(|contact| {
        let layers = contact.pair.nodes(&model.mesh.topology).map(layer);
        let (low, high) = (layers.iter().min(), layers.iter().max());
        low == Some(&(k as usize)) && high == Some(&(k as usize + 1))
    });
    state.contacts = contacts.copied().collect();
    let areas: Vec<f64> =
        film.system.model.mass.iter().map(|mass| mass / model.area_density).collect();
    let pressed = model.interlayer_pressure(&film.state.positions, &areas, &state);
    let whole: f64 = areas.iter().sum();
    // Each of the two sheets carries the force once.
    0.5 * pressed.mean * pressed.area_fraction * whole / (SIDE * SIDE)
}

/// Every interlayer pressure, at three contact distances.
pub fn stack_of_sheets(rig: &Rig) -> Outcome {
    let (pressure, band) = (number("stack/pressure"), number("stack/band"));
    let mut judged = Vec::new();
    for distance in numbers("stack/distances") {
        let mut film = rig.start(&stack(distance, pressure))?;
        let record = run_recorded(&mut film, REST, 10, &Phase::default())?;
        let run = format!("distance {} mm, ", 1e3 * distance);
        let model = film.view().system.contact.as_ref().ok_or("no contact")?;
        for k in 0..LAYERS - 1 {
            let mean = between(&film.view(), model, k);
            let (low, high) = (k + 1, k + 2);
            let quantity = format!("{run}sheets {low} and {high}: interlayer pressure, Pa");
            judged.push(Row::new(&quantity, mean, pressure, band));
        }
        judged.extend(record.rows(&run, number("contact/ledger_band")));
    }
    Ok(judged)
}
