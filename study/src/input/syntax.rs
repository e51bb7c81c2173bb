//! The JSON that people write: comments and commas before a closing bracket are allowed, and every fault
//! has a place, the key that it belongs to, and what to do.

use std::collections::BTreeMap;

use jsonc_parser::ast;
use jsonc_parser::common::Ranged as _;
use jsonc_parser::errors::{ParseError, ParseErrorKind};
use jsonc_parser::tokens::Token;
use jsonc_parser::{CollectOptions, ParseOptions, ParseStringErrorKind, Scanner, parse_to_ast};

use crate::input::json::Json;
use crate::input::place;
use crate::platform::error::InputError;
use crate::platform::quote;

/// RFC 8259 with comments and trailing commas.
const DIALECT: ParseOptions = ParseOptions {
    allow_comments: true,
    allow_loose_object_property_names: false,
    allow_trailing_commas: true,
    allow_missing_commas: false,
    allow_single_quoted_strings: false,
    allow_hexadecimal_numbers: false,
    allow_unary_plus_numbers: false,
    allow_bare_decimal_point_numbers: false,
    allow_non_finite_numbers: false,
    allow_extended_string_escapes: false,
};

/// What a value may be, for messages.
const VALUES: &str =
    "a value is a number, a text in straight double quotes, true, false, null, [ ] or { }";
const CLOSE_TEXT: &str = "write the quote at the end of the text";

#[derive(Debug)]
struct Fault {
    /// Its place, a byte of the text.
    offset: usize,
    /// The key of a value that is refused, as in `design.N`; empty for a fault of the syntax.
    key: String,
    problem: String,
    hint: String,
}

/// Reads JSON text.
///
/// # Errors
/// When the text is not JSON. The error names file, line and column, and the key; it shows the line with
/// the place, and says what to do.
pub fn parse(text: &str, file: &str) -> Result<Json, InputError> {
    let read = match parse_to_ast(text, &CollectOptions::default(), &DIALECT) {
        Ok(parsed) => match &parsed.value {
            Some(value) => tree(value, text, ""),
            None => Err(Fault {
                offset: text.len(),
                key: String::new(),
                problem: "the file ends here, without a value".to_owned(),
                hint: "write an object".to_owned(),
            }),
        },
        Err(error) => Err(explained(&error, text)),
    };
    read.map_err(|fault| {
        let (line, column) = place::line_and_column(text, fault.offset);
        let excerpt = place::excerpt(text, fault.offset);
        InputError {
            file: format!("{file}:{line}:{column}"),
            key: fault.key,
            value: String::new(),
            problem: format!("invalid JSON: {}\n{excerpt}", fault.problem),
            allowed:
                "one JSON object (RFC 8259; comments and trailing commas are allowed), each key \
                      once, numbers within ±1.8e308"
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
        && let Some(offset) = locate(text, &error.key)
    {
        let (line, column) = place::line_and_column(text, offset);
        error.file = format!("{file}:{line}:{column}");
    }
    error
}

/// The place of the value of a key, as in `grid.N[2]`.
fn locate(text: &str, key: &str) -> Option<usize> {
    fn within(value: &ast::Value<'_>, path: &str, key: &str) -> Option<usize> {
        if path == key {
            return Some(value.start());
        }
        match value {
            ast::Value::Object(object) => object
                .properties
                .iter()
                .find_map(|member| within(&member.value, &below(path, member.name.as_str()), key)),
            ast::Value::Array(array) => {
                (0..).zip(&array.elements).find_map(|(index, item): (usize, _)| {
                    within(item, &format!("{path}[{index}]"), key)
                })
            }
            _ => None,
        }
    }
    let parsed = parse_to_ast(text, &CollectOptions::default(), &DIALECT).ok()?;
    within(parsed.value.as_ref()?, "", key)
}

/// The path of a member.
fn below(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}

/// A value with its members; refuses a key that is given twice, a number beyond `f64`, and a text of
/// several lines.
fn tree(value: &ast::Value<'_>, text: &str, path: &str) -> Result<Json, Fault> {
    let fault = |offset, problem: String, hint: &str| {
        Err(Fault { offset, key: path.to_owned(), problem, hint: hint.to_owned() })
    };
    match value {
        ast::Value::NullKeyword(_) => Ok(Json::Null),
        ast::Value::BooleanLit(flag) => Ok(Json::Bool(flag.value)),
        ast::Value::StringLit(literal) => {
            if literal.text(text).contains('\n') {
                let problem = "this text has no closing quote in its line".to_owned();
                return fault(literal.start(), problem, CLOSE_TEXT);
            }
            Ok(Json::Text(literal.value.clone().into_owned()))
        }
        ast::Value::NumberLit(number) => match (number.value.parse(), number.value.parse()) {
            (Ok(whole), _) => Ok(Json::Integer(whole)),
            (_, Ok(value)) if f64::is_finite(value) => Ok(Json::Number(value)),
            _ => fault(
                number.start(),
                "number out of range".to_owned(),
                "write a number within ±1.8e308",
            ),
        },
        ast::Value::Array(array) => {
            let items = array.elements.iter().enumerate();
            let items = items.map(|(index, item)| tree(item, text, &format!("{path}[{index}]")));
            items.collect::<Result<_, _>>().map(Json::List)
        }
        ast::Value::Object(object) => {
            let mut places = BTreeMap::new();
            let mut members = Vec::with_capacity(object.properties.len());
            for member in &object.properties {
                let (name, start) = (member.name.as_str(), member.start());
                if let Some(first) = places.insert(name, start) {
                    let (line, column) = place::line_and_column(text, first);
                    let name = quote::echo(name);
                    let problem = format!(
                        "key \"{name}\" is given twice, first in line {line}, column {column}"
                    );
                    return fault(start, problem, "remove one of the two");
                }
                members.push((name.to_owned(), tree(&member.value, text, &below(path, name))?));
            }
            Ok(Json::Object(members))
        }
    }
}

/// What a reader needs to know about the text before a fault.
#[derive(Default)]
struct Before {
    /// The places of the open brackets.
    open: Vec<usize>,
    /// The bracket that was open where a closing bracket stood at the indent of an outer one: most
    /// likely it is the one that was not closed.
    suspect: Option<usize>,
    /// A text that goes on in the next line: most likely its quote is missing.
    long_text: Option<usize>,
}

impl Before {
    fn of(text: &str, end: usize) -> Self {
        let mut before = Self::default();
        let mut scanner = Scanner::new(text, &jsonc_parser::ScannerOptions::default());
        while let Ok(Some(token)) = scanner.scan() {
            let start = scanner.token_start();
            if start >= end {
                break;
            }
            match token {
                Token::OpenBrace | Token::OpenBracket => before.open.push(start),
                Token::CloseBrace | Token::CloseBracket => before.close(text, start),
                Token::String(_) if text[start..scanner.token_end()].contains('\n') => {
                    before.long_text.get_or_insert(start);
                }
                _ => {}
            }
        }
        before
    }

    /// Closes the innermost bracket.
    fn close(&mut self, text: &str, offset: usize) {
        let line = |offset: usize| text[..offset].rfind('\n').map_or(0, |end| end + 1);
        let indent = |offset: usize| {
            let line = &text[line(offset)..];
            line.len() - line.trim_start_matches([' ', '\t']).len()
        };
        let begins_line = text[line(offset)..offset].trim().is_empty();
        if let Some(inner) = self.open.pop()
            && begins_line
            && indent(offset) < indent(inner)
            && self.open.iter().any(|outer| indent(*outer) == indent(offset))
        {
            self.suspect.get_or_insert(inner);
        }
    }
}

/// A fault of the parser in words.
fn explained(error: &ParseError, text: &str) -> Fault {
    use ParseErrorKind as Kind;
    let say = |problem: &str, hint: &str| (problem.to_owned(), hint.to_owned());
    let mut offset = error.range().start;
    let is_open = matches!(error.kind(), Kind::UnterminatedObject | Kind::UnterminatedArray);
    let before = Before::of(text, if is_open { text.len() } else { offset });
    let rest = &text[offset..];
    let word = rest.trim_start().split([',', '}', ']', '{', '[', '"', ':', '\n', '\r']).next();
    let word = quote::echo(word.unwrap_or("").trim_end());
    let is_word = word.starts_with(|c: char| c.is_alphabetic() || c == '°');
    let line = text[..offset].rsplit('\n').next().unwrap_or("").trim_end();
    let number = line.rsplit([' ', ':', ',', '[', '\t']).next().unwrap_or("");
    let (problem, hint) = match error.kind() {
        _ if before.long_text.is_some() => {
            offset = before.long_text.unwrap_or(offset);
            say("this text has no closing quote in its line", CLOSE_TEXT)
        }
        Kind::UnterminatedObject | Kind::UnterminatedArray => {
            offset = before.suspect.or(before.open.last().copied()).unwrap_or(offset);
            let [open, close] =
                if text[offset..].starts_with('{') { ["{", "}"] } else { ["[", "]"] };
            (format!("this {open} is not closed"), format!("add the missing {close}"))
        }
        Kind::NestingDepthExceeded => say(
            "recursion limit: too many brackets inside each other",
            "a study and a scene need fewer than ten",
        ),
        Kind::String(ParseStringErrorKind::UnterminatedStringLiteral) => {
            say("this text has no closing quote", CLOSE_TEXT)
        }
        Kind::String(kind) => say(
            &kind.to_string().to_lowercase(),
            "write \\\\ for a backslash; / separates folders on every system",
        ),
        Kind::SingleQuotedStringsNotAllowed => {
            say("' is not the quote of JSON", "write straight double quotes, \"")
        }
        Kind::MultipleRootJsonValues => say(
            "the object has ended before this",
            "remove the closing bracket that comes too early, or this text",
        ),
        _ if before.open.is_empty() => say(
            "a file begins with {, not with this",
            "is it another kind of file? start from one in studies/ or scenes/",
        ),
        _ if is_word && number.parse::<f64>().is_ok() => {
            say("a number with a unit is a text", &format!("write \"{number} {word}\""))
        }
        _ if is_word && text[..offset].ends_with('"') => say(
            "the text before this has no closing quote, or a quote inside",
            "write the quote at the end of the text, and \\\" inside a text",
        ),
        Kind::ExpectedComma => {
            say("a comma is missing after this value", "write a comma here, or close the bracket")
        }
        Kind::ExpectedColonAfterObjectKey => {
            say("a colon is missing after this key", "write \"key\": value")
        }
        Kind::ExpectedStringObjectProperty => say(
            "a key stands in double quotes",
            &format!("write \"{word}\":; a number has a point, as in 0.5"),
        ),
        Kind::UnexpectedWord | Kind::UnexpectedToken if is_word => say(
            "a text stands in double quotes",
            &format!("write \"{word}\"; true, false and null alone stand without"),
        ),
        Kind::UnexpectedToken | Kind::UnexpectedTokenInObject => {
            let found = rest.chars().next().unwrap_or(' ');
            let shown = quote::printable(&found.to_string());
            (format!("{shown} (U+{:04X}) cannot stand here", u32::from(found)), VALUES.to_owned())
        }
        kind => say(&kind.to_string().to_lowercase(), VALUES),
    };
    Fault { offset, key: String::new(), problem, hint }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Marks the place of a fault in a text of these tests; it is no part of the text.
    const MARK: char = '¦';

    #[test]
    fn a_fault_stands_where_a_reader_would_point() {
        for (marked, problem, hint) in [
            ("{\"a\": {\"b\": 1¦ \"c\": 2}}", "a comma is missing", "write a comma"),
            ("{\n  \"a\": [1, 2¦\n  3]\n}", "a comma is missing", "close"),
            ("{\"a\": [6,¦, 5]}", "comma", "a value is a number"),
            ("{\"a\": ¦}", "", "a value is a number"),
            ("{\"a\" ¦6}", "a colon is missing", "write \"key\": value"),
            ("{¦a: 6}", "a key stands in double quotes", "write \"a\":"),
            ("{¦'a': 6}", "' is not the quote of JSON", "straight double quotes"),
            ("{\"a\": ¦“x”}", "U+201C", "straight double quotes"),
            ("{\"a\": ¦film}", "a text stands in double quotes", "write \"film\""),
            ("{\"a\": ¦NaN}", "a text stands in double quotes", "a"),
            ("{\"a\": 5 ¦g/s, \"b\": 1}", "a number with a unit", "write \"5 g/s\""),
            ("{\"a\": 30 ¦°}", "a number with a unit is a text", "write \"30 °\""),
            ("{\"a\": ¦0x10}", "hexadecimal", "a value is a number"),
            ("{\"a\": ¦1e999}", "number out of range", "1.8e308"),
            ("{\"a\": 0,¦5, \"b\": 1}", "a key stands in double quotes", "as in 0.5"),
            ("{\"a\": ¦\"x,\n\"b\": 3}", "no closing quote in its line", "end of the text"),
            ("{\"a\": ¦\"x", "no closing quote", "end of the text"),
            ("{\"a\": \"C:¦\\data\"}", "invalid escape", "write \\\\"),
            ("{\"a\": {\"b\": 1,\n ¦\"b\": 2}}", "first in line 1, column 8", "one"),
            ("{\"a\": [1, 2¦}}", "close brace", "a value"),
            ("{\"a\": 1}¦}", "the object has ended before this", "too early"),
            ("¦{\"a\": 1", "this { is not closed", "add the missing }"),
            ("{\"a\": ¦[1, 2", "this [ is not closed", "add the missing ]"),
            (
                "{\n  \"a\": ¦{\n    \"b\": 1,\n  \"c\": {\n    \"d\": 2\n  }\n}\n",
                "this { is not closed",
                "add the missing }",
            ),
            ("¦design:\n  N: 6\n", "begins with {", "another kind of file"),
            ("¦<html>", "begins with {", "another kind of file"),
        ] {
            let text = marked.replace(MARK, "");
            let error = parse(&text, "f").unwrap_err();
            let (line, column) = place::line_and_column(&text, marked.find(MARK).unwrap());
            let shown = format!("{marked}\n{error}");
            assert_eq!(error.file, format!("f:{line}:{column}"), "{shown}");
            assert!(error.problem.contains(problem) && error.hint.contains(hint), "{shown}");
            assert!(!error.allowed.is_empty(), "{shown}");
        }
        let deep = parse(&"[".repeat(100_000), "f").unwrap_err();
        assert!(deep.problem.contains("recursion limit"));
    }

    #[test]
    fn comments_and_trailing_commas_are_read() {
        let text = "{\n  // panels\n  \"N\": [6, 8,], /* both */\n}\n";
        let numbers = Json::List(vec![Json::Integer(6), Json::Integer(8)]);
        assert_eq!(parse(text, "f").unwrap().get("N"), Some(&numbers));
    }

    #[test]
    fn a_value_is_found_by_its_key() {
        let text = "{\"a\": {\"b\": [1, {\"c\": \"x\"}]},\n \"b\": 2}";
        for (key, value) in [("a.b[1].c", "\"x\""), ("a.b[0]", "1"), ("b", "2"), ("a", "{\"b\"")] {
            let offset = locate(text, key).unwrap();
            assert!(text[offset..].starts_with(value), "{key}");
        }
        assert_eq!(locate(text, "a.c"), None);
    }
}
