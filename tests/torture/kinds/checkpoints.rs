//! Changed checkpoints. `billow solve` refuses them, or (a change without meaning) gives the same summary.

use std::fs;
use std::time::Duration;

use serde_json::Value;

use super::mutations::bytes;
use crate::harness::check::without_costs;
use crate::harness::place::Place;
use crate::harness::program::{self, HANG};
use crate::harness::random::Random;
use crate::harness::trial::{Fault, Kind, Trial};

/// Number of changed checkpoints.
const TRIALS: usize = 300;
/// Steps to the checkpoint, from there to the end, and of the whole run.
const STEPS: [&str; 3] = ["150", "100", "250"];
/// Texts that are appended.
const APPENDED: [&str; 4] = ["x", "{}", " 1", "\n[]"];

/// The kind.
pub struct Checkpoints {
    template: Place,
    text: Vec<u8>,
    /// Summary of the whole run, resumed from the unchanged checkpoint.
    summary: Value,
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
            Ok(Checkpoints { template: place.clone(), text, summary: whole })
        }
        _ => Err(format!("the unchanged checkpoint gives another summary: {}", resumed.said())),
    }
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
        TRIALS
    }

    fn limit(&self) -> Duration {
        HANG
    }

    fn trial(&self, number: usize, random: &mut Random, place: &Place) -> Trial {
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
}

/// One change of a checkpoint, and its name.
fn changed(text: &[u8], number: usize, random: &mut Random) -> (&'static str, Vec<u8>) {
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
