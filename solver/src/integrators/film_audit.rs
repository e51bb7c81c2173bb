//! Every audit of film in motion, whatever the integrator: motion, masses, passages, pressure,
//! contact.

use super::contact_audit;
use super::interface::{StepAudit, StepMotion};
use super::motion_audit::MotionAudit;
use super::pressure_audit;
use crate::collision::monitor::TunnellingMonitor;
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;
use crate::mechanics::forces::membrane::NodeForces;
use crate::output::outcome::{AuditKind, Failure};
use crate::scene::monitor_settings::MonitorSettings;
use crate::system::{FilmState, FilmSystem};

/// The audits of a run.
#[derive(Debug, Clone)]
pub struct FilmAudit {
    motion: MotionAudit,
    /// Looks for passages of film through film; `None` without contact or without a monitor.
    pub monitor: Option<TunnellingMonitor>,
    /// Time of the last recorded state, s.
    time: f64,
    /// Scratch memory: a vector for each node.
    moves: Field,
}

impl FilmAudit {
    /// Starts at a state after `steps` steps of the run. The monitor needs contact.
    pub fn start(
        monitor: Option<MonitorSettings>,
        system: &FilmSystem,
        state: &FilmState,
        steps: u64,
    ) -> Self {
        let (positions, set) = (&state.positions, system.instruction_set);
        let start = |(settings, topology): (MonitorSettings, _)| {
            TunnellingMonitor::new(settings, topology, positions, steps, set)
        };
        let monitor = monitor.zip(topology(system)).map(start);
        let moves = Field::zeros(positions.len());
        Self { motion: MotionAudit::start(system), monitor, time: state.time, moves }
    }

    /// Whether every recorded step is tested for passages.
    pub fn is_complete(&self) -> bool {
        self.monitor.as_ref().is_none_or(TunnellingMonitor::is_block_start)
    }

    /// Looks at a state at the end of an interval, with its forces.
    pub fn inspect(
        &mut self,
        system: &FilmSystem,
        state: &FilmState,
        forces: &NodeForces,
    ) -> Result<(), Failure> {
        pressure_audit::check(system, state, forces, &mut self.moves)?;
        contact_audit::check(system, state, forces)
    }
}

/// The mesh of the film in contact.
fn topology(system: &FilmSystem) -> Option<&Topology> {
    system.contact.as_ref().map(|model| &model.mesh.topology)
}

/// The failure of the audit of motion at a time (s).
fn elsewhere(time: f64) -> Failure {
    Failure::new(AuditKind::Motion, time, "nodes are not where their velocities lead")
}

/// The failure of a run up to a time (s) in which film passed through film.
fn check_passages(monitor: &TunnellingMonitor, time: f64) -> Result<(), Failure> {
    let Some((passage, position)) = monitor.first_passage else { return Ok(()) };
    let [x, y, z] = [position.x, position.y, position.z];
    let place = format!("{passage}, near ({x:.4}, {y:.4}, {z:.4}) m");
    Err(Failure::new(AuditKind::Passages, time, place))
}

impl StepAudit for FilmAudit {
    fn moved(&mut self, motion: StepMotion<'_>) -> Result<(), Failure> {
        if self.motion.add(&motion) { Ok(()) } else { Err(elsewhere(motion.start)) }
    }

    fn record(&mut self, system: &FilmSystem, state: &FilmState) -> Result<(), Failure> {
        // A failed step is not accepted: the run ended at the time before it.
        let before = core::mem::replace(&mut self.time, state.time);
        let Some((monitor, topology)) = self.monitor.as_mut().zip(topology(system)) else {
            return Ok(());
        };
        monitor.record_step(topology, &state.positions);
        check_passages(monitor, before)
    }

    fn look(&mut self, system: &FilmSystem, state: &FilmState) {
        if let Some((monitor, topology)) = self.monitor.as_mut().zip(topology(system)) {
            monitor.intersection_counter.update(topology, &state.positions);
        }
    }

    fn complete(&mut self, system: &FilmSystem, state: &FilmState) -> Result<(), Failure> {
        self.time = state.time;
        if let Some((monitor, topology)) = self.monitor.as_mut().zip(topology(system)) {
            monitor.test_to_sample(topology);
            check_passages(monitor, state.time)?;
        }
        if !self.motion.keeps_masses(system) {
            let place = "the masses of the nodes are not those of the start";
            return Err(Failure::new(AuditKind::Mass, state.time, place));
        }
        if self.motion.agrees(&state.positions) { Ok(()) } else { Err(elsewhere(state.time)) }
    }
}
