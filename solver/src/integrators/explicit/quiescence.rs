//! When film is calm, and takes longer steps.
//!
//! ```text
//! calm: for 20 ms ½ Σ m v⁻·v⁻ has been below 5 % of its largest, no film has pressed on film, and no phase begun
//! Δt ≤ min(16/9 CFL, 0.8) (√(1+ζ²) − ζ) 2/√(ω_film² + ω_gas²)
//! ```
//!
//! What central differences miss of the energy they miss where stiffness bends: where film gets taut or
//! slack at speed, or meets film. A capsule that stands and fills does neither, and stability alone bounds
//! its step. Only film with contact is ever calm: there somebody tells when film meets film, and contact's
//! own bound holds from that step on. Film without contact is looked at for its vibrations, which are at rest
//! twice a period.
//!
//! It is looked at where a way begins and every 250 steps of it, so not only where samples are taken.

use serde::{Deserialize, Serialize};

use super::{Explicit, StepInterval};
use crate::scene::timeline::Phase;

/// Kinetic energy of calm film at most, of its largest.
const SHARE: f64 = 0.05;
/// For how long, s: longer than a capsule that turns round stays slow.
const AWHILE: f64 = 0.02;
/// Steps of calm film over those of film in motion.
const LONGER: f64 = 16.0 / 9.0;
/// Share of the stable step it takes at most.
const MOST: f64 = 0.8;
/// Steps after which film is looked at again.
const BETWEEN_LOOKS: f64 = 250.0;

/// What tells whether film is calm.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quiescence {
    /// Largest ½ Σ m v⁻·v⁻ seen, J.
    pub largest_kinetic_energy: f64,
    /// When film was last seen to move, film to press on film, or a phase to begin, s.
    pub lively: f64,
    /// Whether film was packed on the last way.
    packed: bool,
    /// Gas let in on the last way, kg/s.
    mass_flow_rate: f64,
}

impl Explicit {
    /// The way to a target (s) from here under a phase, in steps as long as they may be; `None` where a
    /// step would not advance time.
    pub(super) fn way_to(&mut self, target: f64, phase: &Phase) -> Option<StepInterval> {
        let (time, calm) = (self.state.time, &mut self.state.calm);
        let rate = phase.inflow.mass_flow_rate;
        if calm.packed != phase.packed || calm.mass_flow_rate.to_bits() != rate.to_bits() {
            (calm.packed, calm.mass_flow_rate, calm.lively) = (phase.packed, rate, time);
        }
        self.way_on_to(target)
    }

    /// The same on the way.
    pub(super) fn way_on_to(&mut self, target: f64) -> Option<StepInterval> {
        let calm = self.look_whether_calm();
        let longest = if calm { self.calm_step() } else { self.stable_step() };
        StepInterval::new(self.state.time, target, longest, calm)
    }

    /// Whether film that was calm on its way no longer is, or its steps are too long by now, so that it
    /// needs another way; asked after every step.
    pub(super) fn stirred(&mut self, stretch: &StepInterval) -> bool {
        if self.in_contact() {
            self.state.calm.lively = self.state.time;
            return stretch.calm;
        }
        if stretch.index % BETWEEN_LOOKS >= 0.5 {
            return false;
        }
        let calm = self.look_whether_calm();
        stretch.calm && (!calm || stretch.length > self.calm_step() * (1.0 + 1e-9))
    }

    /// The longest step of calm film now, s. Who asks for longer ones than 0.8 has them in motion too, with
    /// contact's own bound.
    fn calm_step(&self) -> f64 {
        if self.setting.cfl >= MOST {
            return self.stable_step();
        }
        self.longest_step((LONGER * self.setting.cfl).min(MOST), false)
    }

    /// Whether film presses on film, or a plate is there to.
    fn in_contact(&self) -> bool {
        let Some(law) = &self.setting.contact else { return false };
        let plates = law.plates.iter().any(|plate| self.state.time < plate.removal_time);
        plates || !self.state.meeting.contacts.is_empty()
    }

    fn look_whether_calm(&mut self) -> bool {
        if self.setting.contact.is_none() {
            return false;
        }
        let velocities = &self.state.velocities;
        let nodes = self.model.mass.iter().enumerate();
        let energy: f64 =
            nodes.map(|(node, mass)| mass * velocities.get(node).norm_squared()).sum();
        let energy = 0.5 * energy;
        let (time, calm) = (self.state.time, &mut self.state.calm);
        calm.largest_kinetic_energy = calm.largest_kinetic_energy.max(energy);
        // Film that has not moved yet is not calm: nobody knows how fast it will be. Nor is what is no number.
        let slow = energy < SHARE * calm.largest_kinetic_energy;
        if !slow {
            calm.lively = time;
        }
        time - self.state.calm.lively >= AWHILE && !self.in_contact()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector2, Vector3};

    use super::*;
    use crate::collision::broad_phase::collision_mesh::CollisionMesh;
    use crate::collision::contact::{Contact, ContactModel, Pair, PairKind};
    use crate::geometry::field::Field;
    use crate::integrators::explicit::{Parameters, PressureLoad};
    use crate::mechanics::film_model::FilmModel;
    use crate::mechanics::gas::GasState;
    use crate::platform::simd::InstructionSet;
    use crate::scene::Film;
    use crate::scene::inflow::Inflow;
    use crate::scene::plate::Plate;

    /// Two triangles far apart, at rest for 50 ms after they moved.
    fn calm() -> Explicit {
        let film = Film::PAPER;
        let flat = [Vector2::new(0.0, 0.0), Vector2::new(0.1, 0.0), Vector2::new(0.0, 0.1)];
        let triangles = [[0, 1, 2], [3, 4, 5]];
        let model = FilmModel::new(&film, 6, &triangles, &[flat, flat]).expect("a film");
        let place = |height: f64| flat.map(|x| Vector3::new(x.x, x.y, height));
        let places = Field::of(&[place(0.0), place(0.1)].concat());
        let omega = model.largest_frequency();
        let mesh = CollisionMesh::new(6, &triangles);
        let law = ContactModel::new(mesh, 1e-3, omega, 0.1, InstructionSet::detect());
        let setting = Parameters {
            contact: Some(law),
            viscosity: 0.1,
            ..Parameters::free(PressureLoad::Overpressure(0.0), 6)
        };
        let still = Field::zeros(6);
        let mut film = Explicit::new(model, setting, places, still, GasState::default());
        film.state.calm.largest_kinetic_energy = 1.0;
        film.state.time = 0.05;
        film
    }

    fn is_calm(mut film: Explicit, phase: &Phase) -> bool {
        let careful = film.stable_step();
        let way = film.way_to(0.06, phase).expect("a way");
        let longer = way.length > 1.5 * careful;
        assert!(longer || way.length <= careful);
        assert_eq!(longer, way.calm);
        way.calm
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
    fn film_is_calm_that_is_slow_for_a_while_and_alone() {
        let still = Phase::default();
        assert!(is_calm(calm(), &still));
        let with = |change: &dyn Fn(&mut Explicit)| {
            let mut film = calm();
            change(&mut film);
            is_calm(film, &still)
        };
        assert!(!with(&|film| film.state.calm.lively = 0.035));
        assert!(with(&|film| film.state.calm.lively = 0.025));
        assert!(!with(&|film| film.state.calm.largest_kinetic_energy = 0.0));
        assert!(!with(&|film| film.state.velocities.x[2] = f64::NAN));
        assert!(!with(&|film| film.state.meeting.contacts.push(contact())));
        let plates = |film: &mut Explicit, until: f64| {
            film.setting.contact.iter_mut().for_each(|law| law.plates.push(plate(until)));
        };
        assert!(!with(&|film| plates(film, 0.2)));
        assert!(with(&|film| plates(film, 0.04)));
        assert!(!with(&|film| film.setting.contact = None));
        let inflow = Inflow { mass_flow_rate: 1e-3, temperature_flow: 0.3 };
        assert!(!is_calm(calm(), &Phase { packed: false, inflow }));
        assert!(!is_calm(calm(), &Phase { packed: true, ..still }));
    }

    #[test]
    fn contact_stirs_calm_film_at_once_and_motion_at_the_next_look() {
        let mut film = calm();
        let mut way = film.way_to(0.06, &Phase::default()).expect("a way");
        way.index = 3.0;
        assert!(!film.stirred(&way));
        film.state.velocities.x[0] = 100.0;
        assert!(!film.stirred(&way));
        way.index = 250.0;
        assert!(film.stirred(&way));
        assert!(film.way_on_to(0.06).is_some_and(|way| !way.calm));

        let mut film = calm();
        way.index = 3.0;
        film.state.meeting.contacts.push(contact());
        assert!(film.stirred(&way));
        assert_eq!(film.state.calm.lively.to_bits(), film.state.time.to_bits());
        assert!(film.way_on_to(0.06).is_some_and(|way| !way.calm));
    }
}
