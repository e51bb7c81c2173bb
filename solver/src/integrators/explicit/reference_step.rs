//! One step of film without contact at a fixed overpressure, in two versions: [`vector_step`] uses the
//! solver's kernels, [`reference_step`] plain loops over nodes and elements.
//!
//! The plain loops are the reference for tests and for measurements: the same data layout and the same
//! operations in the same order, so the same bits, but without vector registers. The equations are
//! those of [`crate::mechanics::forces::membrane`] and [`super::update`].

use nalgebra::Vector3;

use super::update::{KickParameters, drift_nodes, kick_nodes};
use crate::geometry::field::Field;
use crate::mechanics::film_model::{ElementBlock, FilmModel};
use crate::mechanics::forces::membrane::{
    MembraneSums, NORMAL_TO_GRADIENT, NodeForces, ViscousHistory, assemble_membrane,
};
use crate::mechanics::supports::FreeComponents;
use crate::platform::simd::{InstructionSet, NodeSum, WIDTH};

/// Film in motion, without gas, moving supports, or contact.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmMotion {
    /// Positions of the nodes, m.
    pub positions: Field,
    /// Velocities of the nodes, m/s.
    pub velocities: Field,
    /// Forces on the nodes. A step does not change the contact forces.
    pub forces: NodeForces,
    /// Strain and viscous stress of the elements after the last step.
    pub histories: Vec<[ViscousHistory; 2]>,
    next: Field,
}

impl FilmMotion {
    /// Film at these positions (m) with these velocities (m/s), with the forces of that state.
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

/// Kick, drift for `length` (s), and new forces, by the solver's kernels. Returns the sums over the
/// elements, and the largest squared speed, m²/s².
pub fn vector_step(
    instruction_set: InstructionSet,
    model: &FilmModel,
    parameters: &KickParameters,
    free: &FreeComponents,
    length: f64,
    film: &mut FilmMotion,
) -> (MembraneSums, f64) {
    let FilmMotion { positions, velocities, forces, histories, next } = film;
    kick_nodes(instruction_set, model, forces, parameters, free, velocities, next);
    core::mem::swap(velocities, next);
    let largest = drift_nodes(instruction_set, velocities, length, positions);
    (assemble_membrane(instruction_set, model, positions, length, histories, forces), largest)
}

/// The same step by plain loops, with the same bits.
pub fn reference_step(
    model: &FilmModel,
    parameters: &KickParameters,
    free: &FreeComponents,
    length: f64,
    film: &mut FilmMotion,
) -> (MembraneSums, f64) {
    let FilmMotion { positions, velocities, forces, histories, next } = film;
    let gravity = parameters.gravity != Vector3::zeros();
    for node in 0..model.nodes() {
        let [x, y, z, _] = forces.sums[node].normal;
        let mut force = forces.film(node);
        if parameters.contact_active {
            force += forces.contact.get(node);
        }
        force += Vector3::new(x, y, z) * (parameters.overpressure * NORMAL_TO_GRADIENT);
        if gravity {
            force += parameters.gravity * (model.mass[node] * parameters.weight_factor);
        }
        let velocity = velocities.get(node);
        let change = velocity * (parameters.velocity_factor - 1.0)
            + force * (model.inverse_mass[node] * parameters.acceleration_factor);
        next.set(node, velocity + change.component_mul(&free.get(node)));
    }
    core::mem::swap(velocities, next);
    let mut largest = 0.0_f64;
    for node in 0..model.nodes() {
        let velocity = velocities.get(node);
        positions.set(node, positions.get(node) + velocity * length);
        largest = largest.max(velocity.norm_squared());
    }
    (assemble_kites(model, positions, length, histories, forces), largest)
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

/// For a strain (Exx + Eyy, Exx − Eyy, 2 Exy): mean stress, secant shear modulus, and larger principal
/// stress, Pa.
fn stress_response(model: &FilmModel, [sum, difference, shear]: Vector) -> [f64; 3] {
    let material = &model.material;
    let (k, nu) = (material.plane_modulus(), material.poisson_ratio);
    let diameter = (difference * difference + shear * shear).sqrt();
    let full = [sum * (0.5 * k * (1.0 + nu)), 0.5 * k * (1.0 - nu)];
    let [mean, shear_modulus] = if sum * (1.0 + nu) - diameter * (1.0 - nu) > 0.0 {
        full
    } else {
        let (twice_e1, c) = (sum + diameter, material.compression);
        let wrinkled_mean = twice_e1 * (0.25 * material.youngs_modulus);
        let [mean, shear_modulus] =
            if twice_e1 > 0.0 { [wrinkled_mean, wrinkled_mean / diameter] } else { [0.0; 2] };
        [mean + (full[0] - mean) * c, shear_modulus + (full[1] - shear_modulus) * c]
    };
    [mean, shear_modulus, mean + shear_modulus * diameter]
}

/// S:E of a stress (mean, half difference, shear) and a strain (sum, difference, shear).
fn contract(stress: Vector, strain: Vector) -> f64 {
    stress[0] * strain[0] + stress[1] * strain[1] + stress[2] * strain[2]
}

/// Constants of one element: a lane of an [`ElementBlock`].
struct Constants {
    inverse_shape: Vector,
    minus_volume: f64,
    minus_viscosity: f64,
}

impl Constants {
    fn of(block: &ElementBlock, lane: usize) -> Self {
        Self {
            inverse_shape: block.inverse_shape.each_ref().map(|lanes| lanes.0[lane]),
            minus_volume: block.minus_volume.0[lane],
            minus_viscosity: block.minus_viscosity.0[lane],
        }
    }
}

/// Result of one element.
struct ElementResponse {
    /// Strain (Exx + Eyy, Exx − Eyy, 2 Exy).
    strain: Vector,
    /// −A t `s_v`, J.
    viscous: Vector,
    /// Force densities −r of the edges, N/m.
    minus_force_density: Vector,
    /// Minus twice the viscous work of the step, J.
    minus_twice_work: f64,
    /// Larger principal stress, Pa.
    largest_stress: f64,
}

/// Response of an element with metric (p·p/2, p·q, q·q/2), strain and −A t `s_v` before the step.
fn element_response(
    model: &FilmModel,
    Constants { inverse_shape: [a, b, d], minus_volume, minus_viscosity }: &Constants,
    [m1, m2, m3]: Vector,
    inverse_step: f64,
    [last_strain, last_viscous]: [Vector; 2],
) -> ElementResponse {
    let nu = model.material.poisson_ratio;
    let (b_m1, d_m2) = (b * m1, d * m2);
    let b_m1_d_m2 = b_m1 + d_m2;
    // Exx + ½ and Eyy + ½.
    let (xx, yy) = ((a * a) * m1, b * b_m1_d_m2 + (d * d) * m3);
    let strain = [xx + yy - 1.0, xx - yy, a * (b_m1 + b_m1_d_m2)];
    let change = minus(strain, last_strain);
    let mean_factor = minus_viscosity * (inverse_step * (0.5 * (1.0 + nu)));
    let shear_factor = minus_viscosity * (inverse_step * (0.5 * (1.0 - nu)));
    let viscous = [mean_factor * change[0], shear_factor * change[1], shear_factor * change[2]];
    let minus_twice_work = contract(plus(viscous, last_viscous), change);

    // −A t (s + s_v), then its components and Gᵀ of them.
    let [mean, shear_modulus, largest_stress] = stress_response(model, strain);
    let shear_modulus = shear_modulus * minus_volume;
    let mean = mean * minus_volume + viscous[0];
    let half_difference = shear_modulus * strain[1] + viscous[1];
    let (xx, yy) = (mean + half_difference, mean - half_difference);
    let xy = shear_modulus * strain[2] + viscous[2];
    let a_xy = a * xy;
    let b_yy_a_xy = b * yy + a_xy;
    let minus_force_density = [(a * a) * xx + b * (b_yy_a_xy + a_xy), d * b_yy_a_xy, (d * d) * yy];
    ElementResponse { strain, viscous, minus_force_density, minus_twice_work, largest_stress }
}

/// [`assemble_membrane`], kite by kite.
fn assemble_kites(
    model: &FilmModel,
    positions: &Field,
    step: f64,
    histories: &mut [[ViscousHistory; 2]],
    out: &mut NodeForces,
) -> MembraneSums {
    let (mut six_volumes, mut work, mut largest_stress) = ([0.0; WIDTH], [0.0; WIDTH], 0.0_f64);
    let inverse_step = 1.0 / step;
    out.sums.fill(NodeSum::default());
    for (index, kite) in model.kites.iter().enumerate() {
        let (block, lane) = (index / WIDTH, index % WIDTH);
        let corners = kite.map(|node| <Vector>::from(positions.get(node as usize)));
        let [p, d, q] = [1, 2, 3].map(|corner| minus(corners[corner], corners[0]));
        let (first_normal, second_normal) = (cross(p, d), cross(d, q));
        let normal = plus(first_normal, second_normal);
        six_volumes[lane] += dot(corners[0], normal);

        let d_metric = dot(d, d) * 0.5;
        let metrics =
            [[dot(p, p) * 0.5, dot(p, d), d_metric], [d_metric, dot(d, q), dot(q, q) * 0.5]];
        let (mut force_densities, mut works) = ([[0.0; 3]; 2], [0.0; 2]);
        for half in 0..2 {
            let constants = Constants::of(&model.constants[block][half], lane);
            let ViscousHistory { strain, minus_weighted_stress } = &mut histories[block][half];
            let last = [&*strain, &*minus_weighted_stress]
                .map(|stored| stored.each_ref().map(|lanes| lanes.0[lane]));
            let response = element_response(model, &constants, metrics[half], inverse_step, last);
            for component in 0..3 {
                strain[component].0[lane] = response.strain[component];
                minus_weighted_stress[component].0[lane] = response.viscous[component];
            }
            force_densities[half] = response.minus_force_density;
            works[half] = response.minus_twice_work;
            let stress = response.largest_stress;
            largest_stress = if largest_stress > stress { largest_stress } else { stress };
        }
        work[lane] += works[0] + works[1];

        let [r, r2] = force_densities;
        let force_a = plus(times(p, r[0]), times(d, r[1]));
        let force_t = plus(plus(times(p, r[1]), times(d, r[2] + r2[0])), times(q, r2[1]));
        let force_b = plus(times(d, r2[1]), times(q, r2[2]));
        let force_s = plus(plus(force_a, force_t), force_b).map(|entry| -entry);
        let corner_sums = [
            (force_s, normal),
            (force_a, first_normal),
            (force_t, normal),
            (force_b, second_normal),
        ];
        for ((force, normal), node) in corner_sums.into_iter().zip(kite) {
            let sum = &mut out.sums[*node as usize];
            for axis in 0..3 {
                sum.film[axis] += force[axis];
                sum.normal[axis] += normal[axis];
            }
        }
    }
    // The order of `Lanes::sum`.
    let sum = |[a, b, c, d, e, f, g, h]: [f64; WIDTH]| ((a + e) + (c + g)) + ((b + f) + (d + h));
    let viscous_work = -0.5 * sum(work);
    MembraneSums { six_volumes: sum(six_volumes), viscous_work, largest_stress }
}

#[cfg(test)]
mod tests;
