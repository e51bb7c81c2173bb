//! The update of all nodes at once: kick, drift, and works along the velocities.
//!
//! ```text
//! f = f_film + f_contact + (p − p_ambient) ∂V/∂x + m g
//! v⁺ = v + P ((keep − 1) v + gain/m f)              x⁺ = x + way v⁺
//! ```
//!
//! Eight nodes at a time; what is left over goes one by one with the same operations. Symbols: P 1
//! where a component is free, else 0; keep and gain of [`crate::mechanics::forces::damping::kick_factors`].
//! What is nought everywhere, weight in orbit or contact while nothing touches, and P where it is 1
//! are not read: no force is −0, so adding +0, as multiplying by 1, changes no bit.

#![allow(clippy::inline_always, reason = "inside the node loop")]

use nalgebra::Vector3;

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::membrane::{NodeForces, SIXTH};
use crate::mechanics::supports::Free;
use crate::platform::simd::{InstructionSet, Lanes, WIDTH, Wide, dispatch, dispatch_wide};

/// What pushes nodes in a kick, beside the forces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Push {
    /// p − `p_ambient`, Pa.
    pub overpressure: f64,
    /// Acceleration of gravity, m/s².
    pub gravity: Vector3<f64>,
    /// What mass counts for in weight: 1 but in tests.
    pub weight: f64,
    /// What is left of a velocity.
    pub keep: f64,
    /// Velocity an acceleration gives, s.
    pub gain: f64,
    /// Whether contact pushes; else its forces are all nought.
    pub pressed: bool,
}

/// One component of the kick, of a number or of eight; what is not there is not read.
macro_rules! kicked {
    ($push:expr, $velocity:expr, $film:expr, $normal:expr, $inverse:expr,
     $contact:expr, $weight:expr, $free:expr) => {{
        let force = match $contact {
            Some(contact) => $film + contact,
            None => $film,
        };
        let force = force + $normal * ($push.overpressure * SIXTH);
        let force = match $weight {
            Some(weight) => force + weight,
            None => force,
        };
        let change = $velocity * ($push.keep - 1.0) + force * ($inverse * $push.gain);
        let change = match $free {
            Some(free) => change * free,
            None => change,
        };
        $velocity + change
    }};
}

#[inline(always)]
fn kick_kernel<L: Wide, const PRESSED: bool, const HEAVY: bool>(
    model: &FilmModel,
    forces: &NodeForces,
    push: &Push,
    free: &Free,
    velocities: &Field,
    next: &mut [&mut [f64]; 3],
) {
    let nodes = next[0].len();
    let (mass, inverse) = (&model.mass[..nodes], &model.inverse_mass[..nodes]);
    let contact = &forces.contact;
    let contact = [&contact.x[..nodes], &contact.y[..nodes], &contact.z[..nodes]];
    let all = free.field();
    let part = [&all.x[..nodes], &all.y[..nodes], &all.z[..nodes]];
    let velocity = [&velocities.x[..nodes], &velocities.y[..nodes], &velocities.z[..nodes]];
    let sums = &forces.sums[..nodes];
    let (blocks, _) = sums.as_chunks::<WIDTH>();
    for (block, sums) in blocks.iter().enumerate() {
        let at = block * WIDTH;
        let [film, normal] = L::columns(sums);
        let ([fx, fy, fz], [nx, ny, nz]) =
            ([film.x, film.y, film.z], [normal.x, normal.y, normal.z]);
        let (inverse, held) = (L::load(inverse, at), free.any_held(at));
        for (axis, (film, normal)) in [(fx, nx), (fy, ny), (fz, nz)].into_iter().enumerate() {
            let weight = push.gravity[axis];
            kicked!(
                push,
                L::load(velocity[axis], at),
                film,
                normal,
                inverse,
                if PRESSED { Some(L::load(contact[axis], at)) } else { None },
                if HEAVY {
                    Some(L::splat(weight) * (L::load(mass, at) * push.weight))
                } else {
                    None
                },
                if held { Some(L::load(part[axis], at)) } else { None }
            )
            .store(next[axis], at);
        }
    }
    for at in blocks.len() * WIDTH..nodes {
        for axis in 0..3 {
            next[axis][at] = kicked!(
                push,
                velocity[axis][at],
                sums[at].film[axis],
                sums[at].normal[axis],
                inverse[at],
                if PRESSED { Some(contact[axis][at]) } else { None },
                if HEAVY { Some(push.gravity[axis] * (mass[at] * push.weight)) } else { None },
                Some(part[axis][at])
            );
        }
    }
}

#[inline(always)]
fn any_kick_kernel<L: Wide>(
    model: &FilmModel,
    forces: &NodeForces,
    push: &Push,
    free: &Free,
    velocities: &Field,
    next: &mut [&mut [f64]; 3],
) {
    let heavy = push.gravity != Vector3::zeros();
    match (push.pressed, heavy) {
        (false, false) => {
            kick_kernel::<L, false, false>(model, forces, push, free, velocities, next);
        }
        (false, true) => kick_kernel::<L, false, true>(model, forces, push, free, velocities, next),
        (true, false) => kick_kernel::<L, true, false>(model, forces, push, free, velocities, next),
        (true, true) => kick_kernel::<L, true, true>(model, forces, push, free, velocities, next),
    }
}

dispatch_wide! {
    fn kick_columns / any_kick_kernel(
        model: &FilmModel,
        forces: &NodeForces,
        push: &Push,
        free: &Free,
        velocities: &Field,
        next: &mut [&mut [f64]; 3],
    )
}

/// Velocities of all nodes after a kick, m/s, held along axes alone.
pub fn kick_nodes(
    path: InstructionSet,
    model: &FilmModel,
    forces: &NodeForces,
    push: &Push,
    free: &Free,
    velocities: &Field,
    next: &mut Field,
) {
    // Columns apart: the compiler then knows that they do not overlap.
    let mut next = [&mut next.x[..], &mut next.y[..], &mut next.z[..]];
    kick_columns(path, model, forces, push, free, velocities, &mut next);
}

#[inline(always)]
fn drift_kernel(velocities: &Field, way: f64, places: [&mut [f64]; 3]) -> f64 {
    let [x, y, z] = places;
    let nodes = x.len();
    let [vx, vy, vz] = [&velocities.x[..nodes], &velocities.y[..nodes], &velocities.z[..nodes]];
    let [x, y, z] = [&mut x[..nodes], &mut y[..nodes], &mut z[..nodes]];
    let whole = nodes - nodes % WIDTH;
    let mut lanes = Lanes::default();
    for at in (0..whole).step_by(WIDTH) {
        let [u, v, w] = [Lanes::load(vx, at), Lanes::load(vy, at), Lanes::load(vz, at)];
        (Lanes::load(x, at) + u * way).store(x, at);
        (Lanes::load(y, at) + v * way).store(y, at);
        (Lanes::load(z, at) + w * way).store(z, at);
        // What is no number is taken, and shows in the volume too.
        let squared = u * u + v * v + w * w;
        lanes = squared.max(lanes);
    }
    let mut fastest = lanes.largest();
    for at in whole..nodes {
        let [u, v, w] = [vx[at], vy[at], vz[at]];
        x[at] += u * way;
        y[at] += v * way;
        z[at] += w * way;
        fastest = fastest.max(u * u + v * v + w * w);
    }
    fastest
}

dispatch! {
    fn drift_columns / drift_kernel(velocities: &Field, way: f64, places: [&mut [f64]; 3]) -> f64
}

/// Moves all nodes `way` (s) along their velocities (m/s); gives the largest squared speed, m²/s², of
/// those that are numbers: what is none makes the volume none.
pub fn drift_nodes(path: InstructionSet, velocities: &Field, way: f64, places: &mut Field) -> f64 {
    let places = [&mut places.x[..], &mut places.y[..], &mut places.z[..]];
    drift_columns(path, velocities, way, places)
}

#[inline(always)]
fn speed_kernel(velocities: &Field) -> f64 {
    let nodes = velocities.len();
    let [vx, vy, vz] = [&velocities.x[..nodes], &velocities.y[..nodes], &velocities.z[..nodes]];
    let whole = nodes - nodes % WIDTH;
    let mut lanes = Lanes::default();
    for at in (0..whole).step_by(WIDTH) {
        let [u, v, w] = [Lanes::load(vx, at), Lanes::load(vy, at), Lanes::load(vz, at)];
        let squared = u * u + v * v + w * w;
        lanes = squared.max(lanes);
    }
    let mut fastest = lanes.largest();
    for at in whole..nodes {
        fastest = fastest.max(vx[at] * vx[at] + vy[at] * vy[at] + vz[at] * vz[at]);
    }
    fastest
}

dispatch! {
    /// The largest squared speed, m²/s², of the velocities (m/s) that are numbers.
    pub fn largest_squared_speed / speed_kernel(velocities: &Field) -> f64
}

#[inline(always)]
fn power_kernel(forces: &Field, velocities: &Field) -> f64 {
    let nodes = velocities.len();
    let [fx, fy, fz] = [&forces.x[..nodes], &forces.y[..nodes], &forces.z[..nodes]];
    let mut power = 0.0;
    for first in (0..nodes).step_by(WIDTH) {
        let own = first..(first + WIDTH).min(nodes);
        // Whether any bit but a sign is set: a number that is none counts as a force.
        let bits =
            |column: &[f64]| column.iter().fold(0, |bits, value| bits | (value.to_bits() << 1));
        if bits(&fx[own.clone()]) | bits(&fy[own.clone()]) | bits(&fz[own.clone()]) != 0 {
            for node in own {
                power += forces.get(node).dot(&velocities.get(node));
            }
        }
    }
    power
}

dispatch! {
    /// Σ f·v in the order of nodes, W, quick where most forces are nought.
    pub fn sparse_power / power_kernel(forces: &Field, velocities: &Field) -> f64
}
