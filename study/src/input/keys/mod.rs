//! The keys of a study file and of a scene file: the tables behind reading, errors, defaults,
//! `billow schema` and the names an expression knows.

mod nearest;
mod scene;
mod table;

use std::collections::HashMap;
use std::fmt::Write as _;
use std::sync::LazyLock;

use crate::input::study_file::Json;
use crate::input::units::{self, Dimension};
use crate::input::value::{Value, short_number};

pub use nearest::nearest;
pub use scene::{
    BODY_KEYS, MESH_KEYS, MOVE_KEYS, OUTPUT_KEYS, PLATE_KEYS, ROTATION_KEYS, SCENE,
    SCENE_WINDOW_KEYS, SPIN_KEYS, START_KEYS, SUPPORT_KEYS,
};
pub(crate) use scene::{FLAT, GRAVITY, NEAR};
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
    /// True or false.
    Flag,
    /// Three such quantities, x, y, z: [`Key::read_vector`].
    Vector(Quantity),
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
            Kind::Flag => "true or false".to_owned(),
            Kind::Vector(quantity) => format!("a list of three: {}", quantity.allowed()),
        }
    }

    /// The key as a file would have it, as in `"thickness": "25.4 um"`.
    pub fn sample(&self) -> String {
        format!("\"{}\": {}", self.leaf(), self.example)
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
            (Kind::Flag, Json::Bool(flag)) => Ok(Value::Bool(*flag)),
            (Kind::Flag, other) => refuse(format!("is {}, not true or false", other.kind())),
            (_, other) => refuse(format!("is {}, not a text", other.kind())),
        }
    }
}

impl Key {
    /// Reads three numbers, or texts with their units; a part that is `null` is none.
    ///
    /// # Errors
    /// When it is no list of three, or one of them is of another type or dimension or out of range.
    pub fn read_parts(&self, json: &Json) -> Result<[Option<f64>; 3], Refusal> {
        let refuse = |problem: String| Refusal { problem, allowed: self.allowed() };
        let (Kind::Vector(quantity), Json::List(items)) = (self.kind, json) else {
            return Err(refuse(format!("is {}, not a list of three", json.kind())));
        };
        let mut parts = [None; 3];
        if items.len() != 3 {
            return Err(refuse(format!("has {} of three parts", items.len())));
        }
        for (part, item) in parts.iter_mut().zip(items) {
            if *item != Json::Null {
                *part = quantity.number(&quantity.read(item).map_err(refuse)?);
            }
        }
        Ok(parts)
    }

    /// Reads three numbers, or texts with their units.
    ///
    /// # Errors
    /// As [`Self::read_parts`], and a part that is `null`.
    pub fn read_vector(&self, json: &Json) -> Result<[f64; 3], Refusal> {
        let [Some(x), Some(y), Some(z)] = self.read_parts(json)? else {
            let problem = "has a part that is null".to_owned();
            return Err(Refusal { problem, allowed: self.allowed() });
        };
        Ok([x, y, z])
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

/// The keys of one kind of file that hold one value, with what finds them.
#[derive(Debug)]
pub struct Table {
    /// What the file is, with its article.
    pub what: &'static str,
    /// The keys, in the order of the documentation.
    pub keys: Vec<&'static Key>,
    /// Its objects and what they are about.
    pub sections: &'static [(&'static str, &'static str)],
    /// Paths of the keys that hold more than one value, beside the sections.
    pub structured: &'static [&'static str],
    index: HashMap<&'static str, usize>,
    /// Leaf names that only one key has; a key of the top level owns its name.
    leaves: HashMap<&'static str, usize>,
}

impl Table {
    fn new(
        what: &'static str,
        keys: Vec<&'static Key>,
        sections: &'static [(&'static str, &'static str)],
        structured: &'static [&'static str],
    ) -> Self {
        let index = keys.iter().enumerate().map(|(at, key)| (key.path, at)).collect();
        let mut leaves: HashMap<&'static str, Vec<usize>> = HashMap::new();
        for (at, key) in keys.iter().enumerate() {
            leaves.entry(key.leaf()).or_default().push(at);
        }
        let leaves = leaves.into_iter().filter(|(_, at)| at.len() == 1);
        let leaves = leaves.map(|(leaf, at)| (leaf, at[0])).collect();
        Self { what, keys, sections, structured, index, leaves }
    }

    /// Position of a dotted path.
    pub fn index(&self, path: &str) -> Option<usize> {
        self.index.get(path).copied()
    }

    /// Position of a dotted path or a leaf name only one key has.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.index(name).or_else(|| self.leaves.get(name).copied())
    }

    /// The shortest name that [`Self::find`] finds the key by.
    pub fn short_name(&self, at: usize) -> &'static str {
        let key = self.keys[at];
        if self.leaves.get(key.leaf()) == Some(&at) { key.leaf() } else { key.path }
    }

    /// Whether a path is that of an object.
    pub fn is_section(&self, path: &str) -> bool {
        self.sections.iter().any(|(section, _)| *section == path)
    }

    /// Names of the keys and sections right below a path.
    pub fn children(&self, prefix: &str) -> Vec<&'static str> {
        let mut names: Vec<&'static str> = Vec::new();
        let sections = self.sections.iter().map(|(path, _)| *path);
        let keys = self.keys.iter().map(|key| key.path);
        for path in sections.chain(keys).chain(self.structured.iter().copied()) {
            let rest = match prefix {
                "" => Some(path),
                _ => path.strip_prefix(prefix).and_then(|rest| rest.strip_prefix('.')),
            };
            let Some(name) = rest.and_then(|rest| rest.split('.').next()) else { continue };
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }
}

/// The keys of a study file, those of [`KEYS`] in their order.
pub static STUDY: LazyLock<Table> = LazyLock::new(|| {
    let structured = &["supports", "strategies", "grid"];
    Table::new("a study", KEYS.iter().collect(), SECTIONS, structured)
});

/// Position in [`KEYS`] of a dotted path.
pub fn index(path: &str) -> Option<usize> {
    STUDY.index(path)
}

/// Position in [`KEYS`] of a dotted path or a leaf name only one key has.
pub fn find(name: &str) -> Option<usize> {
    STUDY.find(name)
}

/// The shortest name that [`find`] finds the key by.
pub fn short_name(at: usize) -> &'static str {
    STUDY.short_name(at)
}

#[cfg(test)]
mod tests;
