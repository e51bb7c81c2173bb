//! What was given to a scheduler: which jobs each task has, and the numbers that the scheduler gave.

use std::io;
use std::path::{Path, PathBuf};

use billow_solver::platform::seal;
use serde::{Deserialize, Serialize};

use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::files::{self, disk_error};
use crate::store::results::Results;

/// Name of the format.
const FORMAT: &str = "billow-submission";
/// Version of the format that this program writes, and the newest that it reads.
const VERSION: u64 = 1;
/// Names of the files of a submission.
const CHUNKS: &str = "chunks.json";
const QUEUE: &str = "queue.json";

/// The text of chunks.json.
#[derive(Debug, Serialize, Deserialize)]
struct Chunks {
    format: String,
    version: u64,
    #[serde(rename = "chunks")]
    tasks: Vec<Vec<String>>,
}

/// The numbers that the scheduler gave.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Queued {
    /// Number of the array of tasks.
    pub array: String,
    /// Number of the task that writes the table.
    pub merge: String,
}

/// A submission that is on disk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Submission {
    /// Its name: "0001".
    pub name: String,
    /// Its folder.
    pub folder: PathBuf,
}

impl Submission {
    /// Creates the next submission of a folder, with its chunks. Only for the process that holds the lock.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn create(results: &Results<'_>, chunks: &[Vec<JobId>]) -> Result<Self> {
        let submissions = results.submissions_path();
        let last = names(results)?.iter().filter_map(|name| name.parse::<u64>().ok()).max();
        let name = format!("{:04}", last.unwrap_or(0) + 1);
        let folder = submissions.join(&name);
        let text = Chunks {
            format: FORMAT.to_owned(),
            version: VERSION,
            tasks: chunks
                .iter()
                .map(|chunk| chunk.iter().map(|id| id.as_str().to_owned()).collect())
                .collect(),
        };
        let write = || -> io::Result<()> {
            results.files().create_folder(&folder)?;
            let object = serde_json::to_string(&text).map_err(io::Error::other)?;
            let text = seal::seal(&object) + "\n";
            files::write_atomic(results.files(), &folder.join(CHUNKS), text.as_bytes())
        };
        write().map_err(|error| disk_error(&folder, &error))?;
        Ok(Self { name, folder })
    }

    /// The last submission of a folder that the scheduler took, with its numbers; `None` without one.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn last_queued(results: &Results<'_>) -> Result<Option<(Self, Queued)>> {
        for name in names(results)?.into_iter().rev() {
            let folder = results.submissions_path().join(&name);
            let path = folder.join(QUEUE);
            let bytes = match results.files().read(&path) {
                Ok(bytes) => bytes,
                Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
                Err(error) => return Err(disk_error(&path, &error)),
            };
            let queued = serde_json::from_slice(&bytes).map_err(|error| Error::Disk {
                path,
                problem: format!(
                    "not the numbers of a scheduler: {error}\n  next: delete the file"
                ),
            })?;
            return Ok(Some((Self { name, folder }, queued)));
        }
        Ok(None)
    }

    /// Writes a file of the submission, and returns its path.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn write(&self, results: &Results<'_>, name: &str, text: &str) -> Result<PathBuf> {
        let path = self.folder.join(name);
        files::write_atomic(results.files(), &path, text.as_bytes())
            .map_err(|error| disk_error(&path, &error))?;
        Ok(path)
    }

    /// Records the numbers that the scheduler gave.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn write_queued(&self, results: &Results<'_>, queued: &Queued) -> Result<()> {
        let text = serde_json::to_string(queued);
        let text = text.map_err(|error| disk_error(&self.folder, &io::Error::other(error)))?;
        self.write(results, QUEUE, &(text + "\n")).map(|_| ())
    }
}

/// The jobs of a chunk, named as "0001/3": submission 0001, task 3 (from 1).
///
/// # Errors
/// [`Error::Input`] where there is no such chunk; [`Error::Disk`] for a damaged file.
pub fn chunk(results: &Results<'_>, name: &str) -> Result<Vec<JobId>> {
    let refuse = |problem: String| {
        let allowed = "SUBMISSION/TASK, as in 0001/3: task 3 of submissions/0001";
        Error::invalid_option("--chunk", name, problem, allowed, "billow submit makes submissions")
    };
    let parts = name.split_once('/');
    let parts = parts.and_then(|(submission, task)| {
        let is_name =
            !submission.is_empty() && submission.bytes().all(|byte| byte.is_ascii_digit());
        Some((submission, task.parse::<usize>().ok().filter(|task| *task > 0 && is_name)?))
    });
    let (submission, task) = parts.ok_or_else(|| refuse("is no chunk".to_owned()))?;
    let path = results.submissions_path().join(submission).join(CHUNKS);
    let chunks = match read(results, &path) {
        Err(ReadError::Missing) => return Err(refuse(format!("there is no {}", path.display()))),
        Err(ReadError::Other(error)) => return Err(error),
        Ok(chunks) => chunks.tasks,
    };
    let chunk = chunks
        .get(task - 1)
        .ok_or_else(|| refuse(format!("submission {submission} has {} tasks", chunks.len())))?;
    let ids = chunk.iter().map(|digits| JobId::from_digits(digits));
    let ids: Option<Vec<JobId>> = ids.collect();
    ids.ok_or_else(|| damaged(&path, "a text in it is no job id"))
}

enum ReadError {
    Missing,
    Other(Error),
}

fn read(results: &Results<'_>, path: &Path) -> std::result::Result<Chunks, ReadError> {
    let bytes = results.files().read(path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => ReadError::Missing,
        _ => ReadError::Other(disk_error(path, &error)),
    })?;
    let damaged = |problem: &str| ReadError::Other(damaged(path, problem));
    let text = String::from_utf8(bytes).map_err(|_| damaged("not UTF-8 text"))?;
    let object = seal::open(text.trim_end()).map_err(|error| damaged(&error.to_string()))?;
    let chunks: Chunks =
        serde_json::from_str(&object).map_err(|error| damaged(&error.to_string()))?;
    if chunks.format != FORMAT || chunks.version > VERSION {
        return Err(damaged("a newer billow wrote it"));
    }
    Ok(chunks)
}

fn damaged(path: &Path, problem: &str) -> Error {
    Error::Disk {
        path: path.to_owned(),
        problem: format!(
            "damaged: {problem}\n  next: billow submit again: it submits what is missing"
        ),
    }
}

/// Names of the submissions of a folder, in their order.
fn names(results: &Results<'_>) -> Result<Vec<String>> {
    let folder = results.submissions_path();
    let paths = results.files().list(&folder).map_err(|error| disk_error(&folder, &error))?;
    let name = |path: PathBuf| Some(path.file_name()?.to_str()?.to_owned());
    Ok(paths.into_iter().filter_map(name).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::files::Disk;

    fn id(number: u32) -> JobId {
        JobId::from_digits(&format!("{number:032x}")).unwrap()
    }

    #[test]
    fn chunks_are_those_that_were_submitted() {
        let folder = tempfile::tempdir().unwrap();
        let results = Results::new(&Disk, folder.path());
        let first = Submission::create(&results, &[vec![id(1), id(2)], vec![id(3)]]).unwrap();
        let second = Submission::create(&results, &[vec![id(3)]]).unwrap();
        assert_eq!((first.name.as_str(), second.name.as_str()), ("0001", "0002"));
        assert_eq!(chunk(&results, "0001/1").unwrap(), [id(1), id(2)]);
        assert_eq!(chunk(&results, "0002/1").unwrap(), [id(3)]);
        for name in ["", "1", "0001", "0001/0", "0001/3", "0003/1", "../0001/1", "0001/x"] {
            let error = chunk(&results, name).unwrap_err().to_string();
            assert!(error.contains("--chunk") && error.contains("next:"), "{name}: {error}");
        }
        let path = first.folder.join(CHUNKS);
        let text = String::from_utf8(results.files().read(&path).unwrap()).unwrap();
        let changed = text.replace("0001\"", "0009\"");
        files::write_atomic(&Disk, &path, changed.as_bytes()).unwrap();
        assert!(chunk(&results, "0001/1").unwrap_err().to_string().contains("damaged"));
    }

    #[test]
    fn the_last_submission_that_the_scheduler_took_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let results = Results::new(&Disk, folder.path());
        assert_eq!(Submission::last_queued(&results).unwrap(), None);
        let first = Submission::create(&results, &[vec![id(1)]]).unwrap();
        let queued = Queued { array: "12".to_owned(), merge: "13".to_owned() };
        first.write_queued(&results, &queued).unwrap();
        Submission::create(&results, &[vec![id(1)]]).unwrap();
        assert_eq!(Submission::last_queued(&results).unwrap(), Some((first, queued)));
    }
}
