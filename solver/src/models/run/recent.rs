//! The largest speed of any node, as a mean over τ = [`MEAN_TIME`]: a shake that is over sooner hardly counts.
//!
//! ```text
//! v(t) = max over the nodes of |x(t) − x(t − τ)|/τ
//! ```
//!
//! x is linear between the positions that are kept.

use std::collections::VecDeque;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::geometry::field::Field;
use crate::output::measures::MEAN_TIME;

/// Name, unit and meaning of the track of the largest speed.
pub const FILM_SPEED: (&str, &str, &str) =
    ("film_speed", "m/s", "largest speed of any node of the film: mean over the last 5 ms");
/// Time between positions that are kept, s, at least. Chosen: a fifth of τ shows how the film moves within it.
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
        let speed = first.map_or(0.0, |(at, from)| {
            let (next, to) = self.0.get(1).map_or((time, &positions), |(at, to)| (*at, to));
            let part = ((time - MEAN_TIME - at) / (next - at)).max(0.0);
            let moved = |((now, from), to): ((Vector3<f64>, Vector3<f64>), Vector3<f64>)| {
                (now - from - (to - from) * part).norm_squared()
            };
            let nodes = positions.iter().zip(from.iter()).zip(to.iter());
            nodes.map(moved).fold(0.0, f64::max).sqrt() / MEAN_TIME
        });
        if self.0.back().is_none_or(|(at, _)| is_older(KEPT_INTERVAL, *at)) {
            self.0.push_back((time, positions));
        }
        speed
    }

    /// Whether all positions are those of this number of nodes.
    pub(super) fn fits(&self, nodes: usize) -> bool {
        let fits = |field: &Field| [&field.x, &field.y, &field.z].iter().all(|x| x.len() == nodes);
        self.0.iter().all(|(_, positions)| fits(positions))
    }
}

#[cfg(test)]
mod tests {
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
        for interval in [1e-4, 7e-4, 1e-3, 2e-3, 3e-3, 1e-2] {
            let steady = largest(interval, |time| -7.0 * time);
            assert!((steady - 7.0).abs() < 1e-9, "{interval}: {steady}");
        }
        // 0.02 m there and back within 1 ms, at 40 m/s.
        let shake = |time: f64| if (time - 0.05).abs() < 0.5e-3 { 0.02 } else { 0.0 };
        let shaken = largest(1e-3, shake);
        assert!((shaken - 4.0).abs() < 1e-9, "{shaken}");
        // 0.12 m in 12 ms: the mean over 5 ms within them.
        for interval in [7e-4, 1e-3, 3e-3] {
            let pulse = largest(interval, |time| 0.12 * ((time - 0.05) / 12e-3).clamp(0.0, 1.0));
            assert!((pulse - 10.0).abs() < 1e-9, "{interval}: {pulse}");
        }
        let pulse = largest(1e-4, |time| 0.08 * ((time - 0.05) / 8e-3).clamp(0.0, 1.0));
        assert!((pulse - 10.0).abs() < 1e-9, "{pulse}");
        assert!(largest(1e-3, |_| 1.0) <= 0.0, "at rest");
    }
}
