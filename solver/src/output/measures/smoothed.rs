//! Times at which a bouncing series reaches a level: the crossing of its smoothed course.
//!
//! ```text
//! m(t) = ∫ w(s) y(t + s) ds / ∫ w(s) ds,   w(s) = ½ (1 + cos(2π s/W)),  |s| < W/2
//! W = 5 (t_half − t_low)                   low: midway between the first height and the half
//! ```
//!
//! Film rebounds several times before it rests at its final height. Which rebound first reaches nine tenths
//! depends on small causes: the mesh, the seed, the time step. Its smoothed course passes the level once.
//! The width W follows from the opening of the film, so it scales with the motion and does not depend on
//! when the motion begins. A Hann window has no negative side lobes: no bounce is amplified. The series is
//! linear between samples and constant before the first; at its end the window is cut.

use std::f64::consts::TAU;

/// Width of the window over the opening time [`opening_time`]. Chosen: wider than the first rebound of the
/// paper's capsule; from 4 to 6 the times change by less than their scatter.
const WIDTH_PER_OPENING_TIME: f64 = 5.0;

/// A Hann window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window {
    /// Half of its width, s.
    half: f64,
}

impl Window {
    /// The window of a motion: `height` (m) first holds the level `half` (m) from `t_half` (s) on.
    pub(super) fn of(time: &[f64], height: &[f64], half: f64, t_half: f64) -> Self {
        Self { half: 0.5 * WIDTH_PER_OPENING_TIME * opening_time(time, height, half, t_half) }
    }

    /// First time (s) at which the smoothed `values` reach `level`.
    pub(super) fn first(self, time: &[f64], values: &[f64], level: f64) -> Option<f64> {
        let mut before: Option<[f64; 2]> = None;
        for now in time {
            let value = self.mean(time, values, *now);
            if value >= level {
                let crossing = before.map(|[t, v]| t + (level - v) / (value - v) * (now - t));
                return Some(crossing.unwrap_or(*now));
            }
            before = Some([*now, value]);
        }
        None
    }

    /// Weighted mean of the series around a time between its first and its last sample.
    fn mean(self, time: &[f64], values: &[f64], at: f64) -> f64 {
        let from = time.partition_point(|t| *t <= at - self.half).saturating_sub(1);
        let to = time.partition_point(|t| *t < at + self.half).min(time.len() - 1);
        let (mut sum, mut weight) = (0.0, 0.0);
        // A segment from `low` to `high` after `at`, on the line of this slope with `value` at `at`.
        let mut add = |[low, high]: [f64; 2], value: f64, slope: f64| {
            let (w0, w1) = self.moments(low, high);
            sum += value * w0 + slope * w1;
            weight += w0;
        };
        let first = time[0] - at;
        if first > -self.half {
            add([-self.half, first.min(self.half)], values[0], 0.0);
        }
        for j in from..to {
            let (t0, t1) = (time[j] - at, time[j + 1] - at);
            let (low, high) = (t0.max(-self.half), t1.min(self.half));
            if high > low {
                let slope = (values[j + 1] - values[j]) / (t1 - t0);
                add([low, high], values[j] - slope * t0, slope);
            }
        }
        if weight > 0.0 { sum / weight } else { values[to] }
    }

    /// ∫ w ds and ∫ w s ds from `low` to `high`, within the window.
    fn moments(self, low: f64, high: f64) -> (f64, f64) {
        let k = 0.5 * TAU / self.half;
        let [(s0, c0), (s1, c1)] = [low, high].map(|s| libm::sincos(k * s));
        let zeroth = (high - low) + (s1 - s0) / k;
        let first =
            0.5 * (high * high - low * low) + (high * s1 - low * s0) / k + (c1 - c0) / (k * k);
        (0.5 * zeroth, 0.5 * first)
    }
}

/// Time (s) in which the height rises to `half` (m) from midway between its first value and `half`, before
/// `t_half` (s).
fn opening_time(time: &[f64], height: &[f64], half: f64, t_half: f64) -> f64 {
    let low = 0.5 * (height[0] + half);
    let until = time.partition_point(|t| *t <= t_half);
    let Some(last) = height[..until].iter().rposition(|z| *z < low) else { return 0.0 };
    let (t0, v0) = (time[last], height[last]);
    let Some((t1, v1)) = time.get(last + 1).zip(height.get(last + 1)) else { return 0.0 };
    t_half - (t0 + (low - v0) / (v1 - v0) * (t1 - t0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(count: usize, f: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..count).map(|k| k as f64 * 1e-3).collect();
        let values = time.iter().map(|t| f(*t)).collect();
        (time, values)
    }

    #[test]
    fn a_line_is_its_own_mean() {
        let (time, values) = series(400, |t| 0.1 + 2.0 * t);
        let window = Window { half: 0.04 };
        for at in [0.04, 0.1234, 0.3] {
            assert!((window.mean(&time, &values, at) - (0.1 + 2.0 * at)).abs() < 1e-12);
        }
        let reached = window.first(&time, &values, 0.5).unwrap();
        assert!((reached - 0.2).abs() < 1e-12, "{reached}");
    }

    #[test]
    fn a_window_is_cut_at_the_end_and_constant_before_the_start() {
        let (time, values) = series(200, |_| 3.0);
        let window = Window { half: 10.0 };
        assert!((window.mean(&time, &values, 0.0) - 3.0).abs() < 1e-12);
        assert!((window.mean(&time, &values, 0.199) - 3.0).abs() < 1e-12);
        assert_eq!(window.first(&time, &values, 3.5), None);
    }

    #[test]
    fn a_series_above_the_level_is_there_at_its_first_sample() {
        let (time, values) = series(50, |_| 1.0);
        assert_eq!(Window::of(&time, &values, 0.5, 0.0).first(&time, &values, 0.9), Some(0.0));
    }

    #[test]
    fn a_shift_in_time_shifts_the_result() {
        let rise = |start: f64| move |t: f64| ((t - start) / 0.05).clamp(0.0, 1.0) * 0.98 + 0.02;
        let reached = |start: f64| {
            let (time, values) = series(600, rise(start));
            let t_half = time[values.iter().position(|z| *z >= 0.5).unwrap()];
            Window::of(&time, &values, 0.5, t_half).first(&time, &values, 0.9).unwrap()
        };
        assert!((reached(0.3) - reached(0.1) - 0.2).abs() < 1e-9);
    }
}
