//! Histories of several jobs in one figure: one line per job, one row of panels per quantity. The runs that repeat a
//! point are one line, their median at each time, with a band from least to largest.
//!
//! Of several runs only the done ones count, at times at which all of them have samples. A run with other times is
//! interpolated linearly.

use std::collections::BTreeMap;

use billow_solver::output::history::COLUMNS;

use super::encoding::{Encoding, PREFERRED_LINES};
use super::names::{self, Name};
use super::outcome::{MARKERS, marker};
use super::time_axis::{TIME_AXIS_COLUMNS, TimeAxis};
use super::{Source, invalid_option, outcome, parameters, unknown_name};
use crate::analysis::statistics::Spread;
use crate::input::value::Value;
use crate::job::{JobId, Status};
use crate::platform::error::Result;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Axis, Line, Panel, Plots, Rule};
use crate::render::figure::style::{Fill, Series};
use crate::render::figure::unit::Unit;
use crate::render::figure::{Sheet, columns as columns_of, scale, ticks};
use crate::store::history_file::StoredHistory;

/// Most jobs in one figure. Chosen: 12 panels with a few lines each.
pub const MAX_JOBS: usize = 48;
/// Most lines in a panel of a quantity that oscillates. Chosen: more cover each other.
const MAX_THIN_LINES: usize = 3;
/// Most runs behind the lines of a figure. Chosen: what is drawn of their histories is in memory together, some 200 kB of a
/// run with 6000 samples.
const MAX_RUNS: usize = 2000;

/// Histories by job.
type Histories<'a> = BTreeMap<&'a str, StoredHistory>;

/// Times and values of a quantity in a history; no values when the job does not have it.
fn series<'a>(history: &'a StoredHistory, symbol: &str) -> (&'a [f64], &'a [f64]) {
    let values = match history.tracks.get(symbol) {
        Some(values) => values,
        None if COLUMNS.iter().any(|column| column.name == symbol) => {
            history.history.column(symbol)
        }
        None => &[],
    };
    (history.history.column("time"), values)
}

/// Draws columns of histories over time. `range` gives the ends of the time axis, s, where they differ
/// from those of `TimeAxis`.
///
/// # Errors
/// An unknown column, too many jobs, an empty range; the errors of `read`.
pub fn svg(
    source: &Source<'_>,
    columns: &[String],
    range: [Option<f64>; 2],
    read: &dyn Fn(&JobId) -> Result<StoredHistory>,
) -> Result<String> {
    let rows = source.rows.iter().copied().filter(|row| has_history(source, *row)).collect();
    let stored = Source { rows, ..source.clone() };
    let histories = histories(&stored, columns, read)?;
    let time = TimeAxis::new(&histories.values().collect::<Vec<_>>(), range)?;
    let quantities: Vec<Quantity<'_>> = columns
        .iter()
        .map(|symbol| Quantity::new(symbol, source, &histories, &time))
        .collect::<Result<_>>()?;

    let (mut others, mut notes) = parameters::varying(source.table, &stored.rows, &[]);
    if source.runs.is_some() {
        others = parameters::strategy_first(others);
    }
    let asked = columns.join(",");
    let encoding = |preferred: usize| {
        Encoding::new(&stored, &others, &[], preferred, false, ("--history", &asked))
    };
    let encoding = match quantities.as_slice() {
        [only] if only.thin => encoding(MAX_THIN_LINES).or_else(|_| encoding(PREFERRED_LINES))?,
        _ => encoding(PREFERRED_LINES)?,
    };
    let facets = &encoding.panels.panels;
    let across = columns_of(facets.len());
    let mut panels: Vec<Panel> = Vec::new();
    for quantity in &quantities {
        let panel = |(title, rows): &(String, Vec<usize>)| Panel {
            title: names::capital(title),
            ..quantity.panel(source, rows, &histories, &encoding)
        };
        panels.extend(facets.iter().map(panel));
        // The next quantity starts a row.
        while quantities.len() > 1 && !panels.len().is_multiple_of(across) {
            panels.push(Panel { blank: true, range: quantity.range, ..Panel::default() });
        }
    }
    let plain: Vec<&str> = quantities.iter().map(|quantity| quantity.name.plain.as_str()).collect();
    notes.extend(quantities.iter().flat_map(|quantity| quantity.notes.clone()));
    notes.extend(time.note.clone());
    notes.extend(not_drawn(source));
    notes.extend(source.runs_notes(None));
    let mut legends = encoding.legends(false);
    legends.extend(source.runs_legend("", Sample::Band, &panels));
    legends.push(ends(&stored));
    let limits = quantities.iter().flat_map(|quantity| &quantity.limits);
    let mut limits: Vec<_> = limits.map(|rule| (Sample::End, rule.text.clone())).collect();
    limits.dedup();
    legends.push(Legend { heading: "Limit".to_owned(), entries: limits });
    let sheet = Sheet {
        title: source.title_or(&format!("{} over time", plain.join(", "))),
        subtitle: source.subtitle(),
        legends,
        notes,
    };
    let x = Axis {
        label: time.unit.label("Time t"),
        spread: scale::Spread::Linear,
        range: time.shown(),
        ticks: Vec::new(),
        names: false,
    };
    Ok(Plots { sheet, x, panels, across }.svg())
}

/// Reads the histories of the rows, by job.
fn histories<'a>(
    source: &Source<'a>,
    columns: &[String],
    read: &dyn Fn(&JobId) -> Result<StoredHistory>,
) -> Result<Histories<'a>> {
    let single = source.single();
    let rows = single.rows.iter().filter(|row| has_history(&single, **row));
    let mut jobs: Vec<&str> = rows.map(|row| single.job(*row)).collect();
    jobs.sort_unstable();
    jobs.dedup();
    let drawn = match source.runs {
        None => [(jobs.len(), "jobs", MAX_JOBS); 2],
        Some(_) => [(source.rows.len(), "points", MAX_JOBS), (jobs.len(), "runs", MAX_RUNS)],
    };
    if let Some((number, noun, limit)) = drawn.into_iter().find(|(number, _, limit)| number > limit)
    {
        let (varying, _) = parameters::varying(source.table, &source.rows, &[]);
        let varying: Vec<&str> = varying.iter().map(parameters::Parameter::name).collect();
        let seeds = if source.runs.is_some() { "" } else { parameters::fix_seeds(&varying) };
        return Err(invalid_option(
            "--history",
            &columns.join(","),
            format!("{number} {noun} in one figure"),
            format!("{limit} {noun} at most"),
            format!("choose some with --jobs ID,ID or --where CONDITION{seeds}"),
        ));
    }
    let names: Vec<&str> = columns.iter().map(String::as_str).chain(TIME_AXIS_COLUMNS).collect();
    let mut histories = BTreeMap::new();
    for job in jobs {
        if let Some(id) = JobId::from_digits(job) {
            let mut history = read(&id)?;
            history.keep(&names);
            histories.insert(job, history);
        }
    }
    Ok(histories)
}

/// Whether the job of a row, or one of its runs, has a stored history.
pub fn has_history(source: &Source<'_>, row: usize) -> bool {
    let single = source.runs.map_or(source.table, |runs| runs.single);
    let hash = single.column("content_hash");
    let stored =
        |row: usize| hash.is_some_and(|column| matches!(column.cells[row], Value::Text(_)));
    match source.runs_of(row) {
        None => stored(row),
        Some(runs) => runs.finest.iter().any(|row| stored(*row)),
    }
}

/// A quantity of the figure, and what its lines share.
struct Quantity<'a> {
    symbol: &'a str,
    name: Name,
    /// Unit of the values.
    unit: Unit,
    /// Ends of the y axis.
    range: [f64; 2],
    time: &'a TimeAxis,
    /// The lines of limits, and notes on those that are far away.
    limits: Vec<Rule>,
    notes: Vec<String>,
    /// Whether lines are thin and few.
    thin: bool,
}

impl<'a> Quantity<'a> {
    /// A column of the history, or an extra quantity of a job.
    fn new(
        symbol: &'a str,
        source: &Source<'_>,
        histories: &Histories<'_>,
        time: &'a TimeAxis,
    ) -> Result<Self> {
        let columns = || COLUMNS.iter().filter(|column| column.name != "time");
        let column = columns().find(|column| column.name == symbol);
        let label = || {
            let label = histories.values().find_map(|history| history.labels.get(symbol))?;
            Some((label.0.as_str(), label.1.as_str()))
        };
        let found = column.map(|column| (column.unit, column.meaning)).or_else(label);
        let (si, meaning) = found.ok_or_else(|| {
            let tracks = histories.values().flat_map(|history| history.labels.keys());
            let mut tracks: Vec<&str> = tracks.map(String::as_str).collect();
            tracks.sort_unstable();
            tracks.dedup();
            let known: Vec<&str> = columns().map(|column| column.name).chain(tracks).collect();
            unknown_name("--history", symbol, "no such history column", &known)
        })?;
        let [start, end] = time.ends;
        let inside = histories.values().flat_map(|history| {
            let (times, values) = series(history, symbol);
            let pairs = times.iter().zip(values).filter(move |(t, _)| (start..=end).contains(*t));
            pairs.map(|(_, value)| *value).filter(|value| value.is_finite())
        });
        let ends = inside.map(|value| [value; 2]);
        let ends = ends.reduce(|[low, high], [value, _]| [low.min(value), high.max(value)]);
        let unit = Unit::fit(si, ends.into_iter().flatten());
        let (mut limits, mut notes) = (Vec::new(), Vec::new());
        let range = ends.map_or([0.0, 1.0], |ends| {
            let mut ends = ends.map(|end| unit.shown(end));
            for bound in source.bounds_of_history(symbol) {
                let (extended, note) = bound.extended(ends, &unit);
                limits.extend(note.is_none().then(|| bound.line(&unit)));
                notes.extend(note);
                ends = extended;
            }
            ticks::padded(ends[0], ends[1]).into()
        });
        let name = Name::of_quantity(symbol, meaning);
        // Velocities oscillate.
        Ok(Self { symbol, name, unit, range, time, limits, notes, thin: si == "m/s" })
    }

    /// The panel of these rows.
    fn panel(
        &self,
        source: &Source<'_>,
        rows: &[usize],
        histories: &Histories<'_>,
        encoding: &Encoding<'_>,
    ) -> Panel {
        let mut jobs: Vec<&str> = Vec::new();
        let mut lines: Vec<Line> = Vec::new();
        for (series, rows) in encoding.rows_by_line(rows).into_values() {
            for row in rows {
                // Points that are one job are one line.
                let job = source.job(row);
                if !jobs.contains(&job)
                    && let Some(line) = self.line(source, row, series, histories)
                {
                    jobs.push(job);
                    lines.push(line);
                }
            }
        }
        let message = if histories.is_empty() {
            "nothing to draw: none of these jobs has a history"
        } else if lines.iter().all(|line| line.pieces.is_empty()) {
            "nothing to draw: no value in this time range"
        } else {
            ""
        };
        Panel {
            label: self.name.label(&self.unit),
            range: self.range,
            rules: self.limits.clone(),
            lines,
            message: message.to_owned(),
            ..Panel::default()
        }
    }

    /// The line of a point: of its done runs the median with a band; without one, of its first run. Non-finite
    /// values interrupt it. A cross marks its last point if the job failed, a marker its last visible point if not
    /// every run deployed.
    fn line(
        &self,
        source: &Source<'_>,
        row: usize,
        series: Series,
        histories: &Histories<'_>,
    ) -> Option<Line> {
        let single = source.single();
        let rows = if source.runs.is_some() { source.single_rows(row).to_vec() } else { vec![row] };
        let stored = || rows.iter().filter(|row| histories.contains_key(single.job(**row)));
        let status = |row: usize| single.table.status(row);
        let mut shown: Vec<usize> =
            stored().copied().filter(|row| status(*row) == Some(Status::Done)).collect();
        if shown.is_empty() {
            shown.push(*stored().next()?);
        }
        let failed = status(shown[0]).is_some_and(Status::is_failure);
        let runs: Vec<&StoredHistory> =
            shown.iter().filter_map(|row| histories.get(single.job(*row))).collect();
        let spreads = self.spreads(&runs);
        let side = |pick: fn(&Spread) -> f64| -> Vec<[f64; 2]> {
            let [start, end] = self.time.shown();
            let point = |(t, spread): &(f64, Option<Spread>)| {
                let value =
                    spread.as_ref().map_or(f64::NAN, |spread| self.unit.shown(pick(spread)));
                [self.time.unit.shown(*t), value]
            };
            let points: Vec<[f64; 2]> = spreads.iter().map(point).collect();
            // Of the points beyond the time axis only the next ones are needed.
            let first = points.partition_point(|point| point[0] < start).saturating_sub(1);
            let past = (points.partition_point(|point| point[0] <= end) + 1).min(points.len());
            points[first.min(past)..past].to_vec()
        };
        let median = side(|spread| spread.median);
        let bands = if runs.len() > 1 {
            let [least, largest] = [side(|spread| spread.least), side(|spread| spread.largest)]
                .map(|side| pieces(&side));
            let ends = |(low, high): (&[f64; 2], &[f64; 2])| [low[0], low[1], high[1]];
            let band = |(low, high): (&Vec<_>, &Vec<_>)| low.iter().zip(high).map(ends).collect();
            least.iter().zip(&largest).map(band).collect()
        } else {
            Vec::new()
        };
        let [start, end] = self.time.shown();
        let visible = |point: &&[f64; 2]| point[1].is_finite() && (start..=end).contains(&point[0]);
        let last = median.iter().rfind(visible).copied();
        let is_end = |point: &[f64; 2]| {
            let end = spreads.iter().rfind(|(_, spread)| spread.is_some());
            end.is_some_and(|(t, _)| self.time.unit.shown(*t) <= point[0])
        };
        let (fill, _) = MARKERS[marker(source, row)];
        Some(Line {
            pieces: pieces(&median),
            thin: self.thin,
            marks: last
                .filter(|_| fill != Fill::Filled)
                .map(|last| (last, fill))
                .into_iter()
                .collect(),
            sparse_markers: true,
            crosses: last.filter(|last| failed && is_end(last)).into_iter().collect(),
            bands,
            ..Line::new(series)
        })
    }

    /// Times of the first run, and the spread of the values of all runs; `None` where a run has no finite value.
    fn spreads(&self, runs: &[&StoredHistory]) -> Vec<(f64, Option<Spread>)> {
        let series: Vec<_> = runs.iter().map(|run| series(run, self.symbol)).collect();
        let times = series.first().map_or(&[][..], |(times, _)| times);
        let spread = |time: &f64| {
            let values = series.iter().filter_map(|series| value_at(*series, *time));
            (*time, Spread::of(values).filter(|spread| spread.count == runs.len()))
        };
        times.iter().map(spread).collect()
    }
}

/// The value of a run at a time; `None` after its end, and where it is not finite.
fn value_at((times, values): (&[f64], &[f64]), time: f64) -> Option<f64> {
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

/// The finite pieces of a line.
fn pieces(points: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    let finite = |point: &[f64; 2]| point[1].is_finite();
    let pieces = points.chunk_by(|a, b| finite(a) == finite(b));
    pieces.filter(|piece| finite(&piece[0])).map(<[_]>::to_vec).collect()
}

/// The legend of the marks at the ends of lines.
fn ends(source: &Source<'_>) -> Legend {
    let count = |of: &dyn Fn(usize) -> bool| source.rows.iter().filter(|row| of(**row)).count();
    let mut entries: Vec<(Sample, String)> = Vec::new();
    let mut without_mark = Vec::new();
    for (number, (fill, name)) in MARKERS.into_iter().enumerate() {
        let name = if fill == Fill::Half { "some runs deployed" } else { name };
        let text = match count(&|row| marker(source, row) == number) {
            0 => continue,
            count => format!("{name} ({count})"),
        };
        match fill {
            Fill::Filled if name.contains("deployed") => without_mark.push(text),
            Fill::Filled => {}
            _ => entries.push((Sample::Marker(fill), text)),
        }
    }
    for status in Status::all().filter(|status| status.is_failure()) {
        let number = count(&|row| source.table.status(row) == Some(status));
        if number > 0 && source.runs.is_none() {
            entries.push((Sample::Cross, format!("failed: {} ({number})", status.name())));
        }
    }
    let mut heading = "Outcome, at the end of a line (number of points)".to_owned();
    if !without_mark.is_empty() {
        heading = format!("{heading}; no mark: {}", without_mark.join(", "));
    }
    Legend { heading, entries }
}

/// A note with the number of points without a line, by status.
fn not_drawn(source: &Source<'_>) -> Option<String> {
    let missing: Vec<usize> =
        source.rows.iter().copied().filter(|row| !has_history(source, *row)).collect();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for row in &missing {
        *counts.entry(outcome::status(source, *row)).or_default() += 1;
    }
    let texts: Vec<String> = counts.iter().map(|(status, n)| format!("{n} {status}")).collect();
    let points = source.rows.len();
    (!missing.is_empty()).then(|| {
        format!("{} of {points} points have no history: {}.", missing.len(), texts.join(", "))
    })
}
