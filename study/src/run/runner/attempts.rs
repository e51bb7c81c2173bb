//! What workers write themselves: the line of an attempt before it starts, and checkpoints. So neither
//! waits for the storing thread, which may be writing the table of a large study when a signal arrives.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::job::JobId;
use crate::platform::error::Result;
use crate::store::journal::Writer;
use crate::store::results::Results;

/// The attempts of this process.
pub struct Attempts<'a> {
    results: &'a Results<'a>,
    writer: Mutex<Writer<'a>>,
    /// Jobs with a checkpoint on disk.
    stored: Mutex<BTreeSet<JobId>>,
    /// Whether the journal says that this process was asked to stop.
    stopped: AtomicBool,
}

impl<'a> Attempts<'a> {
    /// The attempts of a process that begins.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`] when the checkpoints cannot be listed.
    pub fn new(results: &'a Results<'a>) -> Result<Self> {
        let writer = Writer::new(results.files(), results.journal_path());
        let stored = results.checkpoints()?.into_iter().collect();
        let (writer, stored) = (Mutex::new(writer), Mutex::new(stored));
        Ok(Self { results, writer, stored, stopped: AtomicBool::new(false) })
    }

    /// The journal of this process.
    pub fn writer(&self) -> MutexGuard<'_, Writer<'a>> {
        locked(&self.writer)
    }

    /// Records that an attempt at a job starts.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`]; the attempt must not start then.
    pub fn start(&self, _id: &JobId) -> Result<()> {
        Ok(())
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
        self.results.write_checkpoint(id, text)?;
        locked(&self.stored).insert(id.clone());
        Ok(())
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

    /// Records once that this process was asked to stop.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn stop(&self) -> Result<()> {
        if self.stopped.swap(true, Ordering::Relaxed) {
            return Ok(());
        }
        Ok(())
    }
}

/// The content of a mutex, also after a panic of another thread: every operation leaves it consistent.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
