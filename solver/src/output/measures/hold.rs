//! The time at which a series reaches a threshold and stays above it.

/// First time (s) from which `value ≥ threshold` holds for `hold` seconds; `None` if never. The series is
/// linear between samples, so a crossing lies between them. The end of the series must not cut the
/// `hold` seconds short.
pub(super) fn first_hold(time: &[f64], value: &[f64], threshold: f64, hold: f64) -> Option<f64> {
    let mut since: Option<f64> = None;
    for (index, (now, reached)) in time.iter().zip(value).enumerate() {
        let crossing = || {
            let (t0, v0) = (time[index - 1], value[index - 1]);
            t0 + (threshold - v0) / (reached - v0) * (now - t0)
        };
        if *reached >= threshold {
            let start = since.unwrap_or_else(|| if index == 0 { *now } else { crossing() });
            since = Some(start);
            if lasts(start, *now, hold) {
                return Some(start);
            }
        } else if let Some(start) = since.take()
            && lasts(start, crossing(), hold)
        {
            return Some(start);
        }
    }
    None
}

/// Whether `from` to `to` is at least `hold`, except for the rounding of sample times.
fn lasts(from: f64, to: f64, hold: f64) -> bool {
    to - from >= hold * (1.0 - 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOLD: f64 = 0.005;

    fn millisecond_samples(values: &[f64]) -> (Vec<f64>, Vec<f64>) {
        ((0..values.len()).map(|k| k as f64 * 1e-3).collect(), values.to_vec())
    }

    fn find(values: &[f64]) -> Option<f64> {
        let (time, value) = millisecond_samples(values);
        first_hold(&time, &value, 1.0, HOLD)
    }

    #[test]
    fn the_crossing_is_interpolated() {
        let found = find(&[0.0, 0.5, 1.5, 2.0, 2.0, 2.0, 2.0, 2.0]).unwrap();
        assert!((found - 0.0015).abs() < 1e-15);
    }

    #[test]
    fn a_stay_shorter_than_the_hold_does_not_count() {
        // Above from 0.5 ms to 4.5 ms, and again from 5.5 ms to the end.
        let found = find(&[0.0, 2.0, 2.0, 2.0, 2.0, 0.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0]).unwrap();
        assert!((found - 0.0055).abs() < 1e-15, "{found}");
    }

    #[test]
    fn a_stay_of_exactly_the_hold_counts() {
        // From 0.5 ms to 5.5 ms.
        let found = find(&[0.0, 2.0, 2.0, 2.0, 2.0, 2.0, 0.0, 0.0]).unwrap();
        assert!((found - 0.0005).abs() < 1e-15);
    }

    #[test]
    fn no_stay_of_that_length_is_none() {
        assert_eq!(find(&[0.0; 20]), None);
        assert_eq!(find(&[0.0, 0.0, 0.0, 2.0, 2.0, 2.0]), None);
        assert_eq!(find(&[]), None);
    }

    #[test]
    fn a_series_above_the_threshold_reaches_it_at_its_start() {
        assert_eq!(find(&[1.0; 6]), Some(0.0));
    }
}
