//! A folder of our own that is gone once nobody holds it.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// An empty folder among the system's temporary files, removed with all in it on drop.
#[derive(Debug)]
pub struct Scratch {
    path: PathBuf,
}

impl Scratch {
    /// Creates one; `word` is part of its name.
    ///
    /// # Errors
    /// Whatever the system says.
    pub fn new(word: &str) -> io::Result<Self> {
        let mut number = 0_u32;
        loop {
            let name = format!("billow-{word}-{}-{number}", std::process::id());
            let path = std::env::temp_dir().join(name);
            match fs::create_dir(&path) {
                Ok(()) => return Ok(Self { path }),
                // Held by this process, or left by a killed one of the same number.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
                Err(error) => return Err(error),
            }
        }
    }

    /// Where it lies.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What cannot be removed lies among temporary files, where the system clears it away.
        let _ = fs::remove_dir_all(&self.path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scratch_folders_differ_and_are_removed_with_what_is_in_them() {
        let one = Scratch::new("test").unwrap();
        let other = Scratch::new("test").unwrap();
        assert_ne!(one.path(), other.path());
        fs::write(one.path().join("file"), b"bytes").unwrap();
        let path = one.path().to_owned();
        drop(one);
        assert!(!path.exists() && other.path().is_dir());
    }
}
