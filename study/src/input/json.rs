//! A JSON tree in file order, before its keys get a meaning.

use std::fmt::{self, Write as _};

use serde::ser::{Serialize, Serializer};

use crate::input::value::Value;

/// A JSON value: objects in file order, no key twice, whole numbers distinct from others.
#[derive(Debug, Clone, PartialEq)]
pub enum Json {
    /// `null`.
    Null,
    /// `true`, `false`.
    Bool(bool),
    /// A number written without fraction and exponent.
    Integer(i64),
    /// Any other number; finite.
    Number(f64),
    /// A string.
    Text(String),
    /// An array.
    List(Vec<Json>),
    /// An object.
    Object(Vec<(String, Json)>),
}

impl Json {
    /// The value of a key of an object.
    pub fn get(&self, key: &str) -> Option<&Self> {
        let Self::Object(members) = self else { return None };
        members.iter().find(|(name, _)| name == key).map(|(_, value)| value)
    }

    /// The value of a key of an object, to change it.
    pub fn get_mut(&mut self, key: &str) -> Option<&mut Self> {
        let Self::Object(members) = self else { return None };
        members.iter_mut().find(|(name, _)| name == key).map(|(_, value)| value)
    }

    /// The value of a key of an object, `null` at its end where it has none; `None` for another value.
    pub fn entry(&mut self, key: &str) -> Option<&mut Self> {
        let Self::Object(members) = self else { return None };
        let position = members.iter().position(|(name, _)| name == key).unwrap_or_else(|| {
            members.push((key.to_owned(), Self::Null));
            members.len() - 1
        });
        Some(&mut members[position].1)
    }

    /// Sets a key of an object: replaces its value, or adds it as the last one.
    pub fn set(&mut self, key: &str, value: Self) {
        if let Some(member) = self.entry(key) {
            *member = value;
        }
    }

    /// The whole number that it is, within ±2^53 where it is written with a fraction or an exponent.
    #[expect(clippy::cast_possible_truncation, reason = "checked to be whole and small")]
    pub fn whole(&self) -> Option<i64> {
        match self {
            Self::Integer(number) => Some(*number),
            Self::Number(number) => (number.fract() == 0.0
                && number.abs() <= 9_007_199_254_740_992.0)
                .then_some(*number as i64),
            _ => None,
        }
    }

    /// Name of its type, with its article, for errors.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Bool(_) => "true or false",
            Self::Integer(_) => "a whole number",
            Self::Number(_) => "a number",
            Self::Text(_) => "a text",
            Self::List(_) => "a list",
            Self::Object(_) => "an object",
        }
    }
}

/// The value on one line, cut to the length of an error's line.
impl fmt::Display for Json {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        /// Characters of a value in an error (chosen: key and value fit on one line).
        const MAX_LENGTH: usize = 60;
        let text = serde_json::to_string(self).map_err(|_| fmt::Error)?;
        match text.char_indices().nth(MAX_LENGTH) {
            None => f.write_str(&text),
            Some(_) => {
                text.chars().take(MAX_LENGTH - 1).chain(['…']).try_for_each(|c| f.write_char(c))
            }
        }
    }
}

/// In file order.
impl Serialize for Json {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        match self {
            Self::Null => serializer.serialize_unit(),
            Self::Bool(value) => serializer.serialize_bool(*value),
            Self::Integer(value) => serializer.serialize_i64(*value),
            Self::Number(value) => serializer.serialize_f64(*value),
            Self::Text(value) => serializer.serialize_str(value),
            Self::List(items) => serializer.collect_seq(items),
            Self::Object(members) => {
                serializer.collect_map(members.iter().map(|(key, value)| (key, value)))
            }
        }
    }
}

impl From<&Value> for Json {
    fn from(value: &Value) -> Self {
        match value {
            Value::Null => Self::Null,
            Value::Bool(value) => Self::Bool(*value),
            Value::Integer(value) => Self::Integer(*value),
            Value::Number(value) => Self::Number(*value),
            Value::Text(value) => Self::Text(value.clone()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::syntax::parse;

    #[test]
    fn objects_keep_their_order_and_numbers_their_type() {
        let json = parse(r#"{"b": 8, "a": [8.0, "x", null, true]}"#, "f").unwrap();
        let Json::Object(members) = &json else { panic!("{json:?}") };
        assert_eq!(members[0], ("b".to_owned(), Json::Integer(8)));
        assert_eq!(json.to_string(), r#"{"b":8,"a":[8.0,"x",null,true]}"#);
    }
}
