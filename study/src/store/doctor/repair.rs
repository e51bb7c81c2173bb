//! Repairs a results folder: what is damaged is restored from other files, or set aside so that its jobs run
//! again. Nothing is deleted but temporary files and the summary table, which is built again; damaged files
//! are kept in the folder `damaged`.

use std::path::{Path, PathBuf};

use super::{histories, is_of_other_physics, kinds};
use crate::job::JobId;
use crate::platform::error::Result;
use crate::store::attempts;
use crate::store::journal::{Journal, Writer};
use crate::store::results::Results;
use crate::store::stored::Stored;

/// Something that was repaired.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Repaired {
    /// File or folder.
    pub path: PathBuf,
    /// What was done.
    pub action: String,
}

/// Repairs a results folder under its lock. Returns what was done, in order.
///
/// # Errors
/// [`crate::platform::error::Error::Disk`] when the folder is locked or cannot be read or written. What was
/// repaired until then stays repaired.
pub fn repair(results: &Results<'_>) -> Result<Vec<Repaired>> {
    let _lock = results.lock()?;
    let mut repaired = Vec::new();
    let mut add = |path: &Path, action: &str| {
        repaired.push(Repaired { path: path.to_owned(), action: action.to_owned() });
    };
    for (path, problem) in kinds::misplaced(results) {
        results.set_aside(&path)?;
        add(&path, &format!("set aside: {problem}"));
    }
    for path in results.remove_temporary_files()? {
        add(&path, "removed: a temporary file of a process that died");
    }
    let journal = results.journal()?;
    if results.restore_study(&journal)? {
        add(&results.study_path(), "restored from the journal");
    }
    for path in results.mend_journal(&journal)? {
        add(&path, "written again without the lines that are not valid; their jobs are pending");
    }
    let mut journal = results.journal()?;
    let mut writer = Writer::new(results.files(), results.journal_path());
    attempts::take_deaths(results, &mut journal, &mut writer)?;
    for (job, problem) in histories::damaged(results, &journal)? {
        let path = results.job_path(&job);
        results.set_aside(&path)?;
        invalidate(&mut writer, &mut journal, &job)?;
        add(&path, &format!("set aside: {problem}; its job is pending"));
    }
    for (path, problem) in results.damaged_checkpoints()? {
        results.set_aside(&path)?;
        add(&path, &format!("set aside: {problem}; its job starts from its beginning"));
    }
    if let Ok(Some(_)) = results.owner()
        && let Ok(stored) = Stored::read(results.clone())
        && repair_table(&stored)?
    {
        add(&results.table_path(), "set aside, and written again from plan and journal");
    }
    Ok(repaired)
}

/// Writes the summary table again if it is not that of plan and journal, and keeps the one that was there.
/// Returns whether it was written.
fn repair_table(stored: &Stored<'_>) -> Result<bool> {
    let (results, table) = (&stored.results, stored.table());
    if results.holds_table(table.clone())? == Some(true) || is_of_other_physics(stored) {
        return Ok(false);
    }
    results.set_aside(&results.table_path())?;
    results.write_table(table)
}

fn invalidate(writer: &mut Writer<'_>, journal: &mut Journal, job: &JobId) -> Result<()> {
    writer.invalidate(std::slice::from_ref(job))?;
    journal.invalidate(job);
    Ok(())
}
