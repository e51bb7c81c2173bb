//! The values of several runs in one cell: "12.3 [11.9 to 13.1]".

use super::legend::PLUS_MINUS;
use crate::analysis::statistics::Spread;
use crate::input::units::DisplayUnit;
use crate::input::value::short_number;

/// Significant digits of a cell, at least. More are shown where the range would vanish otherwise.
const MIN_DIGITS: usize = 3;
/// Significant digits of a cell, at most.
const MAX_DIGITS: usize = 6;
/// Significant digits of a value without a range.
const DIGITS_ALONE: usize = 4;

/// Decimals of a value with an error, at most.
const MAX_DECIMALS: usize = 9;

/// A number with this many significant digits.
pub fn rounded(number: f64, digits: usize) -> f64 {
    format!("{number:.*e}", digits.saturating_sub(1)).parse().unwrap_or(number)
}

/// Median, smallest and largest value in a unit, without the unit: "12.3 [11.9 to 13.1]". Equal values are
/// one number. `runs` is the number of runs that could have a value: where fewer have one, the cell says
/// how many.
pub fn text(spread: &Spread, unit: &DisplayUnit, runs: usize) -> String {
    let numbers = [spread.median, spread.least, spread.largest].map(|number| unit.number(number));
    let with = |digits| numbers.map(|number| short_number(rounded(number, digits)));
    let differing =
        (MIN_DIGITS..=MAX_DIGITS).map(with).find(|[_, least, largest]| least != largest);
    let text = match differing {
        Some([median, least, largest]) => format!("{median} [{least} to {largest}]"),
        None => short_number(rounded(numbers[0], DIGITS_ALONE)),
    };
    if spread.count < runs { format!("{text} ({} of {runs})", spread.count) } else { text }
}

/// A value with its error in a unit, without the unit: "0.1847 ± 0.0091". The error has two digits, the value as
/// many decimals.
pub fn with_error(value: f64, error: f64, unit: &DisplayUnit) -> String {
    let shown = unit.number(value);
    // A unit may have an offset, as °C has; a difference has none.
    let error = (unit.number(value + error) - shown).abs();
    // As in "9.1e-3".
    let scientific = format!("{error:.1e}");
    let exponent =
        scientific.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok());
    match exponent {
        Some(exponent) if error > 0.0 && error.is_finite() => {
            let decimals = usize::try_from(1 - exponent).unwrap_or(0);
            if decimals > MAX_DECIMALS {
                return format!(
                    "{}{PLUS_MINUS}{scientific}",
                    short_number(rounded(shown, MAX_DIGITS))
                );
            }
            format!("{shown:.decimals$}{PLUS_MINUS}{error:.decimals$}")
        }
        _ => short_number(rounded(shown, DIGITS_ALONE)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(numbers: &[f64], runs: usize) -> String {
        let milliseconds = DisplayUnit::new("ms", "s").unwrap();
        text(&Spread::of(numbers.iter().copied()).unwrap(), &milliseconds, runs)
    }

    #[test]
    fn a_range_has_the_digits_that_show_it() {
        assert_eq!(shown(&[0.143_21, 0.138_77, 0.150_02], 3), "143 [139 to 150]");
        assert_eq!(shown(&[0.143_21, 0.143_25], 2), "143.23 [143.21 to 143.25]");
        assert_eq!(shown(&[0.143_21, 0.143_21], 2), "143.2");
        assert_eq!(shown(&[0.1, 0.2], 5), "150 [100 to 200] (2 of 5)");
        assert_eq!(shown(&[-0.0021], 1), "-2.1");
    }

    #[test]
    fn an_error_has_two_digits_and_its_value_as_many_decimals() {
        let seconds = DisplayUnit::si("s");
        let milliseconds = DisplayUnit::new("ms", "s").unwrap();
        assert_eq!(with_error(0.184_664, 0.009_12, &seconds), "0.1847 ± 0.0091");
        assert_eq!(with_error(0.184_664, 0.009_12, &milliseconds), "184.7 ± 9.1");
        assert_eq!(with_error(23.638, 2.44, &seconds), "23.6 ± 2.4");
        assert_eq!(with_error(0.97, 0.000_12, &seconds), "0.97000 ± 0.00012");
        assert_eq!(with_error(1234.5, 210.0, &seconds), "1234 ± 210");
        assert_eq!(with_error(25.269, 1.0, &seconds), "25.3 ± 1.0");
        assert_eq!(with_error(1.0, 0.0, &seconds), "1");
    }
}
