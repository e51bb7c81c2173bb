//! Which results a reading command means.

use std::path::{Path, PathBuf};

use super::Global;
use super::run::results_folder;
use crate::error::{Error, InputError, Result};
use crate::files::{Disk, Files};
use crate::study::Study;

/// The results folder meant: a folder, or that of a study file, or the only one there is.
///
/// # Errors
/// [`Error::Disk`] or [`Error::Input`] when there is none, or several.
pub fn folder(study: Option<&Path>, global: &Global) -> Result<PathBuf> {
    if let Some(results) = &global.results {
        return Ok(results.clone());
    }
    let Some(given) = study else { return only_folder() };
    let named = Path::new("results").join(given);
    if given.is_dir() {
        Ok(given.to_owned())
    } else if !given.exists() && named.is_dir() {
        Ok(named)
    } else if !given.exists() {
        Err(Error::Disk {
            path: given.to_owned(),
            problem: "neither a study file nor a folder of results\n  next: name a study file, or \
                      the folder of its results"
                .to_owned(),
        })
    } else {
        Ok(results_folder(global, &Study::load(given, &global.set)?))
    }
}

fn only_folder() -> Result<PathBuf> {
    let results = Path::new("results");
    let mut folders = Disk.list(results).unwrap_or_default();
    folders
        .retain(|path| path.join("summary.parquet").is_file() || path.join("study.json").is_file());
    match folders.as_slice() {
        [one] => Ok(one.clone()),
        several => {
            let names: Vec<String> =
                several.iter().map(|path| path.display().to_string()).collect();
            Err(InputError {
                file: "results".to_owned(),
                key: String::new(),
                value: String::new(),
                problem: if names.is_empty() {
                    "no results under the current folder".to_owned()
                } else {
                    "results of several studies under the current folder".to_owned()
                },
                allowed: if names.is_empty() {
                    "a study file, or a folder of results".to_owned()
                } else {
                    names.join(", ")
                },
                hint: "name one".to_owned(),
            }
            .into())
        }
    }
}
