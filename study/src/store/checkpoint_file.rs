//! Checkpoints of running jobs: `checkpoints/<job id>.json`, the text of
//! [`billow_solver::output::checkpoint`]. The fingerprint of the scene is the job id.
//!
//! A checkpoint only saves time: without it, or where it is damaged, a job gives the same result.

use std::io;
use std::path::PathBuf;

use billow_solver::integrators::StoredFilm;
use billow_solver::models::run::Run;
use billow_solver::output::checkpoint::{Checkpoint, CheckpointError};

use crate::job::JobId;
use crate::platform::error;
use crate::platform::files::{self, disk_error};
use crate::store::results::Results;

/// A checkpoint as a run resumes from it.
type FilmCheckpoint = Checkpoint<StoredFilm, Run>;

impl Results<'_> {
    /// Simulated time of a job's checkpoint, s; `None` without a readable one.
    pub fn checkpoint_time(&self, id: &JobId) -> Option<f64> {
        let text = self.read_checkpoint(id).ok()??;
        let checkpoint = FilmCheckpoint::from_text(&text, id.as_str()).ok()?;
        Some(checkpoint.state.state.time)
    }

    /// Checkpoints that are damaged or belong to another job, and what is wrong with them. One of another version is not:
    /// its job starts from its beginning.
    ///
    /// # Errors
    /// [`error::Error::Disk`].
    pub fn damaged_checkpoints(&self) -> error::Result<Vec<(PathBuf, String)>> {
        let mut damaged = Vec::new();
        for id in self.checkpoints()? {
            let problem = match self.read_checkpoint(&id) {
                Ok(None) => None,
                Ok(Some(text)) => match FilmCheckpoint::from_text(&text, id.as_str()) {
                    Ok(_)
                    | Err(CheckpointError::Version { .. } | CheckpointError::Physics { .. }) => {
                        None
                    }
                    Err(error) => Some(error.to_string()),
                },
                Err(error) => Some(error.to_string()),
            };
            damaged.extend(problem.map(|problem| (self.checkpoint_path(&id), problem)));
        }
        Ok(damaged)
    }

    /// Path of the checkpoints.
    pub fn checkpoints_path(&self) -> PathBuf {
        self.root().join("checkpoints")
    }

    /// Path of a job's checkpoint.
    pub fn checkpoint_path(&self, id: &JobId) -> PathBuf {
        self.checkpoints_path().join(format!("{id}.json"))
    }

    /// Jobs that have a checkpoint.
    ///
    /// # Errors
    /// [`error::Error::Disk`] when the folder cannot be listed.
    pub fn checkpoints(&self) -> error::Result<Vec<JobId>> {
        let folder = self.checkpoints_path();
        let paths = self.files().list(&folder).map_err(|error| disk_error(&folder, &error))?;
        let named = paths.iter().filter(|path| path.extension().is_some_and(|end| end == "json"));
        Ok(named.filter_map(|path| JobId::from_digits(path.file_stem()?.to_str()?)).collect())
    }

    /// The text of a job's checkpoint; `None` without one. The checksum in the text shows damage.
    ///
    /// # Errors
    /// [`error::Error::Disk`] when the file exists but cannot be read.
    pub fn read_checkpoint(&self, id: &JobId) -> error::Result<Option<String>> {
        let path = self.checkpoint_path(id);
        match self.files().read(&path) {
            Ok(bytes) => Ok(Some(String::from_utf8_lossy(&bytes).into_owned())),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(disk_error(&path, &error)),
        }
    }

    /// Stores the checkpoint of a job in place of its last one.
    ///
    /// # Errors
    /// [`error::Error::Disk`].
    pub fn write_checkpoint(&self, id: &JobId, text: &str) -> error::Result<()> {
        let (folder, path) = (self.checkpoints_path(), self.checkpoint_path(id));
        let write = || -> io::Result<()> {
            if self.files().create_folder(&folder)? {
                self.files().sync_folder(self.root())?;
            }
            files::write_atomic(self.files(), &path, text.as_bytes())
        };
        write().map_err(|error| disk_error(&path, &error))
    }

    /// Removes the checkpoint of a job that has ended.
    ///
    /// # Errors
    /// [`error::Error::Disk`].
    pub fn remove_checkpoint(&self, id: &JobId) -> error::Result<()> {
        let path = self.checkpoint_path(id);
        match self.files().remove(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(disk_error(&path, &error)),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use billow_solver::platform::seal;

    use super::*;
    use crate::platform::files::Disk;

    #[test]
    fn a_checkpoint_is_listed_read_replaced_and_removed() {
        let folder = tempfile::tempdir().unwrap();
        let results = Results::new(&Disk, folder.path());
        let id = JobId::from_digits(&"ab".repeat(16)).unwrap();
        assert_eq!(results.read_checkpoint(&id).unwrap(), None);
        assert!(results.checkpoints().unwrap().is_empty());
        for text in ["first", "second"] {
            results.write_checkpoint(&id, text).unwrap();
            assert_eq!(results.read_checkpoint(&id).unwrap().as_deref(), Some(text));
        }
        assert_eq!(results.checkpoints().unwrap(), std::slice::from_ref(&id));
        assert_eq!(results.checkpoint_time(&id), None);
        assert_eq!(results.damaged_checkpoints().unwrap().len(), 1);
        let other = r#"{"format":"billow-checkpoint","version":1,"physics_version":0}"#;
        results.write_checkpoint(&id, &seal::seal(other)).unwrap();
        assert!(results.damaged_checkpoints().unwrap().is_empty(), "of another version");
        results.write_checkpoint(&id, other).unwrap();
        assert_eq!(results.damaged_checkpoints().unwrap()[0].0, results.checkpoint_path(&id));
        results.remove_checkpoint(&id).unwrap();
        results.remove_checkpoint(&id).unwrap();
        assert_eq!(results.read_checkpoint(&id).unwrap(), None);
    }
}
