//! Gas in pinched pleats: whether the uniform pressure of the model can hold.
//!
//! ```text
//! supply       C = Σ w c(h)     over the rim: w its part of the length, h its distance to the other layer of the pleat
//! demand       |dV/dt|          of the pleat, from the velocities
//! difference   demand/C         pressure difference over p that drives the demand where flow is linear in it; from 1 on
//!                               the pleat starves
//! ```
//!
//! c: `Gas::slit_conductance`. Gas flows freely around the axis within a pleat. It is a report: the film feels one
//! pressure.

use nalgebra::Vector3;

use crate::collision::contact::distance::point_triangle;
use crate::geometry::field::Field;
use crate::geometry::mesh::Pleat;
use crate::mechanics::gas::Gas;
use crate::system::FilmState;

/// Tracks of a capsule with gas and contact: name, unit, meaning.
pub const PLEATS: [(&str, &str, &str); 4] = [
    (
        "pinched_volume_fraction",
        "1",
        "fraction of the volume of the pleats in those that need a pressure difference above 10 % for their flow of gas",
    ),
    (
        "pleat_relative_pressure_difference",
        "1",
        "pressure difference over the pressure that the pleat with the largest one needs for its flow",
    ),
    ("pleat_gap", "m", "mean gap at the mouth of that pleat"),
    (
        "pleat_conductance",
        "m3/s",
        "flow of gas that its mouth passes at most, at the pressure of the gas",
    ),
];
/// Pressure difference over the pressure above which a pleat counts as pinched. Chosen.
pub const MAX_UNIFORM: f64 = 0.1;
/// Length of the narrow passage behind a rim over that of a diagonal. Assumed: 45 to 55 mm in the
/// paper's capsule.
const PASSAGE: f64 = 1.0 / 15.0;
/// Elements that one sphere excludes together. Chosen.
const BLOCK: usize = 8;

/// The values of [`PLEATS`] now.
pub(super) fn values(pleats: &[Pleat], gas: &Gas, state: &FilmState) -> [f64; PLEATS.len()] {
    let (pressure, temperature) = (state.pressure, gas.temperature(state.gas));
    let (mut pinched, mut all, mut worst) = (0.0, 0.0, [0.0; 3]);
    for (index, pleat) in pleats.iter().enumerate() {
        let rims = [0, 1].map(|layer| gaps(pleat, layer, &state.positions));
        // Where both layers have a rim, the mouth is as long as one.
        let rims_used = rims.iter().filter(|rim| !rim.is_empty()).count() as f64;
        let passage = PASSAGE * pleat.diagonal;
        let (mut conductance, mut gap_sum, mut length_sum) = (0.0, 0.0, 0.0);
        for (length, gap) in rims.into_iter().flatten() {
            conductance += length * gas.slit_conductance(pressure, temperature, gap, passage);
            gap_sum += length * gap;
            length_sum += length;
        }
        conductance /= rims_used;
        let (volume, rate) = volume(pleat, &state.positions, &state.velocities);
        let difference = if rate == 0.0 { 0.0 } else { rate.abs() / conductance };
        all += volume.max(0.0);
        if difference > MAX_UNIFORM {
            pinched += volume.max(0.0);
        }
        if index == 0 || difference > worst[0] {
            worst = [difference, gap_sum / length_sum, conductance];
        }
    }
    let fraction = if pinched > 0.0 { pinched / all } else { 0.0 };
    [fraction, worst[0], worst[1], worst[2]]
}

/// Part of the length (m) and distance to the other layer (m) of each node on the rim of a layer.
fn gaps(pleat: &Pleat, layer: usize, positions: &Field) -> Vec<(f64, f64)> {
    let rim = &pleat.layers[layer].rim;
    if rim.is_empty() {
        return Vec::new();
    }
    // Most film is farther away than the nearest so far: spheres exclude eight elements together, and each alone.
    let film = &pleat.layers[1 - layer].film;
    let spheres: Vec<_> = film.iter().map(|nodes| Sphere::about(positions.at(*nodes))).collect();
    let blocks: Vec<_> = spheres.chunks(BLOCK).map(Sphere::around).collect();
    let mut nearest_element = 0;
    let gap = |node: u32| {
        let point = positions.get(node as usize);
        let distance = |element: usize| {
            let [a, b, c] = positions.at(film[element]);
            point_triangle(&[point, a, b, c]).squared.sqrt()
        };
        // First the element nearest to the previous node: the gap is at most its distance.
        let first = nearest_element;
        let mut nearest = distance(first);
        for (block, sphere) in blocks.iter().enumerate() {
            if !sphere.is_within(&point, nearest) {
                continue;
            }
            let elements = spheres.iter().enumerate().skip(block * BLOCK).take(BLOCK);
            for (element, sphere) in elements {
                if element != first && sphere.is_within(&point, nearest) {
                    let distance = distance(element);
                    if distance < nearest {
                        (nearest, nearest_element) = (distance, element);
                    }
                }
            }
        }
        nearest
    };
    let gaps = rim.iter().map(|(node, _)| *node).map(gap);
    rim.iter().map(|(_, length)| *length).zip(gaps).collect()
}

/// A sphere that holds film.
struct Sphere {
    centre: Vector3<f64>,
    radius: f64,
}

impl Sphere {
    /// About the corners of an element.
    fn about(corners: [Vector3<f64>; 3]) -> Self {
        let [a, b, c] = corners;
        let centre = (a + b + c) / 3.0;
        let squared = corners.map(|corner| (corner - centre).norm_squared());
        Self { centre, radius: squared[0].max(squared[1]).max(squared[2]).sqrt() }
    }

    /// Around spheres.
    fn around(spheres: &[Self]) -> Self {
        let centre =
            spheres.iter().map(|sphere| sphere.centre).sum::<Vector3<f64>>() / spheres.len() as f64;
        let reach = |sphere: &Self| (sphere.centre - centre).norm() + sphere.radius;
        Self { centre, radius: spheres.iter().map(reach).fold(0.0, f64::max) }
    }

    /// Whether a part of it may be nearer to a point than this distance (m).
    fn is_within(&self, point: &Vector3<f64>, distance: f64) -> bool {
        let reach = distance + self.radius;
        (point - self.centre).norm_squared() < reach * reach
    }
}

/// V (m³) and dV/dt (m³/s) of a pleat.
fn volume(pleat: &Pleat, positions: &Field, velocities: &Field) -> (f64, f64) {
    let film = pleat.layers.iter().flat_map(|layer| &layer.film);
    let (mut volume, mut rate) = (0.0, 0.0);
    for nodes in film.chain(&pleat.mouth) {
        let [a, b, c] = positions.at(*nodes);
        let [va, vb, vc] = velocities.at(*nodes);
        let (bc, ca, ab) = (b.cross(&c), c.cross(&a), a.cross(&b));
        volume += a.dot(&bc) / 6.0;
        rate += (va.dot(&bc) + vb.dot(&ca) + vc.dot(&ab)) / 6.0;
    }
    (volume, rate)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::fold::FoldPattern;
    use crate::geometry::mesh::{Mesh, Shape};
    use crate::scene::paper;

    #[test]
    fn a_stowed_pleat_is_as_wide_as_its_layers_are_apart() {
        let pattern = FoldPattern::new(&paper::design(8)).unwrap();
        let mesh = Mesh::new(&pattern, 8, Shape::Stowed(0.04)).unwrap();
        let positions = Field::of(&mesh.positions);
        let gaps = gaps(&mesh.pleats[0], 1, &positions);
        let length: f64 = gaps.iter().map(|(length, _)| length).sum();
        let mean = gaps.iter().map(|(part, gap)| part * gap).sum::<f64>() / length;
        // The diagonals rise from the cap through a third of the stack.
        assert!((mean - 0.04 / 6.0).abs() < 1e-4, "{mean}");
        let nearest = |node: u32| {
            let point = positions.get(node as usize);
            let distance = |nodes: &[u32; 3]| {
                let [a, b, c] = positions.at(*nodes);
                point_triangle(&[point, a, b, c]).squared.sqrt()
            };
            mesh.pleats[0].layers[0].film.iter().map(distance).fold(f64::INFINITY, f64::min)
        };
        for ((node, _), (_, gap)) in mesh.pleats[0].layers[1].rim.iter().zip(&gaps) {
            assert!((nearest(*node) - gap).abs() < 1e-15);
        }
        // Film that grows in all directions at the rate 1: dV/dt = 3 V.
        let (volume, rate) = volume(&mesh.pleats[1], &positions, &positions);
        assert!(volume > 0.0 && (rate - 3.0 * volume).abs() < 1e-12 * volume);
    }
}
