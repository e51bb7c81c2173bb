//! Does what `doctor` advises.

use serde_json::Value;

use crate::harness::place::Place;
use crate::harness::program;
use crate::harness::studies;
use crate::harness::trial::{Fault, Trial};

/// The next steps of the findings, each once.
fn steps(findings: &str) -> Vec<String> {
    let findings: Vec<Value> = serde_json::from_str(findings).unwrap_or_default();
    let mut steps: Vec<String> = Vec::new();
    for finding in &findings {
        let step = finding["next"].as_str().unwrap_or_default().to_owned();
        if !steps.contains(&step) {
            steps.push(step);
        }
    }
    steps
}

/// The next steps, for a message.
pub fn said(findings: &str) -> String {
    steps(findings).join(" / ")
}

/// Does every next step, in order: the commands in backquotes. Of "A, or B" only A.
pub fn check(trial: &mut Trial, place: &Place, findings: &str) {
    for step in steps(findings) {
        if step.is_empty() {
            trial.fault(Fault::WrongMessage, "doctor: a finding without a next step");
        }
        if step.starts_with("nothing") {
            continue;
        }
        let first = step.split(", or ").next().unwrap_or_default();
        for command in first.split('`').skip(1).step_by(2) {
            carry_out(trial, place, command);
        }
    }
}

fn carry_out(trial: &mut Trial, place: &Place, command: &str) {
    let words: Vec<&str> = command.split_whitespace().collect();
    let finish = match words.get(1) {
        Some(&"run") => studies::run(place),
        Some(&"doctor") => program::run(place, &["doctor", "--repair", "results/s"]),
        _ => return trial.fault(Fault::WrongMessage, format!("doctor advises {command:?}")),
    };
    finish.check_end(trial, command);
    if finish.code == Some(2) {
        let text = format!("doctor advises {command:?}: {}", finish.said());
        trial.fault(Fault::WrongMessage, text);
    }
}
