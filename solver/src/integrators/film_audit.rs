//! Every audit of film in motion, whatever the integrator: motion, masses, passages, pressure,
//! contact.

use super::contact_audit;
use super::interface::{StepAudit, StepMotion};
use super::motion_audit::MotionAudit;
use super::passage_audit::PassageAudit;
use super::pressure_audit;
use crate::geometry::field::Field;
use crate::mechanics::forces::membrane::NodeForces;
use crate::output::outcome::{AuditKind, Failure};
use crate::scene::monitor_settings::MonitorSettings;
use crate::system::{FilmState, FilmSystem};

/// The audits of a run.
#[derive(Debug, Clone)]
pub struct FilmAudit {
    motion: MotionAudit,
    /// `None` without contact or without a monitor.
    passages: Option<PassageAudit>,
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
        let passages =
            monitor.and_then(|settings| PassageAudit::start(settings, system, state, steps));
        let moves = Field::zeros(state.positions.len());
        Self { motion: MotionAudit::start(system), passages, moves }
    }

    /// The audit of passages.
    pub fn passages(&self) -> Option<&PassageAudit> {
        self.passages.as_ref()
    }

    /// Whether the audit of passages has tested every recorded step.
    pub fn is_complete(&self) -> bool {
        self.passages.as_ref().is_none_or(PassageAudit::is_complete)
    }

    /// Looks at a state at the end of an interval, with its forces.
    ///
    /// # Errors
    /// A [`Failure`] ends the run.
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

/// The failure of the audit of motion at a time (s).
fn elsewhere(time: f64) -> Failure {
    Failure::new(AuditKind::Motion, time, "nodes are not where their velocities lead")
}

impl StepAudit for FilmAudit {
    fn moved(&mut self, motion: StepMotion<'_>) -> Result<(), Failure> {
        if self.motion.add(&motion) { Ok(()) } else { Err(elsewhere(motion.start)) }
    }

    fn record(&mut self, system: &FilmSystem, state: &FilmState) -> Result<(), Failure> {
        self.passages.as_mut().map_or(Ok(()), |audit| audit.record(system, state))
    }

    fn look(&mut self, system: &FilmSystem, state: &FilmState) {
        if let Some(audit) = &mut self.passages {
            audit.look(system, state);
        }
    }

    fn complete(&mut self, system: &FilmSystem, state: &FilmState) -> Result<(), Failure> {
        if let Some(audit) = &mut self.passages {
            audit.complete(system, state)?;
        }
        if !self.motion.keeps_masses(system) {
            let place = "the masses of the nodes are not those of the start";
            return Err(Failure::new(AuditKind::Mass, state.time, place));
        }
        if self.motion.agrees(&state.positions) { Ok(()) } else { Err(elsewhere(state.time)) }
    }
}
