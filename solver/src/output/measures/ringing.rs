//! Ringing: the motion of the top ring after deployment.
//!
//! ```text
//! rms = √(1/n Σ v_j²)
//! X_k = Σ w_j (v_j − v̄) e^(−2πi jk/n),   w_j = ½(1 − cos(2πj/n))  (Hann),   f_k = k/(n Δt)
//! ```
//!
//! The line is the `f_k` of the largest |`X_k`|, k ≥ 1, up to half the sampling rate and at most
//! [`MAX_FREQUENCY`]. Its resolution is 1/(n Δt): 5 Hz.

use std::f64::consts::TAU;

/// Length of the window after `t_deployed`, s. Chosen.
pub(super) const WINDOW: f64 = 0.2;
/// Highest frequency of a line, Hz. Chosen.
const MAX_FREQUENCY: f64 = 2000.0;

/// Root mean square (m/s) and largest line (Hz) of `vz` over the window that starts at `start` (s).
/// `None` if the history ends before the window does; no line if vz is constant.
pub(super) fn ringing(time: &[f64], vz: &[f64], start: f64) -> Option<(f64, Option<f64>)> {
    let end = start + WINDOW;
    if time.last().is_none_or(|last| *last < end - 1e-9) {
        return None;
    }
    let first = time.partition_point(|t| *t < start);
    let mut end_index = time.partition_point(|t| *t <= end + 1e-9);
    if end_index < first + 4 {
        return None;
    }
    let interval = time[first + 1] - time[first];
    // Only the last sample of a run can have another interval.
    if (time[end_index - 1] - time[end_index - 2] - interval).abs() > 1e-6 * interval {
        end_index -= 1;
    }
    let window = &vz[first..end_index];
    let count = window.len();
    let rms = (window.iter().map(|v| v * v).sum::<f64>() / count as f64).sqrt();
    Some((rms, largest_line(window, interval)))
}

fn largest_line(values: &[f64], interval: f64) -> Option<f64> {
    let count = values.len();
    let mean = values.iter().sum::<f64>() / count as f64;
    let sin_cos: Vec<(f64, f64)> =
        (0..count).map(|j| libm::sincos(TAU * j as f64 / count as f64)).collect();
    let weighted: Vec<f64> =
        values.iter().zip(&sin_cos).map(|(v, (_, cos))| 0.5 * (1.0 - cos) * (v - mean)).collect();
    let resolution = 1.0 / (count as f64 * interval);
    let mut largest = (0.0, None);
    for k in (1..=count / 2).take_while(|k| *k as f64 * resolution <= MAX_FREQUENCY) {
        let (mut real, mut imaginary, mut phase) = (0.0, 0.0, 0);
        for value in &weighted {
            let (sin, cos) = sin_cos[phase];
            real += value * cos;
            imaginary -= value * sin;
            phase += k;
            if phase >= count {
                phase -= count;
            }
        }
        let power = real * real + imaginary * imaginary;
        if power > largest.0 {
            largest = (power, Some(k as f64 * resolution));
        }
    }
    largest.1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(count: usize, interval: f64, f: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..count).map(|k| k as f64 * interval).collect();
        let value = time.iter().map(|t| f(*t)).collect();
        (time, value)
    }

    #[test]
    fn a_sine_about_any_mean_is_found_with_its_frequency_and_rms() {
        for tone in [35.0, 85.0, 290.0] {
            let (time, vz) = series(500, 1e-3, |t| 5.0 + 3.0 * libm::sin(TAU * tone * t + 0.4));
            let (rms, line) = ringing(&time, &vz, 0.05).unwrap();
            assert!((rms - 29.5_f64.sqrt()).abs() < 0.03, "{rms}");
            assert!((line.unwrap() - tone).abs() <= 5.0, "{tone}: {line:?}");
        }
    }

    #[test]
    fn zero_velocity_has_no_line_and_a_short_history_no_ringing() {
        let (time, vz) = series(500, 1e-3, |_| 0.0);
        assert_eq!(ringing(&time, &vz, 0.1), Some((0.0, None)));
        assert_eq!(ringing(&time, &vz, 0.4), None);
        assert_eq!(ringing(&[], &[], 0.0), None);
    }

    #[test]
    fn an_uneven_last_sample_is_left_out() {
        let (mut time, mut vz) = series(201, 1e-3, |t| libm::sin(TAU * 50.0 * t));
        time.push(0.2003);
        vz.push(1e3);
        let (rms, _) = ringing(&time, &vz, 0.0003).unwrap();
        assert!(rms < 1.0, "{rms}");
    }
}
