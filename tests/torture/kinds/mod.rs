//! The kinds of trial.

use crate::harness::place::Place;
use crate::harness::trial::Kind;

mod checkpoints;
mod corruptions;
mod kill9;
mod memory;
mod mutations;
mod signals;
mod streams;
mod system_calls;

/// Names of the kinds, in the order of the table.
pub const NAMES: [&str; 8] = [
    "kill9",
    "signals",
    "system_calls",
    "corruptions",
    "checkpoints",
    "memory",
    "streams",
    "mutations",
];

/// Prepares a kind in a place that lives as long as its trials.
pub fn prepare(name: &str, place: &Place) -> Result<Box<dyn Kind>, String> {
    Ok(match name {
        "kill9" => Box::new(kill9::prepare(place)?),
        "signals" => Box::new(signals::prepare(place)?),
        "system_calls" => Box::new(system_calls::prepare(place)?),
        "streams" => Box::new(streams::prepare(place)?),
        "corruptions" => Box::new(corruptions::prepare(place)?),
        "checkpoints" => Box::new(checkpoints::prepare(place)?),
        "memory" => Box::new(memory::Memory),
        "mutations" => Box::new(mutations::prepare(place)?),
        other => return Err(format!("no kind {other:?}")),
    })
}
