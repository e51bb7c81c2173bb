//! The values of the keys of a file that hold one value: read from its tree, with defaults.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use billow_solver::scene::Support;
use serde_json::{Map, json};

use crate::input::json::Json;
use crate::input::keys::{
    KEYS, Key, Named, STRATEGY_KEYS, STUDY, Table, WINDOW_KEYS, pick, position,
};
use crate::input::object::{object, read};
use crate::input::plausible::Implausible;
use crate::input::source::{Source, shown};
use crate::input::strategy::{self, Row};
use crate::input::supports;
use crate::input::value::{Value, json_value};
use crate::platform::error::InputError;
use crate::platform::nearest::{did_you_mean, nearest};

/// Where a strategy stands among the values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Strategy {
    /// Position of the first value of [`STRATEGY_KEYS`]; the windows follow.
    start: usize,
    /// Number of its inflow windows.
    windows: usize,
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

/// The value of every key of a table, in its order; `Null` where absent. In a study, the values of its
/// strategies follow.
#[derive(Debug, Clone)]
pub(crate) struct Settings {
    table: &'static Table,
    values: Vec<Value>,
    /// Paths and keys of the values beyond the table: those of strategies and their inflow windows.
    rows: Vec<(String, &'static Key)>,
    /// The inflation strategies of a study, by name.
    pub strategies: BTreeMap<String, Strategy>,
    /// What holds the capsule of a study.
    pub supports: Vec<Support>,
}

impl PartialEq for Settings {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.table, other.table)
            && (&self.values, &self.strategies, &self.supports)
                == (&other.values, &other.strategies, &other.supports)
    }
}

impl Settings {
    /// Every key at its default.
    pub fn new(table: &'static Table) -> Self {
        let values = table.keys.iter().map(|key| key.default_value()).collect();
        let (rows, strategies, supports) = (Vec::new(), BTreeMap::new(), Vec::new());
        Self { table, values, rows, strategies, supports }
    }

    /// Reads a study: the value of every key, its strategies and supports.
    ///
    /// # Errors
    /// The first key with a value that it does not allow; a name that is no key.
    pub fn of_study(tree: &Json, source: &Source) -> Result<Self, InputError> {
        check_version(tree, source)?;
        let mut settings = Self::new(&STUDY);
        settings.read("", tree, source)?;
        settings.check_stepping(tree, source)?;
        settings.supports = supports::read(tree.get("supports"), source)?;
        if let Some(json) = tree.get("strategies") {
            for (name, value) in object(json, &STUDY, "strategies", source)? {
                settings.add_strategy(name, strategy::read(name, value, source)?);
            }
        }
        if !settings.strategies.contains_key("direct") {
            settings.add_strategy("direct", strategy::direct());
        }
        settings.check_strategy(settings.strategy_name(), "strategy", source)?;
        Ok(settings)
    }

    /// The value of a key, by its position in the table.
    pub fn at(&self, index: usize) -> &Value {
        &self.values[index]
    }

    /// The text of a key; `None` where it has none.
    pub fn text(&self, path: &str) -> Option<&str> {
        match self.value(path) {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Sets a key, and removes the values of the keys it excludes.
    pub fn set(&mut self, index: usize, value: Value) {
        self.values[index] = value;
        for path in self.key(index).excludes {
            if let Some(excluded) = self.table.index(path) {
                self.values[excluded] = Value::Null;
            }
        }
    }

    /// Reads the keys below `prefix`.
    pub fn read(&mut self, prefix: &str, json: &Json, source: &Source) -> Result<(), InputError> {
        let table = self.table;
        for (name, value) in object(json, table, prefix, source)? {
            let path = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
            let section = table.is_section(&path);
            let structured = table.structured.iter().any(|(known, _)| *known == path);
            match table.index(&path) {
                // A species is a word or a section.
                Some(index) if section && matches!(value, Json::Object(_)) => {
                    self.read(&path, value, source)?;
                    check_species(&path, value, source)?;
                    self.values[index] = Value::Null;
                }
                Some(index) => self.values[index] = read(table.keys[index], value, &path, source)?,
                None if section => self.read(&path, value, source)?,
                None if structured => {}
                None => return Err(unknown(table, prefix, &path, name, value, source)),
            }
        }
        Ok(())
    }

    /// Refuses a step that is both adaptive and fixed; a fixed one replaces the default tolerance.
    fn check_stepping(&mut self, tree: &Json, source: &Source) -> Result<(), InputError> {
        let stepping = tree.get("solver").and_then(|solver| solver.get("stepping"));
        if let Some(stepping) = stepping {
            let given = |key: &str| stepping.get(key).is_some();
            if given("adaptive") && given("fixed") {
                return Err(source.error(
                    "solver.stepping",
                    stepping,
                    "gives both adaptive and fixed",
                    "one of {\"adaptive\": 1e-6}, {\"fixed\": \"10 us\"}",
                ));
            }
            if given("fixed") {
                let index = const { position(KEYS, "solver.stepping.fixed") };
                let fixed = self.at(index).clone();
                self.set(index, fixed);
            }
        }
        Ok(())
    }

    fn add_strategy(&mut self, name: &str, rows: Vec<Row>) {
        let windows = (rows.len() - STRATEGY_KEYS.len()) / WINDOW_KEYS.len();
        let strategy = Strategy { start: self.values.len(), windows };
        for (path, key, value) in rows {
            self.rows.push((path, key));
            self.values.push(value);
        }
        self.strategies.insert(name.to_owned(), strategy);
    }

    /// Time until which the lid holds the capsule, s.
    pub fn release_time(&self, strategy: Strategy) -> f64 {
        let index = strategy.start + const { position(STRATEGY_KEYS, "release_time") };
        self.values[index].number().unwrap_or(0.0)
    }

    /// Gas inside from the start, kg.
    pub fn preinflation_mass(&self, strategy: Strategy) -> f64 {
        let index = strategy.start + const { position(STRATEGY_KEYS, "preinflation_mass") };
        self.values[index].number().unwrap_or(0.0)
    }

    /// The inflow windows of a strategy.
    pub fn windows(&self, strategy: Strategy) -> impl Iterator<Item = Window> {
        let start = strategy.start + STRATEGY_KEYS.len();
        let values = &self.values[start..start + strategy.windows * WINDOW_KEYS.len()];
        values.chunks(WINDOW_KEYS.len()).map(|values| Window {
            from: values[const { position(WINDOW_KEYS, "from") }].number(),
            to: values[const { position(WINDOW_KEYS, "to") }].number(),
            mass: values[const { position(WINDOW_KEYS, "mass") }].number(),
            mass_flow_rate: values[const { position(WINDOW_KEYS, "mass_flow_rate") }].number(),
            temperature: values[const { position(WINDOW_KEYS, "temperature") }].number(),
        })
    }

    /// Position of the value that a dotted path names, or a last part that only one key has.
    pub fn find(&self, name: &str) -> Option<usize> {
        let row = || self.rows.iter().position(|(path, _)| path == name);
        self.table.find(name).or_else(|| Some(self.table.keys.len() + row()?))
    }

    /// The key of a value.
    pub fn key(&self, index: usize) -> &'static Key {
        let table = &self.table.keys;
        table.get(index).copied().unwrap_or_else(|| self.rows[index - table.len()].1)
    }

    /// The shortest name of a value.
    pub fn name(&self, index: usize) -> String {
        match index.checked_sub(self.table.keys.len()) {
            Some(row) => self.rows[row].0.clone(),
            None => self.table.short_name(index).to_owned(),
        }
    }

    /// Name of the strategy.
    pub fn strategy_name(&self) -> &str {
        self.text("strategy").unwrap_or_default()
    }

    /// Refuses a strategy that the study does not have.
    pub fn check_strategy(&self, name: &str, key: &str, source: &Source) -> Result<(), InputError> {
        if self.strategies.contains_key(name) {
            return Ok(());
        }
        let known: Vec<&str> = self.strategies.keys().map(String::as_str).collect();
        let near = nearest(name, known.iter().copied());
        let near = near.map_or_else(String::new, |near| format!("; did you mean {near:?}?"));
        Err(source
            .error(
                key,
                Json::Text(name.to_owned()),
                format!("is not a strategy of this study{near}"),
                known.join(", "),
            )
            .with_hint("name one of these, or define it under strategies"))
    }

    /// Settings, strategies and supports, with every value they have.
    pub fn to_json(&self) -> serde_json::Value {
        let mut json = json!({});
        for (key, value) in self.table.keys.iter().zip(&self.values) {
            if *value == Value::Null {
                continue;
            }
            let member = key.path.split('.').fold(&mut json, |object, part| &mut object[part]);
            *member = json_value(value);
        }
        let members = |keys: &[Key], start: usize| {
            let given = keys.iter().zip(&self.values[start..]);
            let given = given.filter(|(_, value)| **value != Value::Null);
            given
                .map(|(key, value)| (key.path.to_owned(), json_value(value)))
                .collect::<Map<_, _>>()
        };
        for (name, Strategy { start, windows }) in &self.strategies {
            let first = start + STRATEGY_KEYS.len();
            let windows =
                (0..*windows).map(|n| members(WINDOW_KEYS, first + n * WINDOW_KEYS.len()));
            let windows: Vec<_> = windows.collect();
            json["strategies"][name] = members(STRATEGY_KEYS, *start).into();
            json["strategies"][name]["inflow"] = json!(windows);
        }
        let supports = self
            .supports
            .iter()
            .map(|support| json!({"on": supports::place_name(support.on), "fix": support.fix}));
        json["supports"] = supports.collect::<Vec<_>>().into();
        json
    }

    /// The value of a key by its path.
    ///
    /// # Panics
    /// When the table has no such key. This is a mistake in code.
    pub fn value(&self, path: &str) -> &Value {
        &self.values[self.position(path)]
    }

    fn position(&self, path: &str) -> usize {
        self.table.index(path).unwrap_or_else(|| unreachable!("no key has the path {path}"))
    }

    /// A number; `None` where the key has no value.
    pub fn number(&self, path: &str) -> Option<f64> {
        self.value(path).number()
    }

    /// A number that the file must give, or has by default.
    pub fn needed(&self, path: &str, source: &Source) -> Result<f64, InputError> {
        self.number(path).ok_or_else(|| self.missing(path, source))
    }

    /// A whole number that the file must give, or has by default.
    pub fn whole(&self, path: &str, source: &Source) -> Result<u64, InputError> {
        match self.value(path) {
            Value::Integer(number) => Ok(u64::try_from(*number).unwrap_or_default()),
            _ => Err(self.missing(path, source)),
        }
    }

    /// A whole number of 32 bits. Every such key allows less than 2^32.
    pub fn count(&self, path: &str, source: &Source) -> Result<u32, InputError> {
        self.whole(path, source).map(|number| u32::try_from(number).unwrap_or_default())
    }

    /// True or false; `None` where the key has no value.
    pub fn flag(&self, path: &str) -> Option<bool> {
        match self.value(path) {
            Value::Bool(flag) => Some(*flag),
            _ => None,
        }
    }

    /// What the word of a key stands for; `None` where it has none.
    pub fn picked<T: Copy>(&self, path: &str, words: &[Named<T>]) -> Option<T> {
        pick(words, self.value(path))
    }

    /// What the word of a key stands for, which the file must give, or has by default.
    pub fn word<T: Copy>(
        &self,
        path: &str,
        words: &[Named<T>],
        source: &Source,
    ) -> Result<T, InputError> {
        self.picked(path, words).ok_or_else(|| self.missing(path, source))
    }

    /// The error of a key that the file does not give.
    pub fn missing(&self, path: &str, source: &Source) -> InputError {
        let key = self.table.keys[self.position(path)];
        let mut error = missing_key(key, source);
        if self.table.structured.iter().any(|(path, _)| *path == "grid") {
            error.hint = format!("give it here, or vary {} under grid", key.leaf());
        }
        error
    }
}

fn missing_key(key: &Key, source: &Source) -> InputError {
    source
        .error(key.path, "", "missing", key.allowed())
        .with_hint(format!("give it, as in {}", key.sample()))
}

/// A gas given by its constants has both.
fn check_species(path: &str, species: &Json, source: &Source) -> Result<(), InputError> {
    for key in ["gas_constant", "cp"] {
        if species.get(key).is_none() {
            return Err(source.error(
                &format!("{path}.{key}"),
                "",
                "missing: a gas given by its constants needs gas_constant and cp",
                "a specific heat in J/(kg K)",
            ));
        }
    }
    Ok(())
}

/// Refuses a newer format, before any other key is read: they may have another meaning there.
pub(crate) fn check_version(tree: &Json, source: &Source) -> Result<(), InputError> {
    match tree.get("version") {
        Some(Json::Integer(version)) if *version > 1 => Err(source.error(
            "version",
            &version.to_string(),
            "is a newer format than this program reads",
            "1; or use a newer billow",
        )),
        _ => Ok(()),
    }
}

/// Largest number of samples of one run (chosen: more is an error in a unit).
const MAX_SAMPLES: f64 = 1e6;

/// Number of samples that a run has at least, without a warning. Chosen: fewer cannot show a deployment.
const MIN_SAMPLES: f64 = 20.0;

/// Refuses a run with more than [`MAX_SAMPLES`] samples, and warns of one with few. Times in s.
pub(crate) fn check_sample_interval(
    interval: f64,
    end_time: f64,
    source: &Source,
) -> Result<(), InputError> {
    if end_time / interval <= MAX_SAMPLES {
        if end_time < MIN_SAMPLES * interval {
            let samples = (end_time / interval * (1.0 + 1e-9)).floor() + 1.0;
            let end_time = shown(end_time);
            let problem =
                format!("gives {samples} sample(s) in a run of {end_time} s, too few for times");
            let next = "check its unit; the default is \"1 ms\"".to_owned();
            let value = format!("{} s", shown(interval));
            source.warn_point("outputs.sample_interval", &value, Implausible { problem, next });
        }
        return Ok(());
    }
    Err(source.error(
        "outputs.sample_interval",
        shown(interval),
        format!("samples a run of {} s more than {MAX_SAMPLES:.0} times", shown(end_time)),
        format!("at least {} s for this end_time", shown(end_time / MAX_SAMPLES)),
    ))
}

/// The error of a name that no key of the table has, with the nearest name that one has.
fn unknown(
    table: &Table,
    prefix: &str,
    path: &str,
    name: &str,
    value: &Json,
    source: &Source,
) -> InputError {
    let known = table.children(prefix);
    let mut problem = format!("is not a key of {}", table.what);
    if prefix.is_empty() && name == "maps" {
        problem.push_str("; a file of maps runs with make stability");
    } else if let Some(question) = did_you_mean(name, known.iter().copied()) {
        let _ = write!(problem, "; {question}");
    } else if let Some(elsewhere) = table.find(name) {
        let _ = write!(problem, "; did you mean {}?", table.keys[elsewhere].path);
    }
    source.error(path, value, problem, known.join(", "))
}
