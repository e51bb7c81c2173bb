//! Ticks of an axis: steps of 1, 2 or 5 times a power of ten, and their texts.

use super::scale::Spread;
use crate::input::value::short_number;

/// A tick: its value and its text.
pub type Tick = (f64, String);

/// At most `most` (at least 2) ticks of an axis.
pub fn of(spread: Spread, [low, high]: [f64; 2], most: usize) -> Vec<Tick> {
    match spread {
        Spread::Linear => linear(low, high, most),
        Spread::Logarithmic => logarithmic(low, high, most),
    }
}

/// Ticks at the multiples of a round step within `low ..= high`. The step is the smallest of 1, 2, 5 times a
/// power of ten that gives at most `most` (at least 2) ticks.
pub fn linear(low: f64, high: f64, most: usize) -> Vec<Tick> {
    let span = high - low;
    if !(span > 0.0 && span.is_finite()) {
        return vec![(low, short_number(low))];
    }
    let least = span / most.max(2) as f64;
    let decade = libm::pow(10.0, libm::floor(libm::log10(least)));
    for factor in [1.0, 2.0, 5.0, 10.0, 20.0, 50.0] {
        let step = factor * decade;
        // A tick outside by a rounding error is inside.
        let rounding = 1e-9 * span;
        let (first, last) =
            (libm::ceil((low - rounding) / step), libm::floor((high + rounding) / step));
        let count = last - first + 1.0;
        if count <= most.max(2) as f64 {
            return (0..most.max(2))
                .map(|number| first + number as f64)
                .take_while(|multiple| *multiple <= last)
                .map(|multiple| (multiple * step, tick_text(multiple * step, step)))
                .collect();
        }
    }
    Vec::new()
}

/// A number with the decimals that its step needs.
fn tick_text(value: f64, step: f64) -> String {
    if value.abs() < 1e-9 * step {
        return "0".to_owned();
    }
    if !(1e-4..1e6).contains(&value.abs().max(step)) {
        return minus(&short_number(value));
    }
    let mut decimals = 0;
    let mut scaled = step;
    while decimals < 9 && (scaled - libm::round(scaled)).abs() > 1e-6 * scaled {
        scaled *= 10.0;
        decimals += 1;
    }
    minus(&format!("{value:.decimals$}"))
}

/// A number with a minus sign instead of a hyphen.
pub fn minus(number: &str) -> String {
    number.replace('-', "−")
}

/// Ticks of a logarithmic axis within `low ..= high`, both positive: 1, 2 and 5 of every decade if `most`
/// allows, else 1 of every decade, else 1 of every few decades. If that gives fewer than two, the ticks of a
/// linear axis.
pub fn logarithmic(low: f64, high: f64, most: usize) -> Vec<Tick> {
    if !(low > 0.0 && high > low && high.is_finite()) {
        return linear(low, high, most);
    }
    let rounding = 1e-9;
    let first = libm::floor(libm::log10(low) + rounding);
    let last = libm::ceil(libm::log10(high) - rounding);
    let inside = |value: &f64| (low * (1.0 - rounding)..=high * (1.0 + rounding)).contains(value);
    let decade_ticks = |mantissas: &[f64], stride: f64| -> Vec<Tick> {
        let mut ticks = Vec::new();
        let mut exponent = first;
        while exponent <= last {
            let decade = libm::pow(10.0, exponent);
            let values = mantissas.iter().map(|mantissa| mantissa * decade);
            ticks.extend(values.filter(inside).map(|value| (value, minus(&short_number(value)))));
            exponent += stride;
        }
        ticks
    };
    let mut choices = vec![decade_ticks(&[1.0, 2.0, 5.0], 1.0), decade_ticks(&[1.0], 1.0)];
    choices.extend((2..40).map(|stride| decade_ticks(&[1.0], f64::from(stride))));
    match choices.into_iter().find(|ticks| ticks.len() <= most.max(2)) {
        Some(ticks) if ticks.len() >= 2 => ticks,
        _ => linear(low, high, most),
    }
}

/// Zero is near a range if its one end is at most this fraction of its other end. Chosen: figures of one
/// study have equal baselines, and a range within a tenth of its value still shows its differences.
const NEAR_ZERO: f64 = 0.9;

/// A range that contains `low ..= high` with padding at both ends. It starts or ends at zero when zero is
/// near.
pub fn padded(low: f64, high: f64) -> (f64, f64) {
    let low = if low >= 0.0 && low <= NEAR_ZERO * high { 0.0 } else { low };
    let high = if high <= 0.0 && high >= NEAR_ZERO * low { 0.0 } else { high };
    let span = high - low;
    // A single value: a tenth of it on both sides.
    let padding = if span > 1e-9 * high.abs().max(low.abs()) {
        0.05 * span
    } else if high == 0.0 {
        1.0
    } else {
        0.1 * high.abs()
    };
    let below = if low == 0.0 && span > 0.0 { low } else { low - padding };
    let above = if high == 0.0 && span > 0.0 { high } else { high + padding };
    (below, above)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn texts(ticks: &[Tick]) -> Vec<&str> {
        ticks.iter().map(|(_, text)| text.as_str()).collect()
    }

    #[test]
    fn steps_are_round_and_numbers_short() {
        assert_eq!(texts(&linear(0.0, 1.05, 6)), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(texts(&linear(-12.0, 31.0, 6)), ["−10", "0", "10", "20", "30"]);
        assert_eq!(texts(&linear(3.2, 3.31, 4)), ["3.20", "3.25", "3.30"]);
        assert_eq!(texts(&linear(0.0, 2.5e7, 4)), ["0", "1e7", "2e7"]);
        assert_eq!(texts(&linear(7.0, 7.0, 4)), ["7"]);
    }

    #[test]
    fn a_logarithmic_axis_has_as_many_ticks_as_fit() {
        assert_eq!(texts(&logarithmic(1.0, 100.0, 8)), ["1", "2", "5", "10", "20", "50", "100"]);
        assert_eq!(texts(&logarithmic(1.0, 1e4, 6)), ["1", "10", "100", "1000", "10000"]);
        assert_eq!(texts(&logarithmic(0.01, 1e6, 5)), ["0.01", "1", "100", "10000", "1000000"]);
        assert!(logarithmic(3.0, 4.0, 5).len() >= 2);
    }

    #[test]
    fn ranges_start_at_zero_when_it_is_near() {
        assert_eq!(padded(0.1, 1.0), (0.0, 1.05));
        assert_eq!(padded(-2.0, -0.1), (-2.1, 0.0));
        let (low, high) = padded(290.0, 300.0);
        assert!((low - 289.5).abs() < 1e-9 && (high - 300.5).abs() < 1e-9);
        assert_eq!(padded(0.0, 0.0), (-1.0, 1.0));
        assert_eq!(padded(5.0, 5.0), (4.5, 5.5));
    }

    proptest! {
        #[test]
        fn ticks_lie_inside_the_range_in_order(
            low in -1e9..1e9_f64, exponent in -6..9_i32, most in 2..12_usize,
        ) {
            let high = low + libm::pow(10.0, f64::from(exponent)) * 1.7;
            prop_assume!(high - low > 1e-7 * low.abs());
            let ticks = linear(low, high, most);
            prop_assert!(ticks.len() <= most);
            prop_assert!(most < 4 || ticks.len() >= 2, "{:?}", ticks);
            let rounding = 1e-6 * (high - low);
            for pair in ticks.windows(2) {
                prop_assert!(pair[0].0 < pair[1].0);
            }
            for (value, _) in &ticks {
                prop_assert!((low - rounding..=high + rounding).contains(value));
            }
        }

        #[test]
        fn logarithmic_ticks_lie_inside(low in -9.0..9.0, decades in 0.1..12.0_f64, most in 2..12_usize) {
            let (low, high) = (libm::pow(10.0, low), libm::pow(10.0, low + decades));
            for (value, text) in logarithmic(low, high, most) {
                prop_assert!((low * 0.999_999..=high * 1.000_001).contains(&value));
                prop_assert!(!text.is_empty());
            }
        }

        #[test]
        fn a_padded_range_contains_its_range(a in -1e6..1e6, b in -1e6..1e6) {
            let (low, high) = (f64::min(a, b), f64::max(a, b));
            let (below, above) = padded(low, high);
            prop_assert!(below <= low && above >= high && above > below);
        }
    }
}
