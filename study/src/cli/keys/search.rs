//! The keys and columns that a word finds.

use crate::accuracy::{PROMISED, Promised};
use crate::input::keys::listing::{Entry, FileKind, entries};
use crate::input::renamed::RENAMED_KEYS;
use crate::job::row::{COLUMNS, RENAMED_TABLE_COLUMNS, RowColumn};
use crate::platform::error::{InputError, Result};
use crate::platform::nearest::nearest;
use crate::platform::quote;

/// Kind of an entry that is a column of the table and no key.
pub(super) const COLUMN: &str = "column of the table";

/// Names printed when a word is not found (chosen: one line).
const MAX_NEAREST: usize = 3;
/// Keys named in the note about further meanings, at most (chosen: two lines).
const MAX_FURTHER: usize = 6;

/// What a word finds.
pub(super) struct Found {
    /// Kind and key.
    pub entries: Vec<(&'static str, Entry)>,
    /// What the reader should know beside it.
    pub notes: Vec<String>,
}

/// The keys with this name; else those with the word in their name, or in that of a column; else those
/// with it in their meaning. Every key without a word.
pub(super) fn search(file: FileKind, word: Option<&str>) -> Result<Found> {
    let all = entries(file);
    let keys =
        |entries: Vec<Entry>| entries.into_iter().map(|entry| (file.name(), entry)).collect();
    let Some(word) = word else { return Ok(Found { entries: keys(all), notes: Vec::new() }) };
    let lower = word.trim().to_lowercase();
    let mut notes = Vec::new();
    // Another case of one letter is another key: N panels, n subdivisions.
    let exact = |entry: &Entry| entry.path == word || leaf(&entry.path) == word;
    let exact_any_case = |entry: &Entry| leaf(&entry.path).to_lowercase() == lower;
    let in_name = |entry: &Entry| {
        let path = entry.path.to_lowercase();
        // A word of one or two letters is in nearly every name.
        if lower.chars().count() < 3 {
            words(&path).any(|part| part == lower)
        } else {
            path.contains(&lower)
        }
    };
    let tests: [&dyn Fn(&Entry) -> bool; 3] = [&exact, &exact_any_case, &in_name];
    for test in tests {
        let (found, others): (Vec<Entry>, Vec<Entry>) = all.iter().cloned().partition(test);
        if !found.is_empty() {
            notes.extend(further(&others, &lower));
            return Ok(Found { entries: keys(found), notes });
        }
    }
    let mut columns: Vec<_> =
        columns(&lower).map(|column| (COLUMN, column_entry(column))).collect();
    if columns.is_empty() {
        columns.extend(error_columns(&lower).map(|entry| (COLUMN, entry)));
    }
    if !columns.is_empty() {
        let names: Vec<&str> = columns.iter().map(|(_, entry)| entry.path.as_str()).collect();
        let one = "is a column of the table, not a key";
        let are = if names.len() == 1 { one } else { "are columns of the table, not keys" };
        notes.push(format!("{} {are}: billow table --columns {}", names.join(", "), names[0]));
        return Ok(Found { entries: columns, notes });
    }
    let renamed: Vec<(String, String)> = RENAMED_KEYS
        .iter()
        .filter(|(old, _)| leaf(old).to_lowercase().contains(&lower))
        .map(|(old, new)| (old.replace('*', "<name>"), new.replace('*', "<name>")))
        .collect();
    let current: Vec<Entry> = all
        .iter()
        .filter(|entry| renamed.iter().any(|(_, new)| *new == entry.path))
        .cloned()
        .collect();
    if !current.is_empty() {
        notes.extend(
            renamed.iter().filter(|(_, new)| all.iter().any(|entry| entry.path == *new)).map(
                |(old, new)| {
                    format!("{old} is now called {new}; the next version refuses the old name")
                },
            ),
        );
        return Ok(Found { entries: keys(current), notes });
    }
    let meant: Vec<Entry> =
        all.iter().filter(|entry| means(&entry.meaning, &lower)).cloned().collect();
    if meant.is_empty() {
        return Err(not_found(file, word, &all).into());
    }
    Ok(Found { entries: keys(meant), notes })
}

/// The last part of a path.
fn leaf(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or_default()
}

/// The words of a text.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty())
}

/// Whether a meaning has a word: a short one as a whole word.
fn means(meaning: &str, lower: &str) -> bool {
    let meaning = meaning.to_lowercase();
    let short = lower.chars().count() < 3;
    if short { words(&meaning).any(|word| word == lower) } else { meaning.contains(lower) }
}

/// The note about keys with the word in their meaning alone.
fn further(others: &[Entry], lower: &str) -> Option<String> {
    let further = others.iter().filter(|entry| means(&entry.meaning, lower));
    let names: Vec<&str> = further.map(|entry| entry.path.as_str()).collect();
    let more = if names.len() > MAX_FURTHER { ", …" } else { "" };
    let shown = names[..names.len().min(MAX_FURTHER)].join(", ");
    (!names.is_empty()).then(|| format!("also in the meaning of {shown}{more}"))
}

/// The columns of the table with a word in their name, also by an old name; exact names first.
fn columns(lower: &str) -> impl Iterator<Item = &'static RowColumn> {
    let old = RENAMED_TABLE_COLUMNS.iter().find(|(old, _)| *old == lower);
    let name = old.map_or(lower, |(_, current)| current).to_owned();
    let exact = COLUMNS.iter().any(|column| column.name == name);
    COLUMNS.iter().filter(move |column| {
        if exact {
            column.name == name
        } else {
            name.chars().count() >= 3 && column.name.contains(&name)
        }
    })
}

/// The columns of mesh errors with a word in their name.
fn error_columns(lower: &str) -> impl Iterator<Item = Entry> {
    let long = lower.chars().count() >= 3;
    let has = move |promised: &&Promised| long && promised.error_column.contains(lower);
    PROMISED.iter().filter(has).map(|promised| Entry {
        path: promised.error_column.to_owned(),
        unit: promised.measure.column().unit,
        default: String::new(),
        allowed: String::new(),
        meaning: promised.meaning(),
    })
}

fn column_entry(column: &RowColumn) -> Entry {
    Entry {
        path: column.name.to_owned(),
        unit: column.unit,
        default: String::new(),
        allowed: String::new(),
        meaning: column.meaning.to_owned(),
    }
}

/// The error of a word that no key and no column has, with the nearest names of both.
fn not_found(file: FileKind, word: &str, known: &[Entry]) -> InputError {
    let mut names: Vec<&str> = known.iter().map(|entry| leaf(&entry.path)).collect();
    names.extend(COLUMNS.iter().map(|column| column.name));
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
        |entry: &Entry| entry.path.to_lowercase().contains(&lower) || means(&entry.meaning, &lower);
    let hint = if near.is_empty() && entries(other).iter().any(has) {
        format!("the {} file has such a key: {command}", other.name())
    } else if near.is_empty() {
        "billow keys prints every key".to_owned()
    } else {
        format!("nearest: {}", near.join(", "))
    };
    InputError {
        file: "billow keys".to_owned(),
        key: String::new(),
        value: String::new(),
        problem: format!(
            "no key of a {} file has \"{shown}\" in its name or meaning, and no column of the table in \
             its name",
            file.name()
        ),
        allowed: "a part of a name or of a meaning, as in billow keys thickness".to_owned(),
        hint,
    }
}
