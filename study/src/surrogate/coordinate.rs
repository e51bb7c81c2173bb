//! An input as a coordinate from 0 to 1.

use crate::input::value::Value;

/// A range is even in its logarithm from this ratio of its ends on. Chosen: a range over which a factor matters, not a
/// difference.
const LOG_RATIO: f64 = 10.0;

/// An input of a surrogate.
#[derive(Debug, Clone, PartialEq)]
pub enum Coordinate {
    /// A number between two, evenly.
    Linear([f64; 2]),
    /// A positive number between two, evenly in the logarithm.
    Log([f64; 2]),
    /// A whole number between two, both counted.
    Whole([f64; 2]),
    /// One of these values.
    Word(Vec<Value>),
}

impl Coordinate {
    /// The coordinate of a number between these.
    pub fn between([low, high]: [f64; 2]) -> Self {
        if low > 0.0 && high >= LOG_RATIO * low {
            Self::Log([low, high])
        } else {
            Self::Linear([low, high])
        }
    }

    /// The coordinate in which these values lie: numbers, or words where one is not a number.
    pub fn of_values<'a>(values: impl Iterator<Item = &'a Value> + Clone) -> Self {
        let numbers: Option<Vec<f64>> = values.clone().map(Value::any_number).collect();
        let Some(numbers) = numbers else {
            let mut words: Vec<Value> = Vec::new();
            for value in values {
                if !words.contains(value) {
                    words.push(value.clone());
                }
            }
            words.sort_by_key(Value::to_string);
            return Self::Word(words);
        };
        let low = numbers.iter().copied().fold(f64::INFINITY, f64::min);
        Self::between([low, numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max)])
    }

    /// Whether it is a word.
    pub fn is_word(&self) -> bool {
        matches!(self, Self::Word(_))
    }

    /// Where a value is: a number from 0 to 1, or the position of a word.
    pub fn place(&self, value: &Value) -> f64 {
        let number = value.any_number().unwrap_or(f64::NAN);
        match self {
            Self::Word(words) => {
                words.iter().position(|word| word == value).unwrap_or(words.len()) as f64
            }
            Self::Log([low, high]) => libm::log(number / low) / libm::log(high / low),
            Self::Linear([low, high]) | Self::Whole([low, high]) if high > low => {
                (number - low) / (high - low)
            }
            Self::Linear(_) | Self::Whole(_) => 0.0,
        }
    }

    /// The value at a place from 0 to 1: a number with four digits, more where the range is narrow; a whole number, of which
    /// each has an equal part of the range; a word likewise.
    pub fn value(&self, place: f64) -> Value {
        let place = place.clamp(0.0, 1.0);
        let short = |number: f64, [low, high]: [f64; 2]| {
            let narrow =
                libm::round(libm::log10(low.abs().max(high.abs()) / (high - low))).clamp(0.0, 12.0);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 12")]
            let digits = 3 + narrow as usize;
            let short: f64 = format!("{number:.digits$e}").parse().unwrap_or(number);
            Value::Number(short.clamp(low, high))
        };
        match self {
            Self::Linear([low, high]) => short(low + place * (high - low), [*low, *high]),
            Self::Log([low, high]) => short(low * libm::pow(high / low, place), [*low, *high]),
            Self::Whole([low, high]) => {
                let number = libm::floor(low + place * (high - low + 1.0)).min(*high);
                #[expect(clippy::cast_possible_truncation, reason = "whole numbers of a key")]
                Value::Integer(number as i64)
            }
            Self::Word(words) => {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "below the number of words"
                )]
                let position = (place * words.len() as f64) as usize;
                words[position.min(words.len() - 1)].clone()
            }
        }
    }
}
