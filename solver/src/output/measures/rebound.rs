//! The first peak of a height and the first minimum after it.
//!
//! A peak is a value of at least half of the largest one from which the series falls by more than
//! [`MIN_FALL`] of it; the minimum after it is a value from which the series rises again by as much.
//! Smaller waves are ringing, and lower ones belong to a film that a lid still holds.

/// Smallest fall after a peak, and rise after a minimum, as a fraction of the peak. Chosen: above the
/// ringing of the top ring, below its rebounds.
const MIN_FALL: f64 = 0.05;

/// Smallest peak as a fraction of the largest value. Chosen.
const MIN_PEAK: f64 = 0.5;

/// Indices of the first peak and of the first minimum after it. `None`: the series ends before the fall
/// or the rise that shows it.
pub fn first_rebound(values: &[f64]) -> (Option<usize>, Option<usize>) {
    let high = MIN_PEAK * values.iter().copied().fold(0.0, f64::max);
    let (mut peak, mut minimum) = (0, None);
    for (index, value) in values.iter().enumerate() {
        let margin = MIN_FALL * values[peak].abs();
        match minimum {
            None if *value > values[peak] => peak = index,
            None if values[peak] >= high && *value < values[peak] - margin => minimum = Some(index),
            Some(lowest) if *value < values[lowest] => minimum = Some(index),
            Some(lowest) if *value > values[lowest] + margin => return (Some(peak), Some(lowest)),
            _ => {}
        }
    }
    (minimum.map(|_| peak), None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ringing_is_no_rebound() {
        let values = [0.0, 0.5, 0.499, 0.9, 1.0, 0.96, 0.98, 0.8, 0.6, 0.64, 0.7, 1.2, 0.1];
        assert_eq!(first_rebound(&values), (Some(4), Some(8)));
    }

    #[test]
    fn a_height_under_a_lid_is_no_peak() {
        let values = [0.04, 0.041, 0.03, 0.04, 0.5, 0.9, 0.7];
        assert_eq!(first_rebound(&values), (Some(5), None));
    }

    #[test]
    fn a_series_that_only_rises_has_no_peak_and_one_that_only_falls_no_minimum() {
        assert_eq!(first_rebound(&[0.0, 1.0, 2.0]), (None, None));
        assert_eq!(first_rebound(&[2.0, 1.0, 0.5]), (Some(0), None));
        assert_eq!(first_rebound(&[]), (None, None));
    }
}
