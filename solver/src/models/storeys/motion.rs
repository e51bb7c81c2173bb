//! The motion of the strips: state, steps, energy ledger, samples.
//!
//! ```text
//! v⁺ = v⁻ + h (f/m + g)        x ← x + Δt v⁺        h = (Δt⁻ + Δt)/2        the gas steps from V to V'
//! Δt = CFL · 2/√(ω_film² + ω_gas²)                  ω_gas² = γ p/V Σ |∂V/∂x|²/m
//! ```
//!
//! Central differences, as the film's. While packed, the strips stand still and only the gas steps.

use nalgebra::Vector3;

use super::STRIPS;
use super::kernel::{ElementState, ForceStep, Kick, Nodes, StepSums, advance, set_forces, volume};
use super::rest::static_shape;
use super::strip::Strip;
use crate::geometry::field::Field;
use crate::geometry::fold::FoldPattern;
use crate::mechanics::gas::{Gas, GasState};
use crate::models::run::Model;
use crate::output::history::Sample;
use crate::output::ledger::{GasBalance, Ledger};
use crate::output::measures::{NoReference, Reference, StaticShape, design_overpressure};
use crate::output::outcome::{AuditKind, Failure};
use crate::platform::simd::{InstructionSet, Lanes};
use crate::scene::Film;
use crate::scene::timeline::Phase;

/// Steps between two looks at the frequency of the gas. Chosen: pressure changes slowly within them.
const STEPS_PER_LOOK: u64 = 16;

/// Constants of a run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Constants {
    /// The strip.
    pub strip: Strip,
    /// The gas.
    pub gas: Gas,
    /// The pattern, for static shapes.
    pub pattern: FoldPattern,
    /// The film, for static shapes.
    pub film: Film,
    /// Acceleration of gravity along z, m/s².
    pub gravity: f64,
    /// CFL number.
    pub cfl: f64,
    /// Most steps.
    pub step_limit: u64,
    /// Instruction set.
    pub instruction_set: InstructionSet,
}

/// The strips during a run.
#[derive(Debug, Clone, PartialEq)]
pub struct StoreysRun {
    constants: Constants,
    time: f64,
    /// Step that led to the positions, s; 0 if none moved them.
    last_step: f64,
    positions: Nodes,
    /// Half a step before the positions, m/s.
    velocities: Nodes,
    /// At the positions, N; without gravity.
    forces: Nodes,
    states: Vec<ElementState>,
    volume: f64,
    gas: GasState,
    balance: GasBalance,
    /// Works and losses so far; kinetic, strain and contact are computed for each sample.
    ledger: Ledger,
    /// Σ m z at time 0, kg m.
    first_moment: f64,
    film_stress: f64,
    steps: u64,
    /// Longest step until the next look at the gas, s.
    longest: f64,
}

impl StoreysRun {
    /// Strips at rest at these positions (m), with this gas.
    pub(super) fn new(constants: Constants, positions: Nodes, gas: GasState) -> Self {
        let still = vec![[Lanes::default(); 3]; positions.len()];
        let volume = volume(constants.instruction_set, &constants.strip, &positions);
        let states = vec![ElementState::default(); constants.strip.elements.len()];
        let mut run = Self {
            constants,
            time: 0.0,
            last_step: 0.0,
            velocities: still.clone(),
            forces: still,
            positions,
            states,
            volume,
            gas,
            balance: GasBalance::default(),
            ledger: Ledger::default(),
            first_moment: 0.0,
            film_stress: 0.0,
            steps: 0,
            longest: 0.0,
        };
        run.first_moment = run.moment();
        run.compute_forces(0.0);
        run
    }

    /// Σ m z, kg m.
    fn moment(&self) -> f64 {
        let nodes = self.constants.strip.nodes.iter().zip(&self.positions);
        nodes.map(|(node, x)| node.mass * x[2].sum()).sum()
    }

    fn overpressure(&self) -> f64 {
        let gas = &self.constants.gas;
        gas.pressure(self.gas, self.volume) - gas.ambient_pressure
    }

    /// Computes the forces after a step of this length (s).
    fn compute_forces(&mut self, length: f64) {
        let strip = &self.constants.strip;
        let creep_share = if length > 0.0 { strip.creep.share(length) } else { 0.0 };
        let step = ForceStep { length, overpressure: self.overpressure(), creep_share };
        let set = self.constants.instruction_set;
        let StepSums { loss, numerical, stress } =
            set_forces(set, strip, &self.positions, step, &mut self.states, &mut self.forces);
        self.ledger.material_loss += loss;
        self.ledger.numerical_dissipation += numerical;
        self.film_stress = self.film_stress.max(stress);
    }

    /// Longest stable step times the CFL number, s.
    fn longest_step(&self) -> f64 {
        let strip = &self.constants.strip;
        let film = 2.0 / strip.stable_step;
        let mut sum = 0.0;
        for lane in 0..STRIPS {
            let place = |node: usize| {
                let [x, y, z] = [0, 1, 2].map(|axis: usize| self.positions[node][axis].0[lane]);
                ((x * x + y * y).sqrt(), z)
            };
            let third = core::f64::consts::PI / (3.0 * STRIPS as f64);
            let mut gradient = vec![[0.0; 2]; strip.nodes.len()];
            for node in 0..strip.elements.len() {
                let ((ra, za), (rb, zb)) = (place(node), place(node + 1));
                let area = third * (ra * ra + ra * rb + rb * rb);
                gradient[node][0] += third * (zb - za) * (2.0 * ra + rb);
                gradient[node + 1][0] += third * (zb - za) * (ra + 2.0 * rb);
                gradient[node][1] -= area;
                gradient[node + 1][1] += area;
            }
            for ([across, along], node) in gradient.iter().zip(&strip.nodes) {
                sum += across * across * node.across + along * along * node.along;
            }
        }
        let gas = &self.constants.gas;
        let stiffness = gas.gamma() * gas.pressure(self.gas, self.volume) / self.volume;
        self.constants.cfl * 2.0 / (film * film + stiffness.max(0.0) * sum).sqrt()
    }

    /// Moves strips and gas by one step of this length (s).
    fn step(&mut self, length: f64, phase: &Phase) -> Result<(), Failure> {
        let constants = &self.constants;
        let before = self.volume;
        if !phase.packed {
            let kick = Kick {
                velocity_step: 0.5 * (self.last_step + length),
                drift: length,
                gravity: constants.gravity,
                keep: 1.0,
                level: false,
            };
            self.volume = advance(
                constants.instruction_set,
                &constants.strip,
                &self.forces,
                kick,
                &mut self.positions,
                &mut self.velocities,
            );
            if !self.volume.is_finite() {
                return Err(self.failure(AuditKind::FiniteMotion, "positions of the strips"));
            }
            if self.volume <= 0.0 {
                return Err(self.failure(AuditKind::Volume, "gas volume"));
            }
        }
        let gas = constants.gas.step(self.gas, before, self.volume, length, phase.inflow);
        self.gas = gas.state;
        self.balance.mass_out += gas.mass_out;
        self.balance.enthalpy_in += gas.enthalpy_in;
        self.balance.enthalpy_out += gas.enthalpy_out;
        self.balance.heat += gas.heat;
        self.balance.gas_work += gas.work;
        self.ledger.ambient_work -= constants.gas.ambient_pressure * (self.volume - before);
        if !phase.packed {
            self.last_step = length;
            self.compute_forces(length);
        }
        Ok(())
    }

    fn failure(&self, audit: AuditKind, place: &str) -> Failure {
        Failure::new(audit, self.time, place)
    }

    /// The ledger now.
    fn ledger(&self) -> Ledger {
        let strip = &self.constants.strip;
        let (mut kinetic, mut contact) = (0.0, 0.0);
        for (index, node) in strip.nodes.iter().enumerate() {
            let (v, f) = (&self.velocities[index], &self.forces[index]);
            let inverse = [node.across, node.across, node.along];
            for axis in 0..3 {
                let gravity =
                    if axis == 2 && node.along > 0.0 { self.constants.gravity } else { 0.0 };
                for lane in 0..STRIPS {
                    let before = v[axis].0[lane];
                    let acceleration = f[axis].0[lane] * inverse[axis] + gravity;
                    kinetic += 0.5 * node.mass * before * (before + self.last_step * acceleration);
                }
            }
            if node.min_radius > 0.0 && node.across > 0.0 {
                let [x, y, _] = &self.positions[index];
                for lane in 0..STRIPS {
                    let radius = (x.0[lane] * x.0[lane] + y.0[lane] * y.0[lane]).sqrt();
                    let depth = (node.min_radius - radius).max(0.0);
                    contact += node.barrier * depth * depth * depth / (3.0 * node.min_radius);
                }
            }
        }
        let mut strain = 0.0;
        for (element, state) in strip.elements.iter().zip(&self.states) {
            for lane in 0..STRIPS {
                let at = |tensor: &[Lanes; 3]| tensor.map(|component| component.0[lane]);
                let (e, s, p) = (at(&state.strain), at(&state.stress), at(&state.creep));
                strain -= element.minus_volume * strip.creep.stored_energy(e, s, p);
            }
        }
        Ledger {
            kinetic,
            strain,
            contact,
            gas_work: self.balance.gas_work,
            gravity_work: self.constants.gravity * (self.moment() - self.first_moment),
            ..self.ledger
        }
    }

    /// Mean over the strips of the velocity of the top ring along z now, m/s.
    fn vz(&self) -> f64 {
        let top = self.constants.strip.top_ring;
        let half = 0.5 * self.last_step * self.constants.strip.nodes[top].along;
        let gravity = 0.5 * self.last_step * self.constants.gravity;
        let (v, f) = (self.velocities[top][2], self.forces[top][2]);
        (v + f * half).sum() / STRIPS as f64 + gravity
    }
}

impl Model for StoreysRun {
    fn advance_at_most(
        &mut self,
        target: f64,
        phase: &Phase,
        steps: &mut u64,
    ) -> Result<bool, Failure> {
        while self.time < target {
            if *steps == 0 {
                return Ok(false);
            }
            if self.steps >= self.constants.step_limit {
                return Err(self.failure(AuditKind::StepLimit, "number of steps"));
            }
            let remaining = target - self.time;
            if self.steps.is_multiple_of(STEPS_PER_LOOK) {
                self.longest = self.longest_step();
            }
            let count = (remaining / self.longest).ceil().max(1.0);
            if !count.is_finite() || self.time + remaining / count <= self.time {
                return Err(self.failure(AuditKind::StepLimit, "length of a step"));
            }
            self.step(remaining / count, phase)?;
            self.time = if count > 1.0 { self.time + remaining / count } else { target };
            self.steps += 1;
            *steps -= 1;
        }
        if phase.packed {
            // The gas changed while the strips stood still.
            self.last_step = 0.0;
            self.compute_forces(0.0);
        }
        Ok(true)
    }

    fn sample(&self, phase: &Phase) -> Sample {
        let strip = &self.constants.strip;
        let gas = &self.constants.gas;
        let fall = STRIPS as f64 * self.constants.gravity * self.time;
        let nodes = strip.nodes.iter().zip(&self.velocities);
        let support_impulse = nodes.map(|(node, v)| node.mass * (v[2].sum() - fall)).sum();
        let mean = |node: usize| self.positions[node][2].sum() / STRIPS as f64;
        let largest = |x: &[Lanes; 3]| x[2].largest();
        let lid = || {
            let top = mean(strip.nodes.len() - 1);
            let nodes = self.positions.iter().zip(&self.forces).zip(&strip.nodes);
            let push = |((x, f), node): ((&[Lanes; 3], &[Lanes; 3]), _)| {
                let node: &super::strip::StripNode = node;
                (0..STRIPS)
                    .map(|k| x[2].0[k] * (f[2].0[k] + node.mass * self.constants.gravity))
                    .sum::<f64>()
            };
            nodes.map(push).sum::<f64>() / top
        };
        Sample {
            time: self.time,
            z_centre: mean(strip.nodes.len() - 1),
            z_rim: mean(strip.top_ring),
            z_max: self.positions.iter().map(largest).fold(f64::NEG_INFINITY, f64::max),
            vz: self.vz(),
            volume: self.volume,
            pressure: gas.pressure(self.gas, self.volume),
            temperature: gas.temperature(self.gas),
            lid_force: if phase.packed { lid().max(0.0) } else { 0.0 },
            support_impulse,
            ledger: self.ledger(),
            gas: GasBalance {
                mass: self.gas.mass,
                internal_energy: self.gas.internal_energy,
                mass_in: 0.0,
                ..self.balance
            },
            ..Sample::default()
        }
    }

    fn positions(&self) -> Option<Field> {
        let lane = |x: &[Lanes; 3], k: usize| Vector3::from([0, 1, 2].map(|axis| x[axis].0[k]));
        let nodes = self.positions.iter().flat_map(|x| (0..STRIPS).map(move |k| lane(x, k)));
        Some(Field::of(&nodes.collect::<Vec<_>>()))
    }

    fn reference(&self, final_overpressure: f64) -> Option<Reference> {
        let Constants { pattern, film, instruction_set, .. } = &self.constants;
        let radius = 0.5 * (pattern.bottom_radius + pattern.top_radius);
        let design = design_overpressure(radius, film.youngs_modulus, film.thickness);
        let shape = |overpressure: f64| -> Result<StaticShape, NoReference> {
            static_shape(*instruction_set, pattern, film, overpressure).ok_or_else(|| {
                let problem = "the strips do not come to rest".to_owned();
                NoReference::NoEquilibrium { overpressure, problem }
            })
        };
        // Below the design overpressure the shape hardly changes, and comes to rest slowly.
        Some(Reference { design: shape(design), end: shape(final_overpressure.max(design)) })
    }

    fn film_stress(&self) -> f64 {
        self.film_stress
    }

    fn steps(&self) -> u64 {
        self.steps
    }
}
