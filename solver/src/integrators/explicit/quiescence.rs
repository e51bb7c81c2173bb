//! Quiescence: a film that hardly moves takes longer steps.
//!
//! ```text
//! quiescent: for QUIET_TIME, ½ Σ m v⁻·v⁻ < 5 % of its largest value so far,
//!            no contact is active, and no phase begins
//! Δt ≤ min(16/9 CFL, 0.8) (√(1+ζ²) − ζ) 2/√(ω_film² + ω_gas²)
//! ```
//!
//! The CFL number bounds the energy error of central differences, and that error arises where the
//! stiffness changes within a step: film becomes taut or slack at speed, or touches film. A quiescent
//! film does neither, so stability alone bounds its step.
//!
//! Only film with contact can be quiescent: contact reports the first pair that touches, and from
//! that step on contact's bound holds. Without contact film is used to study vibrations, whose
//! kinetic energy is small twice in every period.
//!
//! The kinetic energy is checked when a step interval is planned and after every
//! [`CHECK_INTERVAL`] steps of it, so the decision does not depend on the sample times alone.

use serde::{Deserialize, Serialize};

use super::Explicit;
use super::motion::StepInterval;
use crate::output::events::{Event, EventKind};
use crate::scene::timeline::Phase;
use crate::system::{FilmState, FilmSystem};

/// Upper bound of the kinetic energy of a quiescent film, as a fraction of its largest value so far.
/// Chosen.
const MAX_ENERGY_FRACTION: f64 = 0.05;
/// Time for which the film must be slow and without contact, s. Chosen on the paper's capsule: longer
/// than that capsule stays slow when its motion reverses. It does not scale with the film: a much
/// larger or heavier capsule may reverse more slowly and count as quiescent too early. The energy
/// ledger then shows the error.
const QUIET_TIME: f64 = 0.02;
/// Step of a quiescent film over the step of a film in motion. Chosen.
const STEP_RATIO: f64 = 16.0 / 9.0;
/// Upper bound of the CFL number of a quiescent film. Chosen below the stability limit of 1.
const MAX_CFL: f64 = 0.8;
/// Number of steps between two checks within an interval. Chosen.
const CHECK_INTERVAL: u64 = 250;

/// What decides whether film is quiescent.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quiescence {
    /// Largest ½ Σ m v⁻·v⁻ so far, J.
    pub largest_kinetic_energy: f64,
    /// Last time at which the film was in motion or in contact, or a phase began, s.
    pub last_active: f64,
    /// Whether the film was packed in the last interval.
    packed: bool,
    /// Mass flow rate of the inflow in the last interval, kg/s.
    mass_flow_rate: f64,
    /// Whether the film was found quiescent when steps were planned last.
    quiescent: bool,
}

impl Quiescence {
    /// Of a run that continues at a time (s) after film moved with this largest kinetic energy (J).
    pub(super) fn continued(largest_kinetic_energy: f64, time: f64) -> Self {
        Self { largest_kinetic_energy, last_active: time, ..Self::default() }
    }
}

impl Explicit {
    /// Plans equal steps from now to `target` (s) under a phase, as long as the stable step allows.
    /// `None` if a step would not advance time.
    pub(super) fn plan_interval(
        &mut self,
        system: &FilmSystem,
        state: &FilmState,
        target: f64,
        phase: &Phase,
        events: &mut Vec<Event>,
    ) -> Option<StepInterval> {
        let (time, quiescence) = (state.time, &mut self.motion.quiescence);
        let rate = phase.inflow.mass_flow_rate;
        if quiescence.packed != phase.packed
            || quiescence.mass_flow_rate.to_bits() != rate.to_bits()
        {
            (quiescence.packed, quiescence.mass_flow_rate, quiescence.last_active) =
                (phase.packed, rate, time);
        }
        self.replan_interval(system, state, target, events)
    }

    /// [`Self::plan_interval`] within a phase.
    pub(super) fn replan_interval(
        &mut self,
        system: &FilmSystem,
        state: &FilmState,
        target: f64,
        events: &mut Vec<Event>,
    ) -> Option<StepInterval> {
        let quiescent = self.update_quiescence(system, state);
        if core::mem::replace(&mut self.motion.quiescence.quiescent, quiescent) != quiescent {
            let kind = if quiescent { EventKind::Quiescent } else { EventKind::Active };
            events.push(Event { time: state.time, kind });
        }
        let max_step = if quiescent {
            self.quiescent_step(system, state)
        } else {
            self.stable_step(system, state)
        };
        StepInterval::new(state.time, target, max_step, quiescent)
    }

    /// Whether an interval of a quiescent film must be planned again: the film is active, or the steps
    /// are too long by now. Call it after every step.
    pub(super) fn activity_detected(
        &mut self,
        system: &FilmSystem,
        state: &FilmState,
        interval: &StepInterval,
    ) -> bool {
        if in_contact(system, state) {
            self.motion.quiescence.last_active = state.time;
            return interval.quiescent;
        }
        if !interval.index.is_multiple_of(CHECK_INTERVAL) {
            return false;
        }
        let quiescent = self.update_quiescence(system, state);
        let too_long = || interval.length > self.quiescent_step(system, state) * (1.0 + 1e-9);
        interval.quiescent && (!quiescent || too_long())
    }

    /// The longest step of a quiescent film now, s. A scene whose CFL number is already [`MAX_CFL`] or
    /// more keeps its usual step, with contact's bound.
    fn quiescent_step(&self, system: &FilmSystem, state: &FilmState) -> f64 {
        if self.cfl >= MAX_CFL {
            return self.stable_step(system, state);
        }
        self.max_step(system, state, (STEP_RATIO * self.cfl).min(MAX_CFL), false)
    }

    /// Checks the kinetic energy now; whether the film is quiescent.
    fn update_quiescence(&mut self, system: &FilmSystem, state: &FilmState) -> bool {
        if system.contact.is_none() {
            return false;
        }
        let velocities = &self.motion.velocities;
        let nodes = system.model.mass.iter().enumerate();
        let energy: f64 =
            nodes.map(|(node, mass)| mass * velocities.get(node).norm_squared()).sum();
        let energy = 0.5 * energy;
        let (time, quiescence) = (state.time, &mut self.motion.quiescence);
        quiescence.largest_kinetic_energy = quiescence.largest_kinetic_energy.max(energy);
        // False before the first motion, when no scale of the energy is known, and for NaN.
        let slow = energy < MAX_ENERGY_FRACTION * quiescence.largest_kinetic_energy;
        if !slow {
            quiescence.last_active = time;
        }
        time - self.motion.quiescence.last_active >= QUIET_TIME && !in_contact(system, state)
    }
}

/// Whether film touches film, or a plate is present.
fn in_contact(system: &FilmSystem, state: &FilmState) -> bool {
    let Some(contact_model) = &system.contact else { return false };
    let plates = contact_model.plates.iter().any(|plate| state.time < plate.removal_time);
    plates || !state.contact.contacts.is_empty()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector2, Vector3};

    use super::*;
    use crate::collision::broad_phase::collision_mesh::CollisionMesh;
    use crate::collision::contact::{Contact, ContactModel, Pair, PairKind};
    use crate::geometry::field::Field;
    use crate::mechanics::film_model::FilmModel;
    use crate::mechanics::gas::GasState;
    use crate::platform::simd::InstructionSet;
    use crate::scene::Film;
    use crate::scene::inflow::Inflow;
    use crate::scene::plate::Plate;
    use crate::system::PressureLoad;

    /// Two triangles far apart, at rest for 50 ms after a motion.
    struct Scene {
        system: FilmSystem,
        state: FilmState,
        explicit: Explicit,
    }

    impl Scene {
        fn plan(&mut self, phase: &Phase) -> Option<StepInterval> {
            let (system, state) = (&self.system, &self.state);
            self.explicit.plan_interval(system, state, 0.06, phase, &mut Vec::new())
        }

        fn replan(&mut self) -> Option<StepInterval> {
            let (system, state) = (&self.system, &self.state);
            self.explicit.replan_interval(system, state, 0.06, &mut Vec::new())
        }

        fn is_active(&mut self, interval: &StepInterval) -> bool {
            self.explicit.activity_detected(&self.system, &self.state, interval)
        }
    }

    fn quiescent_film() -> Scene {
        let film = Film::PAPER;
        let flat = [Vector2::new(0.0, 0.0), Vector2::new(0.1, 0.0), Vector2::new(0.0, 0.1)];
        let triangles = [[0, 1, 2], [3, 4, 5]];
        let model = FilmModel::new(&film, 6, &triangles, &[flat, flat]).expect("a film");
        let at_height = |height: f64| flat.map(|x| Vector3::new(x.x, x.y, height));
        let positions = Field::of(&[at_height(0.0), at_height(0.1)].concat());
        let omega = model.largest_frequency();
        let contact_model = ContactModel::new(
            CollisionMesh::new(6, &triangles),
            1e-3,
            omega,
            0.1,
            InstructionSet::detect(),
        );
        let system = FilmSystem {
            contact: Some(contact_model),
            numerical_damping: 0.1,
            ..FilmSystem::free(model, PressureLoad::Overpressure(0.0))
        };
        let gas = GasState::default();
        let (mut state, workspace) = FilmState::start(&system, positions, Field::zeros(6), gas);
        let mut explicit = Explicit::start(&system, &state, workspace, 0.45);
        explicit.motion.quiescence.largest_kinetic_energy = 1.0;
        state.time = 0.05;
        Scene { system, state, explicit }
    }

    fn is_quiescent(mut scene: Scene, phase: &Phase) -> bool {
        let stable_step = scene.explicit.stable_step(&scene.system, &scene.state);
        let interval = scene.plan(phase).expect("an interval");
        let longer = interval.length > 1.5 * stable_step;
        assert!(longer || interval.length <= stable_step);
        assert_eq!(longer, interval.quiescent);
        interval.quiescent
    }

    fn plate(until: f64) -> Plate {
        let normal = Vector3::new(0.0, 0.0, 1.0);
        Plate { name: "base".to_owned(), point: -normal, normal, motion: None, removal_time: until }
    }

    fn contact() -> Contact {
        let pair = Pair { kind: PairKind::NodeElement, first: 0, second: 1 };
        Contact {
            pair,
            feature: 0,
            offset: 1e-3,
            stiffness: 1.0,
            gap: 1e-3,
            adhesion: 0.0,
            energy: 0.0,
        }
    }

    #[test]
    fn film_is_quiescent_after_quiet_time_without_motion_or_contact() {
        let still = Phase::default();
        assert!(is_quiescent(quiescent_film(), &still));
        let with = |change: &dyn Fn(&mut Scene)| {
            let mut film = quiescent_film();
            change(&mut film);
            is_quiescent(film, &still)
        };
        assert!(!with(&|film| film.explicit.motion.quiescence.last_active = 0.035));
        assert!(with(&|film| film.explicit.motion.quiescence.last_active = 0.025));
        assert!(!with(&|film| film.explicit.motion.quiescence.largest_kinetic_energy = 0.0));
        assert!(!with(&|film| film.explicit.motion.velocities.x[2] = f64::NAN));
        assert!(!with(&|film| film.state.contact.contacts.push(contact())));
        let plates = |film: &mut Scene, until: f64| {
            film.system.contact.iter_mut().for_each(|model| model.plates.push(plate(until)));
        };
        assert!(!with(&|film| plates(film, 0.2)));
        assert!(with(&|film| plates(film, 0.04)));
        assert!(!with(&|film| film.system.contact = None));
        let inflow = Inflow { mass_flow_rate: 1e-3, temperature_flow: 0.3, ..Inflow::default() };
        assert!(!is_quiescent(quiescent_film(), &Phase { inflow, ..still }));
        assert!(!is_quiescent(quiescent_film(), &Phase { packed: true, ..still }));
    }

    #[test]
    fn contact_ends_quiescence_at_once_and_motion_at_the_next_check() {
        let mut film = quiescent_film();
        let mut interval = film.plan(&Phase::default()).expect("an interval");
        interval.index = 3;
        assert!(!film.is_active(&interval));
        film.explicit.motion.velocities.x[0] = 100.0;
        assert!(!film.is_active(&interval));
        interval.index = CHECK_INTERVAL;
        assert!(film.is_active(&interval));
        assert!(film.replan().is_some_and(|interval| !interval.quiescent));

        let mut film = quiescent_film();
        interval.index = 3;
        film.state.contact.contacts.push(contact());
        assert!(film.is_active(&interval));
        assert_eq!(
            film.explicit.motion.quiescence.last_active.to_bits(),
            film.state.time.to_bits()
        );
        assert!(film.replan().is_some_and(|interval| !interval.quiescent));
    }
}
