//! A temporary folder that is removed on drop.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// An empty folder in the system's folder of temporary files. Drop removes it with its contents.
#[derive(Debug)]
pub struct Scratch {
    path: PathBuf,
}

impl Scratch {
    /// Creates a folder with `word` in its name.
    ///
    /// # Errors
    /// The error of the system.
    pub fn new(word: &str) -> io::Result<Self> {
        let mut number = 0_u32;
        loop {
            let name = format!("billow-{word}-{}-{number}", std::process::id());
            let path = std::env::temp_dir().join(name);
            match fs::create_dir(&path) {
                Ok(()) => return Ok(Self { path }),
                // Used by this process, or left by a killed process with the same number.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
                Err(error) => return Err(error),
            }
        }
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // A folder that cannot be removed stays among the temporary files of the system.
        let _ = fs::remove_dir_all(&self.path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scratch_folders_differ_and_are_removed_with_their_contents() {
        let first = Scratch::new("test").unwrap();
        let second = Scratch::new("test").unwrap();
        assert_ne!(first.path(), second.path());
        fs::write(first.path().join("file"), b"bytes").unwrap();
        let path = first.path().to_owned();
        drop(first);
        assert!(!path.exists() && second.path().is_dir());
    }
}
