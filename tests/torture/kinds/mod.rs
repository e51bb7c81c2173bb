//! The kinds of trial: what is done to the program, how often, and what must follow.

use crate::program::Place;
use crate::random::Random;
use crate::trial::Trial;

mod corruptions;
mod damages;
mod interruptions;
mod limits;
mod mutations;

/// A kind of trial.
pub struct Kind {
    /// Its name.
    pub name: &'static str,
    /// Limit of the time that it measures, s.
    pub limit: u64,
    /// Whether its trials need the machine for themselves.
    pub one_by_one: bool,
    /// Prepares it in a place that lives as long as its trials, or says why it cannot be tried here.
    pub prepare: fn(&Place) -> Result<Prepared, String>,
}

/// A kind, ready for its trials.
pub struct Prepared {
    /// Number of trials.
    pub trials: usize,
    /// Makes one trial in an empty place.
    pub make: Make,
}

type Make = Box<dyn Fn(&mut Trial, &mut Random, &Place) + Sync>;

impl Prepared {
    fn new(trials: usize, make: impl Fn(&mut Trial, &mut Random, &Place) + Sync + 'static) -> Self {
        Self { trials, make: Box::new(make) }
    }
}

/// Every kind, in the order of the table.
pub const KINDS: [Kind; 8] = [
    kind("kill9", 60, interruptions::kill9),
    kind("signals", 2, interruptions::signals),
    kind("system_calls", 10, interruptions::system_calls),
    kind("disk", 60, limits::disk),
    kind("corruptions", 60, corruptions::prepare),
    Kind { one_by_one: true, ..kind("memory", 180, |_| Ok(limits::memory())) },
    kind("mutations", 60, mutations::mutations),
    kind("checkpoints", 60, mutations::checkpoints),
];

const fn kind(
    name: &'static str,
    limit: u64,
    prepare: fn(&Place) -> Result<Prepared, String>,
) -> Kind {
    Kind { name, limit, one_by_one: false, prepare }
}
