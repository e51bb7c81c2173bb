//! The quantities of a figure of histories: name, unit, axis, and whether they ring.

use std::collections::BTreeMap;

use billow_solver::output::history::COLUMNS;

use super::Run;
use crate::chart::names::Name;
use crate::chart::time_axis::TimeAxis;
use crate::chart::unknown_name;
use crate::platform::error::Result;
use crate::render::figure::ticks;
use crate::render::figure::unit::Unit;

/// Number of turns, on average over the jobs, from which a quantity of both signs rings.
const RINGING_TURNS: usize = 5;

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
    pub(super) rings: bool,
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

/// Unit and axis of a quantity, and whether it rings, from its values within the time axis.
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
    let turns: usize = values.iter().map(|values| turns(values, 0.1 * (high - low))).sum();
    let rings = -low > 0.2 * high && high > -0.2 * low && turns > RINGING_TURNS * runs.len();
    Drawn { quantity, unit, range, time, rings }
}

/// How often values turn by at least `change`.
fn turns(values: &[f64], change: f64) -> usize {
    let mut count = 0;
    let (mut low, mut high, mut rising) = (f64::INFINITY, f64::NEG_INFINITY, None);
    for value in values {
        (low, high) = (low.min(*value), high.max(*value));
        let up = *value - low >= change && rising != Some(true);
        let down = high - *value >= change && rising != Some(false);
        if up || down {
            count += usize::from(rising.is_some());
            rising = Some(up);
            (low, high) = (*value, *value);
        }
    }
    count
}
