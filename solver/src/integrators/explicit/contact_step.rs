//! The part of a step that prevents passages of film through film and plates, and the monitor's part.

use super::stability::moves_too_far;
use super::update::largest_squared_speed;
use super::{Explicit, State};
use crate::collision::contact::candidates::CandidateList;
use crate::collision::contact::collision_step::{CollisionStep, Impulses};
use crate::collision::contact::{ContactModel, ContactState, Pair, PairKind};
use crate::geometry::field::Field;
use crate::output::outcome::{Failure, FailureKind};
use crate::platform::simd::InstructionSet;
use crate::platform::stopwatch::{Stage, Stopwatch};

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
    candidates: &mut CandidateList,
    state: &mut ContactState,
    displacements: MaxDisplacements,
    instruction_set: InstructionSet,
) -> Result<(), Unresolved> {
    let MaxDisplacements { mut prepared, mut current } = displacements;
    for alternation in 0..MAX_ALTERNATIONS {
        contact_model
            .resolve_collisions(step, &candidates.candidates, current, alternation, state)
            .map_err(Unresolved::Pair)?;
        let impulses_before = step.impulses.len();
        for plate in &contact_model.plates {
            plate.resolve_collisions(step);
        }
        let displacement = largest_speed(instruction_set, step.velocities) * step.length;
        let exceeds = displacement > prepared;
        if exceeds {
            state.path_length -= prepared;
            candidates.prepare_step(contact_model, step.positions, state, displacement);
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
    /// Sets the initial state of contact.
    pub(super) fn initialise_contact(&mut self) {
        let Some(contact_model) = &self.parameters.contact else { return };
        let positions = &self.state.positions;
        self.state.contact_state.broad_phase_rebuilds = 1;
        let plates = contact_model.plates.iter();
        let states = plates.map(|plate| plate.initial_state(positions, contact_model.distance));
        self.state.contact_state.plates = states.collect();
    }

    /// Updates contacts and plates, and the contact forces, at the current positions, which are those
    /// of `time` (s).
    pub(super) fn update_contact_forces(&mut self, time: f64) {
        let Some(contact_model) = &self.parameters.contact else { return };
        let (positions, state) = (&self.state.positions, &mut self.state.contact_state);
        let list = self.candidates.get_or_insert_with(|| {
            CandidateList::build(contact_model, positions, state.path_length)
        });
        if list.contact_active {
            let Field { x, y, z } = &mut self.forces.contact;
            for column in [x, y, z] {
                column.fill(0.0);
            }
        }
        let forces = &mut self.forces.contact;
        contact_model.update_contacts(positions, &self.model.mass, forces, state, list);
        list.contact_active = !state.contacts.is_empty() || !contact_model.plates.is_empty();
        for (plate, state) in contact_model.plates.iter().zip(&mut state.plates) {
            plate.add_contact_forces(contact_model, &self.model, positions, time, state, forces);
        }
    }

    /// Collects the pairs that the next drift of `length` (s) can bring together, applies friction for
    /// a kick of `kick_length` (s), and resolves the collisions of these pairs and of plates.
    pub(super) fn collision_step(
        &mut self,
        kick_length: f64,
        length: f64,
        stopwatch: &mut dyn Stopwatch,
    ) -> Result<(), Failure> {
        let Some(contact_model) = &self.parameters.contact else { return Ok(()) };
        let instruction_set = self.parameters.instruction_set;
        let State { positions, velocities, contact_state: state, time, .. } = &mut self.state;
        let list = self.candidates.get_or_insert_with(|| {
            CandidateList::build(contact_model, positions, state.path_length)
        });
        let speed = largest_speed(instruction_set, velocities);
        if moves_too_far(&self.model, speed * length) {
            // The step fails as unstable; candidates for such speeds would be meaningless.
            return Ok(());
        }
        let prepared = speed * length;
        stopwatch.begins(Stage::Search);
        list.prepare_step(contact_model, positions, state, prepared);
        stopwatch.begins(Stage::Pairs);
        let mut step = CollisionStep {
            film: &self.model,
            supports: &self.parameters.supports,
            positions,
            velocities_before_kick: &self.next,
            velocities,
            start: *time,
            length,
            impulses: Impulses::new(),
        };
        contact_model.apply_friction(&mut step, kick_length, state);
        // Friction can make a node faster.
        let current = if contact_model.friction > 0.0 {
            prepared.max(largest_speed(instruction_set, step.velocities) * length)
        } else {
            prepared
        };
        let bounds = MaxDisplacements { prepared, current };
        let resolved = resolve_all(contact_model, &mut step, list, state, bounds, instruction_set);
        if let Err(unresolved) = resolved {
            return Err(self.failure(FailureKind::Interpenetrated, &unresolved.message()));
        }
        state.collision_dissipation += step.dissipation();
        Ok(())
    }

    /// Smallest gap of the pairs of film that are closer than their contact distance, m; infinite if
    /// there is none. Pairs beyond the contact distance are not considered.
    pub fn smallest_gap(&self) -> f64 {
        self.candidates.as_ref().map_or(f64::INFINITY, |list| list.smallest_gap)
    }

    /// Number of intersections of the mesh when the monitor counted them last: at the last target, or
    /// where a run was paused.
    pub fn intersections(&self) -> u64 {
        self.monitor.as_ref().map_or(0, |monitor| monitor.intersection_counter.count)
    }

    /// Whether contact or a plate may exert a force now.
    pub(super) fn contact_active(&self) -> bool {
        let has_contact = self.parameters.contact.is_some();
        has_contact && self.candidates.as_ref().is_none_or(|list| list.contact_active)
    }

    /// Adds half a step's work of the plates, with their forces now, for the motion until `until` (s).
    pub(super) fn add_plate_work(&mut self, until: f64) {
        let Some(contact_model) = &self.parameters.contact else { return };
        let state = &mut self.state;
        for (plate, plate_state) in contact_model.plates.iter().zip(&state.contact_state.plates) {
            let work = 0.5 * plate_state.force * plate.displacement(state.time, until);
            state.works.support += work;
            state.works.contact -= work;
        }
    }

    /// Gives the monitor the positions after a step.
    ///
    /// # Errors
    /// `interpenetrated` if the monitor has found a passage.
    pub(super) fn monitor_step(&mut self) -> Result<(), Failure> {
        if let (Some(monitor), Some(contact_model)) = (&mut self.monitor, &self.parameters.contact)
        {
            monitor.record_step(&contact_model.mesh, &self.state.positions);
        }
        self.check_passages()
    }

    /// Makes the monitor test all steps that it has recorded, and count the intersections.
    ///
    /// # Errors
    /// `interpenetrated` if the monitor has found a passage.
    pub(super) fn monitor_interval(&mut self) -> Result<(), Failure> {
        if let (Some(monitor), Some(contact_model)) = (&mut self.monitor, &self.parameters.contact)
        {
            monitor.test_block(&contact_model.mesh);
            monitor.intersection_counter.update(&contact_model.mesh, &self.state.positions);
        }
        self.check_passages()
    }

    fn check_passages(&self) -> Result<(), Failure> {
        match self.monitor.as_ref().and_then(|monitor| monitor.first_passage) {
            None => Ok(()),
            Some((passage, position)) => {
                let [x, y, z] = [position.x, position.y, position.z];
                let place = format!("{passage}, near ({x:.4}, {y:.4}, {z:.4}) m");
                Err(self.failure(FailureKind::Interpenetrated, &place))
            }
        }
    }
}
