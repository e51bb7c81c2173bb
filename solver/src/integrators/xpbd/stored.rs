//! What the method keeps from one substep to the next, beside the state of the film.

use serde::{Deserialize, Serialize};

use crate::integrators::energy_accounting::EnergyAccounting;
use crate::integrators::explicit::motion::StepInterval;

/// What one pass of projections leaves: √Σ (C + α̃ λ)² / √Σ (C² + (α̃ λ)²) over all elements, from 0 (every
/// constraint is met, and the substep is one of the implicit Euler method) to 1.4. Unlike a ledger it is measured,
/// not booked.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Residual {
    /// Of the last substep; 0 where no element carries tension.
    pub last: f64,
    /// Largest so far.
    pub largest: f64,
    /// Sum over all substeps with tension.
    pub sum: f64,
    /// Number of those substeps.
    pub count: u64,
}

impl Residual {
    /// Mean over all substeps with tension; 0 before the first.
    pub fn mean(&self) -> f64 {
        if self.count == 0 { 0.0 } else { self.sum / self.count as f64 }
    }

    /// Adds a substep with these sums of squares, J.
    pub(super) fn add(&mut self, residual: f64, size: f64) {
        self.last = 0.0;
        if size > 0.0 {
            self.last = (residual / size).sqrt();
            self.largest = self.largest.max(self.last);
            self.sum += self.last;
            self.count += 1;
        }
    }
}

/// Everything of the method that a checkpoint stores.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredXpbd {
    /// Energy accounting since time 0.
    pub accounting: EnergyAccounting,
    /// What the projections left.
    pub residual: Residual,
    /// The current interval, if the run was paused within one.
    pub step_interval: Option<StepInterval>,
    /// Path length of the search for contacts, m.
    pub path_length: f64,
}
