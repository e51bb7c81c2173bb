//! Inflation strategies: named schedules of release, preinflation and inflow windows.

use serde_json::{Map, json};

use crate::input::keys::{self, Key, STRATEGY_KEYS, WINDOW_KEYS};
use crate::input::settings::{list, read};
use crate::input::source::Source;
use crate::input::study_file::Json;
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

impl Strategy {
    /// Released at once, inflow from release to the end.
    pub fn direct() -> Self {
        Self {
            values: STRATEGY_KEYS.iter().map(Key::default_value).collect(),
            inflow: vec![WINDOW_KEYS.iter().map(Key::default_value).collect()],
        }
    }

    /// When each inflow window begins and ends, s; `None` at the release, and at the end.
    pub fn windows(&self) -> Vec<[Option<f64>; 2]> {
        let at = |name: &str| WINDOW_KEYS.iter().position(|key| key.path == name);
        let (from, to) = (at("from"), at("to"));
        let time = |window: &Vec<Value>, at: Option<usize>| match at.map(|at| &window[at]) {
            Some(Value::Number(time)) => Some(*time),
            _ => None,
        };
        self.inflow.iter().map(|window| [time(window, from), time(window, to)]).collect()
    }

    /// The strategy spelled out, without what is absent.
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

/// Names a strategy may have: they stand in paths and expressions.
fn is_name(name: &str) -> bool {
    let mut chars = name.chars();
    chars.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_')
        && chars.all(|c| c.is_ascii_alphanumeric() || c == '_')
        && name.len() <= 64
}

/// Reads the strategy of that name.
pub(super) fn read_strategy(
    name: &str,
    json: &Json,
    source: &Source,
) -> Result<Strategy, InputError> {
    let at = format!("strategies.{name}");
    if !is_name(name) {
        let allowed = "a letter, then letters, digits and _";
        return Err(source.error(&at, "", "is no name for a strategy", allowed));
    }
    let allowed = "release_time, preinflation_mass, inflow";
    let Json::Object(members) = json else {
        let problem = format!("is {}, not an object", json.kind());
        return Err(source.error(&at, &json.brief(), problem, allowed));
    };
    let mut strategy = Strategy::direct();
    for (name, value) in members {
        let at = format!("{at}.{name}");
        if name == "inflow" {
            let allowed = "a list of {\"from\": \"5 s\", \"to\": \"12 s\", \"rate\": \"1 g/s\"}";
            strategy.inflow = list(value, &at, source, allowed)?
                .iter()
                .enumerate()
                .map(|(number, value)| window(value, &format!("{at}[{number}]"), source))
                .collect::<Result<_, _>>()?;
        } else if let Some(key) = STRATEGY_KEYS.iter().position(|key| key.path == name) {
            strategy.values[key] = read(&STRATEGY_KEYS[key], value, &at, source)?;
        } else {
            let problem = near("a strategy", name, allowed);
            return Err(source.error(&at, &value.brief(), problem, allowed));
        }
    }
    Ok(strategy)
}

fn window(json: &Json, at: &str, source: &Source) -> Result<Vec<Value>, InputError> {
    let allowed = "from, to, rate, temperature";
    let Json::Object(members) = json else {
        let problem = format!("is {}, not an object", json.kind());
        return Err(source.error(at, &json.brief(), problem, allowed));
    };
    let mut values: Vec<Value> = WINDOW_KEYS.iter().map(Key::default_value).collect();
    for (name, value) in members {
        let at = format!("{at}.{name}");
        let Some(key) = WINDOW_KEYS.iter().position(|key| key.path == name) else {
            let problem = near("an inflow window", name, allowed);
            return Err(source.error(&at, &value.brief(), problem, allowed));
        };
        values[key] = read(&WINDOW_KEYS[key], value, &at, source)?;
    }
    Ok(values)
}

fn near(what: &str, name: &str, allowed: &str) -> String {
    match keys::nearest(name, allowed.split(", ")) {
        Some(near) => format!("is no key of {what}; did you mean {near}?"),
        None => format!("is no key of {what}"),
    }
}
