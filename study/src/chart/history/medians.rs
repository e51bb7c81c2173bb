//! The runs that repeat a point as one line: their median at each time, with a band from least to largest.
//!
//! Only done runs count, at times at which all of them have samples. A run with other times is interpolated
//! linearly.

use std::collections::BTreeMap;

use super::Run;
use super::line::{history_line, last_visible, pieces};
use super::quantity::Drawn;
use crate::analysis::statistics::Spread;
use crate::chart::Source;
use crate::chart::outcome::{OUTCOMES, Outcome};
use crate::job::Status;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::Line;
use crate::render::figure::style::{Fill, Series};

/// The line of a point; `None` without a history.
pub(super) fn line(
    source: &Source<'_>,
    row: usize,
    series: Series,
    runs: &BTreeMap<&str, Run>,
    drawn: &Drawn<'_>,
) -> Option<Line> {
    let single = source.single();
    let stored: Vec<&Run> =
        source.single_rows(row).iter().filter_map(|row| runs.get(single.job(*row))).collect();
    let done = |run: &&&Run| single.table.status(run.row) == Some(Status::Done);
    let done: Vec<&Run> = stored.iter().filter(done).copied().collect();
    match done.as_slice() {
        [] => stored.first().map(|run| history_line(&single, series, run, drawn)),
        [only] => Some(history_line(&single, series, only, drawn)),
        several => Some(median_line(Outcome::of(source, row), series, several, drawn)),
    }
}

fn median_line(outcome: Outcome, series: Series, runs: &[&Run], drawn: &Drawn<'_>) -> Line {
    let Drawn { quantity, unit, time, thin, .. } = drawn;
    let spreads = spreads(runs, &quantity.symbol);
    let side = |pick: fn(&Spread) -> f64| -> Vec<[f64; 2]> {
        let point = |(t, spread): &(f64, Spread)| [time.unit.shown(*t), unit.shown(pick(spread))];
        spreads.iter().map(point).collect()
    };
    let median = side(|spread| spread.median);
    let sides = [side(|spread| spread.least), side(|spread| spread.largest)];
    let [least, largest] = sides.map(|points| pieces(&points, time));
    let band = |(low, high): (&Vec<[f64; 2]>, &Vec<[f64; 2]>)| {
        low.iter().zip(high).map(|(low, high)| [low[0], low[1], high[1]]).collect()
    };
    let fill = Some(outcome.fill()).filter(|fill| *fill != Fill::Filled);
    let end = last_visible(&median, time);
    Line {
        pieces: pieces(&median, time),
        marks: fill.and_then(|fill| end.map(|point| (point, fill))).into_iter().collect(),
        sparse_markers: true,
        thin: *thin,
        bands: least.iter().zip(&largest).map(band).collect(),
        ..Line::new(series)
    }
}

/// Times of the first run at which all runs have finite values, and the spread of these.
fn spreads(runs: &[&Run], name: &str) -> Vec<(f64, Spread)> {
    let values = |time: f64| runs.iter().filter_map(move |run| value_at(run, name, time));
    let times = runs.first().map_or(&[][..], |run| run.times());
    let spread = |time: &f64| {
        let spread = Spread::of(values(*time))?;
        (spread.count == runs.len()).then_some((*time, spread))
    };
    times.iter().filter_map(spread).collect()
}

/// The value of a run at a time; `None` after its end, and where it is not finite.
fn value_at(run: &Run, name: &str, time: f64) -> Option<f64> {
    let (times, values) = (run.times(), run.values(name));
    let next = times.partition_point(|known| *known < time);
    let (after, value) = (*times.get(next)?, *values.get(next)?);
    let value = if next == 0 || after.total_cmp(&time).is_eq() {
        value
    } else {
        let (before, start) = (times[next - 1], values[next - 1]);
        start + (time - before) / (after - before) * (value - start)
    };
    value.is_finite().then_some(value)
}

/// The legends of medians and bands, and of the marks at the ends of the lines.
pub(super) fn legends(source: &Source<'_>) -> Vec<Legend> {
    let mut legends: Vec<Legend> = source.runs_legend(Sample::Band).into_iter().collect();
    let count = |outcome: Outcome| {
        source.rows.iter().filter(|row| Outcome::of(source, **row) == outcome).count()
    };
    let marked = OUTCOMES.into_iter().filter(|outcome| outcome.fill() != Fill::Filled);
    let entry = |outcome: Outcome| {
        let number = count(outcome);
        let name = if outcome == Outcome::Mixed { "some runs deployed" } else { outcome.name() };
        (number > 0).then(|| (Sample::Marker(outcome.fill()), format!("{name} ({number})")))
    };
    let deployed = count(Outcome::All);
    let all = match deployed {
        0 => String::new(),
        deployed => format!("; no mark: all runs deployed ({deployed})"),
    };
    legends.push(Legend {
        heading: format!("Outcome, at the end of a line (number of points){all}"),
        entries: marked.filter_map(entry).collect(),
    });
    legends
}
