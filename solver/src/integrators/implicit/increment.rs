//! What the motion of a step minimises, with the gas and the creep strain that follow it.
//!
//! ```text
//! Φ(x) = Π(x) + ½ w (x − x̂)·M (x − x̂)
//! gas of Π = gas after the whole step to the volume V*;  in another volume adiabatic about V*
//! P of Π   = creep strain after the whole step along x₀ → x*
//! ```
//!
//! x₀ positions at the start of the step. x*, V*: in a step shorter than the relaxation time of the creep those of the
//! start, which is right to second order; in a longer one, whose end is nearly in balance with its creep, those found so
//! far. Gas and creep change little from one Newton step to the next: creep by g/(1 + g) of what the strain does
//! ([`crate::mechanics::material_loss`]).

use super::linear_system::LinearSystem;
use crate::geometry::field::Field;
use crate::mechanics::forces::membrane::CreepStrain;
use crate::scene::inflow::Inflow;
use crate::system::{Evaluation, FilmState, FilmSystem, PressureLoad, Workspace};

/// What a step minimises.
#[derive(Debug, Clone)]
pub(super) struct Increment<'a> {
    pub(super) system: &'a FilmSystem,
    /// State at the start of the step.
    pub(super) from: &'a FilmState,
    /// The same with gas and creep strain as the motion sees them.
    pub(super) state: FilmState,
    /// Inflow of the step.
    pub(super) inflow: Inflow,
    /// Time at the end of the step, s.
    pub(super) end: f64,
    /// w, 1/s².
    pub(super) weight: f64,
    /// x̂, m.
    pub(super) target: &'a Field,
}

impl Increment<'_> {
    /// Length of the step, s.
    fn length(&self) -> f64 {
        self.end - self.from.time
    }

    /// Whether the step is longer than the relaxation time of the creep, which then follows the motion within the step.
    pub(super) fn is_long(&self) -> bool {
        !self.from.creep.is_empty() && self.length() > self.system.model.creep.time
    }

    /// Gives the motion the gas and the creep strain that the step would end with if the film did not move.
    pub(super) fn load_at_start(&mut self) {
        self.load(&self.from.positions, self.from.volume);
    }

    /// Gives the motion the gas and the creep strain that the step would end with at these positions (m) of this volume
    /// (m³), and evaluates there.
    pub(super) fn follow(
        &mut self,
        positions: &mut Field,
        volume: f64,
        workspace: &mut Workspace,
    ) -> (Evaluation, f64) {
        self.load(positions, volume);
        self.evaluate(positions, workspace)
    }

    fn load(&mut self, positions: &Field, volume: f64) {
        let (system, from, length) = (self.system, self.from, self.length());
        self.state.creep.clone_from(&from.creep);
        let path = (&from.positions, positions);
        CreepStrain::relax(&system.model, path, length, &mut self.state.creep);
        if let Some(gas) = system.gas_step(from, volume, length, self.inflow) {
            (self.state.gas, self.state.volume) = (gas.state, volume);
        }
    }

    /// Energies and Φ (J) at positions (m); leaves their forces in the workspace.
    pub(super) fn evaluate(
        &self,
        positions: &mut Field,
        workspace: &mut Workspace,
    ) -> (Evaluation, f64) {
        let system = self.system;
        system.place_closing_nodes(positions);
        let evaluation = system.evaluate(&self.state, positions, self.end, workspace);
        let mut inertia = 0.0;
        for (node, mass) in system.model.mass.iter().enumerate() {
            inertia += mass * (positions.get(node) - self.target.get(node)).norm_squared();
        }
        for body in &system.supports.bodies {
            let Some(node) = body.nodes.first() else { continue };
            let node = *node as usize;
            let travel = body.plane.normal.dot(&(positions.get(node) - self.target.get(node)));
            inertia += body.plane.mass * travel * travel;
        }
        let potential = evaluation.energy() + 0.5 * self.weight * inertia;
        let valid = evaluation.volume > 0.0
            || matches!(system.pressure_load, PressureLoad::Overpressure(_));
        (evaluation, if valid { potential } else { f64::NAN })
    }

    /// −∂Φ/∂x along the unknowns, N.
    pub(super) fn residual(
        &self,
        linear: &LinearSystem,
        positions: &Field,
        evaluation: &Evaluation,
        workspace: &Workspace,
    ) -> Vec<f64> {
        let system = self.system;
        let overpressure = system.overpressure_at(evaluation.gas_pressure);
        let mut forces = Field::zeros(positions.len());
        for (node, mass) in system.model.mass.iter().enumerate() {
            let force = system.node_force(&workspace.forces, overpressure, node);
            let away = positions.get(node) - self.target.get(node);
            forces.set(node, force - away * (self.weight * mass));
        }
        let mut along = linear.unknowns.gather(&forces);
        let planes = along[linear.unknowns.first_plane as usize..].iter_mut();
        for (along, body) in planes.zip(&system.supports.bodies) {
            let Some(node) = body.nodes.first() else { continue };
            let node = *node as usize;
            let travel = body.plane.normal.dot(&(positions.get(node) - self.target.get(node)));
            *along -= self.weight * body.plane.mass * travel;
        }
        along
    }
}
