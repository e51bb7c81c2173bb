//! Inflation strategies: named schedules of release, preinflation and inflow windows.

use crate::input::json::Json;
use crate::input::keys::{Key, STRATEGY_KEYS, WINDOW_KEYS};
use crate::input::object::{Object, list};
use crate::input::source::Source;
use crate::input::value::Value;
use crate::platform::error::InputError;

/// A value of a strategy: its path, as in `strategies.late.inflow[0].from`, and its key.
pub(crate) type Row = (String, &'static Key, Value);

/// Rows of an object with these values.
fn rows(path: &str, keys: &'static [Key], values: Vec<Value>) -> impl Iterator<Item = Row> {
    let path = path.to_owned();
    keys.iter().zip(values).map(move |(key, value)| (format!("{path}.{}", key.path), key, value))
}

/// Longest name of a strategy, letters (chosen: it is part of column names).
const MAX_NAME_LENGTH: usize = 64;

/// Whether a strategy may have this name: it stands in paths and expressions.
fn is_name(name: &str) -> bool {
    let mut chars = name.chars();
    chars.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_')
        && chars.all(|c| c.is_ascii_alphanumeric() || c == '_')
        && name.len() <= MAX_NAME_LENGTH
}

/// Reads the strategy of that name: its values, then those of each of its inflow windows.
pub(crate) fn read(name: &str, json: &Json, source: &Source) -> Result<Vec<Row>, InputError> {
    let path = format!("strategies.{name}");
    if !is_name(name) {
        let allowed = "a letter, then letters, digits and _; up to 64";
        return Err(source.error(&path, "", "is not a name for a strategy", allowed));
    }
    let object = Object::new(json, &path, "a strategy", STRATEGY_KEYS, &["inflow"], source)?;
    let mut strategy: Vec<Row> = rows(&path, STRATEGY_KEYS, object.values()?).collect();
    let path = format!("{path}.inflow");
    // Without windows there is one, from release to the end.
    let one = Json::List(vec![Json::Object(Vec::new())]);
    let windows = object.given("inflow").unwrap_or(&one);
    let allowed = "a list of {\"from\": \"5 s\", \"to\": \"12 s\", \"mass_flow_rate\": \"1 g/s\"}";
    for (index, json) in list(windows, &path, source, allowed)?.iter().enumerate() {
        let path = format!("{path}[{index}]");
        let window = Object::new(json, &path, "an inflow window", WINDOW_KEYS, &["table"], source)?;
        strategy.extend(rows(&path, WINDOW_KEYS, window.values()?));
    }
    Ok(strategy)
}
