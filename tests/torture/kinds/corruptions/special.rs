//! Damages that need a running program, or a lock that is something else.

use std::fs;
use std::os::unix::fs::symlink;
use std::process::Command;
use std::time::Duration;

use super::Corruptions;
use crate::harness::place::Place;
use crate::harness::program::{self, BILLOW, HANG};
use crate::harness::studies;
use crate::harness::trial::{Fault, Trial};

/// Number of these trials.
pub const NUMBER: usize = 7;

/// Makes the trial of that number.
pub fn trial(kind: &Corruptions, number: usize, place: &Place) -> Trial {
    match number {
        0 => lock_is_a_link(kind, place),
        1 => lock_is_a_folder(kind, place),
        2 => read_only(kind, place),
        _ => deleted_during_a_run(place, number - 3),
    }
}

/// The lock links to a file of the user, which must stay as it is.
fn lock_is_a_link(kind: &Corruptions, place: &Place) -> Trial {
    let mut trial = Trial::new("lock: a link to another file");
    let place = kind.copy(place, "damaged");
    let lock = place.results().join("lock");
    place.write("precious", b"precious");
    fs::remove_file(&lock).and_then(|()| symlink(place.join("precious"), &lock)).expect("a link");
    fs::remove_file(place.results().join("summary.parquet")).expect("a table");
    let finish = studies::run(&place);
    trial.detected = !finish.succeeded();
    finish.check_refusal(&mut trial, "run", &[0, 2]);
    if fs::read(place.join("precious")).unwrap_or_default() != b"precious" {
        trial.fault(Fault::Lost, "run changed the file that the lock links to");
    }
    let missing = place.join("missing");
    let _ = fs::remove_file(&lock);
    symlink(&missing, &lock).expect("a link");
    studies::run(&place).check_refusal(&mut trial, "run", &[0, 2]);
    if missing.exists() {
        trial.fault(Fault::Lost, "run created the file that the lock links to");
    }
    let _ = fs::remove_file(&lock);
    kind.check_repair(&mut trial, &place, super::Expect::Harmless);
    trial
}

fn lock_is_a_folder(kind: &Corruptions, place: &Place) -> Trial {
    let mut trial = Trial::new("lock: a folder");
    let place = kind.copy(place, "damaged");
    let lock = place.results().join("lock");
    fs::remove_file(&lock).and_then(|()| fs::create_dir(&lock)).expect("a folder");
    trial.detected = true;
    studies::run(&place).check_refusal(&mut trial, "run", &[2]);
    program::run(&place, &["table", "results/s"]).check_refusal(&mut trial, "table", &[0, 2]);
    program::run(&place, &["doctor", "results/s"]).check_refusal(&mut trial, "doctor", &[0, 1]);
    fs::remove_dir(&lock).expect("the folder");
    kind.check_repair(&mut trial, &place, super::Expect::Harmless);
    trial
}

/// A folder on a disk that is mounted read-only.
fn read_only(kind: &Corruptions, place: &Place) -> Trial {
    let mut trial = Trial::new("folder read-only");
    let place = kind.copy(place, "damaged");
    let script = "mount --bind results results && mount -o remount,ro,bind results || exit 99
        \"$0\" table results/s --json > table.json || exit 98
        \"$0\" doctor results/s > /dev/null || exit 97
        \"$0\" run s.json --quiet --set solver.end_time=0.02";
    let mut command = Command::new("unshare");
    command.args(["--map-root-user", "--mount", "sh", "-c", script, BILLOW]);
    command.current_dir(place.path());
    let finish = program::start(&place, command).finish(HANG);
    if matches!(finish.code, Some(1 | 99)) {
        trial.skipped = Some("no right to mount a folder read-only".to_owned());
        return trial;
    }
    trial.detected = true;
    finish.check_refusal(&mut trial, "run", &[2]);
    kind.check_end(&mut trial, &place, "after a refused run");
    trial
}

/// The results folder is deleted during a run, after a while.
fn deleted_during_a_run(place: &Place, number: usize) -> Trial {
    let mut trial = Trial::new("results folder deleted during a run");
    place.write_study(&studies::film());
    let mut running = program::start(place, program::billow(place, &studies::run_arguments()));
    let lock = place.results().join("lock");
    while !lock.exists() && !running.has_ended() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let pause = [5, 100, 300, 500];
    std::thread::sleep(Duration::from_millis(pause[number % pause.len()]));
    let moved = place.join("moved");
    // Deleted, or moved away: the run must not write into a folder that is not its own.
    let taken = if number.is_multiple_of(2) {
        fs::remove_dir_all(place.results())
    } else {
        fs::rename(place.results(), &moved)
    };
    if taken.is_err() || running.has_ended() {
        trial.skipped = Some("the run ended before".to_owned());
        return trial;
    }
    let finish = running.finish(HANG);
    trial.detected = finish.code == Some(2);
    finish.check_refusal(&mut trial, "run", &[2]);
    if place.results().exists() && !place.results().join("study.json").exists() {
        trial.fault(Fault::Lost, "the run wrote into a folder without study.json");
    }
    trial
}
