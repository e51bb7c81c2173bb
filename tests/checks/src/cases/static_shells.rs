//! Closed shells under pressure: sphere, cylinder, cone.
//!
//! ```text
//! sphere    p = (t/R) E/(1−ν) (λ²−1)/λ
//! cylinder  S_axial t = p R λ_hoop²/(2 λ_axial),  S_hoop t = p R λ_axial
//! cone      N_hoop = p r/cos φ,  N_meridional = p r/(2 cos φ)
//! ```
//!
//! A stretch is the mean radius over that of the unloaded mesh. A rigid plane under the force
//! `p π (R λ_hoop)²` ends the cylinder, a rigid disc under `p π r²` the cone. Forces of the cone are true
//! ones (per deformed width) in its middle third, each compared at its own radius.

use core::f64::consts::PI;

use billow_solver::geometry::shapes::{icosphere, revolved, ring_nodes};
use billow_solver::mechanics::resultants::resultants;
use billow_solver::scene::Film;
use billow_solver::scene::film_scene::{Filling, FilmScene};
use billow_solver::scene::film_support::{FilmSupport, Hold, PlaneBody};
use billow_solver::scene::paper::free_film;
use nalgebra::Vector3;

use super::reference::{entry, rows};
use super::rig::held;
use super::row::worse;
use super::static_equilibrium::{equilibrium, mean};
use super::{Outcome, Rig, Row};

/// Stretch of a sphere.
pub fn sphere(rig: &Rig) -> Outcome {
    let [radius, band, least] = entry("static_sphere", ["radius", "band", "order"]);
    let mut judged = Vec::new();
    for row in rows("static_sphere") {
        let (pressure, expected) = (row[0], row[1]);
        let run = |level: u32| -> Result<f64, String> {
            let filling = Filling::Pressure(pressure);
            let scene =
                FilmScene { filling, ..free_film(icosphere(level, radius), Film::PAPER_ELASTIC) };
            let (state, _) = equilibrium(rig, &scene)?;
            let loaded: f64 = state.positions.iter().map(|x| x.norm()).sum();
            let unloaded: f64 = scene.shell.positions.iter().map(Vector3::norm).sum();
            Ok(loaded / unloaded - 1.0)
        };
        let values = [run(2)?, run(3)?, run(4)?];
        let quantity = format!("lambda - 1 at {pressure} Pa");
        judged.push(Row::converging(&quantity, values, expected, band, least));
    }
    Ok(judged)
}

/// A rigid plate on these nodes under a force along z.
fn plate(nodes: Vec<u32>, force: f64) -> FilmSupport {
    let hold = Hold::Body(PlaneBody { normal: Vector3::z(), mass: 1.0, velocity: 0.0, force });
    FilmSupport { name: "plate".to_owned(), nodes, hold, motion: None }
}

/// Both stretches of a cylinder with closed ends.
pub fn cylinder(rig: &Rig) -> Outcome {
    let [radius, length, pressure, axial, hoop, band, least] = entry(
        "static_cylinder",
        ["radius", "length", "overpressure", "axial", "hoop", "band", "order"],
    );
    let stretched = radius * (1.0 + hoop);
    let run = |along: u32| -> Result<[f64; 2], String> {
        let around = 8 * along;
        let shell =
            revolved(along, around, false, |k| [radius, length * f64::from(k) / f64::from(along)]);
        let top = ring_nodes(along, around);
        let supports = vec![
            held(ring_nodes(0, around), "z"),
            plate(top.clone(), pressure * PI * stretched * stretched),
        ];
        let filling = Filling::Pressure(pressure);
        let (state, _) = equilibrium(
            rig,
            &FilmScene { filling, supports, ..free_film(shell, Film::PAPER_ELASTIC) },
        )?;
        let all: Vec<u32> = (0..(along + 1) * around).collect();
        Ok([
            mean(&state, &all, |x| x.xy().norm()) / radius - 1.0,
            mean(&state, &top, |x| x.z) / length - 1.0,
        ])
    };
    let values = [run(3)?, run(6)?, run(12)?];
    let row = |index: usize, name: &str, expected: f64| {
        Row::converging(name, values.map(|value| value[index]), expected, band, least)
    };
    Ok(vec![row(0, "lambda_hoop - 1", hoop), row(1, "lambda_axial - 1", axial)])
}

/// Membrane forces of a cone far from its ends.
pub fn cone(rig: &Rig) -> Outcome {
    let [bottom, top, height, pressure, band] =
        entry("cone", ["bottom_radius", "top_radius", "height", "overpressure", "band"]);
    let slope = (bottom - top) / height;
    let cos = 1.0 / (1.0 + slope * slope).sqrt();
    let run = |along: u32| -> Result<[[f64; 2]; 2], String> {
        let around = 4 * along;
        let shell = revolved(along, around, false, |k| {
            let s = f64::from(k) / f64::from(along);
            [bottom + (top - bottom) * s, height * s]
        });
        let supports = vec![
            held(ring_nodes(0, around), "xyz"),
            held(ring_nodes(along, around), "xy"),
            plate(ring_nodes(along, around), pressure * PI * top * top),
        ];
        let filling = Filling::Pressure(pressure);
        let (state, _) = equilibrium(
            rig,
            &FilmScene { filling, supports, ..free_film(shell, Film::PAPER_ELASTIC) },
        )?;
        let (mut sum, mut worst, mut count) = ([0.0; 2], [0.0; 2], 0.0);
        for (element, triangle) in state.model.triangles.iter().enumerate() {
            let corners = triangle.map(|node| state.positions.get(node as usize));
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            if (middle.z / height - 0.5).abs() < 1.0 / 6.0 {
                // The mean radius of the corners lies nearer to the surface than that of the chord.
                let radius = corners.iter().map(|x| x.xy().norm()).sum::<f64>() / 3.0;
                let hoop = pressure * radius / cos;
                let force = resultants(&state.model, &state.positions, element).cauchy;
                for (index, expected) in [hoop, 0.5 * hoop].into_iter().enumerate() {
                    sum[index] += force[index] / expected;
                    worst[index] = worse(worst[index], (force[index] / expected - 1.0).abs());
                }
                count += 1.0;
            }
        }
        Ok([sum.map(|sum| sum / count), worst])
    };
    let values = [run(12)?, run(24)?, run(48)?];
    let mut judged = Vec::new();
    for (index, name) in ["N_hoop", "N_meridional"].into_iter().enumerate() {
        let means = values.map(|[mean, _]| mean[index]);
        judged.push(Row::refined(&format!("{name}/(closed form), mean"), means, 1.0, band));
        let largest = values[2][1][index];
        judged.push(Row::at_most(&format!("{name}, largest error of an element"), largest, band));
    }
    Ok(judged)
}
