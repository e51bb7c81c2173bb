//! A disk whose operations fail, for tests.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::{Append, Disk, Files, Lock, Stamp};

/// The real disk, whose n-th changing operation (write, rename, sync, append, new folder, lock) and all
/// later ones fail. A failing write or append leaves the first half of its bytes, as a full disk does.
#[derive(Debug, Clone)]
pub struct FailingFiles {
    failing_from: u64,
    kind: io::ErrorKind,
    operations: Arc<AtomicU64>,
}

impl FailingFiles {
    /// Every changing operation fails from number `failing_from` on (1 is the first).
    pub fn new(failing_from: u64, kind: io::ErrorKind) -> Self {
        Self { failing_from, kind, operations: Arc::default() }
    }

    /// Number of changing operations so far.
    pub fn operations(&self) -> u64 {
        self.operations.load(Ordering::SeqCst)
    }

    fn step(&self) -> io::Result<()> {
        let number = self.operations.fetch_add(1, Ordering::SeqCst) + 1;
        if number >= self.failing_from { Err(self.kind.into()) } else { Ok(()) }
    }
}

impl Files for FailingFiles {
    fn create_folder(&self, path: &Path) -> io::Result<bool> {
        if path.is_dir() {
            return Ok(false);
        }
        self.step()?;
        Disk.create_folder(path)
    }

    fn open(&self, path: &Path) -> io::Result<Box<dyn io::Read>> {
        Disk.open(path)
    }

    fn stamp(&self, path: &Path) -> io::Result<Stamp> {
        Disk.stamp(path)
    }

    fn list(&self, path: &Path) -> io::Result<Vec<PathBuf>> {
        Disk.list(path)
    }

    fn write_new(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        self.step().inspect_err(|_| {
            let _ = Disk.write_new(path, &bytes[..bytes.len() / 2]);
        })?;
        Disk.write_new(path, bytes)
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.step()?;
        Disk.rename(from, to)
    }

    fn sync_folder(&self, path: &Path) -> io::Result<()> {
        self.step()?;
        Disk.sync_folder(path)
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        // Removing frees space: it works on a full disk, but not on one with another fault.
        if self.operations() >= self.failing_from && self.kind != io::ErrorKind::StorageFull {
            return Err(self.kind.into());
        }
        Disk.remove(path)
    }

    fn create_append(&self, path: &Path) -> io::Result<Box<dyn Append>> {
        self.step()?;
        let real = Disk.create_append(path)?;
        Ok(Box::new(FailingAppend { real, files: self.clone() }))
    }

    fn try_lock(&self, path: &Path) -> io::Result<Option<Lock>> {
        self.step()?;
        Disk.try_lock(path)
    }

    fn is_locked(&self, path: &Path) -> io::Result<bool> {
        Disk.is_locked(path)
    }
}

struct FailingAppend {
    real: Box<dyn Append>,
    files: FailingFiles,
}

impl Append for FailingAppend {
    fn append_unsynced(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.append(bytes)
    }

    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.files.step().inspect_err(|_| {
            let _ = self.real.append(&bytes[..bytes.len() / 2]);
        })?;
        self.real.append(bytes)
    }
}
