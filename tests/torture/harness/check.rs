//! Compares a results folder with that of an undisturbed run.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use billow_solver::platform::seal;
use serde_json::Value;
use sha2::{Digest, Sha256};

use super::place::{self, Place};
use super::program::{self, Finish};
use super::trial::{Fault, Trial};
use super::{journal, studies};

/// Columns that say what a run cost and which program made it.
const COSTS: [&str; 4] = ["wall_seconds", "ns_per_element_step", "commit", "program_version"];
/// Differences that are named for one trial, at most.
const MAX_NAMED: usize = 3;

/// What an undisturbed run of a study gave.
pub struct Truth {
    /// Rows of the table, without costs.
    pub rows: Vec<Value>,
    /// SHA-256 of the history files, by name.
    pub histories: BTreeMap<String, String>,
}

impl Truth {
    /// Runs the study of a place to its end, undisturbed.
    pub fn of_run(place: &Place) -> Result<Self, String> {
        let finish = studies::run(place);
        if !finish.succeeded() {
            return Err(format!("the undisturbed run failed: {}", finish.said()));
        }
        Self::read(place).map_err(|finish| format!("table: {}", finish.said()))
    }

    /// What a results folder holds.
    pub fn read(place: &Place) -> Result<Self, Finish> {
        let rows = rows(place)?;
        Ok(Self { rows, histories: histories(&place.results()) })
    }

    /// Jobs that have a history, in the order of the table.
    pub fn jobs(&self) -> Vec<String> {
        let has_file = |job: &&str| self.histories.contains_key(&format!("{job}.h5"));
        let jobs = self.rows.iter().filter_map(|row| row["job"].as_str());
        jobs.filter(has_file).map(ToOwned::to_owned).collect()
    }
}

/// The rows of the table, without costs.
pub fn rows(place: &Place) -> Result<Vec<Value>, Finish> {
    let finish = program::run(place, &["table", "results/s", "--json"]);
    let parsed = serde_json::from_str::<Vec<Value>>(&finish.stdout);
    match parsed {
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

fn histories(results: &Path) -> BTreeMap<String, String> {
    let files = place::files(&results.join("jobs"));
    let hash = |path: &Path| seal::hexadecimal(&Sha256::digest(fs::read(path).unwrap_or_default()));
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    files.iter().map(|path| (name(path), hash(path))).collect()
}

/// Adds a fault for each difference of a finished folder from the truth: rows, histories, journal,
/// temporary files, and what `doctor` says.
pub fn compare(trial: &mut Trial, place: &Place, truth: &Truth) {
    let found = match Truth::read(place) {
        Ok(found) => found,
        Err(finish) => {
            finish.check_end(trial, "table");
            return trial.fault(Fault::Lost, format!("no table: {}", finish.said()));
        }
    };
    compare_rows(trial, &found.rows, &truth.rows);
    compare_histories(trial, &found.histories, &truth.histories);
    let doctor = program::run(place, &["doctor", "results/s"]);
    doctor.check_end(trial, "doctor");
    if doctor.code == Some(1) {
        trial.fault(Fault::Lost, format!("doctor: {}", doctor.said()));
    }
}

/// Adds a fault for each job with more than one record. Only for a folder without damage.
pub fn compare_journal(trial: &mut Trial, place: &Place) {
    for (job, times) in journal::ended(&place.results()).iter().filter(|(_, times)| **times > 1) {
        trial.fault(Fault::RunTwice, format!("job {job} has {times} records"));
    }
    check_temporary_files(trial, place);
}

/// Adds a fault for a temporary file that remains.
fn check_temporary_files(trial: &mut Trial, place: &Place) {
    let temporary = |path: &&std::path::PathBuf| {
        path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'))
    };
    if let Some(path) = place::files(&place.results()).iter().find(temporary) {
        trial.fault(Fault::WrongMessage, format!("{} remains", path.display()));
    }
}

fn compare_rows(trial: &mut Trial, found: &[Value], truth: &[Value]) {
    if found.len() != truth.len() {
        return trial.fault(Fault::Lost, format!("{} rows of {}", found.len(), truth.len()));
    }
    let pairs = found.iter().zip(truth);
    for (found, truth) in pairs.filter(|(found, truth)| *found != *truth).take(MAX_NAMED) {
        let job = truth["job"].as_str().unwrap_or("?");
        let status = found["status"].as_str().unwrap_or("?");
        if found["status"] == truth["status"] {
            let columns = truth.as_object().into_iter().flatten();
            let names = columns.filter(|(name, value)| found[name.as_str()] != **value);
            let names: Vec<&str> = names.map(|(name, _)| name.as_str()).take(MAX_NAMED).collect();
            trial.fault(Fault::OtherBits, format!("job {job}: {}", names.join(", ")));
        } else {
            trial.fault(Fault::Lost, format!("job {job}: status {status}"));
        }
    }
}

fn compare_histories(
    trial: &mut Trial,
    found: &BTreeMap<String, String>,
    truth: &BTreeMap<String, String>,
) {
    let wrong = truth.iter().filter(|(name, hash)| found.get(*name) != Some(*hash));
    for (name, _) in wrong.take(MAX_NAMED) {
        let fault = if found.contains_key(name) { Fault::OtherBits } else { Fault::Lost };
        trial.fault(fault, format!("history {name}"));
    }
}
