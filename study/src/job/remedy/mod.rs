//! What to do about a run that failed: which numerical settings to change, and what only its user can decide.
//!
//! ```text
//! applicable   leaves the physics alone: a smaller CFL number, another integrator, error-controlled steps
//! proposed     changes the result or its cost: loss, mesh, material, model, gas, limits
//! ```
//! The table ([`remedies`]) is a pure function of the failure and of the settings of its scene. It has what the map
//! of failure (docs/guide/stability.md) shows to work. [`next`] goes through it one run after another.

mod change;
mod failure;
mod table;

pub use change::{Change, changes, text};
pub use failure::Failure;
pub use table::remedies;

use billow_solver::scene::Solver;

/// Remedies that are applied to a point one after another, at most. Chosen: with half the step each, the last run takes
/// eight times the steps, and the three together fourteen times.
pub const MAX_REMEDIES: usize = 3;
/// Factor by which a smaller CFL number is smaller. Chosen: one such step cures most drift, at twice the steps.
pub const CFL_FACTOR: f64 = 0.5;

/// A change of a numerical setting, and why it helps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Remedy {
    /// The change.
    pub change: Change,
    /// Why, one sentence.
    pub reason: &'static str,
}

/// What can be done about a failure, the best first.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Remedies {
    /// What leaves the physics alone.
    pub applicable: Vec<Remedy>,
    /// What only the user can decide, one sentence each.
    pub proposed: Vec<&'static str>,
}

/// The settings of the next run of a point, and why they help; `None` when no remedy remains. `runs` are the settings and
/// failures of its runs so far, the planned one first. The remedies of the last failure come first, then those of the
/// failures before it. Settings that were tried are left out.
pub fn next(runs: &[(Solver, Failure)]) -> Option<(Solver, &'static str)> {
    if runs.len() > MAX_REMEDIES {
        return None;
    }
    let tried = |solver: &Solver| runs.iter().any(|(known, _)| known == solver);
    let candidates = runs.iter().rev().flat_map(|(solver, failure)| {
        let applicable = remedies(failure, solver).applicable.into_iter();
        applicable.map(|remedy| (remedy.change.applied(solver), remedy.reason))
    });
    candidates.into_iter().find(|(solver, _)| !tried(solver))
}

#[cfg(test)]
mod tests;
