//! Axes given as a range: values from one end to the other, evenly or logarithmically spaced.
//!
//! ```text
//! n steps, linear:  x_i = from + i (to − from)/(n − 1)
//! n steps, log:     x_i = from exp(i ln(to/from)/(n − 1))
//! step h:           x_i = from + i h, up to `to`, which is one of them
//! ```

use super::plan_size::PlanSize;
use crate::input::json::Json;
use crate::input::keys::{Key, KeyKind};
use crate::input::settings::{read, read_silently};
use crate::input::source::Source;
use crate::input::units;
use crate::input::value::Value;
use crate::platform::error::InputError;

/// What a range must look like, for errors.
const ALLOWED: &str = "{\"from\", \"to\", and \"steps\" (number of values) or \"step\", \
                       \"spacing\": linear or log}";

/// A range in the file.
pub(super) struct RangeInput<'a> {
    /// The key it varies.
    pub key: &'a Key,
    /// Its members.
    pub members: &'a [(String, Json)],
    /// The whole object, for errors.
    pub json: &'a Json,
    /// Its place in the file, as in `grid.N`.
    pub path: &'a str,
    pub source: &'a Source,
}

/// How the values of a range are spaced.
enum Spacing {
    /// This number of values, evenly spaced.
    Linear(usize),
    /// This number of values, evenly spaced in their logarithm.
    Log(usize),
    /// This step, in the unit of the key.
    Step(f64),
}

impl RangeInput<'_> {
    /// The values of the range.
    ///
    /// # Errors
    /// When the range is incomplete or contradicts itself, has more values than a grid has points, or
    /// has a value that the key does not allow.
    pub fn values(&self, size: PlanSize) -> Result<Vec<Value>, InputError> {
        let (KeyKind::Quantity(_) | KeyKind::Integer(..)) = self.key.kind else {
            return self.refuse("is a range of a key that does not hold numbers");
        };
        let spacing = self.spacing()?;
        let (Some(from), Some(to)) = (self.end("from")?, self.end("to")?) else {
            return self.refuse("has no `from` or no `to`");
        };
        if from >= to {
            return self.refuse("`from` is not below `to`");
        }
        let numbers = match spacing {
            Spacing::Linear(steps) => self.linear(from, to, steps, size)?,
            Spacing::Log(steps) => self.logarithmic(from, to, steps, size)?,
            Spacing::Step(step) => self.stepped(from, to, step, size)?,
        };
        let value = |(index, number)| {
            let path = format!("{} (value {})", self.path, index + 1);
            read_silently(self.key, &Json::Number(number), &path, self.source)
        };
        numbers.into_iter().enumerate().map(value).collect()
    }

    fn error(&self, problem: &str) -> InputError {
        self.source.error(self.path, &self.json.brief(), problem, ALLOWED)
    }

    fn refuse<T>(&self, problem: &str) -> Result<T, InputError> {
        Err(self.error(problem))
    }

    fn member(&self, name: &str) -> Option<&Json> {
        self.members.iter().find(|(member, _)| member == name).map(|(_, json)| json)
    }

    /// One end of the range, SI.
    fn end(&self, name: &str) -> Result<Option<f64>, InputError> {
        let Some(json) = self.member(name) else { return Ok(None) };
        let path = format!("{}.{name}", self.path);
        match read(self.key, json, &path, self.source)? {
            Value::Number(number) => Ok(Some(number)),
            Value::Integer(number) => Ok(Some(number as f64)),
            _ => Err(self.source.error(&path, &json.brief(), "is a word, not a number", ALLOWED)),
        }
    }

    fn spacing(&self) -> Result<Spacing, InputError> {
        let (mut steps, mut log) = (None, false);
        for (name, value) in self.members {
            match (name.as_str(), value) {
                ("from" | "to" | "step", _) => {}
                ("steps", Json::Integer(count)) if *count >= 2 => {
                    steps = Some(usize::try_from(*count).unwrap_or(usize::MAX));
                }
                ("spacing", Json::Text(spacing)) if spacing == "linear" => log = false,
                ("spacing", Json::Text(spacing)) if spacing == "log" => log = true,
                ("steps", _) => return self.refuse("`steps` is not a whole number of 2 or more"),
                ("spacing", _) => {
                    return self.refuse("`spacing` is neither \"linear\" nor \"log\"");
                }
                (other, _) => return self.refuse(&format!("`{other}` is not a key of a range")),
            }
        }
        match (steps, self.step()?) {
            (Some(_), Some(_)) | (None, None) => self.refuse("needs either `steps` or `step`"),
            (Some(steps), None) if log => Ok(Spacing::Log(steps)),
            (Some(steps), None) => Ok(Spacing::Linear(steps)),
            (None, Some(_)) if log => self.refuse("has logarithmic spacing, so it needs `steps`"),
            (None, Some(step)) => Ok(Spacing::Step(step)),
        }
    }

    /// The step, SI. It has the dimension of the key, but need not be an allowed value itself.
    fn step(&self) -> Result<Option<f64>, InputError> {
        let Some(step) = self.member("step") else { return Ok(None) };
        let number = match (step, self.key.kind) {
            (Json::Integer(number), _) => Some(*number as f64),
            (Json::Number(number), _) => Some(*number),
            (Json::Text(text), KeyKind::Quantity(quantity)) => {
                units::parse_powers(text, quantity.dimension.powers()).ok()
            }
            _ => None,
        };
        match number {
            Some(step) if step > 0.0 => Ok(Some(step)),
            _ => self.refuse("`step` is not a positive quantity of the key's dimension"),
        }
    }

    fn check_count(&self, count: f64, size: PlanSize) -> Result<(), InputError> {
        if count <= size.points as f64 {
            return Ok(());
        }
        let limit = size.points;
        self.refuse(&format!("has {count:.0} values; a grid may have {limit} points"))
    }

    fn linear(
        &self,
        from: f64,
        to: f64,
        steps: usize,
        size: PlanSize,
    ) -> Result<Vec<f64>, InputError> {
        self.check_count(steps as f64, size)?;
        let width = (to - from) / (steps - 1) as f64;
        Ok(with_ends((0..steps).map(|i| rounded(from + width * i as f64)).collect(), from, to))
    }

    fn logarithmic(
        &self,
        from: f64,
        to: f64,
        steps: usize,
        size: PlanSize,
    ) -> Result<Vec<f64>, InputError> {
        self.check_count(steps as f64, size)?;
        if from <= 0.0 {
            return self.refuse("has logarithmic spacing, so `from` must be above 0");
        }
        let ratio = libm::log(to / from) / (steps - 1) as f64;
        let values = (0..steps).map(|i| rounded(from * libm::exp(ratio * i as f64)));
        Ok(with_ends(values.collect(), from, to))
    }

    fn stepped(
        &self,
        from: f64,
        to: f64,
        step: f64,
        size: PlanSize,
    ) -> Result<Vec<f64>, InputError> {
        // A last value that is above `to` by rounding alone belongs to the range.
        let widths = (to - from) / step * (1.0 + 1e-12);
        let count = widths.floor() + 1.0;
        if widths - widths.floor() > 2e-12 * widths {
            let last = rounded(from + step * widths.floor());
            return self.refuse(&format!("does not end at `to`: its last step is {last}"));
        }
        self.check_count(count, size)?;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a whole number from 1 to the limit of points"
        )]
        let count = count as usize;
        Ok((0..count).map(|i| rounded(from + step * i as f64).min(to)).collect())
    }
}

/// The values with the ends exactly as written.
fn with_ends(mut numbers: Vec<f64>, from: f64, to: f64) -> Vec<f64> {
    if let [first, .., last] = numbers.as_mut_slice() {
        (*first, *last) = (from, to);
    }
    numbers
}

/// The number with fifteen digits, where only rounding separates it from this one. So a range gives
/// the same values, and the same jobs, as the list that a user writes.
fn rounded(number: f64) -> f64 {
    match format!("{number:.14e}").parse::<f64>() {
        Ok(short) if (short - number).abs() <= 1e-14 * number.abs() => short,
        _ => number,
    }
}
