//! What searches have proposed: a plan asks for each generation again whenever it is replayed.

use std::collections::BTreeMap;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::{Deserialize, Serialize};

use super::acquisition::Search;
use super::{Optimise, Trial};
use crate::input::value::Value;
use crate::job::JobId;

/// Points that searches have proposed, by a hash of the points before.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Proposed(BTreeMap<u64, Vec<Vec<Value>>>);

static PROPOSED: Mutex<Proposed> = Mutex::new(Proposed(BTreeMap::new()));

impl Proposed {
    fn known() -> MutexGuard<'static, Self> {
        PROPOSED.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What was proposed in this process, or is known from before.
    pub fn so_far() -> Self {
        Self::known().clone()
    }

    /// Makes known what another process has proposed.
    pub fn recall(other: Self) {
        Self::known().0.extend(other.0);
    }

    /// Whether no search has proposed anything.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// What is known when points are proposed.
pub(super) struct Known<'a> {
    /// The points of the search.
    pub trials: &'a [Trial],
    /// What else the proposals depend on: limits, and the jobs of the cheap model.
    pub beside: &'a str,
    /// Runs the cheap model.
    pub prior: &'a dyn Fn() -> Vec<Trial>,
}

/// The next points of a generation with this number: a batch of [`Search`].
pub(super) fn next(
    optimise: &Optimise,
    known: &Known<'_>,
    (batch, generation): (usize, u32),
    is_new: &dyn Fn(&[Value]) -> bool,
) -> Vec<Vec<Value>> {
    let mut key = DefaultHasher::new();
    // A larger budget goes on with the same points.
    let search = Optimise { budget: 0, ..optimise.clone() };
    (format!("{search:?}"), known.beside, batch, generation).hash(&mut key);
    for trial in known.trials {
        let ids: Vec<&str> = trial.jobs.iter().map(JobId::as_str).collect();
        let place = trial.place.iter().map(|place| place.to_bits());
        let numbers = trial.measures.iter().chain(&trial.margins);
        let numbers = numbers.map(|number| number.map(f64::to_bits));
        (ids, place.collect::<Vec<_>>(), numbers.collect::<Vec<_>>()).hash(&mut key);
        trial.keeps_limits.hash(&mut key);
    }
    let key = key.finish();
    if let Some(proposed) = Proposed::known().0.get(&key) {
        return proposed.clone();
    }
    let search = Search { optimise, trials: known.trials, prior: &(known.prior)(), generation };
    let chosen = search.batch(batch, is_new);
    Proposed::known().0.insert(key, chosen.clone());
    chosen
}
