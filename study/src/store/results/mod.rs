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
use crate::platform::files::{self, Files, Lock, disk_error};
use crate::store::history_file;
use crate::store::journal::{self, Journal, Record};
use crate::store::table::{Table, parquet};

mod study_json;

/// Names that a run writes into a results folder.
pub const RESULT_NAMES: [&str; 8] = [
    "study.json",
    "journal",
    "jobs",
    "references",
    "checkpoints",
    "summary.parquet",
    "charts",
    "lock",
];
/// Attempts to take the lock before it counts as held. Chosen: a command that only checks the lock
/// holds it for much less than the sum of the pauses.
const MAX_LOCK_ATTEMPTS: u32 = 5;
/// Pause between two attempts.
const LOCK_PAUSE: Duration = Duration::from_millis(10);

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

    fn lock_path(&self) -> PathBuf {
        self.root.join("lock")
    }

    /// Creates the folder if it is missing, and takes its lock.
    ///
    /// # Errors
    /// [`Error::Disk`] when the folder cannot be created, holds other files than results, or when
    /// another command holds the lock.
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

    /// Removes temporary files of killed processes. Only for the process that holds the lock.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn remove_temporary_files(&self) -> Result<()> {
        let jobs = self.jobs_path();
        let mut folders = self.files.list(&jobs).map_err(|error| disk_error(&jobs, &error))?;
        // The folders of histories have names of two digits.
        folders
            .retain(|path| path.is_dir() && path.file_name().is_some_and(|name| name.len() == 2));
        folders.extend([self.references_path(), self.checkpoints_path(), self.root.clone()]);
        for folder in folders {
            files::remove_temporary_files(self.files, &folder)
                .map_err(|error| disk_error(&folder, &error))?;
        }
        Ok(())
    }

    /// Reads the journals.
    ///
    /// # Errors
    /// [`Error::Disk`] as [`journal::read`].
    pub fn journal(&self) -> Result<Journal> {
        journal::read(self.files, &self.journal_path())
    }

    /// Why a recorded job must run again: its history file is missing, or is not the recorded one.
    /// `None` for an undamaged file.
    ///
    /// # Errors
    /// [`Error::Disk`] when the file exists but cannot be read.
    pub fn damage(&self, record: &Record) -> Result<Option<String>> {
        let Some(hash) = &record.file_hash else { return Ok(None) };
        let path = self.job_path(&record.job);
        match self.files.read(&path) {
            Ok(bytes) if history_file::bytes_hash(&bytes) == *hash => Ok(None),
            Ok(_) => Ok(Some(format!(
                "{}: not the file that was written; its job is run again",
                path.display()
            ))),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                Ok(Some(format!("{}: missing; its job is run again", path.display())))
            }
            Err(error) => Err(disk_error(&path, &error)),
        }
    }

    /// Stores a history file.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn write_job(&self, id: &JobId, bytes: &[u8]) -> Result<()> {
        let path = self.job_path(id);
        let jobs = self.jobs_path();
        let folder = path.parent().unwrap_or(&jobs);
        let write = || -> io::Result<()> {
            if self.files.create_folder(folder)? {
                self.files.sync_folder(&jobs)?;
                self.files.sync_folder(&self.root)?;
            }
            files::write_atomic(self.files, &path, bytes)
        };
        write().map_err(|error| disk_error(&path, &error))
    }

    /// Stores the summary table. An equal file is not written again.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn write_table(&self, table: &Table) -> Result<()> {
        let path = self.table_path();
        let bytes = parquet::encode(table)
            .map_err(|problem| Error::Disk { path: path.clone(), problem })?;
        files::write_if_changed(self.files, &path, &bytes)
            .map_err(|error| disk_error(&path, &error))?;
        Ok(())
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
