//! Little memory (`ulimit -v`): a study goes on without the jobs that do not fit, a resume runs nothing
//! again, and no command aborts without a message.

use std::time::Duration;

use serde_json::{Value, json};

use crate::harness::check;
use crate::harness::place::Place;
use crate::harness::program::{self, Finish};
use crate::harness::random::Random;
use crate::harness::studies;
use crate::harness::trial::{Fault, Kind, Trial};

/// Limits of the address space, MB.
const LIMITS: [u32; 12] = [120, 160, 200, 260, 350, 500, 700, 1000, 1400, 1800, 2400, 3000];
/// Address space that the program needs for small jobs, MB: below, a message is enough.
const NEEDED: u32 = 260;
/// Time after which a command counts as hanging.
const LIMIT: Duration = Duration::from_mins(3);

/// Studies with small jobs and a large one: the axis of each.
const LOADS: [(&str, [u32; 3]); 2] = [("subdivisions", [2, 200, 3]), ("M", [3, 300, 2])];

/// The kind.
pub struct Memory;

fn study((axis, values): (&str, [u32; 3])) -> Value {
    let mut study = studies::small();
    study["solver"] = json!({ "model": "film", "end_time": "5 ms" });
    study["design"]["N"] = json!(6);
    study["gas"] = json!({ "mass_flow_rate": "1 g/s" });
    study["grid"] = json!({ axis: values });
    study
}

impl Kind for Memory {
    fn trials(&self) -> usize {
        LOADS.len() * LIMITS.len()
    }

    fn limit(&self) -> Duration {
        LIMIT
    }

    fn parallel(&self) -> bool {
        false
    }

    fn trial(&self, number: usize, _: &mut Random, place: &Place) -> Trial {
        let limit = LIMITS[number / LOADS.len()];
        let load = LOADS[number % LOADS.len()];
        let mut trial = Trial::new(format!("{load:?} with {limit} MB"));
        place.write_study(&study(load));
        let finish = limited(place, limit, &studies::run_arguments());
        note_end(&mut trial, "run", &finish, limit, &[0, 1, 2]);
        if matches!(finish.code, Some(0 | 1)) {
            check_study(&mut trial, place, limit);
        } else if finish.code == Some(2) && limit >= NEEDED {
            trial.fault(Fault::Lost, format!("no job of the study runs: {}", finish.said()));
        }
        trial
    }
}

/// A finished study: small jobs done, the others typed rows, and nothing runs again.
fn check_study(trial: &mut Trial, place: &Place, limit: u32) {
    let rows = check::rows(place).unwrap_or_default();
    let count = |status: &str| rows.iter().filter(|row| row["status"] == status).count();
    let (done, refused, failed) = (count("done"), count("out_of_memory"), count("infeasible"));
    trial.count("rows out_of_memory", refused);
    if rows.len() != 3 || done + refused + failed != 3 {
        let statuses: Vec<&Value> = rows.iter().map(|row| &row["status"]).collect();
        trial.fault(Fault::Lost, format!("rows: {statuses:?}"));
    }
    let again = limited(place, limit, &studies::run_arguments());
    note_end(trial, "run again", &again, limit, &[0, 1]);
    if !again.stdout.contains("nothing to run") {
        trial.fault(Fault::RunTwice, format!("the second run: {}", again.said()));
    }
    let doctor = program::run(place, &["doctor", "results/s"]);
    if !doctor.succeeded() {
        trial.fault(Fault::WrongMessage, format!("doctor: {}", doctor.said()));
    }
}

fn limited(place: &Place, megabytes: u32, arguments: &[&str]) -> Finish {
    let limits = format!("-v {}", megabytes * 1000);
    program::start(place, program::limited(place, &limits, arguments)).finish(LIMIT)
}

/// Adds the faults of an end. Below the need of the program itself a message is enough.
fn note_end(trial: &mut Trial, command: &str, finish: &Finish, limit: u32, codes: &[i32]) {
    trial.time(finish.wall);
    trial.detected |= finish.code != Some(0);
    let message = finish.stderr.contains("memory") || finish.stderr.contains("cannot allocate");
    if limit < NEEDED && finish.code != Some(0) && message && !finish.hung {
        return trial.count("below the need of the program, with a message", 1);
    }
    finish.check_refusal(trial, command, codes);
}
