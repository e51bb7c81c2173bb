//! SIGKILL at random times of a run, resumed until the study is complete.

use std::time::Duration;

use crate::harness::check::{self, Truth};
use crate::harness::place::Place;
use crate::harness::program::{self, HANG};
use crate::harness::random::Random;
use crate::harness::studies;
use crate::harness::trial::{Fault, Kind, Trial};

/// Number of trials: each is one study with several kills.
const TRIALS: usize = 60;
/// Kills of one trial, at most. After them the study runs undisturbed.
const MAX_KILLS: usize = 12;

/// The kind.
pub struct Kill9 {
    truth: Truth,
    /// Time of an undisturbed run.
    time: Duration,
}

/// Runs the study undisturbed.
pub fn prepare(place: &Place) -> Result<Kill9, String> {
    place.write_study(&studies::mixed());
    let truth = Truth::of_run(place)?;
    // Once more, when everything is in the memory of the system.
    std::fs::remove_dir_all(place.results()).map_err(|error| error.to_string())?;
    let time = studies::run(place).wall;
    Ok(Kill9 { truth, time })
}

impl Kind for Kill9 {
    fn trials(&self) -> usize {
        TRIALS
    }

    fn limit(&self) -> Duration {
        HANG
    }

    fn trial(&self, _: usize, random: &mut Random, place: &Place) -> Trial {
        let mut trial = Trial::new("kill -9 at random times");
        place.write_study(&studies::mixed());
        let mut kills = 0;
        let finish = loop {
            let command = program::billow(place, &studies::run_arguments());
            let mut running = program::start(place, command);
            if kills < MAX_KILLS {
                std::thread::sleep(self.time.mul_f64(0.8 * random.fraction()));
                running.kill();
            }
            let finish = running.finish(HANG);
            if finish.signal != Some(9) {
                break finish;
            }
            kills += 1;
        };
        trial.count("kills", kills);
        finish_study(&mut trial, place, &self.truth, &finish);
        trial
    }
}

/// Checks a study after its last run, and brings quarantined jobs back.
pub fn finish_study(trial: &mut Trial, place: &Place, truth: &Truth, last: &program::Finish) {
    last.check_end(trial, "run");
    let rows = check::rows(place).unwrap_or_default();
    let crashed = rows.iter().filter(|row| row["status"] == "crashed").count();
    if crashed > 0 {
        trial.count("jobs quarantined and brought back", crashed);
        let arguments = ["run", "results/s", "--again", "crashed", "--quiet"];
        let finish = program::run(place, &arguments);
        finish.check_end(trial, "run --again crashed");
        if !finish.succeeded() {
            trial.fault(Fault::WrongMessage, format!("run --again: {}", finish.said()));
        }
    } else if !last.hung && last.code != Some(0) {
        trial.fault(Fault::Lost, format!("the last run ended with {}", last.said()));
    }
    check::compare(trial, place, truth);
    check::compare_journal(trial, place);
}
