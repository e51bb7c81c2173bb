//! Inflation strategies: named schedules of release, preinflation and inflow windows.

use serde_json::{Map, json};

use crate::input::json::Json;
use crate::input::keys::{Key, STRATEGY_KEYS, WINDOW_KEYS, position};
use crate::input::object::{Object, list};
use crate::input::source::Source;
use crate::input::value::{Value, json_value};
use crate::platform::error::InputError;

/// A named inflation schedule.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Strategy {
    /// Values of [`STRATEGY_KEYS`].
    pub values: Vec<Value>,
    /// Inflow windows: values of [`WINDOW_KEYS`].
    pub inflow: Vec<Vec<Value>>,
}

/// What an inflow window gives; the study or the strategy decides the rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Window {
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
        self.values[const { position(STRATEGY_KEYS, "release_time") }].number().unwrap_or(0.0)
    }

    /// Gas inside from the start, kg.
    pub fn preinflation_mass(&self) -> f64 {
        self.values[const { position(STRATEGY_KEYS, "preinflation_mass") }].number().unwrap_or(0.0)
    }

    /// The inflow windows.
    pub fn windows(&self) -> impl Iterator<Item = Window> {
        self.inflow.iter().map(|values| Window {
            from: values[const { position(WINDOW_KEYS, "from") }].number(),
            to: values[const { position(WINDOW_KEYS, "to") }].number(),
            mass: values[const { position(WINDOW_KEYS, "mass") }].number(),
            mass_flow_rate: values[const { position(WINDOW_KEYS, "mass_flow_rate") }].number(),
            temperature: values[const { position(WINDOW_KEYS, "temperature") }].number(),
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
pub(crate) fn read_strategy(
    name: &str,
    json: &Json,
    source: &Source,
) -> Result<Strategy, InputError> {
    let path = format!("strategies.{name}");
    if !is_name(name) {
        let allowed = "a letter, then letters, digits and _; up to 64";
        return Err(source.error(&path, "", "is not a name for a strategy", allowed));
    }
    let object = Object::new(json, &path, "a strategy", STRATEGY_KEYS, &["inflow"], source)?;
    let mut strategy = Strategy { values: object.values()?, ..Strategy::direct() };
    if let Some(windows) = object.given("inflow") {
        let path = format!("{path}.inflow");
        let allowed =
            "a list of {\"from\": \"5 s\", \"to\": \"12 s\", \"mass_flow_rate\": \"1 g/s\"}";
        let window = |(index, json): (usize, &Json)| {
            let path = format!("{path}[{index}]");
            Object::new(json, &path, "an inflow window", WINDOW_KEYS, &[], source)?.values()
        };
        let windows = list(windows, &path, source, allowed)?.iter().enumerate();
        strategy.inflow = windows.map(window).collect::<Result<_, _>>()?;
    }
    Ok(strategy)
}
