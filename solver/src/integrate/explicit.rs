//! Central differences for film and its gas.
//!
//! ```text
//! f = f_film(x, v⁻) + (p − p_ambient) ∂V/∂x + m g         at time n
//! v⁺ = v⁻ + h a,  h = (Δt⁻ + Δt)/2                        half-step velocities
//! x ← x + Δt v⁺;  the gas steps from V to V'              time n + 1
//!
//! Δt ≤ CFL (√(1+ζ²) − ζ) 2/√(ω_film² + ω_gas²)
//! kinetic energy at n: ½ Σ m v⁻·v⁺
//! ```
//!
//! Every work is the trapezoid of its own force along its own displacement, ½ (fⁿ + fⁿ⁺¹)·Δx: with
//! the kinetic energy above their sum is kept exactly at an even step, so whatever the ledger
//! misses is a force that is no derivative of its energy, or a step too long for its bends. The
//! gas gives ½ (pⁿ + pⁿ⁺¹) ΔV and the same number is the film's entry.
//!
//! Between two targets all steps are equal, so a target is hit exactly and no sliver is left.

use nalgebra::Vector3;

use crate::course::Phase;
use crate::deployment::{Failure, FailureKind};
use crate::forces::damping::{kick_factors, stable_share};
use crate::forces::membrane::{
    ElementForces, NodeForces, Sums, element_pass, node_pass, strain_energy,
};
use crate::forces::pressure::gas_frequency_squared;
use crate::gas::{Gas, GasState, Inflow};
use crate::ledger::{GasBooks, Ledger};
use crate::model::FilmModel;
use crate::state::Field;
use crate::supports::Supports;

/// CFL number to use where nobody asks for another: over the deployment of the paper's capsule
/// without contact it keeps the energy ledger well inside its bound.
pub const DEFAULT_CFL: f64 = 0.45;

/// What presses on the film from inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Interior {
    /// Gas in the closed volume.
    Gas(Gas),
    /// This overpressure, Pa, whatever the volume; film may be open.
    Overpressure(f64),
}

/// What is constant during a run, beside the film itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// What presses from inside.
    pub interior: Interior,
    /// What is held.
    pub supports: Supports,
    /// Acceleration along z, m/s².
    pub gravity: f64,
    /// ζ of the film's viscosity, for the stable step.
    pub viscosity: f64,
    /// c, 1/s: nought but in statics.
    pub mass_damping: f64,
    /// Share of the stable step.
    pub cfl: f64,
    /// Accepted steps after which a run stops.
    pub step_limit: u64,
}

/// Works so far, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Works {
    gas: f64,
    ambient: f64,
    support: f64,
    viscous: f64,
    damping: f64,
}

/// Film in motion: constants and state.
#[derive(Debug, Clone, PartialEq)]
pub struct Explicit {
    /// The film.
    pub model: FilmModel,
    /// All else that is constant.
    pub setting: Setting,
    /// Time, s.
    pub time: f64,
    /// Node places, m.
    pub places: Field,
    /// Node velocities half a step ago, m/s; those of the start before the first step.
    pub velocities: Field,
    /// Length of the last step, s; 0 before the first.
    pub last_step: f64,
    /// V, m³.
    pub volume: f64,
    /// p inside (gas) or overpressure, Pa.
    pub pressure: f64,
    /// Gas inside.
    pub gas: GasState,
    /// Accepted steps.
    pub steps: u64,
    /// Largest principal second Piola-Kirchhoff stress so far, Pa.
    pub film_stress: f64,
    /// Forces on nodes now.
    pub forces: NodeForces,
    elements: ElementForces,
    works: Works,
    books: GasBooks,
    start_moment: f64,
}

impl Explicit {
    /// Starts at time 0 from places (m), velocities (m/s) and a gas.
    pub fn new(
        model: FilmModel,
        setting: Setting,
        places: Field,
        velocities: Field,
        gas: GasState,
    ) -> Self {
        let (elements, forces) = (ElementForces::new(&model), NodeForces::new(&model));
        let mut film = Self {
            model,
            setting,
            time: 0.0,
            places,
            velocities,
            last_step: 0.0,
            volume: 0.0,
            pressure: 0.0,
            gas,
            steps: 0,
            film_stress: 0.0,
            forces,
            elements,
            works: Works::default(),
            books: GasBooks::default(),
            start_moment: 0.0,
        };
        let sums = film.pass();
        film.volume = sums.six_volumes / 6.0;
        film.pressure = match film.setting.interior {
            Interior::Gas(gas) => gas.pressure(film.gas, film.volume),
            Interior::Overpressure(pressure) => pressure,
        };
        film.start_moment = film.first_moment();
        film
    }

    /// Advances to `target` (s) exactly, under a phase.
    ///
    /// # Errors
    /// [`Failure`]: `unstable`, `inverted_volume` or `step_limit`.
    pub fn advance(&mut self, target: f64, phase: &Phase) -> Result<(), Failure> {
        let start = self.time;
        let count = ((target - start) / self.stable_step() * (1.0 - 1e-12)).ceil().max(1.0);
        let length = (target - start) / count;
        if start + length <= start {
            return Err(self.failure(FailureKind::StepLimit, "step too small to advance time"));
        }
        let mut index = 0.0;
        while index < count {
            if self.steps >= self.setting.step_limit {
                let place = format!("after {} accepted steps", self.steps);
                return Err(self.failure(FailureKind::StepLimit, &place));
            }
            index += 1.0;
            let until = if index < count { start + index * length } else { target };
            if phase.packed {
                self.wait(length, phase.inflow);
            } else {
                self.step(length, phase.inflow)?;
            }
            self.time = until;
            self.steps += 1;
        }
        Ok(())
    }

    /// The longest step allowed now, s.
    pub fn stable_step(&self) -> f64 {
        let film = self.model.largest_frequency();
        let gas = match self.setting.interior {
            Interior::Gas(gas) => {
                let stiffness = gas.gamma() * self.pressure;
                gas_frequency_squared(&self.model, &self.forces.area, stiffness, self.volume)
            }
            Interior::Overpressure(_) => 0.0,
        };
        let share = self.setting.cfl * stable_share(self.setting.viscosity);
        share * 2.0 / (film * film + gas).sqrt()
    }

    /// A step in which nothing moves.
    fn wait(&mut self, length: f64, inflow: Inflow) {
        self.last_step = 0.0;
        self.step_gas(self.volume, length, inflow);
    }

    fn step(&mut self, length: f64, inflow: Inflow) -> Result<(), Failure> {
        self.kick(0.5 * (self.last_step + length), length);
        let fastest = self.drift(length);
        let sums = self.pass();
        let volume = sums.six_volumes / 6.0;
        // No NaN passes either of these.
        let sound = fastest < self.model.wave_speed() * self.model.wave_speed();
        if !sound || !volume.is_finite() {
            return Err(self.unstable());
        }
        self.works.viscous += 0.5 * length * sums.viscous_power;
        self.works.support -= 0.5 * length * self.support_power();
        self.film_stress = self.film_stress.max(sums.largest_stress);
        if matches!(self.setting.interior, Interior::Gas(_)) && volume <= 0.0 {
            return Err(self.failure(FailureKind::InvertedVolume, "gas volume"));
        }
        self.step_gas(volume, length, inflow);
        self.last_step = length;
        Ok(())
    }

    /// The gas, while the volume goes to `volume` (m³).
    fn step_gas(&mut self, volume: f64, length: f64, inflow: Inflow) {
        match self.setting.interior {
            Interior::Gas(gas) => {
                let step = gas.step(self.gas, self.volume, volume, length, inflow);
                self.gas = step.state;
                self.pressure = step.pressure;
                self.works.gas += step.work;
                self.works.ambient -= gas.ambient_pressure * (volume - self.volume);
                self.books.mass_out += step.mass_out;
                self.books.enthalpy_in += step.enthalpy_in;
                self.books.enthalpy_out += step.enthalpy_out;
                self.books.heat += step.heat;
            }
            Interior::Overpressure(pressure) => {
                self.works.gas += pressure * (volume - self.volume);
            }
        }
        self.volume = volume;
    }

    /// p − `p_ambient`, Pa.
    pub fn overpressure(&self) -> f64 {
        match self.setting.interior {
            Interior::Gas(gas) => self.pressure - gas.ambient_pressure,
            Interior::Overpressure(pressure) => pressure,
        }
    }

    /// Force on a node now, N.
    #[inline]
    pub fn force(&self, node: usize) -> Vector3<f64> {
        let weight = self.model.mass[node] * self.setting.gravity;
        self.forces.film.get(node)
            + self.forces.area.get(node) * self.overpressure()
            + Vector3::new(0.0, 0.0, weight)
    }

    /// The velocity (m/s) a node gets from its force in a kick.
    #[inline]
    fn kicked(&self, node: usize, (keep, gain): (f64, f64)) -> Vector3<f64> {
        let velocity = self.velocities.get(node);
        let change = velocity * (keep - 1.0) + self.force(node) * (gain / self.model.mass[node]);
        velocity + change.component_mul(&self.setting.supports.free(node))
    }

    fn kick(&mut self, kick: f64, length: f64) {
        let factors = kick_factors(self.setting.mass_damping, kick);
        let mut damped = 0.0;
        for node in 0..self.model.nodes() {
            let velocity = self.kicked(node, factors);
            if self.setting.mass_damping > 0.0 {
                let mean = (velocity + self.velocities.get(node)) * 0.5;
                let free = mean.component_mul(&self.setting.supports.free(node));
                damped += self.model.mass[node] * free.norm_squared();
            }
            self.velocities.set(node, velocity);
        }
        self.works.damping += self.setting.mass_damping * kick * damped;
        self.works.support -= 0.5 * length * self.support_power();
    }

    /// Moves the nodes; gives the largest squared speed.
    fn drift(&mut self, length: f64) -> f64 {
        let (mut fastest, mut taken) = (0.0_f64, 0.0);
        for node in 0..self.model.nodes() {
            let velocity = self.velocities.get(node);
            self.places.set(node, self.places.get(node) + velocity * length);
            taken -= self.forces.viscous.get(node).dot(&velocity);
            let squared = velocity.norm_squared();
            // `max` would let a NaN pass.
            fastest = if squared <= fastest { fastest } else { squared };
        }
        self.works.viscous += 0.5 * length * taken;
        fastest
    }

    /// Element and node passes at the places now.
    fn pass(&mut self) -> Sums {
        let sums = element_pass(&self.model, &self.places, &self.velocities, &mut self.elements);
        node_pass(&self.model, &self.elements, &mut self.forces);
        sums
    }

    /// Power of the film's own forces on what holds it and moves, W.
    fn support_power(&self) -> f64 {
        let one = Vector3::new(1.0, 1.0, 1.0);
        let moving = self.setting.supports.moving.iter().map(|node| *node as usize);
        moving
            .map(|node| {
                let held = one - self.setting.supports.free(node);
                self.force(node).dot(&self.velocities.get(node).component_mul(&held))
            })
            .sum()
    }

    /// Sets the velocity (m/s) of held nodes; their supports do the work of setting it.
    pub fn move_held(&mut self, nodes: &[u32], velocity: impl Fn(u32) -> Vector3<f64>) {
        for node in nodes {
            let index = *node as usize;
            let free = self.setting.supports.free(index);
            let old = self.velocities.get(index);
            let held = Vector3::new(1.0, 1.0, 1.0) - free;
            let new = old.component_mul(&free) + velocity(*node).component_mul(&held);
            self.works.support +=
                0.5 * self.model.mass[index] * (new.norm_squared() - old.norm_squared());
            self.velocities.set(index, new);
        }
        self.setting.supports.moving = nodes.to_vec();
    }

    /// Velocity of a node now, m/s.
    pub fn velocity(&self, node: usize) -> Vector3<f64> {
        self.kicked(node, kick_factors(self.setting.mass_damping, 0.5 * self.last_step))
    }

    /// Kinetic energy, J: ½ Σ m v⁻·v⁺, the form leapfrog keeps.
    pub fn kinetic_energy(&self) -> f64 {
        let factors = kick_factors(self.setting.mass_damping, self.last_step);
        let double = |node: usize| {
            self.model.mass[node] * self.velocities.get(node).dot(&self.kicked(node, factors))
        };
        0.5 * (0..self.model.nodes()).map(double).sum::<f64>()
    }

    /// Elastic energy, J.
    pub fn strain_energy(&self) -> f64 {
        strain_energy(&self.model, &self.places)
    }

    /// The film's side of the ledger.
    pub fn ledger(&self) -> Ledger {
        Ledger {
            kinetic: self.kinetic_energy(),
            strain: self.strain_energy(),
            gas_work: self.works.gas,
            ambient_work: self.works.ambient,
            gravity_work: self.setting.gravity * (self.first_moment() - self.start_moment),
            support_work: self.works.support,
            viscous_work: self.works.viscous,
            damping_work: self.works.damping,
            // No contact yet.
            contact: 0.0,
            friction_work: 0.0,
        }
    }

    /// The gas's side of the ledger; the mass let in is the loop's.
    pub fn books(&self) -> GasBooks {
        GasBooks {
            mass: self.gas.mass,
            internal_energy: self.gas.internal_energy,
            gas_work: self.works.gas,
            ..self.books
        }
    }

    /// Σ m z, kg m.
    fn first_moment(&self) -> f64 {
        self.model.mass.iter().zip(&self.places.z).map(|(mass, z)| mass * z).sum()
    }

    fn unstable(&self) -> Failure {
        let bound = self.model.wave_speed();
        let sound = |node: &usize| self.velocities.get(*node).norm() < bound;
        let node = (0..self.model.nodes()).find(|node| !sound(node));
        let place = match node {
            Some(node) => format!("node {node}, faster than the film's waves ({bound:.0} m/s)"),
            None => "volume not finite".to_owned(),
        };
        self.failure(FailureKind::Unstable, &place)
    }

    fn failure(&self, kind: FailureKind, place: &str) -> Failure {
        Failure { kind, time: self.time, place: place.to_owned() }
    }
}
