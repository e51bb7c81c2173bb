//! The only door to the disk.
//!
//! A file of results is never half there: it is written under a temporary name in its own folder,
//! synced, renamed, and the folder synced ([`write_atomic`]). The journal alone grows in place, one
//! synced append at a time. Everything goes through [`Files`], so that tests can fail any write
//! ([`failing::FailingFiles`]).

#![expect(clippy::disallowed_methods, reason = "this is the door")]

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::platform::error::Error;

pub mod failing;
pub mod scratch;

/// What the program asks of a disk.
pub trait Files: Send + Sync {
    /// Creates a folder and those above it. Says whether it was not there yet.
    ///
    /// # Errors
    /// Whatever the system says.
    fn create_folder(&self, path: &Path) -> io::Result<bool>;

    /// The whole file.
    ///
    /// # Errors
    /// Whatever the system says.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;

    /// Paths in a folder, sorted by name; none for a folder that is not there.
    ///
    /// # Errors
    /// Whatever the system says.
    fn list(&self, path: &Path) -> io::Result<Vec<PathBuf>>;

    /// Writes a file that is not there yet, and syncs it.
    ///
    /// # Errors
    /// Whatever the system says.
    fn write_new(&self, path: &Path, bytes: &[u8]) -> io::Result<()>;

    /// Renames, replacing what is there.
    ///
    /// # Errors
    /// Whatever the system says.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;

    /// Syncs a folder, so that a rename in it survives a power cut.
    ///
    /// # Errors
    /// Whatever the system says.
    fn sync_folder(&self, path: &Path) -> io::Result<()>;

    /// Removes a file.
    ///
    /// # Errors
    /// Whatever the system says.
    fn remove(&self, path: &Path) -> io::Result<()>;

    /// Creates a file to append to; `AlreadyExists` when it is there.
    ///
    /// # Errors
    /// Whatever the system says.
    fn create_append(&self, path: &Path) -> io::Result<Box<dyn Append>>;

    /// Takes the lock of that file, `None` when another process holds it. The system gives it back
    /// when the process ends, however it ends.
    ///
    /// # Errors
    /// Whatever the system says.
    fn try_lock(&self, path: &Path) -> io::Result<Option<Lock>>;

    /// Whether another process holds the lock of that file; changes nothing. To see it, the lock is
    /// shared for an instant, which whoever takes it waits out.
    ///
    /// # Errors
    /// Whatever the system says.
    fn is_locked(&self, path: &Path) -> io::Result<bool>;
}

/// A file that only grows.
pub trait Append: Send {
    /// Appends and syncs.
    ///
    /// # Errors
    /// Whatever the system says; the file may then end in a part of `bytes`.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;
}

/// A held lock, given back on drop.
#[derive(Debug)]
pub struct Lock {
    _file: File,
}

/// The disk itself.
#[derive(Debug, Clone, Copy, Default)]
pub struct Disk;

impl Files for Disk {
    fn create_folder(&self, path: &Path) -> io::Result<bool> {
        if path.is_dir() {
            return Ok(false);
        }
        fs::create_dir_all(path).map(|()| true)
    }

    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        fs::read(path)
    }

    fn list(&self, path: &Path) -> io::Result<Vec<PathBuf>> {
        let entries = match fs::read_dir(path) {
            Ok(entries) => entries,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => return Err(error),
        };
        let mut paths: Vec<PathBuf> =
            entries.map(|entry| entry.map(|entry| entry.path())).collect::<io::Result<_>>()?;
        paths.sort();
        Ok(paths)
    }

    fn write_new(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
        file.write_all(bytes)?;
        file.sync_all()
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }

    fn sync_folder(&self, path: &Path) -> io::Result<()> {
        File::open(path)?.sync_all()
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        fs::remove_file(path)
    }

    fn create_append(&self, path: &Path) -> io::Result<Box<dyn Append>> {
        let file = OpenOptions::new().append(true).create_new(true).open(path)?;
        Ok(Box::new(DiskAppend { file }))
    }

    fn try_lock(&self, path: &Path) -> io::Result<Option<Lock>> {
        let file = OpenOptions::new().write(true).create(true).truncate(false).open(path)?;
        match file.try_lock() {
            Ok(()) => Ok(Some(Lock { _file: file })),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(error)) => Err(error),
        }
    }

    fn is_locked(&self, path: &Path) -> io::Result<bool> {
        let file = match File::open(path) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
            Err(error) => return Err(error),
        };
        match file.try_lock_shared() {
            Ok(()) => Ok(false),
            Err(TryLockError::WouldBlock) => Ok(true),
            Err(TryLockError::Error(error)) => Err(error),
        }
    }
}

struct DiskAppend {
    file: File,
}

impl Append for DiskAppend {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)?;
        self.file.sync_data()
    }
}

/// How the name of a temporary file ends.
const TEMPORARY: &str = ".tmp";

/// The whole file a user names, `None` when it is larger than `limit` bytes.
///
/// # Errors
/// Whatever the system says.
pub fn read_at_most(path: &Path, limit: u64) -> io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(limit + 1).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= limit).then_some(bytes))
}

/// Whether a path has the name of a temporary file of ours.
pub fn is_temporary(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.starts_with('.') && name.ends_with(TEMPORARY)
}

/// Whether a file could be written there: before a long run, not after it.
///
/// # Errors
/// Its folder is none, or it is itself a folder.
pub fn check_place(path: &Path) -> io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if !fs::metadata(folder.unwrap_or(Path::new(".")))?.is_dir() {
        return Err(io::ErrorKind::NotADirectory.into());
    }
    match fs::metadata(path) {
        Ok(there) if there.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        _ => Ok(()),
    }
}

/// Writes a whole file, or leaves what was there: temporary name in the same folder, sync, rename,
/// sync of the folder.
///
/// # Errors
/// Whatever the system says; the temporary file is then removed if it can be.
pub fn write_atomic(files: &dyn Files, path: &Path, bytes: &[u8]) -> io::Result<()> {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let number = COUNTER.fetch_add(1, Ordering::Relaxed);
    let temporary =
        path.with_file_name(format!(".{name}.{}-{number}{TEMPORARY}", std::process::id()));
    let written = files.write_new(&temporary, bytes).and_then(|()| files.rename(&temporary, path));
    if written.is_err() {
        // The reason the write failed is the one to report, not a failed cleaning after it.
        let _ = files.remove(&temporary);
    }
    written?;
    // A bare name's parent is the empty path, which no system opens.
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    files.sync_folder(folder.unwrap_or(Path::new(".")))
}

/// Writes a whole file unless it holds these bytes already. Says whether it wrote.
///
/// # Errors
/// As [`write_atomic`], and a file that is there but cannot be read.
pub fn write_if_changed(files: &dyn Files, path: &Path, bytes: &[u8]) -> io::Result<bool> {
    match files.read(path) {
        Ok(there) if there == bytes => return Ok(false),
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    write_atomic(files, path, bytes).map(|()| true)
}

/// Removes the temporary files a killed process left in a folder. Only for a folder no other
/// process writes to.
///
/// # Errors
/// Whatever the system says.
pub fn sweep(files: &dyn Files, folder: &Path) -> io::Result<()> {
    for path in files.list(folder)?.iter().filter(|path| is_temporary(path)) {
        files.remove(path)?;
    }
    Ok(())
}

/// A disk error as the user meets it: the path, what happened, what to do next.
pub fn disk_error(path: &Path, error: &io::Error) -> Error {
    let next = match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "\n  next: free some space and run the same command again; what is finished is kept"
        }
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "\n  next: make it writable, or choose another place (--results DIR, or --out where a \
             command has it)"
        }
        io::ErrorKind::AlreadyExists => {
            "\n  next: a file is in the way of a folder; choose another with --results DIR or --out"
        }
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory | io::ErrorKind::IsADirectory => {
            "\n  next: name a file in a folder that is there"
        }
        _ => "",
    };
    Error::Disk { path: path.to_owned(), problem: format!("{error}{next}") }
}

#[cfg(test)]
mod tests {
    use super::failing::FailingFiles;
    use super::*;

    #[test]
    fn an_atomic_write_leaves_the_old_or_the_new_whichever_operation_fails() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        write_atomic(&Disk, &path, b"old").unwrap();
        for nth in 1..=3 {
            let failing = FailingFiles::new(nth, io::ErrorKind::StorageFull);
            write_atomic(&failing, &path, b"new, and longer").unwrap_err();
            let found = fs::read(&path).unwrap();
            // A failed sync of the folder comes after the rename.
            let expected: &[u8] = if nth == 3 { b"new, and longer" } else { b"old" };
            assert_eq!(found, expected, "operation {nth}");
            write_atomic(&Disk, &path, b"old").unwrap();
            sweep(&Disk, folder.path()).unwrap();
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        }
        let enough = FailingFiles::new(4, io::ErrorKind::StorageFull);
        write_atomic(&enough, &path, b"new").unwrap();
        assert_eq!(enough.operations(), 3);
    }

    #[test]
    fn a_file_that_would_not_change_is_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        assert!(write_if_changed(&Disk, &path, b"1").unwrap());
        assert!(!write_if_changed(&Disk, &path, b"1").unwrap());
        assert!(write_if_changed(&Disk, &path, b"2").unwrap());
    }

    #[test]
    fn a_lock_is_held_once_and_given_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let held = Disk.try_lock(&path).unwrap();
        assert!(held.is_some());
        assert!(Disk.try_lock(&path).unwrap().is_none());
        assert!(Disk.is_locked(&path).unwrap());
        drop(held);
        assert!(!Disk.is_locked(&path).unwrap());
        assert!(!Disk.is_locked(&folder.path().join("none")).unwrap());
        assert!(Disk.try_lock(&path).unwrap().is_some());
    }
}
