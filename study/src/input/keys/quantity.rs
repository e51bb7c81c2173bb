//! The numbers that keys may hold: quantities with a unit, and whole numbers.

use std::fmt::Write as _;

use crate::input::json::Json;
use crate::input::units::{self, Dimension};
use crate::input::value::{Value, short_number};

/// The numbers a quantity may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Dimension.
    pub dimension: Dimension,
    /// Lower bound, SI.
    pub min: f64,
    /// Whether `min` itself is refused.
    pub above: bool,
    /// Upper bound, SI; allowed.
    pub max: f64,
    /// Range outside of which a unit is probably missing, SI; 0 is always plausible. `None` where no
    /// range is.
    pub plausible: Option<[f64; 2]>,
    /// Words that stand for a number.
    pub words: &'static [(&'static str, f64)],
}

impl Quantity {
    /// The range with its SI unit, as in "above 0 to 100 m".
    pub fn range(&self) -> String {
        let unit = if self.dimension == Dimension::Number { "" } else { self.dimension.si() };
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        let from = if self.above { "above " } else { "from " };
        format!("{from}{} to {}{unit}", short_number(self.min), short_number(self.max))
    }

    /// The plausible range with its SI unit, as in "0 to 0.02 kg".
    pub fn plausible_range(&self) -> Option<String> {
        let [low, high] = self.plausible?.map(short_number);
        Some(format!("{low} to {high} {}", self.dimension.si()))
    }

    /// Whether a number is in the plausible range.
    pub fn is_plausible(&self, number: f64) -> bool {
        let within = |[low, high]: [f64; 2]| (low..=high).contains(&number);
        number == 0.0 || self.plausible.is_none_or(within)
    }

    /// What the quantity allows, in words.
    pub(super) fn allowed(&self) -> String {
        let mut text = format!("{} {}", self.dimension.name(), self.range());
        if self.dimension != Dimension::Number {
            let _ = write!(
                text,
                ", as a number in {} or a text with a unit ({})",
                self.dimension.si(),
                self.dimension.units().join(", ")
            );
        }
        for (word, _) in self.words {
            let _ = write!(text, ", or {word:?}");
        }
        text
    }

    /// Reads a number in SI, a text with a unit, or a word.
    pub(crate) fn read(&self, json: &Json) -> Result<Value, String> {
        let number = match json {
            Json::Integer(number) => *number as f64,
            Json::Number(number) => *number,
            Json::Text(text) => {
                if self.words.iter().any(|(word, _)| word == text) {
                    return Ok(Value::Text(text.clone()));
                }
                units::parse_powers(text, self.dimension.powers())?
            }
            other => {
                return Err(format!("is {}, not {}", other.kind(), self.dimension.name()));
            }
        };
        self.check(number)?;
        // −0 and 0 are the same input.
        Ok(Value::Number(if number == 0.0 { 0.0 } else { number }))
    }

    fn check(&self, number: f64) -> Result<(), String> {
        let high_enough = if self.above { number > self.min } else { number >= self.min };
        if high_enough && number <= self.max { Ok(()) } else { Err("is out of range".to_owned()) }
    }

    /// The number a value stands for: the value itself, or the number of its word.
    pub fn number(&self, value: &Value) -> Option<f64> {
        match value {
            Value::Number(number) => Some(*number),
            Value::Integer(number) => Some(*number as f64),
            Value::Text(text) => {
                self.words.iter().find(|(word, _)| word == text).map(|(_, number)| *number)
            }
            Value::Null | Value::Bool(_) => None,
        }
    }
}

/// Reads a whole number from `min` to `max`.
pub(super) fn integer(json: &Json, min: i64, max: i64) -> Result<Value, String> {
    let number = match json {
        Json::Integer(number) => Some(*number),
        Json::Number(number) => whole(*number),
        Json::Text(text) if text.trim().parse::<f64>().is_ok() => {
            return Err("is a text; write the number without quotes".to_owned());
        }
        other => return Err(format!("is {}, not a whole number", other.kind())),
    };
    match number {
        Some(number) if (min..=max).contains(&number) => Ok(Value::Integer(number)),
        Some(_) => Err("is out of range".to_owned()),
        None => Err("is not a whole number".to_owned()),
    }
}

/// A float that is a whole number within ±2^53.
#[expect(clippy::cast_possible_truncation, reason = "checked to be whole and small")]
pub(crate) fn whole(number: f64) -> Option<i64> {
    (number.fract() == 0.0 && number.abs() <= 9_007_199_254_740_992.0).then_some(number as i64)
}
