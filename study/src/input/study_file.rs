//! A study or scene file as a JSON tree, in file order, before its keys get a meaning.
//!
//! Refused here, with line and column: invalid JSON, a key given twice, a number beyond `f64`, nesting
//! beyond 128 levels, text that is not UTF-8, a file larger than [`MAX_FILE_SIZE`].

use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

use serde::de::{self, Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde::ser::{Serialize, Serializer};

use crate::input::syntax::{self, place};
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files;

/// Largest study or scene file read, bytes (chosen: such a file is written by hand, and a grid of a
/// million points takes a few lines).
pub const MAX_FILE_SIZE: u64 = 16 << 20;

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

    /// Sets a key of an object: replaces its value, or adds it as the last one.
    pub fn set(&mut self, key: &str, value: Self) {
        match self.get_mut(key) {
            Some(member) => *member = value,
            None => {
                if let Self::Object(members) = self {
                    members.push((key.to_owned(), value));
                }
            }
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

    /// The value as written, on one line, cut to the length of an error's line.
    pub fn brief(&self) -> String {
        /// Characters of a value in an error (chosen: key and value fit on one line).
        const MAX_LENGTH: usize = 60;
        let mut text = String::new();
        write_json(self, &mut text, MAX_LENGTH);
        if text.chars().count() > MAX_LENGTH {
            text = text.chars().take(MAX_LENGTH - 1).collect();
            text.push('…');
        }
        text
    }
}

/// Writes compact JSON; stops soon after `max_length` bytes.
fn write_json(value: &Json, text: &mut String, max_length: usize) {
    if text.len() > max_length {
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
            for (index, item) in items.iter().enumerate() {
                text.push_str(if index > 0 { ", " } else { "" });
                write_json(item, text, max_length);
                if text.len() > max_length {
                    return;
                }
            }
            text.push(']');
        }
        Json::Object(members) => {
            text.push('{');
            for (index, (key, item)) in members.iter().enumerate() {
                text.push_str(if index > 0 { ", " } else { "" });
                text.push_str(&serde_json::Value::from(key.as_str()).to_string());
                text.push_str(": ");
                write_json(item, text, max_length);
                if text.len() > max_length {
                    return;
                }
            }
            text.push('}');
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
/// When the text is not JSON. The error names file, line and column, and the key; it shows the line with
/// the place, and says what to do.
pub fn parse(text: &str, file: &str) -> std::result::Result<Json, InputError> {
    let mut reader = serde_json::Deserializer::from_str(text);
    let mut track = serde_path_to_error::Track::new();
    let read = Json::deserialize(serde_path_to_error::Deserializer::new(&mut reader, &mut track));
    read.and_then(|json| reader.end().map(|()| json)).map_err(|error| {
        let fault = syntax::fault(text).unwrap_or_else(|| {
            let key = track.path().to_string();
            let mut problem = error.to_string();
            if let Some(end) = problem.rfind(" at line ") {
                problem.truncate(end);
            }
            // A reader of bytes counts columns in bytes.
            let lines = text.split_inclusive('\n').take(error.line().saturating_sub(1));
            let offset = lines.map(str::len).sum::<usize>() + error.column().saturating_sub(1);
            let key = if key == "." { String::new() } else { key };
            syntax::Fault { offset, key, problem, hint: String::new() }
        });
        let (line, column) = place::line_and_column(text, fault.offset);
        let excerpt = place::excerpt(text, fault.offset);
        InputError {
            file: format!("{file}:{line}:{column}"),
            key: fault.key,
            value: String::new(),
            problem: format!("invalid JSON: {}\n{excerpt}", fault.problem),
            allowed: "one JSON object (RFC 8259), each key once, numbers within ±1.8e308"
                .to_owned(),
            hint: fault.hint,
        }
    })
}

/// The error of a value of a file, with the line and column of that value in the name of the file.
pub fn with_place(mut error: InputError, text: &str, file: &str) -> InputError {
    // A flag, and the text of another file, have no place in this one.
    if error.file == file
        && !error.key.is_empty()
        && let Some(offset) = syntax::locate(text, &error.key)
    {
        let (line, column) = place::line_and_column(text, offset);
        error.file = format!("{file}:{line}:{column}");
    }
    error
}

/// First bytes of files that are given by mistake, and what they are.
const FOREIGN: &[(&[u8], &str)] = &[
    (b"\x89HDF", "an HDF5 file (as the histories of results are)"),
    (b"PAR1", "a Parquet file (as the table of results is)"),
    (b"\x89PNG", "a PNG picture"),
    (b"%PDF", "a PDF file"),
    (b"PK\x03\x04", "a ZIP archive (office documents are such)"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"\x7fELF", "a program"),
];

/// Reads text from bytes.
///
/// # Errors
/// When the bytes are empty, not UTF-8, or start with a byte order mark.
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
            "starts with a byte order mark".to_owned(),
            "save it as plain UTF-8 (\"UTF-8 without BOM\")",
        ));
    }
    if let Some((_, kind)) = FOREIGN.iter().find(|(start, _)| bytes.starts_with(start)) {
        return Err(refuse(format!("is {kind}, not JSON"), "name a study file or a scene file"));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let sound = String::from_utf8_lossy(&bytes[..error.valid_up_to()]);
        let (line, column) = place::line_and_column(&sound, sound.len());
        refuse(
            format!(
                "is not UTF-8 from byte {} on, line {line} column {column}",
                error.valid_up_to()
            ),
            "save it as UTF-8",
        )
    })?;
    if text.contains('\0') {
        return Err(refuse("is not text: it has NUL bytes".to_owned(), "save it as UTF-8"));
    }
    if text.trim().is_empty() {
        return Err(refuse(
            "is empty".to_owned(),
            "start from a file in studies/ (or, for a scene, in scenes/)",
        ));
    }
    Ok(text)
}

/// The bytes of a study or scene file; `what` names the kind of file, `example` one that ships.
///
/// # Errors
/// [`Error::Disk`] when it cannot be read, or is larger than [`MAX_FILE_SIZE`].
pub fn read(path: &Path, what: &str, example: &str) -> Result<Vec<u8>> {
    let disk = |problem: String| Error::Disk { path: path.to_owned(), problem };
    let unreadable = |error: std::io::Error| {
        let next = match error.kind() {
            std::io::ErrorKind::NotFound | std::io::ErrorKind::IsADirectory => {
                let near = files::nearest_name(path)
                    .map_or_else(String::new, |near| format!("did you mean {near}? Otherwise "));
                format!("\n  next: {near}give the path of a {what}, as {example}")
            }
            _ => "\n  next: make the file readable and run the same command again".to_owned(),
        };
        let problem = match error.kind() {
            std::io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
            _ => error.to_string(),
        };
        disk(format!("cannot read the {what}: {problem}{next}"))
    };
    files::read_at_most(path, MAX_FILE_SIZE).map_err(unreadable)?.ok_or_else(|| {
        let limit = MAX_FILE_SIZE >> 20;
        let next = format!("give the path of a {what}, as {example}");
        disk(format!("is larger than {limit} MiB, the limit of a {what}\n  next: {next}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_keep_their_order_and_numbers_their_type() {
        let json = parse(r#"{"b": 8, "a": [8.0, "x", null, true]}"#, "f").unwrap();
        let Json::Object(members) = &json else { panic!("{json:?}") };
        assert_eq!(members[0], ("b".to_owned(), Json::Integer(8)));
        assert_eq!(json.brief(), r#"{"b": 8, "a": [8.0, "x", null, true]}"#);
        let written = serde_json::to_string(&json).unwrap();
        assert_eq!(written, r#"{"b":8,"a":[8.0,"x",null,true]}"#);
    }

    #[test]
    fn errors_name_line_column_and_key() {
        for (text, key, problem) in [
            (
                "{\"a\": {\"b\": 1,\n \"b\": 2}}",
                "a",
                "2:2: a: invalid JSON: key \"b\" is given twice",
            ),
            ("{\"a\": 1e999}", "a", "1:7: a: invalid JSON: number out of range"),
            ("{\"a\": [1, 2", "", "1:7: invalid JSON: this [ is not closed"),
            ("{} {}", "", "1:4: invalid JSON: trailing characters"),
            ("{\"a\": NaN}", "a", "1:7: a: invalid JSON: expected a finite number"),
        ] {
            let error = parse(text, "f.json").unwrap_err();
            assert!(error.key.starts_with(key), "{text}: {error}");
            assert!(error.to_string().contains(&format!("f.json:{problem}")), "{text}: {error}");
        }
        let deep = "[".repeat(100_000);
        assert!(parse(&deep, "f").unwrap_err().problem.contains("recursion limit"));
    }

    #[test]
    fn bytes_that_are_not_text_are_refused() {
        for bytes in
            [&b""[..], b" \n", b"\xEF\xBB\xBF{}", b"\xFF\xFE{\0}\0", b"{\"a\": \"\xC3\x28\"}"]
        {
            assert!(text_of(bytes, "f").is_err(), "{bytes:?}");
        }
    }
}
