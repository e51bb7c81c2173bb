//! Signals that ask a run to stop: exit code, time to the end, and the same bits after a resume.

use std::time::{Duration, Instant};

use serde_json::Value;

use super::kill9::finish_study;
use crate::harness::check::Truth;
use crate::harness::place::Place;
use crate::harness::program::{self, HANG, Running};
use crate::harness::random::Random;
use crate::harness::studies;
use crate::harness::trial::{Fault, Kind, Trial};

/// Signals: name, number.
const SIGNALS: [(&str, i32); 4] = [("TERM", 15), ("INT", 2), ("HUP", 1), ("USR1", 10)];
/// Trials of each study that is resumed to its end.
const RESUMED: usize = 32;
/// Trials of each study that is too long to resume.
const LONG: usize = 4;
/// Jobs of the large study.
const LARGE_JOBS: u32 = 20_000;
/// Subdivisions of the fine mesh.
const FINE: u32 = 40;
/// Longest time from the signal to the end: the promise of the program.
const LIMIT: Duration = Duration::from_secs(2);

/// A study, its result, and the time of its run.
struct Subject {
    name: &'static str,
    study: Value,
    truth: Option<Truth>,
    time: Duration,
}

/// The kind.
pub struct Signals {
    subjects: Vec<Subject>,
}

/// Runs the short studies undisturbed.
pub fn prepare(place: &Place) -> Result<Signals, String> {
    let mut subjects = Vec::new();
    for (name, study) in [("many short jobs", studies::mixed()), ("film jobs", studies::film())] {
        let place = place.with_path(&place.join(name));
        std::fs::create_dir_all(place.path()).map_err(|error| error.to_string())?;
        place.write_study(&study);
        let started = Instant::now();
        let truth = Some(Truth::of_run(&place)?);
        subjects.push(Subject { name, study, truth, time: started.elapsed() });
    }
    for (name, study) in
        [("20,000 jobs", studies::large(LARGE_JOBS)), ("fine mesh", studies::fine(FINE))]
    {
        subjects.push(Subject { name, study, truth: None, time: Duration::from_secs(6) });
    }
    Ok(Signals { subjects })
}

impl Kind for Signals {
    fn trials(&self) -> usize {
        2 * RESUMED + 2 * LONG
    }

    fn limit(&self) -> Duration {
        LIMIT
    }

    fn trial(&self, number: usize, random: &mut Random, place: &Place) -> Trial {
        let subject = if number < 2 * RESUMED { (number / 4) % 2 } else { 2 + (number / 2) % 2 };
        let subject = &self.subjects[subject];
        let (name, code) = SIGNALS[number % SIGNALS.len()];
        let mut trial = Trial::new(format!("SIG{name}, {}", subject.name));
        if name == "HUP" && hangup_ignored() {
            trial.skipped = Some("SIGHUP is ignored here, as under nohup".to_owned());
            return trial;
        }
        place.write_study(&subject.study);
        let command = program::billow(place, &studies::run_arguments());
        let mut running = program::start(place, command);
        wait_for_lock(place, &mut running);
        std::thread::sleep(subject.time.mul_f64(0.8 * random.fraction()));
        if running.has_ended() {
            trial.count("ended before the signal", 1);
        }
        let sent = Instant::now();
        running.signal(name);
        let finish = running.finish(HANG);
        let time = sent.elapsed();
        if finish.code != Some(0) {
            trial.time(time);
            trial.detected = true;
            if time > LIMIT {
                trial.fault(Fault::Slow, format!("{time:.1?} from the signal to the end"));
            }
            if finish.code != Some(128 + code) {
                let end = format!("code {:?}, signal {:?}", finish.code, finish.signal);
                trial.fault(
                    Fault::WrongMessage,
                    format!("{end}, expected exit code {}", 128 + code),
                );
            }
        }
        if let Some(truth) = &subject.truth {
            let last = studies::run(place);
            finish_study(&mut trial, place, truth, &last);
        } else {
            let doctor = program::run(place, &["doctor", "results/s"]);
            doctor.check_end(&mut trial, "doctor");
            if doctor.code == Some(1) && !doctor.stdout.contains("no results here") {
                trial.fault(Fault::Lost, format!("doctor: {}", doctor.said()));
            }
        }
        trial
    }

    fn note(&self) -> String {
        "time from the signal to the end".to_owned()
    }
}

/// Whether this process ignores SIGHUP; then so does every program that it starts.
fn hangup_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).is_ok_and(|mask| mask & 1 == 1))
}

/// Waits until the run has taken its lock: it then answers to signals.
fn wait_for_lock(place: &Place, running: &mut Running) {
    let lock = place.results().join("lock");
    while !lock.exists() && !running.has_ended() {
        std::thread::sleep(Duration::from_millis(1));
    }
}
