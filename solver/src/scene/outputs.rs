//! What is stored of a run, and the thresholds of its verdict.

use serde::{Deserialize, Serialize};

/// Maximum number of samples of a run, `end_time`/`sample_interval`. Chosen: keeps a history in memory
/// and in one file.
pub const MAX_SAMPLES: f64 = 1e6;

/// What is stored of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outputs {
    /// Time between samples of the history, s. Samples are taken at multiples of it, and at the end.
    pub sample_interval: f64,
    /// Number of frames (shapes) to keep ([`crate::output::frames`]); 0 for none.
    pub frames: u32,
    /// Thresholds of the measures and the verdict.
    pub thresholds: Thresholds,
}

/// Thresholds of the verdict; stored with every result.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thresholds {
    /// Smallest V/`V_ref` of a deployed capsule.
    pub deployed_volume: f64,
    /// Smallest `z_rim`/`H_ref` of a deployed capsule.
    pub deployed_height: f64,
    /// A capsule is stalled where the mean V/`V_ref` of the last tenth is below this.
    pub stalled_volume: f64,
    /// A verdict whose smallest margin is below this is marked `near_threshold`. The stored name is
    /// part of job ids.
    #[serde(rename = "close_margin")]
    pub near_threshold_margin: f64,
}

/// Chosen as defaults of the study keys `outputs.thresholds`.
impl Default for Thresholds {
    fn default() -> Self {
        Self {
            deployed_volume: 0.93,
            deployed_height: 0.95,
            stalled_volume: 0.85,
            near_threshold_margin: 0.02,
        }
    }
}
