//! Changed files of a finished results folder. Every reader must give the right answer or report the
//! damage, `doctor` must find it, what it advises must help, and `doctor --repair` and `run` must bring
//! back the same bits.

use std::fs;
use std::path::PathBuf;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use super::Prepared;
use super::damages::{DAMAGES, Expect, Row, Target};
use crate::check::{self, Truth};
use crate::program::{Finish, Place, RUN};
use crate::random::Random;
use crate::studies;
use crate::trial::Trial;

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
    "plan s.json",
];
/// What `status --json` prints for a sound folder.
const NO_FINDINGS: &str = "\"findings\":[]";
/// Words by which an answer itself names a damage, or says that a job has not run.
const REPORTS: [&str; 5] = ["pending", "doctor", "damage", "next:", "checksum"];
/// Trials that need more than a changed file.
const SPECIAL: [fn(&Corruptions, &mut Trial, &Place); 7] = [
    lock_is_a_folder,
    same_process_id,
    read_only,
    |_, trial, place| taken_during_a_run(trial, place, 5, false),
    |_, trial, place| taken_during_a_run(trial, place, 100, true),
    |_, trial, place| taken_during_a_run(trial, place, 300, false),
    |_, trial, place| taken_during_a_run(trial, place, 500, true),
];

struct Corruptions {
    template: PathBuf,
    other: PathBuf,
    truth: Truth,
    /// What each reader says about the undamaged folder: stdout with the picture, and stderr.
    answers: Vec<[String; 2]>,
    /// The last two film jobs.
    jobs: [String; 2],
}

/// Runs two studies undisturbed and asks every reader, twice: the answers must not change by themselves.
pub fn prepare(place: &Place) -> Result<Prepared, String> {
    let (other, template) = (place.within("other"), place.within("template"));
    Truth::of_run(&other, &studies::film())?;
    let truth = Truth::of_run(&template, &studies::small())?;
    let jobs = truth.jobs();
    let [.., second, job] = &jobs[..] else { return Err("no job has a history".to_owned()) };
    let mut answers = Vec::new();
    for reader in READERS {
        let (finish, answer) = ask(&template, reader, job);
        if !finish.succeeded() || ask(&template, reader, job).1 != answer {
            return Err(format!("{reader} on an undamaged folder: {}", finish.said()));
        }
        answers.push(answer);
    }
    let rows =
        DAMAGES.iter().flat_map(|row| row.0.iter().flat_map(move |file| vec![(*file, row); row.3]));
    let rows: Vec<(&str, &Row)> = rows.collect();
    let (template, other) = (template.join(""), other.results());
    let jobs = [job.clone(), second.clone()];
    let kind = Corruptions { template, other, truth, answers, jobs };
    Ok(Prepared::new(rows.len() + SPECIAL.len(), move |trial, random, place| {
        match rows.get(trial.number) {
            Some((file, row)) => kind.trial(trial, random, place, file, row),
            None => SPECIAL[trial.number - rows.len()](&kind, trial, &kind.copy(place)),
        }
    }))
}

fn ask(place: &Place, reader: &str, job: &str) -> (Finish, [String; 2]) {
    let picture = place.join("out.svg");
    let _ = fs::remove_file(&picture);
    let finish = place.run(&reader.replace("JOB", job));
    let text = finish.stdout.clone() + &fs::read_to_string(picture).unwrap_or_default();
    let stderr = finish.stderr.clone();
    (finish, [text, stderr])
}

impl Corruptions {
    /// A copy of the finished folder.
    fn copy(&self, place: &Place) -> Place {
        let copied = place.within("damaged");
        copied.copy_from(&self.template);
        copied
    }

    fn trial(
        &self,
        trial: &mut Trial,
        random: &mut Random,
        place: &Place,
        file: &str,
        (_, how, expect, _, apply): &Row,
    ) {
        trial.what = format!("{file}: {how}");
        let damaged = self.copy(place);
        let target = Target {
            results: damaged.results(),
            other: self.other.clone(),
            job: self.jobs[0].clone(),
            second: self.jobs[1].clone(),
        };
        if apply(&target.path(file), &target, random).is_err() {
            return trial.skip(&format!("not possible here: {}", trial.what));
        }
        let [advised, resumed] = ["advised", "resumed"].map(|name| {
            let copied = place.within(name);
            copied.copy_from(&damaged.join(""));
            copied
        });
        self.check_readers(trial, &damaged);
        self.check_doctor(trial, &damaged, &advised, *expect);
        self.check_run(trial, &resumed, *expect);
        self.check_repair(trial, &damaged, *expect);
    }

    /// Every reader gives the same answer, or reports the damage.
    fn check_readers(&self, trial: &mut Trial, place: &Place) {
        for (reader, [right, warnings]) in READERS.iter().zip(&self.answers) {
            let (finish, [answer, said]) = ask(place, reader, &self.jobs[0]);
            if !finish.succeeded() {
                trial.count("refusals of readers", 1);
                trial.check(reader, &finish, &[1, 2]);
                continue;
            }
            if answer == *right {
                continue;
            }
            let more = |word| answer.matches(word).count() > right.matches(word).count();
            let lists = right.contains(NO_FINDINGS) && !answer.contains(NO_FINDINGS);
            if said != *warnings || lists || REPORTS.into_iter().any(more) {
                trial.count("answers with a warning", 1);
            } else {
                trial.fault(format!("silently wrong: {reader}: another answer, no warning"));
            }
        }
        self.truth.check_table(trial, place, "before a repair");
    }

    /// `doctor` finds the damage, and what it advises helps.
    fn check_doctor(&self, trial: &mut Trial, place: &Place, advised: &Place, expect: Expect) {
        let doctor = trial.run(place, "doctor results/s --json", &[0, 1]);
        trial.detected = doctor.code == Some(1);
        if doctor.succeeded() && expect != Expect::Harmless {
            trial.fault("silently wrong: doctor calls the folder sound");
        }
        if expect == Expect::OtherVersion {
            return;
        }
        follow_advice(trial, advised, &doctor.stdout);
        // A repair leaves jobs pending.
        trial.run(advised, RUN, &[0]);
        self.check_whole(trial, advised, "as doctor advises");
    }

    /// `run` refuses, or gives the right table.
    fn check_run(&self, trial: &mut Trial, place: &Place, expect: Expect) {
        let finish = place.run(RUN);
        if finish.succeeded() && expect != Expect::OtherVersion {
            self.truth.check_table(trial, place, "after run");
            if check::rows(place).is_ok_and(|rows| rows != self.truth.rows) {
                trial.fault("after run: the table is not the original one");
            }
        } else {
            trial.count("refusals of run", 1);
            trial.check("run", &finish, &[2]);
            self.truth.check_table(trial, place, "after a refused run");
        }
    }

    /// `doctor --repair` and `run` bring back everything.
    fn check_repair(&self, trial: &mut Trial, place: &Place, expect: Expect) {
        let other_version = expect == Expect::OtherVersion;
        let codes = if other_version { [1, 2] } else { [0, 1] };
        trial.run(place, "doctor --repair results/s", &codes);
        if !other_version {
            self.truth.check_table(trial, place, "after the repair");
            trial.run(place, RUN, &[0]);
            self.check_whole(trial, place, "after repair and run");
        }
    }

    /// The folder is whole again.
    fn check_whole(&self, trial: &mut Trial, place: &Place, when: &str) {
        let first = trial.faults.len();
        self.truth.compare(trial, place);
        for text in &mut trial.faults[first..] {
            *text = format!("{when}: {text}");
        }
    }
}

/// Does the next step of every finding, each once, in order: the commands in backquotes. Of "A, or B" only A.
fn follow_advice(trial: &mut Trial, place: &Place, findings: &str) {
    let findings: Vec<Value> = serde_json::from_str(findings).unwrap_or_default();
    let mut steps: Vec<&str> = Vec::new();
    for finding in &findings {
        match finding["next"].as_str() {
            None | Some("") => {
                trial.fault("doctor: a finding without a next step");
            }
            Some(step) if !steps.contains(&step) => steps.push(step),
            Some(_) => {}
        }
    }
    for step in steps.iter().filter(|step| !step.starts_with("nothing")) {
        let first = step.split(", or ").next().unwrap_or_default();
        for command in first.split('`').skip(1).step_by(2) {
            let finish = match command.split_whitespace().nth(1) {
                Some("run") => trial.run(place, RUN, &[]),
                Some("doctor") => trial.run(place, "doctor --repair results/s", &[]),
                _ => {
                    trial.fault(format!("doctor advises {command:?}"));
                    continue;
                }
            };
            if finish.code == Some(2) {
                let text = format!("doctor advises {command:?}: {}", finish.said());
                trial.fault(text);
            }
        }
    }
}

fn lock_is_a_folder(kind: &Corruptions, trial: &mut Trial, place: &Place) {
    "lock: a folder".clone_into(&mut trial.what);
    let lock = place.results().join("lock");
    fs::remove_file(&lock).and_then(|()| fs::create_dir(&lock)).expect("a folder");
    trial.detected = true;
    trial.run(place, RUN, &[2]);
    trial.run(place, "table results/s", &[0, 2]);
    trial.run(place, "doctor results/s", &[0, 1]);
    fs::remove_dir(&lock).expect("the folder");
    kind.check_repair(trial, place, Expect::Harmless);
}

/// A dead process with the id of this one left temporary files under every name that this one uses.
fn same_process_id(kind: &Corruptions, trial: &mut Trial, place: &Place) {
    "temporary files of a dead process with the same id".clone_into(&mut trial.what);
    let job = &kind.jobs[0];
    let folder = format!("results/s/jobs/{}", &job[..2]);
    fs::remove_file(place.join(&folder).join(format!("{job}.h5"))).expect("a history");
    fs::remove_file(place.results().join("summary.parquet")).expect("a table");
    // The shell replaces itself: the program has the id that the names hold.
    let script = format!(
        "for n in $(seq 0 40); do
          for name in study.json summary.parquet lock; do : > results/s/.$name.$$-$n.tmp; done
          : > {folder}/.{job}.h5.$$-$n.tmp
        done; exec \"$0\" {RUN}"
    );
    let finish = place.start(place.shell(&script)).finish();
    trial.check("run", &finish, &[0]);
    kind.truth.compare(trial, place);
    check::no_temporary_files(trial, place);
}

/// A folder on a disk that is mounted read-only.
fn read_only(kind: &Corruptions, trial: &mut Trial, place: &Place) {
    "folder read-only".clone_into(&mut trial.what);
    let mount = "mount --bind results results && mount -o remount,ro,bind results";
    let script = format!(
        "\"$0\" table results/s --json > table.json || exit 98
        \"$0\" doctor results/s > /dev/null || exit 97
        \"$0\" {RUN} --set solver.end_time=0.02"
    );
    let Some(finish) = place.run_mounted(mount, &script) else {
        return trial.skip("no right to mount a folder read-only");
    };
    trial.detected = true;
    trial.check("run", &finish, &[2]);
    kind.check_whole(trial, place, "after a refused run");
}

/// The results folder is deleted or moved away during a run, which must not write into a folder that is
/// not its own.
fn taken_during_a_run(trial: &mut Trial, place: &Place, milliseconds: u64, moved: bool) {
    "results folder deleted or moved during a run".clone_into(&mut trial.what);
    let results = place.results();
    fs::remove_dir_all(&results).expect("the results of the template");
    place.write_study(&studies::film());
    let mut running = place.start(place.billow(RUN));
    running.wait_for_lock();
    sleep(Duration::from_millis(milliseconds));
    let taken = if moved {
        fs::rename(&results, place.join("moved"))
    } else {
        fs::remove_dir_all(&results)
    };
    if taken.is_err() || running.has_ended() {
        return trial.skip("the run ended before");
    }
    let finish = running.finish();
    trial.detected = finish.code == Some(2);
    trial.check("run", &finish, &[2]);
    if results.exists() && !results.join("study.json").exists() {
        trial.fault("the run wrote into a folder without study.json");
    }
}
