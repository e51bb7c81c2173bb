//! `billow keys`: the keys of a study or scene file, with unit, default, range and meaning.

use std::io::{self, Write};

use super::options::OutputOptions;
use super::print::print_rows;
use super::{Format, output_error};
use crate::input::keys::listing::{Entry, FileKind, REQUIRED, entries, reference_page};
use crate::input::keys::nearest;
use crate::input::value::Value;
use crate::platform::error::{InputError, Result};

/// Arguments of `billow keys`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Print only keys with this word in their name or meaning.
    pub word: Option<String>,
    /// Print the keys of a scene file.
    #[arg(long)]
    pub scene: bool,
    /// Print the reference page of all keys, in Markdown.
    #[arg(long, hide = true, conflicts_with_all = ["word", "scene"])]
    pub markdown: bool,
    #[command(flatten)]
    output: OutputOptions,
}

/// Names printed when a word is not found (chosen: one line).
const MAX_NEAREST: usize = 3;

/// Width of a line of meaning, characters.
const LINE_WIDTH: usize = 96;

/// Runs `billow keys`.
///
/// # Errors
/// When no key has the word, or the output cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    if args.markdown {
        return write!(out, "{}", reference_page()).map_err(output_error);
    }
    let file = if args.scene { FileKind::Scene } else { FileKind::Study };
    let found = search(file, args.word.as_deref())?;
    match args.output.format() {
        Format::Table => print(&found, out).map_err(output_error),
        format => {
            let rows: Vec<Vec<Value>> = found.iter().map(|entry| row(file, entry)).collect();
            let columns = ["file", "key", "unit", "default", "allowed", "meaning"];
            print_rows(&columns, &rows, format, out)
        }
    }
}

/// The keys with a word in their name or meaning; every key without a word.
fn search(file: FileKind, word: Option<&str>) -> Result<Vec<Entry>> {
    let all = entries(file);
    let Some(word) = word else { return Ok(all) };
    let (found, others): (Vec<Entry>, Vec<Entry>) =
        all.into_iter().partition(|entry| has(entry, word));
    if found.is_empty() { Err(not_found(file, word, &others).into()) } else { Ok(found) }
}

/// Whether a key has a word in its name or meaning, in upper or lower case.
fn has(entry: &Entry, word: &str) -> bool {
    let word = word.to_lowercase();
    entry.path.to_lowercase().contains(&word) || entry.meaning.to_lowercase().contains(&word)
}

/// The error of a word that no key has, with the nearest names.
fn not_found(file: FileKind, word: &str, known: &[Entry]) -> InputError {
    let last = |path: &str| path.rsplit('.').next().unwrap_or_default().to_owned();
    let mut names: Vec<String> = known.iter().map(|entry| last(&entry.path)).collect();
    let mut near: Vec<String> = Vec::new();
    while near.len() < MAX_NEAREST
        && let Some(name) = nearest(word, names.iter().map(String::as_str)).map(str::to_owned)
    {
        names.retain(|known| *known != name);
        near.push(name);
    }
    let (other, command) = match file {
        FileKind::Study => (FileKind::Scene, format!("billow keys --scene {word}")),
        FileKind::Scene => (FileKind::Study, format!("billow keys {word}")),
    };
    let hint = if near.is_empty() && entries(other).iter().any(|entry| has(entry, word)) {
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
        problem: format!("no key of a {} file has {word:?} in its name or meaning", file.name()),
        allowed: "a part of a name or of a meaning, as in billow keys thickness".to_owned(),
        hint,
    }
}

fn row(file: FileKind, entry: &Entry) -> Vec<Value> {
    [file.name(), &entry.path, entry.unit, &entry.default, &entry.allowed, &entry.meaning]
        .map(|text| Value::Text(text.to_owned()))
        .into()
}

/// Prints each key on a few lines: path, then unit, default and range, then meaning.
fn print(entries: &[Entry], out: &mut dyn Write) -> io::Result<()> {
    for entry in entries {
        writeln!(out, "{}", entry.path)?;
        let default = match entry.default.as_str() {
            REQUIRED => ("", REQUIRED),
            default => ("default ", default),
        };
        let facts = [("unit ", entry.unit), default, ("allowed ", entry.allowed.as_str())];
        let facts = facts.iter().filter(|(_, text)| !text.is_empty());
        let facts: Vec<String> = facts.map(|(name, text)| format!("{name}{text}")).collect();
        if !facts.is_empty() {
            writeln!(out, "    {}", facts.join("; "))?;
        }
        for line in wrapped(&entry.meaning) {
            writeln!(out, "    {line}")?;
        }
    }
    Ok(())
}

/// A text in lines of at most [`LINE_WIDTH`] characters.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= LINE_WIDTH => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
