//! study.json: which study a results folder belongs to. It is the resolved study, a study file.

use std::collections::BTreeMap;
use std::io;

use serde::Deserialize;

use super::Results;
use crate::input::study_file::Json;
use crate::input::units::DisplayUnits;
use crate::platform::error::{Error, Result};
use crate::platform::files::{self, disk_error};
use crate::study::{JOB_LIMITS, Study, UNITS};

/// Name of the format.
const FORMAT: &str = "billow-study";
/// Version of study.json that this program writes, and the newest that it reads.
const VERSION: u64 = 1;

/// The members that say which study it is.
#[derive(Deserialize)]
struct Owner {
    format: String,
    version: u64,
    name: String,
    /// Units in which quantities are shown, by name of parameter or column.
    #[serde(default)]
    units: BTreeMap<String, String>,
}

/// The bytes of study.json for a resolved study.
fn study_bytes(name: &str, study: &Json) -> io::Result<Vec<u8>> {
    let mut study = study.clone();
    study.set("format", Json::Text(FORMAT.to_owned()));
    study.set("version", Json::Integer(VERSION.cast_signed()));
    study.set("name", Json::Text(name.to_owned()));
    let mut bytes = serde_json::to_vec_pretty(&study).map_err(io::Error::other)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// A resolved study without the units in which its quantities are shown, and the limits of its jobs.
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
    /// [`Error::Disk`] when study.json cannot be read, is not valid, or is of a newer version.
    pub fn owner(&self) -> Result<Option<String>> {
        Ok(self.read_owner()?.map(|owner| owner.name))
    }

    /// The units in which the study's quantities are shown; SI without study.json.
    ///
    /// # Errors
    /// As [`Self::owner`].
    pub fn display_units(&self) -> Result<DisplayUnits> {
        let mut units = DisplayUnits::si();
        for (name, symbol) in self.read_owner()?.iter().flat_map(|owner| &owner.units) {
            units.set(name, symbol);
        }
        Ok(units)
    }

    fn read_owner(&self) -> Result<Option<Owner>> {
        let path = self.study_path();
        let bytes = match self.files().read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(disk_error(&path, &error)),
        };
        let owner: Owner = serde_json::from_slice(&bytes)
            .map_err(|error| self.refused(&format!("not a study.json of billow: {error}")))?;
        if owner.format != FORMAT {
            return Err(self.refused(&format!("format {:?} is not {FORMAT:?}", owner.format)));
        }
        if owner.version > VERSION {
            return Err(self.refused(&format!(
                "version {}, this program reads up to {VERSION}: a newer billow wrote it",
                owner.version
            )));
        }
        Ok(Some(owner))
    }

    fn refused(&self, problem: &str) -> Error {
        Error::Disk {
            path: self.study_path(),
            problem: format!("{problem}\n  next: choose another folder with --results DIR"),
        }
    }

    /// Writes study.json. An equal file is not written again. `study` is the resolved study, an
    /// object.
    ///
    /// # Errors
    /// [`Error::Disk`] when the folder belongs to another study, or to a newer program.
    pub fn write_study(&self, name: &str, study: &Json) -> Result<()> {
        if let Some(owner) = self.owner()?.filter(|owner| owner != name) {
            return Err(self.refused(&format!(
                "the folder holds results of the study {owner:?}, not of {name:?}"
            )));
        }
        let path = self.study_path();
        let bytes = study_bytes(name, study).map_err(|error| disk_error(&path, &error))?;
        files::write_if_changed(self.files(), &path, &bytes)
            .map_err(|error| disk_error(&path, &error))?;
        Ok(())
    }

    /// Whether the folder was last run for this resolved study. A study.json with old names of keys
    /// is compared by its meaning. The units in which quantities are shown, and the limits
    /// of jobs, do not count.
    ///
    /// # Errors
    /// [`Error::Disk`] when study.json cannot be read.
    pub fn holds(&self, name: &str, study: &Json) -> Result<bool> {
        let path = self.study_path();
        let stored = self.files().read(&path).map_err(|error| disk_error(&path, &error))?;
        let bytes = |name: &str, study: &Json| {
            study_bytes(name, study).map_err(|error| disk_error(&path, &error))
        };
        if stored == bytes(name, study)? {
            return Ok(true);
        }
        let Ok(stored) = Study::load(&path, &[]) else { return Ok(false) };
        let stored = bytes(&stored.name, &without_units(stored.resolved()))?;
        Ok(stored == bytes(name, &without_units(study.clone()))?)
    }
}
