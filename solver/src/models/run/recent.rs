//! The largest speed of any node, as a mean over τ = [`MEAN_TIME`]: a shake that is over sooner hardly counts.
//!
//! ```text
//! v(t) = max over the nodes of |x(t) − x(t − τ)|/τ
//! ```
//!
//! Where no positions are kept from t − τ, those of the last time before it stand for them, and τ is longer.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::geometry::field::Field;
use crate::output::measures::MEAN_TIME;

/// Name, unit and meaning of the track of the largest speed.
pub const FILM_SPEED: (&str, &str, &str) =
    ("film_speed", "m/s", "largest speed of any node of the film: mean over the last 5 ms");
/// Time between positions that are kept, s. Chosen: τ is then at most a fifth longer where samples are closer.
const KEPT_INTERVAL: f64 = MEAN_TIME / 5.0;
/// Part of a time that rounding may take from it. Chosen.
const ROUNDING: f64 = 1e-9;

/// Positions at the last samples, oldest first, with their times (s).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub(super) struct RecentPositions(VecDeque<(f64, Field)>);

impl RecentPositions {
    /// The largest speed (m/s) at a sample at this time (s) with these positions; 0 within the first τ.
    pub(super) fn speed(&mut self, time: f64, positions: Field) -> f64 {
        let is_older = |than: f64, at: f64| time - at >= than * (1.0 - ROUNDING);
        while self.0.get(1).is_some_and(|(at, _)| is_older(MEAN_TIME, *at)) {
            self.0.pop_front();
        }
        let first = self.0.front().filter(|(at, _)| is_older(MEAN_TIME, *at));
        let speed =
            first.map_or(0.0, |(at, from)| from.largest_displacement(&positions) / (time - at));
        if self.0.back().is_none_or(|(at, _)| is_older(KEPT_INTERVAL, *at)) {
            self.0.push_back((time, positions));
        }
        speed
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    /// The largest speed of two nodes, one of which moves along x by `x(t)`, sampled at this interval.
    fn largest(interval: f64, x: impl Fn(f64) -> f64) -> f64 {
        let mut recent = RecentPositions::default();
        let at = |time: f64| Field::of(&[Vector3::new(x(time), 0.0, 1.0), Vector3::zeros()]);
        let times = (0..).map(|k| f64::from(k) * interval).take_while(|time| *time < 0.1);
        times.map(|time| recent.speed(time, at(time))).fold(0.0, f64::max)
    }

    #[test]
    fn the_speed_is_a_mean_over_five_milliseconds_at_any_sample_interval() {
        for interval in [1e-4, 1e-3, 2e-3, 1e-2] {
            let steady = largest(interval, |time| -7.0 * time);
            assert!((steady - 7.0).abs() < 1e-9, "{interval}: {steady}");
        }
        // 0.02 m there and back within 1 ms, at 40 m/s.
        let shake = |time: f64| if (time - 0.05).abs() < 0.5e-3 { 0.02 } else { 0.0 };
        let shaken = largest(1e-3, shake);
        assert!((shaken - 4.0).abs() < 1e-9, "{shaken}");
        // 0.08 m in 8 ms: the mean over at most 6 ms is that of the pulse.
        let pulse = largest(1e-4, |time| 0.08 * ((time - 0.05) / 8e-3).clamp(0.0, 1.0));
        assert!((pulse - 10.0).abs() < 1e-9, "{pulse}");
        assert!(largest(1e-3, |_| 1.0) <= 0.0, "at rest");
    }
}
