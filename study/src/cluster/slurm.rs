//! The commands of Slurm. Only those that work without accounting: `sbatch`, `squeue`, `scontrol show config`.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use super::submission::Queued;
use crate::platform::error::{Error, Result};

/// Tasks of an array where the cluster does not say how many it allows: the default of Slurm.
const DEFAULT_MAX_TASKS: usize = 1000;
/// Characters of a message of Slurm that are shown, at most.
const MAX_MESSAGE: usize = 300;

/// The largest number of tasks of an array.
pub fn max_tasks() -> usize {
    let output = command("scontrol", &["show", "config"]).unwrap_or_default();
    max_tasks_in(&output).unwrap_or(DEFAULT_MAX_TASKS)
}

/// `MaxArraySize` is one more than the largest number of a task, which are from 1 here.
fn max_tasks_in(config: &str) -> Option<usize> {
    let line = config.lines().find(|line| line.starts_with("MaxArraySize"))?;
    let size: usize = line.split_once('=')?.1.trim().parse().ok()?;
    (size > 1).then(|| size - 1)
}

/// Gives scripts to the scheduler: the array of tasks, and the one that runs when all of them have ended.
///
/// # Errors
/// [`Error::Disk`] with the message of Slurm; nothing remains in the queue then.
pub fn submit(array: &Path, merge: &Path) -> Result<Queued> {
    let path = |path: &Path| path.display().to_string();
    let array_number = sbatch(array, &["--parsable", &path(array)])?;
    let dependency = format!("--dependency=afterany:{array_number}");
    match sbatch(merge, &["--parsable", &dependency, &path(merge)]) {
        Ok(merge) => Ok(Queued { array: array_number, merge }),
        Err(error) => {
            // The array alone would leave a study without a table.
            let _ = command("scancel", &[&array_number]);
            Err(error)
        }
    }
}

fn sbatch(script: &Path, arguments: &[&str]) -> Result<String> {
    let output = command("sbatch", arguments).map_err(|problem| Error::Disk {
        path: script.to_owned(),
        problem: format!(
            "sbatch refused it: {problem}\n  next: billow submit --dry-run prints the script; options of your \
             site are given as --sbatch=--account=NAME"
        ),
    })?;
    // "12" or "12;cluster".
    let number = output.trim().split(';').next().unwrap_or_default();
    Ok(number.to_owned())
}

/// Numbers of the tasks of a submission that the queue holds, by their state in words of Slurm (`RUNNING`); empty when all
/// have left it.
///
/// # Errors
/// Why the queue cannot be asked.
pub fn queue(queued: &Queued) -> std::result::Result<BTreeMap<String, usize>, String> {
    let numbers = format!("{},{}", queued.array, queued.merge);
    match command("squeue", &["--noheader", "--array", "--format=%T", "--jobs", &numbers]) {
        Ok(output) => Ok(states(&output)),
        // Slurm says so of numbers that have left the queue some time ago.
        Err(problem) if problem.contains("Invalid job id") => Ok(BTreeMap::new()),
        Err(problem) => Err(problem),
    }
}

fn states(output: &str) -> BTreeMap<String, usize> {
    let mut states = BTreeMap::new();
    for state in output.lines().map(str::trim).filter(|state| !state.is_empty()) {
        *states.entry(state.to_owned()).or_default() += 1;
    }
    states
}

/// What a command of Slurm printed.
fn command(name: &str, arguments: &[&str]) -> std::result::Result<String, String> {
    let output = Command::new(name).args(arguments).output();
    let output = output.map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => {
            format!("no program {name} here: is this a machine of a Slurm cluster?")
        }
        _ => format!("{name}: {error}"),
    })?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let message = String::from_utf8_lossy(&output.stderr);
    let message: String = message.trim().chars().take(MAX_MESSAGE).collect();
    Err(message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_slurm_prints_is_read() {
        let config = "Configuration data\nMaxArraySize            = 1001\nMaxJobCount = 10000\n";
        assert_eq!(max_tasks_in(config), Some(1000));
        assert_eq!(max_tasks_in("MaxArraySize            = 0\n"), None);
        assert_eq!(max_tasks_in(""), None);
        let found = states("RUNNING\nPENDING\nPENDING\n\n");
        assert_eq!(found, [("PENDING".to_owned(), 2), ("RUNNING".to_owned(), 1)].into());
    }
}
