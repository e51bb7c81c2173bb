//! `billow keys`: the keys of a study or scene file, with unit, default, range and meaning.

use std::io::Write;

use serde::Serialize;
use serde_json::Serializer;
use serde_json::ser::PrettyFormatter;

use super::options::OutputOptions;
use super::{Format, output_error};
use crate::accuracy::{NO_ERROR_REASON, NO_ERROR_REASON_MEANING, PROMISED, is_error_column};
use crate::input::keys::listing::{FileKind, KeyDescription, REQUIRED, entries};
use crate::input::schema;
use crate::input::value::Value;
use crate::job::row::{COLUMNS, DERIVED_COLUMNS};
use crate::platform::error::{InputError, Result};
use crate::platform::nearest::nearest;
use crate::platform::quote;
use crate::print::print_rows;

/// Arguments of `billow keys`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Print only keys with this word in their name; without one, columns of the table with it in their
    /// name, or keys with it in their meaning.
    pub word: Option<String>,
    /// Print the keys of a scene file.
    #[arg(long)]
    pub scene: bool,
    /// Print the JSON Schema of a study file or of a scene file, for editors.
    #[arg(
        long,
        value_name = "FILE",
        num_args = 0..=1,
        default_missing_value = "study",
        conflicts_with_all = ["word", "scene"]
    )]
    pub schema: Option<SchemaOf>,
    #[command(flatten)]
    output: OutputOptions,
}

/// A file with a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum SchemaOf {
    /// The study file of `billow run`.
    Study,
    /// The scene file of `billow solve`.
    Scene,
}

/// Kind of an entry that is a column of the table and no key.
const COLUMN: &str = "column of the table";
/// Width of a line of meaning, characters.
const LINE_WIDTH: usize = 96;
/// Names printed when a word is not found (chosen: one line).
const MAX_NEAREST: usize = 3;
/// Letters of a word that is searched within other words, at least: a shorter one is in nearly every name.
const MIN_PART: usize = 3;

/// Runs `billow keys`.
///
/// # Errors
/// When no key and no column has the word, or the output cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let file = match args.schema {
        Some(of) => return print_schema(of, out),
        None if args.scene => FileKind::Scene,
        None => FileKind::Study,
    };
    let found = match &args.word {
        Some(word) => search(file, word)?,
        None => entries(file).into_iter().map(|entry| (file.name(), entry)).collect(),
    };
    let format = args.output.format();
    if format == Format::Table {
        let text: String = found.iter().map(|(kind, entry)| described(kind, entry)).collect();
        return write!(out, "{text}").map_err(output_error);
    }
    let row = |(kind, entry): &(&str, KeyDescription)| {
        [kind, &*entry.path, entry.unit, &entry.default, &entry.allowed, &entry.meaning]
            .map(|text| Value::Text(text.to_owned()))
            .to_vec()
    };
    let rows: Vec<Vec<Value>> = found.iter().map(row).collect();
    print_rows(&["file", "key", "unit", "default", "allowed", "meaning"], &rows, format, out)
}

fn print_schema(of: SchemaOf, out: &mut dyn Write) -> Result<()> {
    let schema = match of {
        SchemaOf::Study => schema::study_schema(),
        SchemaOf::Scene => schema::scene_schema(),
    };
    // One space for each level keeps it readable and small.
    let formatter = PrettyFormatter::with_indent(b" ");
    let mut serializer = Serializer::with_formatter(&mut *out, formatter);
    let written = schema.serialize(&mut serializer).map_err(std::io::Error::from);
    written.and_then(|()| writeln!(out)).map_err(output_error)
}

/// A key on a few lines: path, then unit, default and range, then meaning.
fn described(kind: &str, entry: &KeyDescription) -> String {
    let mut lines = vec![match kind {
        COLUMN => format!("{} ({kind})", entry.path),
        _ => entry.path.clone(),
    }];
    let before_default = if entry.default == REQUIRED { "" } else { "default " };
    let facts =
        [("unit ", entry.unit), (before_default, &entry.default), ("allowed ", &entry.allowed)];
    let facts = facts.iter().filter(|(_, text)| !text.is_empty());
    let facts: Vec<String> = facts.map(|(name, text)| format!("{name}{text}")).collect();
    if !facts.is_empty() {
        lines.push(facts.join("; "));
    }
    let mut words = entry.meaning.split_whitespace().peekable();
    while let Some(first) = words.next() {
        let mut line = first.to_owned();
        let fits =
            |line: &str, word: &str| line.chars().count() + 1 + word.chars().count() <= LINE_WIDTH;
        while let Some(word) = words.next_if(|word| fits(&line, word)) {
            line.extend([" ", word]);
        }
        lines.push(line);
    }
    lines.join("\n    ") + "\n"
}

/// Whether an entry is found.
type Test<'a> = &'a dyn Fn(&KeyDescription) -> bool;

/// The keys with this name, else those with the word in their name, else the columns of the table with it in theirs
/// (measures before their errors), else the keys with it in their meaning, else the columns.
fn search(file: FileKind, word: &str) -> Result<Vec<(&'static str, KeyDescription)>> {
    let lower = word.trim().to_lowercase();
    let (keys, columns) = (entries(file), columns());
    // Another case of one letter is another key: N panels, n subdivisions.
    let tests: [(&'static str, &[KeyDescription], Test<'_>); 8] = [
        (file.name(), &keys, &|entry| entry.path == word || leaf(&entry.path) == word),
        (file.name(), &keys, &|entry| leaf(&entry.path).to_lowercase() == lower),
        (file.name(), &keys, &|entry| has_word(&entry.path, &lower)),
        (COLUMN, &columns, &|entry| entry.path == lower),
        (COLUMN, &columns, &|entry| !is_error_column(&entry.path) && has_word(&entry.path, &lower)),
        (COLUMN, &columns, &|entry| has_word(&entry.path, &lower)),
        (file.name(), &keys, &|entry| has_word(&entry.meaning, &lower)),
        (COLUMN, &columns, &|entry| has_word(&entry.meaning, &lower)),
    ];
    for (kind, all, test) in tests {
        let found: Vec<_> = all.iter().filter(|entry| test(entry)).cloned().collect();
        if !found.is_empty() {
            return Ok(found.into_iter().map(|entry| (kind, entry)).collect());
        }
    }
    Err(not_found(file, word, &keys, &columns).into())
}

/// The last part of a path.
fn leaf(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or_default()
}

/// Whether a text has a word: a short one as a whole word.
fn has_word(text: &str, lower: &str) -> bool {
    let text = text.to_lowercase();
    if lower.chars().count() < MIN_PART {
        text.split(|c: char| !c.is_alphanumeric()).any(|word| word == lower)
    } else {
        text.contains(lower)
    }
}

/// The columns of the table, also those of errors and those that follow from limits.
fn columns() -> Vec<KeyDescription> {
    let entry = |path: &str, unit, meaning| KeyDescription {
        path: path.to_owned(),
        unit,
        default: String::new(),
        allowed: String::new(),
        meaning,
    };
    let of_row =
        COLUMNS.iter().map(|column| entry(column.name, column.unit, column.meaning.to_owned()));
    let of_errors = PROMISED.iter().flat_map(|promised| {
        let unit = promised.measure.column().unit;
        promised.columns().map(|(name, meaning)| entry(name, unit, meaning))
    });
    let derived = DERIVED_COLUMNS
        .iter()
        .map(|column| entry(column.name, column.unit, column.meaning.to_owned()));
    let reason = entry(NO_ERROR_REASON, "", NO_ERROR_REASON_MEANING.to_owned());
    of_row.chain(of_errors).chain(derived).chain([reason]).collect()
}

/// The error of a word that no key and no column has, with the nearest names of both.
fn not_found(
    file: FileKind,
    word: &str,
    keys: &[KeyDescription],
    columns: &[KeyDescription],
) -> InputError {
    let mut names: Vec<&str> = keys.iter().chain(columns).map(|entry| leaf(&entry.path)).collect();
    let mut near: Vec<&str> = Vec::new();
    while near.len() < MAX_NEAREST
        && let Some(name) = nearest(word, names.iter().copied())
    {
        names.retain(|known| *known != name);
        near.push(name);
    }
    let shown = quote::echo(word);
    let (other, command) = match file {
        FileKind::Study => (FileKind::Scene, format!("billow keys --scene {shown}")),
        FileKind::Scene => (FileKind::Study, format!("billow keys {shown}")),
    };
    let lower = word.to_lowercase();
    let has =
        |entry: &KeyDescription| has_word(&entry.path, &lower) || has_word(&entry.meaning, &lower);
    let hint = if entries(other).iter().any(has) {
        format!("the {} file has such a key: {command}", other.name())
    } else if !near.is_empty() {
        format!("nearest: {}", near.join(", "))
    } else {
        "billow keys prints every key".to_owned()
    };
    InputError {
        file: "billow keys".to_owned(),
        key: String::new(),
        value: String::new(),
        problem: format!(
            "no key of a {} file and no column of the table has \"{shown}\" in its name or meaning",
            file.name()
        ),
        allowed: "a part of a name or of a meaning, as in billow keys thickness".to_owned(),
        hint,
    }
}
