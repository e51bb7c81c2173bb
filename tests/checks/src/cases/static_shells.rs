//! Shells of revolution under pressure: sphere, cylinder, cone, and a frustum of compliant film between rings.
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

use billow_solver::geometry::shapes::revolved;

use super::prelude::*;

/// Stretch of a sphere.
pub fn sphere(rig: &Rig) -> Outcome {
    let [radius, band, least] = entry("static_sphere", ["radius", "band", "order"]);
    each("static_sphere", |row| {
        let (pressure, expected) = (row[0], row[1]);
        let quantity = format!("lambda - 1 at {pressure} Pa");
        refined([2, 3, 4], [(quantity, expected, band)], Some(least), |level| {
            let shell = icosphere(level, radius);
            let unloaded: f64 = shell.positions.iter().map(Vector3::norm).sum();
            let state = inflated(rig, shell, Film::PAPER_ELASTIC, pressure, Vec::new())?;
            let loaded: f64 = state.positions.iter().map(|x| x.norm()).sum();
            Ok([loaded / unloaded - 1.0])
        })
    })
}

/// The side of a frustum with these radii (m, bottom and top) and this height (m).
fn side(along: u32, around: u32, [bottom, top]: [f64; 2], height: f64, crossed: bool) -> Shell {
    revolved(along, around, crossed, |k| {
        let s = f64::from(k) / f64::from(along);
        [bottom + (top - bottom) * s, height * s]
    })
}

/// A rigid plate on these nodes under a force along z.
fn plate(nodes: Vec<u32>, force: f64) -> FilmSupport {
    on_plane(nodes, PlaneBody { normal: Vector3::z(), mass: 1.0, velocity: 0.0, force })
}

/// Both stretches of a cylinder with closed ends.
pub fn cylinder(rig: &Rig) -> Outcome {
    let [radius, length, pressure, axial, hoop, band, least] = entry(
        "static_cylinder",
        ["radius", "length", "overpressure", "axial", "hoop", "band", "order"],
    );
    let stretched = radius * (1.0 + hoop);
    let quantities = [("lambda_hoop - 1", hoop, band), ("lambda_axial - 1", axial, band)];
    refined([3, 6, 12], quantities, Some(least), |along| {
        let around = 8 * along;
        let shell = side(along, around, [radius; 2], length, false);
        let top = ring_nodes(along, around);
        let end = plate(top.clone(), pressure * PI * stretched * stretched);
        let supports = vec![held(ring_nodes(0, around), "z"), end];
        let state = inflated(rig, shell, Film::PAPER_ELASTIC, pressure, supports)?;
        let all: Vec<u32> = (0..(along + 1) * around).collect();
        Ok([
            mean(&state, &all, |x| x.xy().norm()) / radius - 1.0,
            mean(&state, &top, |x| x.z) / length - 1.0,
        ])
    })
}

/// Membrane forces of a cone far from its ends.
pub fn cone(rig: &Rig) -> Outcome {
    let [bottom, top, height, pressure, band] =
        entry("cone", ["bottom_radius", "top_radius", "height", "overpressure", "band"]);
    let slope = (bottom - top) / height;
    let cos = 1.0 / (1.0 + slope * slope).sqrt();
    let mut largest = [0.0; 2];
    let mut run = |along: u32| -> Result<[f64; 2]> {
        let around = 4 * along;
        let end = ring_nodes(along, around);
        let supports = vec![
            held(ring_nodes(0, around), "xyz"),
            held(end.clone(), "xy"),
            plate(end, pressure * PI * top * top),
        ];
        let shell = side(along, around, [bottom, top], height, false);
        let state = inflated(rig, shell, Film::PAPER_ELASTIC, pressure, supports)?;
        let (mut sum, mut count) = ([0.0; 2], 0.0);
        largest = [0.0; 2];
        for (element, triangle) in state.model.triangles.iter().enumerate() {
            let corners = state.positions.at(*triangle);
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            if (middle.z / height - 0.5).abs() < 1.0 / 6.0 {
                // The mean radius of the corners lies nearer to the surface than that of the chord.
                let radius = corners.iter().map(|x| x.xy().norm()).sum::<f64>() / 3.0;
                let hoop = pressure * radius / cos;
                let force = resultants(&state.model, &state.positions, element).cauchy;
                for (index, expected) in [hoop, 0.5 * hoop].into_iter().enumerate() {
                    sum[index] += force[index] / expected;
                    largest[index] = worse(largest[index], (force[index] / expected - 1.0).abs());
                }
                count += 1.0;
            }
        }
        Ok(sum.map(|sum| sum / count))
    };
    let names = ["N_hoop", "N_meridional"];
    let quantities = names.map(|name| (format!("{name}/(closed form), mean"), 1.0, band));
    let mut judged = refined([12, 24, 48], quantities, None, &mut run)?;
    for (name, largest) in names.into_iter().zip(largest) {
        judged.push(Row::at_most(&format!("{name}, largest error of an element"), largest, band));
    }
    Ok(judged)
}

/// Largest radius and volume of a frustum of compliant film whose rims are held.
pub fn compliant_frustum(rig: &Rig) -> Outcome {
    let [bottom, top, height] = entry("compliant", ["bottom_radius", "top_radius", "height"]);
    let band = number("compliant/band");
    each("compliant/frustum", |row| {
        let (film, pressure, name) = compliant(&row);
        let quantities = [
            (format!("largest radius, m, {name}"), row[3], band),
            (format!("volume, m3, {name}"), row[4], band),
        ];
        refined([8, 16, 32], quantities, None, |along| {
            let around = 3 * along;
            let shell = side(along, around, [bottom, top], height, true);
            let rims = [0, along].map(|ring| held(ring_nodes(ring, around), "xyz"));
            let state = inflated(rig, shell, film, pressure, rims.to_vec())?;
            let radius = |ring: u32| mean(&state, &ring_nodes(ring, around), |x| x.xy().norm());
            Ok([largest(&(0..=along).map(radius).collect::<Vec<_>>()), state.volume])
        })
    })
}

/// Top of the parabola through the largest of some values and its neighbours.
fn largest(values: &[f64]) -> f64 {
    let inner = values.windows(3).max_by(|a, b| a[1].total_cmp(&b[1]));
    inner.map_or(f64::NAN, |window| {
        let slope = 0.5 * (window[2] - window[0]);
        let bend = window[2] - 2.0 * window[1] + window[0];
        window[1] - 0.5 * slope * slope / bend
    })
}
