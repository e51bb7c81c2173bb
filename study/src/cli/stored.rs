//! Reads a results folder for a command, and says on stderr what of it is damaged.

use std::path::Path;

use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::files::Disk;
use crate::store::journal::{Fault, Journal};
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::store::table::{Table, agreement};

/// Journal lines that are named, at most.
const MAX_SHOWN: usize = 3;

/// Reads a results folder.
///
/// # Errors
/// As [`Stored::read`].
pub fn read(root: &Path) -> Result<Stored<'static>> {
    let stored = Stored::read(Results::new(&Disk, root))?;
    note_faults(&stored.journal, &stored.results);
    Ok(stored)
}

/// Reads what a results folder has of one job, whose id begins with `prefix`.
///
/// # Errors
/// As [`Stored::read`] and [`Stored::job`].
pub fn read_job(root: &Path, prefix: &str) -> Result<(Stored<'static>, JobId)> {
    let stored = read(root)?;
    let id = stored.job(prefix)?;
    Ok((stored, id))
}

/// Names the lines of the journal that are not valid. A torn last line is what a running process writes.
pub fn note_faults(journal: &Journal, results: &Results<'_>) {
    let running = results.is_running().unwrap_or(false);
    let shown: Vec<&Fault> =
        journal.faults.iter().filter(|fault| !(fault.torn && running)).collect();
    let mut faults = shown.iter();
    for fault in faults.by_ref().take(MAX_SHOWN) {
        eprintln!("billow: damaged: {fault}");
    }
    let more = faults.count();
    if more > 0 {
        eprintln!("billow: damaged: {more} more lines of the journal");
    }
    if !shown.is_empty() {
        let root = results.root().display();
        eprintln!(
            "  next: run `billow run` of the study: it runs these jobs again; `billow doctor {root}`"
        );
    }
}

/// The stored table if it says what the journal says, else the table of plan and journal, with a
/// message on stderr.
///
/// # Errors
/// When neither can be read.
pub fn table(results: &Results<'_>, journal: &Journal) -> Result<Table> {
    // A run that was stopped before it wrote its table has a plan and a journal.
    let written = results.table_path().exists();
    let stored = results.read_table();
    if results.owner()?.is_none() || (written && journal.is_empty()) {
        if stored.is_ok() {
            let root = results.root().display();
            eprintln!(
                "billow: {root}: no journal: nothing confirms the table\n  next: billow doctor {root}"
            );
        }
        return stored;
    }
    let truth = Stored::read(results.clone())?.table();
    if let Ok(table) = &stored {
        if agreement::different_rows(table, &truth) == 0 {
            return Ok(truth);
        }
        if agreement::is_of_other_physics(table, &journal.records) {
            return stored;
        }
    }
    match stored {
        Err(Error::Disk { path, problem }) if written => {
            let problem = problem.split('\n').next().unwrap_or_default();
            eprintln!(
                "billow: {}: {problem}; the journal is read instead\n  next: run `billow run` of its study: \
                 it writes the table again",
                path.display()
            );
        }
        Ok(_) if journal.faults.is_empty() && !results.is_running()? => {
            let path = results.table_path();
            eprintln!(
                "billow: {}: differs from the journal; the journal is read instead\n  next: billow doctor \
                 {}",
                path.display(),
                results.root().display()
            );
        }
        _ => {}
    }
    Ok(truth)
}
