//! Discs under pressure: one clamped, two joined at the rim.
//!
//! The pressure on the clamped disc follows its surface. N0 is a nominal force, per reference width.
//!
//! The balloon is modelled by its upper half, whose rim slides in the plane of symmetry. The rim
//! shortens by a quarter, so the mesh lies along the meridians. The reference is the shape of
//! revolution. It is an equilibrium but not the one of least energy: a rim with deep dents encloses
//! more volume. A mesh of six sectors, oblique to the meridians, finds such dented states.

use billow_solver::geometry::shapes::{disc, ring_nodes};
use billow_solver::mechanics::resultants::resultants;
use billow_solver::scene::Film;
use billow_solver::scene::film_scene::{Filling, FilmScene};
use billow_solver::scene::paper::free_film;
use nalgebra::Vector3;

use super::reference::{entry, rows};
use super::rig::held;
use super::shapes::{disc_rim, radial_disc};
use super::static_equilibrium::{equilibrium, mean};
use super::{Outcome, Rig, Row};

/// Thickness of the film of the clamped disc, m. Chosen: only E t matters.
const THICKNESS: f64 = 1e-4;

/// Height, volume and membrane force of a clamped disc under pressure.
pub fn clamped_disc(rig: &Rig) -> Outcome {
    let [size, force, least] = entry("clamped_disc", ["size_band", "force_band", "order"]);
    let mut judged = Vec::new();
    for row in rows("clamped_disc") {
        let (radius, pressure) = (row[0], row[3]);
        let film = Film {
            youngs_modulus: row[1] / THICKNESS,
            poisson_ratio: row[2],
            thickness: THICKNESS,
            ..Film::PAPER_ELASTIC
        };
        let run = |rings: u32| -> Result<[f64; 3], String> {
            let filling = Filling::Pressure(pressure);
            let supports = vec![held(disc_rim(rings), "xyz")];
            let scene = FilmScene { filling, supports, ..free_film(disc(rings, radius), film) };
            let (state, _) = equilibrium(rig, &scene)?;
            // The first six elements surround the centre.
            let mean_force = |element| {
                let nominal = resultants(&state.model, &state.positions, element).nominal;
                0.5 * (nominal[0] + nominal[1])
            };
            let middle = (0..6).map(mean_force).sum::<f64>() / 6.0;
            Ok([state.positions.z[0], state.volume, middle])
        };
        let values = [run(8)?, run(16)?, run(32)?];
        let names = ["w0, m", "volume, m3", "N0, N/m"];
        for (index, (name, band)) in names.into_iter().zip([size, size, force]).enumerate() {
            let (name, values) = (format!("{name}, at {pressure} Pa"), values.map(|v| v[index]));
            judged.push(Row::converging(&name, values, row[4 + index], band, least));
        }
    }
    Ok(judged)
}

/// Radius, thickness and volume of the balloon.
pub fn mylar_balloon(rig: &Rig) -> Outcome {
    let [radius, size, bulk] = entry("mylar_balloon", ["radius", "size_band", "volume_band"]);
    let mut judged = Vec::new();
    for row in rows("mylar_balloon") {
        let pressure = row[0];
        let run = |rings: u32| -> Result<([f64; 3], String), String> {
            let filling = Filling::Pressure(pressure);
            let around = 3 * rings;
            let rim = ring_nodes(0, around);
            let supports = vec![held(rim.clone(), "z")];
            let shell = radial_disc(rings, around, radius);
            let (state, note) = equilibrium(
                rig,
                &FilmScene { filling, supports, ..free_film(shell, Film::PAPER_ELASTIC) },
            )?;
            let middle =
                Vector3::new(mean(&state, &rim, |x| x.x), mean(&state, &rim, |x| x.y), 0.0);
            let distance = |x: Vector3<f64>| (x - middle).norm();
            let mean_radius = mean(&state, &rim, distance);
            let dent = mean(&state, &rim, |x| (distance(x) - mean_radius).abs());
            let cube = radius * radius * radius;
            let pole = state.positions.get(state.positions.len() - 1);
            let sizes = [mean_radius / radius, 2.0 * pole.z / radius, 2.0 * state.volume / cube];
            let dent = dent / mean_radius;
            Ok((sizes, format!("{note}; mean deviation of the rim from a circle {dent:.1e}")))
        };
        let (finest, note) = run(32)?;
        let values = [run(8)?.0, run(16)?.0, finest];
        let names = ["r/a", "thickness/a", "V/a3"];
        for (index, (name, band)) in names.into_iter().zip([size, size, bulk]).enumerate() {
            let (name, values) = (format!("{name} at {pressure} Pa"), values.map(|v| v[index]));
            judged.push(Row::refined(&name, values, row[1 + index], band).with_note(&note));
        }
    }
    Ok(judged)
}
