//! The damages: what happens to any file, and what is special to journal, study.json, histories, table and
//! other files.

use std::fs::{self, File};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use billow_solver::platform::seal;

use super::super::mutations::bytes;
use crate::harness::journal;
use crate::harness::random::Random;

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

/// Does a damage; `None` where it is not possible.
type Apply = Box<dyn Fn(&Target, &mut Random) -> Option<()> + Sync + Send>;

/// A damage of a finished folder.
pub struct Damage {
    /// What is damaged, and how.
    pub name: String,
    /// Does it.
    pub apply: Apply,
    /// What `doctor` must say.
    pub expect: Expect,
    /// Number of trials.
    pub trials: usize,
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
}

/// A file of the folder.
type Which = fn(&Target) -> Option<PathBuf>;

const JOURNAL: Which = |target| journal::paths(&target.results).into_iter().next();
const STUDY: Which = |target| Some(target.results.join("study.json"));
const HISTORY: Which = |target| Some(target.history(&target.job));
const TABLE: Which = |target| Some(target.results.join("summary.parquet"));

/// Every damage.
pub fn all() -> Vec<Damage> {
    let mut all = Vec::new();
    for (name, file) in
        [("journal", JOURNAL), ("study.json", STUDY), ("history", HISTORY), ("table", TABLE)]
    {
        all.extend(of_any_file(name, file));
    }
    all.extend(of_text("journal", JOURNAL, "peak_vz"));
    all.extend(of_text("study.json", STUDY, "bottom_radius"));
    all.extend(of_lines());
    all.extend(of_places());
    all.extend(others());
    all
}

fn damage(
    name: impl Into<String>,
    (expect, trials): (Expect, usize),
    apply: impl Fn(&Target, &mut Random) -> Option<()> + Sync + Send + 'static,
) -> Damage {
    Damage { name: name.into(), apply: Box::new(apply), expect, trials }
}

/// What happens to a file of any kind.
fn of_any_file(what: &'static str, file: Which) -> Vec<Damage> {
    // Every cell of the table is compared; other bytes of it hold no result.
    let flips = if what == "table" { Expect::Harmless } else { Expect::Fault };
    let deleted = if what == "table" { Expect::Harmless } else { Expect::Fault };
    let edit = move |name: &str, expect, edit: fn(&mut Vec<u8>, &mut Random)| {
        damage(format!("{what}: {name}"), expect, move |target, random| {
            edit_file(&file(target)?, |bytes| edit(bytes, random))
        })
    };
    let fault = (Expect::Fault, 1);
    vec![
        edit("one bit flipped", (flips, 6), |bytes, random| {
            let at = random.below(bytes.len());
            bytes[at] ^= 1 << random.below(8);
        }),
        edit("a block of zeros", (flips, 2), |bytes, random| {
            let at = random.below(bytes.len());
            let end = (at + BLOCK).min(bytes.len());
            bytes[at..end].fill(0);
        }),
        edit("truncated", (Expect::Fault, 3), |bytes, random| {
            // Beyond its last line a journal has nothing to lose.
            bytes.truncate(random.below(bytes.len() * 9 / 10));
        }),
        edit("empty", fault, |bytes, _| bytes.clear()),
        edit("of another program", fault, |bytes, _| *bytes = b"\xff\xfe{}".to_vec()),
        damage(format!("{what}: deleted"), (deleted, 1), move |target, _| {
            fs::remove_file(file(target)?).ok()
        }),
        damage(format!("{what}: a folder in its place"), fault, move |target, _| {
            let path = file(target)?;
            fs::remove_file(&path).ok()?;
            fs::create_dir(path).ok()
        }),
    ]
}

/// What happens to a text with checksums; `number` is a member with a number.
fn of_text(what: &'static str, file: Which, number: &'static str) -> Vec<Damage> {
    let edit = move |name: &str, expect, edit: fn(&str, &str, &mut Random) -> Option<String>| {
        damage(format!("{what}: {name}"), (expect, 1), move |target, random| {
            let path = file(target)?;
            let text = fs::read_to_string(&path).ok()?;
            let edited = edit(&text, number, random).filter(|edited| *edited != text)?;
            fs::write(path, edited).ok()
        })
    };
    let mut all = vec![
        edit("a number edited", Expect::Fault, |text, key, random| {
            let mut bytes = text.as_bytes().to_vec();
            let at = text.find(&format!("\"{key}\":"))?;
            let digit = at + bytes[at..].iter().position(|byte| (b'1'..=b'8').contains(byte))?;
            bytes::digit(&mut bytes, digit, random);
            String::from_utf8(bytes).ok()
        }),
        edit("a checksum edited", Expect::Fault, |text, _, _| {
            let at = text.find("\"checksum\":")? + 16;
            let digit = if text.as_bytes()[at] == b'0' { "1" } else { "0" };
            Some(format!("{}{digit}{}", &text[..at], &text[at + 1..]))
        }),
        edit("a checksum removed", Expect::Fault, |text, _, _| {
            Some(format!("{{{}", text.split_once(',')?.1))
        }),
    ];
    all.push(edit("of another version", Expect::OtherVersion, |text, _, _| {
        let (first, rest) = match text.split_once('\n') {
            Some((line, rest)) if line.ends_with('}') => (line, format!("\n{rest}")),
            _ => (text.trim_end(), String::new()),
        };
        let object = seal::open(first).or_else(|_| seal::open(text)).ok()?;
        let at = object.find("\"version\":")? + 10;
        let at = at + object[at..].find(|symbol: char| symbol.is_ascii_digit())?;
        let other = format!("{}9{}", &object[..at], &object[at..]);
        Some(seal::seal(&other) + &rest)
    }));
    all
}

/// Lines of the journal that are missing, doubled, moved or of another job.
fn of_lines() -> Vec<Damage> {
    let edit = |name: &str, expect, edit: fn(&mut Vec<String>, [usize; 2], &Target)| {
        damage(format!("journal: {name}"), (expect, 1), move |target, _| {
            let path = JOURNAL(target)?;
            let text = fs::read_to_string(&path).ok()?;
            let mut lines: Vec<String> = text.lines().map(ToOwned::to_owned).collect();
            let line_of = |job: &str| {
                lines.iter().position(|line| journal::ended_job(line).as_deref() == Some(job))
            };
            let at = [line_of(&target.job)?, line_of(&target.second)?];
            edit(&mut lines, at, target);
            fs::write(path, lines.join("\n") + "\n").ok()
        })
    };
    vec![
        edit("header removed", Expect::Fault, |lines, _, _| drop(lines.remove(0))),
        edit("line removed", Expect::Fault, |lines, [at, _], _| drop(lines.remove(at))),
        edit("line doubled", Expect::Harmless, |lines, [at, _], _| {
            lines.insert(at, lines[at].clone());
        }),
        edit("lines swapped", Expect::Harmless, |lines, [a, b], _| lines.swap(a, b)),
        edit("line of another job", Expect::Fault, |lines, [a, b], _| lines[a] = lines[b].clone()),
        edit("line of another study", Expect::Harmless, |lines, _, target| {
            let paths = journal::paths(&target.other);
            let text = paths.first().and_then(|path| fs::read_to_string(path).ok());
            let text = text.unwrap_or_default();
            let ended = text.lines().find(|line| journal::ended_job(line).is_some());
            lines.extend(ended.map(ToOwned::to_owned));
        }),
        edit("a line of another program", Expect::Fault, |lines, [at, _], _| {
            lines.insert(at, "not a record".to_owned());
        }),
        edit("cut after a line", Expect::Harmless, |lines, [at, _], _| lines.truncate(at)),
        edit("line ends of Windows", Expect::Harmless, |lines, _, _| {
            for line in lines {
                line.push('\r');
            }
        }),
    ]
}

/// Files that take the place of another one.
fn of_places() -> Vec<Damage> {
    let fault = (Expect::Fault, 1);
    let two_histories =
        |target: &Target| (target.history(&target.job), target.history(&target.second));
    vec![
        damage("history: two swapped", fault, move |target, _| swap(two_histories(target))),
        damage("history: a link to that of another job", fault, move |target, _| {
            let (path, other) = two_histories(target);
            fs::remove_file(&path).ok()?;
            symlink(other, path).ok()
        }),
        damage("history: all deleted", fault, |target, _| {
            fs::remove_dir_all(target.results.join("jobs")).ok()
        }),
        damage("history: other bytes, same size and time", (Expect::Fault, 4), |target, random| {
            let path = target.history(&target.job);
            let time = fs::metadata(&path).ok()?.modified().ok()?;
            edit_file(&path, |bytes| {
                let at = random.below(bytes.len());
                bytes[at] ^= 1;
            })?;
            File::options().write(true).open(path).ok()?.set_modified(time).ok()
        }),
        damage("history: only its time changed", (Expect::Harmless, 1), |target, _| {
            let file = File::options().write(true).open(target.history(&target.job)).ok()?;
            file.set_modified(SystemTime::now() - Duration::from_hours(24)).ok()
        }),
        damage("table: of another study", fault, |target, _| {
            let name = "summary.parquet";
            fs::copy(target.other.join(name), target.results.join(name)).ok().map(|_| ())
        }),
        damage("journal: folder deleted", fault, |target, _| {
            fs::remove_dir_all(target.results.join("journal")).ok()
        }),
        damage("journal: a file in the place of its folder", fault, |target, _| {
            fs::remove_dir_all(target.results.join("journal")).ok()?;
            fs::write(target.results.join("journal"), "x").ok()
        }),
        damage("journal: copied under a second number", (Expect::Harmless, 1), |target, _| {
            let path = JOURNAL(target)?;
            fs::copy(&path, path.with_file_name("000009.jsonl")).ok().map(|_| ())
        }),
    ]
}

/// Files and folders that hold no result.
fn others() -> Vec<Damage> {
    let harmless = (Expect::Harmless, 1);
    vec![
        damage("lock: with content", harmless, |target, _| {
            fs::write(target.results.join("lock"), "99999").ok()
        }),
        damage("temporary files of dead processes", harmless, |target, _| {
            let folders = ["", "journal", "charts", "checkpoints"];
            for folder in folders.map(|folder| target.results.join(folder)) {
                fs::create_dir_all(&folder).ok()?;
                fs::write(folder.join(".x.1-0.tmp"), "half").ok()?;
            }
            let history = target.history(&target.job);
            fs::write(history.with_file_name(".x.h5.1-0.tmp"), "half").ok()
        }),
        damage("attempts of a dead process: not readable", harmless, |target, _| {
            fs::write(target.results.join("attempts.jsonl"), "{\"format\":\nhalf").ok()
        }),
        damage("a checkpoint of a finished job", harmless, |target, _| {
            let folder = target.results.join("checkpoints");
            fs::create_dir_all(&folder).ok()?;
            fs::write(folder.join(format!("{}.json", target.job)), "{}").ok()
        }),
        damage("files of another program", harmless, |target, _| {
            fs::write(target.results.join("notes.txt"), "mine").ok()?;
            symlink("/nowhere", target.results.join("dangling")).ok()
        }),
    ]
}

/// Changes the bytes of a file; `None` where the change changed nothing.
fn edit_file(path: &Path, edit: impl FnOnce(&mut Vec<u8>)) -> Option<()> {
    let before = fs::read(path).ok()?;
    let mut bytes = before.clone();
    edit(&mut bytes);
    (bytes != before).then(|| fs::write(path, bytes).ok())?
}

/// Swaps two files.
fn swap((a, b): (PathBuf, PathBuf)) -> Option<()> {
    let (first, second) = (fs::read(&a).ok()?, fs::read(&b).ok()?);
    fs::write(a, second).ok()?;
    fs::write(b, first).ok()
}
