//! A results folder: where everything of a study lies, and whether it is sound.
//!
//! ```text
//! results/<study>/study.json        the study as last run, all spelled out: a study file itself
//!                 journal/*.jsonl   which jobs ended, and how (crate::store::journal)
//!                 jobs/<ab>/<id>.h5 histories (crate::store::history_file)
//!                 references/*.json static states of the designs (crate::job::references)
//!                 summary.parquet   the table, rebuilt from plan and journal (crate::store::table)
//!                 charts/           pictures (crate::chart)
//!                 lock              held while a command changes the folder
//! ```
//!
//! Job ids are hashes of what decides a result, so a study may grow or change its grid and keep the
//! folder: finished jobs that are still planned are kept, the others lie there unused, and the table
//! follows the plan.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::Deserialize;

use crate::input::study_file::Json;
use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::files::{self, Files, Lock, disk_error};
use crate::store::history_file;
use crate::store::journal::{self, Journal, Record};
use crate::store::table::{Table, parquet};

/// Name of the format of study.json: it is a study file, with everything spelled out.
const FORMAT: &str = "billow-study";
/// Version of study.json this program writes, and the newest it reads.
const VERSION: u64 = 1;

/// Names of what a run leaves in a folder.
pub const OURS: [&str; 7] =
    ["study.json", "journal", "jobs", "references", "summary.parquet", "charts", "lock"];
/// How often a lock that is held is looked at before it counts as held.
const LOOKS: u32 = 5;

/// What tells whose folder it is.
#[derive(Deserialize)]
struct Owner {
    format: String,
    version: u64,
    name: String,
}

/// study.json of a resolved study.
fn study_bytes(name: &str, study: &Json) -> io::Result<Vec<u8>> {
    let mut study = study.clone();
    study.set("format", Json::Text(FORMAT.to_owned()));
    study.set("version", Json::Integer(VERSION.cast_signed()));
    study.set("name", Json::Text(name.to_owned()));
    let mut bytes = serde_json::to_vec_pretty(&study).map_err(io::Error::other)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// A results folder on some disk.
#[derive(Clone)]
pub struct Results<'a> {
    files: &'a dyn Files,
    root: PathBuf,
}

impl<'a> Results<'a> {
    /// The folder at `root`; nothing is read or written yet.
    pub fn new(files: &'a dyn Files, root: &Path) -> Self {
        Self { files, root: root.to_owned() }
    }

    /// The disk it lies on.
    pub fn files(&self) -> &'a dyn Files {
        self.files
    }

    /// Path of the folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Path of the journals.
    pub fn journal_path(&self) -> PathBuf {
        self.root.join("journal")
    }

    /// Path of a job's history file.
    pub fn job_path(&self, id: &JobId) -> PathBuf {
        self.root.join("jobs").join(&id.as_str()[..2]).join(format!("{id}.h5"))
    }

    /// Path of the static states runs are judged against.
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

    /// Creates the folder if need be, and takes its lock.
    ///
    /// # Errors
    /// [`Error::Disk`] when it cannot be created, or when another command holds the lock.
    pub fn lock(&self) -> Result<Lock> {
        let at_root = |error: io::Error| disk_error(&self.root, &error);
        if !self.files.create_folder(&self.root).map_err(at_root)? {
            self.refuse_foreign()?;
        }
        let path = self.lock_path();
        // A command that only looks whether somebody runs holds the lock for an instant.
        for _ in 0..LOOKS {
            let lock = self.files.try_lock(&path).map_err(|error| disk_error(&path, &error))?;
            if let Some(lock) = lock {
                return Ok(lock);
            }
            std::thread::sleep(Duration::from_millis(10));
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

    fn lock_path(&self) -> PathBuf {
        self.root.join("lock")
    }

    /// Refuses a folder that holds what no study left there.
    fn refuse_foreign(&self) -> Result<()> {
        let at_root = |error: io::Error| disk_error(&self.root, &error);
        let names: Vec<String> = self
            .files
            .list(&self.root)
            .map_err(at_root)?
            .iter()
            .filter_map(|path| path.file_name().map(|name| name.to_string_lossy().into_owned()))
            .collect();
        // A folder with its study.json is judged by that; hidden files may be half-written ones.
        let foreign =
            names.iter().find(|name| !OURS.contains(&name.as_str()) && !name.starts_with('.'));
        match foreign {
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

    /// Removes what a killed process left half written. Only with the lock held.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn sweep(&self) -> Result<()> {
        let jobs = self.root.join("jobs");
        let mut folders = self.files.list(&jobs).map_err(|error| disk_error(&jobs, &error))?;
        // Job folders are named by two digits; anything else in there is not ours.
        folders
            .retain(|path| path.is_dir() && path.file_name().is_some_and(|name| name.len() == 2));
        folders.extend([self.references_path(), self.root.clone()]);
        for folder in folders {
            files::sweep(self.files, &folder).map_err(|error| disk_error(&folder, &error))?;
        }
        Ok(())
    }

    /// Path of study.json.
    pub fn study_path(&self) -> PathBuf {
        self.root.join("study.json")
    }

    /// Name of the study the folder belongs to, `None` where no study.json says so.
    ///
    /// # Errors
    /// [`Error::Disk`] when study.json cannot be read, is none of ours, or of a newer program.
    pub fn owner(&self) -> Result<Option<String>> {
        let path = self.study_path();
        let bytes = match self.files.read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(disk_error(&path, &error)),
        };
        let there: Owner = serde_json::from_slice(&bytes)
            .map_err(|error| self.refused(&format!("not a study.json of billow: {error}")))?;
        if there.format != FORMAT {
            return Err(self.refused(&format!("format {:?} is not {FORMAT:?}", there.format)));
        }
        if there.version > VERSION {
            return Err(self.refused(&format!(
                "version {}, this program reads up to {VERSION}: written by a newer billow",
                there.version
            )));
        }
        Ok(Some(there.name))
    }

    fn refused(&self, problem: &str) -> Error {
        Error::Disk {
            path: self.study_path(),
            problem: format!("{problem}\n  next: choose another folder with --results DIR"),
        }
    }

    /// Notes which study the folder belongs to, unless it says so already: `study` is the resolved
    /// study, an object.
    ///
    /// # Errors
    /// [`Error::Disk`] when it belongs to another study, or to a newer program.
    pub fn write_study(&self, name: &str, study: &Json) -> Result<()> {
        if let Some(there) = self.owner()?.filter(|there| there != name) {
            return Err(self.refused(&format!(
                "the folder holds results of the study {there:?}, not of {name:?}"
            )));
        }
        let path = self.study_path();
        let bytes = study_bytes(name, study).map_err(|error| disk_error(&path, &error))?;
        files::write_if_changed(self.files, &path, &bytes)
            .map_err(|error| disk_error(&path, &error))?;
        Ok(())
    }

    /// Whether this is the study the folder was last run for.
    ///
    /// # Errors
    /// [`Error::Disk`] when study.json cannot be read.
    pub fn holds(&self, name: &str, study: &Json) -> Result<bool> {
        let path = self.study_path();
        let there = self.files.read(&path).map_err(|error| disk_error(&path, &error))?;
        Ok(there == study_bytes(name, study).map_err(|error| disk_error(&path, &error))?)
    }

    /// What the journals say.
    ///
    /// # Errors
    /// [`Error::Disk`] as [`journal::read`].
    pub fn journal(&self) -> Result<Journal> {
        journal::read(self.files, &self.journal_path())
    }

    /// Why a recorded job has to run again after all: its history file is missing or not the one
    /// recorded. `None` when all is well.
    ///
    /// # Errors
    /// [`Error::Disk`] when the file is there but cannot be read.
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
        let jobs = self.root.join("jobs");
        let folder = path.parent().unwrap_or(&jobs);
        let written = || -> io::Result<()> {
            if self.files.create_folder(folder)? {
                self.files.sync_folder(&jobs)?;
                self.files.sync_folder(&self.root)?;
            }
            files::write_atomic(self.files, &path, bytes)
        };
        written().map_err(|error| disk_error(&path, &error))
    }

    /// Stores the summary table, unless it is there already.
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

    /// The summary table.
    ///
    /// # Errors
    /// [`Error::Disk`] when there is none, or as [`parquet::decode`].
    pub fn read_table(&self) -> Result<Table> {
        let path = self.table_path();
        match self.files.read(&path) {
            Ok(bytes) => parquet::decode(&path, &bytes),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Err(Error::Disk {
                path,
                problem: "no table here\n  next: `billow run STUDY` first, or name the folder of \
                          its results"
                    .to_owned(),
            }),
            Err(error) => Err(disk_error(&path, &error)),
        }
    }
}
