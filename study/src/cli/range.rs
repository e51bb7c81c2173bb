//! The values of several runs in one cell: "12.3 [11.9 to 13.1]".

use crate::analysis::statistics::Spread;
use crate::input::units::DisplayUnit;
use crate::input::value::short_number;

/// Significant digits of a cell, at least. More are shown where the range would vanish otherwise.
const MIN_DIGITS: usize = 3;
/// Significant digits of a cell, at most.
const MAX_DIGITS: usize = 6;
/// Significant digits of a value without a range.
const DIGITS_ALONE: usize = 4;

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
}
