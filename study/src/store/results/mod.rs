//! A results folder: where the files of a study are, its lock, its jobs and its table.
//!
//! ```text
//! results/<study>/study.json        the study as last run, fully written out: a study file itself
//!                 journal/*.jsonl   which jobs ended, and how (crate::store::journal)
//!                 jobs/<ab>/<id>.h5 histories (crate::store::history_file)
//!                 references/*.json static references of the designs (crate::job::references)
//!                 checkpoints/*.json states of jobs that have not ended (crate::store::checkpoint_file)
//!                 summary.parquet   the table, built from plan and journal (crate::store::table)
//!                 charts/           pictures (crate::chart)
//!                 attempts.jsonl    during a run: which jobs it has started (crate::store::attempts)
//!                 damaged/          files that were damaged, as they were found (crate::store::damaged)
//!                 lock              held while a command changes the folder
//! ```
//!
//! Job ids are hashes of all that decides a result. So the grid of a study can change and the folder
//! stays: jobs that ended and are still planned are kept, other files stay unused, and the table
//! follows the plan.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::files::{self, Files, Lock, Stamp, disk_error};
use crate::store::history_file::{self, StoredHistory};
use crate::store::journal::{self, Journal, Record};
use crate::store::table::{Table, parquet};

mod set_aside;
mod study_json;

/// Name of the file of a run's attempts.
const ATTEMPTS: &str = "attempts.jsonl";
/// Names that a run writes into a results folder.
pub const RESULT_NAMES: [&str; 10] = [
    "study.json",
    "journal",
    "jobs",
    "references",
    "checkpoints",
    "summary.parquet",
    "charts",
    ATTEMPTS,
    "damaged",
    "lock",
];
/// What is wrong with a history file of other bytes.
const OTHER_FILE: &str = "not the file that was written; its job runs again";
/// What is wrong with a history file that does not exist.
const MISSING_FILE: &str = "missing; its job runs again";
/// Attempts to take the lock before it counts as held. Chosen: a command that only checks the lock
/// holds it for much less than the sum of the pauses.
const MAX_LOCK_ATTEMPTS: u32 = 5;
/// Pause between two attempts.
const LOCK_PAUSE: Duration = Duration::from_millis(10);

/// A problem of a history file, with its next step.
fn next_run(problem: &str) -> String {
    format!(
        "{problem}\n  next: run `billow run` of its study: it runs the job again; while a run is active, \
         try again"
    )
}

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

    /// Path of the static references.
    pub fn references_path(&self) -> PathBuf {
        self.root.join("references")
    }

    /// Path of the pictures.
    pub fn charts_path(&self) -> PathBuf {
        self.root.join("charts")
    }

    /// Path of the summary table.
    pub fn table_path(&self) -> PathBuf {
        self.root.join("summary.parquet")
    }

    /// Path of the attempts of a running process.
    pub fn attempts_path(&self) -> PathBuf {
        self.root.join(ATTEMPTS)
    }

    /// Path of the folder of damaged files.
    pub fn damaged_path(&self) -> PathBuf {
        self.root.join("damaged")
    }

    fn lock_path(&self) -> PathBuf {
        self.root.join("lock")
    }

    /// Creates the folder if it is missing, and takes its lock.
    ///
    /// # Errors
    /// [`Error::Disk`] when the folder cannot be created, holds other files than results, when another
    /// command holds the lock, or when the lock is a symbolic link.
    pub fn lock(&self) -> Result<Lock> {
        let created =
            self.files.create_folder(&self.root).map_err(|error| disk_error(&self.root, &error))?;
        if !created {
            self.refuse_other_folders()?;
        }
        let path = self.lock_path();
        // A command that only checks the lock holds it for an instant.
        for _ in 0..MAX_LOCK_ATTEMPTS {
            let lock = self.files.try_lock(&path).map_err(|error| disk_error(&path, &error))?;
            if let Some(lock) = lock {
                return Ok(lock);
            }
            std::thread::sleep(LOCK_PAUSE);
        }
        Err(Error::Disk {
            path: self.root.clone(),
            problem: "another billow command is running this study\n  next: wait until it has \
                      ended, or choose another folder with --results DIR"
                .to_owned(),
        })
    }

    /// Checks that a held lock is still that of this folder, so that nothing is written into a folder that
    /// was deleted or replaced.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn check_lock(&self, lock: &Lock) -> Result<()> {
        let path = self.lock_path();
        if lock.is_file(&path).map_err(|error| disk_error(&path, &error))? {
            return Ok(());
        }
        Err(Error::Disk {
            path: self.root.clone(),
            problem: "the folder was deleted or replaced while a command was writing into it\n  next: run \
                      the same command again; what was stored before is gone with the folder"
                .to_owned(),
        })
    }

    /// Whether another process is running this study.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn is_locked(&self) -> Result<bool> {
        let path = self.lock_path();
        self.files.is_locked(&path).map_err(|error| disk_error(&path, &error))
    }

    /// Refuses a folder without study.json that holds files no run wrote.
    fn refuse_other_folders(&self) -> Result<()> {
        let names: Vec<String> = self
            .files
            .list(&self.root)
            .map_err(|error| disk_error(&self.root, &error))?
            .iter()
            .filter_map(|path| path.file_name().map(|name| name.to_string_lossy().into_owned()))
            .collect();
        // A killed process may have left hidden files.
        let other = names
            .iter()
            .find(|name| !RESULT_NAMES.contains(&name.as_str()) && !name.starts_with('.'));
        match other {
            Some(name) if !names.iter().any(|name| name == "study.json") => Err(Error::Disk {
                path: self.root.clone(),
                problem: format!(
                    "not a folder of results: it holds {name:?} and no study.json\n  next: choose \
                     an empty or new folder with --results DIR"
                ),
            }),
            _ => Ok(()),
        }
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
        let written_under_lock = [
            self.journal_path(),
            self.references_path(),
            self.checkpoints_path(),
            self.root.clone(),
        ];
        folders.extend(written_under_lock);
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

    /// Reads the journals.
    ///
    /// # Errors
    /// [`Error::Disk`] as [`journal::read`].
    pub fn journal(&self) -> Result<Journal> {
        journal::read(self.files, &self.journal_path())
    }

    /// Removes the lines of the journals that are not valid: [`journal::mend`].
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn mend_journal(&self, journal: &Journal) -> Result<Vec<PathBuf>> {
        journal::mend(self.files, &journal.faults, &self.damaged_path())
    }

    /// Why a recorded job must run again: its history file is missing, or is not the recorded one.
    /// `None` for an undamaged file. A file with the recorded size and time counts as undamaged; its bytes
    /// are checked by who reads it.
    ///
    /// # Errors
    /// [`Error::Disk`] when the file exists but cannot be read.
    pub fn damage(&self, record: &Record) -> Result<Option<String>> {
        let Some(hash) = &record.file_hash else { return Ok(None) };
        let path = self.job_path(&record.job);
        let again = |problem: &str| Some(format!("{}: {problem}", path.display()));
        let found = self.files.stamp(&path);
        match (&found, &record.file_stamp) {
            (Ok(found), Some(recorded)) if found == recorded => return Ok(None),
            (Ok(found), Some(recorded)) if found.size != recorded.size => {
                return Ok(again(OTHER_FILE));
            }
            _ => {}
        }
        match found.and_then(|_| self.files.read(&path)) {
            Ok(bytes) if history_file::bytes_hash(&bytes) == *hash => Ok(None),
            Ok(_) => Ok(again(OTHER_FILE)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(again(MISSING_FILE)),
            Err(error) => Err(disk_error(&path, &error)),
        }
    }

    /// Checks that a history file holds the bytes that its record names, so that it is complete, unchanged,
    /// and that of its job.
    ///
    /// # Errors
    /// [`Error::Disk`] with the reason.
    pub fn check_history(&self, record: &Record) -> Result<()> {
        let path = self.job_path(&record.job);
        let bytes = self.files.read(&path).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => {
                Error::Disk { path: path.clone(), problem: next_run("missing") }
            }
            _ => disk_error(&path, &error),
        })?;
        if record.file_hash.as_ref().is_none_or(|hash| history_file::bytes_hash(&bytes) == *hash) {
            return Ok(());
        }
        let problem = next_run("not the history that was written for this job");
        Err(Error::Disk { path, problem })
    }

    /// Reads the history of a job, after [`Self::check_history`]. Without a record only its job is checked.
    ///
    /// # Errors
    /// [`Error::Disk`] with the reason.
    pub fn read_history(&self, id: &JobId, record: Option<&Record>) -> Result<StoredHistory> {
        let recorded = record.filter(|record| record.file_hash.is_some());
        recorded.map_or(Ok(()), |record| self.check_history(record))?;
        let path = self.job_path(id);
        let stored = history_file::read(&path)?;
        if recorded.is_some() || stored.job == *id {
            return Ok(stored);
        }
        let problem = next_run(&format!("it is the history of the job {}", stored.job));
        Err(Error::Disk { path, problem })
    }

    /// Stores a history file. Returns its size and time.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn write_job(&self, id: &JobId, bytes: &[u8]) -> Result<Stamp> {
        let path = self.job_path(id);
        let jobs = self.jobs_path();
        let folder = path.parent().unwrap_or(&jobs);
        let write = || -> io::Result<Stamp> {
            if self.files.create_folder(folder)? {
                self.files.sync_folder(&jobs)?;
                self.files.sync_folder(&self.root)?;
            }
            files::write_atomic(self.files, &path, bytes)?;
            self.files.stamp(&path)
        };
        write().map_err(|error| disk_error(&path, &error))
    }

    /// Stores the summary table. An equal file is not written again. Returns whether it was written.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn write_table(&self, table: &Table) -> Result<bool> {
        let path = self.table_path();
        if path.is_dir() {
            self.set_aside(&path)?;
        }
        let bytes = parquet::encode(table)
            .map_err(|problem| Error::Disk { path: path.clone(), problem })?;
        files::write_if_changed(self.files, &path, &bytes)
            .map_err(|error| disk_error(&path, &error))
    }

    /// Reads the summary table.
    ///
    /// # Errors
    /// [`Error::Disk`] when there is no table, or as [`parquet::decode`].
    pub fn read_table(&self) -> Result<Table> {
        let path = self.table_path();
        match self.files.read(&path) {
            Ok(bytes) => parquet::decode(&path, &bytes),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Err(Error::Disk {
                path,
                problem: "no table here\n  next: run `billow run STUDY` first, or name the folder \
                          of its results"
                    .to_owned(),
            }),
            Err(error) => Err(disk_error(&path, &error)),
        }
    }
}
