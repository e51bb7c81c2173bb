//! Dormand-Prince 5(4) for small, piecewise smooth systems of ordinary differential equations, with error
//! control or a fixed step.
//!
//! ```text
//! dy/dt = f_b(y)        while margin_b(y) > 0;        b → next branch where margin_b = 0
//! ```
//!
//! - [`Integrator::advance`] reaches its target time exactly. f does not depend on time within a call:
//!   samples, edges of inflow windows and the release are targets, so they never lie inside a step.
//! - The branch b is constant within a step. A step that ends outside its branch is cut where the
//!   margin vanishes, so a kink of the force does not reduce the order of accuracy.
//! - [`Stepping::Adaptive`]: the error of each component, divided by tolerance times the scale of its
//!   group, is at most 1 in every step. The scale of a group is the largest magnitude of its components
//!   so far, and at least the initial scale. The controller uses numbers of the run only, so it is
//!   deterministic.
//! - [`Stepping::Fixed`]: the same formulas with the given step, shortened only to reach the target.
//! - Sums are compensated (Kahan), so a constant rate integrates exactly up to rounding for any number of
//!   steps. A step allocates no memory.

use crate::output::outcome::{AuditKind, Failure};
use crate::scene::Stepping;

mod step;

use step::{Trial, step};

/// Default tolerance of [`Stepping::Adaptive`]. Chosen: ledger residuals stay below 1e-6.
pub const DEFAULT_TOLERANCE: f64 = 1e-9;

/// A piecewise smooth, autonomous system of N equations.
pub trait System<const N: usize> {
    /// Name of a smooth piece.
    type Branch: Copy;

    /// Group of each component, below N. The components of a group share one error scale.
    const GROUPS: [usize; N];

    /// f = dy/dt in a branch.
    fn rates(&self, branch: Self::Branch, state: &[f64; N]) -> [f64; N];

    /// Positive inside the branch, negative outside, smooth across its edge.
    fn margin(&self, branch: Self::Branch, state: &[f64; N]) -> f64;

    /// The next branch if the state leaves `branch` at `state`.
    fn next_branch(&self, branch: Self::Branch, state: &[f64; N]) -> Self::Branch;

    /// Checks whether a state is valid.
    fn check(&self, state: &[f64; N]) -> Result<(), (AuditKind, &'static str)>;
}

/// Choice of the step, and the limit of steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Control {
    /// How the step is chosen.
    pub stepping: Stepping,
    /// Accepted steps after which the run fails with `step_limit`.
    pub step_limit: u64,
}

/// State of an integration.
#[derive(Debug, Clone, PartialEq)]
pub struct Integrator<const N: usize, B> {
    /// Time, s.
    pub time: f64,
    /// State y.
    pub state: [f64; N],
    /// Branch of the state.
    pub branch: B,
    /// Accepted steps so far.
    pub steps: u64,
    /// Rounding error of `state` so far (Kahan).
    carry: [f64; N],
    /// Largest magnitude so far, by group.
    scales: [f64; N],
    /// Next step of the controller, s; 0 before the first.
    next_step: f64,
    /// Rates at the end of the last step, if the integration was paused there.
    paused_rates: Option<[f64; N]>,
}

/// First trial step over the time to the first target. Chosen.
const FIRST_STEP_FRACTION: f64 = 1e-3;
/// Upper bound of the remaining time over a step that one step may cover. Chosen: avoids a tiny last step.
const MAX_LAST_STEP_RATIO: f64 = 1.0 + 1e-9;
/// Lower bound of a step over the target time. Chosen: a smaller step advances nothing, even from time 0.
const MIN_STEP_FRACTION: f64 = 1e-18;
/// Tolerance of the edge of a branch, as a fraction of the step. Chosen.
const EDGE_TOLERANCE: f64 = 1e-14;

impl<const N: usize, B: Copy> Integrator<N, B> {
    /// An integration at this time (s), with this state and its branch. `scales`: initial error scale of each
    /// group; 0 if there is none.
    pub fn new(time: f64, state: [f64; N], branch: B, scales: [f64; N]) -> Self {
        Self {
            time,
            state,
            branch,
            steps: 0,
            carry: [0.0; N],
            scales,
            next_step: 0.0,
            paused_rates: None,
        }
    }

    /// Integrates to exactly `target` (s) and calls `accepted` with the state after every step.
    ///
    /// # Errors
    /// [`Failure`] if [`System::check`] refuses the state ([`AuditKind::Volume`], …), if it is not
    /// finite ([`AuditKind::FiniteMotion`]), or if the steps run out or are too small to advance time
    /// ([`AuditKind::StepLimit`]). Time and state are those of the last accepted step.
    pub fn advance<S: System<N, Branch = B>>(
        &mut self,
        system: &S,
        target: f64,
        control: &Control,
        accepted: &mut dyn FnMut(&[f64; N]),
    ) -> Result<(), Failure> {
        self.advance_at_most(system, target, control, &mut u64::MAX.clone(), accepted).map(|_| ())
    }

    /// Integrates towards `target` (s) by at most `steps` accepted steps, and subtracts the steps taken from
    /// `steps`. Returns whether it reached the target. A pause changes no bit.
    pub fn advance_at_most<S: System<N, Branch = B>>(
        &mut self,
        system: &S,
        target: f64,
        control: &Control,
        steps: &mut u64,
        accepted: &mut dyn FnMut(&[f64; N]),
    ) -> Result<bool, Failure> {
        let paused = self.paused_rates.take();
        let mut rates = paused.unwrap_or_else(|| system.rates(self.branch, &self.state));
        while self.time < target {
            if *steps == 0 {
                self.paused_rates = Some(rates);
                return Ok(false);
            }
            if self.steps >= control.step_limit {
                let place = format!("after {} accepted steps", self.steps);
                return Err(self.failure(AuditKind::StepLimit, place));
            }
            *steps -= 1;
            let mut trial = self.trial(system, &rates, target, control)?;
            let leaves = system.margin(self.branch, &trial.state) < 0.0;
            if leaves {
                trial = self.to_edge(system, &rates, trial);
            }
            let reaches_target = !leaves && trial.length >= target - self.time;
            self.accept::<S>(&trial, if reaches_target { Some(target) } else { None });
            if let Err((kind, place)) = system.check(&self.state) {
                return Err(self.failure(kind, place.to_owned()));
            }
            rates = if leaves {
                self.branch = system.next_branch(self.branch, &self.state);
                system.rates(self.branch, &self.state)
            } else {
                trial.last_rates
            };
            accepted(&self.state);
        }
        Ok(true)
    }

    /// A finite step that meets the tolerance (adaptive) or has the given length (fixed).
    fn trial<S: System<N, Branch = B>>(
        &mut self,
        system: &S,
        rates: &[f64; N],
        target: f64,
        control: &Control,
    ) -> Result<Trial<N>, Failure> {
        let remaining = target - self.time;
        let take = |length: f64| step(|y| system.rates(self.branch, y), &self.state, rates, length);
        match control.stepping {
            Stepping::Fixed(length) => {
                let trial = take(self.representable(length, remaining));
                if trial.is_finite() {
                    Ok(trial)
                } else {
                    Err(self
                        .failure(AuditKind::FiniteMotion, "state after the fixed step".to_owned()))
                }
            }
            Stepping::Stable(_) => unreachable!("no model integrated here has a stable step"),
            Stepping::Adaptive(tolerance) => {
                let mut desired = if self.next_step > 0.0 {
                    self.next_step
                } else {
                    FIRST_STEP_FRACTION * remaining
                };
                let mut rejected = false;
                loop {
                    let length = self.representable(desired, remaining);
                    if self.time + length <= self.time || length < MIN_STEP_FRACTION * target.abs()
                    {
                        let (kind, place) = if take(desired).is_finite() {
                            (AuditKind::StepLimit, "the step is too small to advance time")
                        } else {
                            (
                                AuditKind::FiniteMotion,
                                "the state is not finite at the smallest step",
                            )
                        };
                        return Err(self.failure(kind, place.to_owned()));
                    }
                    let trial = take(length);
                    let error = self.error::<S>(&trial, tolerance);
                    if error <= 1.0 {
                        let grown = length * growth(error, rejected);
                        // A step shortened to reach the target does not shorten the next one.
                        self.next_step = if length < desired { grown.max(desired) } else { grown };
                        return Ok(trial);
                    }
                    rejected = true;
                    // From the desired step: rounding to representable times could undo the reduction.
                    desired = desired.min(length) * growth(error, true);
                }
            }
        }
    }

    /// The step nearest to the desired one that ends at a representable time, or at the target.
    fn representable(&self, desired: f64, remaining: f64) -> f64 {
        if remaining <= desired * MAX_LAST_STEP_RATIO {
            remaining
        } else {
            (self.time + desired) - self.time
        }
    }

    /// Largest error of a trial over its tolerance; infinite if the trial is not finite.
    fn error<S: System<N>>(&self, trial: &Trial<N>, tolerance: f64) -> f64 {
        if !trial.is_finite() {
            return f64::INFINITY;
        }
        let mut scales = self.scales;
        grow_scales::<N, S>(&mut scales, &self.state);
        grow_scales::<N, S>(&mut scales, &trial.state);
        let mut largest = 0.0_f64;
        for (error, group) in trial.error.iter().zip(S::GROUPS) {
            if *error != 0.0 {
                largest = largest.max(error.abs() / (tolerance * scales[group]));
            }
        }
        largest
    }

    /// Shortens a trial that leaves the branch so that its margin vanishes. Secant method with bisection;
    /// ends just outside the edge.
    fn to_edge<S: System<N, Branch = B>>(
        &self,
        system: &S,
        rates: &[f64; N],
        outside: Trial<N>,
    ) -> Trial<N> {
        let full = outside.length;
        // A step that begins on an edge may begin outside by rounding. It counts as inside, so that the
        // step ends at the other edge of a branch just entered, or at once if the branch is wrong.
        let start_margin = system.margin(self.branch, &self.state).max(0.0);
        let (mut inner, mut inner_margin) = (0.0, start_margin);
        let (mut outer, mut outer_margin) = (full, system.margin(self.branch, &outside.state));
        let mut best = outside;
        let mut bisect = false;
        while outer - inner > EDGE_TOLERANCE * full && outer_margin < 0.0 {
            let width = outer - inner;
            let secant =
                (inner * outer_margin - outer * inner_margin) / (outer_margin - inner_margin);
            let middle = inner + 0.5 * width;
            if middle <= inner || middle >= outer {
                break;
            }
            let use_secant = !bisect && secant > inner && secant < outer;
            let length = if use_secant { secant } else { middle };
            let trial = step(|y| system.rates(self.branch, y), &self.state, rates, length);
            let margin = system.margin(self.branch, &trial.state);
            if margin > 0.0 {
                (inner, inner_margin) = (length, margin);
            } else {
                best = trial;
                (outer, outer_margin) = (length, margin);
            }
            // The secant converges slowly if the margin starts near zero, rises and falls.
            bisect = !bisect && outer - inner > 0.5 * width;
        }
        best
    }

    fn accept<S: System<N>>(&mut self, trial: &Trial<N>, end: Option<f64>) {
        grow_scales::<N, S>(&mut self.scales, &self.state);
        grow_scales::<N, S>(&mut self.scales, &trial.state);
        for ((value, carry), increment) in
            self.state.iter_mut().zip(&mut self.carry).zip(&trial.increment)
        {
            let corrected = increment - *carry;
            let sum = *value + corrected;
            *carry = (sum - *value) - corrected;
            *value = sum;
        }
        self.time = end.unwrap_or(self.time + trial.length);
        self.steps += 1;
    }

    fn failure(&self, audit: AuditKind, place: String) -> Failure {
        Failure::new(audit, self.time, place)
    }
}

fn grow_scales<const N: usize, S: System<N>>(scales: &mut [f64; N], state: &[f64; N]) {
    for (value, group) in state.iter().zip(S::GROUPS) {
        scales[group] = scales[group].max(value.abs());
    }
}

/// Ratio of the next step to this one: 0.9 error^(−1/5), limited to 0.2…5, or to 0.2…1 after a rejection
/// (E. Hairer, S. Nørsett, G. Wanner, "Solving Ordinary Differential Equations I", II.4).
fn growth(error: f64, rejected: bool) -> f64 {
    let largest = if rejected { 1.0 } else { 5.0 };
    if error == 0.0 { largest } else { (0.9 * libm::pow(error, -0.2)).clamp(0.2, largest) }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests;
