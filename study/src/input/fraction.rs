//! Fractions of the command line: a number, or a percentage with its sign.
//!
//! ```text
//! 0.02 = "2 %"
//! ```

use super::units::{self, Dimension};

/// What a relative error may be, for messages.
pub const RELATIVE_ERROR: &str = "a relative error above 0 and below 1, as 0.02 or \"2 %\"";

/// A fraction as an option of a command gives it: 0.02 or 2 %.
pub fn fraction(text: &str) -> Option<f64> {
    text.trim().parse().ok().or_else(|| units::parse(text, Dimension::Number).ok())
}

/// A relative error as an option of a command gives it.
pub fn relative_error(text: &str) -> Option<f64> {
    fraction(text).filter(|number| *number > 0.0 && *number < 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fraction_is_a_number_or_a_percentage() {
        for text in ["0.02", "2e-2", "2 %", "2%", " 0.02 ", " 2 % "] {
            assert_eq!(relative_error(text), Some(0.02), "{text:?}");
        }
        for text in ["", "two", "2 mm", "2 %%", "0", "1", "-0.1", "100 %", "NaN", "inf"] {
            assert_eq!(relative_error(text), None, "{text:?}");
        }
        assert_eq!(fraction("0"), Some(0.0));
    }
}
