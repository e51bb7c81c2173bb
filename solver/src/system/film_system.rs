//! Everything that is constant while film moves.

use std::sync::Arc;

use nalgebra::Vector3;

use super::FilmState;
use crate::collision::contact::ContactModel;
use crate::geometry::field::Field;
use crate::mechanics::energy_term::{EnergyTerm, Yielding};
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::membrane::NodeForces;
use crate::mechanics::gas::{Gas, GasState, GasStep};
use crate::mechanics::supports::{RigidPlane, Supports};
use crate::platform::fault_injection::{Fault, Term};
use crate::platform::simd::InstructionSet;
use crate::scene::inflow::Inflow;

/// The pressure on the inside of the film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PressureLoad {
    /// Gas in the closed volume.
    Gas(Gas),
    /// A fixed overpressure, Pa, whatever the volume. The film may be open.
    Overpressure(f64),
}

/// Everything that is constant during a run: mesh, masses, material, supports, contact, gas law, loads.
#[derive(Debug, Clone)]
pub struct FilmSystem {
    /// Mesh, masses and material of the film.
    pub model: FilmModel,
    /// Pressure on the inside.
    pub pressure_load: PressureLoad,
    /// Supports.
    pub supports: Supports,
    /// Acceleration of gravity, m/s².
    pub gravity: Vector3<f64>,
    /// Numerical damping ratio ζ.
    pub numerical_damping: f64,
    /// Mass damping c, 1/s. A capsule's scene sets 0; a film scene and [`crate::statics::Relaxation`]
    /// may set more.
    pub mass_damping: f64,
    /// Contact of film with film; without it film passes through film.
    pub contact: Option<ContactModel>,
    /// Further energies.
    pub energy_terms: Vec<Arc<dyn EnergyTerm>>,
    /// Instruction set. Every one gives the same bits.
    pub instruction_set: InstructionSet,
    /// A deliberate fault: tests only.
    pub fault: Option<Fault>,
}

impl FilmSystem {
    /// Film without supports, gravity, damping or contact, on the widest instruction set of this machine.
    pub fn free(model: FilmModel, pressure_load: PressureLoad) -> Self {
        Self {
            pressure_load,
            supports: Supports::none(model.nodes()),
            model,
            gravity: Vector3::zeros(),
            numerical_damping: 0.0,
            mass_damping: 0.0,
            contact: None,
            energy_terms: Vec::new(),
            instruction_set: InstructionSet::detect(),
            fault: None,
        }
    }

    /// Kinetic energy of nodes and rigid planes of a state, J.
    pub fn kinetic_energy(&self, state: &FilmState) -> f64 {
        let nodes = self.model.mass.iter().zip(state.velocities.iter());
        let film: f64 = nodes.map(|(mass, velocity)| mass * velocity.norm_squared()).sum();
        let planes = self.supports.bodies.iter().zip(&state.planes);
        let planes: f64 = planes.map(|(body, speed)| body.plane.mass * speed * speed).sum();
        0.5 * (film + planes)
    }

    /// The factor a deliberate fault puts on this term; 1 without a fault.
    pub fn fault_factor(&self, term: Term) -> f64 {
        self.fault.filter(|fault| fault.term == term).map_or(1.0, |fault| fault.factor)
    }

    /// Pressure of the load in a volume (m³), Pa; of a fixed overpressure that overpressure.
    pub fn pressure(&self, gas: GasState, volume: f64) -> f64 {
        match self.pressure_load {
            PressureLoad::Gas(law) => {
                self.fault_factor(Term::GasPressure) * law.pressure(gas, volume)
            }
            PressureLoad::Overpressure(pressure) => pressure,
        }
    }

    /// Overpressure p − `p_ambient` at a pressure (Pa), Pa.
    pub fn overpressure_at(&self, pressure: f64) -> f64 {
        match self.pressure_load {
            PressureLoad::Gas(gas) => {
                pressure - gas.ambient_pressure * self.fault_factor(Term::Ambient)
            }
            PressureLoad::Overpressure(pressure) => pressure,
        }
    }

    /// Overpressure p − `p_ambient` of a state, Pa.
    pub fn overpressure(&self, state: &FilmState) -> f64 {
        self.overpressure_at(state.pressure)
    }

    /// Zero forces on the nodes.
    pub fn no_forces(&self) -> NodeForces {
        let mut forces = NodeForces::new(&self.model);
        if !self.energy_terms.is_empty() {
            forces.terms = Field::zeros(self.model.nodes());
        }
        forces
    }

    /// What the further energies have yielded before any motion: nothing.
    pub fn unyielded(&self) -> Vec<Vec<f64>> {
        self.energy_terms.iter().map(|term| vec![0.0; term.yield_values()]).collect()
    }

    /// Energy of the further terms at these positions (m), J.
    pub fn term_energy(&self, positions: &Field, yielded: &[Vec<f64>]) -> f64 {
        self.energy_terms
            .iter()
            .zip(yielded)
            .map(|(term, of_term)| term.energy(positions, of_term))
            .sum()
    }

    /// Lets the further energies yield at the positions of a state.
    pub fn let_terms_yield(&self, state: &mut FilmState) -> Yielding {
        let mut sum = Yielding::default();
        for (term, yielded) in self.energy_terms.iter().zip(&mut state.yielded) {
            let Yielding { work, released } = term.let_yield(&state.positions, yielded);
            sum.work += work * self.fault_factor(Term::YieldWork);
            sum.released += released;
        }
        sum
    }

    /// Sets the forces (N) of the further energies at these positions (m).
    pub fn term_forces(&self, positions: &Field, yielded: &[Vec<f64>], forces: &mut NodeForces) {
        if self.energy_terms.is_empty() {
            return;
        }
        let Field { x, y, z } = &mut forces.terms;
        for column in [x, y, z] {
            column.fill(0.0);
        }
        for (term, of_term) in self.energy_terms.iter().zip(yielded) {
            term.add_forces(positions, of_term, &mut forces.terms);
        }
        if self.fault.is_some() {
            let factor = self.fault_factor(Term::Bending);
            for node in 0..forces.terms.len() {
                forces.terms.set(node, forces.terms.get(node) * factor);
            }
        }
    }

    /// Sum of all forces on a node under an overpressure (Pa), N.
    #[inline]
    pub fn node_force(&self, forces: &NodeForces, overpressure: f64, node: usize) -> Vector3<f64> {
        let force = forces.film(node)
            + forces.contact.get(node)
            + forces.area(node) * overpressure
            + self.gravity * (self.model.mass[node] * self.fault_factor(Term::Gravity));
        if self.energy_terms.is_empty() { force } else { force + forces.terms.get(node) }
    }

    /// Force of the film on a rigid plane along the plane's normal, N.
    pub fn force_on(&self, forces: &NodeForces, overpressure: f64, body: &RigidPlane) -> f64 {
        let along = |node: &u32| {
            self.node_force(forces, overpressure, *node as usize).dot(&body.plane.normal)
        };
        body.nodes.iter().map(along).sum()
    }

    /// What a step of `length` (s) to a volume (m³) makes of the gas; `None` under a fixed overpressure.
    pub fn gas_step(
        &self,
        state: &FilmState,
        volume: f64,
        length: f64,
        inflow: Inflow,
    ) -> Option<GasStep> {
        let PressureLoad::Gas(gas) = self.pressure_load else { return None };
        let mut step = gas.step(state.gas, state.volume, volume, length, inflow);
        if let Some(fault) = self.fault {
            step.inject_fault(&gas, volume, inflow.mass_flow_rate * length, fault);
        }
        Some(step)
    }

    /// First moment of mass Σ m x of a state, kg m.
    pub fn first_moment(&self, state: &FilmState) -> Vector3<f64> {
        let nodes = self.model.mass.iter().zip(state.positions.iter());
        nodes.map(|(mass, position)| position * *mass).sum()
    }
}
