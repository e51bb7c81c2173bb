//! A run is disturbed at every system call that changes the disk: killed before the call or in the
//! middle of a write, or refused by the system. `shim.c` says how.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use super::kill9::finish_study;
use crate::harness::check::Truth;
use crate::harness::place::Place;
use crate::harness::program::{self, Finish};
use crate::harness::random::Random;
use crate::harness::studies;
use crate::harness::trial::{Fault, Kind, Trial};

/// Source of the library that disturbs the calls.
const SHIM: &str = include_str!("../shim.c");
/// Letters of the calls that create a file or folder: the ones that need an inode.
const CREATIONS: &str = "cm";
/// Letters of the calls that open a file.
const OPENS: &str = "co";
/// Time after which a disturbed run counts as hanging.
const LIMIT: Duration = Duration::from_secs(10);

const EIO: i32 = 5;
const EMFILE: i32 = 24;
const ENOSPC: i32 = 28;
const EDQUOT: i32 = 122;

/// One disturbance.
struct Disturbance {
    name: &'static str,
    mode: &'static str,
    at: usize,
    error: i32,
    kinds: &'static str,
}

/// The kind.
pub struct SystemCalls {
    truth: Truth,
    shim: PathBuf,
    disturbances: Vec<Disturbance>,
    calls: usize,
}

/// Compiles the library and counts the calls of an undisturbed run.
pub fn prepare(place: &Place) -> Result<SystemCalls, String> {
    let shim = compile(place).ok_or("cc is needed, to disturb system calls")?;
    place.write_study(&studies::small());
    let letters_of = |kinds: &str| {
        let _ = fs::remove_dir_all(place.results());
        let count = Disturbance { name: "", mode: "count", at: 0, error: 0, kinds: "" };
        let finish = disturbed(place, &shim, &count, kinds);
        let text = if finish.succeeded() { letters(place) } else { None };
        text.ok_or_else(|| format!("the counted run failed: {}", finish.said()))
    };
    let creations = letters_of(CREATIONS)?.len();
    let opens = letters_of(OPENS)?.len();
    let letters = letters_of("")?;
    let truth = Truth::read(place).map_err(|finish| finish.said())?;
    let disturbances = disturbances(&letters, creations, opens);
    Ok(SystemCalls { truth, shim, disturbances, calls: letters.len() })
}

fn disturbances(letters: &[u8], creations: usize, opens: usize) -> Vec<Disturbance> {
    let mut all = Vec::new();
    let mut add = |name, mode, at, error, kinds| {
        all.push(Disturbance { name, mode, at, error, kinds });
    };
    for at in 1..=letters.len() {
        add("SIGKILL before call", "before", at, 0, "");
        if letters[at - 1] == b'w' {
            add("SIGKILL in the middle of write", "half", at, 0, "");
        }
        add("disk full from call", "from", at, ENOSPC, "");
        add("EIO from call", "from", at, EIO, "");
        add("EIO of call", "once", at, EIO, "");
        if at % 3 == 0 {
            add("quota exceeded from call", "from", at, EDQUOT, "");
        }
        if at % 7 == 1 {
            add("EINTR and short writes from call", "short", at, 0, "");
        }
    }
    for at in 1..=creations {
        add("no inodes from creation", "from", at, ENOSPC, CREATIONS);
    }
    for at in 1..=opens {
        add("EMFILE from open", "from", at, EMFILE, OPENS);
    }
    all
}

fn compile(place: &Place) -> Option<PathBuf> {
    let (source, shim) = (place.join("shim.c"), place.join("shim.so"));
    fs::write(&source, SHIM).ok()?;
    let mut compiler = Command::new("cc");
    compiler.args(["-O1", "-shared", "-fPIC", "-o"]).arg(&shim).arg(&source).arg("-ldl");
    compiler.status().is_ok_and(|status| status.success()).then_some(shim)
}

/// Runs the study of a place under the library, on one thread.
fn disturbed(place: &Place, shim: &Path, disturbance: &Disturbance, kinds: &str) -> Finish {
    let log = place.said().join("calls");
    let _ = fs::remove_file(&log);
    let mut command = program::billow(place, &["run", "s.json", "--quiet", "--threads", "1"]);
    command.env("LD_PRELOAD", shim).env("TORTURE_LOG", log);
    command.env("TORTURE_MODE", disturbance.mode).env("TORTURE_KINDS", kinds);
    command.env("TORTURE_AT", disturbance.at.to_string());
    command.env("TORTURE_ERRNO", disturbance.error.to_string());
    program::start(place, command).finish(LIMIT)
}

/// The letters of the calls of the last run.
fn letters(place: &Place) -> Option<Vec<u8>> {
    let log = fs::read(place.said().join("calls")).ok()?;
    let count = u64::from_le_bytes(log.get(..8)?.try_into().ok()?);
    Some(log.get(8..8 + usize::try_from(count).ok()?)?.to_vec())
}

impl Kind for SystemCalls {
    fn trials(&self) -> usize {
        self.disturbances.len()
    }

    fn limit(&self) -> Duration {
        LIMIT
    }

    fn trial(&self, number: usize, _: &mut Random, place: &Place) -> Trial {
        let disturbance = &self.disturbances[number];
        let mut trial = Trial::new(format!("{} {}", disturbance.name, disturbance.at));
        place.write_study(&studies::small());
        let finish = disturbed(place, &self.shim, disturbance, disturbance.kinds);
        trial.time(finish.wall);
        match disturbance.mode {
            "before" | "half" if finish.signal == Some(9) && !finish.hung => {}
            "short" => finish.check_refusal(&mut trial, "run", &[0]),
            "from" | "once" => {
                finish.check_refusal(&mut trial, "run", &[0, 2]);
                trial.detected = finish.code == Some(2);
                if trial.detected && !finish.stderr.contains("s.json") && !names_results(&finish) {
                    let text = format!("run: no path: {}", finish.said());
                    trial.fault(Fault::WrongMessage, text);
                }
            }
            _ => finish.check_end(&mut trial, "run"),
        }
        let last = studies::run(place);
        finish_study(&mut trial, place, &self.truth, &last);
        trial
    }

    fn note(&self) -> String {
        format!("{} calls of a run", self.calls)
    }
}

fn names_results(finish: &Finish) -> bool {
    finish.stderr.contains("results/s") || finish.stderr.contains("results:")
}
