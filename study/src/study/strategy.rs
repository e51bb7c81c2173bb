//! Inflation strategies: named schedules of release, preinflation and inflow windows.

use serde_json::{Map, json};

use crate::input::json::Json;
use crate::input::keys::{self, Key, STRATEGY_KEYS, WINDOW_KEYS, position};
use crate::input::settings::{list, read};
use crate::input::source::Source;
use crate::input::value::{Value, json_value};
use crate::platform::error::InputError;

/// A named inflation schedule.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Strategy {
    /// Values of [`STRATEGY_KEYS`].
    pub values: Vec<Value>,
    /// Inflow windows: values of [`WINDOW_KEYS`].
    pub inflow: Vec<Vec<Value>>,
}

/// What an inflow window gives; the study or the strategy decides the rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window {
    /// Start, s.
    pub from: Option<f64>,
    /// End, s.
    pub to: Option<f64>,
    /// Mass let in, kg; it gives the end.
    pub mass: Option<f64>,
    /// Mass flow rate, kg/s.
    pub mass_flow_rate: Option<f64>,
    /// Temperature of the gas let in, K.
    pub temperature: Option<f64>,
}

impl Strategy {
    /// Released at once, inflow from release to the end.
    pub fn direct() -> Self {
        Self { values: defaults(STRATEGY_KEYS), inflow: vec![defaults(WINDOW_KEYS)] }
    }

    /// Time until which the lid holds the capsule, s.
    pub fn release_time(&self) -> f64 {
        number(&self.values[const { position(STRATEGY_KEYS, "release_time") }]).unwrap_or(0.0)
    }

    /// Gas inside from the start, kg.
    pub fn preinflation_mass(&self) -> f64 {
        number(&self.values[const { position(STRATEGY_KEYS, "preinflation_mass") }]).unwrap_or(0.0)
    }

    /// The inflow windows.
    pub fn windows(&self) -> impl Iterator<Item = Window> {
        self.inflow.iter().map(|values| Window {
            from: number(&values[const { position(WINDOW_KEYS, "from") }]),
            to: number(&values[const { position(WINDOW_KEYS, "to") }]),
            mass: number(&values[const { position(WINDOW_KEYS, "mass") }]),
            mass_flow_rate: number(&values[const { position(WINDOW_KEYS, "mass_flow_rate") }]),
            temperature: number(&values[const { position(WINDOW_KEYS, "temperature") }]),
        })
    }

    /// The strategy with every value it has.
    pub fn to_json(&self) -> serde_json::Value {
        let members = |keys: &[Key], values: &[Value]| {
            let given = keys.iter().zip(values).filter(|(_, value)| **value != Value::Null);
            given
                .map(|(key, value)| (key.path.to_owned(), json_value(value)))
                .collect::<Map<_, _>>()
        };
        let mut json = members(STRATEGY_KEYS, &self.values);
        let inflow = self.inflow.iter().map(|window| members(WINDOW_KEYS, window));
        json.insert("inflow".to_owned(), json!(inflow.collect::<Vec<_>>()));
        json.into()
    }
}

fn defaults(keys: &[Key]) -> Vec<Value> {
    keys.iter().map(Key::default_value).collect()
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) => Some(*number),
        _ => None,
    }
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

/// Reads the strategy of that name.
pub(super) fn read_strategy(
    name: &str,
    json: &Json,
    source: &Source,
) -> Result<Strategy, InputError> {
    let path = format!("strategies.{name}");
    if !is_name(name) {
        let allowed = "a letter, then letters, digits and _; up to 64";
        return Err(source.error(&path, "", "is not a name for a strategy", allowed));
    }
    let allowed = names(STRATEGY_KEYS, &["inflow"]);
    let Json::Object(members) = json else {
        let problem = format!("is {}, not an object", json.kind());
        return Err(source.error(&path, &json.brief(), problem, allowed));
    };
    let mut strategy = Strategy::direct();
    for (name, value) in members {
        let path = format!("{path}.{name}");
        if name == "inflow" {
            let allowed =
                "a list of {\"from\": \"5 s\", \"to\": \"12 s\", \"mass_flow_rate\": \"1 g/s\"}";
            strategy.inflow = list(value, &path, source, allowed)?
                .iter()
                .enumerate()
                .map(|(index, value)| window(value, &format!("{path}[{index}]"), source))
                .collect::<Result<_, _>>()?;
        } else if let Some(key) = STRATEGY_KEYS.iter().position(|key| key.path == name) {
            strategy.values[key] = read(&STRATEGY_KEYS[key], value, &path, source)?;
        } else {
            let problem = unknown("a strategy", name, &allowed);
            return Err(source.error(&path, &value.brief(), problem, allowed));
        }
    }
    Ok(strategy)
}

fn window(json: &Json, path: &str, source: &Source) -> Result<Vec<Value>, InputError> {
    let allowed = names(WINDOW_KEYS, &[]);
    let Json::Object(members) = json else {
        let problem = format!("is {}, not an object", json.kind());
        return Err(source.error(path, &json.brief(), problem, allowed));
    };
    let mut values = defaults(WINDOW_KEYS);
    for (name, value) in members {
        let path = format!("{path}.{name}");
        let Some(key) = WINDOW_KEYS.iter().position(|key| key.path == name) else {
            let problem = unknown("an inflow window", name, &allowed);
            return Err(source.error(&path, &value.brief(), problem, allowed));
        };
        values[key] = read(&WINDOW_KEYS[key], value, &path, source)?;
    }
    Ok(values)
}

/// The names of the keys of an object, for errors.
fn names(keys: &[Key], more: &[&str]) -> String {
    let names = keys.iter().map(|key| key.path).chain(more.iter().copied());
    names.collect::<Vec<_>>().join(", ")
}

/// What is wrong with a name that an object does not have.
fn unknown(what: &str, name: &str, allowed: &str) -> String {
    match keys::nearest(name, allowed.split(", ")) {
        Some(near) => format!("is not a key of {what}; did you mean {near}?"),
        None => format!("is not a key of {what}"),
    }
}
