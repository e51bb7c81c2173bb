//! Extended position-based dynamics for film, one projection of every constraint a substep.
//!
//! ```text
//! v* = v + h W f_ext          x* = x + h v*           f_ext = m g + further energies, at x
//! x* ← x* + h² W ∂V/∂x Δp     Δp = p − p_ambient after the motion, to first order: the gas as one constraint
//! Δλ = −(C + α̃ λ)/(Σ ∇C·W ∇C + α̃)      x ← x + W ∇C Δλ         one pass, λ = 0 before it: elements, then contacts
//! v' = (x' − x)/h             the gas steps from V to V'
//!
//! C = √(2 U)      compliance 1, so that ½ C² is the energy U of the element, and α̃ = 1/h²
//! h ≤ 4 CFL 2/ω_film          h ≤ 0.8 · 2/ω_terms
//! ```
//!
//! Sources: M. Macklin, M. Müller, N. Chentanez, "XPBD: position-based simulation of compliant constrained
//! dynamics" (2016); M. Macklin et al., "Small steps in physics simulation" (2019): one pass a substep. With a
//! whole tension field as one constraint ∇U = C ∇C, so a projection is the element's force, limited to what the
//! element can bear in the substep: Δx = h² W f/(1 + h² Σ f·W f/(2 U)).
//!
//! First order in h, and never unstable in the film, however long h is. One pass leaves a residual C + α̃ λ: an
//! element bears its load only when it is stretched 1 + h² Σ f·W f/(2 U) times as far, so taut film is too soft, and
//! stores more energy than it was given. The fastest waves lose energy. Further energies are explicit, so they bound h. The
//! numerical damping ratio is ignored: the method damps by itself. Creep is split off: it advances after each
//! substep (`sweep`). Film is kept apart by `contacts`. Friction, adhesion and rigid planes are refused.
//!
//! Numerical dissipation is what closes the ledger. So no residual of the ledger can fault this method; a
//! dissipation far below zero does (`unstable`), and so does [`Residual`], which the history file has as a track.

use crate::collision::contact::SearchProgress;
use crate::geometry::field::Field;
use crate::integrators::energy_accounting::EnergyAccounting;
use crate::integrators::explicit::motion::StepInterval;
use crate::integrators::interface::{Advance, Budget, Integrator, Interval};
use crate::integrators::{ContactForce, IntegratorEntry, Refusal, StoredIntegrator};
use crate::mechanics::forces::membrane::{NodeForces, stored_energy, stress_on_fraction};
use crate::output::ledger::Ledger;
use crate::output::outcome::{AuditKind, Failure};
use crate::platform::simd::Lanes;
use crate::platform::stopwatch::Stage;

use crate::system::{FilmState, FilmSystem, Workspace};

use constraints::{Batch, Mobility};

mod constraints;
mod contacts;
mod step;
mod stored;
mod sweep;

pub use stored::{Residual, StoredXpbd};

/// The row in the table of integrators.
pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    name: "xpbd",
    meaning: "extended position-based dynamics, one pass a substep: for comparison",
    start: |system, state, workspace, cfl| Box::new(Xpbd::start(system, state, workspace, cfl)),
    lacks: &[ContactForce::Friction, ContactForce::Adhesion],
    refuses,
};

/// Substep over the stable step of central differences without gas and contact, at the same CFL number. Chosen: with
/// 8 the default CFL number leaves the paper's film so soft that its energy has no source.
pub const SUBSTEP_FACTOR: f64 = 4.0;
/// Bound of a substep over that of stability for the explicit forces. Chosen below 1.
const MAX_EXPLICIT_SHARE: f64 = 0.8;
/// Numerical dissipation below zero, over the energy moved, at which a run fails. Chosen: as the bound of central
/// differences for energy without a source.
const MAX_ENERGY_GAIN: f64 = 0.1;

/// Why the method cannot move the film of a system, but for contact; `None` if it can.
fn refuses(system: &FilmSystem) -> Option<Refusal> {
    let planes = !system.supports.bodies.is_empty();
    planes.then_some(Refusal { unknown: "rigid planes", allowed: "no support with a mass" })
}

/// Extended position-based dynamics.
#[derive(Debug, Clone)]
pub struct Xpbd {
    /// CFL number; a substep is [`SUBSTEP_FACTOR`] times longer.
    cfl: f64,
    accounting: EnergyAccounting,
    residual: Residual,
    /// The current interval, if the run was paused within one.
    step_interval: Option<StepInterval>,
    /// Forces now, and the search for contacts.
    workspace: Workspace,
    mobility: Mobility,
    batches: Vec<Batch>,
    /// Scratch: α̃ λ of each element.
    multipliers: Vec<Lanes>,
    /// Scratch: positions after a substep, m.
    next: Field,
    /// Scratch: displacements of a substep, m.
    displacements: Field,
}

impl Xpbd {
    /// Starts at a state.
    ///
    /// # Panics
    /// If it cannot move the system ([`IntegratorEntry::refusal`]).
    pub fn start(system: &FilmSystem, state: &FilmState, workspace: Workspace, cfl: f64) -> Self {
        let mut accounting = EnergyAccounting::start(system, state);
        accounting.broad_phase_rebuilds = u64::from(system.contact.is_some());
        let stored = StoredXpbd { accounting, ..StoredXpbd::default() };
        let mut xpbd = Self::with(system, state, workspace, &stored, cfl);
        xpbd.accounting.works.contact = -state.contact.stored_energy();
        xpbd.accounting.start_energy = xpbd.open_ledger(system, state).stored();
        xpbd
    }

    /// Resumes at a state with what was stored there. The run continues with the same bits.
    ///
    /// # Panics
    /// If it cannot move the system ([`IntegratorEntry::refusal`]).
    pub fn resume(system: &FilmSystem, state: &FilmState, stored: &StoredXpbd, cfl: f64) -> Self {
        let rebuilds = stored.accounting.broad_phase_rebuilds;
        let progress = SearchProgress { path_length: stored.path_length, rebuilds };
        let workspace = Workspace::resumed(system, state, progress);
        Self::with(system, state, workspace, stored, cfl)
    }

    fn with(
        system: &FilmSystem,
        state: &FilmState,
        mut workspace: Workspace,
        stored: &StoredXpbd,
        cfl: f64,
    ) -> Self {
        let refused = ENTRY.refusal(system);
        assert!(refused.is_none(), "{refused:?}");
        workspace.forces_at(system, state, None);
        let mobility = Mobility::new(system);
        let batches = Batch::all(&system.model, &mobility);
        Self {
            cfl,
            accounting: stored.accounting,
            residual: stored.residual,
            step_interval: stored.step_interval,
            workspace,
            mobility,
            multipliers: vec![Lanes::default(); batches.len()],
            batches,
            next: state.positions.clone(),
            displacements: Field::zeros(system.model.nodes()),
        }
    }

    fn advance_steps(
        &mut self,
        state: &mut FilmState,
        system: &FilmSystem,
        Interval { target, phase }: Interval<'_>,
        budget: &mut Budget<'_>,
    ) -> Result<Advance, Failure> {
        let no_advance =
            |state: &FilmState| failure(state, AuditKind::StepLimit, "the substep is too small");
        let mut interval = match self.step_interval.take() {
            Some(interval) => interval,
            None => StepInterval::new(state.time, target, self.next_step(system, state), false)
                .ok_or_else(|| no_advance(state))?,
        };
        while let Some(end) = interval.next_end() {
            if *budget.steps == 0 {
                self.step_interval = Some(interval);
                return Ok(Advance::Paused);
            }
            if self.accounting.steps >= budget.step_limit {
                let place = format!("after {} accepted steps", self.accounting.steps);
                return Err(failure(state, AuditKind::StepLimit, &place));
            }
            *budget.steps -= 1;
            interval.index += 1;
            if phase.packed && system.contact.is_none() {
                let volume = state.volume;
                let gas = system.gas_step(state, volume, interval.length, phase.inflow);
                self.accounting.commit_gas(system, state, gas, volume);
                state.time = end;
            } else {
                let span = (interval.length, end);
                self.step(system, state, span, phase.inflow, budget)?;
                budget.audit.record(system, state)?;
            }
            self.accounting.steps += 1;
        }
        budget.stopwatch.begins(Stage::Audit);
        budget.audit.complete(system, state)?;
        self.check_energy(system, state)?;
        Ok(Advance::Reached)
    }

    /// The ledger without numerical dissipation.
    fn open_ledger(&self, system: &FilmSystem, state: &FilmState) -> Ledger {
        let strain = stored_energy(&system.model, &state.creep, &self.workspace.histories);
        let nodes = system.model.mass.iter().zip(state.velocities.iter());
        let kinetic: f64 = nodes.map(|(mass, v)| 0.5 * mass * v.norm_squared()).sum();
        let ledger = self.accounting.ledger(system, state, kinetic, strain);
        let contact = state.contact.stored_energy();
        Ledger { contact, numerical_dissipation: 0.0, ..ledger }
    }

    /// Checks that no energy came without a source.
    fn check_energy(&self, system: &FilmSystem, state: &FilmState) -> Result<(), Failure> {
        let ledger = self.ledger(system, state);
        let moved = ledger.external() + ledger.kinetic + self.accounting.start_energy.abs();
        // Written so that NaN fails too.
        let has_source = -ledger.numerical_dissipation <= MAX_ENERGY_GAIN * moved;
        if has_source {
            return Ok(());
        }
        Err(failure(state, AuditKind::EnergySource, "the film's energy came without a source"))
    }
}

/// A failure at the time of a state.
fn failure(state: &FilmState, audit: AuditKind, place: &str) -> Failure {
    Failure::new(audit, state.time, place)
}

impl Integrator for Xpbd {
    fn advance(
        &mut self,
        state: &mut FilmState,
        system: &FilmSystem,
        interval: Interval<'_>,
        mut budget: Budget<'_>,
    ) -> Result<Advance, Failure> {
        let advanced = self.advance_steps(state, system, interval, &mut budget);
        let ledger = self.ledger(system, state);
        self.accounting.works.contact = -ledger.contact;
        self.accounting.works.numerical_dissipation = ledger.numerical_dissipation;
        advanced
    }

    fn next_step(&self, system: &FilmSystem, _: &FilmState) -> f64 {
        let film = SUBSTEP_FACTOR * self.cfl * 2.0 / system.model.largest_frequency();
        let terms = system.energy_terms.iter();
        // Not a sum: that of no terms is −0.
        let squared = terms.fold(0.0, |sum, term| sum + term.frequency_squared(&system.model.mass));
        film.min(MAX_EXPLICIT_SHARE * 2.0 / squared.sqrt())
    }

    fn forces(&self) -> &NodeForces {
        &self.workspace.forces
    }

    fn accounting(&self) -> &EnergyAccounting {
        &self.accounting
    }

    fn ledger(&self, system: &FilmSystem, state: &FilmState) -> Ledger {
        let ledger = self.open_ledger(system, state);
        let numerical_dissipation = -ledger.defect_since(self.accounting.start_energy);
        Ledger { numerical_dissipation, ..ledger }
    }

    fn stress_on_fraction(&self, system: &FilmSystem, fraction: f64) -> f64 {
        stress_on_fraction(&system.model, &self.workspace.histories, fraction)
    }

    fn smallest_gap(&self) -> f64 {
        self.workspace.contact.as_ref().map_or(f64::INFINITY, |contact| contact.list.smallest_gap)
    }

    fn residual(&self) -> Option<f64> {
        Some(self.residual.last)
    }

    fn stored(&self) -> Option<StoredIntegrator> {
        let progress = self.workspace.contact.as_ref().map(|contact| contact.progress);
        Some(StoredIntegrator::Xpbd(StoredXpbd {
            accounting: self.accounting,
            residual: self.residual,
            step_interval: self.step_interval,
            path_length: progress.unwrap_or_default().path_length,
        }))
    }

    fn boxed(&self) -> Box<dyn Integrator> {
        Box::new(self.clone())
    }
}
