//! Discs under pressure: two clamped ones, one of compliant film, and two discs joined at the rim; and two squares joined
//! at the edge.
//!
//! The pressure on a clamped disc follows its surface. N0 is a nominal force, per reference width.
//!
//! The balloon is modelled by its upper half, whose rim slides in the plane of symmetry. The rim
//! shortens by a quarter, so the mesh lies along the meridians. The reference is the shape of
//! revolution. It is an equilibrium but not the one of least energy: a rim with deep dents encloses
//! more volume. A mesh of six sectors, oblique to the meridians, finds such dented states.
//!
//! The mesh of the squares is a quarter of the upper one between planes of symmetry. The seam stays in z = 0 and is free
//! in it. There are several close minima of energy: the potential energy shows which one is found, and lower is better.

use billow_solver::geometry::shapes::{disc, grid, nodes_where};

use super::prelude::*;
use super::shapes::{disc_rim, radial_disc};

/// Thickness of the film of the clamped disc, m. Chosen: only E t matters.
const THICKNESS: f64 = 1e-4;

/// Height, volume and membrane force of a clamped disc under pressure.
pub fn clamped_disc(rig: &Rig) -> Outcome {
    let [size, force, least] = entry("clamped_disc", ["size_band", "force_band", "order"]);
    each("clamped_disc", |row| {
        let (radius, pressure) = (row[0], row[3]);
        let film = Film {
            youngs_modulus: row[1] / THICKNESS,
            poisson_ratio: row[2],
            thickness: THICKNESS,
            ..Film::PAPER_ELASTIC
        };
        let quantities =
            [("w0, m", row[4], size), ("volume, m3", row[5], size), ("N0, N/m", row[6], force)]
                .map(|(name, value, band)| (format!("{name}, at {pressure} Pa"), value, band));
        refined([8, 16, 32], quantities, Some(least), |rings| {
            let supports = vec![held(disc_rim(rings), "xyz")];
            let state = inflated(rig, disc(rings, radius), film, pressure, supports)?;
            // The first six elements surround the centre.
            let mean_force = |element| {
                let nominal = resultants(&state.model, &state.positions, element).nominal;
                0.5 * (nominal[0] + nominal[1])
            };
            let middle = (0..6).map(mean_force).sum::<f64>() / 6.0;
            Ok([state.positions.z[0], state.volume, middle])
        })
    })
}

/// Height and volume of a disc of compliant film held at its rim.
pub fn compliant_disc(rig: &Rig) -> Outcome {
    let [radius, band] = entry("compliant", ["bottom_radius", "band"]);
    each("compliant/disc", |row| {
        let (film, pressure, name) = compliant(&row);
        let quantities = [("height, m", row[3]), ("volume, m3", row[4])]
            .map(|(what, value)| (format!("{what}, {name}"), value, band));
        refined([8, 16, 32], quantities, None, |rings| {
            let supports = vec![held(disc_rim(rings), "xyz")];
            let state = inflated(rig, disc(rings, radius), film, pressure, supports)?;
            Ok([state.positions.z[0], state.volume])
        })
    })
}

/// Radius, thickness and volume of the balloon.
pub fn mylar_balloon(rig: &Rig) -> Outcome {
    let radius = number("mylar_balloon/radius");
    let [size, bulk] = entry("mylar_balloon", ["size_band", "volume_band"]);
    each("mylar_balloon", |row| {
        let pressure = row[0];
        let quantities =
            [("r/a", row[1], size), ("thickness/a", row[2], size), ("V/a3", row[3], bulk)]
                .map(|(name, value, band)| (format!("{name} at {pressure} Pa"), value, band));
        refined([8, 16, 32], quantities, None, |rings| {
            let around = 3 * rings;
            let rim = ring_nodes(0, around);
            let (shell, supports) =
                (radial_disc(rings, around, radius), vec![held(rim.clone(), "z")]);
            let state = inflated(rig, shell, Film::PAPER_ELASTIC, pressure, supports)?;
            let middle =
                Vector3::new(mean(&state, &rim, |x| x.x), mean(&state, &rim, |x| x.y), 0.0);
            let rim = mean(&state, &rim, |x| (x - middle).norm());
            let pole = state.positions.get(state.positions.len() - 1);
            let cube = radius * radius * radius;
            Ok([rim / radius, 2.0 * pole.z / radius, 2.0 * state.volume / cube])
        })
    })
}

/// A quarter of the upper sheet.
fn quarter(cells: u32) -> FilmScene {
    let [youngs_modulus, poisson_ratio, thickness, pressure] =
        entry("square_airbag", ["youngs_modulus", "poisson_ratio", "thickness", "overpressure"]);
    let side = 0.5 * number("square_airbag/diagonal") / 2.0_f64.sqrt();
    let film = Film { youngs_modulus, poisson_ratio, thickness, ..Film::PAPER_ELASTIC };
    let shell = grid(cells, cells, side, side);
    let seam = nodes_where(&shell, |x| x.x >= side || x.y >= side);
    let supports = vec![
        held(nodes_where(&shell, |x| x.x <= 0.0), "x"),
        held(nodes_where(&shell, |x| x.y <= 0.0), "y"),
        held(seam, "z"),
    ];
    let filling = Filling::Pressure(pressure);
    FilmScene { filling, supports, ..free_film(shell, film) }
}

/// Energy, height and volume on three meshes.
pub fn square_airbag(rig: &Rig) -> Outcome {
    let [volume, energy_band, height_band, volume_band] =
        entry("square_airbag", ["volume", "energy_band", "height_band", "volume_band"]);
    let (mut judged, mut whole_volume) = (Vec::new(), f64::NAN);
    for (cells, row) in [16, 32, 64].into_iter().zip(rows("square_airbag")) {
        let state = equilibrium(rig, &quarter(cells), None)?;
        let name = |what: &str| format!("{what}, {cells} cells");
        let (energy, height) = (state.potential_energy, state.positions.z[0]);
        let excess = name("potential energy minus reference, J");
        judged.push(Row::at_most(&excess, energy - row[1], energy_band));
        let difference = name("w_M, difference to reference, m");
        judged.push(Row::at_most(&difference, (height - row[2]).abs(), height_band));
        whole_volume = 8.0 * state.volume;
    }
    let difference = (whole_volume - volume).abs();
    let quantity = "volume, difference to reference, finest mesh, m3";
    judged.push(Row::at_most(quantity, difference, volume_band));
    Ok(judged)
}
