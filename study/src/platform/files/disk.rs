//! The real disk.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

use super::{Append, Files, Lock, Stamp};

/// The disk of this machine.
#[derive(Debug, Clone, Copy, Default)]
pub struct Disk;

impl Files for Disk {
    fn create_folder(&self, path: &Path) -> io::Result<bool> {
        if path.is_dir() {
            return Ok(false);
        }
        fs::create_dir_all(path).map(|()| true)
    }

    fn open(&self, path: &Path) -> io::Result<Box<dyn io::Read>> {
        Ok(Box::new(File::open(path)?))
    }

    fn stamp(&self, path: &Path) -> io::Result<Stamp> {
        let found = fs::metadata(path)?;
        let modified = format!("{}.{:09}", found.mtime(), found.mtime_nsec());
        Ok(Stamp { size: found.len(), modified })
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
        let file = open_lock(path)?;
        taken(file.try_lock(), file)
    }

    fn is_locked(&self, path: &Path) -> io::Result<bool> {
        let opened = OpenOptions::new().read(true).custom_flags(libc::O_NOFOLLOW).open(path);
        let file = match opened {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
            Err(error) => return Err(no_link(&error)),
        };
        match file.try_lock_shared() {
            Ok(()) => Ok(false),
            Err(TryLockError::WouldBlock) => Ok(true),
            Err(TryLockError::Error(error)) => Err(error),
        }
    }
}

/// Opens the file of a lock; creates it if it is missing.
fn open_lock(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    // NFS gives a shared lock to a file open for reading only, and the other one to a file open for writing.
    options.read(true).write(true).create(true).truncate(false).custom_flags(libc::O_NOFOLLOW);
    options.open(path).map_err(|error| no_link(&error))
}

/// The lock, if it was taken.
fn taken(result: Result<(), TryLockError>, file: File) -> io::Result<Option<Lock>> {
    match result {
        Ok(()) => Ok(Some(Lock { file })),
        Err(TryLockError::WouldBlock) => Ok(None),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

/// The error of a lock that is a symbolic link, in words; any other error as it is.
fn no_link(error: &io::Error) -> io::Error {
    match error.raw_os_error() {
        Some(libc::ELOOP) => {
            io::Error::other("a symbolic link, not a lock\n  next: remove the link")
        }
        _ => io::Error::new(error.kind(), error.to_string()),
    }
}

struct DiskAppend {
    file: File,
}

impl Append for DiskAppend {
    fn append_unsynced(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)
    }

    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)?;
        self.file.sync_data()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_does_not_follow_a_symbolic_link_and_notices_another_file() {
        let folder = tempfile::tempdir().unwrap();
        let [path, target] = ["lock", "target"].map(|name| folder.path().join(name));
        std::os::unix::fs::symlink(&target, &path).unwrap();
        for error in [Disk.try_lock(&path).map(|_| ()), Disk.is_locked(&path).map(|_| ())] {
            assert!(error.unwrap_err().to_string().contains("a symbolic link"));
        }
        assert!(!target.exists());
        fs::remove_file(&path).unwrap();
        let lock = Disk.try_lock(&path).unwrap().unwrap();
        assert!(lock.is_file(&path).unwrap());
        fs::remove_file(&path).unwrap();
        assert!(!lock.is_file(&path).unwrap());
        fs::write(&path, "").unwrap();
        assert!(!lock.is_file(&path).unwrap());
    }

    #[test]
    fn a_lock_is_held_once_and_released() {
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
