//! The square airbag: two square sheets joined at the edge and inflated.
//!
//! The mesh is a quarter of the upper sheet between planes of symmetry. The seam stays in z = 0 and is
//! free in it. There are several close minima of energy: the potential energy shows which one is
//! found, and lower is better.

use billow_solver::geometry::shapes::{grid, nodes_where};

use super::prelude::*;

/// A quarter of the upper sheet.
fn quarter(cells: u32) -> FilmScene {
    let [youngs_modulus, poisson_ratio, thickness, pressure] =
        entry("square_airbag", ["youngs_modulus", "poisson_ratio", "thickness", "overpressure"]);
    let side = side();
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

/// Side of the quarter, m.
fn side() -> f64 {
    0.5 * number("square_airbag/diagonal") / 2.0_f64.sqrt()
}

/// Energy, height and volume on three meshes.
pub fn square_airbag(rig: &Rig) -> Outcome {
    let [thickness, volume] = entry("square_airbag", ["thickness", "volume"]);
    let [energy_band, height_band, volume_band] =
        entry("square_airbag", ["energy_band", "height_band", "volume_band"]);
    let (mut judged, mut whole_volume) = (Vec::new(), f64::NAN);
    for (cells, row) in [16, 32, 64].into_iter().zip(rows("square_airbag")) {
        let state = equilibrium(rig, &quarter(cells), None)?;
        let name = |what: &str| format!("{what}, {cells} cells");
        let corner = state.positions.get(state.positions.len() - 1);
        let inward = 2.0_f64.sqrt() * side() - corner.xy().norm();
        let stress = resultants(&state.model, &state.positions, 0).principal[0] / thickness * 1e-6;
        let (energy, height) = (state.potential_energy, state.positions.z[0]);
        let excess = name("potential energy minus reference, J");
        let note = format!("{energy:.6} J; u_A {inward:.6} m, S1(M) {stress:.4} MPa");
        judged.push(Row::at_most(&excess, energy - row[1], energy_band).with_note(&note));
        let difference = name("w_M, difference to reference, m");
        let note = format!("{height:.6} m");
        judged
            .push(Row::at_most(&difference, (height - row[2]).abs(), height_band).with_note(&note));
        whole_volume = 8.0 * state.volume;
    }
    let difference = (whole_volume - volume).abs();
    judged.push(
        Row::at_most("volume, difference to reference, finest mesh, m3", difference, volume_band)
            .with_note(&format!("{whole_volume:.6} m3")),
    );
    Ok(judged)
}
