//! The audit of contact forces: they are the derivative of the energy of the contacts.
//!
//! ```text
//! Σ F·δ = −Σ_contacts dE/dd n·Σ w δ − Σ_plates dE/dd n·δ           |Δ| ≤ 1e-5 Σ |…|
//! dE/dd = (8 (E(d + η) − E(d − η)) − E(d + 2 η) + E(d − 2 η))/(12 η)        exact for a cubic
//! ```
//!
//! Symbols: F contact forces of the integrator, N; δ a pseudo-random virtual displacement, m; d gap and n direction
//! of a contact at the positions of the state, w weights of its closest points; E its energy, repulsion and adhesion,
//! J, each a cubic of d; η a quarter of the distance to where that cubic ends, m. A contact that the forces lack, one
//! that they have twice, and a sign are seen; a pair that is in no list of contacts is not.

use super::virtual_displacement::displacement;
use crate::collision::contact::distance::Closest;
use crate::collision::contact::{Contact, ContactModel};
use crate::mechanics::forces::membrane::NodeForces;
use crate::output::outcome::{AuditKind, Failure};
use crate::system::{FilmState, FilmSystem};

/// Bound of the difference in virtual work over its magnitude. Chosen: above the rounding of energies.
const MAX_DIFFERENCE: f64 = 1e-5;
/// η over the distance to the nearer end of the cubic. Chosen: 2 η stays inside.
const STEP: f64 = 0.25;
/// That distance over the range of adhesion below which the force is left out. Chosen: the energy differs by its
/// rounding there, and the force is a tenth of what [`MIN_ADHESION`] allows.
const MIN_DISTANCE: f64 = 1e-8;

/// Penetration over the offset below which a force counts as that of this penetration. Chosen: the rounding of a gap
/// is no error.
const MIN_PENETRATION: f64 = 1e-3;
/// Part of the largest adhesive force that counts at least: that at a hundredth of the range. Chosen: above the
/// rounding of energies at [`MIN_DISTANCE`].
const MIN_ADHESION: f64 = 0.04;

/// Sum of virtual works, J, and of their magnitudes.
#[derive(Debug, Clone, Copy, Default)]
struct VirtualWork {
    sum: f64,
    magnitude: f64,
}

impl VirtualWork {
    /// Adds the work of a force (N) along a displacement (m), which counts as at least `least` (N).
    fn add(&mut self, force: f64, moved: f64, least: f64) {
        self.sum += force * moved;
        self.magnitude += (force.abs() + least) * moved.abs();
    }
}

/// Repulsive force that counts at least, of a contact with this stiffness (N/m) and offset (m), N.
fn least_repulsion(stiffness: f64, offset: f64) -> f64 {
    0.5 * stiffness * MIN_PENETRATION * MIN_PENETRATION * offset
}

/// −dE/dd at a gap (m), with a step (m), N.
fn force(energy: impl Fn(f64) -> f64, gap: f64, step: f64) -> f64 {
    let difference = |step: f64| energy(gap - step) - energy(gap + step);
    (8.0 * difference(step) - difference(2.0 * step)) / (12.0 * step)
}

/// η of a contact with this penetration (m; negative beyond the offset) and range of adhesion (m), m; 0 without force.
fn step(penetration: f64, range: f64) -> f64 {
    let distance =
        if penetration > 0.0 { penetration } else { (-penetration).min(range + penetration) };
    if distance > MIN_DISTANCE * range { STEP * distance } else { 0.0 }
}

/// −dE/dd of a contact at a gap (m) with a range of adhesion (m), N.
fn force_of(contact: &Contact, gap: f64, range: f64) -> f64 {
    let range = if contact.adhesion > 0.0 { range } else { 0.0 };
    let energy = |gap: f64| contact.stored_energy(gap) - contact.adhesive_energy(gap, range);
    let step = step(contact.offset - gap, range);
    if step > 0.0 { force(energy, gap, step) } else { 0.0 }
}

/// Force that counts at least, of a contact, N.
fn least_force(contact: &Contact) -> f64 {
    least_repulsion(contact.stiffness, contact.offset) + MIN_ADHESION * contact.adhesion
}

/// Virtual work of the energies of contacts and plates.
fn of_energies(model: &ContactModel, system: &FilmSystem, state: &FilmState) -> VirtualWork {
    let mut work = VirtualWork::default();
    for contact in &state.contact.contacts {
        let nodes = contact.pair.nodes(&model.mesh.topology);
        let Closest { weights, between, squared } =
            contact.pair.closest(&state.positions.at(nodes));
        let gap = squared.sqrt();
        let moved = nodes
            .iter()
            .zip(weights)
            .map(|(node, weight)| between.dot(&displacement(*node as usize)) * (weight / gap));
        // Also without a force: the gap of the forces may differ by its rounding.
        let force = force_of(contact, gap, model.adhesion.range);
        work.add(force, moved.sum::<f64>(), least_force(contact));
    }
    for (plate, plate_state) in model.plates.iter().zip(&state.contact.plates) {
        let height = plate.height(state.time);
        for (node, offset) in plate_state.offsets.iter().enumerate() {
            let gap = plate.normal.dot(&state.positions.get(node)) - height;
            let penetration = offset - gap;
            if penetration > 0.0 {
                let stiffness = model.stiffness_per_mass * system.model.mass[node] / offset;
                let energy =
                    |gap: f64| stiffness * (offset - gap) * (offset - gap) * (offset - gap) / 6.0;
                let moved = plate.normal.dot(&displacement(node));
                let force = force(energy, gap, STEP * penetration);
                work.add(force, moved, least_repulsion(stiffness * offset, *offset));
            }
        }
    }
    work
}

/// Checks the contact forces of a state.
pub(super) fn check(
    system: &FilmSystem,
    state: &FilmState,
    forces: &NodeForces,
) -> Result<(), Failure> {
    let Some(model) = &system.contact else { return Ok(()) };
    let expected = of_energies(model, system, state);
    let mut work = 0.0;
    for (node, force) in forces.contact.iter().enumerate() {
        if force != nalgebra::Vector3::zeros() {
            work += force.dot(&displacement(node));
        }
    }
    // Written so that NaN fails.
    if (work - expected.sum).abs() <= MAX_DIFFERENCE * expected.magnitude {
        return Ok(());
    }
    let place = "the contact forces are not the derivative of their energy";
    Err(Failure::new(AuditKind::Contact, state.time, place))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collision::contact::pair::{Pair, PairKind};

    #[test]
    fn the_derivative_of_the_energy_is_the_force_at_every_gap() {
        let (offset, range) = (3e-4, 2e-5);
        let pair = Pair { kind: PairKind::NodeElement, first: 0, second: 0 };
        let (stiffness, adhesion) = (40.0, 1e-3);
        let contact =
            Contact { pair, feature: 0, offset, stiffness, gap: offset, adhesion, energy: 0.0 };
        for share in [0.0, 1e-12, 1e-9, 1.1e-8, 1e-6, 1e-4, 0.01, 0.3, 0.5] {
            for gap in [share, 1.0 - share, -10.0 * share].map(|share| offset + share * range) {
                let expected = contact.repulsive_force(gap) - contact.adhesive_force(gap, range);
                let difference = (expected - force_of(&contact, gap, range)).abs();
                let magnitude = expected.abs() + least_force(&contact);
                assert!(difference <= 0.5 * MAX_DIFFERENCE * magnitude, "{share}: {difference} N");
            }
        }
    }
}
