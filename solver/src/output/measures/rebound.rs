//! The first peak of a height and the first minimum after it.
//!
//! A peak is a value from which the series falls by more than [`MIN_FALL`] of it; the minimum after it is
//! a value from which the series rises again by as much. Smaller waves are ringing, not a rebound.

/// Smallest fall after a peak, and rise after a minimum, as a fraction of the peak. Chosen: above the
/// ringing of the top ring, below its rebounds.
const MIN_FALL: f64 = 0.01;

/// Indices of the first peak and of the first minimum after it. `None`: the series ends before the fall
/// or the rise that shows it.
pub fn first_rebound(values: &[f64]) -> (Option<usize>, Option<usize>) {
    let (mut peak, mut minimum) = (0, None);
    for (index, value) in values.iter().enumerate() {
        match minimum {
            None if *value > values[peak] => peak = index,
            None if *value < values[peak] - MIN_FALL * values[peak].abs() => minimum = Some(index),
            None => {}
            Some(lowest) if *value < values[lowest] => minimum = Some(index),
            Some(lowest) if *value > values[lowest] + MIN_FALL * values[peak].abs() => {
                return (Some(peak), Some(lowest));
            }
            Some(_) => {}
        }
    }
    (minimum.map(|_| peak), None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ringing_is_no_rebound() {
        let values = [0.0, 0.5, 0.499, 0.9, 1.0, 0.995, 0.8, 0.6, 0.605, 0.7, 1.2, 0.1];
        assert_eq!(first_rebound(&values), (Some(4), Some(7)));
    }

    #[test]
    fn a_series_that_only_rises_has_no_peak_and_one_that_only_falls_no_minimum() {
        assert_eq!(first_rebound(&[0.0, 1.0, 2.0]), (None, None));
        assert_eq!(first_rebound(&[2.0, 1.0, 0.5]), (Some(0), None));
        assert_eq!(first_rebound(&[]), (None, None));
    }
}
