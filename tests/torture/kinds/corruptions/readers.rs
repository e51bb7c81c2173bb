//! What the commands that only read say about a folder.

use std::collections::BTreeMap;
use std::fs;

use serde_json::Value;

use crate::harness::check;
use crate::harness::place::Place;
use crate::harness::program::{self, Finish};
use crate::harness::trial::{Fault, Trial};

/// Commands that read the job `JOB`; those that draw write the file `out.svg`.
const READERS: [&str; 11] = [
    "table results/s --json",
    "table results/s --json --where mass_flow_rate>0",
    "job JOB results/s --all --json",
    "job JOB results/s --history --format csv",
    "job JOB results/s --json",
    "status results/s --json",
    "compare results/s --by mass_flow_rate --base 0.002 --json",
    "chart results/s --history z_rim --jobs JOB --out out.svg",
    "chart results/s --measure peak_vz --over mass_flow_rate --out out.svg",
    "frames JOB results/s --out out.svg",
    "plan s.json --summary",
];

/// What `status --json` prints for a sound folder.
const NO_FINDINGS: &str = "\"findings\":[]";

/// An answer: stdout, the picture, stderr.
#[derive(PartialEq)]
pub struct Answer {
    stdout: String,
    picture: Vec<u8>,
    stderr: String,
}

/// The answers for an undamaged folder.
pub struct Answers(BTreeMap<&'static str, Answer>);

impl Answer {
    /// What a reader of the answer and of the picture reads.
    fn text(&self) -> String {
        format!("{}{}", self.stdout, String::from_utf8_lossy(&self.picture))
    }
}

fn ask(place: &Place, reader: &'static str, job: &str) -> (Finish, Answer) {
    let picture = place.join("out.svg");
    let _ = fs::remove_file(&picture);
    let words: Vec<String> = reader.split(' ').map(|word| word.replace("JOB", job)).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let finish = program::run(place, &words);
    let picture = fs::read(picture).unwrap_or_default();
    let answer = Answer { stdout: finish.stdout.clone(), picture, stderr: finish.stderr.clone() };
    (finish, answer)
}

impl Answers {
    /// Asks every reader about an undamaged folder, twice: the answers must not change by themselves.
    pub fn of(place: &Place, job: &str) -> Result<Self, String> {
        let mut answers = BTreeMap::new();
        for reader in READERS {
            let (finish, answer) = ask(place, reader, job);
            if !finish.succeeded() || ask(place, reader, job).1 != answer {
                return Err(format!("{reader} on an undamaged folder: {}", finish.said()));
            }
            answers.insert(reader, answer);
        }
        Ok(Self(answers))
    }

    /// Asks every reader about a damaged folder: the same answer, or a report of the damage.
    pub fn compare(&self, trial: &mut Trial, place: &Place, job: &str) {
        for (reader, right) in &self.0 {
            let (finish, answer) = ask(place, reader, job);
            if !finish.succeeded() {
                trial.count("refusals of readers", 1);
                finish.check_refusal(trial, reader, &[1, 2]);
                continue;
            }
            let same = answer.stdout == right.stdout && answer.picture == right.picture;
            let warned = answer.stderr != right.stderr || reports(&answer.text(), &right.text());
            if !same && !warned {
                trial.fault(Fault::SilentlyWrong, format!("{reader}: another answer, no warning"));
            } else if !same {
                trial.count("answers with a warning", 1);
            }
        }
    }
}

/// Whether an answer itself names the damage, or says that a job has not run.
fn reports(answer: &str, right: &str) -> bool {
    let more = |word: &str| answer.matches(word).count() > right.matches(word).count();
    let lists_findings = right.contains(NO_FINDINGS) && !answer.contains(NO_FINDINGS);
    lists_findings || ["pending", "doctor", "damage", "next:", "checksum"].into_iter().any(more)
}

/// Adds a fault if the table shows a number of an ended job that is not the true one.
pub fn check_table(trial: &mut Trial, place: &Place, truth: &[Value], when: &str) {
    let rows = match check::rows(place) {
        Ok(rows) => rows,
        Err(finish) => return finish.check_refusal(trial, "table", &[2]),
    };
    for row in rows.iter().filter(|row| row["status"] != "pending") {
        let job = row["job"].as_str().unwrap_or("?");
        if !truth.contains(row) {
            let text = format!("{when}: the table has another row of job {job}");
            trial.fault(Fault::SilentlyWrong, text);
        }
    }
}
