//! One step of film without contact at a fixed overpressure, in two versions: [`vector_step`] uses the
//! solver's kernels, [`reference_step`] plain loops over nodes and elements.
//!
//! The plain loops are the reference for tests and for measurements: the same data layout and the same
//! operations in the same order, so the same bits, but without vector registers. The equations are
//! those of [`billow_solver::mechanics::forces::membrane`] and [`billow_solver::integrators::explicit::update`].

use nalgebra::Vector3;

use billow_solver::geometry::field::Field;
use billow_solver::integrators::explicit::update::{KickParameters, drift_nodes, kick_nodes};
use billow_solver::mechanics::film_model::{ElementBlock, FilmModel};
use billow_solver::mechanics::forces::membrane::{
    CreepStep, CreepStrain, ElementHistory, MembraneSums, NORMAL_TO_GRADIENT, NodeForces,
    assemble_membrane,
};
use billow_solver::mechanics::supports::FreeComponents;
use billow_solver::platform::simd::{InstructionSet, Lanes, NodeSum, WIDTH};

/// Film in motion, without gas, moving supports, or contact.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmMotion {
    /// Positions of the nodes, m.
    pub positions: Field,
    /// Velocities of the nodes, m/s.
    pub velocities: Field,
    /// Forces on the nodes. A step does not change the contact forces.
    pub forces: NodeForces,
    /// Strains and stresses of the elements after the last step.
    pub histories: Vec<[ElementHistory; 2]>,
    /// Creep strains; empty for film without loss.
    pub creep: Vec<[CreepStrain; 2]>,
    next_creep: Vec<[CreepStrain; 2]>,
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
        let mut histories = ElementHistory::zero(model);
        let creep = CreepStrain::at_rest(model, &positions);
        let next = Field::zeros(model.nodes());
        let mut next_creep = creep.clone();
        let creep_step = &mut CreepStep { last: &creep, next: &mut next_creep };
        let _ = assemble_membrane(
            instruction_set,
            model,
            &positions,
            0.0,
            creep_step,
            &mut histories,
            &mut forces,
        );
        Self { positions, velocities, forces, histories, creep, next_creep, next }
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
    let FilmMotion { positions, velocities, forces, histories, creep, next_creep, next } = film;
    kick_nodes(instruction_set, model, forces, parameters, free, velocities, next);
    core::mem::swap(velocities, next);
    let largest = drift_nodes(instruction_set, velocities, length, positions);
    let step = &mut CreepStep { last: creep, next: next_creep };
    let sums =
        assemble_membrane(instruction_set, model, positions, length, step, histories, forces);
    core::mem::swap(creep, next_creep);
    (sums, largest)
}

/// The same step by plain loops, with the same bits.
pub fn reference_step(
    model: &FilmModel,
    parameters: &KickParameters,
    free: &FreeComponents,
    length: f64,
    film: &mut FilmMotion,
) -> (MembraneSums, f64) {
    let FilmMotion { positions, velocities, forces, histories, creep, next, .. } = film;
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
    (assemble_kites(model, positions, length, (creep, histories), forces), largest)
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
    damping_time: f64,
}

impl Constants {
    fn of(block: &ElementBlock, lane: usize) -> Self {
        Self {
            inverse_shape: block.inverse_shape.each_ref().map(|lanes| lanes.0[lane]),
            minus_volume: block.minus_volume.0[lane],
            damping_time: block.damping_time.0[lane],
        }
    }
}

/// A lane of an [`ElementHistory`] and of the [`CreepStrain`] beside it.
#[derive(Clone, Copy)]
struct Stored {
    strain: Vector,
    stress: Vector,
    numerical_stress: Vector,
    creep: Vector,
}

impl Stored {
    fn load(history: &ElementHistory, creep: &CreepStrain, lane: usize) -> Self {
        let of = |stored: &[Lanes; 3]| stored.each_ref().map(|lanes| lanes.0[lane]);
        Self {
            strain: of(&history.strain),
            stress: of(&history.stress),
            numerical_stress: of(&history.numerical_stress),
            creep: creep.lane(lane),
        }
    }

    fn store(&self, history: &mut ElementHistory, creep: &mut CreepStrain, lane: usize) {
        for component in 0..3 {
            history.strain[component].0[lane] = self.strain[component];
            history.stress[component].0[lane] = self.stress[component];
            history.numerical_stress[component].0[lane] = self.numerical_stress[component];
            creep.0[component].0[lane] = self.creep[component];
        }
    }
}

/// Result of one element.
struct ElementResponse {
    /// What the element stores.
    stored: Stored,
    /// Force densities −r of the edges, N/m.
    minus_force_density: Vector,
    /// Minus twice the numerical dissipation of the step, J.
    minus_twice_numerical: f64,
    /// Minus twice the material loss of the step, J.
    minus_twice_loss: f64,
    /// Larger principal stress, Pa.
    largest_stress: f64,
}

/// Multiplies the components of a strain by the two factors of an isotropic tensor.
fn isotropic(a: Vector, [mean, deviator]: [f64; 2]) -> Vector {
    [a[0] * mean, a[1] * deviator, a[2] * deviator]
}

/// Response of an element with metric (p·p/2, p·q, q·q/2) after a step.
fn element_response(
    model: &FilmModel,
    Constants { inverse_shape: [a, b, d], minus_volume, damping_time }: &Constants,
    [m1, m2, m3]: Vector,
    step: f64,
    last: &Stored,
) -> ElementResponse {
    let creep = &model.creep;
    let loses = creep.ratio > 0.0;
    let (b_m1, d_m2) = (b * m1, d * m2);
    let b_m1_d_m2 = b_m1 + d_m2;
    // Exx + ½ and Eyy + ½.
    let (xx, yy) = ((a * a) * m1, b * b_m1_d_m2 + (d * d) * m3);
    let mut strain = [xx + yy - 1.0, xx - yy, a * (b_m1 + b_m1_d_m2)];
    let (mut creep_strain, mut creep_step) = (last.creep, [0.0; 3]);
    let last_driving = minus(last.stress, isotropic(creep_strain, creep.stiffness));
    if loses {
        creep_step = times(isotropic(last_driving, creep.compliance), creep.share(step));
        creep_strain = plus(creep_strain, creep_step);
        strain = plus(strain, times(minus(strain, creep_strain), creep.ratio));
    }
    let [mean, shear_modulus, largest_stress] = stress_response(model, strain);
    let stress = [mean, shear_modulus * strain[1], shear_modulus * strain[2]];

    let (strain_step, stress_step) = (minus(strain, last.strain), minus(stress, last.stress));
    let twice_missed = contract(stress, last.strain) - contract(last.stress, strain);
    let larger = |a: f64, b: f64| if a > b { a } else { b };
    let work = larger(contract(stress_step, strain_step), f64::MIN_POSITIVE);
    let share = (twice_missed * 0.5) / work;
    let share = -larger(-larger(share, -0.5), -0.5);
    let numerical = times(stress_step, share + damping_time * (1.0 / step));
    let displacement =
        if loses { plus(strain_step, times(creep_step, creep.ratio)) } else { strain_step };
    let twice_work = contract(plus(numerical, last.numerical_stress), displacement) - twice_missed;
    let minus_twice_loss = if loses {
        let driving = minus(stress, isotropic(creep_strain, creep.stiffness));
        minus_volume * contract(plus(driving, last_driving), creep_step)
    } else {
        0.0
    };

    // −A t (s + d), then its components and Gᵀ of them.
    let [mean, half_difference, xy] = times(plus(stress, numerical), *minus_volume);
    let (xx, yy) = (mean + half_difference, mean - half_difference);
    let a_xy = a * xy;
    let b_yy_a_xy = b * yy + a_xy;
    let minus_force_density = [(a * a) * xx + b * (b_yy_a_xy + a_xy), d * b_yy_a_xy, (d * d) * yy];
    let stored = Stored { strain, stress, numerical_stress: numerical, creep: creep_strain };
    ElementResponse {
        stored,
        minus_force_density,
        minus_twice_numerical: minus_volume * twice_work,
        minus_twice_loss,
        largest_stress,
    }
}

/// [`assemble_membrane`], kite by kite.
fn assemble_kites(
    model: &FilmModel,
    positions: &Field,
    step: f64,
    (creep, histories): (&mut [[CreepStrain; 2]], &mut [[ElementHistory; 2]]),
    out: &mut NodeForces,
) -> MembraneSums {
    let (mut six_volumes, mut largest_stress) = ([0.0; WIDTH], 0.0_f64);
    let (mut numerical, mut loss) = ([0.0; WIDTH], [0.0; WIDTH]);
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
        let [first, second] = [0, 1].map(|half| {
            let constants = Constants::of(&model.constants[block][half], lane);
            let history = &mut histories[block][half];
            let mut none = CreepStrain::default();
            let creep = creep.get_mut(block).map_or(&mut none, |both| &mut both[half]);
            let last = Stored::load(history, creep, lane);
            let response = element_response(model, &constants, metrics[half], step, &last);
            response.stored.store(history, creep, lane);
            response
        });
        for response in [&first, &second] {
            let stress = response.largest_stress;
            largest_stress = if largest_stress > stress { largest_stress } else { stress };
        }
        numerical[lane] += first.minus_twice_numerical + second.minus_twice_numerical;
        loss[lane] += first.minus_twice_loss + second.minus_twice_loss;

        let (r, r2) = (first.minus_force_density, second.minus_force_density);
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
    MembraneSums {
        six_volumes: sum(six_volumes),
        numerical_dissipation: -0.5 * sum(numerical) / (1.0 + model.creep.ratio),
        material_loss: -0.5 * sum(loss) * model.creep.ratio / (1.0 + model.creep.ratio),
        largest_stress,
    }
}

#[cfg(test)]
mod tests;
