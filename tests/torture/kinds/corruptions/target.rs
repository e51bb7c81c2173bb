//! What a damage is done to, and the edits that all damages share.

use std::fs;
use std::path::{Path, PathBuf};

use billow_solver::platform::seal;

use super::super::mutations::bytes;
use crate::harness::random::Random;
use crate::harness::{journal, place};

/// What `doctor` must say about a damage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Expect {
    /// It is a fault: exit code 1.
    Fault,
    /// It may be a note, or nothing: the text says why no result depends on it.
    Harmless(&'static str),
    /// The file is of a newer program: it is refused, and not repaired.
    Newer,
}

/// A damage of a finished folder. It returns whether it was possible.
pub struct Damage {
    /// What is damaged, and how.
    pub name: &'static str,
    /// Does it.
    pub apply: fn(&Target, &mut Random) -> Option<()>,
    /// What `doctor` must say.
    pub expect: Expect,
    /// Number of trials.
    pub trials: usize,
}

/// A damage that `doctor` must find, tried once.
pub const fn fault(name: &'static str, apply: fn(&Target, &mut Random) -> Option<()>) -> Damage {
    Damage { name, apply, expect: Expect::Fault, trials: 1 }
}

/// A damage at random places that `doctor` must find.
pub const fn faults(
    name: &'static str,
    trials: usize,
    apply: fn(&Target, &mut Random) -> Option<()>,
) -> Damage {
    Damage { name, apply, expect: Expect::Fault, trials }
}

/// A change on which no result depends.
pub const fn harmless(
    name: &'static str,
    why: &'static str,
    apply: fn(&Target, &mut Random) -> Option<()>,
) -> Damage {
    Damage { name, apply, expect: Expect::Harmless(why), trials: 1 }
}

/// A finished results folder to damage.
pub struct Target {
    /// The folder.
    pub results: PathBuf,
    /// A finished folder of another study.
    pub other: PathBuf,
    /// The job that the readers read: a film job.
    pub job: String,
    /// Another film job.
    pub second: String,
}

impl Target {
    /// History file of a job.
    pub fn history(&self, job: &str) -> PathBuf {
        self.results.join("jobs").join(&job[..2]).join(format!("{job}.h5"))
    }

    /// The first journal of the folder.
    pub fn journal(&self) -> Option<PathBuf> {
        journal::paths(&self.results).into_iter().next()
    }

    /// The static references.
    pub fn references(&self) -> Vec<PathBuf> {
        place::files(&self.results.join("references"))
    }

    /// Changes the lines of the journal. Each ends without its line feed.
    pub fn edit_lines(&self, edit: impl FnOnce(&mut Vec<String>) -> Option<()>) -> Option<()> {
        let path = self.journal()?;
        let text = fs::read_to_string(&path).ok()?;
        let mut lines: Vec<String> = text.lines().map(ToOwned::to_owned).collect();
        edit(&mut lines)?;
        fs::write(path, lines.join("\n") + "\n").ok()
    }

    /// Changes the journal line that records the end of the job.
    pub fn edit_line(&self, edit: impl FnOnce(&str) -> Option<String>) -> Option<()> {
        self.edit_lines(|lines| {
            let at = line_of(lines, &self.job)?;
            lines[at] = edit(&lines[at])?;
            Some(())
        })
    }
}

/// Number of the line that records the end of a job.
pub fn line_of(lines: &[String], job: &str) -> Option<usize> {
    lines.iter().position(|line| journal::ended_job(line).as_deref() == Some(job))
}

/// Changes the bytes of a file.
pub fn edit_file(path: &Path, edit: impl FnOnce(&mut Vec<u8>) -> Option<()>) -> Option<()> {
    let mut bytes = fs::read(path).ok()?;
    let before = bytes.clone();
    edit(&mut bytes)?;
    (bytes != before).then(|| fs::write(path, bytes).ok())?
}

/// Flips one bit of a file.
pub fn flip(path: &Path, random: &mut Random) -> Option<()> {
    edit_file(path, |bytes| {
        let at = random.below(bytes.len());
        bytes[at] ^= 1 << random.below(8);
        Some(())
    })
}

/// Cuts a file to this share of its bytes.
pub fn cut(path: &Path, share: f64) -> Option<()> {
    edit_file(path, |bytes| {
        let wanted = share * bytes.len() as f64;
        let length = (0..bytes.len()).find(|length| *length as f64 >= wanted)?;
        bytes.truncate(length);
        Some(())
    })
}

/// Fills a part of a file with NUL bytes, as a disk does after a power cut.
pub fn zero(path: &Path, random: &mut Random) -> Option<()> {
    edit_file(path, |bytes| {
        let at = random.below(bytes.len());
        let end = (at + 512).min(bytes.len());
        bytes[at..end].fill(0);
        Some(())
    })
}

/// The text with the first digit of a member's number changed.
pub fn with_other_number(text: &str, key: &str, random: &mut Random) -> Option<String> {
    let at = after_key(text, key)?;
    let mut bytes = text.as_bytes().to_vec();
    let digit = at + bytes[at..].iter().position(|byte| (b'1'..=b'8').contains(byte))?;
    bytes::digit(&mut bytes, digit, random);
    String::from_utf8(bytes).ok()
}

/// The text with one hexadecimal digit of a member changed.
pub fn with_other_digit(text: &str, key: &str, random: &mut Random) -> Option<String> {
    let at = after_key(text, key)? + 1 + random.below(16);
    let mut bytes = text.as_bytes().to_vec();
    bytes[at] = if bytes[at] == b'0' { b'1' } else { b'0' };
    String::from_utf8(bytes).ok()
}

/// The text with another value of a member that is a text.
pub fn with_other_text(text: &str, key: &str, value: &str) -> Option<String> {
    let at = after_key(text, key)? + 1;
    let end = at + text[at..].find('"')?;
    (&text[at..end] != value).then(|| format!("{}{value}{}", &text[..at], &text[end..]))
}

/// Place of the value of a member.
fn after_key(text: &str, key: &str) -> Option<usize> {
    let name = format!("\"{key}\":");
    let at = text.find(&name)? + name.len();
    Some(at + text[at..].find(|symbol| symbol != ' ')?)
}

/// A text with a checksum, changed as a newer program would write it: with a checksum that is right.
pub fn sealed_again(text: &str, from: &str, to: &str) -> Option<String> {
    let object = seal::open(text.trim_end()).ok()?;
    object.contains(from).then(|| seal::seal(&object.replacen(from, to, 1)))
}
