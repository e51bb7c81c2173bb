//! What a grid varies: a key of the study, of a strategy or of an inflow window.

use std::fmt::Write as _;

use crate::input::json::Json;
use crate::input::keys::{self, KEYS, Key, STRATEGY_KEYS, WINDOW_KEYS};
use crate::input::settings::Settings;
use crate::input::source::Source;
use crate::input::value::Value;
use crate::platform::error::InputError;
use crate::platform::nearest::or_nearest;

/// A varied key.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    /// The shortest name of the key.
    pub name: String,
    pub target: Target,
}

/// Where the value of a column goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Target {
    /// Position in [`KEYS`].
    Key(usize),
    /// Strategy, position in [`STRATEGY_KEYS`].
    Strategy(String, usize),
    /// Strategy, window, position in [`WINDOW_KEYS`].
    Window(String, usize, usize),
}

impl Target {
    pub fn key(&self) -> &'static Key {
        match self {
            Self::Key(index) => &KEYS[*index],
            Self::Strategy(_, index) => &STRATEGY_KEYS[*index],
            Self::Window(_, _, index) => &WINDOW_KEYS[*index],
        }
    }

    /// Whether a name, short or whole, is that of its key.
    pub fn has_name(&self, name: &str) -> bool {
        matches!(self, Self::Key(index) if keys::find(name) == Some(*index))
    }

    /// The value at a point.
    pub fn value(&self, point: &Settings) -> Value {
        match self {
            Self::Key(index) => point.at(*index).clone(),
            Self::Strategy(name, index) => point
                .strategies
                .get(name)
                .map_or(Value::Null, |strategy| strategy.values[*index].clone()),
            Self::Window(name, window, index) => point
                .strategies
                .get(name)
                .and_then(|strategy| strategy.inflow.get(*window))
                .map_or(Value::Null, |window| window[*index].clone()),
        }
    }

    /// Sets the value at a point.
    pub fn set(&self, point: &mut Settings, value: Value) {
        match self {
            Self::Key(index) => point.set(*index, value),
            Self::Strategy(name, index) => {
                if let Some(strategy) = point.strategies.get_mut(name) {
                    strategy.values[*index] = value;
                }
            }
            Self::Window(name, window, index) => {
                let strategy = point.strategies.get_mut(name);
                let window = strategy.and_then(|strategy| strategy.inflow.get_mut(*window));
                if let Some(window) = window {
                    window[*index] = value;
                }
            }
        }
    }
}

/// A section of a study file whose members are keys and their values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Section {
    /// The axes.
    Grid,
    /// The replicates.
    Replicates,
}

impl Section {
    /// Its members that are not keys.
    fn words(self) -> &'static [&'static str] {
        match self {
            Self::Grid => &["zip", "points", "filter"],
            Self::Replicates => &[],
        }
    }

    /// What it does with a key, for errors.
    fn use_of_keys(self) -> &'static str {
        match self {
            Self::Grid => "a grid can vary",
            Self::Replicates => "can repeat a point",
        }
    }
}

/// Finds what the name of an axis stands for: its shortest name and its target. `path` is the place of
/// the axis in the file.
pub(super) fn find(
    name: &str,
    path: &str,
    value: &Json,
    settings: &Settings,
    section: Section,
    source: &Source,
) -> Result<Column, InputError> {
    if let Some(index) = keys::find(name).filter(|index| KEYS[*index].varies()) {
        let target = Target::Key(index);
        return Ok(Column { name: keys::short_name(index).to_owned(), target });
    }
    if let Some(rest) = name.strip_prefix("strategies.") {
        return of_strategy(name, rest, path, value, settings, source);
    }
    Err(unknown(name, path, value, section, source))
}

/// The target of `strategies.<rest>`.
fn of_strategy(
    name: &str,
    rest: &str,
    path: &str,
    value: &Json,
    settings: &Settings,
    source: &Source,
) -> Result<Column, InputError> {
    let allowed =
        "strategies.<name>.release_time, .preinflation_mass, .inflow[0].mass_flow_rate, …";
    let parts: Vec<&str> = rest.split('.').collect();
    let Some(strategy) = parts.first().and_then(|part| settings.strategies.get(*part)) else {
        settings.check_strategy(parts.first().unwrap_or(&""), path, source)?;
        return Err(source.error(path, &value.brief(), "is not a key of a strategy", allowed));
    };
    let position = |keys: &[Key], leaf: &str| keys.iter().position(|key| key.path == leaf);
    let owner = parts[0].to_owned();
    let found = match parts[1..] {
        [leaf] => {
            position(STRATEGY_KEYS, leaf).map(|key| (name.to_owned(), Target::Strategy(owner, key)))
        }
        [window, leaf] => window
            .strip_prefix("inflow[")
            .and_then(|index| index.strip_suffix(']')?.parse::<usize>().ok())
            .filter(|index| *index < strategy.inflow.len())
            .zip(position(WINDOW_KEYS, leaf))
            .map(|(index, key)| {
                let name = format!("strategies.{owner}.inflow[{index}].{leaf}");
                (name, Target::Window(owner, index, key))
            }),
        _ => None,
    };
    match found {
        Some((name, target)) => Ok(Column { name, target }),
        None => Err(source.error(path, &value.brief(), "is not a key of that strategy", allowed)),
    }
}

/// The error of a name that a grid cannot vary, with the nearest name.
fn unknown(name: &str, path: &str, value: &Json, section: Section, source: &Source) -> InputError {
    let same_leaf: Vec<&str> =
        KEYS.iter().filter(|key| key.leaf() == name).map(|key| key.path).collect();
    if same_leaf.len() > 1 {
        let problem = "is the name of several keys";
        return source.error(path, &value.brief(), problem, same_leaf.join(", "));
    }
    let varied = KEYS.iter().enumerate().filter(|(_, key)| key.varies());
    let known = varied.flat_map(|(index, key)| [keys::short_name(index), key.path]);
    let near = or_nearest(name, known.chain(section.words().iter().copied()));
    let problem = format!("is not a key that {}{near}", section.use_of_keys());
    let mut allowed = "keys of the study, as N or film.thickness".to_owned();
    if !section.words().is_empty() {
        let _ = write!(allowed, "; {}", section.words().join(", "));
    }
    source.error(path, &value.brief(), problem, allowed)
}
