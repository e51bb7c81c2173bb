//! Projection of contacts and plates, and displacements that let no film pass.
//!
//! ```text
//! C = √(2 E)      E energy of a contact or of a node at a plate      α̃ λ, Δx: as those of an element
//! gap             d = n·Σ w x, with n and w of the start of the substep: signed, so a predicted passage is undone
//! a pair that loses more than nine tenths of its gap:  u_i ← ū + s (u_i − ū)      ū of the pair's centre of mass
//! ```
//!
//! s is the safe share of the pair's relative motion ([`crate::collision::contact::safe_step`]). The pair
//! keeps its momentum and loses energy: that is the ledger's `contact_dissipation`.

use nalgebra::Vector3;

use super::constraints::Mobility;
use crate::collision::contact::ContactModel;
use crate::collision::contact::distance::Closest;
use crate::collision::contact::pair::{CandidatePair, vectors_of};
use crate::collision::contact::safe_step::{MAX_UNTESTED_APPROACH, MIN_KEPT_SHARE};
use crate::geometry::field::Field;
use crate::platform::fault_injection::Term;
use crate::system::{FilmState, FilmSystem};

/// Rounds over all candidates before all displacements are scaled at once. Chosen: most substeps need two.
const MAX_ROUNDS: u32 = 20;
/// Upper bound of the approach of a pair over the largest displacement of a node: relative to the mean of four
/// nodes both primitives move by at most 1.5 of it each; the rest covers rounding.
const MAX_APPROACH_PER_DISPLACEMENT: f64 = 3.01;

/// Moves nodes (positions `next`, m) by one projection of every contact of a state, over a substep of `length`
/// (s) that ends at the time `end` (s).
pub(super) fn project_contacts(
    system: &FilmSystem,
    state: &FilmState,
    mobility: &Mobility,
    (length, end): (f64, f64),
    next: &mut Field,
) {
    let Some(model) = &system.contact else { return };
    let (squared, fault) = (length * length, system.fault_factor(Term::Contact));
    for contact in &state.contact.contacts {
        let nodes = contact.pair.nodes(&model.mesh.topology);
        let Closest { weights, between, squared: gap_squared } =
            contact.pair.closest(&vectors_of(&state.positions, nodes));
        if gap_squared <= 0.0 {
            continue;
        }
        let normal = between / gap_squared.sqrt();
        let at = vectors_of(next, nodes);
        let gap: f64 = at.iter().zip(weights).map(|(x, weight)| normal.dot(x) * weight).sum();
        let (force, twice_energy) =
            (contact.repulsive_force(gap), 2.0 * contact.stored_energy(gap));
        if twice_energy <= 0.0 {
            continue;
        }
        let forces = weights.map(|weight| normal * (force * weight));
        let moves: [Vector3<f64>; 4] =
            core::array::from_fn(|k| mobility.of(nodes[k] as usize, forces[k]));
        let power: f64 = forces.iter().zip(&moves).map(|(force, moved)| force.dot(moved)).sum();
        let factor = fault * squared / (1.0 + squared * power / twice_energy);
        for (node, moved) in nodes.iter().zip(moves) {
            let node = *node as usize;
            next.set(node, next.get(node) + moved * factor);
        }
    }
    for (plate, plate_state) in model.plates.iter().zip(&state.contact.plates) {
        if end >= plate.removal_time || plate_state.offsets.is_empty() {
            continue;
        }
        let height = plate.height(end);
        for node in 0..next.len() {
            let gap = plate.normal.dot(&next.get(node)) - height;
            let offset = plate_state.offsets[node].max(gap.min(model.distance));
            let penetration = offset - gap;
            if penetration <= 0.0 {
                continue;
            }
            // f = k p²/(2 o), 2 E = k p³/(3 o): f/(2 E) = 3/(2 p).
            let stiffness = model.stiffness_per_mass * system.model.mass[node];
            let force = plate.normal * (0.5 * stiffness * penetration * penetration / offset);
            let moved = mobility.of(node, force);
            let power = 1.5 / penetration * plate.normal.dot(&moved);
            next.set(node, next.get(node) + moved * (fault * squared / (1.0 + squared * power)));
        }
    }
}

/// What keeping film apart took.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Separation {
    /// Σ ½ m (|u|² − |u′|²), kg m²: over the square of the substep an energy.
    pub dissipation: f64,
    /// Number of pairs that were changed.
    pub pairs: u64,
}

/// Changes displacements (m) from the positions of a state until no candidate and no node in front of a plate
/// loses more than nine tenths of its gap in a substep that ends at the time `end` (s). `largest` (m): bound of the
/// displacements that the candidates were collected for.
pub(super) fn keep_apart(
    system: &FilmSystem,
    state: &FilmState,
    mobility: &Mobility,
    candidates: &[CandidatePair],
    (largest, end): (f64, f64),
    displacements: &mut Field,
) -> Separation {
    let mut separation = Separation::default();
    let Some(model) = &system.contact else { return separation };
    let safe = MAX_UNTESTED_APPROACH * model.bound_factor() / MAX_APPROACH_PER_DISPLACEMENT;
    let energy = |displacements: &Field| -> f64 {
        let nodes = system.model.mass.iter().zip(displacements.iter());
        nodes.map(|(mass, u)| 0.5 * mass * u.norm_squared()).sum()
    };
    let before = energy(displacements);
    let mut bound = largest;
    for _ in 0..MAX_ROUNDS {
        let plates = stop_at_plates(model, state, end, displacements);
        let mut changed = 0;
        for candidate in candidates {
            if candidate.gap * safe > bound && changed == 0 && separation.pairs == 0 {
                continue;
            }
            if slow_down(system, state, mobility, (model, *candidate), displacements) {
                changed += 1;
            }
        }
        separation.pairs += changed;
        if changed == 0 && plates == 0 {
            break;
        }
        bound = largest;
    }
    if separation.pairs > 0 {
        let share = model.safe_step(candidates, &state.positions, displacements, state.time);
        if share < 1.0 {
            for node in 0..displacements.len() {
                displacements.set(node, displacements.get(node) * share);
            }
        }
        separation.dissipation = before - energy(displacements);
    }
    separation
}

/// Makes the relative motion of one candidate safe. Returns whether it was not.
fn slow_down(
    system: &FilmSystem,
    state: &FilmState,
    mobility: &Mobility,
    (model, candidate): (&ContactModel, CandidatePair),
    displacements: &mut Field,
) -> bool {
    let nodes = candidate.pair.nodes(&model.mesh.topology);
    let (x, moves) = (vectors_of(&state.positions, nodes), vectors_of(displacements, nodes));
    let share = model.safe_time_of_pair(candidate.pair, candidate.gap, &x, &moves);
    if share >= 1.0 {
        return false;
    }
    let (mut mass, mut moment) = (0.0, Vector3::zeros());
    let free = nodes.map(|node| mobility.is_free(node as usize));
    for k in 0..4 {
        // A node that a support holds counts alone: it does not yield.
        if free[k] == free.iter().all(|free| *free) {
            let weight = if free[k] { system.model.mass[nodes[k] as usize] } else { 1.0 };
            mass += weight;
            moment += moves[k] * weight;
        }
    }
    let common = moment / mass;
    for k in (0..4).filter(|k| free[*k]) {
        displacements.set(nodes[k] as usize, common + (moves[k] - common) * share);
    }
    true
}

/// Takes from each displacement what brings its node nearer to a plate than a tenth of its gap. Returns the number
/// of displacements that were changed.
fn stop_at_plates(
    model: &ContactModel,
    state: &FilmState,
    end: f64,
    displacements: &mut Field,
) -> u64 {
    let mut changed = 0;
    for plate in model.plates.iter().filter(|plate| end < plate.removal_time) {
        let height = plate.height(end);
        for node in 0..displacements.len() {
            let (x, u) = (state.positions.get(node), displacements.get(node));
            let gap = plate.normal.dot(&x) - height;
            let excess = -plate.normal.dot(&u) - (1.0 - MIN_KEPT_SHARE) * gap;
            if gap >= 0.0 && excess > 0.0 {
                displacements.set(node, u + plate.normal * excess);
                changed += u64::from(excess > 1e-12 * gap);
            }
        }
    }
    changed
}
