//! One key of a file: its name, what it may hold, its default, its meaning.

use std::fmt::Write as _;

use super::quantity::Quantity;
use super::words::{FORMULAS, Word};
use crate::input::json::Json;
use crate::input::plausible;
use crate::input::source::Source;
use crate::input::units;
use crate::input::value::Value;
use crate::platform::error::InputError;
use crate::platform::nearest::nearest;

/// One key that holds one value: one row of a table of keys.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// Dotted path, as in `film.thickness`.
    pub path: &'static str,
    /// What it may hold.
    pub kind: KeyKind,
    /// Its value when the file does not give it.
    pub default: Default,
    /// Meaning, one line.
    pub doc: &'static str,
    /// A value as a user writes it, JSON.
    pub example: &'static str,
    /// Whether only a study file has the key; a scene file has it as well otherwise.
    pub study_only: bool,
    /// Paths of the keys that lose their value when this one is set.
    pub excludes: &'static [&'static str],
}

/// What a key may hold.
#[derive(Debug, Clone, Copy)]
pub enum KeyKind {
    /// A number in SI, or a text with a unit.
    Quantity(Quantity),
    /// A whole number, both ends allowed.
    Integer(i64, i64),
    /// One of these words.
    Choice(&'static [Word]),
    /// Any text.
    Text,
    /// True or false.
    Flag,
    /// Three such quantities, x, y, z: [`Key::read_vector`].
    Vector(Quantity),
}

/// The value of a key that the file does not give.
#[derive(Debug, Clone, Copy)]
pub enum Default {
    /// This number, SI.
    Number(f64),
    /// This whole number.
    Integer(i64),
    /// This word.
    Word(&'static str),
    /// No value; the text says what happens then.
    Absent(&'static str),
    /// The file must give it, in its section or on the grid.
    Required,
}

/// Why a key cannot hold a value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal {
    /// What is wrong.
    pub problem: String,
    /// What is allowed.
    pub allowed: String,
}

impl Key {
    /// The last part of the path.
    pub fn leaf(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }

    /// Whether a grid may vary it: every key except those that name the file and the study, and those that
    /// change no job.
    pub fn varies(&self) -> bool {
        let names = matches!(self.path, "format" | "version" | "name" | "question");
        !names && !self.path.starts_with("job_limits.")
    }

    /// The default as a value; `Null` where there is none.
    pub fn default_value(&self) -> Value {
        match self.default {
            Default::Number(number) => Value::Number(number),
            Default::Integer(number) => Value::Integer(number),
            Default::Word(word) => Value::Text(word.to_owned()),
            Default::Absent(_) | Default::Required => Value::Null,
        }
    }

    /// SI unit: "1" for a pure number, empty for a word, a text or a flag.
    pub fn unit(&self) -> &'static str {
        match self.kind {
            KeyKind::Quantity(quantity) | KeyKind::Vector(quantity) => quantity.dimension.si(),
            KeyKind::Integer(..) => "1",
            KeyKind::Choice(_) | KeyKind::Text | KeyKind::Flag => "",
        }
    }

    /// What the key allows, in words.
    pub fn allowed(&self) -> String {
        match self.kind {
            KeyKind::Quantity(quantity) => quantity.allowed(),
            KeyKind::Integer(min, max) => format!("a whole number, {min} to {max}"),
            KeyKind::Choice(words) => names(words).collect::<Vec<_>>().join(", "),
            KeyKind::Text => "a text".to_owned(),
            KeyKind::Flag => "true or false".to_owned(),
            KeyKind::Vector(quantity) => format!("a list of three: {}", quantity.allowed()),
        }
    }

    /// Meaning, with the meanings of its words.
    pub fn meaning(&self) -> String {
        let mut meaning = self.doc.to_owned();
        if let KeyKind::Choice(words) = self.kind {
            let explained = words.iter().filter(|word| !word.meaning.is_empty());
            let texts: Vec<String> =
                explained.map(|word| format!("{}: {}", word.name, word.meaning)).collect();
            if !texts.is_empty() {
                let _ = write!(meaning, " {}.", texts.join("; "));
            }
        }
        meaning
    }

    /// The key as a file has it, as in `"thickness": "25.4 um"`.
    pub fn sample(&self) -> String {
        format!("\"{}\": {}", self.leaf(), self.example)
    }

    /// Reads the value that a file gives at a path. A value that is not plausible is a warning of the source.
    pub(crate) fn value(
        &self,
        json: &Json,
        path: &str,
        source: &Source,
    ) -> Result<Value, InputError> {
        let value = self.value_silently(json, path, source)?;
        if let Some(implausible) = plausible::check(self, json, &value) {
            source.warn(path, json, implausible);
        }
        Ok(value)
    }

    /// The keys of its object, where it has one beside its words.
    fn parts(&self) -> Vec<&'static str> {
        let is_part =
            |key: &&Key| key.path.strip_prefix(self.path).is_some_and(|rest| rest.starts_with('.'));
        super::KEYS.iter().filter(is_part).map(|key| key.path).collect()
    }

    /// Reads a value that no user wrote, as one between the ends of a range.
    pub(crate) fn value_silently(
        &self,
        json: &Json,
        path: &str,
        source: &Source,
    ) -> Result<Value, InputError> {
        self.read(json).map_err(|Refusal { problem, allowed }| {
            source.error(path, json, problem, allowed).with_hint(
                match plausible::meant(self, json) {
                    None if matches!(json, Json::Object(_)) && !self.parts().is_empty() => format!(
                        "an axis takes its words; {} vary together under grid.zip",
                        self.parts().join(" and ")
                    ),
                    Some(text) => format!("if {text} is meant, write {text:?}"),
                    None => format!("write it as in {}", self.sample()),
                },
            )
        })
    }

    /// Reads a finite number: an end of an axis.
    pub(crate) fn finite(
        &self,
        json: &Json,
        path: &str,
        source: &Source,
    ) -> Result<f64, InputError> {
        match self.value(json, path, source)? {
            Value::Number(number) if number.is_finite() => Ok(number),
            Value::Integer(number) => Ok(number as f64),
            _ => Err(source.error(path, json, "is a word, not a number", self.allowed())),
        }
    }

    /// Reads a value: units to SI, 8.0 as the whole number 8 and 8 as the number 8.0, −0 as 0.
    ///
    /// # Errors
    /// When the value has another type or dimension, or is out of range.
    pub fn read(&self, json: &Json) -> Result<Value, Refusal> {
        let refuse = |problem: String| Err(Refusal { problem, allowed: self.allowed() });
        match (self.kind, json) {
            (KeyKind::Quantity(quantity), _) => quantity.read(json).or_else(refuse),
            (KeyKind::Integer(min, max), _) => integer(json, min, max).or_else(refuse),
            (KeyKind::Choice(words), Json::Text(text)) => {
                let named = FORMULAS.iter().find(|(formula, _)| formula == text);
                let word = named.map_or(text.as_str(), |(_, name)| *name);
                if names(words).any(|name| name == word) {
                    return Ok(Value::Text(word.to_owned()));
                }
                if self.path == "design.caps" && text == "circular" {
                    return refuse(
                        "circular caps belong to the erected shape: a disc cannot be sewn to a \
                         flat-folded N-gon without strain"
                            .to_owned(),
                    );
                }
                let hint = match nearest(text, names(words)) {
                    Some(near) => format!("; did you mean {near:?}?"),
                    None => String::new(),
                };
                refuse(format!("is not one of the words of this key{hint}"))
            }
            (KeyKind::Text, Json::Text(text)) => Ok(Value::Text(text.clone())),
            (KeyKind::Flag, Json::Bool(flag)) => Ok(Value::Bool(*flag)),
            (KeyKind::Flag, other) => refuse(format!("is {}, not true or false", other.kind())),
            (_, other) => refuse(format!("is {}, not a text", other.kind())),
        }
    }

    /// Reads three numbers, or texts with their units; a `null` component has no value.
    ///
    /// # Errors
    /// When it is not a list of three, or a component has another type or dimension or is out of
    /// range.
    pub fn read_components(&self, json: &Json) -> Result<[Option<f64>; 3], Refusal> {
        let refuse = |problem: String| Refusal { problem, allowed: self.allowed() };
        let (KeyKind::Vector(quantity), Json::List(items)) = (self.kind, json) else {
            return Err(refuse(format!("is {}, not a list of three", json.kind())));
        };
        let mut components = [None; 3];
        if items.len() != 3 {
            return Err(refuse(format!("has {} components instead of three", items.len())));
        }
        for (component, item) in components.iter_mut().zip(items) {
            if *item != Json::Null {
                *component = quantity.number(&quantity.read(item).map_err(refuse)?);
            }
        }
        Ok(components)
    }

    /// Reads three numbers, or texts with their units.
    ///
    /// # Errors
    /// As [`Self::read_components`], and when a component is `null`.
    pub fn read_vector(&self, json: &Json) -> Result<[f64; 3], Refusal> {
        let [Some(x), Some(y), Some(z)] = self.read_components(json)? else {
            let problem = "has a component that is null".to_owned();
            return Err(Refusal { problem, allowed: self.allowed() });
        };
        Ok([x, y, z])
    }
}

fn names(words: &'static [Word]) -> impl Iterator<Item = &'static str> {
    words.iter().map(|word| word.name)
}

impl Quantity {
    /// Reads a number in SI, a text with a unit, or a word.
    pub(crate) fn read(&self, json: &Json) -> Result<Value, String> {
        let number = match json {
            Json::Integer(number) => *number as f64,
            Json::Number(number) => *number,
            Json::Text(text) => {
                if self.words.iter().any(|(word, _)| word == text) {
                    return Ok(Value::Text(text.clone()));
                }
                units::parse_powers(text, self.dimension.powers())?
            }
            other => {
                return Err(format!("is {}, not {}", other.kind(), self.dimension.name()));
            }
        };
        self.check(number)?;
        // −0 and 0 are the same input.
        Ok(Value::Number(if number == 0.0 { 0.0 } else { number }))
    }

    fn check(&self, number: f64) -> Result<(), String> {
        let high_enough = if self.above { number > self.min } else { number >= self.min };
        if high_enough && number <= self.max { Ok(()) } else { Err("is out of range".to_owned()) }
    }

    /// The number a value stands for: the value itself, or the number of its word.
    pub fn number(&self, value: &Value) -> Option<f64> {
        match value {
            Value::Number(number) => Some(*number),
            Value::Integer(number) => Some(*number as f64),
            Value::Text(text) => {
                self.words.iter().find(|(word, _)| word == text).map(|(_, number)| *number)
            }
            Value::Null | Value::Bool(_) => None,
        }
    }
}

/// Reads a whole number from `min` to `max`.
fn integer(json: &Json, min: i64, max: i64) -> Result<Value, String> {
    match (json.whole(), json) {
        (Some(number), _) if (min..=max).contains(&number) => Ok(Value::Integer(number)),
        (Some(_), _) => Err("is out of range".to_owned()),
        (None, Json::Number(_)) => Err("is not a whole number".to_owned()),
        (None, Json::Text(text)) if text.trim().parse::<f64>().is_ok() => {
            Err("is a text; write the number without quotes".to_owned())
        }
        (None, other) => Err(format!("is {}, not a whole number", other.kind())),
    }
}
