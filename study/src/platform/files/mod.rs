//! Access to the disk. No other module calls the file system.
//!
//! A result file is never incomplete: it is written under a temporary name in the same folder, synced
//! and renamed, and the folder is synced ([`write_atomic`]). Only the journal grows in place, with one
//! synced append at a time. All access goes through [`Files`], so that tests can make any write fail
//! ([`failing::FailingFiles`]).

#![expect(clippy::disallowed_methods, reason = "this module is the access to the disk")]

use std::fs::{self, File};
use std::io::{self, Read};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::platform::error::Error;
use crate::platform::nearest::nearest;

mod atomic;
mod disk;
pub mod failing;

pub use atomic::{
    build_output, is_temporary, remove_stale_files, remove_temporary_files, write_atomic,
    write_if_changed, write_output,
};
pub use disk::Disk;

/// The disk operations of the program.
pub trait Files: Send + Sync {
    /// Creates a folder and its parents. Returns `false` when it existed already.
    ///
    /// # Errors
    /// The error of the system.
    fn create_folder(&self, path: &Path) -> io::Result<bool>;

    /// Reads a whole file.
    ///
    /// # Errors
    /// The error of the system.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.open(path)?.read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    /// Opens a file for reading.
    ///
    /// # Errors
    /// The error of the system.
    fn open(&self, path: &Path) -> io::Result<Box<dyn io::Read>>;

    /// Size and time of a file.
    ///
    /// # Errors
    /// The error of the system.
    fn stamp(&self, path: &Path) -> io::Result<Stamp>;

    /// Paths in a folder, sorted by name; none for a missing folder.
    ///
    /// # Errors
    /// The error of the system.
    fn list(&self, path: &Path) -> io::Result<Vec<PathBuf>>;

    /// Writes a new file and syncs it. An existing file is an error.
    ///
    /// # Errors
    /// The error of the system.
    fn write_new(&self, path: &Path, bytes: &[u8]) -> io::Result<()>;

    /// Renames a file and replaces an existing one.
    ///
    /// # Errors
    /// The error of the system.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;

    /// Syncs a folder, so that a rename in it survives a power cut.
    ///
    /// # Errors
    /// The error of the system.
    fn sync_folder(&self, path: &Path) -> io::Result<()>;

    /// Removes a file.
    ///
    /// # Errors
    /// The error of the system.
    fn remove(&self, path: &Path) -> io::Result<()>;

    /// Creates a file to append to; the error `AlreadyExists` when it exists.
    ///
    /// # Errors
    /// The error of the system.
    fn create_append(&self, path: &Path) -> io::Result<Box<dyn Append>>;

    /// Takes the lock of that file; `None` when another process holds it. The system releases the
    /// lock when the process ends, also after a crash.
    ///
    /// # Errors
    /// The error of the system.
    fn try_lock(&self, path: &Path) -> io::Result<Option<Lock>>;

    /// Whether another process holds the lock of that file. The check takes a shared lock for an
    /// instant; a process that takes the lock at that moment must try again.
    ///
    /// # Errors
    /// The error of the system.
    fn is_locked(&self, path: &Path) -> io::Result<bool>;
}

/// Size and time of a file: when both are those of its writing, it was hardly changed since.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    /// Size, bytes.
    pub size: u64,
    /// Time of its last change, s and ns since 1970: "1764000000.000000001".
    pub modified: String,
}

/// A file that only grows.
pub trait Append: Send {
    /// Appends without a sync: the bytes survive the death of the process, not a power cut.
    ///
    /// # Errors
    /// As [`Self::append`].
    fn append_unsynced(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Appends and syncs.
    ///
    /// # Errors
    /// The error of the system. The file may then end in a part of `bytes`.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;
}

/// A held lock, released on drop.
#[derive(Debug)]
pub struct Lock {
    file: File,
}

impl Lock {
    /// Whether the locked file is the file of this path; `false` if there is none.
    ///
    /// # Errors
    /// The error of the system.
    pub fn is_file(&self, path: &Path) -> io::Result<bool> {
        let locked = self.file.metadata()?;
        match fs::symlink_metadata(path) {
            Ok(found) => Ok((found.dev(), found.ino()) == (locked.dev(), locked.ino())),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
            Err(error) => Err(error),
        }
    }
}

/// Names of a folder that are compared with a mistyped one, at most (chosen: a folder of a million
/// files delays no message).
const MAX_NAMES: usize = 10_000;

/// Reads a whole file that the user named; `None` when it is larger than `limit` bytes.
///
/// # Errors
/// The error of the system.
pub fn read_at_most(path: &Path, limit: u64) -> io::Result<Option<Vec<u8>>> {
    let file = File::open(path)?;
    // The size of a pipe is 0; a list that grows takes more memory than the file.
    let size = file.metadata()?.len().min(limit);
    let mut bytes = Vec::with_capacity(usize::try_from(size).unwrap_or(0));
    file.take(limit + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= limit).then_some(bytes))
}

/// The text of /proc/self/status; `None` where the system has none.
pub fn process_status() -> Option<String> {
    fs::read_to_string("/proc/self/status").ok()
}

/// The path in the same folder whose name is nearest to that of a path that does not exist; also with
/// the ending `.json` added.
pub fn nearest_name(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    let folder = path.parent()?;
    let listed = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries = fs::read_dir(listed).ok()?.take(MAX_NAMES).flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let mut names: Vec<String> = names.filter(|known| known != name).collect();
    // The order of a folder is that of its disk.
    names.sort();
    let with_ending = format!("{name}.json");
    let exact = names.iter().find(|known| **known == with_ending).map(String::as_str);
    let near = exact.or_else(|| nearest(name, names.iter().map(String::as_str)))?;
    Some(folder.join(near).display().to_string())
}

/// Checks that an output file can be written to that path, before a long run starts.
///
/// # Errors
/// When its folder does not exist, or the path is a folder.
pub fn check_output_path(path: &Path) -> io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if !fs::metadata(folder.unwrap_or(Path::new(".")))?.is_dir() {
        return Err(io::ErrorKind::NotADirectory.into());
    }
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        _ => Ok(()),
    }
}

/// Error numbers of the system for too many open files: ENFILE (of the machine), EMFILE (of the process).
const TOO_MANY_FILES: [i32; 2] = [23, 24];

/// A disk error with path, cause and next step.
pub fn disk_error(path: &Path, error: &io::Error) -> Error {
    let next = match error.kind() {
        _ if error.to_string().contains("\n  next: ") => "",
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "\n  next: free some space and run the same command again; finished jobs are kept"
        }
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "\n  next: make it writable, or choose another folder with --results DIR or another file \
             with --out"
        }
        io::ErrorKind::AlreadyExists => {
            "\n  next: it is a file and not a folder; choose another with --results DIR or --out"
        }
        io::ErrorKind::IsADirectory => {
            "\n  next: move the folder away, or name a file; `billow doctor RESULTS` checks a results folder"
        }
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => {
            "\n  next: name a file in an existing folder; in a results folder, `billow doctor --repair` moves \
             what is in the way"
        }
        _ if error.raw_os_error().is_some_and(|code| TOO_MANY_FILES.contains(&code)) => {
            "\n  next: raise the limit of open files (ulimit -n), or use fewer --threads"
        }
        _ => "\n  next: run the same command again; if the error remains, check the disk",
    };
    Error::Disk { path: path.to_owned(), problem: format!("{error}{next}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_disk_error_has_a_next_step() {
        for code in [1, 2, 4, 5, 13, 17, 20, 21, 23, 24, 27, 28, 30, 40, 122] {
            let text = disk_error(Path::new("a"), &io::Error::from_raw_os_error(code)).to_string();
            assert!(text.contains("a: ") && text.contains("\n  next: "), "{text}");
        }
    }
}
