//! Search for the feasible value nearest to an infeasible one.
//!
//! Feasibility is known only by evaluation. The search therefore steps away from the start, and refines
//! the first feasible step by bisection.

/// Largest distance of a whole number from the start. Chosen: covers every practical number of panels
/// or storeys.
const MAX_WHOLE_DISTANCE: u32 = 63;

/// Factor up to which a real number is searched, upward and downward. Chosen: a million, which covers
/// every practical change of a length or ratio.
const MAX_FACTOR: f64 = 1e6;

/// Growth of the factor in a step near the start. Chosen: 2 %, so that no narrow feasible range is
/// missed.
const NEAR_STEP: f64 = 1.02;

/// Growth of the factor in a step beyond [`FAR_FACTOR`]. Chosen: coarse, only an edge is searched there.
const FAR_STEP: f64 = 1.5;

/// Factor beyond which steps are coarse.
const FAR_FACTOR: f64 = 50.0;

/// Bisections of the step in which the value becomes feasible. Chosen: 2⁻⁴⁰ of a step, far below the
/// digits shown.
const BISECTIONS: u32 = 40;

/// Numbers of significant digits tried for a rounded value, fewest first.
const SIGNIFICANT_DIGITS: core::ops::Range<u8> = 3..9;

/// Direction of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Direction {
    Up,
    Down,
}

/// Both directions; at equal factors the larger value is tried first.
pub(super) const BOTH: [Direction; 2] = [Direction::Up, Direction::Down];

/// The feasible whole number nearest to an infeasible one; `None` beyond [`MAX_WHOLE_DISTANCE`].
pub(super) fn nearest_whole(start: f64, feasible: impl Fn(f64) -> bool) -> Option<f64> {
    (1..=MAX_WHOLE_DISTANCE).find_map(|step| {
        let step = f64::from(step);
        [start + step, start - step].into_iter().find(|value| *value > 0.0 && feasible(*value))
    })
}

/// The feasible value nearest to an infeasible one in these directions, rounded into the feasible
/// range; `None` beyond [`MAX_FACTOR`].
pub(super) fn nearest_real(
    start: f64,
    directions: &[Direction],
    feasible: impl Fn(f64) -> bool,
) -> Option<f64> {
    let mut factor = 1.0;
    while factor < MAX_FACTOR {
        let previous = factor;
        factor *= if factor < FAR_FACTOR { NEAR_STEP } else { FAR_STEP };
        for direction in directions.iter().copied() {
            let value = |factor: f64| match direction {
                Direction::Up => start * factor,
                Direction::Down => start / factor,
            };
            if !feasible(value(factor)) {
                continue;
            }
            let (mut outside, mut inside) = (previous, factor);
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (outside + inside);
                if feasible(value(middle)) { inside = middle } else { outside = middle }
            }
            let edge = value(inside);
            return Some(rounded(edge, direction, &feasible).unwrap_or(edge));
        }
    }
    None
}

/// The edge of the feasible range rounded into it, with the fewest significant digits that remain
/// feasible.
fn rounded(edge: f64, direction: Direction, feasible: impl Fn(f64) -> bool) -> Option<f64> {
    let magnitude = libm::floor(libm::log10(edge));
    SIGNIFICANT_DIGITS.clone().find_map(|digits| {
        let unit = libm::pow(10.0, magnitude - f64::from(digits - 1));
        let whole = match direction {
            Direction::Up => libm::ceil(edge / unit),
            Direction::Down => libm::floor(edge / unit),
        };
        // Through text, so that the value prints with exactly these digits.
        let value: f64 = format!("{:.*e}", usize::from(digits - 1), whole * unit).parse().ok()?;
        feasible(value).then_some(value)
    })
}
