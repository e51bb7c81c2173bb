//! A run that shares its folder with other runs: it claims each job before it starts, and leaves alone what others have
//! or have ended.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use crate::job::JobId;
use crate::platform::error::Result;
use crate::platform::files::Stamp;
use crate::store::claims::{Claim, Claims};
use crate::store::journal::{Follower, Record};
use crate::store::results::Results;

/// How a run shares its folder.
#[derive(Debug, Clone)]
pub struct Shared {
    /// Whose run it is; no other run at the same time has the same owner.
    pub owner: String,
    /// Time after which a claim that was not renewed is over: [`crate::store::claims::LEASE`].
    pub lease: Duration,
}

/// The claims of a run, and what other runs do.
pub struct Sharing<'a> {
    claims: Claims<'a>,
    follower: Follower<'a>,
    /// Jobs that other runs had when this one wanted them, and when those were last alive.
    held: BTreeMap<JobId, Stamp>,
}

impl<'a> Sharing<'a> {
    /// The claims of a run. Made before the journals are read.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn new(results: &Results<'a>, shared: &Shared) -> Result<Self> {
        let follower = Follower::new(results.files(), &results.journal_path())?;
        let claims = Claims::new(results, &shared.owner, shared.lease)?;
        Ok(Self { claims, follower, held: BTreeMap::new() })
    }

    /// The claims.
    pub fn claims(&self) -> &Claims<'a> {
        &self.claims
    }

    /// Claims a job. `false` when another run has it or has ended it.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn claim(&mut self, id: &JobId) -> Result<bool> {
        if let Claim::Held(alive) = self.claims.take(id)? {
            self.held.entry(id.clone()).or_insert(alive);
            return Ok(false);
        }
        self.held.remove(id);
        // Its run may have ended it before this one looked at the claim.
        let ended = self.follower.ended()?.contains_key(id);
        if ended {
            self.claims.release(id)?;
        }
        Ok(!ended)
    }

    /// Gives a job back.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn release(&mut self, id: &JobId) -> Result<()> {
        self.claims.release(id)
    }

    /// Says that this run is alive, when it is time to.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn renew(&mut self) -> Result<()> {
        self.claims.renew_if_due()
    }

    /// The jobs that have ended since this run began, with their records.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn ended(&mut self) -> Result<&BTreeMap<JobId, Record>> {
        self.follower.ended()
    }

    /// Looks after the jobs that other runs had. Those of live runs and those that ended are forgotten; returns the ones
    /// that no run has, and whether others are not known yet: their runs were killed a moment ago, or have not renewed
    /// their claims since.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`].
    pub fn free_jobs(&mut self) -> Result<(BTreeSet<JobId>, bool)> {
        let mut holders = Vec::with_capacity(self.held.len());
        for (id, alive) in std::mem::take(&mut self.held) {
            let holder = self.claims.holder(&id)?;
            holders.push((id, alive, holder));
        }
        // After the claims: a run gives a job back when its record is there.
        let ended = self.follower.ended()?;
        holders.retain(|(id, _, _)| !ended.contains_key(id));
        let mut free = BTreeSet::new();
        for (id, alive, holder) in holders {
            match holder {
                None => {
                    free.insert(id);
                }
                Some(now) if now == alive => {
                    self.held.insert(id, alive);
                }
                // Its run is alive, and keeps it.
                Some(_) => {}
            }
        }
        Ok((free, !self.held.is_empty()))
    }
}
