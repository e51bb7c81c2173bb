//! The audit of contact forces: they are the derivative of the energy of the contacts.
//!
//! ```text
//! Σ F·δ = −Σ_contacts dE/dd n·Σ w δ − Σ_plates dE/dd n·δ           |Δ| ≤ 1e-5 Σ |…|
//! dE/dd ≈ (E(d + η) − E(d − η))/(2 η)                               η a thousandth of the penetration
//! ```
//!
//! Symbols: F contact forces of the integrator, N; δ a pseudo-random virtual displacement, m; d gap and n direction
//! of a contact at the positions of the state, w weights of its closest points; E its energy, repulsion and adhesion,
//! J. A contact that the forces lack, one that they have twice, and a sign are seen; a pair that is in no list of
//! contacts is not.

use super::virtual_displacement::displacement;
use crate::collision::contact::ContactModel;
use crate::collision::contact::distance::Closest;
use crate::collision::contact::pair::vectors_of;
use crate::mechanics::forces::membrane::NodeForces;
use crate::output::outcome::{AuditKind, Failure};
use crate::system::{FilmState, FilmSystem};

/// Bound of the difference in virtual work over its magnitude. Chosen: above the error of the slope, 1e-6.
const MAX_DIFFERENCE: f64 = 1e-5;
/// η over the penetration, or over the range of adhesion. Chosen: its square is the error of the slope.
const STEP: f64 = 1e-3;

/// Penetration over the offset below which a force counts as that of this penetration. Chosen: the rounding of a gap
/// is no error.
const MIN_PENETRATION: f64 = 1e-3;

/// Sum of virtual works, J, and of their magnitudes.
#[derive(Debug, Clone, Copy, Default)]
struct VirtualWork {
    sum: f64,
    magnitude: f64,
}

impl VirtualWork {
    /// Adds the work of a force (N) along a displacement (m), of a contact with this stiffness (N/m) and offset (m).
    fn add(&mut self, force: f64, moved: f64, stiffness: f64, offset: f64) {
        let least = 0.5 * stiffness * MIN_PENETRATION * MIN_PENETRATION * offset;
        self.sum += force * moved;
        self.magnitude += (force.abs() + least) * moved.abs();
    }
}

/// −dE/dd at a gap (m), with a step (m), N.
fn force(energy: impl Fn(f64) -> f64, gap: f64, step: f64) -> f64 {
    (energy(gap - step) - energy(gap + step)) / (2.0 * step)
}

/// Virtual work of the energies of contacts and plates.
fn of_energies(model: &ContactModel, system: &FilmSystem, state: &FilmState) -> VirtualWork {
    let mut work = VirtualWork::default();
    let range = model.adhesion.range;
    for contact in &state.contact.contacts {
        let nodes = contact.pair.nodes(&model.mesh.topology);
        let Closest { weights, between, squared } =
            contact.pair.closest(&vectors_of(&state.positions, nodes));
        let gap = squared.sqrt();
        let energy = |gap: f64| contact.stored_energy(gap) - contact.adhesive_energy(gap, range);
        let penetration = contact.offset - gap;
        let step = STEP * if penetration > 0.0 { penetration } else { range };
        if step > 0.0 {
            let moved = nodes
                .iter()
                .zip(weights)
                .map(|(node, weight)| between.dot(&displacement(*node as usize)) * (weight / gap));
            let force = force(energy, gap, step);
            work.add(force, moved.sum::<f64>(), contact.stiffness, contact.offset);
        }
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
                work.add(force, moved, stiffness * offset, *offset);
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
