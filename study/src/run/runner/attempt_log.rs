//! What workers write themselves: the claim and the line of an attempt before it starts, and checkpoints. So a worker
//! does not wait for the storing thread, which may be writing the table of a large study when a signal
//! arrives.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::sharing::Sharing;
use crate::job::JobId;
use crate::platform::error::Result;
use crate::platform::files::Lock;
use crate::store::attempts::Attempts;
use crate::store::journal::{Record, Writer};
use crate::store::results::Results;

/// Attempts and checkpoints of this process.
pub struct AttemptLog<'a> {
    results: &'a Results<'a>,
    /// `None` for a shared folder on a file system without locks.
    lock: Option<&'a Lock>,
    /// Claims; `None` for a run that is alone.
    sharing: Option<Mutex<Sharing<'a>>>,
    writer: Mutex<Writer<'a>>,
    attempts: Mutex<Attempts<'a>>,
    /// Jobs with a checkpoint on disk.
    stored: Mutex<BTreeSet<JobId>>,
    /// Whether this process was asked to stop.
    stopped: AtomicBool,
}

impl<'a> AttemptLog<'a> {
    /// The log of a process that holds the lock of the results alone, with the writer of its journal.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn alone(results: &'a Results<'a>, lock: &'a Lock, writer: Writer<'a>) -> Result<Self> {
        Self::new(results, Some(lock), writer, None)
    }

    /// The log of a process that shares the results with others. The deaths of other processes are left to the next one
    /// that is alone.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn shared(
        results: &'a Results<'a>,
        lock: Option<&'a Lock>,
        sharing: Sharing<'a>,
    ) -> Result<Self> {
        let writer = Writer::new(results.files(), results.journal_path());
        Self::new(results, lock, writer, Some(sharing))
    }

    fn new(
        results: &'a Results<'a>,
        lock: Option<&'a Lock>,
        writer: Writer<'a>,
        sharing: Option<Sharing<'a>>,
    ) -> Result<Self> {
        let attempts = match &sharing {
            Some(sharing) => Attempts::at(results, sharing.claims().attempts_path()),
            None => Attempts::new(results),
        };
        Ok(Self {
            results,
            lock,
            sharing: sharing.map(Mutex::new),
            writer: Mutex::new(writer),
            attempts: Mutex::new(attempts),
            stored: Mutex::new(results.checkpoints()?.into_iter().collect()),
            stopped: AtomicBool::new(false),
        })
    }

    /// Whether other runs may work in the folder.
    pub fn is_shared(&self) -> bool {
        self.sharing.is_some()
    }

    /// Claims a job where other runs work in the folder. `false` when one of them has it or has ended it.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn claim(&self, id: &JobId) -> Result<bool> {
        self.sharing.as_ref().map_or(Ok(true), |sharing| locked(sharing).claim(id))
    }

    /// Gives jobs back, after their records are there.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn release<'j>(&self, mut ids: impl Iterator<Item = &'j JobId>) -> Result<()> {
        let Some(sharing) = &self.sharing else { return Ok(()) };
        let mut sharing = locked(sharing);
        ids.try_for_each(|id| sharing.release(id))
    }

    /// Says to other runs that this one is alive, when it is time to.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn renew(&self) -> Result<()> {
        self.sharing.as_ref().map_or(Ok(()), |sharing| locked(sharing).renew())
    }

    /// The records of the jobs that other runs have ended since this one began.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn ended_elsewhere(&self) -> Result<BTreeMap<JobId, Record>> {
        self.sharing
            .as_ref()
            .map_or(Ok(BTreeMap::new()), |sharing| locked(sharing).ended().cloned())
    }

    /// Jobs that other runs had and that no run has now, and whether some are not known yet.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn free_jobs(&self) -> Result<(BTreeSet<JobId>, bool)> {
        let none = || Ok((BTreeSet::new(), false));
        self.sharing.as_ref().map_or_else(none, |sharing| locked(sharing).free_jobs())
    }

    /// Checks that the results folder is still the one that was locked.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn check_folder(&self) -> Result<()> {
        self.lock.map_or(Ok(()), |lock| self.results.check_lock(lock))
    }

    /// The journal of this process.
    pub fn writer(&self) -> MutexGuard<'_, Writer<'a>> {
        locked(&self.writer)
    }

    /// Records that an attempt at a job starts.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`]; the attempt must not start then.
    pub fn start(&self, id: &JobId) -> Result<()> {
        locked(&self.attempts).start(&[id])
    }

    /// The checkpoint of a job, if it has one.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`]; the job can start from its beginning.
    pub fn checkpoint(&self, id: &JobId) -> Result<Option<String>> {
        let has_checkpoint = locked(&self.stored).contains(id);
        if has_checkpoint { self.results.read_checkpoint(id) } else { Ok(None) }
    }

    /// Stores a checkpoint of a job.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`]; the job has its last checkpoint then.
    pub fn store(&self, id: &JobId, text: &str) -> Result<()> {
        self.check_folder()?;
        self.results.write_checkpoint(id, text)?;
        locked(&self.stored).insert(id.clone());
        locked(&self.attempts).progress(id)?;
        self.writer().progress(std::slice::from_ref(id))
    }

    /// Removes the checkpoint of a job that has ended.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn remove(&self, id: &JobId) -> Result<()> {
        if locked(&self.stored).remove(id) { self.results.remove_checkpoint(id) } else { Ok(()) }
    }

    /// Jobs that have a checkpoint.
    pub fn stored(&self) -> Vec<JobId> {
        locked(&self.stored).iter().cloned().collect()
    }

    /// Notes that this process was asked to stop: its attempts do not count against their jobs, also if it
    /// must end before they do. Called by a thread that waits for nothing else: the storing thread may be
    /// writing the table, and the workers may be waiting for it.
    pub fn stop(&self) {
        if !self.stopped.swap(true, Ordering::Relaxed) {
            locked(&self.attempts).end();
        }
    }
}

/// The content of a mutex, also after a panic of another thread: every operation leaves it consistent.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
