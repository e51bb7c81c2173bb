//! Film in motion, to look at: nothing can be changed through it.

use nalgebra::{Matrix3, Vector3};

use super::energy_accounting::EnergyAccounting;
use super::film_audit::FilmAudit;
use super::interface::Integrator;
use crate::collision::monitor::TunnellingMonitor;
use crate::mechanics::forces::membrane::{NORMAL_TO_GRADIENT, NodeForces, stress_on_fraction};
use crate::output::ledger::{GasBalance, Ledger};
use crate::system::{FilmState, FilmSystem};

/// Film in motion as it is now.
#[derive(Debug, Clone, Copy)]
pub struct FilmView<'a> {
    /// What is constant.
    pub system: &'a FilmSystem,
    /// What changes, at one time.
    pub state: &'a FilmState,
    pub(super) integrator: &'a dyn Integrator,
    pub(super) audit: &'a FilmAudit,
}

impl<'a> FilmView<'a> {
    /// Forces on the nodes, dissipative ones included.
    pub fn forces(&self) -> &'a NodeForces {
        &self.integrator.computed().workspace.forces
    }

    /// Energy accounting since time 0.
    pub fn accounting(&self) -> &'a EnergyAccounting {
        self.integrator.computed().accounting
    }

    /// Accepted steps.
    pub fn steps(&self) -> u64 {
        self.accounting().steps
    }

    /// The length of the next step if nothing bounds it but the method, s.
    pub fn next_step(&self) -> f64 {
        self.integrator.next_step(self.system, self.state)
    }

    /// The energy ledger of the film.
    pub fn ledger(&self) -> Ledger {
        self.integrator.ledger(self.system, self.state)
    }

    /// The balance of the gas, without the mass let in.
    pub fn gas_balance(&self) -> GasBalance {
        self.accounting().gas_balance(self.system, self.state)
    }

    /// Overpressure p − `p_ambient`, Pa.
    pub fn overpressure(&self) -> f64 {
        self.system.overpressure(self.state)
    }

    /// Sum of all forces on a node, N.
    pub fn force(&self, node: usize) -> Vector3<f64> {
        self.system.node_force(self.forces(), self.overpressure(), node)
    }

    /// Force of the film on a support that holds `nodes` along `held`, N, and its moment about the origin,
    /// N m. Inertia is not included, nor is the pressure on closing faces on a wall.
    pub fn reaction(&self, nodes: &[u32], held: &Matrix3<f64>) -> [Vector3<f64>; 2] {
        let mut sum = [Vector3::zeros(); 2];
        let on_walls = self.system.model.closure_nodes.on_walls(&self.state.positions);
        for node in nodes {
            let wall = on_walls.get(node).map_or_else(Vector3::zeros, |normal| *normal);
            let node = *node as usize;
            let on_wall = wall * (self.overpressure() * NORMAL_TO_GRADIENT);
            let force = held * (self.force(node) - on_wall);
            sum[0] += force;
            sum[1] += self.state.positions.get(node).cross(&force);
        }
        sum
    }

    /// Stress (Pa) that the largest principal stress reaches on this fraction of the film's area.
    pub fn stress_on_fraction(&self, fraction: f64) -> f64 {
        let histories = &self.integrator.computed().workspace.histories;
        stress_on_fraction(&self.system.model, histories, fraction)
    }

    /// Smallest gap of the pairs of film that are closer than their contact distance, m; infinite if there
    /// is none. Pairs beyond the contact distance are not considered.
    pub fn smallest_gap(&self) -> f64 {
        let contact = self.integrator.computed().workspace.contact.as_ref();
        contact.map_or(f64::INFINITY, |contact| contact.list.smallest_gap)
    }

    /// Passages of film through film so far; `None` without an audit.
    pub fn passages(&self) -> Option<u64> {
        self.audit.monitor.as_ref().map(|monitor| monitor.passages)
    }

    /// Number of steps of the run that are tested for passages; `None` without an audit.
    pub fn tested_steps(&self) -> Option<u64> {
        self.audit.monitor.as_ref().map(TunnellingMonitor::tested_steps)
    }

    /// Intersections of the mesh at the end of the last interval; `None` without an audit.
    pub fn intersections(&self) -> Option<u64> {
        self.audit.monitor.as_ref().map(|monitor| monitor.intersection_counter.count)
    }
}
