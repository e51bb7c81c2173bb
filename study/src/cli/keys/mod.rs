//! `billow keys`: the keys of a study or scene file, with unit, default, range and meaning.

use std::io::{self, Write};

use super::options::OutputOptions;
use super::print::print_rows;
use super::{Format, output_error};
use crate::input::keys::listing::{Entry, FileKind, REQUIRED, reference_page};
use crate::input::value::Value;
use crate::platform::error::Result;

mod search;

/// Arguments of `billow keys`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Print only keys with this word in their name; without one, those with it in their meaning, and
    /// columns of the table.
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

/// Width of a line of meaning, characters.
const LINE_WIDTH: usize = 96;

/// Runs `billow keys`.
///
/// # Errors
/// When no key and no column has the word, or the output cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    if args.markdown {
        return write!(out, "{}", reference_page()).map_err(output_error);
    }
    let file = if args.scene { FileKind::Scene } else { FileKind::Study };
    let found = search::search(file, args.word.as_deref())?;
    for note in &found.notes {
        eprintln!("billow: {note}");
    }
    match args.output.format() {
        Format::Table => print(&found.entries, out).map_err(output_error),
        format => {
            let rows: Vec<Vec<Value>> =
                found.entries.iter().map(|(kind, entry)| row(kind, entry)).collect();
            let columns = ["file", "key", "unit", "default", "allowed", "meaning"];
            print_rows(&columns, &rows, format, out)
        }
    }
}

fn row(kind: &str, entry: &Entry) -> Vec<Value> {
    [kind, &entry.path, entry.unit, &entry.default, &entry.allowed, &entry.meaning]
        .map(|text| Value::Text(text.to_owned()))
        .into()
}

/// Prints each key on a few lines: path, then unit, default and range, then meaning.
fn print(entries: &[(&str, Entry)], out: &mut dyn Write) -> io::Result<()> {
    for (kind, entry) in entries {
        match *kind {
            search::COLUMN => writeln!(out, "{} ({kind})", entry.path)?,
            _ => writeln!(out, "{}", entry.path)?,
        }
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
