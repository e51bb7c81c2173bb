//! Film between plates: flat sheets pressed together, and an inextensible tube.
//!
//! ```text
//! stack:  force of sheet k on sheet k + 1 = p A         the same in every layer, at any contact distance
//! tube:   b = π (R − g/2)     A = b g + π g²/4     force per length = p b,  p = p0 (A0/A)^γ
//! ```
//!
//! The lowest sheet lies on a plate. The highest is a rigid plane under the force p A. Each mesh is
//! shifted, so that nodes do not lie on nodes.
//!
//! Symbols of the tube: R radius, g gap between the flat films, b width of the contact, A area of the section, A0 at the
//! start; m and m². Its mesh is a slice between two symmetry planes; end fans close its volume. The pressure is so low
//! that the film hardly stretches.

use billow_solver::collision::contact::{ContactModel, ContactState};
use billow_solver::geometry::shapes::tube;
use nalgebra::Matrix3;

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

/// Elements around the tube.
const AROUND: u32 = 64;
/// Pressure at the start, Pa.
const PRESSURE: f64 = 200.0;
/// Temperature of the gas, K.
const TEMPERATURE: f64 = 293.0;
/// Contact distance, m.
const DISTANCE: f64 = 5e-4;
/// Time at which the plates stop, s.
const CLOSED: f64 = 0.03;
/// Time at which the tube is at rest, s.
const TUBE_REST: f64 = 0.08;

/// Width of the slice, m: that of one element.
fn width(radius: f64) -> f64 {
    core::f64::consts::TAU * radius / f64::from(AROUND)
}

/// The slice about z between two plates that close to `gap` (m) between the films.
fn slice(radius: f64, gap: f64) -> FilmScene {
    let mut shell: Shell = tube(AROUND, 1, radius, width(radius));
    let tips = shell.close(|_| Matrix3::identity());
    let volume = shell.volume(|node| shell.positions[node as usize]);
    let gas_constant = nitrogen_supply().species.gas_constant;
    let mass = PRESSURE * volume / (gas_constant * TEMPERATURE);
    // The plates start one contact distance off the tube and end one off the film.
    let (start, end) = (radius + DISTANCE, 0.5 * gap + DISTANCE);
    let half = |sign: f64| {
        let up = Vector3::y() * sign;
        plate(up * start, -up, Some((up * (end - start), CLOSED)))
    };
    let mut scene = FilmScene {
        filling: nitrogen_filling(mass, TEMPERATURE),
        supports: vec![held((0..2 * AROUND).collect(), "z"), held(tips, "xyz")],
        contact: Some(FilmContact {
            plates: vec![half(1.0), half(-1.0)],
            ..monitored_contact(DISTANCE)
        }),
        ..free_film(shell, Film { numerical_damping: 0.1, ..Film::PAPER_ELASTIC })
    };
    scene.solver.mass_damping = 300.0;
    scene
}

/// Force and area of the section at both gaps.
pub fn tube_between_plates(rig: &Rig) -> Outcome {
    let radius = number("tube_between_plates/radius");
    let [force_band, area_band] = entry("tube_between_plates", ["force_band", "area_band"]);
    let mut judged = Vec::new();
    for row in rows("tube_between_plates") {
        let (gap, area, force) = (row[0], row[2], row[3]);
        let mut film = rig.start(&slice(radius, gap))?;
        let start = film.view().state.volume;
        let record = run_recorded(&mut film, TUBE_REST, 8, &Phase::default())?;
        let force_on_plates: f64 =
            film.view().state.contact.plates.iter().map(|plate| 0.5 * plate.force).sum();
        let run = format!("g {gap} m: ");
        let quantity = format!("{run}force per length over p0, N/m/Pa");
        let of_plates = force_on_plates / width(radius) / PRESSURE;
        judged.push(Row::new(&quantity, of_plates, force, force_band));
        let share = film.view().state.volume / start;
        judged.push(Row::new(&format!("{run}A/A0"), share, area, area_band));
        judged.extend(record.rows(&run, number("contact/ledger_band")));
    }
    Ok(judged)
}
