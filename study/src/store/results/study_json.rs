//! study.json: which study a results folder belongs to. It is the study file as it ran, with a
//! checksum ([`billow_solver::platform::seal`]).
//!
//! The journal holds the text too, so that a damaged file can be restored.

use std::io;

use billow_solver::platform::seal;
use serde::Deserialize;

use super::Results;
use crate::input::json::Json;
use crate::platform::error::{Error, Result};
use crate::platform::files::{self, disk_error};
use crate::platform::quote;
use crate::store::journal::Journal;
use crate::study::{JOB_LIMITS, Study, UNITS};

/// Name of the format.
const FORMAT: &str = "billow-study";
/// Version of study.json.
const VERSION: u64 = 1;

/// The members that say which study it is.
#[derive(Deserialize)]
struct Owner {
    format: String,
    version: u64,
    name: String,
}

/// What is on disk.
enum State {
    Missing,
    Valid(Owner),
    /// Not the text that was written.
    Damaged(String),
}

/// The text of study.json for the file of a study.
fn study_text(name: &str, study: &Json) -> io::Result<String> {
    let mut study = study.clone();
    study.set("format", Json::Text(FORMAT.to_owned()));
    study.set("version", Json::Integer(VERSION.cast_signed()));
    study.set("name", Json::Text(name.to_owned()));
    let object = serde_json::to_string_pretty(&study).map_err(io::Error::other)?;
    Ok(seal::seal(&(object + "\n")))
}

/// The file of a study without the units in which its quantities are shown, and the limits of its jobs.
fn without_units(mut study: Json) -> Json {
    if let Json::Object(members) = &mut study {
        members.retain(|(name, _)| name != UNITS && name != JOB_LIMITS);
    }
    study
}

impl Results<'_> {
    /// Name of the study that the folder belongs to; `None` without study.json.
    ///
    /// # Errors
    /// [`Error::Disk`] when study.json cannot be read, is not valid, or is of another version.
    pub fn owner(&self) -> Result<Option<String>> {
        Ok(self.read_owner()?.map(|owner| owner.name))
    }

    fn read_owner(&self) -> Result<Option<Owner>> {
        match self.study_state()? {
            State::Missing => Ok(None),
            State::Valid(owner) => Ok(Some(owner)),
            State::Damaged(problem) => {
                let root = quote::path(self.root());
                Err(Error::Disk {
                    path: self.study_path(),
                    problem: format!(
                        "damaged: {problem}\n  next: `billow doctor --repair {root}`, or `billow run \
                         STUDY --results {root}` with the study file: it writes the file again"
                    ),
                })
            }
        }
    }

    /// The state of study.json.
    ///
    /// # Errors
    /// [`Error::Disk`] when it cannot be read, belongs to another program, or is of another version.
    fn study_state(&self) -> Result<State> {
        let path = self.study_path();
        let bytes = match self.files().read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(State::Missing),
            Err(error) => return Err(disk_error(&path, &error)),
        };
        let Ok(text) = String::from_utf8(bytes) else {
            return Ok(State::Damaged("it is not UTF-8 text".to_owned()));
        };
        let sealed = seal::open(&text);
        if sealed == Err(seal::SealError::Changed) {
            return Ok(State::Damaged(seal::SealError::Changed.to_string()));
        }
        let owner = match serde_json::from_str::<Owner>(&text) {
            Ok(owner) => owner,
            Err(error) => {
                return Ok(State::Damaged(format!("not a study.json of billow: {error}")));
            }
        };
        if owner.format != FORMAT {
            return Err(self.refused(&format!("format {:?} is not {FORMAT:?}", owner.format)));
        }
        if owner.version != VERSION {
            return Err(self.refused(&format!(
                "version {}, this program reads version {VERSION}: another billow wrote it",
                owner.version
            )));
        }
        Ok(match sealed {
            Ok(_) => State::Valid(owner),
            Err(error) => State::Damaged(error.to_string()),
        })
    }

    fn refused(&self, problem: &str) -> Error {
        Error::Disk {
            path: self.study_path(),
            problem: format!("{problem}\n  next: choose another folder with --results DIR"),
        }
    }

    /// Writes study.json and returns its text. An equal file is not written again. The file of another form of the
    /// study becomes previous.json. A damaged file is kept in the folder `damaged`. `study` is the file of the study, an
    /// object; `journal` is that of the folder.
    ///
    /// # Errors
    /// [`Error::Disk`] when the folder belongs to another study, or to a program with another version of the file.
    pub fn write_study(&self, name: &str, study: &Json, journal: &Journal) -> Result<String> {
        let path = self.study_path();
        let owner = match self.study_state()? {
            State::Missing => journal.study_owner(),
            State::Valid(owner) => Some(owner.name),
            // Without a record the file may be one of another program.
            State::Damaged(problem) if journal.is_empty() => return Err(self.refused(&problem)),
            State::Damaged(_) => {
                self.set_aside(&path)?;
                journal.study_owner()
            }
        };
        if let Some(owner) = owner.filter(|owner| owner != name) {
            return Err(self.refused(&format!(
                "the folder holds results of the study {owner:?}, not of {name:?}; if it is this study under an \
                 earlier name, give \"name\": {owner:?} in the study file"
            )));
        }
        let text = study_text(name, study).map_err(|error| disk_error(&path, &error))?;
        if path.exists() && !self.holds(name, study)? {
            let previous = self.previous_path();
            let before = self.files().read(&path).map_err(|error| disk_error(&path, &error))?;
            files::write_if_changed(self.files(), &previous, &before)
                .map_err(|error| disk_error(&previous, &error))?;
        }
        self.write_study_text(&text)?;
        Ok(text)
    }

    /// Writes study.json again as the journal has it, if it is damaged or missing and the journal has it. The
    /// damaged file is kept in the folder `damaged`. Returns whether it was written.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn restore_study(&self, journal: &Journal) -> Result<bool> {
        let Some(text) = &journal.study else { return Ok(false) };
        match self.study_state()? {
            State::Valid(_) => return Ok(false),
            State::Missing => {}
            State::Damaged(_) => self.set_aside(&self.study_path())?,
        }
        self.write_study_text(text).map(|()| true)
    }

    /// Writes the text of study.json. An equal file is not written again.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn write_study_text(&self, text: &str) -> Result<()> {
        let path = self.study_path();
        files::write_if_changed(self.files(), &path, text.as_bytes())
            .map_err(|error| disk_error(&path, &error))?;
        Ok(())
    }

    /// Whether the folder was last run for this file of a study. The units in which quantities are shown, and the limits
    /// of jobs, do not count.
    ///
    /// # Errors
    /// [`Error::Disk`] when study.json cannot be read.
    pub fn holds(&self, name: &str, study: &Json) -> Result<bool> {
        let path = self.study_path();
        let stored = self.files().read(&path).map_err(|error| disk_error(&path, &error))?;
        let text = |name: &str, study: &Json| {
            study_text(name, study).map_err(|error| disk_error(&path, &error))
        };
        if stored == text(name, study)?.as_bytes() {
            return Ok(true);
        }
        let Ok(stored) = Study::load(&path, &[]) else { return Ok(false) };
        let stored = text(&stored.name, &without_units(stored.file().clone()))?;
        Ok(stored == text(name, &without_units(study.clone()))?)
    }
}

impl Journal {
    /// Name of the study in the journal's copy of study.json.
    fn study_owner(&self) -> Option<String> {
        Some(serde_json::from_str::<Owner>(self.study.as_deref()?).ok()?.name)
    }
}
