//! Reads the settings of a file from its tree.

use std::fmt::Write as _;

use crate::input::json::Json;
use crate::input::keys::{KEYS, Key, STRATEGY_KEYS, STUDY, Table, WINDOW_KEYS, position};
use crate::input::object::object;
use crate::input::overrides::member;
use crate::input::plausible::Implausible;
use crate::input::settings::{Settings, Strategy};
use crate::input::source::{Source, shown};
use crate::input::strategy::{self, Row};
use crate::input::supports;
use crate::input::value::{Value, brief_number};
use crate::platform::error::InputError;
use crate::platform::nearest::did_you_mean;

impl Settings {
    /// Reads a study: the value of every key, its strategies and supports.
    ///
    /// # Errors
    /// The first key with a value that it does not allow; a name that is no key.
    pub fn of_study(tree: &Json, source: &Source) -> Result<Self, InputError> {
        check_version(tree, source)?;
        let mut settings = Self::new(&STUDY);
        settings.read("", tree, source)?;
        settings.check_stepping(tree, source)?;
        // Supports of a mesh need its nodes.
        if !has_mesh(tree) {
            settings.supports = supports::read(tree.get("supports"), source)?;
        }
        if let Some(json) = tree.get("strategies") {
            for (name, value) in object(json, &STUDY, "strategies", source)? {
                settings.add_strategy(name, strategy::read(name, value, source)?);
            }
        }
        if !settings.strategies.contains_key("direct") {
            // Released at once, inflow from release to the end.
            let direct = strategy::read("direct", &Json::Object(Vec::new()), source)?;
            settings.add_strategy("direct", direct);
        }
        settings.check_strategy(settings.strategy_name(), "strategy", source)?;
        Ok(settings)
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
                Some(index) => {
                    self.values[index] = table.keys[index].value(value, &path, source)?;
                }
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

    /// Writes the default of every key that the tree does not give into it.
    pub fn write_defaults(&self, tree: &mut Json) {
        let from_mesh = has_mesh(tree);
        let is_of_fold = |key: &Key| {
            from_mesh && key.path.starts_with("design.") && key.path != "design.subdivisions"
        };
        let values = self.table.keys.iter().zip(&self.values);
        let given = |(key, value): &(&&Key, &Value)| **value != Value::Null && !is_of_fold(key);
        for (key, value) in values.filter(given) {
            let parts = || key.path.split('.');
            if parts().try_fold(&*tree, Json::get).is_none()
                && let Some(member) = parts().try_fold(&mut *tree, member)
            {
                *member = Json::from(value);
            }
        }
    }
}

/// Whether a study has film from a mesh.
pub(crate) fn has_mesh(tree: &Json) -> bool {
    tree.get("design").and_then(|design| design.get("mesh")).is_some()
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
            version.to_string(),
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

/// Refuses a window, between these times (s), that ends before it begins, and warns of one that starts or ends after
/// the run. `end` is the key that gives its end, with its value; `None` where nothing does.
pub(crate) fn check_window(
    path: &str,
    [from, to]: [f64; 2],
    end: Option<(&str, String)>,
    end_time: f64,
    source: &Source,
) -> Result<(), InputError> {
    let is_given = end.as_ref().is_some_and(|(key, _)| *key == "to");
    if to <= from && (to < from || is_given) {
        return Err(source.error(
            &format!("{path}.to"),
            shown(to),
            "the window ends before it begins",
            format!("above its `from`, {} s", shown(from)),
        ));
    }
    let part = if from >= end_time {
        "the window".to_owned()
    } else if to > end_time {
        let part = brief_number(100.0 * (to - end_time) / (to - from));
        format!("the part after it, {part} % of its gas,")
    } else {
        return Ok(());
    };
    let end = end.filter(|_| from < end_time);
    let (key, value) = end.unwrap_or_else(|| ("from", format!("{} s", shown(from))));
    let problem = format!("is after solver.end_time ({} s): {part} is ignored", shown(end_time));
    let next = "change it, or raise solver.end_time".to_owned();
    source.warn_point(&format!("{path}.{key}"), &value, Implausible { problem, next });
    Ok(())
}
