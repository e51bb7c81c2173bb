//! Changed files of a finished results folder. Every reader must give the right answer or report the
//! damage, `doctor` must find it, what it advises must help, and `doctor --repair` and `run` must bring
//! back the same bits.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use serde_json::Value;

use crate::harness::check::{self, Truth};
use crate::harness::place::Place;
use crate::harness::program::{self, Finish, HANG};
use crate::harness::random::Random;
use crate::harness::studies;
use crate::harness::trial::{Fault, Kind, Trial};

mod advice;
mod damages;
mod readers;
mod special;

use damages::{Damage, Expect, Target};
use readers::Answers;

/// The kind.
pub struct Corruptions {
    template: Place,
    other: PathBuf,
    truth: Truth,
    answers: Answers,
    jobs: Vec<String>,
    damages: Vec<Damage>,
    /// Index of the damage of each trial.
    numbers: Vec<usize>,
}

/// Runs two studies undisturbed and asks every reader.
pub fn prepare(place: &Place) -> Result<Corruptions, String> {
    let folder = |name: &str, study: &Value| {
        let folder = place.with_path(&place.join(name));
        fs::create_dir_all(folder.path()).map_err(|error| error.to_string())?;
        folder.write_study(study);
        Ok::<Place, String>(folder)
    };
    let other = folder("other", &studies::film())?;
    Truth::of_run(&other)?;
    let template = folder("template", &studies::small())?;
    let truth = Truth::of_run(&template)?;
    let jobs = truth.jobs();
    // The film jobs are the last ones.
    let film = jobs.last().ok_or("no job has a history")?;
    let answers = Answers::of(&template, film)?;
    let damages = damages::all();
    let trials = damages.iter().enumerate();
    let numbers = trials.flat_map(|(index, damage)| vec![index; damage.trials]).collect();
    let other = other.results();
    Ok(Corruptions { template, other, truth, answers, jobs, damages, numbers })
}

impl Kind for Corruptions {
    fn trials(&self) -> usize {
        self.numbers.len() + special::NUMBER
    }

    fn limit(&self) -> Duration {
        HANG
    }

    fn trial(&self, number: usize, random: &mut Random, place: &Place) -> Trial {
        let Some(index) = self.numbers.get(number) else {
            return special::trial(self, number - self.numbers.len(), place);
        };
        let damage = &self.damages[*index];
        let mut trial = Trial::new(damage.name.clone());
        let damaged = self.copy(place, "damaged");
        if (damage.apply)(&self.target(&damaged), random).is_none() {
            trial.skipped = Some(format!("not possible here: {}", damage.name));
            return trial;
        }
        let copy = |name: &str| {
            let copied = place.with_path(&place.join(name));
            fs::create_dir_all(copied.path()).expect("a folder of a trial");
            copied.copy_from(&damaged);
            copied
        };
        let (advised, resumed) = (copy("advised"), copy("resumed"));
        self.check_readers(&mut trial, &damaged);
        self.check_doctor(&mut trial, &damaged, &advised, damage.expect);
        self.check_run(&mut trial, &resumed, damage.expect);
        self.check_repair(&mut trial, &damaged, damage.expect);
        trial
    }
}

impl Corruptions {
    /// A copy of the finished folder in a place.
    fn copy(&self, place: &Place, name: &str) -> Place {
        let copied = place.with_path(&place.join(name));
        fs::create_dir_all(copied.path()).expect("a folder of a trial");
        copied.copy_from(&self.template);
        copied
    }

    fn target(&self, place: &Place) -> Target {
        let last = self.jobs.len() - 1;
        Target {
            results: place.results(),
            other: self.other.clone(),
            job: self.jobs[last].clone(),
            second: self.jobs[last - 1].clone(),
        }
    }

    fn check_readers(&self, trial: &mut Trial, place: &Place) {
        let job = &self.target(place).job;
        self.answers.compare(trial, place, job);
        readers::check_table(trial, place, &self.truth.rows, "before a repair");
    }

    /// `doctor` finds the damage, and what it advises helps.
    fn check_doctor(&self, trial: &mut Trial, place: &Place, advised: &Place, expect: Expect) {
        let doctor = program::run(place, &["doctor", "results/s", "--json"]);
        doctor.check_end(trial, "doctor");
        trial.detected = doctor.code == Some(1);
        match (expect, doctor.code) {
            (_, Some(1)) | (Expect::Harmless, Some(0)) => {}
            (_, Some(0)) => trial.fault(Fault::SilentlyWrong, "doctor calls the folder sound"),
            _ => trial.fault(Fault::WrongMessage, format!("doctor: {}", doctor.said())),
        }
        if expect == Expect::OtherVersion {
            return;
        }
        advice::check(trial, advised, &doctor.stdout);
        // A repair leaves jobs pending.
        check_success(trial, &studies::run(advised), "run after the advice");
        let text = format!("as doctor advises ({})", advice::said(&doctor.stdout));
        self.check_end(trial, advised, &text);
    }

    /// `run` refuses, or gives the right table.
    fn check_run(&self, trial: &mut Trial, place: &Place, expect: Expect) {
        let finish = studies::run(place);
        if finish.succeeded() && expect != Expect::OtherVersion {
            readers::check_table(trial, place, &self.truth.rows, "after run");
            if check::rows(place).is_ok_and(|rows| rows != self.truth.rows) {
                trial.fault(Fault::Lost, "after run: the table is not the original one");
            }
        } else {
            trial.count("refusals of run", 1);
            finish.check_refusal(trial, "run", &[2]);
            readers::check_table(trial, place, &self.truth.rows, "after a refused run");
        }
    }

    /// `doctor --repair` and `run` bring back everything.
    fn check_repair(&self, trial: &mut Trial, place: &Place, expect: Expect) {
        let repair = program::run(place, &["doctor", "--repair", "results/s"]);
        if expect == Expect::OtherVersion {
            return repair.check_refusal(trial, "doctor --repair", &[1, 2]);
        }
        repair.check_refusal(trial, "doctor --repair", &[0, 1]);
        readers::check_table(trial, place, &self.truth.rows, "after the repair");
        let finish = studies::run(place);
        check_success(trial, &finish, "run after the repair");
        self.check_end(trial, place, "after repair and run");
    }

    /// The folder is whole again.
    fn check_end(&self, trial: &mut Trial, place: &Place, when: &str) {
        let mut found = Trial::default();
        check::compare(&mut found, place, &self.truth);
        for (fault, text) in found.faults {
            trial.fault(fault, format!("{when}: {text}"));
        }
    }
}

fn check_success(trial: &mut Trial, finish: &Finish, command: &str) {
    finish.check_end(trial, command);
    if finish.code.is_some_and(|code| code != 0) {
        trial.fault(Fault::Lost, format!("{command}: {}", finish.said()));
    }
}
