//! The last submission of a study: its scripts, and the numbers that the scheduler gave.

use std::io;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::platform::error::{Error, Result};
use crate::platform::files::{self, disk_error};
use crate::store::results::Results;

/// Name of the file with the numbers that the scheduler gave.
const QUEUE: &str = "queue.json";

/// The numbers that the scheduler gave.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Queued {
    /// Number of the array of tasks.
    pub array: String,
    /// Number of the task that merges their results.
    pub merge: String,
}

/// The numbers of the last submission of a folder; `None` without one.
///
/// # Errors
/// [`Error::Disk`].
pub fn last_queued(results: &Results<'_>) -> Result<Option<Queued>> {
    let path = results.submission_path().join(QUEUE);
    let bytes = match results.files().read(&path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(disk_error(&path, &error)),
    };
    serde_json::from_slice(&bytes).map(Some).map_err(|error| Error::Disk {
        path,
        problem: format!("not the numbers of a scheduler: {error}\n  next: delete the file"),
    })
}

/// Writes a file of the submission, and returns its path.
///
/// # Errors
/// [`Error::Disk`].
pub fn write(results: &Results<'_>, name: &str, text: &str) -> Result<PathBuf> {
    let folder = results.submission_path();
    let path = folder.join(name);
    let write = || -> io::Result<()> {
        results.files().create_folder(&folder)?;
        files::write_atomic(results.files(), &path, text.as_bytes())
    };
    write().map_err(|error| disk_error(&path, &error))?;
    Ok(path)
}

/// Records the numbers that the scheduler gave.
///
/// # Errors
/// [`Error::Disk`].
pub fn write_queued(results: &Results<'_>, queued: &Queued) -> Result<()> {
    let text = serde_json::to_string(queued);
    let text = text.map_err(|error| disk_error(&results.submission_path(), &error.into()))?;
    write(results, QUEUE, &(text + "\n")).map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::files::Disk;

    #[test]
    fn the_numbers_of_the_last_submission_are_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let results = Results::new(&Disk, folder.path());
        assert_eq!(last_queued(&results).unwrap(), None);
        for number in ["12", "14"] {
            let queued = Queued { array: number.to_owned(), merge: "15".to_owned() };
            write_queued(&results, &queued).unwrap();
            assert_eq!(last_queued(&results).unwrap(), Some(queued));
        }
        write(&results, QUEUE, "{}").unwrap();
        let problem = last_queued(&results).unwrap_err().to_string();
        assert!(problem.contains("not the numbers of a scheduler"), "{problem}");
    }
}
