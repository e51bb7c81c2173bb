//! The part of a step that prevents passages of film through film and plates.

use super::collisions::{CollisionStep, Impulses, apply_friction, resolve_pairs, resolve_plate};
use super::stability::moves_too_far;
use super::update::largest_squared_speed;
use super::{Explicit, failure};
use crate::collision::contact::candidates::CandidateList;
use crate::collision::contact::{ContactModel, Pair, PairKind, SearchProgress};
use crate::geometry::field::Field;
use crate::output::outcome::{AuditKind, Failure};
use crate::platform::simd::InstructionSet;
use crate::platform::stopwatch::{Stage, Stopwatch};
use crate::system::{ContactWorkspace, FilmState, FilmSystem};

/// Largest number of alternations between pairs of film and plates in a step. Chosen: a stack that is
/// pressed between plates needs several, because each plate changes the velocities of the outer
/// layers; a step that needs more is taken to have no solution.
const MAX_ALTERNATIONS: u32 = 50;

/// What could not be separated in a step.
enum Unresolved {
    /// A pair of primitives.
    Pair(Pair),
    /// Film between plates.
    Plates,
}

impl Unresolved {
    fn message(&self) -> String {
        match self {
            Self::Pair(pair) => {
                let [first, second] = match pair.kind {
                    PairKind::NodeElement => ["node", "element"],
                    PairKind::EdgeEdge => ["edge", "edge"],
                };
                format!(
                    "{first} {} and {second} {} could not be kept apart",
                    pair.first, pair.second
                )
            }
            Self::Plates => "film between plates could not be kept apart".to_owned(),
        }
    }
}

/// Largest speed of any node, m/s. NaN is ignored; the volume shows it.
fn largest_speed(instruction_set: InstructionSet, velocities: &Field) -> f64 {
    largest_squared_speed(instruction_set, velocities).sqrt()
}

/// Changes the velocities of a step until no pair and no plate lets film through.
///
/// Pairs and plates alternate until a whole alternation changes nothing. An impulse can make a node
/// faster than the candidates were collected for; they are collected again then.
fn resolve_all(
    contact_model: &ContactModel,
    step: &mut CollisionStep<'_>,
    (candidates, progress): (&mut CandidateList, &mut SearchProgress),
    impulses: &mut u64,
    displacements: MaxDisplacements,
    instruction_set: InstructionSet,
) -> Result<(), Unresolved> {
    let MaxDisplacements { mut prepared, mut current } = displacements;
    for alternation in 0..MAX_ALTERNATIONS {
        let pairs = &candidates.candidates;
        resolve_pairs(contact_model, step, pairs, current, alternation, impulses)
            .map_err(Unresolved::Pair)?;
        let impulses_before = step.impulses.len();
        for plate in &contact_model.plates {
            resolve_plate(plate, step);
        }
        // Without an impulse `current` still holds.
        let displacement = if step.impulses.is_empty() {
            current
        } else {
            largest_speed(instruction_set, step.velocities) * step.length
        };
        let exceeds = displacement > prepared;
        if exceeds {
            progress.path_length -= prepared;
            candidates.prepare_step(contact_model, step.positions, progress, displacement);
            prepared = displacement;
            current = displacement;
        }
        if !exceeds && step.impulses.len() == impulses_before {
            return Ok(());
        }
    }
    Err(Unresolved::Plates)
}

/// Upper bounds of the displacement of any node in a step, m.
#[derive(Clone, Copy)]
struct MaxDisplacements {
    /// The bound that the candidates were collected for.
    prepared: f64,
    /// The bound that holds now; friction may have made it larger.
    current: f64,
}

impl Explicit {
    /// Collects the pairs that the next drift of `length` (s) can bring together, applies friction for
    /// a kick of `kick_length` (s), and resolves the collisions of these pairs and of plates.
    pub(super) fn collision_step(
        &mut self,
        system: &FilmSystem,
        state: &FilmState,
        kick_length: f64,
        length: f64,
        stopwatch: &mut dyn Stopwatch,
    ) -> Result<(), Failure> {
        let Some(contact_model) = &system.contact else { return Ok(()) };
        let Some(ContactWorkspace { list, progress, .. }) = &mut self.workspace.contact else {
            return Ok(());
        };
        let set = system.instruction_set;
        let (velocities, accounting) = (&mut self.motion.velocities, &mut self.motion.accounting);
        let speed = largest_speed(set, velocities);
        if moves_too_far(&system.model, speed * length) {
            // The step fails as unstable; candidates for such speeds would be meaningless.
            return Ok(());
        }
        let prepared = speed * length;
        stopwatch.begins(Stage::Search);
        list.prepare_step(contact_model, &state.positions, progress, prepared);
        stopwatch.begins(Stage::Pairs);
        let mut step = CollisionStep {
            film: &system.model,
            supports: &system.supports,
            positions: &state.positions,
            velocities_before_kick: &self.next,
            velocities,
            start: state.time,
            length,
            impulses: Impulses::new(),
        };
        let contacts = &state.contact.contacts;
        let friction = apply_friction(contact_model, contacts, &mut step, kick_length);
        // Friction can make a node faster.
        let current = if contact_model.friction > 0.0 {
            prepared.max(largest_speed(set, step.velocities) * length)
        } else {
            prepared
        };
        let bounds = MaxDisplacements { prepared, current };
        let impulses = &mut accounting.collision_impulses;
        let search = (list, progress);
        let resolved = resolve_all(contact_model, &mut step, search, impulses, bounds, set);
        if let Err(unresolved) = resolved {
            return Err(failure(state, AuditKind::Passages, &unresolved.message()));
        }
        accounting.friction_dissipation += step.dissipation(&friction);
        accounting.collision_dissipation += step.dissipation(&step.impulses);
        if let Some(contact) = &self.workspace.contact {
            self.motion.accounting.broad_phase_rebuilds = contact.progress.rebuilds;
        }
        Ok(())
    }

    /// Adds half a step's work of the plates, with their forces now, for the motion until `until` (s).
    pub(super) fn add_plate_work(&mut self, system: &FilmSystem, state: &FilmState, until: f64) {
        let Some(contact_model) = &system.contact else { return };
        let works = &mut self.motion.accounting.works;
        for (plate, plate_state) in contact_model.plates.iter().zip(&state.contact.plates) {
            let work = 0.5 * plate_state.force * plate.displacement(state.time, until);
            works.support += work;
            works.contact -= work;
        }
    }
}
