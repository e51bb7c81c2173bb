//! One step of film without contact at a fixed overpressure, twice: as the solver takes it, and as plain
//! loops over elements and nodes.
//!
//! The plain one is what the other is measured against, and tested against: same layout, same
//! operations in the same order, so the same bits; no lanes and no instruction set asked for.

use nalgebra::Vector3;

use super::update::{Push, drift_nodes, kick_nodes};
use crate::geometry::field::Field;
use crate::mechanics::film_model::{ElementBlock, FilmModel};
use crate::mechanics::forces::membrane::{
    NodeForces, SIXTH, Sums, ViscousHistory, assemble_membrane,
};
use crate::mechanics::supports::Free;
use crate::platform::simd::{InstructionSet, NodeSum, WIDTH};

/// Film in motion, without gas, supports that move, or contact.
#[derive(Debug, Clone, PartialEq)]
pub struct Moving {
    /// Places of nodes, m.
    pub places: Field,
    /// Their velocities, m/s.
    pub velocities: Field,
    /// Forces on them; those of contact stay as they are.
    pub forces: NodeForces,
    /// What elements remember of the last step.
    pub past: Vec<[ViscousHistory; 2]>,
    next: Field,
}

impl Moving {
    /// At places (m) with velocities (m/s); forces are those there.
    pub fn new(path: InstructionSet, model: &FilmModel, places: Field, velocities: Field) -> Self {
        let mut forces = NodeForces::new(model);
        let mut past = ViscousHistory::in_motion(model, &places, &velocities);
        let _ = assemble_membrane(path, model, &places, 0.0, &mut past, &mut forces);
        Self { places, velocities, forces, past, next: Field::zeros(model.nodes()) }
    }
}

/// Kick, drift of `length` (s), and forces where that leads, as the solver does it: the sums of the
/// pass, and the largest squared speed, m²/s².
pub fn fast_step(
    path: InstructionSet,
    model: &FilmModel,
    push: &Push,
    free: &Free,
    length: f64,
    film: &mut Moving,
) -> (Sums, f64) {
    let Moving { places, velocities, forces, past, next } = film;
    kick_nodes(path, model, forces, push, free, velocities, next);
    core::mem::swap(velocities, next);
    let fastest = drift_nodes(path, velocities, length, places);
    (assemble_membrane(path, model, places, length, past, forces), fastest)
}

/// The same by plain loops: the same bits.
pub fn plain_step(
    model: &FilmModel,
    push: &Push,
    free: &Free,
    length: f64,
    film: &mut Moving,
) -> (Sums, f64) {
    let Moving { places, velocities, forces, past, next } = film;
    let heavy = push.gravity != Vector3::zeros();
    for node in 0..model.nodes() {
        let [x, y, z, _] = forces.sums[node].normal;
        let mut force = forces.film(node);
        if push.pressed {
            force += forces.contact.get(node);
        }
        force += Vector3::new(x, y, z) * (push.overpressure * SIXTH);
        if heavy {
            force += push.gravity * (model.mass[node] * push.weight);
        }
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
    (elements(model, places, length, past, forces), fastest)
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

/// Of a strain (xx + yy, xx − yy, 2xy): the mean of the stress, how it leans with the strain, and its
/// larger principal value, Pa.
fn response(model: &FilmModel, [sum, difference, shear]: Vector) -> [f64; 3] {
    let material = &model.material;
    let (k, nu) = (material.plane_modulus(), material.poisson_ratio);
    let diameter = (difference * difference + shear * shear).sqrt();
    let full = [sum * (0.5 * k * (1.0 + nu)), 0.5 * k * (1.0 - nu)];
    let [mean, shear_modulus] = if sum * (1.0 + nu) - diameter * (1.0 - nu) > 0.0 {
        full
    } else {
        let (twice, c) = (sum + diameter, material.compression);
        let tension = twice * (0.25 * material.youngs_modulus);
        let [mean, shear_modulus] =
            if twice > 0.0 { [tension, tension / diameter] } else { [0.0; 2] };
        [mean + (full[0] - mean) * c, shear_modulus + (full[1] - shear_modulus) * c]
    };
    [mean, shear_modulus, mean + shear_modulus * diameter]
}

fn contract(stress: Vector, strain: Vector) -> f64 {
    stress[0] * strain[0] + stress[1] * strain[1] + stress[2] * strain[2]
}

/// Of one element, [`crate::mechanics::film_model::ElementBlock`].
struct Constants {
    inverse: Vector,
    minus_volume: f64,
    drag: f64,
}

impl Constants {
    fn of(block: &ElementBlock, lane: usize) -> Self {
        Self {
            inverse: block.inverse.each_ref().map(|lanes| lanes.0[lane]),
            minus_volume: block.minus_volume.0[lane],
            drag: block.drag.0[lane],
        }
    }
}

/// What an element tells of itself.
struct ElementResponse {
    strain: Vector,
    viscous: Vector,
    pull: Vector,
    taken: f64,
    largest: f64,
}

fn told(
    model: &FilmModel,
    Constants { inverse: [a, b, d], minus_volume, drag }: &Constants,
    [pp, pq, qq]: Vector,
    inverse_step: f64,
    [strain_before, before]: [Vector; 2],
) -> ElementResponse {
    let nu = model.material.poisson_ratio;
    let (along, across) = (b * pp, d * pq);
    let lean = along + across;
    let (xx, yy) = ((a * a) * pp, b * lean + (d * d) * qq);
    let strain = [xx + yy - 1.0, xx - yy, a * (along + lean)];
    let change = minus(strain, strain_before);
    let (both, apart) = (inverse_step * (0.5 * (1.0 + nu)), inverse_step * (0.5 * (1.0 - nu)));
    let (mean, shear) = (drag * both, drag * apart);
    let viscous = [mean * change[0], shear * change[1], shear * change[2]];
    let taken = contract(plus(viscous, before), change);

    let [mean, shear_modulus, largest] = response(model, strain);
    let shear_modulus = shear_modulus * minus_volume;
    let mean = mean * minus_volume + viscous[0];
    let half = shear_modulus * strain[1] + viscous[1];
    let (xx, yy) = (mean + half, mean - half);
    let xy = shear_modulus * strain[2] + viscous[2];
    let across = a * xy;
    let lean = b * yy + across;
    let pull = [(a * a) * xx + b * (lean + across), d * lean, (d * d) * yy];
    ElementResponse { strain, viscous, pull, taken, largest }
}

/// [`assemble_membrane`], kite by kite.
fn elements(
    model: &FilmModel,
    places: &Field,
    step: f64,
    past: &mut [[ViscousHistory; 2]],
    out: &mut NodeForces,
) -> Sums {
    let (mut volumes, mut works, mut largest) = ([0.0; WIDTH], [0.0; WIDTH], 0.0_f64);
    let inverse_step = 1.0 / step;
    out.sums.fill(NodeSum::default());
    for (index, kite) in model.kites.iter().enumerate() {
        let (block, lane) = (index / WIDTH, index % WIDTH);
        let corners = kite.map(|node| <Vector>::from(places.get(node as usize)));
        let [p, d, q] = [1, 2, 3].map(|other| minus(corners[other], corners[0]));
        let (first_normal, second_normal) = (cross(p, d), cross(d, q));
        let normal = plus(first_normal, second_normal);
        volumes[lane] += dot(corners[0], normal);

        let shared = dot(d, d) * 0.5;
        let metrics = [[dot(p, p) * 0.5, dot(p, d), shared], [shared, dot(d, q), dot(q, q) * 0.5]];
        let (mut pulls, mut takens) = ([[0.0; 3]; 2], [0.0; 2]);
        for half in 0..2 {
            let constants = Constants::of(&model.constants[block][half], lane);
            let ViscousHistory { strain, drag } = &mut past[block][half];
            let before = [&*strain, &*drag].map(|own| own.each_ref().map(|lanes| lanes.0[lane]));
            let told = told(model, &constants, metrics[half], inverse_step, before);
            for axis in 0..3 {
                strain[axis].0[lane] = told.strain[axis];
                drag[axis].0[lane] = told.viscous[axis];
            }
            (pulls[half], takens[half]) = (told.pull, told.taken);
            largest = if largest > told.largest { largest } else { told.largest };
        }
        works[lane] += takens[0] + takens[1];

        let [r, s] = pulls;
        let at_a = plus(times(p, r[0]), times(d, r[1]));
        let at_t = plus(plus(times(p, r[1]), times(d, r[2] + s[0])), times(q, s[1]));
        let at_b = plus(times(d, s[1]), times(q, s[2]));
        let at_s = plus(plus(at_a, at_t), at_b).map(|entry| -entry);
        let given = [(at_s, normal), (at_a, first_normal), (at_t, normal), (at_b, second_normal)];
        for ((force, normal), node) in given.into_iter().zip(kite) {
            let sum = &mut out.sums[*node as usize];
            for axis in 0..3 {
                sum.film[axis] += force[axis];
                sum.normal[axis] += normal[axis];
            }
        }
    }
    let tree = |[a, b, c, d, e, f, g, h]: [f64; WIDTH]| ((a + e) + (c + g)) + ((b + f) + (d + h));
    let viscous_work = -0.5 * tree(works);
    Sums { six_volumes: tree(volumes), viscous_work, largest_stress: largest }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;
    use proptest::prelude::*;

    use super::*;
    use crate::mechanics::forces::membrane::strain;
    use crate::mechanics::material::Regime;
    use crate::scene::Film;

    /// 7 x 5 cells less half a one: 69 elements, one alone in its kite, the last block not full; 48 nodes.
    fn sheet(compression: f64) -> (FilmModel, Vec<Vector3<f64>>) {
        let film = Film { compression, ..Film::PAPER };
        let place = |i: u32, j: u32| Vector2::new(0.1 * f64::from(i), 0.08 * f64::from(j));
        let flat: Vec<_> = (0..6).flat_map(|j| (0..8).map(move |i| place(i, j))).collect();
        let mut triangles = Vec::new();
        for a in (0..35).map(|cell| cell / 7 * 8 + cell % 7) {
            triangles.extend([[a, a + 1, a + 9], [a, a + 9, a + 8]]);
        }
        triangles.truncate(69);
        let reference: Vec<_> =
            triangles.iter().map(|t: &[u32; 3]| t.map(|node| flat[node as usize])).collect();
        let model = FilmModel::new(&film, flat.len(), &triangles, &reference).expect("a film");
        (model, flat.iter().map(|p| Vector3::new(p.x, p.y, 0.3)).collect())
    }

    fn bits(film: &Moving, kites: usize) -> Vec<u64> {
        let Moving { places, velocities, forces, past, .. } = film;
        let (films, areas) = (forces.films(), forces.areas());
        let nodes = [places, velocities, &films, &areas].into_iter().flat_map(Field::iter);
        // Not the elements of no volume that fill the last block: the plain loops have none.
        nodes
            .flat_map(|own| [own.x, own.y, own.z])
            .chain((0..kites).flat_map(|at| {
                let own = past[at / WIDTH].iter().flat_map(|own| [own.strain, own.drag]);
                own.flatten().map(move |entry| entry.0[at % WIDTH])
            }))
            .map(f64::to_bits)
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
            (pressed, gravity) in (any::<bool>(), any::<bool>()),
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
            let mut free = Free::all(48);
            free.set(held, Vector3::new(0.0, 1.0, 0.0));
            let length = 1e-7;
            let push = Push {
                overpressure: 120.0,
                gravity: Vector3::new(0.0, 1.0, -9.81) * f64::from(u8::from(gravity)),
                weight: 1.0,
                keep: 0.999,
                gain: length,
                pressed,
            };
            let start = Moving::new(InstructionSet::Scalar, &model, places, velocities);
            let mut plain = start.clone();
            let told: Vec<_> = (0..3)
                .map(|_| plain_step(&model, &push, &free, length, &mut plain))
                .collect();
            for path in InstructionSet::ALL {
                let mut film = start.clone();
                for (sums, fastest) in &told {
                    let (own, speed) = fast_step(path, &model, &push, &free, length, &mut film);
                    prop_assert_eq!(own.six_volumes.to_bits(), sums.six_volumes.to_bits());
                    prop_assert_eq!(own.viscous_work.to_bits(), sums.viscous_work.to_bits());
                    prop_assert_eq!(own.largest_stress.to_bits(), sums.largest_stress.to_bits());
                    prop_assert_eq!(speed.to_bits(), fastest.to_bits());
                }
                let kites = model.kites.len();
                prop_assert!(bits(&film, kites) == bits(&plain, kites), "{}", path.name());
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
}
