//! A value of a key, a parameter or a table cell, and its text.

use std::fmt;

use serde::{Deserialize, Serialize};

/// One value of a key, an axis or a table cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Value {
    /// No value: not given, or it never happened.
    Null,
    /// True or false.
    Bool(bool),
    /// Whole number.
    Integer(i64),
    /// Number, SI.
    Number(f64),
    /// Text.
    Text(String),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Null => f.write_str("null"),
            Self::Bool(value) => write!(f, "{value}"),
            Self::Integer(value) => write!(f, "{value}"),
            Self::Number(value) => write!(f, "{value}"),
            Self::Text(value) => f.write_str(value),
        }
    }
}

impl Value {
    /// The number it holds; `None` for a whole number, a text, …
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }

    /// The number it holds, also a whole one.
    pub fn any_number(&self) -> Option<f64> {
        match self {
            Self::Integer(number) => Some(*number as f64),
            other => other.number(),
        }
    }

    /// Its text for a reader: a number has six significant digits.
    pub fn short(&self) -> String {
        match self {
            Self::Number(number) => short_number(*number),
            other => other.to_string(),
        }
    }
}

/// What becomes a value as it stands.
macro_rules! from {
    ($($type:ty, $value:ident => $made:expr;)*) => {
        $(impl From<$type> for Value {
            fn from($value: $type) -> Self {
                $made
            }
        })*
    };
}

from! {
    bool, value => Self::Bool(value);
    f64, value => Self::Number(value);
    i64, value => Self::Integer(value);
    u32, value => Self::Integer(value.into());
    u64, value => Self::Integer(i64::try_from(value).unwrap_or(i64::MAX));
    usize, value => Self::Integer(i64::try_from(value).unwrap_or(i64::MAX));
    &str, value => Self::Text(value.to_owned());
    String, value => Self::Text(value);
}

impl<T: Into<Value>> From<Option<T>> for Value {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Null, T::into)
    }
}

/// A value as JSON; a non-finite number is `null`.
pub fn json_value(value: &Value) -> serde_json::Value {
    match value {
        Value::Null => serde_json::Value::Null,
        Value::Bool(value) => (*value).into(),
        Value::Integer(value) => (*value).into(),
        Value::Number(value) => (*value).into(),
        Value::Text(value) => value.as_str().into(),
    }
}

/// A number to six significant digits, without trailing zeros; with a power of ten below 1e-4 and
/// from 1e7 on.
pub fn short_number(number: f64) -> String {
    if !number.is_finite() {
        return number.to_string();
    }
    if number == 0.0 {
        return "0".to_owned();
    }
    let scientific = format!("{number:.5e}");
    let Some((mantissa, Ok(exponent))) =
        scientific.split_once('e').map(|(mantissa, exponent)| (mantissa, exponent.parse::<i32>()))
    else {
        return scientific;
    };
    if (-4..7).contains(&exponent) {
        let decimals = usize::try_from(5 - exponent).unwrap_or(0);
        trim_zeros(&format!("{number:.decimals$}")).to_owned()
    } else {
        format!("{}e{exponent}", trim_zeros(mantissa))
    }
}

/// A number to four significant digits, for lines of text.
pub fn brief_number(number: f64) -> String {
    format!("{number:.3e}").parse().map_or_else(|_| number.to_string(), short_number)
}

/// Numbers as text: the one, or the smallest and the largest; `None` without any.
pub fn range_text(
    numbers: impl IntoIterator<Item = f64>,
    text: fn(f64) -> String,
) -> Option<String> {
    let ends = numbers.into_iter().map(|number| [number; 2]);
    let ends = ends.reduce(|[low, high], [number, _]| [low.min(number), high.max(number)]);
    let [low, high] = ends?.map(text);
    Some(if low == high { low } else { format!("{low} to {high}") })
}

fn trim_zeros(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_numbers_keep_six_digits() {
        for (number, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1"),
            (0.005, "0.005"),
            (1_000_000.0, "1000000"),
            (123_456_789.0, "1.23457e8"),
            (25.4e-6, "2.54e-5"),
            (std::f64::consts::PI, "3.14159"),
            (-0.999_999_96, "-1"),
        ] {
            assert_eq!(short_number(number), text);
        }
        assert_eq!(brief_number(0.123_456), "0.1235");
        assert_eq!(brief_number(f64::NAN), "NaN");
    }
}
