//! The audit of passages: no film passes through film.

use crate::collision::monitor::TunnellingMonitor;
use crate::output::outcome::{AuditKind, Failure};
use crate::scene::monitor_settings::MonitorSettings;
use crate::system::{FilmState, FilmSystem};

/// The tunnelling monitor of a run.
#[derive(Debug, Clone)]
pub struct PassageAudit {
    /// The monitor.
    monitor: TunnellingMonitor,
    /// Time of the last recorded state, s.
    time: f64,
}

impl PassageAudit {
    /// Starts at a state after `steps` steps of the run; `None` without contact.
    pub fn start(
        settings: MonitorSettings,
        system: &FilmSystem,
        state: &FilmState,
        steps: u64,
    ) -> Option<Self> {
        let contact_model = system.contact.as_ref()?;
        let (topology, set) = (&contact_model.mesh.topology, system.instruction_set);
        let monitor = TunnellingMonitor::new(settings, topology, &state.positions, steps, set);
        Some(Self { monitor, time: state.time })
    }

    /// Passages of film through film so far.
    pub fn passages(&self) -> u64 {
        self.monitor.passages
    }

    /// Number of intersections of the mesh at the end of the last interval, or where the run was resumed.
    pub fn intersections(&self) -> u64 {
        self.monitor.intersection_counter.count
    }

    /// Number of steps of the run that are tested.
    pub fn tested_steps(&self) -> u64 {
        self.monitor.tested_steps()
    }

    /// Whether every recorded step is tested.
    pub fn is_complete(&self) -> bool {
        self.monitor.is_block_start()
    }

    fn check(&self, time: f64) -> Result<(), Failure> {
        match self.monitor.first_passage {
            None => Ok(()),
            Some((passage, position)) => {
                let [x, y, z] = [position.x, position.y, position.z];
                let place = format!("{passage}, near ({x:.4}, {y:.4}, {z:.4}) m");
                Err(Failure::new(AuditKind::Passages, time, place))
            }
        }
    }
}

impl PassageAudit {
    /// As [`super::StepAudit::record`].
    pub(super) fn record(&mut self, system: &FilmSystem, state: &FilmState) -> Result<(), Failure> {
        if let Some(contact_model) = &system.contact {
            self.monitor.record_step(&contact_model.mesh.topology, &state.positions);
        }
        // A failed step is not accepted: the run ended at the time before it.
        let before = core::mem::replace(&mut self.time, state.time);
        self.check(before)
    }

    /// As [`super::StepAudit::look`].
    pub(super) fn look(&mut self, system: &FilmSystem, state: &FilmState) {
        if let Some(contact_model) = &system.contact {
            let topology = &contact_model.mesh.topology;
            self.monitor.intersection_counter.update(topology, &state.positions);
        }
    }

    /// As [`super::StepAudit::complete`].
    pub(super) fn complete(
        &mut self,
        system: &FilmSystem,
        state: &FilmState,
    ) -> Result<(), Failure> {
        if let Some(contact_model) = &system.contact {
            self.monitor.test_block(&contact_model.mesh.topology);
        }
        self.look(system, state);
        self.time = state.time;
        self.check(self.time)
    }
}
