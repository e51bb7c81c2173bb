//! A machine that gives little: a small disk, little memory.

use std::fs;

use serde_json::{Value, json};

use super::Prepared;
use crate::check::{self, Truth};
use crate::program::{Finish, Place, RUN};
use crate::studies;
use crate::trial::Trial;

/// Small disks: bytes and inodes of a tmpfs. The study needs less than the last of each.
const SIZES: [&str; 10] = ["4k", "12k", "20k", "40k", "80k", "120k", "200k", "280k", "360k", "1m"];
const INODES: [u32; 8] = [2, 4, 6, 8, 10, 14, 20, 60];

/// A real disk that is full or without inodes. It needs user namespaces.
pub fn disk(place: &Place) -> Result<Prepared, String> {
    let truth = Truth::of_run(place, &studies::small())?;
    let sizes = SIZES.iter().map(|size| format!("size={size}"));
    let inodes = INODES.iter().map(|number| format!("nr_inodes={number}"));
    let disks: Vec<String> = sizes.chain(inodes).collect();
    Ok(Prepared::new(disks.len(), move |trial, _, place| {
        trial.what.clone_from(&disks[trial.number]);
        place.write_study(&studies::small());
        fs::create_dir(place.join("results")).expect("a folder of a trial");
        let mount = format!("mount -t tmpfs -o {} none results", trial.what);
        // What was stored is then copied to a disk with space.
        let script = format!(
            "\"$0\" {RUN}; code=$?; [ ! -d results/s ] || cp -a results/s stored; exit $code"
        );
        let Some(finish) = place.run_mounted(&mount, &script) else {
            return trial.skip("no right to mount a tmpfs");
        };
        trial.time(finish.wall);
        trial.detected = finish.code == Some(2);
        trial.check("run", &finish, &[0, 2]);
        if trial.detected && !finish.stderr.contains("No space left on device") {
            trial.fault(format!("run names another cause: {}", finish.said()));
        }
        if place.join("stored").is_dir() {
            fs::rename(place.join("stored"), place.results()).expect("the stored files");
        }
        truth.finish(trial, place);
    }))
}

/// Limits of the address space, MB.
const LIMITS: [u32; 12] = [120, 160, 200, 260, 350, 500, 700, 1000, 1400, 1800, 2400, 3000];
/// Address space that the program needs for small jobs, MB: below, a message is enough.
const NEEDED: u32 = 260;
/// Studies with small jobs and a large one: the axis of each.
const LOADS: [(&str, [u32; 3]); 2] = [("subdivisions", [2, 200, 3]), ("M", [3, 300, 2])];

/// Little memory (`ulimit -v`): a study goes further without the jobs that do not fit, and a resume runs
/// nothing again.
pub fn memory() -> Prepared {
    Prepared::new(LIMITS.len() * LOADS.len(), move |trial, _, place| {
        let limit = LIMITS[trial.number / LOADS.len()];
        let (axis, values) = LOADS[trial.number % LOADS.len()];
        trial.what = format!("{axis} {values:?} with {limit} MB");
        let mut study = studies::small();
        study["solver"] = json!({ "model": "film", "end_time": "5 ms" });
        study["design"]["N"] = json!(6);
        study["gas"] = json!({ "mass_flow_rate": "1 g/s" });
        study["grid"] = json!({ axis: values });
        place.write_study(&study);
        let finish = run(trial, place, limit, &[0, 1, 2]);
        match finish.code {
            Some(0 | 1) => check_study(trial, place, limit),
            Some(2) if limit >= NEEDED => {
                trial.fault(format!("no job of the study runs: {}", finish.said()));
            }
            _ => {}
        }
    })
}

/// A finished study: small jobs done, the others typed rows, and nothing runs again.
fn check_study(trial: &mut Trial, place: &Place, limit: u32) {
    let rows = check::rows(place).unwrap_or_default();
    let statuses: Vec<&Value> = rows.iter().map(|row| &row["status"]).collect();
    let refused = statuses.iter().filter(|status| **status == "out_of_memory").count();
    trial.count("rows out_of_memory", refused);
    let others = statuses.iter().filter(|status| **status == "done" || **status == "infeasible");
    if rows.len() != 3 || others.count() + refused != 3 {
        trial.fault(format!("lost: rows {statuses:?}"));
    }
    let again = run(trial, place, limit, &[0, 1]);
    if !again.stdout.contains("nothing to run") {
        trial.fault(format!("jobs run twice: {}", again.said()));
    }
    trial.run(place, "doctor results/s", &[0]);
}

/// Runs the study with little memory. Below the need of the program itself a message is enough.
fn run(trial: &mut Trial, place: &Place, limit: u32, codes: &[i32]) -> Finish {
    let finish = place.start(place.limited(limit, RUN)).finish();
    trial.time(finish.wall);
    trial.detected |= !finish.succeeded();
    let message = finish.stderr.contains("memory") || finish.stderr.contains("cannot allocate");
    if limit < NEEDED && !finish.succeeded() && message && !finish.hung {
        trial.count("below the need of the program, with a message", 1);
    } else {
        trial.check("run", &finish, codes);
    }
    finish
}
