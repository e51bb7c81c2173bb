//! One step of film without contact at a fixed overpressure, in two versions: [`vector_step`] as the
//! solver takes it, and [`reference_step`] as plain loops over elements and nodes.
//!
//! Tests and the bench compare the two. The reference has the same data layout and the same operations
//! in the same order, so it gives the same bits; it uses no vector instructions.

use nalgebra::Vector3;

use super::update::{KickParameters, drift_nodes, kick_nodes};
use crate::geometry::field::Field;
use crate::mechanics::film_model::{ElementBlock, FilmModel};
use crate::mechanics::forces::membrane::{
    NodeForces, SIXTH, Sums, ViscousHistory, assemble_membrane,
};
use crate::mechanics::supports::Free;
use crate::platform::simd::{InstructionSet, NodeSum, WIDTH};

/// Film in motion, without gas, moving supports or contact.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmMotion {
    /// Positions of the nodes, m.
    pub positions: Field,
    /// Velocities of the nodes, m/s.
    pub velocities: Field,
    /// Forces on the nodes. The contact forces never change.
    pub forces: NodeForces,
    /// Strain and viscous stress of the elements at the end of the last step.
    pub histories: Vec<[ViscousHistory; 2]>,
    next: Field,
}

impl FilmMotion {
    /// Film at these positions (m) with these velocities (m/s); computes the forces there.
    pub fn new(
        instruction_set: InstructionSet,
        model: &FilmModel,
        positions: Field,
        velocities: Field,
    ) -> Self {
        let mut forces = NodeForces::new(model);
        let mut histories = ViscousHistory::in_motion(model, &positions, &velocities);
        let _ =
            assemble_membrane(instruction_set, model, &positions, 0.0, &mut histories, &mut forces);
        Self { positions, velocities, forces, histories, next: Field::zeros(model.nodes()) }
    }
}

/// Kick, drift of `length` (s), and forces at the new positions, as the solver computes them. Returns the
/// sums over elements and the largest squared speed, m²/s².
pub fn vector_step(
    instruction_set: InstructionSet,
    model: &FilmModel,
    parameters: &KickParameters,
    free: &Free,
    length: f64,
    film: &mut FilmMotion,
) -> (Sums, f64) {
    let FilmMotion { positions, velocities, forces, histories, next } = film;
    kick_nodes(instruction_set, model, forces, parameters, free, velocities, next);
    core::mem::swap(velocities, next);
    let fastest = drift_nodes(instruction_set, velocities, length, positions);
    (assemble_membrane(instruction_set, model, positions, length, histories, forces), fastest)
}

/// [`vector_step`] as plain loops: the same bits.
pub fn reference_step(
    model: &FilmModel,
    parameters: &KickParameters,
    free: &Free,
    length: f64,
    film: &mut FilmMotion,
) -> (Sums, f64) {
    let FilmMotion { positions, velocities, forces, histories, next } = film;
    let has_gravity = parameters.gravity != Vector3::zeros();
    for node in 0..model.nodes() {
        let [x, y, z, _] = forces.sums[node].normal;
        let mut force = forces.film(node);
        if parameters.contact_active {
            force += forces.contact.get(node);
        }
        force += Vector3::new(x, y, z) * (parameters.overpressure * SIXTH);
        if has_gravity {
            force += parameters.gravity * (model.mass[node] * parameters.weight_factor);
        }
        let velocity = velocities.get(node);
        let change = velocity * (parameters.velocity_factor - 1.0)
            + force * (model.inverse_mass[node] * parameters.acceleration_factor);
        next.set(node, velocity + change.component_mul(&free.get(node)));
    }
    core::mem::swap(velocities, next);
    let mut max_squared = 0.0_f64;
    for node in 0..model.nodes() {
        let velocity = velocities.get(node);
        positions.set(node, positions.get(node) + velocity * length);
        max_squared = max_squared.max(velocity.norm_squared());
    }
    (assemble_reference(model, positions, length, histories, forces), max_squared)
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

/// Stress of a strain (Exx + Eyy, Exx − Eyy, 2 Exy): its mean, the factor from the deviatoric strain to the
/// deviatoric stress, and its larger principal value, Pa.
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

/// The constants of one element: a lane of [`crate::mechanics::film_model::ElementBlock`].
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

/// Response of one element.
struct ElementResponse {
    /// Strain (Exx + Eyy, Exx − Eyy, 2 Exy).
    strain: Vector,
    /// −A t times the viscous stress, J.
    viscous: Vector,
    /// −r of [`assemble_membrane`]'s equations, N/m.
    pull: Vector,
    /// Minus twice the viscous work of the step, J.
    viscous_work: f64,
    /// Larger principal stress, Pa.
    max_stress: f64,
}

fn element_response(
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
    let (mean_factor, shear_factor) =
        (inverse_step * (0.5 * (1.0 + nu)), inverse_step * (0.5 * (1.0 - nu)));
    let (mean, shear) = (drag * mean_factor, drag * shear_factor);
    let viscous = [mean * change[0], shear * change[1], shear * change[2]];
    let viscous_work = contract(plus(viscous, before), change);

    let [mean, shear_modulus, max_stress] = response(model, strain);
    let shear_modulus = shear_modulus * minus_volume;
    let mean = mean * minus_volume + viscous[0];
    let half = shear_modulus * strain[1] + viscous[1];
    let (xx, yy) = (mean + half, mean - half);
    let xy = shear_modulus * strain[2] + viscous[2];
    let across = a * xy;
    let lean = b * yy + across;
    let pull = [(a * a) * xx + b * (lean + across), d * lean, (d * d) * yy];
    ElementResponse { strain, viscous, pull, viscous_work, max_stress }
}

/// [`assemble_membrane`], kite by kite.
fn assemble_reference(
    model: &FilmModel,
    positions: &Field,
    step: f64,
    histories: &mut [[ViscousHistory; 2]],
    out: &mut NodeForces,
) -> Sums {
    let (mut volumes, mut works, mut max_stress) = ([0.0; WIDTH], [0.0; WIDTH], 0.0_f64);
    let inverse_step = 1.0 / step;
    out.sums.fill(NodeSum::default());
    for (index, kite) in model.kites.iter().enumerate() {
        let (block, lane) = (index / WIDTH, index % WIDTH);
        let corners = kite.map(|node| <Vector>::from(positions.get(node as usize)));
        let [p, d, q] = [1, 2, 3].map(|other| minus(corners[other], corners[0]));
        let (first_normal, second_normal) = (cross(p, d), cross(d, q));
        let normal = plus(first_normal, second_normal);
        volumes[lane] += dot(corners[0], normal);

        let shared = dot(d, d) * 0.5;
        let metrics = [[dot(p, p) * 0.5, dot(p, d), shared], [shared, dot(d, q), dot(q, q) * 0.5]];
        let (mut pulls, mut viscous_works) = ([[0.0; 3]; 2], [0.0; 2]);
        for half in 0..2 {
            let constants = Constants::of(&model.constants[block][half], lane);
            let ViscousHistory { strain, drag } = &mut histories[block][half];
            let before =
                [&*strain, &*drag].map(|column| column.each_ref().map(|lanes| lanes.0[lane]));
            let response = element_response(model, &constants, metrics[half], inverse_step, before);
            for axis in 0..3 {
                strain[axis].0[lane] = response.strain[axis];
                drag[axis].0[lane] = response.viscous[axis];
            }
            (pulls[half], viscous_works[half]) = (response.pull, response.viscous_work);
            let stress = response.max_stress;
            max_stress = if max_stress > stress { max_stress } else { stress };
        }
        works[lane] += viscous_works[0] + viscous_works[1];

        let [r, s] = pulls;
        let at_a = plus(times(p, r[0]), times(d, r[1]));
        let at_t = plus(plus(times(p, r[1]), times(d, r[2] + s[0])), times(q, s[1]));
        let at_b = plus(times(d, s[1]), times(q, s[2]));
        let at_s = plus(plus(at_a, at_t), at_b).map(|entry| -entry);
        let contributions =
            [(at_s, normal), (at_a, first_normal), (at_t, normal), (at_b, second_normal)];
        for ((force, normal), node) in contributions.into_iter().zip(kite) {
            let sum = &mut out.sums[*node as usize];
            for axis in 0..3 {
                sum.film[axis] += force[axis];
                sum.normal[axis] += normal[axis];
            }
        }
    }
    let tree = |[a, b, c, d, e, f, g, h]: [f64; WIDTH]| ((a + e) + (c + g)) + ((b + f) + (d + h));
    let viscous_work = -0.5 * tree(works);
    Sums { six_volumes: tree(volumes), viscous_work, largest_stress: max_stress }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;
    use proptest::prelude::*;

    use super::*;
    use crate::mechanics::forces::membrane::strain;
    use crate::mechanics::material::Regime;
    use crate::scene::Film;

    /// 7 x 5 cells without the last half cell: 69 elements, one alone in its kite, the last block partly
    /// filled; 48 nodes.
    fn sheet(compression: f64) -> (FilmModel, Vec<Vector3<f64>>) {
        let film = Film { compression, ..Film::PAPER };
        let position = |i: u32, j: u32| Vector2::new(0.1 * f64::from(i), 0.08 * f64::from(j));
        let flat: Vec<_> = (0..6).flat_map(|j| (0..8).map(move |i| position(i, j))).collect();
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

    fn bits(film: &FilmMotion, kites: usize) -> Vec<u64> {
        let FilmMotion { positions, velocities, forces, histories, .. } = film;
        let (films, areas) = (forces.films(), forces.areas());
        let nodes = [positions, velocities, &films, &areas].into_iter().flat_map(Field::iter);
        // Without the padding of the last block: the plain loops do not touch it.
        nodes
            .flat_map(|vector| [vector.x, vector.y, vector.z])
            .chain((0..kites).flat_map(|kite| {
                let history = histories[kite / WIDTH].iter();
                let entries = history.flat_map(|history| [history.strain, history.drag]);
                entries.flatten().map(move |entry| entry.0[kite % WIDTH])
            }))
            .map(f64::to_bits)
            .collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Sheets pulled, pushed and sheared at random: all regimes, several compression fractions, every
        /// instruction set.
        #[test]
        fn reference_step_gives_the_bits_of_every_instruction_set(
            offsets in prop::collection::vec(prop::array::uniform6(-1.0..1.0_f64), 48),
            compression in prop::sample::select(vec![0.0, 0.3, 1.0]),
            size in prop::sample::select(vec![1e-5, 1e-3, 0.02]),
            stretch in prop::array::uniform2(0.98..1.02_f64),
            held in 0_usize..48,
            (contact_active, gravity) in (any::<bool>(), any::<bool>()),
        ) {
            let (model, flat) = sheet(compression);
            let displaced = |(x, off): (&Vector3<f64>, &[f64; 6])| {
                let x = Vector3::new(x.x * stretch[0], x.y * stretch[1], x.z);
                x + Vector3::new(off[0], off[1], off[2]) * size
            };
            let positions: Vec<_> = flat.iter().zip(&offsets).map(displaced).collect();
            let positions = Field::of(&positions);
            let velocity = |off: &[f64; 6]| Vector3::new(off[3], off[4], off[5]) * 10.0;
            let velocities = Field::of(&offsets.iter().map(velocity).collect::<Vec<_>>());
            let mut free = Free::all(48);
            free.set(held, Vector3::new(0.0, 1.0, 0.0));
            let length = 1e-7;
            let parameters = KickParameters {
                overpressure: 120.0,
                gravity: Vector3::new(0.0, 1.0, -9.81) * f64::from(u8::from(gravity)),
                weight_factor: 1.0,
                velocity_factor: 0.999,
                acceleration_factor: length,
                contact_active,
            };
            let start = FilmMotion::new(InstructionSet::Scalar, &model, positions, velocities);
            let mut reference = start.clone();
            let expected: Vec<_> = (0..3)
                .map(|_| reference_step(&model, &parameters, &free, length, &mut reference))
                .collect();
            for instruction_set in InstructionSet::ALL {
                let mut film = start.clone();
                for (sums, max_squared) in &expected {
                    let (found, speed) = vector_step(instruction_set, &model, &parameters, &free, length, &mut film);
                    prop_assert_eq!(found.six_volumes.to_bits(), sums.six_volumes.to_bits());
                    prop_assert_eq!(found.viscous_work.to_bits(), sums.viscous_work.to_bits());
                    prop_assert_eq!(found.largest_stress.to_bits(), sums.largest_stress.to_bits());
                    prop_assert_eq!(speed.to_bits(), max_squared.to_bits());
                }
                let kites = model.kites.len();
                prop_assert!(bits(&film, kites) == bits(&reference, kites), "{}", instruction_set.name());
            }
        }
    }

    #[test]
    fn sheets_reach_every_regime() {
        let (model, flat) = sheet(0.0);
        let regime = |stretch: [f64; 2]| {
            let stretched =
                |x: &Vector3<f64>| Vector3::new(x.x * stretch[0], x.y * stretch[1], x.z);
            let positions = Field::of(&flat.iter().map(stretched).collect::<Vec<_>>());
            model.material.regime(strain(&model, &positions, 0))
        };
        assert_eq!(regime([1.01, 1.01]), Regime::Taut);
        assert_eq!(regime([1.01, 0.99]), Regime::Wrinkled);
        assert_eq!(regime([0.99, 0.99]), Regime::Slack);
    }
}
