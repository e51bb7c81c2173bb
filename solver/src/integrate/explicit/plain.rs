//! One step of film without contact at a fixed overpressure, twice: as the solver takes it, and as plain
//! loops over elements and nodes.
//!
//! The plain one is what the other is measured against, and tested against: same layout, same
//! operations in the same order, so the same bits; no lanes and no instruction set asked for.

use super::update::{Push, drift_nodes, kick_nodes};
use crate::forces::membrane::{Drag, NodeForces, Sums, film_pass};
use crate::model::FilmModel;
use crate::simd::{NodeSum, Path, WIDTH};
use crate::state::Field;

/// Film in motion, without gas, supports that move, or contact.
#[derive(Debug, Clone, PartialEq)]
pub struct Moving {
    /// Places of nodes, m.
    pub places: Field,
    /// Their velocities, m/s.
    pub velocities: Field,
    /// Forces on them; those of contact stay as they are.
    pub forces: NodeForces,
    /// What the pass before left of elements.
    pub drag: Drag,
    next: Field,
}

impl Moving {
    /// At places (m) with velocities (m/s); forces are those there.
    pub fn new(path: Path, model: &FilmModel, places: Field, velocities: Field) -> Self {
        let (mut forces, mut drag) = (NodeForces::new(model), Drag::new(model));
        let _ = film_pass(path, model, &places, &velocities, 0.0, &mut drag, &mut forces);
        Self { places, velocities, forces, drag, next: Field::zeros(model.nodes()) }
    }
}

/// Kick, drift of `length` (s), and forces where that leads, as the solver does it: the sums of the
/// pass, and the largest squared speed, m²/s². `free` is 1 where a component of a node is not held, 0
/// where it is.
pub fn fast_step(
    path: Path,
    model: &FilmModel,
    push: &Push,
    free: &Field,
    length: f64,
    film: &mut Moving,
) -> (Sums, f64) {
    let Moving { places, velocities, forces, drag, next } = film;
    kick_nodes(path, model, forces, push, free, velocities, next);
    core::mem::swap(velocities, next);
    let fastest = drift_nodes(path, velocities, length, places);
    (film_pass(path, model, places, velocities, length, drag, forces), fastest)
}

/// The same by plain loops: the same bits.
pub fn plain_step(
    model: &FilmModel,
    push: &Push,
    free: &Field,
    length: f64,
    film: &mut Moving,
) -> (Sums, f64) {
    let Moving { places, velocities, forces, drag, next } = film;
    for node in 0..model.nodes() {
        let force = forces.film.get(node)
            + forces.contact.get(node)
            + forces.area.get(node) * push.overpressure
            + push.gravity * (model.mass[node] * push.weight);
        let velocity = velocities.get(node);
        let change = velocity * (push.keep - 1.0) + force * (model.inverse_mass[node] * push.gain);
        next.set(node, velocity + change.component_mul(&free.get(node)));
    }
    core::mem::swap(velocities, next);
    let mut fastest = 0.0_f64;
    for node in 0..model.nodes() {
        let velocity = velocities.get(node);
        places.set(node, places.get(node) + velocity * length);
        fastest = fastest.max(velocity.norm_squared());
    }
    (elements(model, places, velocities, length, drag, forces), fastest)
}

type Vector = [f64; 3];

fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn plus(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn times(a: Vector, factor: f64) -> Vector {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// By columns: of edges p and q, F or its rate.
fn gradient([a, b, c, d]: [f64; 4], [p, q]: [Vector; 2]) -> [Vector; 2] {
    [plus(times(p, a), times(q, c)), plus(times(p, b), times(q, d))]
}

/// S, as xx, yy, xy, and its larger principal value, Pa, at a strain.
fn stress(model: &FilmModel, [xx, yy, xy]: [f64; 3]) -> ([f64; 3], f64) {
    let material = &model.material;
    let (k, nu) = (material.plane_modulus(), material.poisson_ratio);
    let (half, mean) = ((xx - yy) * 0.5, (xx + yy) * 0.5);
    let radius = (half * half + xy * xy).sqrt();
    let (e1, e2) = (mean + radius, mean - radius);
    let full = full_stress(model, [xx, yy, xy]);
    let full_largest = (e1 + e2 * nu) * k;
    if e2 + e1 * nu > 0.0 {
        return (full, full_largest);
    }
    let (mut own, mut largest) = ([0.0; 3], 0.0);
    if e1 > 0.0 {
        largest = e1 * material.youngs_modulus;
        let lean = largest * 0.5 / radius;
        own = [largest * 0.5 + lean * half, largest * 0.5 - lean * half, lean * xy];
    }
    let blend = |own: f64, full: f64| own + (full - own) * material.compression;
    let [a, b, c] = own;
    ([blend(a, full[0]), blend(b, full[1]), blend(c, full[2])], blend(largest, full_largest))
}

fn full_stress(model: &FilmModel, [xx, yy, xy]: [f64; 3]) -> [f64; 3] {
    let (k, nu) = (model.material.plane_modulus(), model.material.poisson_ratio);
    [(xx + yy * nu) * k, (yy + xx * nu) * k, xy * (k * (1.0 - nu))]
}

/// Forces of a stress on the three corners, N.
fn corner_forces(
    [a, b, c, d]: [f64; 4],
    volume: f64,
    [f, g]: [Vector; 2],
    [xx, yy, xy]: [f64; 3],
) -> [Vector; 3] {
    let (p, q) = (plus(times(f, xx), times(g, xy)), plus(times(f, xy), times(g, yy)));
    let loss = -volume;
    let first = times(plus(times(p, a), times(q, b)), loss);
    let second = times(plus(times(p, c), times(q, d)), loss);
    [plus(first, second).map(|entry| -entry), first, second]
}

fn contract([a, b, c]: [f64; 3], [d, e, f]: [f64; 3]) -> f64 {
    a * d + b * e + (c * f) * 2.0
}

/// [`film_pass`], element by element.
fn elements(
    model: &FilmModel,
    places: &Field,
    velocities: &Field,
    way: f64,
    drag: &mut Drag,
    out: &mut NodeForces,
) -> Sums {
    let (mut volumes, mut powers, mut largest) = ([0.0; WIDTH], [0.0; WIDTH], 0.0);
    for (element, triangle) in model.triangles.iter().enumerate() {
        let shape = model.inverse_shape.each_ref().map(|column| column[element]);
        let volume = model.volume[element];
        let [a, b, c] = triangle.map(|node| <Vector>::from(places.get(node as usize)));
        let [u, v, w] = triangle.map(|node| <Vector>::from(velocities.get(node as usize)));
        volumes[element % WIDTH] += dot(a, cross(b, c));
        let edges = [minus(b, a), minus(c, a)];
        let area = times(cross(edges[0], edges[1]), 1.0 / 6.0);
        let [f, g] = gradient(shape, edges);
        let strain = [(dot(f, f) - 1.0) * 0.5, (dot(g, g) - 1.0) * 0.5, dot(f, g) * 0.5];
        let (stress, most) = stress(model, strain);
        largest = if largest > most { largest } else { most };
        let [fr, gr] = gradient(shape, [minus(v, u), minus(w, u)]);
        let rate = [dot(f, fr), dot(g, gr), (dot(f, gr) + dot(g, fr)) * 0.5];
        let time = model.viscous_time[element];
        let viscous = full_stress(model, rate).map(|entry| entry * time);

        let before = drag.stress.each_ref().map(|column| column[element]);
        for (column, entry) in drag.stress.iter_mut().zip(viscous) {
            column[element] = entry;
        }
        let both = plus(before, viscous);
        let gram = [dot(fr, fr), dot(gr, gr), dot(fr, gr)];
        powers[element % WIDTH] += (contract(both, rate) - contract(before, gram) * way) * volume;

        let elastic = corner_forces(shape, volume, [f, g], stress);
        let slowing = corner_forces(shape, volume, [f, g], viscous);
        for (corner, node) in triangle.iter().enumerate() {
            let force = plus(elastic[corner], slowing[corner]);
            let sum = &mut out.sums[*node as usize];
            for axis in 0..3 {
                sum.film[axis] += force[axis];
                sum.area[axis] += area[axis];
            }
        }
    }
    for (node, sum) in out.sums.iter_mut().enumerate() {
        let ([fx, fy, fz, _], [ax, ay, az, _]) = (sum.film, sum.area);
        out.film.set(node, [fx, fy, fz].into());
        out.area.set(node, [ax, ay, az].into());
        *sum = NodeSum::default();
    }
    let tree = |[a, b, c, d, e, f, g, h]: [f64; WIDTH]| ((a + e) + (c + g)) + ((b + f) + (d + h));
    Sums { six_volumes: tree(volumes), viscous_power: tree(powers), largest_stress: largest }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector2, Vector3};
    use proptest::prelude::*;

    use super::*;
    use crate::forces::membrane::strain;
    use crate::material::Regime;
    use crate::scene::Film;

    /// A sheet of 7 x 5 cells: 70 elements, the last block not full; 48 nodes.
    fn sheet(compression: f64) -> (FilmModel, Vec<Vector3<f64>>) {
        let film = Film {
            youngs_modulus: 3.45e9,
            poisson_ratio: 0.3,
            density: 1400.0,
            thickness: 25.4e-6,
            compression,
            viscosity: 0.1,
            temperature: 293.0,
        };
        let place = |i: u32, j: u32| Vector2::new(0.1 * f64::from(i), 0.08 * f64::from(j));
        let flat: Vec<_> = (0..6).flat_map(|j| (0..8).map(move |i| place(i, j))).collect();
        let mut triangles = Vec::new();
        for j in 0..5 {
            for i in 0..7 {
                let [a, b, c, d] = [8 * j + i, 8 * j + i + 1, 8 * j + i + 9, 8 * j + i + 8];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        let reference: Vec<_> =
            triangles.iter().map(|t: &[u32; 3]| t.map(|node| flat[node as usize])).collect();
        let model = FilmModel::new(&film, flat.len(), &triangles, &reference).expect("a film");
        (model, flat.iter().map(|p| Vector3::new(p.x, p.y, 0.3)).collect())
    }

    fn bits(film: &Moving) -> Vec<u64> {
        let Moving { places, velocities, forces, drag, .. } = film;
        let fields = [places, velocities, &forces.film, &forces.area];
        let nodes = fields.into_iter().flat_map(|field| [&field.x, &field.y, &field.z]);
        // Not the elements of no volume that fill the last block: the plain loops have none.
        nodes
            .flatten()
            .chain(drag.stress.iter().flat_map(|column| &column[..70]))
            .map(|number| number.to_bits())
            .collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Sheets pulled, pushed and sheared at random: all regimes, every compression, every path.
        #[test]
        fn plain_loops_give_the_same_bits(
            offsets in prop::collection::vec(prop::array::uniform6(-1.0..1.0_f64), 48),
            compression in prop::sample::select(vec![0.0, 0.3, 1.0]),
            size in prop::sample::select(vec![1e-5, 1e-3, 0.02]),
            stretch in prop::array::uniform2(0.98..1.02_f64),
            held in 0_usize..48,
        ) {
            let (model, flat) = sheet(compression);
            let place = |(x, off): (&Vector3<f64>, &[f64; 6])| {
                let x = Vector3::new(x.x * stretch[0], x.y * stretch[1], x.z);
                x + Vector3::new(off[0], off[1], off[2]) * size
            };
            let places: Vec<_> = flat.iter().zip(&offsets).map(place).collect();
            let places = Field::of(&places);
            let velocity = |off: &[f64; 6]| Vector3::new(off[3], off[4], off[5]) * 10.0;
            let velocities = Field::of(&offsets.iter().map(velocity).collect::<Vec<_>>());
            let mut free = Field::of(&vec![Vector3::repeat(1.0); 48]);
            free.set(held, Vector3::new(0.0, 1.0, 0.0));
            let length = 1e-7;
            let push = Push {
                overpressure: 120.0,
                gravity: Vector3::new(0.0, 1.0, -9.81),
                weight: 1.0,
                keep: 0.999,
                gain: length,
            };
            let start = Moving::new(Path::Scalar, &model, places, velocities);
            let mut plain = start.clone();
            let told: Vec<_> = (0..3)
                .map(|_| plain_step(&model, &push, &free, length, &mut plain))
                .collect();
            for path in Path::ALL {
                let mut film = start.clone();
                for (sums, fastest) in &told {
                    let (own, speed) = fast_step(path, &model, &push, &free, length, &mut film);
                    prop_assert_eq!(own.six_volumes.to_bits(), sums.six_volumes.to_bits());
                    prop_assert_eq!(own.viscous_power.to_bits(), sums.viscous_power.to_bits());
                    prop_assert_eq!(own.largest_stress.to_bits(), sums.largest_stress.to_bits());
                    prop_assert_eq!(speed.to_bits(), fastest.to_bits());
                }
                prop_assert!(bits(&film) == bits(&plain), "{}", path.name());
            }
        }
    }

    #[test]
    fn the_sheets_have_every_regime() {
        let (model, flat) = sheet(0.0);
        let met = |stretch: [f64; 2]| {
            let to = |x: &Vector3<f64>| Vector3::new(x.x * stretch[0], x.y * stretch[1], x.z);
            let places = Field::of(&flat.iter().map(to).collect::<Vec<_>>());
            model.material.regime(strain(&model, &places, 0))
        };
        assert_eq!(met([1.01, 1.01]), Regime::Taut);
        assert_eq!(met([1.01, 0.99]), Regime::Wrinkled);
        assert_eq!(met([0.99, 0.99]), Regime::Slack);
    }

    /// Half the step times the power told is the work of the viscous forces: minus their trapezoid along
    /// the way.
    #[test]
    fn the_power_told_is_the_trapezoid_of_the_forces() {
        use crate::forces::membrane::viscous_forces;

        let (model, flat) = sheet(0.0);
        let wave = |k: usize| libm::sin(1.7 * k as f64);
        let moving = |k: usize| Vector3::new(wave(k), wave(2 * k + 1), wave(3 * k)) * 20.0;
        let velocities = Field::of(&(0..48).map(moving).collect::<Vec<_>>());
        let mut film = Moving::new(Path::best(), &model, Field::of(&flat), velocities);
        let free = Field::of(&vec![Vector3::repeat(1.0); 48]);
        let length = 2e-6;
        let push = Push {
            overpressure: 0.0,
            gravity: Vector3::zeros(),
            weight: 1.0,
            keep: 1.0,
            gain: length,
        };
        for _ in 0..3 {
            let before = viscous_forces(&model, &film.places, &film.velocities);
            let (sums, _) = fast_step(Path::best(), &model, &push, &free, length, &mut film);
            let after = viscous_forces(&model, &film.places, &film.velocities);
            let along = |forces: &Field| -> f64 {
                forces.iter().zip(film.velocities.iter()).map(|(f, v)| -f.dot(&v)).sum()
            };
            let trapezoid = along(&before) + along(&after);
            assert!((sums.viscous_power / trapezoid - 1.0).abs() < 1e-9, "{sums:?} {trapezoid}");
        }
    }
}
