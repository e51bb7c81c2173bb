//! Fractions: a number, or a percentage with its sign.
//!
//! ```text
//! 0.02 = "2 %"
//! ```

use super::json::Json;
use super::units::{self, Dimension};

/// What a relative error may be, for messages.
pub const RELATIVE_ERROR: &str = "a relative error above 0 and below 1, as 0.02 or \"2 %\"";

/// A fraction as an option of a command gives it: 0.02 or 2 %.
pub fn fraction(text: &str) -> Option<f64> {
    text.trim().parse().ok().or_else(|| percentage(text))
}

/// A relative error as an option of a command gives it.
pub fn relative_error(text: &str) -> Option<f64> {
    fraction(text).and_then(in_range)
}

/// A relative error as a file gives it: a number, or a text with its unit.
pub fn relative_error_in(json: &Json) -> Option<f64> {
    let number = match json {
        Json::Text(text) => percentage(text),
        Json::Number(number) => Some(*number),
        _ => None,
    };
    number.and_then(in_range)
}

fn percentage(text: &str) -> Option<f64> {
    units::parse(text, Dimension::Number).ok()
}

fn in_range(number: f64) -> Option<f64> {
    (number > 0.0 && number < 1.0).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fraction_is_a_number_or_a_percentage() {
        for text in ["0.02", "2e-2", "2 %", "2%", " 0.02 ", " 2 % "] {
            assert_eq!(fraction(text), Some(0.02), "{text:?}");
        }
        assert_eq!(fraction("0"), Some(0.0));
        for text in ["", "two", "2 mm", "2 %%"] {
            assert_eq!(fraction(text), None, "{text:?}");
        }
    }

    #[test]
    fn a_relative_error_lies_between_zero_and_one() {
        assert_eq!(relative_error("2 %"), Some(0.02));
        for text in ["0", "1", "-0.1", "100 %", "NaN", "inf"] {
            assert_eq!(relative_error(text), None, "{text:?}");
        }
        assert_eq!(relative_error_in(&Json::Number(0.02)), Some(0.02));
        assert_eq!(relative_error_in(&Json::Text("2 %".to_owned())), Some(0.02));
        // As everywhere in a file, a number stands without quotes.
        assert_eq!(relative_error_in(&Json::Text("0.02".to_owned())), None);
        assert_eq!(relative_error_in(&Json::Number(1.5)), None);
        assert_eq!(relative_error_in(&Json::Bool(true)), None);
    }
}
