//! One step of the eight strips: motion, then forces. Each lane is one strip.
//!
//! ```text
//! element from a to b, Δ = b − a, r its distance from the axis:
//!   strain   2 Exx = |Δ|²/L² − 1    2 Eyy = (ra² + rb²)/(Ra² + Rb²) − 1    2 Exy = (ax by − ay bx)/(R L)
//!   forces   f_b = −A t (Sxx Δ/L² + Syy b/(Ra² + Rb²) + Sxy (−ay, ax)/(R L)), f_a likewise
//! volume     V = Σ π/3 Δz (ra² + ra rb + rb²)          pressure forces (p − p_a) ∂V/∂x
//! barrier    φ = κ/3 (r_min − r)³/r_min where r < r_min
//! ```
//!
//! x runs along the strip, y around the axis. The film is a tension field with loss and numerical stress, as
//! in [`crate::mechanics::forces::membrane`]; L, R, Ra, Rb are stress-free, A t its volume. The chord |Δ| is
//! that between points of one material line, so the strain needs no angle.

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use core::f64::consts::PI;

use super::STRIPS;
use super::strip::{Strip, StripElement};
use crate::mechanics::material::{MohrCircle, StressResponse};
use crate::mechanics::material_loss::Creep;
use crate::mechanics::tensor::{add, contract, isotropic, scale, subtract};
use crate::platform::simd::{InstructionSet, Lanes, Wide, dispatch_wide};

/// Vectors of the nodes: x, y, z of each, one lane a strip.
pub(super) type Nodes = Vec<[Lanes; 3]>;

/// What an element keeps from step to step. Strains as (Exx + Eyy, Exx − Eyy, 2 Exy), stresses as
/// ((Sxx + Syy)/2, (Sxx − Syy)/2, Sxy).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct ElementState {
    /// Ê.
    pub strain: [Lanes; 3],
    /// S, Pa.
    pub stress: [Lanes; 3],
    /// P.
    pub creep: [Lanes; 3],
    /// D, Pa.
    pub numerical: [Lanes; 3],
}

/// What the forces of a step depend on, beside the positions.
#[derive(Debug, Clone, Copy)]
pub(super) struct ForceStep {
    /// Length of the step that led to the positions, s; 0 for none.
    pub length: f64,
    /// Overpressure, Pa.
    pub overpressure: f64,
    /// 1 − exp(−Δt/τ).
    pub creep_share: f64,
}

/// Sums of a step over all elements and strips.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct StepSums {
    /// Material loss of the step, J.
    pub loss: f64,
    /// Numerical dissipation of the step, J.
    pub numerical: f64,
    /// Largest principal stress, Pa.
    pub stress: f64,
}

#[inline(always)]
fn load<L: Wide>(lanes: &[Lanes; 3]) -> [L; 3] {
    [L::load(&lanes[0].0, 0), L::load(&lanes[1].0, 0), L::load(&lanes[2].0, 0)]
}

#[inline(always)]
fn store<L: Wide>(value: [L; 3]) -> [Lanes; 3] {
    [value[0].lanes(), value[1].lanes(), value[2].lanes()]
}

/// Stress of an element at its strain; replaces the state. Adds to minus twice loss and numerical
/// dissipation.
#[inline(always)]
fn element_stress<L: Wide>(
    strip: &Strip,
    element: &StripElement,
    strain: [L; 3],
    step: ForceStep,
    state: &mut ElementState,
    totals: &mut [L; 3],
) -> [L; 3] {
    let creep = &strip.creep;
    let zero = L::splat(0.0);
    let (last_strain, last_stress) = (load::<L>(&state.strain), load::<L>(&state.stress));
    let last_numerical = load::<L>(&state.numerical);
    let mut creep_strain = load::<L>(&state.creep);
    let last_driving = subtract(last_stress, isotropic(creep_strain, creep.stiffness));
    let creep_step = scale(isotropic(last_driving, creep.compliance), L::splat(step.creep_share));
    creep_strain = Creep::after_step(creep_strain, creep_step);
    let over = scale(subtract(strain, creep_strain), L::splat(creep.ratio));
    let elastic = add(strain, over);
    let circle = MohrCircle::of_difference(elastic[0], elastic[1], elastic[2]);
    let StressResponse { mean, shear_modulus, largest } = strip.material.response(circle);
    let stress = [mean, shear_modulus * circle.difference, shear_modulus * circle.shear];
    let mut numerical = [zero; 3];
    if step.length > 0.0 {
        let minus_volume = L::splat(element.minus_volume);
        let (strain_step, stress_step) =
            (subtract(elastic, last_strain), subtract(stress, last_stress));
        let twice_missed = contract(stress, last_strain) - contract(last_stress, elastic);
        let work = contract(stress_step, strain_step).max(L::splat(f64::MIN_POSITIVE));
        let half = L::splat(0.5);
        let share = (twice_missed * half).over(work);
        let share = -((-share.max(-half)).max(-half));
        let damping = L::splat(element.damping_time / step.length);
        numerical = scale(stress_step, share + damping);
        let displacement = add(strain_step, scale(creep_step, L::splat(creep.ratio)));
        let twice_work = contract(add(numerical, last_numerical), displacement) - twice_missed;
        let driving = subtract(stress, isotropic(creep_strain, creep.stiffness));
        totals[0] = totals[0] + minus_volume * contract(add(driving, last_driving), creep_step);
        totals[1] = totals[1] + minus_volume * twice_work;
    }
    totals[2] = totals[2].max(largest);
    *state = ElementState {
        strain: store(elastic),
        stress: store(stress),
        creep: store(creep_strain),
        numerical: store(numerical),
    };
    add(stress, numerical)
}

/// Forces on the nodes at their positions.
#[inline(always)]
fn force_kernel<L: Wide>(
    strip: &Strip,
    positions: &[[Lanes; 3]],
    step: ForceStep,
    states: &mut [ElementState],
    forces: &mut [[Lanes; 3]],
) -> StepSums {
    let mut totals = [L::splat(0.0); 3];
    let third = L::splat(step.overpressure * PI / (3.0 * STRIPS as f64));
    let tiny = L::splat(f64::MIN_POSITIVE);
    let mut a = load::<L>(&positions[0]);
    let mut square_a = a[0] * a[0] + a[1] * a[1];
    let mut radius_a = square_a.sqrt();
    // Force on the node at the start of the element from the elements before.
    let mut carried = [L::splat(0.0); 3];
    for (index, element) in strip.elements.iter().enumerate() {
        let b = load::<L>(&positions[index + 1]);
        let square_b = b[0] * b[0] + b[1] * b[1];
        let radius_b = square_b.sqrt();
        let chord = subtract(b, a);
        let along = (contract(chord, chord) * element.length - L::splat(1.0)) * 0.5;
        let around = ((square_a + square_b) * element.hoop - L::splat(1.0)) * 0.5;
        let shear = (a[0] * b[1] - a[1] * b[0]) * element.shear;
        let strain = [along + around, along - around, shear];
        let stress = element_stress(strip, element, strain, step, &mut states[index], &mut totals);
        let (xx, yy) = (stress[0] + stress[1], stress[0] - stress[1]);
        let pull = xx * (element.minus_volume * element.length);
        let ring = yy * (element.minus_volume * element.hoop);
        let turn = stress[2] * (element.minus_volume * element.shear);
        // Pressure: across through the radii, along through the frustum's mean square radius.
        let area = third * (square_a + radius_a * radius_b + square_b);
        let load_a = third * chord[2] * (radius_a + radius_a + radius_b);
        let load_b = third * chord[2] * (radius_a + radius_b + radius_b);
        let across_a = ring + load_a.over(radius_a.max(tiny));
        let across_b = ring + load_b.over(radius_b.max(tiny));
        let force_a = [
            across_a * a[0] - pull * chord[0] + turn * b[1],
            across_a * a[1] - pull * chord[1] - turn * b[0],
            -(pull * chord[2]) - area,
        ];
        let force_b = [
            across_b * b[0] + pull * chord[0] - turn * a[1],
            across_b * b[1] + pull * chord[1] + turn * a[0],
            pull * chord[2] + area,
        ];
        let node = &strip.nodes[index];
        let mut total = add(carried, force_a);
        if node.min_radius > 0.0 {
            let depth = (L::splat(node.min_radius) - radius_a).max(L::splat(0.0));
            let push = (depth * depth * (node.barrier / node.min_radius)).over(radius_a.max(tiny));
            total = [total[0] + push * a[0], total[1] + push * a[1], total[2]];
        }
        forces[index] = store(total);
        carried = force_b;
        (a, square_a, radius_a) = (b, square_b, radius_b);
    }
    let last = strip.elements.len();
    forces[last] = store(carried);
    let ratio = strip.creep.ratio;
    let half = -0.5 / (1.0 + ratio);
    StepSums {
        loss: half * ratio * totals[0].lanes().sum(),
        numerical: half * totals[1].lanes().sum(),
        stress: totals[2].lanes().largest(),
    }
}

dispatch_wide! {
    /// Sets `forces` (N) to the forces of film, gas and barrier at these positions (m).
    pub(super) fn set_forces / force_kernel(
        strip: &Strip,
        positions: &[[Lanes; 3]],
        step: ForceStep,
        states: &mut [ElementState],
        forces: &mut [[Lanes; 3]],
    ) -> StepSums
}

/// How velocities and positions advance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kick {
    /// Mean of the last and the next step, s.
    pub velocity_step: f64,
    /// The next step, s; 0 only reads the volume.
    pub drift: f64,
    /// Acceleration of gravity along z, m/s².
    pub gravity: f64,
    /// Factor of the velocities, 1 without damping.
    pub keep: f64,
    /// Whether heights stay.
    pub level: bool,
}

#[inline(always)]
fn move_kernel<L: Wide>(
    strip: &Strip,
    forces: &[[Lanes; 3]],
    kick: Kick,
    positions: &mut [[Lanes; 3]],
    velocities: &mut [[Lanes; 3]],
) -> f64 {
    let mut volume = L::splat(0.0);
    let (mut last_z, mut last_radius) = (L::splat(0.0), L::splat(0.0));
    let (drift, keep) = (L::splat(kick.drift), L::splat(kick.keep));
    for (index, node) in strip.nodes.iter().enumerate() {
        let mut x = load::<L>(&positions[index]);
        if kick.drift > 0.0 {
            let (mut v, f) = (load::<L>(&velocities[index]), load::<L>(&forces[index]));
            let across = L::splat(kick.velocity_step * node.across);
            let free = node.along > 0.0 && !kick.level;
            let along = L::splat(if free { kick.velocity_step * node.along } else { 0.0 });
            let fall = L::splat(if free { kick.velocity_step * kick.gravity } else { 0.0 });
            v = [v[0] + f[0] * across, v[1] + f[1] * across, v[2] + f[2] * along + fall];
            v = scale(v, keep);
            x = add(x, scale(v, drift));
            velocities[index] = store(v);
            positions[index] = store(x);
        }
        let square = x[0] * x[0] + x[1] * x[1];
        let radius = square.sqrt();
        let squares = square + radius * last_radius + last_radius * last_radius;
        // The first node lies on the axis and closes nothing.
        if index > 0 {
            volume = volume + (x[2] - last_z) * squares;
        }
        (last_z, last_radius) = (x[2], radius);
    }
    volume.lanes().sum() * (PI / (3.0 * STRIPS as f64))
}

dispatch_wide! {
    /// Advances velocities (m/s) and positions (m), and returns the volume there (m³).
    pub(super) fn advance / move_kernel(
        strip: &Strip,
        forces: &[[Lanes; 3]],
        kick: Kick,
        positions: &mut [[Lanes; 3]],
        velocities: &mut [[Lanes; 3]],
    ) -> f64
}

/// Volume (m³) of strips at these positions (m).
pub(super) fn volume(instruction_set: InstructionSet, strip: &Strip, positions: &Nodes) -> f64 {
    let read = Kick { velocity_step: 0.0, drift: 0.0, gravity: 0.0, keep: 1.0, level: false };
    advance(instruction_set, strip, &[], read, &mut positions.clone(), &mut [])
}

#[cfg(test)]
mod tests;
