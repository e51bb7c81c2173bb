//! Update of all nodes: kick (velocities), drift (positions), and powers along the velocities.
//!
//! ```text
//! f = f_film + f_contact + (p − p_ambient) ∂V/∂x + m g
//! v⁺ = v + P ((κ − 1) v + (τ/m) f)                  x⁺ = x + Δt v⁺
//! ```
//!
//! Symbols: P is 1 for a free component and 0 for a held one; κ and τ (s) are the factors of
//! [`crate::mechanics::forces::damping::kick_factors`].
//!
//! Eight nodes are updated at a time, the last ones one by one with the same operations. A kernel does
//! not read terms that are zero everywhere (weight in orbit, contact without active pairs), nor P where
//! it is 1. This changes no bit: no force is −0, and adding +0 or multiplying by 1 keeps the value.

#![allow(clippy::inline_always, reason = "inside the node loop")]

use nalgebra::Vector3;

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::membrane::{NORMAL_TO_GRADIENT, NodeForces};
use crate::mechanics::supports::FreeComponents;
use crate::platform::simd::{InstructionSet, Lanes, WIDTH, Wide, dispatch, dispatch_wide};

/// Uniform quantities of a kick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KickParameters {
    /// p − `p_ambient`, Pa.
    pub overpressure: f64,
    /// Acceleration of gravity, m/s².
    pub gravity: Vector3<f64>,
    /// Factor on the mass in the weight: 1, except with an injected fault.
    pub weight_factor: f64,
    /// κ, factor on the velocity.
    pub velocity_factor: f64,
    /// τ, factor on the acceleration, s.
    pub acceleration_factor: f64,
    /// Whether any contact force is nonzero.
    pub contact_active: bool,
}

/// One component of the velocity after a kick, for one node or for eight. A term that is `None` is not
/// read.
macro_rules! kicked_velocity {
    ($parameters:expr, $velocity:expr, $film:expr, $normal:expr, $inverse_mass:expr,
     $contact:expr, $weight:expr, $free:expr) => {{
        let force = match $contact {
            Some(contact) => $film + contact,
            None => $film,
        };
        let force = force + $normal * ($parameters.overpressure * NORMAL_TO_GRADIENT);
        let force = match $weight {
            Some(weight) => force + weight,
            None => force,
        };
        let change = $velocity * ($parameters.velocity_factor - 1.0)
            + force * ($inverse_mass * $parameters.acceleration_factor);
        let change = match $free {
            Some(free) => change * free,
            None => change,
        };
        $velocity + change
    }};
}

#[inline(always)]
fn kick_kernel<L: Wide, const CONTACT: bool, const GRAVITY: bool>(
    model: &FilmModel,
    forces: &NodeForces,
    parameters: &KickParameters,
    free: &FreeComponents,
    velocities: &Field,
    next: &mut [&mut [f64]; 3],
) {
    let nodes = next[0].len();
    let (mass, inverse_mass) = (&model.mass[..nodes], &model.inverse_mass[..nodes]);
    let contact = &forces.contact;
    let contact = [&contact.x[..nodes], &contact.y[..nodes], &contact.z[..nodes]];
    let factors = free.field();
    let factors = [&factors.x[..nodes], &factors.y[..nodes], &factors.z[..nodes]];
    let velocity = [&velocities.x[..nodes], &velocities.y[..nodes], &velocities.z[..nodes]];
    let sums = &forces.sums[..nodes];
    let (blocks, _) = sums.as_chunks::<WIDTH>();
    for (block, sums) in blocks.iter().enumerate() {
        let first = block * WIDTH;
        let [film, normal] = L::from_node_sums(sums);
        let ([fx, fy, fz], [nx, ny, nz]) =
            ([film.x, film.y, film.z], [normal.x, normal.y, normal.z]);
        let (inverse_mass, any_held) = (L::load(inverse_mass, first), free.any_held(first));
        for (axis, (film, normal)) in [(fx, nx), (fy, ny), (fz, nz)].into_iter().enumerate() {
            let gravity = parameters.gravity[axis];
            kicked_velocity!(
                parameters,
                L::load(velocity[axis], first),
                film,
                normal,
                inverse_mass,
                if CONTACT { Some(L::load(contact[axis], first)) } else { None },
                if GRAVITY {
                    Some(L::splat(gravity) * (L::load(mass, first) * parameters.weight_factor))
                } else {
                    None
                },
                if any_held { Some(L::load(factors[axis], first)) } else { None }
            )
            .store(next[axis], first);
        }
    }
    for node in blocks.len() * WIDTH..nodes {
        for axis in 0..3 {
            next[axis][node] = kicked_velocity!(
                parameters,
                velocity[axis][node],
                sums[node].film[axis],
                sums[node].normal[axis],
                inverse_mass[node],
                if CONTACT { Some(contact[axis][node]) } else { None },
                if GRAVITY {
                    Some(parameters.gravity[axis] * (mass[node] * parameters.weight_factor))
                } else {
                    None
                },
                Some(factors[axis][node])
            );
        }
    }
}

#[inline(always)]
fn select_kick_kernel<L: Wide>(
    model: &FilmModel,
    forces: &NodeForces,
    parameters: &KickParameters,
    free: &FreeComponents,
    velocities: &Field,
    next: &mut [&mut [f64]; 3],
) {
    let gravity = parameters.gravity != Vector3::zeros();
    match (parameters.contact_active, gravity) {
        (false, false) => {
            kick_kernel::<L, false, false>(model, forces, parameters, free, velocities, next);
        }
        (false, true) => {
            kick_kernel::<L, false, true>(model, forces, parameters, free, velocities, next);
        }
        (true, false) => {
            kick_kernel::<L, true, false>(model, forces, parameters, free, velocities, next);
        }
        (true, true) => {
            kick_kernel::<L, true, true>(model, forces, parameters, free, velocities, next);
        }
    }
}

dispatch_wide! {
    fn kick_columns / select_kick_kernel(
        model: &FilmModel,
        forces: &NodeForces,
        parameters: &KickParameters,
        free: &FreeComponents,
        velocities: &Field,
        next: &mut [&mut [f64]; 3],
    )
}

/// Sets `next` to the velocities of all nodes after a kick, m/s. Applies only supports along the axes.
pub fn kick_nodes(
    instruction_set: InstructionSet,
    model: &FilmModel,
    forces: &NodeForces,
    parameters: &KickParameters,
    free: &FreeComponents,
    velocities: &Field,
    next: &mut Field,
) {
    // Three slices instead of a `Field`: the compiler then knows that they do not overlap.
    let mut next = [&mut next.x[..], &mut next.y[..], &mut next.z[..]];
    kick_columns(instruction_set, model, forces, parameters, free, velocities, &mut next);
}

#[inline(always)]
fn drift_kernel(velocities: &Field, time: f64, positions: [&mut [f64]; 3]) -> f64 {
    let [x, y, z] = positions;
    let nodes = x.len();
    let [vx, vy, vz] = [&velocities.x[..nodes], &velocities.y[..nodes], &velocities.z[..nodes]];
    let [x, y, z] = [&mut x[..nodes], &mut y[..nodes], &mut z[..nodes]];
    let in_blocks = nodes - nodes % WIDTH;
    let mut max_lanes = Lanes::default();
    for first in (0..in_blocks).step_by(WIDTH) {
        let [u, v, w] = [Lanes::load(vx, first), Lanes::load(vy, first), Lanes::load(vz, first)];
        (Lanes::load(x, first) + u * time).store(x, first);
        (Lanes::load(y, first) + v * time).store(y, first);
        (Lanes::load(z, first) + w * time).store(z, first);
        let squared = u * u + v * v + w * w;
        max_lanes = squared.max(max_lanes);
    }
    let mut largest = max_lanes.largest();
    for node in in_blocks..nodes {
        let [u, v, w] = [vx[node], vy[node], vz[node]];
        x[node] += u * time;
        y[node] += v * time;
        z[node] += w * time;
        largest = largest.max(u * u + v * v + w * w);
    }
    largest
}

dispatch! {
    fn drift_columns / drift_kernel(
        velocities: &Field,
        time: f64,
        positions: [&mut [f64]; 3],
    ) -> f64
}

/// Moves all nodes along their velocities (m/s) for `time` (s). Returns the largest squared speed,
/// m²/s², ignoring NaN: a NaN velocity also makes the volume NaN, where it is detected.
pub fn drift_nodes(
    instruction_set: InstructionSet,
    velocities: &Field,
    time: f64,
    positions: &mut Field,
) -> f64 {
    let positions = [&mut positions.x[..], &mut positions.y[..], &mut positions.z[..]];
    drift_columns(instruction_set, velocities, time, positions)
}

#[inline(always)]
fn speed_kernel(velocities: &Field) -> f64 {
    let nodes = velocities.len();
    let [vx, vy, vz] = [&velocities.x[..nodes], &velocities.y[..nodes], &velocities.z[..nodes]];
    let in_blocks = nodes - nodes % WIDTH;
    let mut max_lanes = Lanes::default();
    for first in (0..in_blocks).step_by(WIDTH) {
        let [u, v, w] = [Lanes::load(vx, first), Lanes::load(vy, first), Lanes::load(vz, first)];
        let squared = u * u + v * v + w * w;
        max_lanes = squared.max(max_lanes);
    }
    let mut largest = max_lanes.largest();
    for node in in_blocks..nodes {
        largest = largest.max(vx[node] * vx[node] + vy[node] * vy[node] + vz[node] * vz[node]);
    }
    largest
}

dispatch! {
    /// The largest squared speed, m²/s², of these velocities (m/s), ignoring NaN.
    pub fn largest_squared_speed / speed_kernel(velocities: &Field) -> f64
}

#[inline(always)]
fn power_kernel(forces: &Field, velocities: &Field) -> f64 {
    let nodes = velocities.len();
    let [fx, fy, fz] = [&forces.x[..nodes], &forces.y[..nodes], &forces.z[..nodes]];
    let mut power = 0.0;
    for first in (0..nodes).step_by(WIDTH) {
        let block = first..(first + WIDTH).min(nodes);
        // All bits but the signs: zero only where every component is ±0. NaN counts as a force.
        let bits =
            |column: &[f64]| column.iter().fold(0, |bits, value| bits | (value.to_bits() << 1));
        if bits(&fx[block.clone()]) | bits(&fy[block.clone()]) | bits(&fz[block.clone()]) != 0 {
            for node in block {
                power += forces.get(node).dot(&velocities.get(node));
            }
        }
    }
    power
}

dispatch! {
    /// Power Σ f·v, W, summed in the order of nodes. Fast where most forces are zero: it skips groups of
    /// eight nodes without force.
    pub fn sparse_power / power_kernel(forces: &Field, velocities: &Field) -> f64
}
