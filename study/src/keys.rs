//! The keys of a study file: the one table behind reading, errors, defaults, `billow schema` and
//! the names an expression knows.

mod table;

use std::collections::HashMap;
use std::fmt::Write as _;
use std::sync::LazyLock;

use crate::study_file::Json;
use crate::units::{self, Dimension};
use crate::value::{Value, short_number};

pub use table::{KEYS, SECTIONS, STRATEGY_KEYS, WINDOW_KEYS};

/// One key that holds one value.
#[derive(Debug)]
pub struct Key {
    /// Dotted path, as in `film.thickness`.
    pub path: &'static str,
    /// What it may hold.
    pub kind: Kind,
    /// What it is when the file does not say.
    pub default: Default,
    /// Meaning, one line.
    pub doc: &'static str,
    /// A value as a user would write it, JSON.
    pub example: &'static str,
}

/// What a key may hold.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// A number in SI, or a text with a unit.
    Quantity(Quantity),
    /// A whole number, both ends allowed.
    Integer(i64, i64),
    /// One of these words.
    Choice(&'static [&'static str]),
    /// Any text.
    Text,
}

/// The numbers a quantity may take.
#[derive(Debug, Clone, Copy)]
pub struct Quantity {
    /// Dimension.
    pub dimension: Dimension,
    /// Least, SI.
    pub min: f64,
    /// Whether `min` itself is refused.
    pub above: bool,
    /// Most, SI.
    pub max: f64,
    /// Words that stand for a number.
    pub words: &'static [(&'static str, f64)],
}

/// What a key is when the file does not say.
#[derive(Debug, Clone, Copy)]
pub enum Default {
    /// This number, SI.
    Number(f64),
    /// This whole number.
    Integer(i64),
    /// This word.
    Word(&'static str),
    /// Nothing, which means what the text says.
    Absent(&'static str),
    /// It must be given, in its place or on the grid.
    Required,
}

/// Why a value is not one a key may hold.
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

    /// Whether a grid may vary it: all but what names the study.
    pub fn varies(&self) -> bool {
        !matches!(self.path, "format" | "version" | "name" | "question")
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

    /// What the key allows, in words.
    pub fn allowed(&self) -> String {
        match self.kind {
            Kind::Quantity(quantity) => quantity.allowed(),
            Kind::Integer(min, max) => format!("a whole number, {min} to {max}"),
            Kind::Choice(words) => words.join(", "),
            Kind::Text => "a text".to_owned(),
        }
    }

    /// Reads a value: units to SI, 8.0 as the whole number 8 and 8 as the number 8.0, −0 as 0.
    ///
    /// # Errors
    /// When it is of another type or dimension, or out of range.
    pub fn read(&self, json: &Json) -> Result<Value, Refusal> {
        let refuse = |problem: String| Err(Refusal { problem, allowed: self.allowed() });
        match (self.kind, json) {
            (Kind::Quantity(quantity), _) => match quantity.read(json) {
                Ok(value) => Ok(value),
                Err(problem) => refuse(problem),
            },
            (Kind::Integer(min, max), _) => {
                let number = match json {
                    Json::Integer(number) => Some(*number),
                    Json::Number(number) => whole(*number),
                    Json::Text(text) if text.trim().parse::<f64>().is_ok() => {
                        return refuse("is a text; write the number without quotes".to_owned());
                    }
                    other => return refuse(format!("is {}, not a whole number", other.kind())),
                };
                match number {
                    Some(number) if (min..=max).contains(&number) => Ok(Value::Integer(number)),
                    Some(_) => refuse("is out of range".to_owned()),
                    None => refuse("is not a whole number".to_owned()),
                }
            }
            (Kind::Choice(words), Json::Text(text)) => {
                if words.contains(&text.as_str()) {
                    return Ok(Value::Text(text.clone()));
                }
                if self.path == "design.caps" && text == "circular" {
                    return refuse(
                        "circular caps belong to the erected shape: a disc cannot be sewn to a \
                         flat-folded N-gon without strain"
                            .to_owned(),
                    );
                }
                let near = nearest(text, words.iter().copied());
                refuse(near.map_or_else(
                    || "is none of the words it may be".to_owned(),
                    |near| format!("is none of the words it may be; did you mean {near:?}?"),
                ))
            }
            (Kind::Text, Json::Text(text)) => Ok(Value::Text(text.clone())),
            (_, other) => refuse(format!("is {}, not a text", other.kind())),
        }
    }
}

impl Quantity {
    fn allowed(&self) -> String {
        let mut text = self.dimension.name().to_owned();
        let unit = if self.dimension == Dimension::Number { "" } else { self.dimension.si() };
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        let from = if self.above { "above " } else { "from " };
        let _ =
            write!(text, " {from}{} to {}{unit}", short_number(self.min), short_number(self.max));
        if self.dimension != Dimension::Number {
            let _ = write!(
                text,
                ", as a number in {} or a text with a unit ({})",
                self.dimension.si(),
                self.dimension.units().join(", ")
            );
        }
        for (word, _) in self.words {
            let _ = write!(text, ", or {word:?}");
        }
        text
    }

    fn read(&self, json: &Json) -> Result<Value, String> {
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

    /// The number a value stands for: itself, or that of its word.
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

/// A float that is a whole number within ±2^53.
#[expect(clippy::cast_possible_truncation, reason = "checked to be whole and small")]
pub(crate) fn whole(number: f64) -> Option<i64> {
    (number.fract() == 0.0 && number.abs() <= 9_007_199_254_740_992.0).then_some(number as i64)
}

static INDEX: LazyLock<HashMap<&'static str, usize>> =
    LazyLock::new(|| KEYS.iter().enumerate().map(|(at, key)| (key.path, at)).collect());

/// Leaf names that only one key has; a key of the top level owns its name.
static LEAVES: LazyLock<HashMap<&'static str, usize>> = LazyLock::new(|| {
    let mut leaves: HashMap<&'static str, Vec<usize>> = HashMap::new();
    for (at, key) in KEYS.iter().enumerate() {
        leaves.entry(key.leaf()).or_default().push(at);
    }
    leaves.into_iter().filter(|(_, at)| at.len() == 1).map(|(leaf, at)| (leaf, at[0])).collect()
});

/// Position in [`KEYS`] of a dotted path.
pub fn index(path: &str) -> Option<usize> {
    INDEX.get(path).copied()
}

/// Position in [`KEYS`] of a dotted path or a leaf name only one key has.
pub fn find(name: &str) -> Option<usize> {
    index(name).or_else(|| LEAVES.get(name).copied())
}

/// The shortest name that [`find`] finds the key by.
pub fn short_name(at: usize) -> &'static str {
    let key = &KEYS[at];
    if LEAVES.get(key.leaf()) == Some(&at) { key.leaf() } else { key.path }
}

/// The known name nearest to a mistyped one, if any is near.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    if name.len() > 64 {
        return None;
    }
    let name = name.to_lowercase();
    let furthest = 1 + name.chars().count() / 4;
    known
        .map(|known| (distance(&name, &known.to_lowercase()), known))
        .filter(|(distance, _)| *distance <= furthest)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, known)| known)
}

/// Edits (insert, delete, replace) from one word to another.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, c) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, d) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(c != *d);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests;
