//! Integration of a small, piecewise smooth system of ordinary differential equations:
//! Dormand-Prince 5(4), error controlled or of fixed step.
//!
//! ```text
//! dy/dt = f_b(y)        while margin_b(y) > 0;        b → next branch where margin_b = 0
//! ```
//!
//! - A call to [`Integrator::advance`] lands on its target time exactly; within it f does not
//!   depend on time, so samples, window edges and the release are targets and never lie inside a
//!   step.
//! - The branch b is constant within a step. A step that ends outside its branch is cut where the
//!   margin vanishes, so a kink of the force costs no order of accuracy.
//! - [`Stepping::Adaptive`]: the largest component error of a step, over tolerance times the scale
//!   of its group (the largest value any component of the group has had so far), is kept at or
//!   below 1. The scales begin with the least ones given at the start. The controller sees numbers of the
//!   run alone, so it is deterministic.
//! - [`Stepping::Fixed`]: the same formulas, every step as given, shortened only to land.
//! - Sums are compensated (Kahan), so a constant rate integrates to rounding whatever the number of
//!   steps. Nothing is allocated inside a step.

use crate::output::outcome::{Failure, FailureKind};
use crate::scene::Stepping;

mod step;

use step::{Trial, step};

/// Tolerance of [`Stepping::Adaptive`] to use where nobody asks for another: ledger residuals stay
/// below 1e-6.
pub const DEFAULT_TOLERANCE: f64 = 1e-9;

/// A piecewise smooth, autonomous system of N equations.
pub trait System<const N: usize> {
    /// Names one smooth piece.
    type Branch: Copy;

    /// Group of each component, below N: components of one group share one error scale.
    const GROUPS: [usize; N];

    /// f: dy/dt in a branch.
    fn rates(&self, branch: Self::Branch, state: &[f64; N]) -> [f64; N];

    /// Positive inside the branch, negative outside, smooth across its edge.
    fn margin(&self, branch: Self::Branch, state: &[f64; N]) -> f64;

    /// The branch entered by leaving `branch` at `state`.
    fn next_branch(&self, branch: Self::Branch, state: &[f64; N]) -> Self::Branch;

    /// Whether a state is one the system can be in.
    ///
    /// # Errors
    /// Kind and place of the failure, if not.
    fn check(&self, state: &[f64; N]) -> Result<(), (FailureKind, &'static str)>;
}

/// How to step, and how long at most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Control {
    /// How the step is chosen.
    pub stepping: Stepping,
    /// Accepted steps after which the run stops.
    pub step_limit: u64,
}

/// The changing part of an integration.
#[derive(Debug, Clone, PartialEq)]
pub struct Integrator<const N: usize, B> {
    /// Time, s.
    pub time: f64,
    /// y.
    pub state: [f64; N],
    /// The smooth piece the state is in.
    pub branch: B,
    /// Accepted steps so far.
    pub steps: u64,
    /// What the rounding of `state` has dropped so far.
    carry: [f64; N],
    /// Largest magnitude so far, by group.
    scales: [f64; N],
    /// Step the controller would take next, s; 0 before the first.
    next_step: f64,
}

/// Share of the way to the first target that the first trial step takes.
const FIRST_STEP: f64 = 1e-3;
/// A remaining way this close to one step is taken in one, that no sliver is left.
const LANDING_SLACK: f64 = 1.0 + 1e-9;
/// Share of the target time below which a step does not advance it, even from time 0.
const SMALLEST_STEP: f64 = 1e-18;
/// Part of a step, relative, to which the edge of a branch is located.
const EDGE_TOLERANCE: f64 = 1e-14;

impl<const N: usize, B: Copy> Integrator<N, B> {
    /// Starts at a time (s), a state and the branch that state is in. `scales` by group: the error
    /// scales a run that starts from nothing begins with; 0 for none.
    pub fn new(time: f64, state: [f64; N], branch: B, scales: [f64; N]) -> Self {
        Self { time, state, branch, steps: 0, carry: [0.0; N], scales, next_step: 0.0 }
    }

    /// Integrates to `target` (s) exactly, calling `accepted` with the state after every step.
    ///
    /// # Errors
    /// [`Failure`] when the state leaves what [`System::check`] allows
    /// ([`FailureKind::InvertedVolume`], …), is no longer finite ([`FailureKind::Unstable`]), or
    /// the steps run out or no longer advance time ([`FailureKind::StepLimit`]). Time and state are
    /// those of the last accepted step.
    pub fn advance<S: System<N, Branch = B>>(
        &mut self,
        system: &S,
        target: f64,
        control: &Control,
        accepted: &mut dyn FnMut(&[f64; N]),
    ) -> Result<(), Failure> {
        let mut rates = system.rates(self.branch, &self.state);
        while self.time < target {
            if self.steps >= control.step_limit {
                let place = format!("after {} accepted steps", self.steps);
                return Err(self.failure(FailureKind::StepLimit, place));
            }
            let mut trial = self.trial(system, &rates, target, control)?;
            let leaves = system.margin(self.branch, &trial.state) < 0.0;
            if leaves {
                trial = self.to_edge(system, &rates, trial);
            }
            let landed = !leaves && trial.length >= target - self.time;
            self.accept::<S>(&trial, if landed { Some(target) } else { None });
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
        Ok(())
    }

    /// A step that meets the tolerance (adaptive) or has the given length (fixed), and is finite.
    fn trial<S: System<N, Branch = B>>(
        &mut self,
        system: &S,
        rates: &[f64; N],
        target: f64,
        control: &Control,
    ) -> Result<Trial<N>, Failure> {
        let rest = target - self.time;
        let take = |length: f64| step(|y| system.rates(self.branch, y), &self.state, rates, length);
        match control.stepping {
            Stepping::Fixed(length) => {
                let trial = take(self.representable(length, rest));
                if trial.is_finite() {
                    Ok(trial)
                } else {
                    Err(self.failure(FailureKind::Unstable, "state of the fixed step".to_owned()))
                }
            }
            Stepping::Stable(_) => unreachable!("no model integrated here has a stable step"),
            Stepping::Adaptive(tolerance) => {
                let mut wish =
                    if self.next_step > 0.0 { self.next_step } else { FIRST_STEP * rest };
                let mut rejected = false;
                loop {
                    let length = self.representable(wish, rest);
                    if self.time + length <= self.time || length < SMALLEST_STEP * target.abs() {
                        let (kind, place) = if take(wish).is_finite() {
                            (FailureKind::StepLimit, "step too small to advance time")
                        } else {
                            (FailureKind::Unstable, "state not finite at the smallest step")
                        };
                        return Err(self.failure(kind, place.to_owned()));
                    }
                    let trial = take(length);
                    let error = self.error::<S>(&trial, tolerance);
                    if error <= 1.0 {
                        let grown = length * growth(error, rejected);
                        // A step cut short to land says little of the next one.
                        self.next_step = if length < wish { grown.max(wish) } else { grown };
                        return Ok(trial);
                    }
                    rejected = true;
                    // From the wish: rounding to representable times could undo a shrunken length.
                    wish = wish.min(length) * growth(error, true);
                }
            }
        }
    }

    /// The step nearest to the wish that ends on a representable time, or on the target.
    fn representable(&self, wish: f64, rest: f64) -> f64 {
        if rest <= wish * LANDING_SLACK { rest } else { (self.time + wish) - self.time }
    }

    /// Largest error of a trial over what is tolerated; infinite where the trial is not finite.
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

    /// Cuts a trial that leaves the branch to where its margin vanishes (secant, safeguarded by
    /// bisection; ends on the outer side of the edge).
    fn to_edge<S: System<N, Branch = B>>(
        &self,
        system: &S,
        rates: &[f64; N],
        outside: Trial<N>,
    ) -> Trial<N> {
        let full = outside.length;
        // A step that begins on an edge may lie beyond it by rounding: it counts as inside, so that
        // a branch just entered is left where it ends, and one wrongly entered at once.
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
            let sound = !bisect && secant > inner && secant < outer;
            let length = if sound { secant } else { middle };
            let trial = step(|y| system.rates(self.branch, y), &self.state, rates, length);
            let margin = system.margin(self.branch, &trial.state);
            if margin > 0.0 {
                (inner, inner_margin) = (length, margin);
            } else {
                best = trial;
                (outer, outer_margin) = (length, margin);
            }
            // A margin that starts near zero, rises and falls fools the secant again and again.
            bisect = !bisect && outer - inner > 0.5 * width;
        }
        best
    }

    fn accept<S: System<N>>(&mut self, trial: &Trial<N>, landing: Option<f64>) {
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
        self.time = landing.unwrap_or(self.time + trial.length);
        self.steps += 1;
    }

    fn failure(&self, kind: FailureKind, place: String) -> Failure {
        Failure { kind, time: self.time, place }
    }
}

fn grow_scales<const N: usize, S: System<N>>(scales: &mut [f64; N], state: &[f64; N]) {
    for (value, group) in state.iter().zip(S::GROUPS) {
        scales[group] = scales[group].max(value.abs());
    }
}

/// Factor from one step to the next: error^(−1/5) with a margin, within [0.2, 5].
fn growth(error: f64, rejected: bool) -> f64 {
    let largest = if rejected { 1.0 } else { 5.0 };
    if error == 0.0 { largest } else { (0.9 * libm::pow(error, -0.2)).clamp(0.2, largest) }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests;
