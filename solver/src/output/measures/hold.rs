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

    #[test]
    fn the_first_stay_of_the_hold_is_found() {
        let cases: [(&[f64], Option<f64>); 7] = [
            // The crossing is interpolated.
            (&[0.0, 0.5, 1.5, 2.0, 2.0, 2.0, 2.0, 2.0], Some(0.0015)),
            // Above from 0.5 ms to 4.5 ms, and again from 5.5 ms to the end.
            (&[0.0, 2.0, 2.0, 2.0, 2.0, 0.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0], Some(0.0055)),
            // Exactly the hold: from 0.5 ms to 5.5 ms.
            (&[0.0, 2.0, 2.0, 2.0, 2.0, 2.0, 0.0, 0.0], Some(0.0005)),
            (&[0.0; 20], None),
            (&[0.0, 0.0, 0.0, 2.0, 2.0, 2.0], None),
            (&[], None),
            (&[1.0; 6], Some(0.0)),
        ];
        for (values, expected) in cases {
            let time: Vec<f64> = (0..values.len()).map(|k| k as f64 * 1e-3).collect();
            let found = first_hold(&time, values, 1.0, HOLD);
            assert_eq!(found.is_some(), expected.is_some(), "{values:?}");
            let error = found.unwrap_or(0.0) - expected.unwrap_or(0.0);
            assert!(error.abs() < 1e-15, "{values:?}: {found:?}");
        }
    }
}
