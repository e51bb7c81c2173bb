//! Everything that changes while film moves, at one time.

use serde::{Deserialize, Serialize};

use super::{FilmSystem, Workspace};
use crate::collision::contact::ContactState;
use crate::geometry::field::Field;
use crate::mechanics::forces::membrane::CreepStrain;
use crate::mechanics::gas::GasState;
use crate::mechanics::supports::RigidPlane;

/// All fields of moving film at one time. No method's private data: those are the integrator's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilmState {
    /// Time, s.
    pub time: f64,
    /// Positions of the nodes, m.
    pub positions: Field,
    /// Velocities of the nodes, m/s.
    pub velocities: Field,
    /// Velocities of the rigid planes along their normals, m/s.
    pub planes: Vec<f64>,
    /// Creep strains, the history of the material, in the layout of the element loop; empty for film
    /// without loss.
    pub creep: Vec<[CreepStrain; 2]>,
    /// What each further energy has yielded: of bending the turn of each hinge, rad; empty for one that does not yield.
    pub yielded: Vec<Vec<f64>>,
    /// Enclosed volume V, m³.
    pub volume: f64,
    /// Gas: pressure p. Fixed overpressure: that overpressure. Pa.
    pub pressure: f64,
    /// Mass and internal energy of the gas.
    pub gas: GasState,
    /// Contact of film with film and with plates.
    pub contact: ContactState,
}

impl FilmState {
    /// Film at time 0 with these positions (m), velocities (m/s) and gas, and the workspace that holds its
    /// forces. Nodes of rigid planes have the velocity of their plane.
    pub fn start(
        system: &FilmSystem,
        mut positions: Field,
        mut velocities: Field,
        gas: GasState,
    ) -> (Self, Workspace) {
        let bodies = &system.supports.bodies;
        let planes: Vec<f64> = bodies.iter().map(|body| body.plane.velocity).collect();
        for (body, velocity) in bodies.iter().zip(&planes) {
            bind(body, *velocity, &mut velocities);
        }
        let creep = CreepStrain::at_rest(&system.model, &positions);
        let yielded = system.unyielded();
        system.model.closure_nodes.place(&mut positions);
        let mut contact = ContactState::default();
        if let Some(contact_model) = &system.contact {
            let plates = contact_model.plates.iter();
            contact.plates = plates
                .map(|plate| plate.initial_state(&positions, contact_model.distance))
                .collect();
        }
        let (time, volume, pressure) = (0.0, 0.0, 0.0);
        let mut state = Self {
            time,
            positions,
            velocities,
            planes,
            creep,
            yielded,
            volume,
            pressure,
            gas,
            contact,
        };
        let mut workspace = Workspace::new(system, &state);
        state.volume = workspace.forces_at(system, &state, None).six_volumes / 6.0;
        state.pressure = system.pressure(state.gas, state.volume);
        workspace.commit_contact(&mut state);
        (state, workspace)
    }

    /// Whether it can be a state of this system: its fields have the sizes of the system's film.
    pub fn fits(&self, system: &FilmSystem) -> bool {
        let nodes = system.model.nodes();
        let blocks = if system.model.creep.ratio > 0.0 { system.model.constants.len() } else { 0 };
        let columns = [&self.positions, &self.velocities].map(|f| [&f.x, &f.y, &f.z]);
        columns.iter().flatten().all(|column| column.len() == nodes)
            && self.creep.len() == blocks
            && self.yielded.len() == system.energy_terms.len()
            && self
                .yielded
                .iter()
                .zip(&system.energy_terms)
                .all(|(y, term)| y.len() == term.yield_values())
            && self.planes.len() == system.supports.bodies.len()
    }
}

/// Gives the nodes of a rigid plane the plane's velocity (m/s) along its normal.
pub(crate) fn bind(body: &RigidPlane, velocity: f64, velocities: &mut Field) {
    for node in &body.nodes {
        let node = *node as usize;
        let before = velocities.get(node);
        let normal = body.plane.normal;
        velocities.set(node, before + normal * (velocity - normal.dot(&before)));
    }
}
