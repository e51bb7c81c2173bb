//! A results folder: where the files of a study are, its lock, its jobs and its table.
//!
//! ```text
//! results/<study>/study.json        the study as last run, fully written out: a study file itself
//!                 journal/*.jsonl   which jobs ended, and how (crate::store::journal)
//!                 jobs/<ab>/<id>.h5 histories (crate::store::history_file)
//!                 checkpoints/*.json states of jobs that have not ended (crate::store::checkpoint_file)
//!                 summary.parquet   the table, built from plan and journal (crate::store::table)
//!                 charts/           pictures (crate::chart)
//!                 proposed.json     what a search proposed ([`proposals`])
//!                 attempts.jsonl    during a run: which jobs it has started (crate::store::attempts)
//!                 submission/       what was given to a scheduler (`crate::cluster`)
//!                 parts/            results of the tasks of a scheduler, folders of results
//!                 damaged/          files that were damaged, as they were found (crate::store::damaged)
//!                 lock              held while a command changes the folder
//! ```
//!
//! Job ids are hashes of all that decides a result. So the grid of a study can change and the folder
//! stays: jobs that ended and are still planned are kept, other files stay unused, and the table
//! follows the plan.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::files::{self, Files, disk_error};
use crate::store::journal::{self, Journal, Record};
use crate::store::table::{Table, parquet};

mod histories;
mod lock;
mod proposals;
mod set_aside;
mod study_json;

/// Name of the file of a run's attempts.
const ATTEMPTS: &str = "attempts.jsonl";
/// Name of the file of what a search proposed.
const PROPOSED: &str = "proposed.json";
/// Name of the folder of what was given to a scheduler.
pub const SUBMISSION: &str = "submission";
/// Name of the folder with the results of the tasks of a scheduler.
pub const PARTS: &str = "parts";
/// Names that a run writes into a results folder.
pub const RESULT_NAMES: [&str; 14] = [
    "study.json",
    "previous.json",
    "journal",
    "jobs",
    "checkpoints",
    "summary.parquet",
    "charts",
    REPORT,
    PROPOSED,
    ATTEMPTS,
    SUBMISSION,
    PARTS,
    "damaged",
    "lock",
];
/// Names that people and other commands put beside them: a page about the results, what is published of them.
pub const OTHER_NAMES: [&str; 2] = ["README.md", PUBLISHED];
/// The page that answers a study.
const REPORT: &str = "report.html";
/// The folder with what is published of results; it may be there before them.
pub const PUBLISHED: &str = "published";

/// A results folder on a disk.
#[derive(Clone)]
pub struct Results<'a> {
    files: &'a dyn Files,
    root: PathBuf,
}

impl<'a> Results<'a> {
    /// The folder at `root`. Nothing is read or written yet.
    pub fn new(files: &'a dyn Files, root: &Path) -> Self {
        Self { files, root: root.to_owned() }
    }

    /// The disk of the folder.
    pub fn files(&self) -> &'a dyn Files {
        self.files
    }

    /// Path of the folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Path of study.json.
    pub fn study_path(&self) -> PathBuf {
        self.root.join("study.json")
    }

    /// study.json of the run before, where that was of another form of the study.
    pub fn previous_path(&self) -> PathBuf {
        self.root.join("previous.json")
    }

    /// Path of the journals.
    pub fn journal_path(&self) -> PathBuf {
        self.root.join("journal")
    }

    /// Path of the folder of history files.
    pub fn jobs_path(&self) -> PathBuf {
        self.root.join("jobs")
    }

    /// Path of a job's history file.
    pub fn job_path(&self, id: &JobId) -> PathBuf {
        self.jobs_path().join(&id.as_str()[..2]).join(format!("{id}.h5"))
    }

    /// Path of the pictures.
    pub fn charts_path(&self) -> PathBuf {
        self.root.join("charts")
    }

    /// Path of the report.
    pub fn report_path(&self) -> PathBuf {
        self.root.join(REPORT)
    }

    /// Path of the summary table.
    pub fn table_path(&self) -> PathBuf {
        self.root.join("summary.parquet")
    }

    /// Path of the attempts of a running process.
    pub fn attempts_path(&self) -> PathBuf {
        self.root.join(ATTEMPTS)
    }

    /// Path of what was given to a scheduler.
    pub fn submission_path(&self) -> PathBuf {
        self.root.join(SUBMISSION)
    }

    /// The results of the tasks of a scheduler, as far as they began.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn parts(&self) -> Result<Vec<Self>> {
        let folder = self.root.join(PARTS);
        let paths = self.files.list(&folder).map_err(|error| disk_error(&folder, &error))?;
        let started = paths.iter().filter(|path| path.join("study.json").exists());
        Ok(started.map(|path| Self::new(self.files, path)).collect())
    }

    /// The records of the results of which these are a part; none for a folder outside `parts`.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn known(&self) -> Result<BTreeMap<JobId, Record>> {
        match self.whole() {
            Some(whole) if whole.owner()?.is_some() => Ok(whole.journal()?.records),
            _ => Ok(BTreeMap::new()),
        }
    }

    /// The results of which these are a part; `None` for a folder outside `parts`.
    pub fn whole(&self) -> Option<Self> {
        let parts = self.root.parent().filter(|parts| parts.ends_with(PARTS))?;
        Some(Self::new(self.files, parts.parent()?))
    }

    /// Path of the folder of damaged files.
    pub fn damaged_path(&self) -> PathBuf {
        self.root.join("damaged")
    }

    /// Path of the lock.
    pub fn lock_path(&self) -> PathBuf {
        self.root.join("lock")
    }

    /// Removes temporary files of killed processes and returns their paths. Only for the process that holds
    /// the lock.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn remove_temporary_files(&self) -> Result<Vec<PathBuf>> {
        let jobs = self.jobs_path();
        let mut folders = self.files.list(&jobs).map_err(|error| disk_error(&jobs, &error))?;
        // The folders of histories have names of two digits.
        folders
            .retain(|path| path.is_dir() && path.file_name().is_some_and(|name| name.len() == 2));
        folders.extend([self.journal_path(), self.checkpoints_path(), self.root.clone()]);
        // Commands without the lock write pictures.
        let charts = self.charts_path();
        let mut removed = files::remove_stale_files(self.files, &charts)
            .map_err(|error| disk_error(&charts, &error))?;
        for folder in folders {
            let paths = files::remove_temporary_files(self.files, &folder)
                .map_err(|error| disk_error(&folder, &error))?;
            removed.extend(paths);
        }
        Ok(removed)
    }

    /// Reads the journals, and what a search has proposed: with both the points of a study are known.
    ///
    /// # Errors
    /// [`Error::Disk`] as [`journal::read`].
    pub fn journal(&self) -> Result<Journal> {
        self.recall_proposed();
        journal::read(self.files, &self.journal_path())
    }

    /// Removes the lines of the journals that are not valid: [`journal::mend`].
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn mend_journal(&self, journal: &Journal) -> Result<Vec<PathBuf>> {
        journal::mend(self.files, &journal.faults, &self.damaged_path())
    }

    /// Stores the summary table. An equal file is not written again. Returns whether it was written.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn write_table(&self, table: Table) -> Result<bool> {
        let path = self.table_path();
        if path.is_dir() {
            self.set_aside(&path)?;
        }
        files::write_if_changed(self.files, &path, &self.table_bytes(table)?)
            .map_err(|error| disk_error(&path, &error))
    }

    /// Whether the file of the summary table holds this one, byte for byte; `None` without a file.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn holds_table(&self, table: Table) -> Result<Option<bool>> {
        let path = self.table_path();
        match self.files.read(&path) {
            Ok(bytes) => Ok(Some(bytes == self.table_bytes(table)?)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(disk_error(&path, &error)),
        }
    }

    fn table_bytes(&self, table: Table) -> Result<Vec<u8>> {
        let at = |problem| Error::Disk { path: self.table_path(), problem };
        parquet::encode(table).map_err(at)
    }
}
