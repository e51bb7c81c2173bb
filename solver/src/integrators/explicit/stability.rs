//! What a step must not do: leave the finite numbers, exceed the stable step of stretched film, or stretch
//! the film beyond its material model.
//!
//! ```text
//! ω² ≤ ω_film² (1 + 3 S1/E)              in-plane frequency of film stretched by the stress S1
//! S1 ≤ 4 E                               e1 = 4: film at three times its length
//! ```
//!
//! The tangent of St. Venant-Kirchhoff film along a stretch λ is λ² C + S, with λ² = 1 + 2 e and e ≤ S1/E: at
//! most C (1 + 3 S1/E). A node may be faster than the waves of its film: soft film under gas is.

use super::motion::StepInterval;
use super::{Explicit, FilmModel, failure};
use crate::integrators::interface::Integrator as _;
use crate::mechanics::material::MAX_STRESS_RATIO;
use crate::mechanics::resultants::stretches;
use crate::output::audit::MAX_LEDGER_RESIDUAL;
use crate::output::outcome::{AuditKind, Failure, FailureKind};
use crate::system::{FilmState, FilmSystem};

/// Growth of ω² with S1/E. Source: the tangent above.
const STIFFENING: f64 = 3.0;
/// S1/E above which the step follows the stretch. Chosen: film of high modulus is far below it, and the
/// margin of the CFL number covers it.
const MIN_STRETCHED: f64 = 0.25;
/// Step over the longest step at which an interval is planned again. Chosen: a growing stretch then does not
/// plan every step.
const MAX_STEP_RATIO: f64 = 1.1;

/// Whether a displacement (m) in one step is larger than the film, or not finite.
pub(super) fn moves_too_far(model: &FilmModel, displacement: f64) -> bool {
    let within = displacement <= model.size();
    !within
}

/// Upper bound of the energy defect over the energy moved within a step, whose works are not complete.
/// Chosen: far above the works of one step, far below what an unstable step adds.
const MAX_PARTIAL_DEFECT: f64 = 0.1;

impl Explicit {
    /// S1/E now.
    fn stress_ratio(&self, system: &FilmSystem) -> f64 {
        // Written so that NaN counts as no stress: the volume is NaN too, and is checked.
        (self.largest_stress / system.model.material.youngs_modulus).max(0.0)
    }

    /// Upper bound of ω² of the film as it is stretched now, rad²/s²; that of the film at rest below
    /// [`MIN_STRETCHED`].
    pub(super) fn stretched_squared(&self, system: &FilmSystem) -> f64 {
        let film = system.model.largest_frequency();
        let ratio = self.stress_ratio(system);
        let at_rest = film * film;
        if ratio > MIN_STRETCHED { at_rest * (1.0 + STIFFENING * ratio) } else { at_rest }
    }

    /// Whether the steps of an interval are too long for the film as it is stretched now.
    pub(super) fn step_too_long(
        &self,
        system: &FilmSystem,
        state: &FilmState,
        interval: &StepInterval,
    ) -> bool {
        !interval.quiescent
            && self.stress_ratio(system) > MIN_STRETCHED
            && interval.length > MAX_STEP_RATIO * self.stable_step(system, state)
    }

    /// Checks a step whose largest displacement (m) and volume (m³) after it are these.
    pub(super) fn check_finite(
        &self,
        system: &FilmSystem,
        state: &FilmState,
        displacement: f64,
        volume: f64,
    ) -> Result<(), Failure> {
        if !moves_too_far(&system.model, displacement) && volume.is_finite() {
            return Ok(());
        }
        Err(self.unstable(
            state,
            AuditKind::FiniteMotion,
            "farther than the size of the film in one step",
        ))
    }

    /// Checks the energy after a step with this largest speed (m/s), where it is above that of the film's
    /// waves.
    pub(super) fn check_source(
        &self,
        system: &FilmSystem,
        state: &FilmState,
        speed: f64,
    ) -> Result<(), Failure> {
        if speed <= system.model.wave_speed() || self.energy_has_source(system, state) {
            return Ok(());
        }
        Err(self.unstable(state, AuditKind::EnergySource, "its energy came without a source"))
    }

    fn unstable(&self, state: &FilmState, audit: AuditKind, problem: &str) -> Failure {
        let (node, speed) = self.fastest_node();
        let place = format!("node {node} moves at {speed:.3e} m/s: {problem}");
        failure(state, audit, &place)
    }

    /// The fastest node and its speed, m/s. NaN counts as the fastest.
    fn fastest_node(&self) -> (usize, f64) {
        let speed = |node: usize| self.motion.velocities.get(node).norm();
        let fastest = (0..self.motion.velocities.len())
            .fold(0, |fastest, node| if speed(node) <= speed(fastest) { fastest } else { node });
        (fastest, speed(fastest))
    }

    /// Whether the external works cover kinetic and elastic energy. Contact that gave energy is no source.
    fn energy_has_source(&self, system: &FilmSystem, state: &FilmState) -> bool {
        let ledger = self.ledger(system, state);
        let works =
            ledger.gas_work + ledger.ambient_work + ledger.gravity_work + ledger.support_work;
        let excess = ledger.kinetic + ledger.strain - self.motion.accounting.start_energy - works;
        excess <= MAX_PARTIAL_DEFECT * (ledger.external() + self.motion.accounting.start_energy)
    }

    /// Whether the energy ledger now closes to this fraction of the energy moved.
    fn energy_balances(&self, system: &FilmSystem, state: &FilmState, fraction: f64) -> bool {
        let ledger = self.ledger(system, state);
        let defect = ledger.defect_since(self.motion.accounting.start_energy).abs();
        defect <= fraction * (ledger.kinetic + ledger.external())
    }

    /// The failure of a gas volume that is not above 0: by an unstable step if energy came without a source.
    pub(super) fn inverted_volume(&self, system: &FilmSystem, state: &FilmState) -> Failure {
        if self.energy_balances(system, state, MAX_PARTIAL_DEFECT) {
            return failure(state, AuditKind::Volume, "gas volume");
        }
        let (node, speed) = self.fastest_node();
        let place = format!(
            "node {node} moves at {speed:.3e} m/s: the gas volume is negative, and energy came without a source"
        );
        failure(state, AuditKind::EnergySource, &place)
    }

    /// Checks the stretch of the film after a step. Film that stretched by itself has a balanced ledger.
    pub(super) fn check_stretch(
        &self,
        system: &FilmSystem,
        state: &FilmState,
    ) -> Result<(), Failure> {
        if self.stress_ratio(system) <= MAX_STRESS_RATIO {
            return Ok(());
        }
        let [_, (stretch, element)] = stretches(&system.model, &state.positions);
        let balanced = self.energy_balances(system, state, MAX_LEDGER_RESIDUAL);
        let node = system.model.triangles[element][0];
        let place =
            format!("node {node}, element {element}: stretched to {stretch:.2} times its length");
        let kind = if balanced { FailureKind::Overstretched } else { FailureKind::Unstable };
        Err(Failure { kind, ..failure(state, AuditKind::Stretch, &place) })
    }
}
