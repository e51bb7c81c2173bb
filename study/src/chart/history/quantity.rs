//! The quantities of a figure of histories: name, unit, axis, and whether their lines are thin.

use std::collections::BTreeMap;

use billow_solver::output::history::COLUMNS;

use super::Run;
use crate::chart::names::Name;
use crate::chart::time_axis::TimeAxis;
use crate::chart::unknown_name;
use crate::platform::error::Result;
use crate::render::figure::ticks;
use crate::render::figure::unit::Unit;

/// A quantity: symbol, SI unit, plain name.
pub(super) struct Quantity {
    pub(super) symbol: String,
    pub(super) unit: String,
    pub(super) name: Name,
}

/// What the lines of a quantity share.
pub(super) struct Drawn<'a> {
    pub(super) quantity: &'a Quantity,
    /// Unit of the values.
    pub(super) unit: Unit,
    /// Ends of the y axis.
    pub(super) range: [f64; 2],
    pub(super) time: &'a TimeAxis,
    /// Whether lines are thin and few.
    pub(super) thin: bool,
}

/// The quantity with that name: a column of the history, or an extra quantity of a job.
pub(super) fn quantity(symbol: &str, runs: &BTreeMap<&str, Run>) -> Result<Quantity> {
    let shown = || COLUMNS.iter().filter(|column| column.name != "time");
    let of = |unit: &str, meaning: &str| Quantity {
        symbol: symbol.to_owned(),
        unit: unit.to_owned(),
        name: Name::of_history(symbol, meaning),
    };
    if let Some(column) = shown().find(|column| column.name == symbol) {
        return Ok(of(column.unit, column.meaning));
    }
    let found = runs.values().find_map(|run| run.history.labels.get(symbol));
    if let Some((unit, meaning)) = found {
        return Ok(of(unit, meaning));
    }
    let mut known: Vec<&str> = shown().map(|column| column.name).collect();
    for track in runs.values().flat_map(|run| run.history.labels.keys()) {
        if !known.contains(&track.as_str()) {
            known.push(track);
        }
    }
    Err(unknown_name("--history", symbol, "no such history column", &known))
}

/// Unit and axis of a quantity, from its values within the time axis.
pub(super) fn drawn<'a>(
    quantity: &'a Quantity,
    runs: &BTreeMap<&str, Run>,
    time: &'a TimeAxis,
) -> Drawn<'a> {
    let [start, end] = time.ends;
    let inside = |run: &Run| -> Vec<f64> {
        let pairs = run.times().iter().zip(run.values(&quantity.symbol));
        let pairs = pairs.filter(|(t, _)| (start..=end).contains(*t));
        pairs.map(|(_, value)| *value).filter(|value| value.is_finite()).collect()
    };
    let values: Vec<Vec<f64>> = runs.values().map(inside).collect();
    let all = || values.iter().flatten().copied();
    let unit = Unit::fit(&quantity.unit, all());
    let [low, high] = all().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    });
    let range = if low > high {
        [0.0, 1.0]
    } else {
        ticks::padded(unit.shown(low), unit.shown(high)).into()
    };
    // Velocities oscillate.
    let thin = quantity.unit == "m/s";
    Drawn { quantity, unit, range, time, thin }
}
