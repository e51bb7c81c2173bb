//! Scratch of an evaluation: it belongs to the caller, and what it holds of a trial becomes the state only
//! when it is committed.

use super::{FilmState, FilmSystem};
use crate::collision::contact::candidates::CandidateList;
use crate::collision::contact::{ContactModel, ContactState, PlateState, SearchProgress};
use crate::geometry::field::Field;
use crate::mechanics::forces::membrane::{
    CreepStep, CreepStrain, ElementHistory, MembraneSums, NodeForces, assemble_conservative,
    assemble_membrane, numerical_forces,
};
use crate::mechanics::forces::pressure::add_closure;
use crate::platform::fault_injection::Term;
use crate::platform::stopwatch::{Stage, Stopwatch};

/// Forces at the positions that were evaluated last, and what a trial at them would change.
#[derive(Debug, Clone)]
pub struct Workspace {
    /// Forces on the nodes.
    pub forces: NodeForces,
    /// Strain and stress of the elements, and the numerical stress of a method that has one.
    pub histories: Vec<[ElementHistory; 2]>,
    /// Creep strain after a step; empty for film without loss.
    creep: Vec<[CreepStrain; 2]>,
    /// Search and trial of contact; `None` without contact.
    pub contact: Option<ContactWorkspace>,
}

/// Search for contacts, and the contacts of a trial.
#[derive(Debug, Clone)]
pub struct ContactWorkspace {
    /// Pairs that may be in contact: a function of the motion so far.
    pub list: CandidateList,
    /// How far the search has come.
    pub progress: SearchProgress,
    /// Contacts and plates at the positions evaluated last.
    pub trial: ContactState,
    /// Positions that the search was prepared for, m; only [`FilmSystem::evaluate`] uses them.
    pub(super) prepared: Field,
}

impl ContactWorkspace {
    /// The search at these positions (m), continued from this progress.
    pub fn new(contact_model: &ContactModel, positions: &Field, progress: SearchProgress) -> Self {
        Self {
            list: CandidateList::build(contact_model, positions, progress.path_length),
            progress,
            trial: ContactState {
                contacts: Vec::new(),
                plates: vec![PlateState::default(); contact_model.plates.len()],
            },
            prepared: positions.clone(),
        }
    }
}

impl Workspace {
    /// A workspace for this system, with the search for contacts at the positions of a state.
    pub fn new(system: &FilmSystem, state: &FilmState) -> Self {
        Self::resumed(system, state, SearchProgress { path_length: 0.0, rebuilds: 1 })
    }

    /// A workspace whose search continues from this progress.
    pub fn resumed(system: &FilmSystem, state: &FilmState, progress: SearchProgress) -> Self {
        Self {
            forces: system.no_forces(),
            histories: ElementHistory::zero(&system.model),
            creep: state.creep.clone(),
            contact: system
                .contact
                .as_ref()
                .map(|model| ContactWorkspace::new(model, &state.positions, progress)),
        }
    }

    /// Forces of a state at its positions and time, and its contacts as a trial. `step`: the time since the
    /// positions evaluated before, s, for a method whose numerical stress follows its steps, 0 if nothing
    /// moved since; `None` for the conservative part.
    pub fn forces_at(
        &mut self,
        system: &FilmSystem,
        state: &FilmState,
        step: Option<f64>,
    ) -> MembraneSums {
        let mut sums = self.membrane(system, state, &state.positions, step);
        self.add_other_forces(system, &state.positions, &mut sums);
        system.term_forces(&state.positions, &state.yielded, &mut self.forces);
        self.contact_at(system, state, &state.positions, state.time);
        sums
    }

    /// [`Self::forces_at`] after a step of `length` (s) that ends at the time `end` (s), with a stopwatch, but for the
    /// further energies ([`FilmSystem::term_forces`]); makes creep strain and contacts those of the state.
    pub(crate) fn step_forces(
        &mut self,
        system: &FilmSystem,
        state: &mut FilmState,
        length: f64,
        end: f64,
        stopwatch: &mut dyn Stopwatch,
    ) -> MembraneSums {
        stopwatch.begins(Stage::Membrane);
        system.model.closure_nodes.place(&mut state.positions);
        let mut sums = self.membrane(system, state, &state.positions, Some(length));
        if length > 0.0 {
            core::mem::swap(&mut state.creep, &mut self.creep);
        }
        self.add_other_forces(system, &state.positions, &mut sums);
        stopwatch.begins(Stage::Pairs);
        self.contact_at(system, state, &state.positions, end);
        self.commit_contact(state);
        sums
    }

    /// Prepares the search for contacts at any positions (m).
    pub(super) fn prepare_search(&mut self, system: &FilmSystem, positions: &Field) {
        let (Some(model), Some(contact)) = (&system.contact, &mut self.contact) else { return };
        let moved = contact.prepared.largest_displacement(positions);
        if moved > 0.0 {
            contact.list.prepare_step(model, positions, &mut contact.progress, moved);
            contact.prepared.copy_from(positions);
        }
    }

    /// Membrane forces and ∂V/∂x of the film alone.
    pub(super) fn membrane(
        &mut self,
        system: &FilmSystem,
        state: &FilmState,
        positions: &Field,
        step: Option<f64>,
    ) -> MembraneSums {
        let (set, model) = (system.instruction_set, &system.model);
        let Self { forces, histories, creep, .. } = self;
        match step {
            None => assemble_conservative(set, model, positions, &state.creep, histories, forces),
            Some(step) => {
                let creep_step = &mut CreepStep { last: &state.creep, next: creep };
                assemble_membrane(set, model, positions, step, creep_step, histories, forces)
            }
        }
    }

    /// Adds the closing faces, and injects a fault.
    pub(super) fn add_other_forces(
        &mut self,
        system: &FilmSystem,
        positions: &Field,
        sums: &mut MembraneSums,
    ) {
        sums.six_volumes += add_closure(&system.model, positions, &mut self.forces);
        if system.fault.is_some() {
            self.inject_fault(system, positions, sums);
        }
    }

    /// Contacts and plates at these positions (m) and this time (s), as a trial, and their forces.
    pub(super) fn contact_at(
        &mut self,
        system: &FilmSystem,
        state: &FilmState,
        positions: &Field,
        time: f64,
    ) {
        let (Some(model), Some(contact)) = (&system.contact, &mut self.contact) else { return };
        let ContactWorkspace { list, progress, trial, .. } = contact;
        let forces = &mut self.forces.contact;
        if list.contact_active {
            let Field { x, y, z } = &mut *forces;
            for column in [x, y, z] {
                column.fill(0.0);
            }
        }
        let (mass, last) = (&system.model.mass, &state.contact);
        let path_length = progress.path_length;
        let out = (&mut trial.contacts, &mut *forces);
        model.contacts_at(positions, mass, &last.contacts, path_length, list, out);
        list.contact_active = !trial.contacts.is_empty() || !model.plates.is_empty();
        let states = last.plates.iter().zip(&mut trial.plates);
        for (plate, (last, next)) in model.plates.iter().zip(states) {
            let (film, now) = (&system.model, (positions, time));
            plate.state_at(model, film, now, last, (next, &mut *forces));
        }
        if system.fault.is_some() {
            let factor = system.fault_factor(Term::Contact);
            for node in 0..forces.len() {
                forces.set(node, forces.get(node) * factor);
            }
        }
    }

    /// Whether contact or a plate may exert a force at the positions evaluated last.
    pub fn contact_active(&self) -> bool {
        self.contact.as_ref().is_some_and(|contact| contact.list.contact_active)
    }

    /// Path length of the search for contacts, m; 0 without contact.
    pub fn path_length(&self) -> f64 {
        self.contact.as_ref().map_or(0.0, |contact| contact.progress.path_length)
    }

    /// Makes the contacts of the trial those of the state.
    pub fn commit_contact(&mut self, state: &mut FilmState) {
        if let Some(contact) = &mut self.contact {
            core::mem::swap(&mut state.contact, &mut contact.trial);
        }
    }

    /// Makes positions (m) that were evaluated last, with their contacts and volume, those of the state.
    /// The gas is another step's matter ([`FilmSystem::gas_step`]).
    pub fn commit(&mut self, state: &mut FilmState, positions: &Field) {
        state.positions.copy_from(positions);
        self.commit_contact(state);
    }

    /// Applies a deliberate fault to the forces: tests only.
    fn inject_fault(&mut self, system: &FilmSystem, positions: &Field, sums: &mut MembraneSums) {
        let [elastic, numerical, area] =
            [Term::Elastic, Term::NumericalStress, Term::PressureForce]
                .map(|term| system.fault_factor(term));
        let damping = numerical_forces(&system.model, positions, &self.histories);
        for (node, damping) in damping.iter().enumerate() {
            let elastic_force = self.forces.film(node) - damping;
            self.forces.set_film(node, elastic_force * elastic + damping * numerical);
            self.forces.scale_area(node, area);
        }
        sums.six_volumes *= system.fault_factor(Term::Volume);
    }
}
