//! The damages of a finished results folder, one row each.

use std::fs::{self, File};
use std::io::{Error, Result};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use billow_solver::platform::seal;

use crate::check::ended_job;
use crate::mutate;
use crate::random::Random;

use Expect::{Fault, Harmless, OtherVersion};

/// Files of the folder.
const JOURNAL: &str = "journal/000001.jsonl";
const STUDY: &str = "study.json";
/// That of [`Target::job`].
const HISTORY: &str = "history";
const TABLE: &str = "summary.parquet";
/// The lock, or several files.
const LOCK: &str = "lock";
const OTHER: &str = "";
/// Bytes that a disk fills with zeros after a power cut.
const BLOCK: usize = 512;

/// What `doctor` must say about a damage.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Expect {
    /// It is a fault: exit code 1.
    Fault,
    /// It may be a note, or nothing: no result depends on it.
    Harmless,
    /// The file has another version: it is refused, and not repaired.
    OtherVersion,
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
    fn history(&self, job: &str) -> PathBuf {
        self.results.join("jobs").join(&job[..2]).join(format!("{job}.h5"))
    }

    /// Path of a file of the folder.
    pub fn path(&self, file: &str) -> PathBuf {
        if file == HISTORY { self.history(&self.job) } else { self.results.join(file) }
    }
}

/// Damages the file at this path; an error where that is not possible.
type Apply = fn(&Path, &Target, &mut Random) -> Result<()>;

/// Files, what happens to each, what `doctor` must say, number of trials, how it is done.
pub type Row = (&'static [&'static str], &'static str, Expect, usize, Apply);

/// Every damage. Every cell of the table is compared; other bytes of it hold no result.
pub const DAMAGES: [Row; 38] = [
    (&[JOURNAL, STUDY, HISTORY], "one bit flipped", Fault, 6, flip),
    (&[TABLE], "one bit flipped", Harmless, 6, flip),
    (&[JOURNAL, STUDY, HISTORY], "a block of zeros", Fault, 2, zeros),
    (&[TABLE], "a block of zeros", Harmless, 2, zeros),
    (&[JOURNAL, STUDY, HISTORY], "deleted", Fault, 1, |path, _, _| fs::remove_file(path)),
    (&[TABLE], "deleted", Harmless, 1, |path, _, _| fs::remove_file(path)),
    // Beyond its last line a journal has nothing to lose.
    (&[JOURNAL, STUDY, HISTORY, TABLE], "truncated", Fault, 3, |path, _, random| {
        edit_bytes(path, |bytes| bytes.truncate(random.below(bytes.len() * 9 / 10)))
    }),
    (&[JOURNAL, STUDY, HISTORY, TABLE], "empty", Fault, 1, |path, _, _| fs::write(path, "")),
    (&[JOURNAL, STUDY, HISTORY, TABLE], "of another program", Fault, 1, |path, _, _| {
        fs::write(path, b"\xff\xfe{}")
    }),
    (&[JOURNAL, STUDY, HISTORY, TABLE], "a folder in its place", Fault, 1, |path, _, _| {
        fs::remove_file(path)?;
        fs::create_dir(path)
    }),
    (&[JOURNAL], "a number edited", Fault, 1, |path, _, random| {
        edit_number(path, "peak_vz", random)
    }),
    (&[STUDY], "a number edited", Fault, 1, |path, _, random| {
        edit_number(path, "bottom_radius", random)
    }),
    (&[JOURNAL, STUDY], "a checksum edited", Fault, 1, |path, _, _| {
        edit_text(path, |text| {
            let at = text.find("\"checksum\":")? + 16;
            let digit = if text.as_bytes()[at] == b'0' { "1" } else { "0" };
            Some(format!("{}{digit}{}", &text[..at], &text[at + 1..]))
        })
    }),
    (&[JOURNAL, STUDY], "a checksum removed", Fault, 1, |path, _, _| {
        edit_text(path, |text| Some(format!("{{{}", text.split_once(',')?.1)))
    }),
    (&[JOURNAL, STUDY], "of another version", OtherVersion, 1, |path, _, _| {
        edit_text(path, with_other_version)
    }),
    (&[JOURNAL], "header removed", Fault, 1, |path, target, _| {
        edit_lines(path, target, |lines, _| drop(lines.remove(0)))
    }),
    (&[JOURNAL], "line removed", Fault, 1, |path, target, _| {
        edit_lines(path, target, |lines, [at, _]| drop(lines.remove(at)))
    }),
    (&[JOURNAL], "line doubled", Harmless, 1, |path, target, _| {
        edit_lines(path, target, |lines, [at, _]| lines.insert(at, lines[at].clone()))
    }),
    (&[JOURNAL], "lines swapped", Harmless, 1, |path, target, _| {
        edit_lines(path, target, |lines, [a, b]| lines.swap(a, b))
    }),
    (&[JOURNAL], "line of another job", Fault, 1, |path, target, _| {
        edit_lines(path, target, |lines, [a, b]| lines[a] = lines[b].clone())
    }),
    (&[JOURNAL], "line of another study", Harmless, 1, |path, target, _| {
        let other = fs::read_to_string(target.other.join(JOURNAL))?;
        let ended = other.lines().find(|line| ended_job(line).is_some()).map(ToOwned::to_owned);
        edit_lines(path, target, |lines, _| lines.extend(ended))
    }),
    (&[JOURNAL], "a line of another program", Fault, 1, |path, target, _| {
        edit_lines(path, target, |lines, [at, _]| lines.insert(at, "not a record".to_owned()))
    }),
    (&[JOURNAL], "cut after a line", Harmless, 1, |path, target, _| {
        edit_lines(path, target, |lines, [at, _]| lines.truncate(at))
    }),
    (&[JOURNAL], "line ends of Windows", Harmless, 1, |path, target, _| {
        edit_lines(path, target, |lines, _| lines.iter_mut().for_each(|line| line.push('\r')))
    }),
    (&[HISTORY], "swapped with another one", Fault, 1, |path, target, _| {
        let other = target.history(&target.second);
        let (first, second) = (fs::read(path)?, fs::read(&other)?);
        fs::write(path, second)?;
        fs::write(other, first)
    }),
    (&[HISTORY], "a link to that of another job", Fault, 1, |path, target, _| {
        fs::remove_file(path)?;
        symlink(target.history(&target.second), path)
    }),
    (&[HISTORY], "all deleted", Fault, 1, |_, target, _| {
        fs::remove_dir_all(target.results.join("jobs"))
    }),
    (&[HISTORY], "other bytes, same size and time", Fault, 4, |path, target, random| {
        let time = fs::metadata(path)?.modified()?;
        flip(path, target, random)?;
        File::options().write(true).open(path)?.set_modified(time)
    }),
    (&[HISTORY], "only its time changed", Harmless, 1, |path, _, _| {
        let file = File::options().write(true).open(path)?;
        file.set_modified(SystemTime::now() - Duration::from_hours(24))
    }),
    (&[TABLE], "of another study", Fault, 1, |path, target, _| {
        fs::copy(target.other.join("summary.parquet"), path).map(drop)
    }),
    (&[JOURNAL], "folder deleted", Fault, 1, |_, target, _| {
        fs::remove_dir_all(target.results.join("journal"))
    }),
    (&[JOURNAL], "a file in the place of its folder", Fault, 1, |_, target, _| {
        fs::remove_dir_all(target.results.join("journal"))?;
        fs::write(target.results.join("journal"), "x")
    }),
    (&[JOURNAL], "copied under a second number", Harmless, 1, |path, _, _| {
        fs::copy(path, path.with_file_name("000009.jsonl")).map(drop)
    }),
    (&[LOCK], "with content", Harmless, 1, |path, _, _| fs::write(path, "99999")),
    (&[OTHER], "temporary files of dead processes", Harmless, 1, |results, target, _| {
        for folder in ["", "journal", "charts", "checkpoints"].map(|name| results.join(name)) {
            fs::create_dir_all(&folder)?;
            fs::write(folder.join(".x.1-0.tmp"), "half")?;
        }
        fs::write(target.history(&target.job).with_file_name(".x.h5.1-0.tmp"), "half")
    }),
    (&[OTHER], "attempts of a dead process, not readable", Harmless, 1, |results, _, _| {
        fs::write(results.join("attempts.jsonl"), "{\"format\":\nhalf")
    }),
    (&[OTHER], "a checkpoint of a finished job", Harmless, 1, |results, target, _| {
        fs::create_dir_all(results.join("checkpoints"))?;
        fs::write(results.join("checkpoints").join(format!("{}.json", target.job)), "{}")
    }),
    (&[OTHER], "files of another program", Harmless, 1, |results, _, _| {
        fs::write(results.join("notes.txt"), "mine")?;
        symlink("/nowhere", results.join("dangling"))
    }),
];

fn flip(path: &Path, _: &Target, random: &mut Random) -> Result<()> {
    edit_bytes(path, |bytes| mutate::flip(bytes, random))
}

fn zeros(path: &Path, _: &Target, random: &mut Random) -> Result<()> {
    edit_bytes(path, |bytes| {
        let at = random.below(bytes.len());
        let end = (at + BLOCK).min(bytes.len());
        bytes[at..end].fill(0);
    })
}

/// Changes the bytes of a file; an error where the change changed nothing.
fn edit_bytes(path: &Path, edit: impl FnOnce(&mut Vec<u8>)) -> Result<()> {
    let before = fs::read(path)?;
    let mut bytes = before.clone();
    edit(&mut bytes);
    if bytes == before { Err(Error::other("no change")) } else { fs::write(path, bytes) }
}

/// Changes a text; an error where nothing changes.
fn edit_text(path: &Path, edit: impl FnOnce(&str) -> Option<String>) -> Result<()> {
    let text = fs::read_to_string(path)?;
    let edited = edit(&text).filter(|edited| *edited != text);
    fs::write(path, edited.ok_or_else(|| Error::other("no change"))?)
}

/// Changes a digit of a member with a number.
fn edit_number(path: &Path, key: &str, random: &mut Random) -> Result<()> {
    edit_text(path, |text| {
        let mut bytes = text.as_bytes().to_vec();
        let at = text.find(&format!("\"{key}\":"))?;
        let digit = at + bytes[at..].iter().position(|byte| (b'1'..=b'8').contains(byte))?;
        mutate::digit(&mut bytes, digit, random);
        String::from_utf8(bytes).ok()
    })
}

/// The text of a sealed object, or of lines that begin with one, in another version, with a right checksum.
fn with_other_version(text: &str) -> Option<String> {
    let (first, rest) = match text.split_once('\n') {
        Some((line, rest)) if line.ends_with('}') => (line, format!("\n{rest}")),
        _ => (text.trim_end(), String::new()),
    };
    let object = seal::open(first).or_else(|_| seal::open(text)).ok()?;
    let at = object.find("\"version\":")? + 10;
    let at = at + object[at..].find(|symbol: char| symbol.is_ascii_digit())?;
    Some(seal::seal(&format!("{}9{}", &object[..at], &object[at..])) + &rest)
}

/// Changes the lines of the journal; the change gets the places of the records of the two jobs.
fn edit_lines(
    path: &Path,
    target: &Target,
    edit: impl FnOnce(&mut Vec<String>, [usize; 2]),
) -> Result<()> {
    edit_text(path, |text| {
        let mut lines: Vec<String> = text.lines().map(ToOwned::to_owned).collect();
        let line_of =
            |job: &String| lines.iter().position(|line| ended_job(line).as_ref() == Some(job));
        let at = [line_of(&target.job)?, line_of(&target.second)?];
        edit(&mut lines, at);
        Some(lines.join("\n") + "\n")
    })
}
