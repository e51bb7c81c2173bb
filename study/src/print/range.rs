//! The values of several runs in one cell: "12.3 [11.9 to 13.1]".

use crate::input::units::DisplayUnit;
use crate::input::value::short_number;

/// What is between a value and its uncertainty.
const PLUS_MINUS: &str = " ± ";
/// Significant digits of a cell, at least. More are shown where the range would vanish otherwise.
const MIN_DIGITS: usize = 3;
/// Significant digits of a cell, at most.
const MAX_DIGITS: usize = 6;
/// Significant digits of a value without a range.
const DIGITS_ALONE: usize = 4;

/// Power of ten of an error whose digits are all written, at most.
const MAX_EXPONENT: i32 = 4;
/// Decimals of a value with an error, at most.
const MAX_DECIMALS: usize = 9;

/// A number with this many significant digits.
fn rounded(number: f64, digits: usize) -> f64 {
    format!("{number:.*e}", digits.saturating_sub(1)).parse().unwrap_or(number)
}

/// A value in a unit, without the unit, with its smallest and largest value and its uncertainty below and above it:
/// "12.3 [11.9 to 13.1] ± 0.4", "12.3 −0.6 +0.2". Equal values are one number.
pub fn text(
    value: f64,
    ends: Option<(f64, f64)>,
    error: Option<[f64; 2]>,
    unit: &DisplayUnit,
) -> String {
    let with = |digits| {
        let (least, largest) = ends?;
        let text = |number| short_number(rounded(unit.number(number), digits));
        let [value, least, largest] = [value, least, largest].map(text);
        (least != largest).then(|| format!("{value} [{least} to {largest}]"))
    };
    let range = (MIN_DIGITS..=MAX_DIGITS).find_map(with);
    match (range, error.map(|error| with_error(value, error, unit))) {
        (Some(range), Some((_, error))) => format!("{range}{error}"),
        (Some(range), None) => range,
        (None, Some((value, error))) => format!("{value}{error}"),
        (None, None) => short_number(rounded(unit.number(value), DIGITS_ALONE)),
    }
}

/// A value in a unit, without the unit, and its error below and above it: "0.1847" and " ± 0.0091". The larger side has
/// two digits, the other and the value as many decimals.
fn with_error(value: f64, sides: [f64; 2], unit: &DisplayUnit) -> (String, String) {
    let shown = unit.number(value);
    // A unit may have an offset, as °C has; a difference has none.
    let sides = sides.map(|side| (unit.number(value + side) - shown).abs());
    let largest = sides[0].max(sides[1]);
    // As in "9.1e-3".
    let scientific = format!("{largest:.1e}");
    let exponent =
        scientific.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok());
    let (value, [below, above]) = match exponent {
        Some(exponent) if exponent > MAX_EXPONENT && largest.is_finite() => {
            let short = |number: f64| short_number(rounded(number, 2));
            (short_number(rounded(shown, DIGITS_ALONE)), sides.map(short))
        }
        Some(exponent) if largest > 0.0 && largest.is_finite() => {
            let decimals = usize::try_from(1 - exponent).unwrap_or(0);
            if decimals > MAX_DECIMALS {
                let value = short_number(rounded(shown, MAX_DIGITS));
                (value, sides.map(|side| format!("{side:.1e}")))
            } else {
                (format!("{shown:.decimals$}"), sides.map(|side| format!("{side:.decimals$}")))
            }
        }
        _ => return (short_number(rounded(shown, DIGITS_ALONE)), String::new()),
    };
    let error = if below == above {
        format!("{PLUS_MINUS}{below}")
    } else {
        format!(" −{below} +{above}")
    };
    (value, error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_the_digits_that_show_it() {
        let milliseconds = DisplayUnit::new("ms", "s").unwrap();
        let shown =
            |value, least, largest| text(value, Some((least, largest)), None, &milliseconds);
        assert_eq!(shown(0.143_21, 0.138_77, 0.150_02), "143 [139 to 150]");
        assert_eq!(shown(0.143_23, 0.143_21, 0.143_25), "143.23 [143.21 to 143.25]");
        assert_eq!(shown(0.143_21, 0.143_21, 0.143_21), "143.2");
        assert_eq!(text(-0.0021, None, None, &milliseconds), "-2.1");
    }

    #[test]
    fn an_error_has_two_digits_and_its_value_as_many_decimals() {
        let seconds = DisplayUnit::si("s");
        let milliseconds = DisplayUnit::new("ms", "s").unwrap();
        let shown = |value, sides, unit| text(value, None, Some(sides), unit);
        assert_eq!(shown(0.184_664, [0.009_12; 2], &seconds), "0.1847 ± 0.0091");
        assert_eq!(shown(0.184_664, [0.009_12; 2], &milliseconds), "184.7 ± 9.1");
        assert_eq!(shown(23.638, [2.44; 2], &seconds), "23.6 ± 2.4");
        assert_eq!(shown(0.97, [0.000_12; 2], &seconds), "0.97000 ± 0.00012");
        assert_eq!(shown(1234.5, [210.0; 2], &seconds), "1234 ± 210");
        assert_eq!(shown(25.269, [1.0; 2], &seconds), "25.3 ± 1.0");
        assert_eq!(shown(1.0, [0.0; 2], &seconds), "1");
        assert_eq!(shown(2.4e7, [13_284_708.0, 18_211_422.0], &seconds), "2.4e7 −1.3e7 +1.8e7");
        assert_eq!(shown(23.638, [6.31, 0.82], &seconds), "23.6 −6.3 +0.8");
        assert_eq!(shown(0.184_664, [0.0, 0.009_12], &milliseconds), "184.7 −0.0 +9.1");
        assert_eq!(
            text(0.3, Some((0.1, 0.4)), Some([0.2, 0.1]), &seconds),
            "0.3 [0.1 to 0.4] −0.20 +0.10"
        );
    }
}
