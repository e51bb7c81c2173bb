//! Looking outward from an infeasible value for the nearest feasible one.

/// The feasible whole number nearest to one that is not, within 63.
pub(super) fn whole(start: f64, feasible: impl Fn(f64) -> bool) -> Option<f64> {
    (1..64).find_map(|step| {
        let step = f64::from(step);
        [start + step, start - step].into_iter().find(|value| *value > 0.0 && feasible(*value))
    })
}

/// The largest feasible value below one that is not; `None` if there is none within a factor of a
/// million.
pub(super) fn below(start: f64, feasible: impl Fn(f64) -> bool) -> Option<f64> {
    real(start, &[false], feasible)
}

/// Upward first.
pub(super) const BOTH_WAYS: [bool; 2] = [true, false];

/// The feasible value nearest to one that is not, in the ways given (up is `true`), by factors up to a
/// million; rounded into the feasible range.
pub(super) fn real(start: f64, ways: &[bool], feasible: impl Fn(f64) -> bool) -> Option<f64> {
    let mut factor = 1.0;
    while factor < 1e6 {
        let previous = factor;
        // Near, a narrow range must not be stepped over; far off the edge alone is looked for.
        factor *= if factor < 50.0 { 1.02 } else { 1.5 };
        for up in ways.iter().copied() {
            let at = |factor: f64| if up { start * factor } else { start / factor };
            if !feasible(at(factor)) {
                continue;
            }
            let (mut outside, mut inside) = (previous, factor);
            for _ in 0..40 {
                let middle = 0.5 * (outside + inside);
                if feasible(at(middle)) { inside = middle } else { outside = middle }
            }
            return Some(rounded(at(inside), up, &feasible).unwrap_or_else(|| at(inside)));
        }
    }
    None
}

/// The edge of the feasible range rounded into it, to the fewest digits (3 or more) that stay near.
fn rounded(edge: f64, up: bool, feasible: impl Fn(f64) -> bool) -> Option<f64> {
    let magnitude = libm::floor(libm::log10(edge));
    (3_u8..9).find_map(|digits| {
        let unit = libm::pow(10.0, magnitude - f64::from(digits - 1));
        let whole = if up { libm::ceil(edge / unit) } else { libm::floor(edge / unit) };
        // Through text, so that the value prints with those digits.
        let value: f64 = format!("{:.*e}", usize::from(digits - 1), whole * unit).parse().ok()?;
        feasible(value).then_some(value)
    })
}
