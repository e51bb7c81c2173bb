//! What workers write themselves: the line of an attempt before it starts, and checkpoints. So a worker
//! does not wait for the storing thread, which may be writing the table of a large study when a signal
//! arrives.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::job::JobId;
use crate::platform::error::Result;
use crate::platform::files::Lock;
use crate::store::attempts::Attempts;
use crate::store::journal::Writer;
use crate::store::results::Results;

/// Attempts and checkpoints of this process.
pub struct AttemptLog<'a> {
    results: &'a Results<'a>,
    lock: &'a Lock,
    writer: Mutex<Writer<'a>>,
    attempts: Mutex<Attempts<'a>>,
    /// Jobs with a checkpoint on disk.
    stored: Mutex<BTreeSet<JobId>>,
    /// Whether this process was asked to stop.
    stopped: AtomicBool,
}

impl<'a> AttemptLog<'a> {
    /// The log of a process that holds the lock of the results, with the writer of its journal.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn new(results: &'a Results<'a>, lock: &'a Lock, writer: Writer<'a>) -> Result<Self> {
        Ok(Self {
            results,
            lock,
            writer: Mutex::new(writer),
            attempts: Mutex::new(Attempts::new(results)),
            stored: Mutex::new(results.checkpoints()?.into_iter().collect()),
            stopped: AtomicBool::new(false),
        })
    }

    /// Checks that the results folder is still the one that was locked.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn check_folder(&self) -> Result<()> {
        self.results.check_lock(self.lock)
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
