//! Central differences for film and its gas.
//!
//! ```text
//! f = f_film(xⁿ, xⁿ⁻¹) + (p − p_ambient) ∂V/∂x + m g      at time n
//! v⁺ = v⁻ + h a,  h = (Δt⁻ + Δt)/2                        half-step velocities
//! x ← x + Δt v⁺;  the gas steps from V to V'              time n + 1
//!
//! Δt ≤ CFL (√(1+ζ²) − ζ) 2/√(ω_film² + ω_gas²)             film in motion; calm film: `calm`
//! kinetic energy at n: ½ Σ m v⁻·v⁺
//! ```
//!
//! Every work is the trapezoid of its own force along its own displacement, ½ (fⁿ + fⁿ⁺¹)·Δx (viscosity's
//! but for a part of the third order in Δt: [`crate::mechanics::forces::damping`]): with
//! the kinetic energy above their sum is kept exactly at an even step, so whatever the ledger
//! misses is a force that is no derivative of its energy, or a step too long for its bends. The
//! gas gives ½ (pⁿ + pⁿ⁺¹) ΔV and the same number is the film's entry.
//!
//! Between two targets all steps are equal, so a target is hit exactly and no sliver is left, but where
//! calm film (`calm`) is pressed on the way: from there they are shorter. What
//! changes is one [`State`]: a run put back on it goes on bit for bit, at any step.

use nalgebra::Vector3;

use crate::collision::contact::candidates::CandidateList;
use crate::collision::monitor::TunnellingMonitor;
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::damping::stable_share;
use crate::mechanics::forces::membrane::{
    MembraneSums, NodeForces, ViscousHistory, assemble_membrane, viscous_forces,
};
use crate::mechanics::forces::pressure::{add_closure, gas_frequency_squared};
use crate::mechanics::gas::GasState;
use crate::output::outcome::{Failure, FailureKind};
use crate::platform::fault_injection::Term;
use crate::platform::stopwatch::{Stage, Stopwatch, Untimed};
use crate::scene::inflow::Inflow;
use crate::scene::timeline::Phase;

use update::{drift_nodes, sparse_power};

mod contact_step;
mod energy_accounting;
mod kick;
mod parameters;
mod quiescence;
pub mod reference_step;
mod state;
pub mod update;

pub use parameters::{DEFAULT_CFL, Parameters, PressureLoad};
pub use quiescence::Quiescence;
pub use state::{State, StepInterval, Works};

/// Steps shorter than this over the film's largest frequency are slivers, between targets that differ by rounding.
const SLIVER: f64 = 1e-6;

/// Film in motion: constants and state.
#[derive(Debug, Clone, PartialEq)]
pub struct Explicit {
    /// The film.
    pub model: FilmModel,
    /// All else that is constant.
    pub setting: Parameters,
    /// All that changes.
    pub state: State,
    /// Forces on nodes now: a function of the state.
    pub forces: NodeForces,
    /// Who counts passages; nobody where film has no contact.
    pub watch: Option<TunnellingMonitor>,
    /// What is near: a function of the state, made when first asked for.
    search: Option<CandidateList>,
    next: Field,
}

impl Explicit {
    /// Starts at time 0 from places (m), velocities (m/s) and a gas.
    pub fn new(
        model: FilmModel,
        setting: Parameters,
        places: Field,
        velocities: Field,
        gas: GasState,
    ) -> Self {
        let planes = setting.supports.bodies.iter().map(|body| body.plane.velocity).collect();
        let state = State::start(places, velocities, Vec::new(), planes, gas);
        let mut film = Self::with(model, setting, state);
        film.bind_to_planes();
        film.state.past =
            ViscousHistory::in_motion(&film.model, &film.state.places, &film.state.velocities);
        film.initialise_contact();
        let sums = film.pass_at(0.0, 0.0, &mut Untimed);
        film.state.volume = sums.six_volumes / 6.0;
        film.state.pressure = match film.setting.interior {
            PressureLoad::Gas(gas) => {
                film.setting.fault(Term::GasPressure)
                    * gas.pressure(film.state.gas, film.state.volume)
            }
            PressureLoad::Overpressure(pressure) => pressure,
        };
        film.state.start_moment = film.first_moment().into();
        film
    }

    /// Goes on from a state of the same film under the same setting, bit for bit.
    ///
    /// # Panics
    /// On the state of another film.
    pub fn resume(model: FilmModel, setting: Parameters, state: State) -> Self {
        let mut film = Self::with(model, setting, state);
        let _ = film.pass_at(film.state.time, 0.0, &mut Untimed);
        film
    }

    fn with(model: FilmModel, setting: Parameters, state: State) -> Self {
        let forces = NodeForces::new(&model);
        let next = Field::zeros(model.nodes());
        let watch = setting.watch.zip(setting.contact.as_ref());
        let watch = watch.map(|(how, law)| {
            TunnellingMonitor::new(how, &law.mesh, &state.places, state.steps, setting.path)
        });
        Self { model, setting, state, forces, watch, search: None, next }
    }

    /// Advances to `target` (s) exactly, under a phase.
    ///
    /// # Errors
    /// [`Failure`]: `unstable`, `inverted_volume` or `step_limit`.
    pub fn advance(&mut self, target: f64, phase: &Phase) -> Result<(), Failure> {
        self.advance_at_most(target, phase, &mut u64::MAX.clone()).map(|_| ())
    }

    /// Advances towards `target` (s), under a phase, by at most `steps` steps, which it counts down;
    /// whether it got there. Pausing changes no bit of what follows.
    ///
    /// # Errors
    /// As [`Self::advance`].
    pub fn advance_at_most(
        &mut self,
        target: f64,
        phase: &Phase,
        steps: &mut u64,
    ) -> Result<bool, Failure> {
        self.advance_timed(target, phase, steps, &mut Untimed)
    }

    /// The same, telling a stopwatch what is done when.
    ///
    /// # Errors
    /// As [`Self::advance`].
    pub fn advance_timed(
        &mut self,
        target: f64,
        phase: &Phase,
        steps: &mut u64,
        stopwatch: &mut dyn Stopwatch,
    ) -> Result<bool, Failure> {
        let mut stretch = match self.state.stretch.take() {
            Some(stretch) => stretch,
            None => self.way_to(target, phase).ok_or_else(|| self.too_small())?,
        };
        while let Some(until) = stretch.next_end() {
            if *steps == 0 {
                self.state.stretch = Some(stretch);
                stopwatch.begins(Stage::Audit);
                self.monitor_interval()?;
                return Ok(false);
            }
            if self.state.steps >= self.setting.step_limit {
                let place = format!("after {} accepted steps", self.state.steps);
                return Err(self.failure(FailureKind::StepLimit, &place));
            }
            *steps -= 1;
            stretch.index += 1.0;
            if phase.packed && self.setting.contact.is_none() {
                self.wait(stretch.length, phase.inflow);
            } else {
                self.step(stretch.length, until, phase.inflow, stopwatch)?;
            }
            self.state.time = until;
            self.state.steps += 1;
            if self.stirred(&stretch) {
                let target = stretch.target;
                stretch = self.way_on_to(target).ok_or_else(|| self.too_small())?;
            }
        }
        stopwatch.begins(Stage::Audit);
        self.monitor_interval()?;
        Ok(true)
    }

    fn too_small(&self) -> Failure {
        self.failure(FailureKind::StepLimit, "step too small to advance time")
    }

    /// The longest step allowed to film in motion now, s.
    pub fn stable_step(&self) -> f64 {
        self.longest_step(self.setting.cfl, true)
    }

    /// The longest step of this share of the stable one, s, and stable where contact presses or does not.
    fn longest_step(&self, cfl: f64, pressed: bool) -> f64 {
        let film = self.model.largest_frequency();
        let gas = match self.setting.interior {
            PressureLoad::Gas(gas) => {
                let stiffness = gas.gamma() * self.state.pressure;
                let (supports, forces) = (&self.setting.supports, &self.forces);
                gas_frequency_squared(&self.model, supports, forces, stiffness, self.state.volume)
            }
            PressureLoad::Overpressure(_) => 0.0,
        };
        let share = stable_share(self.setting.viscosity) * 2.0;
        let alone = cfl * share / (film * film + gas).sqrt();
        match self.setting.contact.as_ref().filter(|_| pressed) {
            // Contact counts for stability only: what is well below its limit resolves it too.
            Some(law) => {
                alone.min(share / (film * film + gas + law.added_frequency_squared()).sqrt())
            }
            None => alone,
        }
    }

    /// A step in which nothing moves: film without contact, packed.
    fn wait(&mut self, length: f64, inflow: Inflow) {
        self.state.last_step = 0.0;
        self.step_gas(self.state.volume, length, inflow);
    }

    /// A step that ends at the time `until` (s).
    fn step(
        &mut self,
        length: f64,
        until: f64,
        inflow: Inflow,
        stopwatch: &mut dyn Stopwatch,
    ) -> Result<(), Failure> {
        stopwatch.begins(Stage::Update);
        self.kick(0.5 * (self.state.last_step + length), length, until);
        self.collision_step(0.5 * (self.state.last_step + length), length, stopwatch)?;
        stopwatch.begins(Stage::Update);
        self.share_work(length);
        let way = length * self.setting.fault(Term::Drift);
        let state = &mut self.state;
        let path = self.setting.path;
        let fastest = drift_nodes(path, &state.velocities, way, &mut state.places);
        self.add_plate_work(until);
        // Rounding of a strain over next to no time would be a rate: such a step leaves viscosity as it is.
        let sliver = length * self.model.largest_frequency() < SLIVER;
        let sums = self.pass_at(until, if sliver { 0.0 } else { length }, stopwatch);
        stopwatch.begins(Stage::Gas);
        self.add_plate_work(until);
        let volume = sums.six_volumes / 6.0;
        // No NaN passes either of these.
        let sound = fastest < self.model.wave_speed() * self.model.wave_speed();
        if !sound || !volume.is_finite() {
            return Err(self.unstable());
        }
        self.state.works.viscous += sums.viscous_work * self.setting.fault(Term::ViscousWork);
        self.state.film_stress = self.state.film_stress.max(sums.largest_stress);
        if matches!(self.setting.interior, PressureLoad::Gas(_)) && volume <= 0.0 {
            return Err(self.failure(FailureKind::InvertedVolume, "gas volume"));
        }
        self.step_gas(volume, length, inflow);
        stopwatch.begins(Stage::Update);
        self.share_work(length);
        self.state.last_step = length;
        stopwatch.begins(Stage::Audit);
        self.monitor_step()
    }

    /// Half a step's work of what acts at the nodes now along the velocities now: on moving supports,
    /// and of an overpressure on the film.
    fn share_work(&mut self, length: f64) {
        let half = 0.5 * length;
        if self.contact_active() {
            let (contact, velocities) = (&self.forces.contact, &self.state.velocities);
            self.state.works.contact += half * sparse_power(self.setting.path, contact, velocities);
        }
        self.state.works.support -= half * self.support_power();
        if let PressureLoad::Overpressure(pressure) = self.setting.interior {
            let sweep: f64 = (0..self.model.nodes())
                .map(|node| self.forces.area(node).dot(&self.state.velocities.get(node)))
                .sum();
            self.state.works.gas += half * pressure * sweep;
        }
    }

    /// The gas, while the volume goes to `volume` (m³).
    fn step_gas(&mut self, volume: f64, length: f64, inflow: Inflow) {
        let state = &mut self.state;
        if let PressureLoad::Gas(gas) = self.setting.interior {
            let mut step = gas.step(state.gas, state.volume, volume, length, inflow);
            if let Some(mutation) = self.setting.mutation {
                step.inject_fault(&gas, volume, inflow.mass_flow_rate * length, mutation);
            }
            state.gas = step.state;
            state.pressure = step.pressure;
            state.works.gas += step.work;
            state.works.ambient -= gas.ambient_pressure * (volume - state.volume);
            state.books.mass_out += step.mass_out;
            state.books.enthalpy_in += step.enthalpy_in;
            state.books.enthalpy_out += step.enthalpy_out;
            state.books.heat += step.heat;
        }
        state.volume = volume;
    }

    /// p − `p_ambient`, Pa.
    pub fn overpressure(&self) -> f64 {
        match self.setting.interior {
            PressureLoad::Gas(gas) => {
                let ambient = gas.ambient_pressure * self.setting.fault(Term::Ambient);
                self.state.pressure - ambient
            }
            PressureLoad::Overpressure(pressure) => pressure,
        }
    }

    /// Force on a node now, N.
    #[inline]
    pub fn force(&self, node: usize) -> Vector3<f64> {
        self.forces.film(node)
            + self.forces.contact.get(node)
            + self.forces.area(node) * self.overpressure()
            + self.setting.gravity * (self.model.mass[node] * self.setting.fault(Term::Gravity))
    }

    /// Forces at the places now, which are those of `time` (s), `step` (s) after they were last asked for.
    fn pass_at(&mut self, time: f64, step: f64, stopwatch: &mut dyn Stopwatch) -> MembraneSums {
        stopwatch.begins(Stage::Membrane);
        let (model, path) = (&self.model, self.setting.path);
        let State { places, past, .. } = &mut self.state;
        let mut sums = assemble_membrane(path, model, places, step, past, &mut self.forces);
        sums.six_volumes += add_closure(model, places, &mut self.forces);
        if self.setting.mutation.is_some() {
            self.suffer(&mut sums);
        }
        stopwatch.begins(Stage::Pairs);
        self.update_contact_forces(time);
        sums
    }

    /// Faults of the forces: tests only.
    fn suffer(&mut self, sums: &mut MembraneSums) {
        let [elastic, viscous, area] = [Term::Elastic, Term::Viscous, Term::PressureForce]
            .map(|term| self.setting.fault(term));
        let drags = viscous_forces(&self.model, &self.state.places, &self.state.past);
        for (node, drag) in drags.iter().enumerate() {
            let rest = self.forces.film(node) - drag;
            self.forces.set_film(node, rest * elastic + drag * viscous);
            self.forces.scale_area(node, area);
        }
        sums.six_volumes *= self.setting.fault(Term::Volume);
    }

    fn unstable(&self) -> Failure {
        let bound = self.model.wave_speed();
        let sound = |node: &usize| self.state.velocities.get(*node).norm() < bound;
        let node = (0..self.model.nodes()).find(|node| !sound(node));
        let place = match node {
            Some(node) => format!("node {node}, faster than the film's waves ({bound:.0} m/s)"),
            None => "volume not finite".to_owned(),
        };
        self.failure(FailureKind::Unstable, &place)
    }

    fn failure(&self, kind: FailureKind, place: &str) -> Failure {
        Failure { kind, time: self.state.time, place: place.to_owned() }
    }
}
