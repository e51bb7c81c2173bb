//! The update of all nodes: kick, drift, largest speed, and power along the velocities.
//!
//! ```text
//! f = f_film + f_contact + (p − p_ambient) ∂V/∂x + m g
//! v⁺ = v + P ((κ − 1) v + (τ/m) f)              x⁺ = x + Δt v⁺
//! ```
//!
//! P is 1 for a free component and 0 for a held one; κ and τ (s) are the factors of
//! [`crate::mechanics::forces::damping::kick_factors`]. Eight nodes at a time; the remaining nodes one by
//! one with the same operations. The loop skips terms that are zero everywhere (weight in orbit,
//! contact forces without contact) and factors P that are 1. That changes no bit: no force is −0, so
//! adding +0 changes nothing, and neither does a product with 1.

#![allow(clippy::inline_always, reason = "inside the node loop")]

use nalgebra::Vector3;

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::membrane::{NodeForces, SIXTH};
use crate::mechanics::supports::Free;
use crate::platform::simd::{InstructionSet, Lanes, WIDTH, Wide, dispatch, dispatch_wide};

/// The quantities of a kick that are the same for all nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KickParameters {
    /// Overpressure p − `p_ambient`, Pa.
    pub overpressure: f64,
    /// Acceleration of gravity, m/s².
    pub gravity: Vector3<f64>,
    /// Factor on the weight; 1 without a deliberate fault.
    pub weight_factor: f64,
    /// κ, factor on the velocity.
    pub velocity_factor: f64,
    /// τ, factor on the acceleration, s.
    pub acceleration_factor: f64,
    /// Whether contact forces act; otherwise all of them are 0.
    pub contact_active: bool,
}

/// One component of the kick, for one node or for eight. An absent term is not read.
macro_rules! kicked {
    ($parameters:expr, $velocity:expr, $film:expr, $normal:expr, $inverse:expr,
     $contact:expr, $weight:expr, $free:expr) => {{
        let force = match $contact {
            Some(contact) => $film + contact,
            None => $film,
        };
        let force = force + $normal * ($parameters.overpressure * SIXTH);
        let force = match $weight {
            Some(weight) => force + weight,
            None => force,
        };
        let change = $velocity * ($parameters.velocity_factor - 1.0)
            + force * ($inverse * $parameters.acceleration_factor);
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
    free: &Free,
    velocities: &Field,
    next: &mut [&mut [f64]; 3],
) {
    let nodes = next[0].len();
    let (mass, inverse) = (&model.mass[..nodes], &model.inverse_mass[..nodes]);
    let contact = &forces.contact;
    let contact = [&contact.x[..nodes], &contact.y[..nodes], &contact.z[..nodes]];
    let free_components = free.field();
    let free_components =
        [&free_components.x[..nodes], &free_components.y[..nodes], &free_components.z[..nodes]];
    let velocity = [&velocities.x[..nodes], &velocities.y[..nodes], &velocities.z[..nodes]];
    let sums = &forces.sums[..nodes];
    let (blocks, _) = sums.as_chunks::<WIDTH>();
    for (block, sums) in blocks.iter().enumerate() {
        let node = block * WIDTH;
        let [film, normal] = L::columns(sums);
        let ([fx, fy, fz], [nx, ny, nz]) =
            ([film.x, film.y, film.z], [normal.x, normal.y, normal.z]);
        let (inverse, held) = (L::load(inverse, node), free.any_held(node));
        for (axis, (film, normal)) in [(fx, nx), (fy, ny), (fz, nz)].into_iter().enumerate() {
            let weight = parameters.gravity[axis];
            kicked!(
                parameters,
                L::load(velocity[axis], node),
                film,
                normal,
                inverse,
                if CONTACT { Some(L::load(contact[axis], node)) } else { None },
                if GRAVITY {
                    Some(L::splat(weight) * (L::load(mass, node) * parameters.weight_factor))
                } else {
                    None
                },
                if held { Some(L::load(free_components[axis], node)) } else { None }
            )
            .store(next[axis], node);
        }
    }
    for node in blocks.len() * WIDTH..nodes {
        for axis in 0..3 {
            next[axis][node] = kicked!(
                parameters,
                velocity[axis][node],
                sums[node].film[axis],
                sums[node].normal[axis],
                inverse[node],
                if CONTACT { Some(contact[axis][node]) } else { None },
                if GRAVITY {
                    Some(parameters.gravity[axis] * (mass[node] * parameters.weight_factor))
                } else {
                    None
                },
                Some(free_components[axis][node])
            );
        }
    }
}

#[inline(always)]
fn select_kick_kernel<L: Wide>(
    model: &FilmModel,
    forces: &NodeForces,
    parameters: &KickParameters,
    free: &Free,
    velocities: &Field,
    next: &mut [&mut [f64]; 3],
) {
    let has_gravity = parameters.gravity != Vector3::zeros();
    match (parameters.contact_active, has_gravity) {
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
        free: &Free,
        velocities: &Field,
        next: &mut [&mut [f64]; 3],
    )
}

/// Velocities of all nodes after a kick, m/s, into `next`. Nodes held along oblique directions are treated
/// as free here.
pub fn kick_nodes(
    instruction_set: InstructionSet,
    model: &FilmModel,
    forces: &NodeForces,
    parameters: &KickParameters,
    free: &Free,
    velocities: &Field,
    next: &mut Field,
) {
    // As three slices, so that the compiler knows that they do not overlap.
    let mut next = [&mut next.x[..], &mut next.y[..], &mut next.z[..]];
    kick_columns(instruction_set, model, forces, parameters, free, velocities, &mut next);
}

#[inline(always)]
fn drift_kernel(velocities: &Field, step: f64, positions: [&mut [f64]; 3]) -> f64 {
    let [x, y, z] = positions;
    let nodes = x.len();
    let [vx, vy, vz] = [&velocities.x[..nodes], &velocities.y[..nodes], &velocities.z[..nodes]];
    let [x, y, z] = [&mut x[..nodes], &mut y[..nodes], &mut z[..nodes]];
    let whole = nodes - nodes % WIDTH;
    let mut max_lanes = Lanes::default();
    for node in (0..whole).step_by(WIDTH) {
        let [u, v, w] = [Lanes::load(vx, node), Lanes::load(vy, node), Lanes::load(vz, node)];
        (Lanes::load(x, node) + u * step).store(x, node);
        (Lanes::load(y, node) + v * step).store(y, node);
        (Lanes::load(z, node) + w * step).store(z, node);
        // A NaN speed is ignored here; it shows as a volume that is not finite.
        let squared = u * u + v * v + w * w;
        max_lanes = squared.max(max_lanes);
    }
    let mut max_squared = max_lanes.largest();
    for node in whole..nodes {
        let [u, v, w] = [vx[node], vy[node], vz[node]];
        x[node] += u * step;
        y[node] += v * step;
        z[node] += w * step;
        max_squared = max_squared.max(u * u + v * v + w * w);
    }
    max_squared
}

dispatch! {
    fn drift_columns / drift_kernel(velocities: &Field, step: f64, positions: [&mut [f64]; 3]) -> f64
}

/// Moves all nodes along their velocities (m/s) over `step` (s). Returns the largest squared speed,
/// m²/s². NaN is ignored: it shows as a volume that is not finite.
pub fn drift_nodes(
    instruction_set: InstructionSet,
    velocities: &Field,
    step: f64,
    positions: &mut Field,
) -> f64 {
    let positions = [&mut positions.x[..], &mut positions.y[..], &mut positions.z[..]];
    drift_columns(instruction_set, velocities, step, positions)
}

#[inline(always)]
fn speed_kernel(velocities: &Field) -> f64 {
    let nodes = velocities.len();
    let [vx, vy, vz] = [&velocities.x[..nodes], &velocities.y[..nodes], &velocities.z[..nodes]];
    let whole = nodes - nodes % WIDTH;
    let mut max_lanes = Lanes::default();
    for node in (0..whole).step_by(WIDTH) {
        let [u, v, w] = [Lanes::load(vx, node), Lanes::load(vy, node), Lanes::load(vz, node)];
        let squared = u * u + v * v + w * w;
        max_lanes = squared.max(max_lanes);
    }
    let mut max_squared = max_lanes.largest();
    for node in whole..nodes {
        max_squared =
            max_squared.max(vx[node] * vx[node] + vy[node] * vy[node] + vz[node] * vz[node]);
    }
    max_squared
}

dispatch! {
    /// The largest squared speed, m²/s², of these velocities (m/s), NaN ignored.
    pub fn largest_squared_speed / speed_kernel(velocities: &Field) -> f64
}

#[inline(always)]
fn power_kernel(forces: &Field, velocities: &Field) -> f64 {
    let nodes = velocities.len();
    let [fx, fy, fz] = [&forces.x[..nodes], &forces.y[..nodes], &forces.z[..nodes]];
    let mut power = 0.0;
    for first in (0..nodes).step_by(WIDTH) {
        let block = first..(first + WIDTH).min(nodes);
        // Whether any bit except the sign is set: NaN counts as a force.
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
    /// Power Σ f·v, W, added in the order of nodes. Fast if most forces are zero.
    pub fn sparse_power / power_kernel(forces: &Field, velocities: &Field) -> f64
}
