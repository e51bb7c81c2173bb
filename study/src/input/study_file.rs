//! Exactly what a study file says: its JSON as a tree, in file order, before any meaning.
//!
//! Refused here, with line and column: what is no JSON, a key given twice, a number no `f64` holds,
//! nesting beyond 128 levels, text that is not UTF-8, a file beyond [`LARGEST_FILE`].

use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

use serde::de::{self, Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde::ser::{Serialize, Serializer};

use crate::platform::error::{Error, InputError, Result};
use crate::platform::files;

/// Largest study file read, bytes. A study is written by hand; a grid of a million points fits in a
/// few lines.
pub const LARGEST_FILE: u64 = 16 << 20;

/// A JSON value: objects in file order, no key twice, whole numbers told from others.
#[derive(Debug, Clone, PartialEq)]
pub enum Json {
    /// `null`.
    Null,
    /// `true`, `false`.
    Bool(bool),
    /// A number written as a whole one.
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

    /// Sets a key of an object: in its place where it is there, else as the last one.
    pub fn set(&mut self, key: &str, value: Self) {
        let Self::Object(members) = self else { return };
        match members.iter_mut().find(|(name, _)| name == key) {
            Some((_, place)) => *place = value,
            None => members.push((key.to_owned(), value)),
        }
    }

    /// What it is, with its article, as errors say it.
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

    /// The value as written, on one line, cut to a length an error can show.
    pub fn brief(&self) -> String {
        const LONGEST: usize = 60;
        let mut text = String::new();
        write_json(self, &mut text, LONGEST);
        if text.chars().count() > LONGEST {
            text = text.chars().take(LONGEST - 1).collect();
            text.push('…');
        }
        text
    }
}

/// Writes compact JSON, stopping soon after `longest` bytes.
fn write_json(value: &Json, text: &mut String, longest: usize) {
    if text.len() > longest {
        return;
    }
    match value {
        Json::Null => text.push_str("null"),
        Json::Bool(value) => text.push_str(if *value { "true" } else { "false" }),
        Json::Integer(value) => text.push_str(&value.to_string()),
        Json::Number(value) => text.push_str(&serde_json::Value::from(*value).to_string()),
        Json::Text(value) => text.push_str(&serde_json::Value::from(value.as_str()).to_string()),
        Json::List(items) => {
            text.push('[');
            for (at, item) in items.iter().enumerate() {
                text.push_str(if at > 0 { ", " } else { "" });
                write_json(item, text, longest);
                if text.len() > longest {
                    return;
                }
            }
            text.push(']');
        }
        Json::Object(members) => {
            text.push('{');
            for (at, (key, item)) in members.iter().enumerate() {
                text.push_str(if at > 0 { ", " } else { "" });
                text.push_str(&serde_json::Value::from(key.as_str()).to_string());
                text.push_str(": ");
                write_json(item, text, longest);
                if text.len() > longest {
                    return;
                }
            }
            text.push('}');
        }
    }
}

/// In file order, as it was read.
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

impl From<serde_json::Value> for Json {
    fn from(value: serde_json::Value) -> Self {
        match value {
            serde_json::Value::Null => Self::Null,
            serde_json::Value::Bool(value) => Self::Bool(value),
            serde_json::Value::Number(number) => number
                .as_i64()
                .map_or_else(|| Self::Number(number.as_f64().unwrap_or(f64::NAN)), Self::Integer),
            serde_json::Value::String(text) => Self::Text(text),
            serde_json::Value::Array(items) => {
                Self::List(items.into_iter().map(Self::from).collect())
            }
            serde_json::Value::Object(members) => Self::Object(
                members.into_iter().map(|(key, value)| (key, Self::from(value))).collect(),
            ),
        }
    }
}

impl<'de> Deserialize<'de> for Json {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_any(JsonVisitor)
    }
}

struct JsonVisitor;

impl<'de> Visitor<'de> for JsonVisitor {
    type Value = Json;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_unit<E: de::Error>(self) -> std::result::Result<Json, E> {
        Ok(Json::Null)
    }

    fn visit_bool<E: de::Error>(self, value: bool) -> std::result::Result<Json, E> {
        Ok(Json::Bool(value))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> std::result::Result<Json, E> {
        Ok(Json::Integer(value))
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> std::result::Result<Json, E> {
        Ok(i64::try_from(value).map_or(Json::Number(value as f64), Json::Integer))
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> std::result::Result<Json, E> {
        Ok(Json::Number(value))
    }

    fn visit_str<E: de::Error>(self, value: &str) -> std::result::Result<Json, E> {
        Ok(Json::Text(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> std::result::Result<Json, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = list.next_element()? {
            items.push(item);
        }
        Ok(Json::List(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<Json, A::Error> {
        let mut members = Vec::new();
        let mut seen = BTreeSet::new();
        while let Some(key) = map.next_key::<String>()? {
            if !seen.insert(key.clone()) {
                return Err(de::Error::custom(format_args!("key {key:?} is given twice")));
            }
            members.push((key, map.next_value()?));
        }
        Ok(Json::Object(members))
    }
}

/// Reads JSON text.
///
/// # Errors
/// Names the file, line and column, and the key reached.
pub fn parse(text: &str, file: &str) -> std::result::Result<Json, InputError> {
    let mut reader = serde_json::Deserializer::from_str(text);
    let mut track = serde_path_to_error::Track::new();
    let read = Json::deserialize(serde_path_to_error::Deserializer::new(&mut reader, &mut track));
    read.and_then(|json| reader.end().map(|()| json)).map_err(|error| {
        let key = track.path().to_string();
        let mut message = error.to_string();
        if let Some(place) = message.rfind(" at line ") {
            message.truncate(place);
        }
        let problem =
            format!("not sound JSON: {message}, line {} column {}", error.line(), error.column());
        InputError {
            file: file.to_owned(),
            key: if key == "." { String::new() } else { key },
            value: String::new(),
            problem,
            allowed: "one JSON object (RFC 8259), each key once, numbers within ±1.8e308"
                .to_owned(),
            hint: String::new(),
        }
    })
}

/// Reads text from bytes.
///
/// # Errors
/// Empty, not UTF-8, or opened by a byte order mark.
pub fn text_of<'a>(bytes: &'a [u8], file: &str) -> std::result::Result<&'a str, InputError> {
    let refuse = |problem: String, hint: &str| InputError {
        file: file.to_owned(),
        key: String::new(),
        value: String::new(),
        problem,
        allowed: "JSON in UTF-8, without a byte order mark".to_owned(),
        hint: hint.to_owned(),
    };
    if bytes.starts_with(&[0xEF, 0xBB, 0xBF])
        || bytes.starts_with(&[0xFF, 0xFE])
        || bytes.starts_with(&[0xFE, 0xFF])
    {
        return Err(refuse(
            "opens with a byte order mark".to_owned(),
            "save it as plain UTF-8 (\"UTF-8 without BOM\")",
        ));
    }
    let text = std::str::from_utf8(bytes)
        .map_err(|error| refuse(format!("not UTF-8 from byte {} on", error.valid_up_to()), ""))?;
    if text.trim().is_empty() {
        return Err(refuse(
            "empty".to_owned(),
            "start from a file in studies/ (or, for one scene, scenes/)",
        ));
    }
    Ok(text)
}

/// The bytes of a study or scene file; `what` it is to be, `example` one that ships.
///
/// # Errors
/// [`Error::Disk`] when it cannot be read, or is larger than [`LARGEST_FILE`].
pub fn read(path: &Path, what: &str, example: &str) -> Result<Vec<u8>> {
    let disk = |problem: String| Error::Disk { path: path.to_owned(), problem };
    let unreadable = |error: std::io::Error| {
        let next = match error.kind() {
            std::io::ErrorKind::NotFound | std::io::ErrorKind::IsADirectory => {
                format!("\n  next: give the path of a {what}, as {example}")
            }
            _ => String::new(),
        };
        disk(format!("cannot read the {what}: {error}{next}"))
    };
    files::read_at_most(path, LARGEST_FILE).map_err(unreadable)?.ok_or_else(|| {
        disk(format!("larger than the {} MiB a {what} may have", LARGEST_FILE >> 20))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_keep_their_order_and_numbers_their_kind() {
        let json = parse(r#"{"b": 8, "a": [8.0, "x", null, true]}"#, "f").unwrap();
        let Json::Object(members) = &json else { panic!("{json:?}") };
        assert_eq!(members[0], ("b".to_owned(), Json::Integer(8)));
        assert_eq!(json.brief(), r#"{"b": 8, "a": [8.0, "x", null, true]}"#);
        let written = serde_json::to_string(&json).unwrap();
        assert_eq!(written, r#"{"b":8,"a":[8.0,"x",null,true]}"#);
    }

    #[test]
    fn errors_carry_line_column_and_key() {
        for (text, key, problem) in [
            ("{\"a\": {\"b\": 1,\n \"b\": 2}}", "a", "key \"b\" is given twice, line 2 column"),
            ("{\"a\": 1e999}", "a", "number out of range, line 1"),
            ("{\"a\": [1, 2", "a", "EOF while parsing"),
            ("{} {}", "", "trailing characters, line 1 column 4"),
            ("{\"a\": NaN}", "a", "expected"),
        ] {
            let error = parse(text, "f.json").unwrap_err();
            assert!(error.key.starts_with(key), "{text}: {error}");
            assert!(error.problem.contains(problem), "{text}: {error}");
        }
        let deep = "[".repeat(100_000);
        assert!(parse(&deep, "f").unwrap_err().problem.contains("recursion limit"));
    }

    #[test]
    fn bytes_that_are_no_text_are_refused() {
        for bytes in
            [&b""[..], b" \n", b"\xEF\xBB\xBF{}", b"\xFF\xFE{\0}\0", b"{\"a\": \"\xC3\x28\"}"]
        {
            assert!(text_of(bytes, "f").is_err(), "{bytes:?}");
        }
    }
}
