//! Reads values, lists and objects by the tables of their keys.

use nalgebra::Vector3;

use crate::input::json::Json;
use crate::input::keys::{Key, Refusal, Table};
use crate::input::source::Source;
use crate::input::value::Value;
use crate::platform::error::InputError;
use crate::platform::nearest::or_nearest;

/// An object whose keys are all known.
pub(crate) struct Object<'a> {
    json: &'a Json,
    /// Its place in the file, as in `supports[0]`.
    pub path: String,
    keys: &'static [Key],
    /// Every key it may have.
    names: Vec<&'a str>,
    source: &'a Source,
}

impl<'a> Object<'a> {
    /// The object at a path. `what` is its name with its article; `more` are its keys beside those of
    /// the table.
    pub fn new(
        json: &'a Json,
        path: &str,
        what: &str,
        keys: &'static [Key],
        more: &[&'a str],
        source: &'a Source,
    ) -> Result<Self, InputError> {
        let names: Vec<&str> =
            keys.iter().map(|key| key.path).chain(more.iter().copied()).collect();
        for (name, value) in members(json, path, source, &names.join(", "))? {
            if !names.contains(&name.as_str()) {
                let near = or_nearest(name, names.iter().copied());
                let problem = format!("is not a key of {what}{near}");
                let key = format!("{path}.{name}");
                return Err(source.error(&key, value, problem, names.join(", ")));
            }
        }
        Ok(Self { json, path: path.to_owned(), keys, names, source })
    }

    /// The value that the file gives a key; `null` counts as not given.
    pub fn given(&self, name: &str) -> Option<&'a Json> {
        debug_assert!(self.names.contains(&name), "{} has no key {name}", self.path);
        self.json.get(name).filter(|json| **json != Json::Null)
    }

    /// An error about a key.
    pub fn error(
        &self,
        name: &str,
        problem: impl Into<String>,
        allowed: impl Into<String>,
    ) -> InputError {
        let value = self.given(name).map(Json::to_string).unwrap_or_default();
        self.source.error(&format!("{}.{name}", self.path), &value, problem, allowed)
    }

    /// The error of a key that the file does not give.
    pub fn missing(&self, name: &str) -> InputError {
        let key = self.key(name);
        let next = format!("give it, as in {}", key.sample());
        self.error(name, "missing", key.allowed()).with_hint(next)
    }

    /// The row of a key.
    fn key(&self, name: &str) -> &'static Key {
        let key = self.keys.iter().find(|key| key.path == name);
        key.unwrap_or_else(|| unreachable!("{} has no key {name}", self.path))
    }

    /// The value of every key of its table, in their order: given or by default.
    pub fn values(&self) -> Result<Vec<Value>, InputError> {
        self.keys.iter().map(|key| self.value(key.path)).collect()
    }

    fn value(&self, name: &str) -> Result<Value, InputError> {
        match self.given(name) {
            Some(json) => self.key(name).value(json, &format!("{}.{name}", self.path), self.source),
            None => Ok(self.key(name).default_value()),
        }
    }

    /// A number, given or by default.
    pub fn number(&self, name: &str) -> Result<Option<f64>, InputError> {
        Ok(self.value(name)?.number())
    }

    /// A number, given or by default; an error without either.
    pub fn needed(&self, name: &str) -> Result<f64, InputError> {
        self.number(name)?.ok_or_else(|| self.missing(name))
    }

    /// A whole number of 32 bits, given or by default; an error without either.
    pub fn count(&self, name: &str) -> Result<u32, InputError> {
        match self.value(name)? {
            Value::Integer(number) => u32::try_from(number).map_err(|_| self.missing(name)),
            _ => Err(self.missing(name)),
        }
    }

    /// A word or a text, given or by default.
    pub fn text(&self, name: &str) -> Result<Option<String>, InputError> {
        match self.value(name)? {
            Value::Text(text) => Ok(Some(text)),
            _ => Ok(None),
        }
    }

    /// A word or a text, given or by default; an error without either.
    pub fn needed_text(&self, name: &str) -> Result<String, InputError> {
        self.text(name)?.ok_or_else(|| self.missing(name))
    }

    /// Displacement components, letters of "xyz" in any order; an error where they are not given.
    pub fn displacements(&self, name: &str) -> Result<[bool; 3], InputError> {
        let text = self.needed_text(name)?;
        let axes = ["x", "y", "z"];
        let count = |axis: &str| text.matches(axis).count();
        let known: usize = axes.into_iter().map(count).sum();
        if text.is_empty() || known < text.chars().count() || axes.into_iter().any(|a| count(a) > 1)
        {
            let problem = "does not name displacement components";
            return Err(self.error(name, problem, "letters of \"xyz\", each once"));
        }
        Ok(axes.map(|axis| count(axis) == 1))
    }

    /// What a key reads from its value, where given.
    fn read<T>(
        &self,
        name: &str,
        read: fn(&Key, &Json) -> Result<T, Refusal>,
    ) -> Result<Option<T>, InputError> {
        let Some(json) = self.given(name) else { return Ok(None) };
        let key = self.key(name);
        read(key, json).map(Some).map_err(|Refusal { problem, allowed }| {
            let next = format!("write it as in {}", key.sample());
            self.error(name, problem, allowed).with_hint(next)
        })
    }

    /// Three numbers, where given.
    pub fn vector(&self, name: &str) -> Result<Option<Vector3<f64>>, InputError> {
        Ok(self.read(name, Key::read_vector)?.map(Vector3::from))
    }

    /// Three numbers; an error where they are not given.
    pub fn needed_vector(&self, name: &str) -> Result<Vector3<f64>, InputError> {
        self.vector(name)?.ok_or_else(|| self.missing(name))
    }

    /// Three numbers or `null`s, where given.
    pub fn components(&self, name: &str) -> Result<[Option<f64>; 3], InputError> {
        Ok(self.read(name, Key::read_components)?.unwrap_or_default())
    }

    /// A direction as a unit vector; an error where it is not given or zero.
    pub fn direction(&self, name: &str) -> Result<Vector3<f64>, InputError> {
        let vector = self.needed_vector(name)?;
        if vector.norm() > 0.0 {
            Ok(vector.normalize())
        } else {
            Err(self.error(name, "has no direction", "a vector of any length but 0"))
        }
    }
}

/// The members of an object of a table.
pub(crate) fn object<'a>(
    json: &'a Json,
    table: &Table,
    path: &str,
    source: &Source,
) -> Result<&'a [(String, Json)], InputError> {
    match table.children(path) {
        names if names.is_empty() => members(json, path, source, "an object"),
        names => members(json, path, source, &names.join(", ")),
    }
}

/// The members of an object.
pub(crate) fn members<'a>(
    json: &'a Json,
    path: &str,
    source: &Source,
    allowed: &str,
) -> Result<&'a [(String, Json)], InputError> {
    match json {
        Json::Object(members) => Ok(members),
        other => {
            let problem = format!("is {}, not an object", other.kind());
            Err(source.error(path, other, problem, allowed))
        }
    }
}

/// The items of a list.
pub(crate) fn list<'a>(
    json: &'a Json,
    path: &str,
    source: &Source,
    allowed: &str,
) -> Result<&'a [Json], InputError> {
    match json {
        Json::List(items) => Ok(items),
        other => {
            let problem = format!("is {}, not a list", other.kind());
            Err(source.error(path, other, problem, allowed))
        }
    }
}
