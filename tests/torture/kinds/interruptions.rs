//! A run that is interrupted: killed at random times, asked by a signal to stop, or disturbed at a system
//! call. Resumed, it gives the same bits.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::Prepared;
use crate::check::Truth;
use crate::program::{Finish, Place, RUN};
use crate::studies;

/// Kills of one trial, at most. After them the study runs undisturbed.
const MAX_KILLS: usize = 12;
/// Signals that ask a run to stop: name, number.
const SIGNALS: [(&str, i32); 4] = [("TERM", 15), ("INT", 2), ("HUP", 1), ("USR1", 10)];
/// Trials of each study that is resumed to its end, and of each that is too long to resume.
const RESUMED: usize = 32;
const LONG: usize = 4;

/// SIGKILL at random times of a run, resumed until the study is complete.
pub fn kill9(place: &Place) -> Result<Prepared, String> {
    let mut subjects = Vec::new();
    for (name, study) in [("many jobs", studies::mixed()), ("a search", studies::search())] {
        let place = place.within(name);
        let truth = Truth::of_run(&place, &study)?;
        // Once more, when everything is in the memory of the system.
        fs::remove_dir_all(place.results()).map_err(|error| error.to_string())?;
        subjects.push((name, study, truth, place.run(RUN).wall));
    }
    Ok(Prepared::new(60, move |trial, random, place| {
        let (name, study, truth, time) = &subjects[trial.number % subjects.len()];
        trial.what = format!("kill -9 at random times, {name}");
        place.write_study(study);
        for _ in 0..MAX_KILLS {
            let running = place.start(place.billow(RUN));
            sleep(time.mul_f64(0.8 * random.fraction()));
            running.signal("KILL");
            let finish = running.finish();
            if finish.hung || finish.signal != Some(9) {
                trial.check("run", &finish, &[]);
                break;
            }
            trial.count("kills", 1);
        }
        truth.finish(trial, place);
    }))
}

/// Signals that ask a run to stop: exit code, time to the end, and the same bits after a resume.
pub fn signals(place: &Place) -> Result<Prepared, String> {
    let mut subjects = Vec::new();
    for (name, study) in [("many short jobs", studies::mixed()), ("film jobs", studies::film())] {
        let started = Instant::now();
        let truth = Some(Truth::of_run(&place.within(name), &study)?);
        subjects.push((name, study, truth, started.elapsed()));
    }
    for (name, study) in [("20,000 jobs", studies::large()), ("fine mesh", studies::fine())] {
        subjects.push((name, study, None, Duration::from_secs(6)));
    }
    Ok(Prepared::new(2 * RESUMED + 2 * LONG, move |trial, random, place| {
        let number = trial.number;
        let subject = if number < 2 * RESUMED { (number / 4) % 2 } else { 2 + (number / 2) % 2 };
        let (name, study, truth, time) = &subjects[subject];
        let (signal, code) = SIGNALS[number % SIGNALS.len()];
        trial.what = format!("SIG{signal}, {name}");
        place.write_study(study);
        // Under nohup SIGHUP is ignored.
        let run = format!("exec env --default-signal=HUP \"$0\" {RUN}");
        let mut running = place.start(place.shell(&run));
        running.wait_for_lock();
        sleep(time.mul_f64(0.8 * random.fraction()));
        if running.has_ended() {
            trial.count("ended before the signal", 1);
        }
        let sent = Instant::now();
        running.signal(signal);
        let finish = running.finish();
        if !finish.succeeded() {
            trial.time(sent.elapsed());
            trial.detected = true;
            trial.check("run", &finish, &[128 + code]);
        }
        // An orderly stop leaves nothing to repair.
        let doctor = trial.run(place, "doctor results/s", &[]);
        if doctor.code == Some(1) && !doctor.stdout.contains("no results here") {
            trial.fault(format!("doctor: {}", doctor.stdout));
        }
        if let Some(truth) = truth {
            truth.finish(trial, place);
        }
    }))
}

/// Letters of the calls that need an inode, and of those that open a file.
const CREATIONS: &str = "cm";
const OPENS: &str = "co";
/// Disturbances of one call, or of all from one call on: name, mode of `shim.c`, error, letters of the
/// calls (empty: all that change the disk).
const DISTURBANCES: [(&str, &str, i32, &str); 9] = [
    ("SIGKILL before call", "before", 0, ""),
    ("SIGKILL in the middle of write", "half", 0, ""),
    ("disk full from call", "from", 28, ""),
    ("EIO from call", "from", 5, ""),
    ("EIO of call", "once", 5, ""),
    ("quota exceeded from call", "from", 122, ""),
    ("EINTR and short writes from call", "short", 0, ""),
    ("no inodes from creation", "from", 28, CREATIONS),
    ("EMFILE from open", "from", 24, OPENS),
];

/// A run is disturbed at every system call that changes the disk: killed before the call or in the
/// middle of a write, or refused by the system. `shim.c` says how.
pub fn system_calls(place: &Place) -> Result<Prepared, String> {
    let (source, shim) = (place.join("shim.c"), place.join("shim.so"));
    place.write("shim.c", include_bytes!("../shim.c"));
    let mut compiler = Command::new("cc");
    compiler.args(["-O1", "-shared", "-fPIC", "-o"]).arg(&shim).arg(&source).arg("-ldl");
    if !compiler.status().is_ok_and(|status| status.success()) {
        return Err("cc is needed, to disturb system calls".to_owned());
    }
    place.write_study(&studies::small());
    let letters_of = |kinds: &str| {
        let _ = fs::remove_dir_all(place.results());
        let (finish, letters) = disturbed(place, &shim, ("", "count", 0, kinds), 0);
        let problem = || format!("the counted run failed: {}", finish.said());
        finish.succeeded().then_some(letters).ok_or_else(problem)
    };
    let (creations, opens, all) = (letters_of(CREATIONS)?, letters_of(OPENS)?, letters_of("")?);
    let truth = Truth::read(place)?;
    let mut places = Vec::new();
    for disturbance in DISTURBANCES {
        let (_, mode, error, kinds) = disturbance;
        let calls = match kinds {
            CREATIONS => &creations,
            OPENS => &opens,
            _ => &all,
        };
        let chosen = (1..=calls.len()).filter(|at| match (mode, error) {
            ("half", _) => calls[at - 1] == b'w',
            ("short", _) => at % 7 == 1,
            (_, 122) => at % 3 == 0,
            _ => true,
        });
        places.extend(chosen.map(|at| (disturbance, at)));
    }
    Ok(Prepared::new(places.len(), move |trial, _, place| {
        let (disturbance, at) = places[trial.number];
        let (name, mode, ..) = disturbance;
        trial.what = format!("{name} {at}");
        place.write_study(&studies::small());
        let (finish, _) = disturbed(place, &shim, disturbance, at);
        trial.time(finish.wall);
        match mode {
            "before" | "half" if finish.signal == Some(9) && !finish.hung => {}
            "short" => trial.check("run", &finish, &[0]),
            "from" | "once" => trial.check("run", &finish, &[0, 2]),
            _ => trial.check("run", &finish, &[]),
        }
        trial.detected = finish.code == Some(2);
        let names = ["s.json", "results/s", "results:"];
        if trial.detected && !names.iter().any(|name| finish.stderr.contains(name)) {
            trial.fault(format!("run: no path: {}", finish.said()));
        }
        truth.finish(trial, place);
    }))
}

/// Runs the study of a place under the library, on one thread; the letters of the calls that it counts.
fn disturbed(
    place: &Place,
    shim: &Path,
    (_, mode, error, kinds): (&str, &str, i32, &str),
    at: usize,
) -> (Finish, Vec<u8>) {
    let log = place.join("calls");
    let _ = fs::remove_file(&log);
    let mut command = place.billow("run s.json --quiet --threads 1");
    command.env("LD_PRELOAD", shim).env("TORTURE_LOG", &log);
    command.env("TORTURE_MODE", mode).env("TORTURE_KINDS", kinds);
    command.env("TORTURE_AT", at.to_string()).env("TORTURE_ERRNO", error.to_string());
    let finish = place.start(command).finish();
    let log = fs::read(&log).unwrap_or_default().into_iter();
    (finish, log.skip(8).take_while(|letter| *letter != 0).collect())
}
