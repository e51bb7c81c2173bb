//! Reading an object of a scene by the table of its keys.

use nalgebra::Vector3;

use crate::input::keys::{self, Key, Refusal};
use crate::input::settings::read;
use crate::input::source::Source;
use crate::input::study_file::Json;
use crate::input::value::Value;
use crate::platform::error::InputError;

/// An object whose keys are all known.
pub(super) struct Object<'a> {
    json: &'a Json,
    /// Where it stands, as in `supports[0]`.
    pub at: String,
    keys: &'static [Key],
    source: &'a Source,
}

impl<'a> Object<'a> {
    /// The object at a place. `what` it is, with its article; `more` the keys beside those of the
    /// table.
    pub fn new(
        json: &'a Json,
        at: &str,
        what: &str,
        keys: &'static [Key],
        more: &[&str],
        source: &'a Source,
    ) -> Result<Self, InputError> {
        let names = || keys.iter().map(|key| key.path).chain(more.iter().copied());
        let allowed = || names().collect::<Vec<_>>().join(", ");
        let Json::Object(members) = json else {
            let problem = format!("is {}, not an object", json.kind());
            return Err(source.error(at, &json.brief(), problem, allowed()));
        };
        for (name, value) in members {
            if !names().any(|known| known == name) {
                let near = keys::nearest(name, names())
                    .map_or_else(String::new, |near| format!("; did you mean {near}?"));
                let problem = format!("is no key of {what}{near}");
                return Err(source.error(
                    &format!("{at}.{name}"),
                    &value.brief(),
                    problem,
                    allowed(),
                ));
            }
        }
        Ok(Self { json, at: at.to_owned(), keys, source })
    }

    /// What a key is given; `null` is nothing.
    pub fn given(&self, name: &str) -> Option<&'a Json> {
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
        self.source.error(&format!("{}.{name}", self.at), &value, problem, allowed)
    }

    fn key(&self, name: &str) -> &'static Key {
        match self.keys.iter().find(|key| key.path == name) {
            Some(key) => key,
            None => unreachable!("no key {name}"),
        }
    }

    /// The error of a key that is not given.
    pub fn missing(&self, name: &str) -> InputError {
        let Some(key) = self.keys.iter().find(|key| key.path == name) else {
            return self.error(name, "missing", "");
        };
        let mut error = self.error(name, "missing", key.allowed());
        error.hint = format!("give it, as in {}", key.sample());
        error
    }

    fn value(&self, name: &str) -> Result<Value, InputError> {
        let key = self.key(name);
        match self.given(name) {
            Some(json) => read(key, json, &format!("{}.{name}", self.at), self.source),
            None => Ok(key.default_value()),
        }
    }

    /// A number, given or by default.
    pub fn number(&self, name: &str) -> Result<Option<f64>, InputError> {
        match self.value(name)? {
            Value::Number(number) => Ok(Some(number)),
            _ => Ok(None),
        }
    }

    /// A number that must be there.
    pub fn needed(&self, name: &str) -> Result<f64, InputError> {
        self.number(name)?.ok_or_else(|| self.missing(name))
    }

    /// A whole number from 0 on that must be there.
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

    fn refused(&self, name: &str, refusal: Refusal) -> InputError {
        let mut error = self.error(name, refusal.problem, refusal.allowed);
        error.hint = format!("write it as in {}", self.key(name).sample());
        error
    }

    /// Three numbers, where given.
    pub fn vector(&self, name: &str) -> Result<Option<Vector3<f64>>, InputError> {
        let Some(json) = self.given(name) else { return Ok(None) };
        let read = self.key(name).read_vector(json);
        read.map(|vector| Some(vector.into())).map_err(|refusal| self.refused(name, refusal))
    }

    /// Three numbers or `null`s, where given.
    pub fn parts(&self, name: &str) -> Result<[Option<f64>; 3], InputError> {
        let Some(json) = self.given(name) else { return Ok([None; 3]) };
        self.key(name).read_parts(json).map_err(|refusal| self.refused(name, refusal))
    }

    /// A direction that must be there, as a unit vector.
    pub fn direction(&self, name: &str) -> Result<Vector3<f64>, InputError> {
        let vector = self.vector(name)?.ok_or_else(|| self.missing(name))?;
        if vector.norm() > 0.0 {
            Ok(vector.normalize())
        } else {
            Err(self.error(name, "has no direction", "a vector of any length but 0"))
        }
    }
}
