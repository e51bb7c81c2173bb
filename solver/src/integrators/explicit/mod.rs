//! Central differences for film and its gas.
//!
//! ```text
//! f = f_film + f_contact + (p − p_ambient) ∂V/∂x + m g      at time n
//! v⁺ = v⁻ + h a,  h = (Δt⁻ + Δt)/2                        half-step velocities
//! x ← x + Δt v⁺;  the gas steps from V to V'              time n + 1
//!
//! Δt ≤ CFL (√(1+ζ²) − ζ) 2/√(ω_film² + ω_gas²)             stable step; quiescent film: `quiescence`
//! kinetic energy at n: ½ Σ m v⁻·v⁺
//! ```
//!
//! Each work is the trapezoid rule of its own force along its own displacement, ½ (fⁿ + fⁿ⁺¹)·Δx; the
//! work of numerical damping agrees with that up to third order in Δt
//! ([`crate::mechanics::forces::damping`]). With equal steps these works and the kinetic energy above
//! add up exactly. So a ledger residual has one of two causes: a force that is not the derivative of its
//! energy, or a step that turns an element too far. The gas does the work ½ (pⁿ + pⁿ⁺¹) ΔV, and the
//! ledger of the film takes the same number.
//!
//! Between two targets all steps are equal, so a run reaches every target exactly and without a tiny
//! last step. One exception: contact with a quiescent film shortens the steps from there on.
//! Everything that changes is one [`State`]: a run resumed from it continues with the same bits, from
//! any step.

use nalgebra::Vector3;

use crate::collision::contact::candidates::CandidateList;
use crate::collision::monitor::TunnellingMonitor;
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::damping::stable_share;
use crate::mechanics::forces::membrane::{
    ElementHistory, MembraneSums, NodeForces, assemble_membrane, numerical_forces,
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
mod stability;
mod state;
pub mod update;

pub use parameters::{DEFAULT_CFL, Parameters, PressureLoad};
pub use quiescence::Quiescence;
pub use state::{State, StepInterval, Works};

/// Upper bound of step × largest film frequency for a step that leaves creep and damping unchanged. Such
/// steps lie between targets that differ by rounding. Chosen: far below any step of a run (about 1).
const MAX_TINY_STEP: f64 = 1e-6;

/// Film in motion: film model, parameters and state.
#[derive(Debug, Clone, PartialEq)]
pub struct Explicit {
    /// Film model: constant.
    pub model: FilmModel,
    /// Everything else that is constant.
    pub parameters: Parameters,
    /// Everything that changes.
    pub state: State,
    /// Forces on the nodes now: a function of the state.
    pub forces: NodeForces,
    /// Tunnelling monitor: counts passages of film through film. `None` without contact.
    pub monitor: Option<TunnellingMonitor>,
    /// Largest principal stress now, Pa: a function of the state.
    largest_stress: f64,
    /// Candidate pairs of contact: a function of the state, built at first use.
    candidates: Option<CandidateList>,
    /// Scratch: the velocities after a kick.
    next: Field,
}

impl Explicit {
    /// Film at time 0 with these positions (m), velocities (m/s) and gas.
    pub fn new(
        model: FilmModel,
        parameters: Parameters,
        positions: Field,
        velocities: Field,
        gas: GasState,
    ) -> Self {
        let planes = parameters.supports.bodies.iter().map(|body| body.plane.velocity).collect();
        let state = State::start(positions, velocities, Vec::new(), planes, gas);
        let mut film = Self::with(model, parameters, state);
        film.bind_to_planes();
        film.state.element_history = ElementHistory::at_rest(&film.model, &film.state.positions);
        film.initialise_contact();
        let sums = film.assemble_forces(0.0, 0.0, &mut Untimed);
        film.state.volume = sums.six_volumes / 6.0;
        film.state.pressure = match film.parameters.pressure_load {
            PressureLoad::Gas(gas) => {
                film.parameters.fault_factor(Term::GasPressure)
                    * gas.pressure(film.state.gas, film.state.volume)
            }
            PressureLoad::Overpressure(pressure) => pressure,
        };
        film.state.start_moment = film.first_moment().into();
        film.state.start_energy = film.ledger().stored();
        film
    }

    /// Resumes from a state of the same film under the same parameters. The run continues with the same
    /// bits.
    ///
    /// # Panics
    /// If the state is that of another film.
    pub fn resume(model: FilmModel, parameters: Parameters, state: State) -> Self {
        let mut film = Self::with(model, parameters, state);
        let _ = film.assemble_forces(film.state.time, 0.0, &mut Untimed);
        film
    }

    fn with(model: FilmModel, parameters: Parameters, state: State) -> Self {
        let forces = NodeForces::new(&model);
        let next = Field::zeros(model.nodes());
        let monitor = parameters.monitor.zip(parameters.contact.as_ref());
        let monitor = monitor.map(|(settings, contact_model)| {
            let (mesh, positions) = (&contact_model.mesh, &state.positions);
            let instruction_set = parameters.instruction_set;
            TunnellingMonitor::new(settings, mesh, positions, state.steps, instruction_set)
        });
        Self {
            model,
            parameters,
            state,
            forces,
            monitor,
            largest_stress: 0.0,
            candidates: None,
            next,
        }
    }

    /// Advances to exactly `target` (s) under a phase.
    ///
    /// # Errors
    /// [`Failure`]: `unstable`, `overstretched`, `inverted_volume`, `step_limit` or `interpenetrated`.
    pub fn advance(&mut self, target: f64, phase: &Phase) -> Result<(), Failure> {
        self.advance_at_most(target, phase, &mut u64::MAX.clone()).map(|_| ())
    }

    /// Advances towards `target` (s) under a phase by at most `steps` steps, and subtracts the steps taken
    /// from `steps`. Returns whether it reached the target. A pause changes no bit of the run: the monitor
    /// tests its block when it is complete.
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

    /// [`Self::advance_at_most`] with a stopwatch that learns when each stage begins.
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
        let mut interval = match self.state.step_interval.take() {
            Some(interval) => interval,
            None => self.plan_interval(target, phase).ok_or_else(|| self.no_advance())?,
        };
        while let Some(end) = interval.next_end() {
            if *steps == 0 {
                self.state.step_interval = Some(interval);
                return Ok(false);
            }
            if self.state.steps >= self.parameters.step_limit {
                let place = format!("after {} accepted steps", self.state.steps);
                return Err(self.failure(FailureKind::StepLimit, &place));
            }
            *steps -= 1;
            interval.index += 1;
            if phase.packed && self.parameters.contact.is_none() {
                self.wait(interval.length, phase.inflow);
            } else {
                self.step(interval.length, end, phase.inflow, stopwatch)?;
            }
            self.state.time = end;
            self.state.steps += 1;
            if self.activity_detected(&interval) || self.step_too_long(&interval) {
                let target = interval.target;
                interval = self.replan_interval(target).ok_or_else(|| self.no_advance())?;
            }
        }
        stopwatch.begins(Stage::Audit);
        self.monitor_interval()?;
        Ok(true)
    }

    /// Whether a run that is resumed from the state now reports a passage of film at the same step as this
    /// one: the tunnelling monitor has tested every step so far.
    pub fn is_monitored(&self) -> bool {
        self.monitor.as_ref().is_none_or(TunnellingMonitor::is_block_start)
    }

    fn no_advance(&self) -> Failure {
        self.failure(FailureKind::StepLimit, "the step is too small to advance time")
    }

    /// The longest step of film in motion now, s: CFL number times stable step.
    pub fn stable_step(&self) -> f64 {
        self.max_step(self.parameters.cfl, true)
    }

    /// The longest step at this CFL number now, s; with `contact_active` also stable under contact forces.
    fn max_step(&self, cfl: f64, contact_active: bool) -> f64 {
        let film = self.model.largest_frequency();
        let gas = match self.parameters.pressure_load {
            PressureLoad::Gas(gas) => {
                let stiffness = gas.gamma() * self.state.pressure;
                let (supports, forces) = (&self.parameters.supports, &self.forces);
                gas_frequency_squared(&self.model, supports, forces, stiffness, self.state.volume)
            }
            PressureLoad::Overpressure(_) => 0.0,
        };
        let factor = stable_share(self.parameters.numerical_damping) * 2.0;
        let max_step = cfl * factor / (self.stretched_squared() + gas).sqrt();
        match self.parameters.contact.as_ref().filter(|_| contact_active) {
            // Contact bounds stability only: the CFL number already keeps the step well below it.
            Some(contact_model) => {
                let contact = contact_model.added_frequency_squared();
                max_step.min(factor / (film * film + gas + contact).sqrt())
            }
            None => max_step,
        }
    }

    /// A step in which no node moves: packed film without contact.
    fn wait(&mut self, length: f64, inflow: Inflow) {
        self.state.last_step = 0.0;
        self.step_gas(self.state.volume, length, inflow);
    }

    /// A step of `length` (s) that ends at the time `end` (s).
    fn step(
        &mut self,
        length: f64,
        end: f64,
        inflow: Inflow,
        stopwatch: &mut dyn Stopwatch,
    ) -> Result<(), Failure> {
        stopwatch.begins(Stage::Update);
        self.kick(0.5 * (self.state.last_step + length), length, end);
        self.collision_step(0.5 * (self.state.last_step + length), length, stopwatch)?;
        stopwatch.begins(Stage::Update);
        self.half_step_works(length);
        let drift = length * self.parameters.fault_factor(Term::Drift);
        let state = &mut self.state;
        let instruction_set = self.parameters.instruction_set;
        let max_speed_squared =
            drift_nodes(instruction_set, &state.velocities, drift, &mut state.positions);
        self.add_plate_work(end);
        // In a tiny step the rounding of a stress would count as a stress rate.
        let tiny = length * self.model.largest_frequency() < MAX_TINY_STEP;
        let sums = self.assemble_forces(end, if tiny { 0.0 } else { length }, stopwatch);
        stopwatch.begins(Stage::Gas);
        self.add_plate_work(end);
        let volume = sums.six_volumes / 6.0;
        let max_speed = max_speed_squared.sqrt();
        self.check_finite(max_speed * drift, volume)?;
        let works = &mut self.state.works;
        works.numerical_dissipation +=
            sums.numerical_dissipation * self.parameters.fault_factor(Term::NumericalWork);
        works.material_loss += sums.material_loss;
        self.state.film_stress = self.state.film_stress.max(sums.largest_stress);
        if matches!(self.parameters.pressure_load, PressureLoad::Gas(_)) && volume <= 0.0 {
            return Err(self.inverted_volume());
        }
        self.step_gas(volume, length, inflow);
        stopwatch.begins(Stage::Update);
        self.half_step_works(length);
        self.state.last_step = length;
        stopwatch.begins(Stage::Audit);
        self.check_source(max_speed)?;
        self.check_stretch()?;
        self.monitor_step()
    }

    /// Adds half a step's work of the forces now along the velocities now: of contact, of moving supports,
    /// and of a fixed overpressure. Called before and after the drift, so each work is a trapezoid.
    fn half_step_works(&mut self, length: f64) {
        let half = 0.5 * length;
        if self.contact_active() {
            let (contact, velocities) = (&self.forces.contact, &self.state.velocities);
            self.state.works.contact +=
                half * sparse_power(self.parameters.instruction_set, contact, velocities);
        }
        self.state.works.support -= half * self.support_power();
        if let PressureLoad::Overpressure(pressure) = self.parameters.pressure_load {
            let volume_rate: f64 = (0..self.model.nodes())
                .map(|node| self.forces.area(node).dot(&self.state.velocities.get(node)))
                .sum();
            self.state.works.gas += half * pressure * volume_rate;
        }
    }

    /// Advances the gas by `length` (s) while the volume changes to `volume` (m³).
    fn step_gas(&mut self, volume: f64, length: f64, inflow: Inflow) {
        let state = &mut self.state;
        if let PressureLoad::Gas(gas) = self.parameters.pressure_load {
            let mut step = gas.step(state.gas, state.volume, volume, length, inflow);
            if let Some(fault) = self.parameters.fault {
                step.inject_fault(&gas, volume, inflow.mass_flow_rate * length, fault);
            }
            state.gas = step.state;
            state.pressure = step.pressure;
            state.works.gas += step.work;
            state.works.ambient -= gas.ambient_pressure * (volume - state.volume);
            state.gas_balance.mass_out += step.mass_out;
            state.gas_balance.enthalpy_in += step.enthalpy_in;
            state.gas_balance.enthalpy_out += step.enthalpy_out;
            state.gas_balance.heat += step.heat;
        }
        state.volume = volume;
    }

    /// Overpressure p − `p_ambient`, Pa.
    pub fn overpressure(&self) -> f64 {
        match self.parameters.pressure_load {
            PressureLoad::Gas(gas) => {
                let ambient = gas.ambient_pressure * self.parameters.fault_factor(Term::Ambient);
                self.state.pressure - ambient
            }
            PressureLoad::Overpressure(pressure) => pressure,
        }
    }

    /// Sum of all forces on a node now, N.
    #[inline]
    pub fn force(&self, node: usize) -> Vector3<f64> {
        self.forces.film(node)
            + self.forces.contact.get(node)
            + self.forces.area(node) * self.overpressure()
            + self.parameters.gravity
                * (self.model.mass[node] * self.parameters.fault_factor(Term::Gravity))
    }

    /// Computes all forces at the positions now. `time` (s) is the time of these positions, `step` (s) the
    /// time since the last call; 0 leaves creep and numerical stress unchanged.
    fn assemble_forces(
        &mut self,
        time: f64,
        step: f64,
        stopwatch: &mut dyn Stopwatch,
    ) -> MembraneSums {
        stopwatch.begins(Stage::Membrane);
        let (model, instruction_set) = (&self.model, self.parameters.instruction_set);
        let State { positions, element_history, .. } = &mut self.state;
        model.closure_nodes.place(positions);
        let mut sums = assemble_membrane(
            instruction_set,
            model,
            positions,
            step,
            element_history,
            &mut self.forces,
        );
        self.largest_stress = sums.largest_stress;
        sums.six_volumes += add_closure(model, positions, &mut self.forces);
        if self.parameters.fault.is_some() {
            self.inject_fault(&mut sums);
        }
        stopwatch.begins(Stage::Pairs);
        self.update_contact_forces(time);
        sums
    }

    /// Applies a deliberate fault to the forces: tests only.
    fn inject_fault(&mut self, sums: &mut MembraneSums) {
        let [elastic, numerical, area] =
            [Term::Elastic, Term::NumericalStress, Term::PressureForce]
                .map(|term| self.parameters.fault_factor(term));
        let damping =
            numerical_forces(&self.model, &self.state.positions, &self.state.element_history);
        for (node, damping) in damping.iter().enumerate() {
            let elastic_force = self.forces.film(node) - damping;
            self.forces.set_film(node, elastic_force * elastic + damping * numerical);
            self.forces.scale_area(node, area);
        }
        sums.six_volumes *= self.parameters.fault_factor(Term::Volume);
    }

    fn failure(&self, kind: FailureKind, place: &str) -> Failure {
        Failure { kind, time: self.state.time, place: place.to_owned() }
    }
}
