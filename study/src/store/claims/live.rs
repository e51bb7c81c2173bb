//! Which runs work in a results folder, for readers, and for commands that must be alone in it.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::{ATTEMPTS, LEASE, Owner, RUN, lease, read, remove, time};
use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::files::{self, disk_error};
use crate::store::results::Results;

/// A run that claims jobs, as a reader sees it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LiveRun {
    /// Whose run it is.
    pub owner: String,
    /// Jobs that it has, in order.
    pub jobs: Vec<JobId>,
}

impl Results<'_> {
    /// Path of the claims.
    pub fn claims_path(&self) -> PathBuf {
        self.root().join("claims")
    }

    /// The runs that share the folder and are alive, with the jobs that they have. By the clock of this machine.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn live_runs(&self) -> Result<Vec<LiveRun>> {
        let mut runs: Vec<(Owner, LiveRun)> = Vec::new();
        let (mut files, mut claimed) = (Vec::new(), Vec::new());
        for path in self.claim_files()? {
            match path.extension() {
                Some(end) if end == RUN => files.push(path),
                Some(_) => {}
                None => claimed.push(path),
            }
        }
        for path in files {
            if let Some(owner) = self.live_owner(&path)? {
                let run = LiveRun { owner: owner.name.clone(), jobs: Vec::new() };
                runs.push((owner, run));
            }
        }
        for path in claimed {
            let id = path.file_name().and_then(|name| JobId::from_digits(name.to_str()?));
            let owner = read(self.files(), &path)?.and_then(|(owner, _)| owner);
            let run = owner.and_then(|owner| runs.iter_mut().find(|(known, _)| *known == owner));
            if let (Some(id), Some((_, run))) = (id, run) {
                run.jobs.push(id);
            }
        }
        Ok(runs.into_iter().map(|(_, run)| run).collect())
    }

    /// Refuses a command that must be alone while a run that shares the folder is alive.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn refuse_live_runs(&self) -> Result<()> {
        let runs = self.live_runs()?;
        let Some(first) = runs.first() else { return Ok(()) };
        Err(Error::Disk {
            path: self.root().to_owned(),
            problem: format!(
                "{} in this folder with --shared (the first is {})\n  next: wait until they have ended, at most {} s \
                 after one was killed; or use billow run --shared too",
                if runs.len() == 1 {
                    "a run works".to_owned()
                } else {
                    format!("{} runs work", runs.len())
                },
                first.owner,
                LEASE.as_secs(),
            ),
        })
    }

    /// Removes the claims of dead runs, and returns the paths of their attempts. Only for the process that holds the
    /// lock alone.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn take_dead_runs(&self) -> Result<Vec<PathBuf>> {
        let (mut dead, mut attempts) = (Vec::new(), Vec::new());
        for path in self.claim_files()? {
            if path.extension().is_some_and(|end| end == ATTEMPTS) {
                let run = path.with_extension(RUN);
                if self.live_owner(&run)?.is_none() {
                    attempts.push(path);
                }
            } else if files::is_temporary(&path) || self.live_owner(&path)?.is_none() {
                dead.push(path);
            }
        }
        for path in dead {
            remove(self.files(), &path)?;
        }
        Ok(attempts)
    }

    fn claim_files(&self) -> Result<Vec<PathBuf>> {
        let folder = self.claims_path();
        self.files().list(&folder).map_err(|error| disk_error(&folder, &error))
    }

    /// The owner of a claim that is not over.
    fn live_owner(&self, path: &Path) -> Result<Option<Owner>> {
        let Some((owner, stamp)) = read(self.files(), path)? else { return Ok(None) };
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let is_over = now.saturating_sub(time(&stamp)) > lease(owner.as_ref());
        Ok(owner.filter(|_| !is_over))
    }
}
