//! Axes given as a range: values from one end to the other, evenly or logarithmically spaced.
//!
//! ```text
//! n steps, linear:  x_i = from + i (to − from)/(n − 1)
//! n steps, log:     x_i = from exp(i ln(to/from)/(n − 1))
//! step h:           x_i = from + i h, up to `to`, which is one of them
//! ```

use crate::input::json::Json;
use crate::input::keys::{Key, KeyKind, RANGE_KEYS};
use crate::input::object::Object;
use crate::input::source::Source;
use crate::input::units;
use crate::input::value::Value;
use crate::platform::error::InputError;

/// What a range must look like, for errors.
const ALLOWED: &str = "{\"from\", \"to\", and \"steps\" (number of values) or \"step\", \
                       \"spacing\": linear or log}";

/// The values of a range of a key; `path` is its place in the file, as in `grid.N`.
pub(super) fn values(
    key: &Key,
    json: &Json,
    path: &str,
    source: &Source,
    max_points: usize,
) -> Result<Vec<Value>, InputError> {
    let refuse = |problem: &str| source.error(path, json, problem, ALLOWED);
    let (KeyKind::Quantity(_) | KeyKind::Integer(..)) = key.kind else {
        return Err(refuse("is a range of a key that does not hold numbers"));
    };
    let object = Object::new(json, path, "a range", RANGE_KEYS, &["from", "to", "step"], source)?;
    let end = |name: &str| match object.given(name) {
        Some(json) => key.finite(json, &format!("{path}.{name}"), source),
        None => Err(refuse("has no `from` or no `to`")),
    };
    let (from, to) = (end("from")?, end("to")?);
    if from >= to {
        return Err(refuse("`from` is not below `to`"));
    }
    let is_log = object.text("spacing")?.as_deref() == Some("log");
    if is_log && from <= 0.0 {
        return Err(refuse("has logarithmic spacing, so `from` must be above 0"));
    }
    let count = match (object.given("steps"), object.given("step")) {
        (Some(_), None) => object.count("steps")?.into(),
        (None, Some(_)) if is_log => {
            return Err(refuse("has logarithmic spacing, so it needs `steps`"));
        }
        (None, Some(step)) => {
            let step = width(key, step).ok_or_else(|| {
                refuse("`step` is not a positive quantity of the key's dimension")
            })?;
            // A last value that is above `to` by rounding alone belongs to the range.
            let widths = (to - from) / step * (1.0 + 1e-12);
            if widths - widths.floor() > 2e-12 * widths {
                let last = rounded(from + step * widths.floor());
                let problem = format!("does not end at `to`: its last step is {last}");
                return Err(refuse(&problem));
            }
            widths.floor() + 1.0
        }
        _ => return Err(refuse("needs either `steps` or `step`")),
    };
    if count > max_points as f64 {
        let problem = format!("has {count:.0} values; a grid may have {max_points} points");
        return Err(refuse(&problem));
    }
    let step = object.given("step").and_then(|step| width(key, step));
    let number = |index: u32| {
        let i = f64::from(index);
        match step {
            Some(step) => rounded(from + step * i).min(to),
            // The ends are exactly as written.
            None if index == 0 => from,
            None if i >= count - 1.0 => to,
            None if is_log => rounded(from * libm::exp(libm::log(to / from) / (count - 1.0) * i)),
            None => rounded(from + (to - from) / (count - 1.0) * i),
        }
    };
    let value = |index: u32| {
        let path = format!("{path} (value {})", index + 1);
        key.value_silently(&Json::Number(number(index)), &path, source)
    };
    (0..).take_while(|index| f64::from(*index) < count).map(value).collect()
}

/// A positive width, SI. It has the dimension of the key, but need not be an allowed value itself.
pub(super) fn width(key: &Key, json: &Json) -> Option<f64> {
    let number = match (json, key.kind) {
        (Json::Integer(number), _) => Some(*number as f64),
        (Json::Number(number), _) => Some(*number),
        (Json::Text(text), KeyKind::Quantity(quantity)) => {
            units::parse_powers(text, quantity.dimension.powers()).ok()
        }
        _ => None,
    };
    number.filter(|width| *width > 0.0)
}

/// The number with fifteen digits, where only rounding separates it from this one. So a range gives
/// the same values, and the same jobs, as the list that a user writes.
fn rounded(number: f64) -> f64 {
    match format!("{number:.14e}").parse::<f64>() {
        Ok(short) if (short - number).abs() <= 1e-14 * number.abs() => short,
        _ => number,
    }
}
