//! Claims: which run works on which job, where several runs share a results folder.
//!
//! ```text
//! results/<study>/claims/<process>.run        {"checksum":"…","owner":"…","process":"…","lease":120}
//!                        <job id>             a second name (hard link) of the file of the run that has the job
//!                        <process>.attempts   its attempts (crate::store::attempts)
//! ```
//!
//! A run writes its file again every [`RENEWAL`]. All its claims are that file, so its time is the time at which
//! the run was last known to be alive. A claim is over when its time is older than [`LEASE`], by the clock of the
//! file server: a run knows it from the time of its file. A run takes over what is over,
//! and what its owner left in an earlier attempt (a task that Slurm starts again).
//!
//! Claims only save work. When two runs take over one claim at the same moment, or a run is held up for longer than the lease,
//! both run the job: it gives the same bits, and the readers of the journal see one record.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use billow_solver::platform::seal;
use serde::{Deserialize, Serialize};

use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::files::{Files, Stamp, disk_error};
use crate::store::results::Results;

/// Time after which a claim that was not renewed is over. Chosen: longer than a file server or a paused machine
/// usually holds a write up; a job waits as long after its run was killed.
pub const LEASE: Duration = Duration::from_mins(2);
/// Time between two renewals. Chosen: several may fail before a claim is over.
pub const RENEWAL: Duration = Duration::from_secs(15);
/// End of the name of the file of a run.
const RUN: &str = "run";
/// End of the name of a run's attempts.
const ATTEMPTS: &str = "attempts";
/// Attempts at a claim that others remove at the same time. Chosen: once is rare.
const MAX_ATTEMPTS: u32 = 5;

/// The text of a run's file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Owner {
    /// Whose run it is: the same when Slurm starts a task again.
    #[serde(rename = "owner")]
    name: String,
    /// Name of the process, unique in the folder.
    process: String,
    /// Time after which a claim is over, s.
    lease: u64,
}

/// What an attempt at a claim gave.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Claim {
    /// This run has the job.
    Taken,
    /// Another run has it, which was alive at this time.
    Held(Stamp),
}

/// The claims of this process.
pub struct Claims<'a> {
    files: &'a dyn Files,
    folder: PathBuf,
    owner: Owner,
    text: String,
    held: BTreeSet<JobId>,
    /// Time of the file of this run at its last renewal, and when that was.
    renewed: Option<(Duration, Instant)>,
}

impl<'a> Claims<'a> {
    /// The claims of a process in this folder. `owner` says whose run it is; two runs at the same time have different
    /// owners.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn new(results: &Results<'a>, owner: &str, lease: Duration) -> Result<Self> {
        let nanoseconds = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        let nanoseconds = nanoseconds.map_or(0, |time| time.as_nanos());
        let process = format!("{owner}-{}-{nanoseconds}", std::process::id());
        let owner = Owner { name: owner.to_owned(), process, lease: lease.as_secs() };
        let folder = results.claims_path();
        let object = serde_json::to_string(&owner)
            .map_err(|error| disk_error(&folder, &io::Error::other(error)))?;
        let text = seal::seal(&object) + "\n";
        let (files, held) = (results.files(), BTreeSet::new());
        let claims = Self { files, folder, owner, text, held, renewed: None };
        claims.write_run_file()?;
        Ok(claims)
    }

    /// Path of the attempts of this process.
    pub fn attempts_path(&self) -> PathBuf {
        self.folder.join(format!("{}.{ATTEMPTS}", self.owner.process))
    }

    fn run_path(&self) -> PathBuf {
        self.folder.join(format!("{}.{RUN}", self.owner.process))
    }

    fn write_run_file(&self) -> Result<()> {
        let path = self.run_path();
        let write = || {
            self.files.create_folder(&self.folder)?;
            self.files.write_new(&path, self.text.as_bytes())
        };
        write().map_err(|error| disk_error(&path, &error))
    }

    /// Claims a job.
    ///
    /// # Errors
    /// [`Error::Disk`], also on a file system without hard links.
    pub fn take(&mut self, id: &JobId) -> Result<Claim> {
        let path = self.folder.join(id.as_str());
        for _ in 0..MAX_ATTEMPTS {
            match self.files.link(&self.run_path(), &path) {
                Ok(()) => return Ok(self.taken(id)),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                // Another command removed this run's file, because it seemed dead.
                Err(error) if error.kind() == io::ErrorKind::NotFound => {
                    self.write_run_file()?;
                    continue;
                }
                Err(error) => return Err(no_links(&path, &error)),
            }
            let Some((owner, stamp)) = read(self.files, &path)? else { continue };
            // A network file system may report a link that it made as one that was there.
            if owner.as_ref() == Some(&self.owner) {
                return Ok(self.taken(id));
            }
            let is_earlier = owner.as_ref().is_some_and(|other| other.name == self.owner.name);
            if !is_earlier && !self.is_over(owner.as_ref(), &stamp)? {
                return Ok(Claim::Held(stamp));
            }
            self.take_away(&path)?;
        }
        let stamp = self.files.stamp(&self.run_path());
        stamp.map(Claim::Held).map_err(|error| disk_error(&path, &error))
    }

    fn taken(&mut self, id: &JobId) -> Claim {
        self.held.insert(id.clone());
        Claim::Taken
    }

    /// Whether a claim of this time is over now.
    fn is_over(&mut self, owner: Option<&Owner>, stamp: &Stamp) -> Result<bool> {
        self.renew_if_due()?;
        let now = self.renewed.map_or(Duration::ZERO, |(time, then)| time + then.elapsed());
        Ok(now.saturating_sub(time(stamp)) > lease(owner))
    }

    /// Removes a claim of another run. Of several runs one succeeds; the others see a new claim or none.
    fn take_away(&self, path: &Path) -> Result<()> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let aside = path.with_file_name(format!(".{name}.{}.tmp", self.owner.process));
        match self.files.rename(path, &aside) {
            Ok(()) => self.files.remove(&aside).map_err(|error| disk_error(&aside, &error)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            Err(error) => Err(disk_error(path, &error)),
        }
    }

    /// The state of a job's claim: the time at which its run was last alive; `None` where no run has it, or where its
    /// claim is over.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn holder(&mut self, id: &JobId) -> Result<Option<Stamp>> {
        let path = self.folder.join(id.as_str());
        let Some((owner, stamp)) = read(self.files, &path)? else { return Ok(None) };
        Ok((!self.is_over(owner.as_ref(), &stamp)?).then_some(stamp))
    }

    /// Gives a job back: it has a record, or does not run.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn release(&mut self, id: &JobId) -> Result<()> {
        if !self.held.remove(id) {
            return Ok(());
        }
        remove(self.files, &self.folder.join(id.as_str()))
    }

    /// Says that this run is alive, when [`RENEWAL`] has passed.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn renew_if_due(&mut self) -> Result<()> {
        if self.renewed.is_some_and(|(_, then)| then.elapsed() < RENEWAL) {
            return Ok(());
        }
        self.renew()
    }

    /// Says that this run is alive.
    ///
    /// # Errors
    /// [`Error::Disk`].
    pub fn renew(&mut self) -> Result<()> {
        let path = self.run_path();
        match self.files.overwrite(&path, self.text.as_bytes()) {
            // Another command removed it, because this run seemed dead.
            Err(error) if error.kind() == io::ErrorKind::NotFound => self.write_run_file()?,
            result => result.map_err(|error| disk_error(&path, &error))?,
        }
        let stamp = self.files.stamp(&path).map_err(|error| disk_error(&path, &error))?;
        self.renewed = Some((time(&stamp), Instant::now()));
        Ok(())
    }
}

impl Drop for Claims<'_> {
    /// Gives everything back.
    fn drop(&mut self) {
        // What cannot be removed is over after the lease.
        for id in std::mem::take(&mut self.held) {
            let _ = remove(self.files, &self.folder.join(id.as_str()));
        }
        let _ = remove(self.files, &self.run_path());
    }
}

/// Owner and time of a claim; no owner for a damaged one, `None` where there is none.
fn read(files: &dyn Files, path: &Path) -> Result<Option<(Option<Owner>, Stamp)>> {
    // The file is opened first: network file systems then ask the server for its time.
    let read = files.read(path).and_then(|bytes| Ok((bytes, files.stamp(path)?)));
    match read {
        Ok((bytes, stamp)) => {
            let object =
                String::from_utf8(bytes).ok().and_then(|text| seal::open(text.trim_end()).ok());
            Ok(Some((object.and_then(|object| serde_json::from_str(&object).ok()), stamp)))
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(disk_error(path, &error)),
    }
}

/// Removes a file; one that is gone is no error.
fn remove(files: &dyn Files, path: &Path) -> Result<()> {
    match files.remove(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(disk_error(path, &error)),
        _ => Ok(()),
    }
}

/// The lease of an owner.
fn lease(owner: Option<&Owner>) -> Duration {
    owner.map_or(LEASE, |owner| Duration::from_secs(owner.lease))
}

/// Time of a stamp since 1970.
fn time(stamp: &Stamp) -> Duration {
    let parts = stamp.modified.split_once('.');
    let parts = parts.and_then(|(s, ns)| Some(Duration::new(s.parse().ok()?, ns.parse().ok()?)));
    parts.unwrap_or_default()
}

/// The error of a link that cannot be made.
fn no_links(path: &Path, error: &io::Error) -> Error {
    if error.kind() != io::ErrorKind::Unsupported && error.raw_os_error() != Some(EPERM) {
        return disk_error(path, error);
    }
    let problem = format!(
        "{error}: this file system has no hard links, with which runs claim their jobs\n  next: put the results on another \
         file system, or run each part into another folder: billow run --points K/N, then billow merge"
    );
    Error::Disk { path: path.to_owned(), problem }
}

/// Number of the system's error "operation not permitted": what Linux says of a link where there are none.
const EPERM: i32 = 1;

mod live;
#[cfg(test)]
mod tests;

pub use live::LiveRun;
