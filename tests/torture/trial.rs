//! What a trial found.

use std::time::Duration;

use crate::program::{Finish, Place};

/// What one trial found.
#[derive(Default)]
pub struct Trial {
    /// Its number within the kind.
    pub number: usize,
    /// What was done, to name the trial.
    pub what: String,
    /// What must not happen, a sentence each.
    pub faults: Vec<String>,
    /// The program reported the damage or the end; otherwise it was not disturbed.
    pub detected: bool,
    /// The trial was not made.
    pub skipped: bool,
    /// Events to count, by name.
    pub counts: Vec<(String, usize)>,
    /// The longest time that the kind measures.
    pub longest: Duration,
}

impl Trial {
    /// Adds a fault.
    pub fn fault(&mut self, text: impl Into<String>) {
        self.faults.push(text.into());
    }

    /// Counts an event.
    pub fn count(&mut self, name: impl Into<String>, number: usize) {
        self.counts.push((name.into(), number));
    }

    /// The trial is not made.
    pub fn skip(&mut self, reason: &str) {
        self.skipped = true;
        self.count(format!("skipped: {reason}"), 1);
    }

    /// Takes note of a measured time.
    pub fn time(&mut self, time: Duration) {
        self.longest = self.longest.max(time);
    }

    /// Runs `billow` to its end and checks the end.
    pub fn run(&mut self, place: &Place, arguments: &str, codes: &[i32]) -> Finish {
        let finish = place.run(arguments);
        self.check(arguments, &finish, codes);
        finish
    }

    /// Adds the fault of an end: a hang, a panic, an abort, another exit code than these (empty: any), a
    /// refusal without a next step or what is allowed.
    pub fn check(&mut self, command: &str, finish: &Finish, codes: &[i32]) {
        let said = finish.said();
        let text = match finish.code {
            _ if finish.hung => "no end".to_owned(),
            Some(101) => format!("panic: {said}"),
            _ if finish.stderr.contains("panicked at") => format!("panic: {said}"),
            None => format!("abort by signal {:?}: {said}", finish.signal),
            Some(code) if !codes.is_empty() && !codes.contains(&code) => {
                format!("exit code {code}, expected {codes:?}: {said}")
            }
            Some(2) if !["next:", "allowed:"].iter().any(|word| finish.stderr.contains(word)) => {
                format!("no next step: {said}")
            }
            Some(_) => return,
        };
        self.fault(format!("{command}: {text}"));
    }
}
