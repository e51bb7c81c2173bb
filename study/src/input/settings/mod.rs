//! The keys of a file that hold one value: read from its tree, defaulted, found by their path.

mod parts;

use std::fmt::Write as _;

use crate::input::keys::{self, Key, Table};
use crate::input::source::Source;
use crate::input::study_file::Json;
use crate::input::value::Value;
use crate::platform::error::InputError;

pub(crate) use parts::{design, film, gas_laws, missing, number, unsigned, whole};

/// The value of every key of a table, in its order; `Null` where absent.
#[derive(Debug, Clone)]
pub(crate) struct Settings {
    table: &'static Table,
    values: Vec<Value>,
}

impl PartialEq for Settings {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.table, other.table) && self.values == other.values
    }
}

impl Settings {
    /// Every key at its default.
    pub fn new(table: &'static Table) -> Self {
        Self { table, values: table.keys.iter().map(|key| key.default_value()).collect() }
    }

    /// Its table.
    pub fn table(&self) -> &'static Table {
        self.table
    }

    /// Values in the order of the table.
    pub fn values(&self) -> &[Value] {
        &self.values
    }

    /// The value of a key. Paths are literals of this crate, so an unknown one is a mistake in code.
    pub fn get(&self, path: &str) -> &Value {
        match self.table.index(path) {
            Some(at) => &self.values[at],
            None => unreachable!("no key {path}"),
        }
    }

    pub fn at(&self, at: usize) -> &Value {
        &self.values[at]
    }

    pub fn number(&self, path: &str) -> Option<f64> {
        match self.get(path) {
            Value::Number(number) => Some(*number),
            _ => None,
        }
    }

    pub fn integer(&self, path: &str) -> Option<i64> {
        match self.get(path) {
            Value::Integer(number) => Some(*number),
            _ => None,
        }
    }

    pub fn maybe_text(&self, path: &str) -> Option<&str> {
        match self.get(path) {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    pub fn text(&self, path: &str) -> &str {
        self.maybe_text(path).unwrap_or_default()
    }

    pub fn maybe_flag(&self, path: &str) -> Option<bool> {
        match self.get(path) {
            Value::Bool(flag) => Some(*flag),
            _ => None,
        }
    }

    /// Whether a key is set to true.
    pub fn flag(&self, path: &str) -> bool {
        *self.get(path) == Value::Bool(true)
    }

    /// Sets a key. Of keys that exclude each other the one set stays.
    pub fn set(&mut self, at: usize, value: Value) {
        self.values[at] = value;
        let excluded: &[&str] = match self.table.keys[at].path {
            "solver.stepping.adaptive" => &["solver.stepping.fixed"],
            "solver.stepping.fixed" => &["solver.stepping.adaptive"],
            "gas.species" => &["gas.species.gas_constant", "gas.species.cp"],
            _ => &[],
        };
        for other in excluded.iter().filter_map(|path| self.table.index(path)) {
            self.values[other] = Value::Null;
        }
    }

    /// Reads the keys below `prefix`.
    pub fn read(&mut self, prefix: &str, json: &Json, source: &Source) -> Result<(), InputError> {
        let table = self.table;
        for (name, value) in object(json, table, prefix, source)? {
            let path = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
            let section = table.is_section(&path);
            match table.index(&path) {
                // A species is a word or a section of its own.
                Some(at) if section && matches!(value, Json::Object(_)) => {
                    self.read(&path, value, source)?;
                    check_species(&path, value, source)?;
                    self.values[at] = Value::Null;
                }
                Some(at) => self.values[at] = read(table.keys[at], value, &path, source)?,
                None if section => self.read(&path, value, source)?,
                None if table.structured.contains(&path.as_str()) => {}
                None => return Err(unknown(table, prefix, &path, name, value, source)),
            }
        }
        Ok(())
    }
}

/// A gas of its own has both its constants.
fn check_species(path: &str, species: &Json, source: &Source) -> Result<(), InputError> {
    for key in ["gas_constant", "cp"] {
        if species.get(key).is_none() {
            return Err(source.error(
                &format!("{path}.{key}"),
                "",
                "missing: a gas of its own needs gas_constant and cp",
                "a specific heat in J/(kg K)",
            ));
        }
    }
    Ok(())
}

/// First of all: a newer format may mean anything by its other keys.
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

/// Reads one value of a key at a place.
pub(crate) fn read(key: &Key, json: &Json, at: &str, source: &Source) -> Result<Value, InputError> {
    key.read(json).map_err(|refusal| {
        let mut error = source.error(at, &json.brief(), refusal.problem, refusal.allowed);
        error.hint = format!("write it as in {}", key.sample());
        error
    })
}

/// The members of an object.
pub(crate) fn object<'a>(
    json: &'a Json,
    table: &Table,
    at: &str,
    source: &Source,
) -> Result<&'a [(String, Json)], InputError> {
    match json {
        Json::Object(members) => Ok(members),
        other => Err(source.error(
            at,
            &other.brief(),
            format!("is {}, not an object", other.kind()),
            match table.children(at) {
                names if names.is_empty() => "an object".to_owned(),
                names => names.join(", "),
            },
        )),
    }
}

/// The items of a list.
pub(crate) fn list<'a>(
    json: &'a Json,
    at: &str,
    source: &Source,
    allowed: &str,
) -> Result<&'a [Json], InputError> {
    match json {
        Json::List(items) => Ok(items),
        other => {
            let problem = format!("is {}, not a list", other.kind());
            Err(source.error(at, &other.brief(), problem, allowed))
        }
    }
}

fn unknown(
    table: &Table,
    prefix: &str,
    path: &str,
    name: &str,
    value: &Json,
    source: &Source,
) -> InputError {
    let known = table.children(prefix);
    let mut problem = format!("is no key of {}", table.what);
    if let Some(near) = keys::nearest(name, known.iter().copied()) {
        let _ = write!(problem, "; did you mean {near}?");
    } else if let Some(elsewhere) = table.find(name) {
        let _ = write!(problem, "; did you mean {}?", table.keys[elsewhere].path);
    }
    source.error(path, &value.brief(), problem, known.join(", "))
}
