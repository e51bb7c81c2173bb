//! Every fault. `docs/reference/faults.md` says which audit catches it in each integrator.

use billow_solver::platform::fault_injection::{Fault, Term};

use super::injected::Change;
use super::scenes::{self, SceneOf};
use super::stored;
use crate::prelude::*;

/// A fault: its name in the table of the page, the change that makes it, and the scenes in which it is made.
pub type Row = (&'static str, Change, &'static [Place]);

/// Where a fault is made: name and start of the scene, and from when, s.
pub type Place = (&'static str, SceneOf, f64);

fn term(system: &mut FilmSystem, term: Term, factor: f64) -> bool {
    system.fault = Some(Fault { term, factor });
    true
}

/// The first contact that there is, that with the smallest gap, is in no list from then on.
fn lose_pair(system: &mut FilmSystem, state: &FilmState) -> bool {
    let contacts = state.contact.contacts.iter();
    let Some(nearest) = contacts.min_by(|a, b| a.gap.total_cmp(&b.gap)) else { return false };
    let model = system.contact.as_mut().expect("contact");
    model.broad_phase_fault = Some(BroadPhaseFault::LostPair(nearest.pair));
    true
}

fn stop_search(system: &mut FilmSystem, _: &FilmState) -> bool {
    let model = system.contact.as_mut().expect("contact");
    model.broad_phase_fault = Some(BroadPhaseFault::StoppedQueues(0.0));
    true
}

fn double_mass(system: &mut FilmSystem, _: &FilmState) -> bool {
    system.model.mass[5] *= 2.0;
    system.model.inverse_mass[5] *= 0.5;
    true
}

const ELASTIC: Change = Change::System(|system, _| term(system, Term::Elastic, -1.0));
const PRESSURE: Change = Change::System(|system, _| term(system, Term::PressureForce, -1.0));
const CONTACT: Change = Change::System(|system, _| term(system, Term::Contact, -1.0));
const NUMERICAL: Change = Change::System(|system, _| term(system, Term::NumericalStress, -1.0));
const GAS_WORK: Change = Change::System(|system, _| term(system, Term::GasWork, 1.01));
const PUSH: Change = Change::System(|system, _| term(system, Term::PressureForce, 1.01));
const GAS_PRESSURE: Change = Change::System(|system, _| term(system, Term::GasPressure, 1.01));
const VOLUME: Change = Change::System(|system, _| term(system, Term::Volume, 1.01));
const NAN_FORCE: Change = Change::OneStep(|system| {
    term(system, Term::Elastic, f64::NAN);
});
const NAN_POSITION: Change = Change::Stored(|stored, _| {
    stored::change_state(stored, |state| state.positions.x[5] = f64::NAN);
});
const NAN_VELOCITY: Change = Change::Stored(|stored, _| {
    stored::change_velocities(stored, |velocities| velocities.x[5] = f64::NAN);
});
const NAN_GAS: Change = Change::Stored(|stored, _| {
    stored::change_state(stored, |state| state.gas.internal_energy = f64::NAN);
});
const FAR: Change = Change::Stored(|stored, system| {
    let distance = stored::edge_length(stored, system);
    stored::teleport(stored, distance);
});
const THROUGH: Change = Change::Stored(|stored, _| stored::teleport(stored, -scenes::DISTANCE));
const NO_CREEP: Change = Change::Stored(|stored, _| {
    stored::change_state(stored, |state| state.creep.fill_with(Default::default));
});
const NO_NUMERICAL: Change = Change::Stored(|stored, _| stored::forget_numerical_stress(stored));

pub const BAG: Place = ("bag", scenes::bag, 0.0102);
pub const FILLING: Place = ("filling", scenes::filling, 0.302);
pub const SHEETS: Place = ("sheets", scenes::sheets, 0.0022);
pub const STRIP: Place = ("strip", scenes::strip, 0.0003);
const TOUCHING: Place = ("sheets", scenes::sheets, 0.0);
pub const CAPSULE: Place = ("capsule", scenes::capsule, 0.0102);

pub const ROWS: &[Row] = &[
    ("sign of the elastic force", ELASTIC, &[BAG, FILLING, CAPSULE]),
    ("sign of the force of the pressure", PRESSURE, &[BAG, FILLING]),
    ("sign of the contact force", CONTACT, &[SHEETS, CAPSULE]),
    ("sign of the numerical stress", NUMERICAL, &[BAG]),
    ("gas loses 1 % more than its work", GAS_WORK, &[BAG, FILLING]),
    ("force of the pressure 1 % too large", PUSH, &[BAG, FILLING]),
    ("pressure 1 % too large", GAS_PRESSURE, &[BAG]),
    ("volume 1 % too large", VOLUME, &[BAG]),
    ("one step doubled", Change::DoubledStep, &[BAG, FILLING, SHEETS]),
    ("NaN in one position", NAN_POSITION, &[BAG, FILLING]),
    ("NaN in one velocity", NAN_VELOCITY, &[BAG, FILLING]),
    ("NaN in the forces of one step", NAN_FORCE, &[BAG, FILLING]),
    ("NaN in the energy of the gas", NAN_GAS, &[BAG, FILLING]),
    ("a node elsewhere by an edge", FAR, &[BAG, FILLING, SHEETS]),
    ("a node elsewhere by a contact distance", THROUGH, &[SHEETS, CAPSULE]),
    ("creep strain zeroed", NO_CREEP, &[STRIP, BAG, FILLING]),
    ("numerical stress zeroed", NO_NUMERICAL, &[BAG]),
    ("stale broad phase", Change::System(stop_search), &[SHEETS, CAPSULE]),
    ("a contact pair lost", Change::System(lose_pair), &[TOUCHING]),
    ("mass of a node doubled", Change::System(double_mass), &[BAG, FILLING]),
];
