//! Length of the steps.
//!
//! ```text
//! e ≤ 1e-4 (CFL/0.45)³ L f        h' = h min(2, max(0.3, 0.9 (e_allowed/e)^(1/k)))        k = 3; first step 2
//! ```
//!
//! Symbols: e mean error of a step; L size of the film; f factor of the caller, 1 for a run that is implicit
//! throughout. The error of a step goes with the cube of its length, so the length goes with the CFL number, as that
//! of explicit steps does.

use serde::{Deserialize, Serialize};

use crate::scene::DEFAULT_CFL;

/// Error of a step over the size of the film at the default CFL number. Chosen: a thousand such errors are a tenth.
const TOLERANCE: f64 = 1e-4;
/// Bounds of the growth of steps. Chosen below 1 + √2.
const GROWTH: [f64; 2] = [0.3, 2.0];
/// Safety factor. Chosen.
const SAFETY: f64 = 0.9;
/// Length after a step without solution, over its length. Chosen.
const AFTER_FAILURE: f64 = 0.4;
/// Mean displacement that ends Newton's method over the allowed error. Chosen: the step after it is much smaller.
const NEWTON_SHARE: f64 = 0.1;
/// Mean displacement of the first Newton step over the allowed error at which a step has no prospect: four times the
/// one whose error is the allowed one. Chosen.
const FIRST_SHARE: f64 = 12.0;
/// Longest step of error control, s. Chosen: energies between the ends of a step are interpolated, and the ledger of a
/// filling capsule then closes to 1e-3; a filling takes seconds.
const LONGEST: f64 = 0.1;

/// How the length of steps is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StepControl {
    /// By the error of each step, at most this (m).
    Error(f64),
    /// This length, s.
    Fixed(f64),
}

impl StepControl {
    /// By the error, for film of this size (m), with a factor on the error.
    pub fn error(cfl: f64, size: f64, factor: f64) -> Self {
        let ratio = cfl / DEFAULT_CFL;
        Self::Error(TOLERANCE * ratio * ratio * ratio * size * factor)
    }

    /// Mean displacement (m) of the first Newton step from the prediction above which the step is shortened.
    pub(super) fn first_displacement(self) -> f64 {
        match self {
            Self::Error(allowed) => FIRST_SHARE * allowed,
            Self::Fixed(_) => f64::INFINITY,
        }
    }

    /// Longest step, s.
    pub(super) fn longest(self) -> f64 {
        match self {
            Self::Error(_) => LONGEST,
            Self::Fixed(step) => step,
        }
    }

    /// Mean displacement (m) that ends Newton's method.
    pub(super) fn newton_displacement(self, size: f64) -> f64 {
        match self {
            Self::Error(allowed) => NEWTON_SHARE * allowed,
            Self::Fixed(_) => 1e-9 * size,
        }
    }

    /// Whether a step with this error (m) is accepted, and the length of the next one, s.
    pub(super) fn next(self, length: f64, error: f64, order: i32) -> (bool, f64) {
        match self {
            Self::Fixed(step) => (true, step),
            Self::Error(allowed) => {
                let ratio = allowed / error;
                let root = if order == 3 { libm::cbrt(ratio) } else { ratio.sqrt() };
                // No error at all is a ratio without bound; NaN is refused.
                let factor = (SAFETY * root).clamp(GROWTH[0], GROWTH[1]);
                (error <= allowed, length * factor)
            }
        }
    }

    /// Length after a step of `length` (s) without solution; `None` for fixed steps.
    pub(super) fn shorter(self, length: f64) -> Option<f64> {
        match self {
            Self::Fixed(_) => None,
            Self::Error(_) => Some(AFTER_FAILURE * length),
        }
    }
}
