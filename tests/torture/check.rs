//! Compares a results folder with that of an undisturbed run.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::program::{Finish, Place, RUN, files};
use crate::trial::Trial;

/// Columns that say what a run cost and which program made it.
const COSTS: [&str; 4] = ["wall_seconds", "time_per_zone_cycle", "commit", "program_version"];
/// Differences that are named for one trial, at most.
const MAX_NAMED: usize = 3;

/// What an undisturbed run of a study gave.
pub struct Truth {
    /// Rows of the table, without costs.
    pub rows: Vec<Value>,
    /// The history files, by name.
    histories: BTreeMap<String, Vec<u8>>,
}

impl Truth {
    /// Runs a study in a place to its end, undisturbed.
    pub fn of_run(place: &Place, study: &Value) -> Result<Self, String> {
        place.write_study(study);
        let finish = place.run(RUN);
        if finish.succeeded() { Self::read(place) } else { Err(finish.said()) }
    }

    /// What a results folder holds.
    pub fn read(place: &Place) -> Result<Self, String> {
        let rows = rows(place).map_err(|finish| format!("no table: {}", finish.said()))?;
        let named = |path: PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            (name, fs::read(path).unwrap_or_default())
        };
        let histories = files(&place.results().join("jobs")).into_iter().map(named).collect();
        Ok(Self { rows, histories })
    }

    /// Jobs that have a history, in the order of the table.
    pub fn jobs(&self) -> Vec<String> {
        let has_file = |job: &&str| self.histories.contains_key(&format!("{job}.h5"));
        let jobs = self.rows.iter().filter_map(|row| row["job"].as_str());
        jobs.filter(has_file).map(ToOwned::to_owned).collect()
    }

    /// Adds a fault for each difference of a finished folder: rows, histories, what `doctor` says.
    pub fn compare(&self, trial: &mut Trial, place: &Place) {
        let found = match Self::read(place) {
            Ok(found) => found,
            Err(problem) => return trial.fault(problem),
        };
        if found.rows.len() != self.rows.len() {
            trial.fault(format!("lost: {} rows of {}", found.rows.len(), self.rows.len()));
        }
        let rows = found.rows.iter().zip(&self.rows).filter(|(found, truth)| found != truth);
        for (found, truth) in rows.take(MAX_NAMED) {
            let [has, had] = [found, truth].map(|row| &row["status"]);
            trial.fault(format!("job {}: another row, {has} instead of {had}", truth["job"]));
        }
        let wrong =
            self.histories.iter().filter(|(name, file)| found.histories.get(*name) != Some(*file));
        for (name, _) in wrong.take(MAX_NAMED) {
            let changed = found.histories.contains_key(name);
            let what = if changed { "has other bits" } else { "is lost" };
            trial.fault(format!("history {name} {what}"));
        }
        trial.run(place, "doctor results/s", &[0]);
    }

    /// The same for a study whose files were never damaged: resumes it, returns quarantined jobs to it,
    /// and adds a fault for a job with two records and for a temporary file that remains.
    pub fn finish(&self, trial: &mut Trial, place: &Place) {
        let last = trial.run(place, RUN, &[]);
        let rows = rows(place).unwrap_or_default();
        let crashed = rows.iter().filter(|row| row["status"] == "crashed").count();
        if crashed > 0 {
            trial.count("jobs quarantined and returned", crashed);
            trial.run(place, "run results/s --again crashed --quiet", &[0]);
        } else if last.code.is_some_and(|code| code != 0) {
            trial.fault(format!("the last run ended with {}", last.said()));
        }
        self.compare(trial, place);
        for (job, times) in ended(&place.results()).iter().filter(|(_, times)| **times > 1) {
            trial.fault(format!("job {job} ran {times} times"));
        }
        no_temporary_files(trial, place);
    }

    /// Adds a fault if the table shows a number of an ended job that is not the true one.
    pub fn check_table(&self, trial: &mut Trial, place: &Place, when: &str) {
        let rows = match rows(place) {
            Ok(rows) => rows,
            Err(finish) => return trial.check("table", &finish, &[2]),
        };
        for row in rows.iter().filter(|row| row["status"] != "pending" && !self.rows.contains(row))
        {
            let text =
                format!("silently wrong {when}: the table has another row of job {}", row["job"]);
            trial.fault(text);
        }
    }
}

/// The rows of the table, without costs.
pub fn rows(place: &Place) -> Result<Vec<Value>, Finish> {
    let finish = place.run("table results/s --runs --json");
    match serde_json::from_str::<Vec<Value>>(&finish.stdout) {
        Ok(rows) if finish.succeeded() => Ok(rows.into_iter().map(without_costs).collect()),
        _ => Err(finish),
    }
}

/// A row or a summary without costs.
pub fn without_costs(mut row: Value) -> Value {
    if let Some(row) = row.as_object_mut() {
        row.retain(|name, _| !COSTS.contains(&name.as_str()));
    }
    row
}

/// The job of a line that records the end of a job.
pub fn ended_job(line: &str) -> Option<String> {
    let line: Value = serde_json::from_str(line).ok()?;
    line["cells"]["status"].as_str()?;
    Some(line["job"].as_str()?.to_owned())
}

/// Adds a fault for a temporary file that remains.
pub fn no_temporary_files(trial: &mut Trial, place: &Place) {
    let is_temporary = |path: &&PathBuf| {
        path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'))
    };
    if let Some(path) = files(&place.results()).iter().find(is_temporary) {
        trial.fault(format!("{} remains", path.display()));
    }
}

/// Jobs that are recorded as ended, and how often since they were last asked to run again. A record
/// of a job that took the process with it is no end.
fn ended(results: &Path) -> BTreeMap<String, usize> {
    let mut jobs = BTreeMap::new();
    let journals = files(&results.join("journal"));
    let text = journals.into_iter().map(|path| fs::read(path).unwrap_or_default());
    for line in text.collect::<Vec<_>>().concat().split(|byte| *byte == b'\n') {
        let line = serde_json::from_slice::<Value>(line).unwrap_or_default();
        let Some(job) = line["job"].as_str() else { continue };
        if line["kind"] == "invalidated" {
            jobs.remove(job);
        } else if line["cells"]["status"].as_str().is_some_and(|status| status != "crashed") {
            *jobs.entry(job.to_owned()).or_default() += 1;
        }
    }
    jobs
}
