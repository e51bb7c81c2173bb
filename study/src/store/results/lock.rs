//! The lock of a results folder: one command at a time changes it.

use std::time::Duration;

use super::{OTHER_NAMES, PUBLISHED, RESULT_NAMES, Results};
use crate::platform::error::{Error, Result};
use crate::platform::files::{Lock, disk_error};

/// Attempts to take the lock before it counts as held. Chosen: a command that only checks the lock
/// holds it for much less than the sum of the pauses.
const MAX_LOCK_ATTEMPTS: u32 = 5;
/// Pause between two attempts.
const LOCK_PAUSE: Duration = Duration::from_millis(10);

impl Results<'_> {
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
        if path.is_dir() {
            let problem = "a folder, not a lock\n  next: move it away".to_owned();
            return Err(Error::Disk { path, problem });
        }
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
    pub fn is_running(&self) -> Result<bool> {
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
        // A page alone may be that of a repository.
        let is_published = names.iter().any(|name| name == PUBLISHED);
        let known = |name: &str| {
            RESULT_NAMES.contains(&name) || (is_published && OTHER_NAMES.contains(&name))
        };
        let other = names.iter().find(|name| !known(name) && !name.starts_with('.'));
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
}
