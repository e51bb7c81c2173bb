//! Discs under pressure: one clamped, two sewn together.
//!
//! The clamped disc's pressure follows its surface; N0 is nominal, per reference width.
//!
//! The balloon is its upper half, whose rim slides in the plane of symmetry. Its film shortens round
//! the rim by a quarter, so it is judged on a mesh along its meridians. The reference is the shape
//! of revolution; it is a state of rest, but not the one of least energy: deep dents of the rim
//! enclose more (by 0.06 % at 10 Pa). On a mesh of six sectors, its elements aslant, all that was
//! found at 10 Pa on 16, 32 and 48 rings, and at 5 kPa on 32 and 48, is dented by 8 to 11 % in places:
//! the mean rim lies 0.7 to 1.0 % inside, the thickness 0.3 to 0.7 % over, the volume within 0.6 %.

use billow_solver::geometry::shapes::{disc, disc_rim, radial_disc, ring_nodes};
use billow_solver::mechanics::resultants::resultants;
use billow_solver::scene::Film;
use billow_solver::scene::film_scene::{Filling, FilmScene};
use billow_solver::scene::paper::free_film;
use nalgebra::Vector3;

use super::reference::{number, rows};
use super::rig::held;
use super::row::order;
use super::static_equilibrium::{equilibrium, mean};
use super::{Outcome, Rig, Row};

/// Thickness of the clamped disc's film, m; only E t counts.
const THICKNESS: f64 = 1e-4;

/// Height, volume and membrane force of a clamped disc under pressure.
pub fn clamped_disc(_: &Rig) -> Outcome {
    let [size, force, least] =
        ["size_band", "force_band", "order"].map(|key| number(&format!("clamped_disc/{key}")));
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
            let (state, _) = equilibrium(&scene)?;
            // The first six elements lie round the centre.
            let pull = |element| {
                let own = resultants(&state.model, &state.places, element).nominal;
                0.5 * (own[0] + own[1])
            };
            let middle = (0..6).map(pull).sum::<f64>() / 6.0;
            Ok([state.places.z[0], state.volume, middle])
        };
        let values = [run(8)?, run(16)?, run(32)?];
        let names = ["w0, m", "volume, m3", "N0, N/m"];
        for (at, (name, band)) in names.into_iter().zip([size, size, force]).enumerate() {
            let expected = row[4 + at];
            let errors = values.map(|value| value[at] / expected - 1.0);
            let seen = order(errors[0], errors[1]).min(order(errors[1], errors[2]));
            judged.push(
                Row::new(&format!("{name}, at {pressure} Pa"), values[2][at], expected, band)
                    .with_least_order(seen, least)
                    .with_errors(errors),
            );
        }
    }
    Ok(judged)
}

/// Radius, thickness and volume of the balloon.
pub fn mylar_balloon(_: &Rig) -> Outcome {
    let [radius, size, bulk] =
        ["radius", "size_band", "volume_band"].map(|key| number(&format!("mylar_balloon/{key}")));
    let mut judged = Vec::new();
    for row in rows("mylar_balloon") {
        let pressure = row[0];
        let run = |rings: u32| -> Result<([f64; 3], String), String> {
            let filling = Filling::Pressure(pressure);
            let around = 3 * rings;
            let rim = ring_nodes(0, around);
            let supports = vec![held(rim.clone(), "z")];
            let shell = radial_disc(rings, around, radius);
            let (state, word) = equilibrium(&FilmScene {
                filling,
                supports,
                ..free_film(shell, Film::PAPER_ELASTIC)
            })?;
            let middle =
                Vector3::new(mean(&state, &rim, |x| x.x), mean(&state, &rim, |x| x.y), 0.0);
            let far = |x: Vector3<f64>| (x - middle).norm();
            let wide = mean(&state, &rim, far);
            let dent = mean(&state, &rim, |x| (far(x) - wide).abs());
            let cube = radius * radius * radius;
            let pole = state.places.get(state.places.len() - 1);
            let sizes = [wide / radius, 2.0 * pole.z / radius, 2.0 * state.volume / cube];
            Ok((sizes, format!("{word}; rim out of round by {:.1e} in the mean", dent / wide)))
        };
        let (finest, word) = run(32)?;
        let values = [run(8)?.0, run(16)?.0, finest];
        let names = ["r/a", "thickness/a", "V/a3"];
        for (at, (name, band)) in names.into_iter().zip([size, size, bulk]).enumerate() {
            let expected = row[1 + at];
            let errors = values.map(|value| value[at] / expected - 1.0);
            judged.push(
                Row::new(&format!("{name} at {pressure} Pa"), values[2][at], expected, band)
                    .with_order(order(errors[1], errors[2]))
                    .with_errors(errors)
                    .with_note(&word),
            );
        }
    }
    Ok(judged)
}
