//! Reads values, lists and objects by the tables of their keys.

use nalgebra::Vector3;

use crate::input::json::Json;
use crate::input::keys::{Key, Refusal, Table};
use crate::input::plausible;
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
        let Json::Object(members) = json else {
            let problem = format!("is {}, not an object", json.kind());
            return Err(source.error(path, &json.brief(), problem, names.join(", ")));
        };
        for (name, value) in members {
            if !names.contains(&name.as_str()) {
                let near = or_nearest(name, names.iter().copied());
                let problem = format!("is not a key of {what}{near}");
                let key = format!("{path}.{name}");
                return Err(source.error(&key, &value.brief(), problem, names.join(", ")));
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
        let value = self.given(name).map(Json::brief).unwrap_or_default();
        self.source.error(&format!("{}.{name}", self.path), &value, problem, allowed)
    }

    /// The error of a key that the file does not give.
    pub fn missing(&self, key: &Key) -> InputError {
        let mut error = self.error(key.path, "missing", key.allowed());
        error.hint = format!("give it, as in {}", key.sample());
        error
    }

    /// The value of every key of its table, in their order: given or by default.
    pub fn values(&self) -> Result<Vec<Value>, InputError> {
        self.keys.iter().map(|key| self.value(key)).collect()
    }

    fn value(&self, key: &Key) -> Result<Value, InputError> {
        match self.given(key.path) {
            Some(json) => read(key, json, &format!("{}.{}", self.path, key.path), self.source),
            None => Ok(key.default_value()),
        }
    }

    /// A number, given or by default.
    pub fn number(&self, key: &Key) -> Result<Option<f64>, InputError> {
        match self.value(key)? {
            Value::Number(number) => Ok(Some(number)),
            _ => Ok(None),
        }
    }

    /// A number, given or by default; an error without either.
    pub fn needed(&self, key: &Key) -> Result<f64, InputError> {
        self.number(key)?.ok_or_else(|| self.missing(key))
    }

    /// A whole number of 32 bits, given or by default; an error without either.
    pub fn count(&self, key: &Key) -> Result<u32, InputError> {
        match self.value(key)? {
            Value::Integer(number) => u32::try_from(number).map_err(|_| self.missing(key)),
            _ => Err(self.missing(key)),
        }
    }

    /// A word or a text, given or by default.
    pub fn text(&self, key: &Key) -> Result<Option<String>, InputError> {
        match self.value(key)? {
            Value::Text(text) => Ok(Some(text)),
            _ => Ok(None),
        }
    }

    /// A word or a text, given or by default; an error without either.
    pub fn needed_text(&self, key: &Key) -> Result<String, InputError> {
        self.text(key)?.ok_or_else(|| self.missing(key))
    }

    /// Displacement components, letters of "xyz" in any order; an error where they are not given.
    pub fn displacements(&self, key: &Key) -> Result<[bool; 3], InputError> {
        let text = self.needed_text(key)?;
        let axes = ["x", "y", "z"];
        let count = |axis: &str| text.matches(axis).count();
        let known: usize = axes.into_iter().map(count).sum();
        if text.is_empty() || known < text.chars().count() || axes.into_iter().any(|a| count(a) > 1)
        {
            let problem = "does not name displacement components";
            return Err(self.error(key.path, problem, "letters of \"xyz\", each once"));
        }
        Ok(axes.map(|axis| count(axis) == 1))
    }

    fn refused(&self, key: &Key, refusal: Refusal) -> InputError {
        let mut error = self.error(key.path, refusal.problem, refusal.allowed);
        error.hint = format!("write it as in {}", key.sample());
        error
    }

    /// Three numbers, where given.
    pub fn vector(&self, key: &Key) -> Result<Option<Vector3<f64>>, InputError> {
        let Some(json) = self.given(key.path) else { return Ok(None) };
        let read = key.read_vector(json);
        read.map(|vector| Some(vector.into())).map_err(|refusal| self.refused(key, refusal))
    }

    /// Three numbers; an error where they are not given.
    pub fn needed_vector(&self, key: &Key) -> Result<Vector3<f64>, InputError> {
        self.vector(key)?.ok_or_else(|| self.missing(key))
    }

    /// Three numbers or `null`s, where given.
    pub fn components(&self, key: &Key) -> Result<[Option<f64>; 3], InputError> {
        let Some(json) = self.given(key.path) else { return Ok([None; 3]) };
        key.read_components(json).map_err(|refusal| self.refused(key, refusal))
    }

    /// A direction as a unit vector; an error where it is not given or zero.
    pub fn direction(&self, key: &Key) -> Result<Vector3<f64>, InputError> {
        let vector = self.needed_vector(key)?;
        if vector.norm() > 0.0 {
            Ok(vector.normalize())
        } else {
            Err(self.error(key.path, "has no direction", "a vector of any length but 0"))
        }
    }
}

/// Reads one value of a key; `path` is where the file gives it. A value that is not plausible is a
/// warning of the source.
pub(crate) fn read(
    key: &Key,
    json: &Json,
    path: &str,
    source: &Source,
) -> Result<Value, InputError> {
    let value = read_silently(key, json, path, source)?;
    if let Some(implausible) = plausible::check(key, json, &value) {
        source.warn(path, &json.brief(), implausible);
    }
    Ok(value)
}

/// Reads one value of a key that no user wrote, as a value between the ends of a range.
pub(crate) fn read_silently(
    key: &Key,
    json: &Json,
    path: &str,
    source: &Source,
) -> Result<Value, InputError> {
    key.read(json).map_err(|refusal| {
        let mut error = source.error(path, &json.brief(), refusal.problem, refusal.allowed);
        error.hint = match plausible::meant(key, json) {
            Some(text) => format!("if {text} is meant, write {text:?}"),
            None => format!("write it as in {}", key.sample()),
        };
        error
    })
}

/// Reads one finite number of a key: an end of an axis.
pub(crate) fn read_number(
    key: &Key,
    json: &Json,
    path: &str,
    source: &Source,
) -> Result<f64, InputError> {
    match read(key, json, path, source)? {
        Value::Number(number) if number.is_finite() => Ok(number),
        Value::Integer(number) => Ok(number as f64),
        _ => Err(source.error(path, &json.brief(), "is a word, not a number", key.allowed())),
    }
}

/// The members of an object.
pub(crate) fn object<'a>(
    json: &'a Json,
    table: &Table,
    path: &str,
    source: &Source,
) -> Result<&'a [(String, Json)], InputError> {
    match json {
        Json::Object(members) => Ok(members),
        other => Err(source.error(
            path,
            &other.brief(),
            format!("is {}, not an object", other.kind()),
            match table.children(path) {
                names if names.is_empty() => "an object".to_owned(),
                names => names.join(", "),
            },
        )),
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
            Err(source.error(path, &other.brief(), problem, allowed))
        }
    }
}
