//! Film in motion: a system, its state, an integrator and an audit.

use serde::{Deserialize, Serialize};

use super::film_audit::FilmAudit;
use super::film_view::FilmView;
use super::interface::{Advance, Budget, Integrator, Interval};
use super::{StoredIntegrator, entry};
use crate::geometry::field::Field;
use crate::mechanics::gas::GasState;
use crate::output::events::Event;
use crate::output::outcome::Failure;
use crate::platform::stopwatch::{Stopwatch, Untimed};
use crate::scene::monitor_settings::MonitorSettings;
use crate::scene::timeline::Phase;
use crate::scene::{DEFAULT_CFL, IntegratorKind};
use crate::system::{FilmState, FilmSystem};

/// How a system is integrated and audited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimulationSettings {
    /// Integrator.
    pub integrator: IntegratorKind,
    /// CFL number: the step as a fraction of the stable step.
    pub cfl: f64,
    /// Accepted steps after which a run fails with `step_limit`.
    pub step_limit: u64,
    /// Settings of the tunnelling monitor; `None` switches it off. It needs contact.
    pub monitor: Option<MonitorSettings>,
}

impl Default for SimulationSettings {
    fn default() -> Self {
        Self {
            integrator: IntegratorKind::default(),
            cfl: DEFAULT_CFL,
            step_limit: u64::MAX,
            monitor: None,
        }
    }
}

/// Everything that a run of film resumes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredFilm {
    /// State of the film.
    pub state: FilmState,
    /// Private state of the integrator.
    pub integrator: StoredIntegrator,
}

/// Film in motion.
#[derive(Debug)]
pub struct FilmSimulation {
    system: FilmSystem,
    state: FilmState,
    settings: SimulationSettings,
    integrator: Box<dyn Integrator>,
    audit: FilmAudit,
    events: Vec<Event>,
}

impl Clone for FilmSimulation {
    fn clone(&self) -> Self {
        Self {
            system: self.system.clone(),
            state: self.state.clone(),
            settings: self.settings,
            integrator: self.integrator.boxed(),
            audit: self.audit.clone(),
            events: self.events.clone(),
        }
    }
}

impl FilmSimulation {
    /// A system at time 0 with these positions (m), velocities (m/s) and gas.
    pub fn new(
        system: FilmSystem,
        settings: SimulationSettings,
        positions: Field,
        velocities: Field,
        gas: GasState,
    ) -> Self {
        let (state, workspace) = FilmState::start(&system, positions, velocities, gas);
        let start = entry(settings.integrator).start;
        let integrator = start(&system, &state, workspace, settings.cfl);
        Self::of(system, state, settings, integrator)
    }

    /// A system at a state, with an integrator of any kind that starts there.
    pub fn of(
        system: FilmSystem,
        state: FilmState,
        settings: SimulationSettings,
        integrator: Box<dyn Integrator>,
    ) -> Self {
        let steps = integrator.computed().accounting.steps;
        let audit = FilmAudit::start(settings.monitor, &system, &state, steps);
        Self { system, state, settings, integrator, audit, events: Vec::new() }
    }

    /// Resumes a run of the same system with the same settings. It continues with the same bits. `None` if
    /// what is stored belongs to another system or another integrator.
    pub fn resume(
        system: FilmSystem,
        settings: SimulationSettings,
        stored: StoredFilm,
    ) -> Option<Self> {
        let StoredFilm { state, integrator } = stored;
        let fits = state.fits(&system)
            && integrator.kind() == settings.integrator
            && integrator.fits(&system);
        fits.then(|| {
            let integrator = integrator.resume(&system, &state, settings.cfl);
            Self::of(system, state, settings, integrator)
        })
    }

    /// The same film at its state now, as another system and with other settings: a change of load, damping
    /// or step. The integrator keeps its private state, the audit starts again.
    ///
    /// # Panics
    /// If the film of the other system has another mesh, or the integrator cannot be resumed.
    #[must_use]
    pub fn with(
        self,
        change: impl FnOnce(FilmSystem, SimulationSettings) -> (FilmSystem, SimulationSettings),
    ) -> Self {
        let stored = self.stored().expect("an integrator that can be resumed");
        let (system, settings) = change(self.system, self.settings);
        let mut stored = stored;
        stored.state.pressure = match system.pressure_load {
            crate::system::PressureLoad::Overpressure(pressure) => pressure,
            crate::system::PressureLoad::Gas(_) => stored.state.pressure,
        };
        Self::resume(system, settings, stored).expect("a system with the same film")
    }

    /// The film as it is now.
    pub fn view(&self) -> FilmView<'_> {
        FilmView {
            system: &self.system,
            state: &self.state,
            integrator: &*self.integrator,
            audit: &self.audit,
        }
    }

    /// Settings.
    pub fn settings(&self) -> SimulationSettings {
        self.settings
    }

    /// Its system, state and settings: to build another simulation of them.
    pub fn into_parts(self) -> (FilmSystem, FilmState, SimulationSettings) {
        (self.system, self.state, self.settings)
    }

    /// What the run resumes from; `None` with an integrator that cannot be resumed.
    pub fn stored(&self) -> Option<StoredFilm> {
        let integrator = self.integrator.stored()?;
        Some(StoredFilm { state: self.state.clone(), integrator })
    }

    /// Whether a run that is resumed from here reports a passage of film at the same step as this one: the
    /// audit has tested every step so far.
    pub fn is_audited(&self) -> bool {
        self.audit.is_complete()
    }

    /// The decisions of the step controller since the last call.
    pub fn take_events(&mut self) -> Vec<Event> {
        core::mem::take(&mut self.events)
    }

    /// Advances to exactly `target` (s) under a phase.
    ///
    /// # Errors
    /// [`Failure`]: `unstable`, `overstretched`, `inverted_volume`, `step_limit` or `interpenetrated`.
    pub fn advance(&mut self, target: f64, phase: &Phase) -> Result<(), Failure> {
        self.advance_at_most(target, phase, &mut u64::MAX.clone()).map(|_| ())
    }

    /// Advances towards `target` (s) under a phase by at most `steps` steps, and subtracts the steps taken
    /// from `steps`. Returns whether it reached the target. A pause changes no bit of the run: the audit
    /// tests its block of steps when it is complete.
    pub fn advance_at_most(
        &mut self,
        target: f64,
        phase: &Phase,
        steps: &mut u64,
    ) -> Result<bool, Failure> {
        self.advance_timed(target, phase, steps, &mut Untimed)
    }

    /// [`Self::advance_at_most`] with a stopwatch that learns when each stage begins.
    pub fn advance_timed(
        &mut self,
        target: f64,
        phase: &Phase,
        steps: &mut u64,
        stopwatch: &mut dyn Stopwatch,
    ) -> Result<bool, Failure> {
        let (step_limit, events) = (self.settings.step_limit, &mut self.events);
        let audit = &mut self.audit;
        let budget = Budget { steps, step_limit, audit, stopwatch, events };
        let interval = Interval { target, phase };
        let advanced = self.integrator.advance(&mut self.state, &self.system, interval, budget)?;
        let reached = advanced == Advance::Reached;
        if reached {
            self.audit.inspect(
                &self.system,
                &self.state,
                &self.integrator.computed().workspace.forces,
            )?;
        }
        Ok(reached)
    }
}
