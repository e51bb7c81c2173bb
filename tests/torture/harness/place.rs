//! The folder of a trial.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// A folder in which a trial runs, and a folder beside it for what the program says.
#[derive(Clone)]
pub struct Place {
    path: PathBuf,
    said: PathBuf,
}

impl Place {
    /// An empty place at `root`; what was there is removed.
    pub fn new(root: &Path) -> io::Result<Self> {
        if root.exists() {
            remove(root)?;
        }
        let place = Self { path: root.join("work"), said: root.join("said") };
        fs::create_dir_all(&place.path)?;
        fs::create_dir_all(&place.said)?;
        Ok(place)
    }

    /// A place with the same files for what is said, but another work folder.
    pub fn with_path(&self, path: &Path) -> Self {
        Self { path: path.to_owned(), said: self.said.clone() }
    }

    /// The work folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A path in the work folder.
    pub fn join(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Folder of stdout and stderr.
    pub fn said(&self) -> &Path {
        &self.said
    }

    /// Folder of the results of the study `s.json`.
    pub fn results(&self) -> PathBuf {
        self.path.join("results/s")
    }

    /// Writes the study `s.json`.
    pub fn write_study(&self, study: &Value) {
        self.write("s.json", study.to_string().as_bytes());
    }

    /// Writes a file of the work folder.
    pub fn write(&self, name: &str, bytes: &[u8]) {
        fs::write(self.join(name), bytes).expect("a file of a trial");
    }

    /// Copies everything of another place, with the times of its files.
    pub fn copy_from(&self, other: &Self) {
        copy(&other.path, &self.path);
    }

    /// Removes everything.
    pub fn remove(&self) {
        if let Some(root) = self.path.parent() {
            let _ = remove(root);
        }
    }
}

/// Copies the files of a folder into another one, with their times and links.
pub fn copy(from: &Path, to: &Path) {
    let status = Command::new("cp").arg("-a").arg(from.join(".")).arg(to).status();
    assert!(status.is_ok_and(|status| status.success()), "cp -a {} failed", from.display());
}

/// Removes a folder, also one with folders that are not writable.
fn remove(root: &Path) -> io::Result<()> {
    if fs::remove_dir_all(root).is_ok() {
        return Ok(());
    }
    let _ = Command::new("chmod").args(["-R", "u+rwX"]).arg(root).status();
    fs::remove_dir_all(root)
}

/// Every file under a folder, in order; hidden ones, too.
pub fn files(root: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = fs::read_dir(&folder) else { continue };
        for entry in entries.flatten() {
            let path = entry.path();
            if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                folders.push(path);
            } else {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}
