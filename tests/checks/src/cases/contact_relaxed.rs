//! The folded capsule, deployed and relaxed, against the static equilibrium of the erected one; and that equilibrium
//! against recorded results of billow. The band of these is wide enough for another minimum of wrinkled film, and narrow
//! enough to detect a change of 1 %.
//!
//! ```text
//! stowed: m a = f_film + f_contact + p ∂V/∂x − c m v    until kinetic energy < 1e-6 p V
//! erected, same caps, same supports: f_film + p ∂V/∂x = 0
//! ```
//!
//! Caps are N-gons, the bottom ring is held on its stowed N-gon. Volume, height of the top rim and
//! strain energy are compared.

use billow_solver::geometry::mesh::{Mesh, Shape};
use billow_solver::models::film::{StaticState, static_states};
use billow_solver::scene::DEFAULT_CFL;

use super::contact_rig::intersection_count;
use super::prelude::*;

/// Mass damping, 1/s. Chosen: small against the rates of the deployment, large enough to reach rest
/// before [`LATEST`].
const DAMPING: f64 = 30.0;
/// Earliest time at which low kinetic energy counts as rest, s: the film also starts at rest.
const EARLIEST: f64 = 0.1;
/// Time without rest at which the case fails, s.
const LATEST: f64 = 5.0;
/// Time between two checks, s.
const CHECK_INTERVAL: f64 = 0.01;

/// The stowed capsule at rest under a fixed pressure (Pa).
fn relaxed(rig: &Rig, scene: &Scene, pressure: f64) -> Result<(FilmSimulation, Mesh)> {
    let stowed = Shape::Stowed(scene.design.folded()?.stowed_height);
    let (film, mesh) = capsule::film_scene(rig.instruction_set, scene, stowed, DEFAULT_CFL)?;
    let contact = capsule::resolved_contact(FilmContact::default(), scene.design.folded()?)?;
    let mut film =
        FilmScene { filling: Filling::Pressure(pressure), contact: Some(contact), ..film };
    film.solver.mass_damping = DAMPING;
    let mut film = rig.start(&film)?;
    let share = number("deployed_equals_inflated/kinetic_share");
    // Twice in succession: a motion that reverses has no kinetic energy for a moment either.
    let mut quiet_checks = 0;
    while quiet_checks < 2 {
        let target = film.view().state.time + CHECK_INTERVAL;
        if target > LATEST {
            return Err(format!("not at rest at {LATEST} s").into());
        }
        advance(&mut film, target, &Phase::default())?;
        let settled =
            film.view().ledger().kinetic.abs() < share * pressure * film.view().state.volume;
        quiet_checks = if settled && target > EARLIEST { quiet_checks + 1 } else { 0 };
    }
    Ok((film, mesh))
}

/// Rows of one pressure.
fn compare(film: &FilmView<'_>, mesh: &Mesh, expected: &StaticState) -> Vec<Row> {
    let name = |what: &str| format!("{what}, at {} Pa", expected.overpressure);
    let band = |key: &str| number(&format!("deployed_equals_inflated/{key}"));
    let rim = mesh.top_ring.iter().map(|node| film.state.positions.z[*node as usize]).sum::<f64>()
        / mesh.top_ring.len() as f64;
    let share = film.ledger().kinetic / (expected.overpressure * film.state.volume);
    let passages = film.passages().map_or(f64::NAN, |passages| passages as f64);
    let strain = film.ledger().strain;
    let row = |what: &str, value: f64, expected: f64, key: &str| {
        Row::new(&name(what), value, expected, band(key))
    };
    vec![
        row("volume, m3", film.state.volume, expected.volume, "volume_band"),
        row("rim height, m", rim, expected.height, "rim_height_band"),
        row("strain energy, J", strain, expected.strain_energy, "strain_energy_band"),
        Row::at_most(&name("kinetic energy over p V"), share, band("kinetic_share")),
        Row::at_most(&name("passages"), passages, 0.0),
        Row::at_most(&name("intersections"), intersection_count(film) as f64, 0.0),
    ]
}

/// The relaxed capsule against the erected one.
pub fn deployed_equals_inflated(rig: &Rig, subdivisions: u32) -> Outcome {
    let scene = paper::capsule(subdivisions, 1.0);
    let pressures = numbers("deployed_equals_inflated/pressures");
    let inflated = static_states(rig.instruction_set, &scene, &pressures)?;
    let mut judged = Vec::new();
    for expected in &inflated {
        let (film, mesh) = relaxed(rig, &scene, expected.overpressure)?;
        judged.extend(compare(&film.view(), &mesh, expected));
    }
    Ok(judged)
}

/// The static equilibria on each mesh of the table.
pub fn end_state_polygon(rig: &Rig) -> Outcome {
    let bands = numbers("end_state_polygon/bands");
    let mut judged = Vec::new();
    for subdivisions in [5, 8, 16] {
        // The table has rising pressures; falling ones converge faster.
        let of_mesh = |row: &Vec<f64>| (row[0] - f64::from(subdivisions)).abs() < 0.5;
        let rows: Vec<Vec<f64>> =
            rows("end_state_polygon").into_iter().filter(of_mesh).rev().collect();
        let pressures: Vec<f64> = rows.iter().map(|row| row[1]).collect();
        let scene = paper::capsule(subdivisions, 0.3);
        let states = static_states(rig.instruction_set, &scene, &pressures)?;
        for (row, state) in rows.iter().zip(states) {
            let sizes = [state.volume, state.height, state.strain_energy];
            let names = ["volume, m3", "rim height, m", "strain energy, J"];
            for (index, (name, value)) in names.into_iter().zip(sizes).enumerate() {
                let name = format!("{name}, at {} Pa, n {subdivisions}", row[1]);
                judged.push(Row::new(&name, value, row[2 + index], bands[index]));
            }
        }
    }
    Ok(judged)
}
