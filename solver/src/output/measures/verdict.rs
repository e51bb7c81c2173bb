//! The verdict: did the capsule deploy?
//!
//! It compares the last tenth of the run with the static equilibrium at its mean overpressure (of
//! film by its ladder, after the run), in this order:
//!
//! - deployed, if V and `z_rim` stay at or above their thresholds throughout;
//! - stalled, if the mean V is below its threshold;
//! - partial otherwise.
//!
//! Of film without rings the volume alone counts.
//!
//! A verdict is near its threshold if a change of the ratios by less than the near-threshold margin
//! would change it.

use super::Verdict;
use super::reference::{last_tenth, mean};
use crate::scene::Thresholds;

/// The last tenth of a run, divided by its static reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LastTenth {
    /// Mean V divided by the static volume.
    pub(super) mean_volume: f64,
    /// Smallest V divided by the static volume.
    pub(super) min_volume: f64,
    /// Smallest `z_rim` divided by the static height.
    pub(super) min_height: f64,
}

impl LastTenth {
    /// Of a run with at least one sample.
    pub(super) fn new(time: &[f64], volume: &[f64], height: &[f64], (v, h): (f64, f64)) -> Self {
        let from = last_tenth(time).unwrap_or(0);
        let min = |values: &[f64]| values[from..].iter().copied().fold(f64::INFINITY, f64::min);
        Self {
            mean_volume: mean(&time[from..], &volume[from..]) / v,
            min_volume: min(volume) / v,
            min_height: min(height) / h,
        }
    }

    /// The verdict, and whether it is near a threshold. `height`: whether the height counts.
    pub(super) fn judge(&self, thresholds: &Thresholds, height: bool) -> (Verdict, bool) {
        let volume_margin = self.min_volume - thresholds.deployed_volume;
        let height_margin = self.min_height - thresholds.deployed_height;
        let deployed_margin = if height { volume_margin.min(height_margin) } else { volume_margin };
        let stalled_margin = thresholds.stalled_volume - self.mean_volume;
        let (verdict, margin) = if deployed_margin >= 0.0 {
            (Verdict::Deployed, deployed_margin)
        } else if stalled_margin > 0.0 {
            (Verdict::Stalled, stalled_margin)
        } else {
            (Verdict::Partial, (-stalled_margin).min(-deployed_margin))
        };
        (verdict, margin < thresholds.near_threshold_margin)
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;

    fn judge(mean_volume: f64, min_volume: f64, min_height: f64) -> (Verdict, bool) {
        LastTenth { mean_volume, min_volume, min_height }.judge(&Thresholds::default(), true)
    }

    #[test]
    fn every_rule_holds_at_its_threshold() {
        assert_eq!(judge(1.0, 1.0, 1.0), (Verdict::Deployed, false));
        assert_eq!(judge(0.94, 0.93, 1.0), (Verdict::Deployed, true));
        assert_eq!(judge(1.0, 1.0, 0.95), (Verdict::Deployed, true));
        assert_eq!(judge(1.0, 1.0, 0.97).0, Verdict::Deployed);
        assert_eq!(judge(0.94, 0.929, 1.0), (Verdict::Partial, true));
        assert_eq!(judge(0.9, 0.9, 0.98), (Verdict::Partial, false));
        assert_eq!(judge(0.86, 0.86, 0.86), (Verdict::Partial, true));
        assert_eq!(judge(0.85, 0.8, 0.8), (Verdict::Partial, true));
        assert_eq!(judge(0.849, 0.8, 0.8), (Verdict::Stalled, true));
        assert_eq!(judge(0.5, 0.4, 0.94), (Verdict::Stalled, false));
        // The volume misses its threshold by little, the height by much: no small change helps.
        assert_eq!(judge(0.94, 0.925, 0.5), (Verdict::Partial, false));
        let low = LastTenth { mean_volume: 1.0, min_volume: 0.96, min_height: 0.1 };
        assert_eq!(low.judge(&Thresholds::default(), false), (Verdict::Deployed, false));
        let odd = Thresholds { stalled_volume: 2.0, ..Thresholds::default() };
        let tenth = LastTenth { mean_volume: 1.0, min_volume: 1.0, min_height: 1.0 };
        assert_eq!(
            tenth.judge(&odd, true).0,
            Verdict::Deployed,
            "it takes precedence over stalled"
        );
    }

    #[test]
    fn only_the_last_tenth_counts() {
        let time: Vec<f64> = (0..=100).map(|k| f64::from(k) * 0.01).collect();
        let volume: Vec<f64> = time.iter().map(|t| if *t < 0.895 { 0.0 } else { 2.0 }).collect();
        let tenth = LastTenth::new(&time, &volume, &volume, (2.0, 1.0));
        assert_eq!(tenth, LastTenth { mean_volume: 1.0, min_volume: 1.0, min_height: 2.0 });
        let dip: Vec<f64> = time.iter().map(|t| if *t > 0.995 { 0.0 } else { 2.0 }).collect();
        let tenth = LastTenth::new(&time, &dip, &volume, (2.0, 1.0));
        assert_eq!(tenth.min_volume, 0.0);
        assert!((tenth.mean_volume - 0.95).abs() < 1e-12);
    }
}
