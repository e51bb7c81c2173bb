//! Newton's method for the positions after a step.
//!
//! ```text
//! Φ(x) = Π(x) + ½ w (x − x̂)·M (x − x̂)            minimal at the positions after the step
//! A d = −∂Φ/∂x        x ← x + α d                 Φ falls by at least 1e-4 of its slope
//! ```
//!
//! Symbols: Π energy of film, gas, contact and loads; w and x̂ from the method (`super::method`). α is at most the
//! share of d that brings no film into film, from the first positions on. In long steps gas and creep strain of Π are
//! those at the positions found so far ([`Increment::follow`]).

use super::increment::Increment;
use super::linear_system::LinearSystem;
use crate::factorisation::unknowns::dot;
use crate::geometry::field::Field;
use crate::system::{Evaluation, FilmState, FilmSystem, Workspace};

/// Fall of Φ over its slope times α that a step must reach. Chosen (L. Armijo, 1966).
const MIN_FALL: f64 = 1e-4;
/// Slope after a step over that before it at which the step counts where Φ has no more digits. Chosen.
const MAX_SLOPE_RATIO: f64 = 0.9;
/// Rounding of Φ over its magnitude.
const ROUNDING: f64 = 1e-11;
/// Halvings of α. Chosen.
const MAX_HALVINGS: u32 = 10;
/// Largest displacement of a Newton step over the size of the film. Chosen.
const MAX_DISPLACEMENT: f64 = 0.1;
/// Smallest α: shorter steps do not arrive. Chosen.
const MIN_SHARE: f64 = 1e-3;

/// What ends the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limits {
    /// Largest mean displacement (m) of the next Newton step at which the positions are those after the step.
    pub(super) displacement: f64,
    /// Largest mean displacement (m) of the first Newton step from the guess: a larger one says that the error of
    /// the step will be too large.
    pub(super) first: f64,
    /// Most Newton steps.
    pub(super) iterations: u32,
}

/// Positions and their evaluation. The workspace has their forces and contacts.
#[derive(Debug, Clone)]
pub(in crate::integrators) struct Newton {
    pub(super) system: LinearSystem,
    /// Positions that the order of elimination is of, m: with another order the bits would differ.
    pub(super) ordered_at: Field,
    pub(super) positions: Field,
    trial: Field,
    moves: Field,
}

impl Newton {
    /// For film whose order of elimination is that of some positions (m).
    pub(in crate::integrators) fn new(
        system: &FilmSystem,
        state: &FilmState,
        ordered_at: Field,
    ) -> Self {
        let zeros = || Field::zeros(state.positions.len());
        let system = LinearSystem::new(system, state, &ordered_at);
        Self { system, ordered_at, positions: zeros(), trial: zeros(), moves: zeros() }
    }

    /// Finds the positions after a step: from those of the state, or from these displacements (m) away if Φ is
    /// smaller there. Returns their evaluation and the number of Newton steps; `None` if it finds none.
    pub(super) fn solve(
        &mut self,
        increment: &mut Increment<'_>,
        guess: &Field,
        limits: Limits,
        workspace: &mut Workspace,
    ) -> Option<(Evaluation, u32)> {
        let Increment { system, end, weight, .. } = *increment;
        increment.load_at_start();
        self.positions.copy_from(&increment.from.positions);
        let (_, before) = increment.evaluate(&mut self.positions, workspace);
        self.moves.copy_from(guess);
        let (mut evaluation, mut potential) = self.guess(increment, before, workspace);
        let at_guess = potential < before;
        let is_long = increment.is_long();
        let fewest = if is_long { 2 } else { 1 };
        if at_guess && is_long {
            (evaluation, potential) =
                increment.follow(&mut self.positions, evaluation.volume, workspace);
        }
        for iteration in 1..=limits.iterations {
            let at = (&self.positions, end);
            let here = (&evaluation, &*workspace);
            let residual =
                increment.residual(&self.system, &self.positions, &evaluation, workspace);
            if !self.system.prepare(system, &increment.state, at, here, weight) {
                return None;
            }
            let step = self.system.solve(system, &residual);
            let slope = dot(&step, &residual);
            let finite = slope.is_finite() && slope >= 0.0;
            if !finite {
                return None;
            }
            for node in 0..self.moves.len() {
                self.moves.set(node, self.system.unknowns.displacement(node, &step));
            }
            let mean = self.mean(&step);
            if iteration == 1 && at_guess && mean > limits.first {
                return None;
            }
            let largest = self.system.unknowns.largest(&step);
            let most = (MAX_DISPLACEMENT * system.model.size() / largest).min(1.0);
            let share = most * self.safe_share(increment, most, workspace);
            if share < MIN_SHARE {
                return None;
            }
            let small = mean <= limits.displacement && share >= 1.0;
            let found = self.line_search(increment, (potential, slope, share), &step, workspace)?;
            core::mem::swap(&mut self.positions, &mut self.trial);
            (evaluation, potential) = found;
            if small && iteration >= fewest {
                return self.is_safe(increment, workspace).then_some((evaluation, iteration));
            }
            if is_long {
                (evaluation, potential) =
                    increment.follow(&mut self.positions, evaluation.volume, workspace);
            }
        }
        None
    }

    /// Moves to the guess as far as that is safe, if Φ is smaller there.
    fn guess(
        &mut self,
        increment: &Increment<'_>,
        potential: f64,
        workspace: &mut Workspace,
    ) -> (Evaluation, f64) {
        let share = self.safe_share(increment, 1.0, workspace);
        self.shift(share);
        let (evaluation, there) = increment.evaluate(&mut self.trial, workspace);
        if there < potential {
            core::mem::swap(&mut self.positions, &mut self.trial);
            return (evaluation, there);
        }
        // The workspace has to hold the forces of the positions.
        increment.evaluate(&mut self.positions, workspace)
    }

    /// Share of `most` times the displacements that brings no film into film.
    fn safe_share(&self, increment: &Increment<'_>, most: f64, workspace: &mut Workspace) -> f64 {
        let Increment { system, end, .. } = *increment;
        if system.contact.is_none() {
            return 1.0;
        }
        let at = (&self.positions, end);
        if most >= 1.0 {
            return system.safe_step(at, &self.moves, workspace);
        }
        let scaled: Vec<_> = self.moves.iter().map(|u| u * most).collect();
        system.safe_step(at, &Field::of(&scaled), workspace)
    }

    /// Whether the straight motion from the start to the positions brings no film into film. Leaves the workspace with
    /// the forces of the positions.
    fn is_safe(&mut self, increment: &Increment<'_>, workspace: &mut Workspace) -> bool {
        let Increment { system, from, end, .. } = *increment;
        if system.contact.is_none() {
            return true;
        }
        for node in 0..self.moves.len() {
            self.moves.set(node, self.positions.get(node) - from.positions.get(node));
        }
        let share = system.safe_step((&from.positions, end), &self.moves, workspace);
        let _ = increment.evaluate(&mut self.positions, workspace);
        share >= 1.0
    }

    /// Sets the trial positions this share of the displacements away.
    fn shift(&mut self, share: f64) {
        for node in 0..self.moves.len() {
            self.trial.set(node, self.positions.get(node) + self.moves.get(node) * share);
        }
    }

    fn line_search(
        &mut self,
        increment: &Increment<'_>,
        (potential, slope, share): (f64, f64, f64),
        step: &[f64],
        workspace: &mut Workspace,
    ) -> Option<(Evaluation, f64)> {
        let mut share = share;
        for _ in 0..MAX_HALVINGS {
            self.shift(share);
            let (evaluation, there) = increment.evaluate(&mut self.trial, workspace);
            if there <= potential - MIN_FALL * share * slope {
                return Some((evaluation, there));
            }
            if there <= potential + ROUNDING * potential.abs() {
                let trial = &self.trial;
                let residual = increment.residual(&self.system, trial, &evaluation, workspace);
                if dot(step, &residual).abs() <= MAX_SLOPE_RATIO * slope {
                    return Some((evaluation, there));
                }
            }
            share *= 0.5;
        }
        None
    }

    /// Mean displacement √(Σ m d²/Σ m), m.
    fn mean(&self, step: &[f64]) -> f64 {
        let mass = &self.system.unknowns.mass;
        let sum: f64 = step.iter().zip(mass).map(|(d, mass)| mass * d * d).sum();
        (sum / mass.iter().sum::<f64>()).sqrt()
    }
}
