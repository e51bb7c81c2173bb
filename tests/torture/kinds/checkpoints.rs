//! Changed checkpoints. `billow solve` refuses them, or (a change without meaning) gives the same summary.
//! `billow run` starts their jobs from the beginning, with the same bits.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use serde_json::Value;

use super::mutations::bytes;
use crate::harness::check::{self, Truth, without_costs};
use crate::harness::place::{self, Place};
use crate::harness::program::{self, HANG};
use crate::harness::random::Random;
use crate::harness::studies;
use crate::harness::trial::{Fault, Kind, Trial};

/// Number of changed checkpoints of `solve`, and of `run`.
const TRIALS: [usize; 2] = [300, 60];
/// Steps to the checkpoint, from there to the end, and of the whole run.
const STEPS: [&str; 3] = ["150", "100", "250"];
/// Attempts to end a study while its jobs run, and the first pause before the signal.
const MAX_ATTEMPTS: u32 = 10;
const FIRST_PAUSE: Duration = Duration::from_millis(60);
/// Texts that are appended.
const APPENDED: [&str; 4] = ["x", "{}", " 1", "\n[]"];

/// The kind.
pub struct Checkpoints {
    template: Place,
    text: Vec<u8>,
    /// Summary of the whole run, resumed from the unchanged checkpoint.
    summary: Value,
    /// A study that a signal ended while its jobs ran, and what it gives undisturbed.
    study: Place,
    truth: Truth,
}

/// Makes the checkpoint and its summary.
pub fn prepare(place: &Place) -> Result<Checkpoints, String> {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/capsule.json");
    fs::copy(scene, place.join("scene.json")).map_err(|error| format!("{scene}: {error}"))?;
    let first = solve(place, &["--stop-after", STEPS[0], "--checkpoint", "checkpoint.json"]);
    let text = fs::read(place.join("checkpoint.json"))
        .map_err(|error| format!("checkpoint.json: {error}: {}", first.said()))?;
    let whole = solve(place, &["--stop-after", STEPS[2], "--checkpoint", "whole.json"]);
    let resumed = resume(place);
    match (summary(&whole), summary(&resumed)) {
        (Some(whole), Some(resumed)) if whole == resumed => {
            let (study, truth) = interrupted_study(place)?;
            Ok(Checkpoints { template: place.clone(), text, summary: whole, study, truth })
        }
        _ => Err(format!("the unchanged checkpoint gives another summary: {}", resumed.said())),
    }
}

/// Runs a study undisturbed, then ends it by a signal while its jobs run.
fn interrupted_study(place: &Place) -> Result<(Place, Truth), String> {
    let study = place.with_path(&place.join("study"));
    fs::create_dir_all(study.path()).map_err(|error| error.to_string())?;
    study.write_study(&studies::film());
    let truth = Truth::of_run(&study)?;
    for attempt in 1..=MAX_ATTEMPTS {
        fs::remove_dir_all(study.results()).map_err(|error| error.to_string())?;
        let running = program::start(&study, program::billow(&study, &studies::run_arguments()));
        std::thread::sleep(FIRST_PAUSE * attempt);
        running.signal("TERM");
        running.finish(HANG);
        if !stored(&study).is_empty() {
            return Ok((study, truth));
        }
    }
    Err("a signal during a run leaves no checkpoint".to_owned())
}

/// The checkpoints of an interrupted study.
fn stored(study: &Place) -> Vec<PathBuf> {
    place::files(&study.results().join("checkpoints"))
}

fn solve(place: &Place, arguments: &[&str]) -> program::Finish {
    let mesh = "design.subdivisions=2";
    program::run(place, &[&["solve", "scene.json", "-q", "--set", mesh], arguments].concat())
}

fn resume(place: &Place) -> program::Finish {
    let stop = ["--stop-after", STEPS[1], "--checkpoint", "end.json"];
    solve(place, &[&["--resume", "checkpoint.json"], &stop[..]].concat())
}

fn summary(finish: &program::Finish) -> Option<Value> {
    let value = serde_json::from_str(&finish.stdout).ok()?;
    finish.succeeded().then(|| without_costs(value))
}

impl Kind for Checkpoints {
    fn trials(&self) -> usize {
        TRIALS[0] + TRIALS[1]
    }

    fn limit(&self) -> Duration {
        HANG
    }

    fn trial(&self, number: usize, random: &mut Random, place: &Place) -> Trial {
        if number < TRIALS[0] {
            self.of_solve(number, random, place)
        } else {
            self.of_run(number, random, place)
        }
    }
}

impl Checkpoints {
    fn of_solve(&self, number: usize, random: &mut Random, place: &Place) -> Trial {
        let (what, changed) = changed(&self.text, number, random);
        let mut trial = Trial::new(format!("solve: {what}"));
        if changed == self.text {
            trial.skipped = Some("the change gave the same file".to_owned());
            return trial;
        }
        place.copy_from(&self.template);
        place.write("checkpoint.json", &changed);
        let finish = resume(place);
        trial.time(finish.wall);
        if finish.succeeded() {
            trial.count("accepted with the same summary", 1);
            if summary(&finish).as_ref() != Some(&self.summary) {
                trial.fault(Fault::SilentlyWrong, "accepted, and the summary is another one");
            }
        } else {
            trial.detected = true;
            finish.check_refusal(&mut trial, "solve --resume", &[2]);
        }
        trial
    }

    fn of_run(&self, number: usize, random: &mut Random, place: &Place) -> Trial {
        place.copy_from(&self.study);
        let paths = stored(place);
        let path = random.pick(&paths);
        let text = fs::read(path).unwrap_or_default();
        let (what, changed) = match random.below(8) {
            0 => ("that of another film", self.text.clone()),
            _ => changed(&text, number, random),
        };
        let mut trial = Trial::new(format!("run: {what}"));
        if changed == text {
            trial.skipped = Some("the change gave the same file".to_owned());
            return trial;
        }
        fs::write(path, changed).expect("a file of a trial");
        let finish = program::run(place, &["run", "s.json", "--threads", "2"]);
        trial.time(finish.wall);
        finish.check_refusal(&mut trial, "run", &[0]);
        trial.detected = finish.stderr.contains("checkpoint");
        if !trial.detected {
            trial.fault(Fault::SilentlyWrong, "run uses the checkpoint, or does not name it");
        }
        check::compare(&mut trial, place, &self.truth);
        check::compare_journal(&mut trial, place);
        trial
    }
}

/// One change of a checkpoint, and its name.
pub fn changed(text: &[u8], number: usize, random: &mut Random) -> (&'static str, Vec<u8>) {
    let mut changed = text.to_vec();
    let at = random.below(changed.len());
    match number % 6 {
        0 => {
            changed[at] ^= 1 << random.below(8);
            ("one bit flipped", changed)
        }
        1 => {
            bytes::digit(&mut changed, at, random);
            ("one digit changed", changed)
        }
        2 => ("two numbers swapped", with_swapped_numbers(text, random)),
        3 => {
            changed.truncate(at);
            ("truncated", changed)
        }
        4 => {
            changed.extend_from_slice(random.pick(&APPENDED).as_bytes());
            ("text appended", changed)
        }
        _ => {
            bytes::change(&mut changed, random);
            ("bytes changed", changed)
        }
    }
}

/// The text with two neighbouring numbers of a list in the other order.
fn with_swapped_numbers(text: &[u8], random: &mut Random) -> Vec<u8> {
    let is_number =
        |part: &[u8]| std::str::from_utf8(part).is_ok_and(|part| part.parse::<f64>().is_ok());
    let mut parts: Vec<&[u8]> = text.split(|byte| *byte == b',').collect();
    let pairs: Vec<usize> = (1..parts.len())
        .filter(|index| is_number(parts[index - 1]) && is_number(parts[*index]))
        .collect();
    if !pairs.is_empty() {
        let index = *random.pick(&pairs);
        parts.swap(index - 1, index);
    }
    parts.join(&b","[..])
}
