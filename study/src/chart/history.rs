//! Histories of several jobs in one figure: one panel per quantity, one line per job.

use billow_solver::output::history::COLUMNS;
use billow_solver::output::measures::Verdict;

use super::parameters::{self, Parameter};
use super::{Source, invalid_option, outcome, title, unknown_name};
use crate::input::value::Value;
use crate::job::{JobId, Status};
use crate::platform::error::Result;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Axis, Line, Panel, Plots};
use crate::render::figure::scale::Spread;
use crate::render::figure::unit::Unit;
use crate::render::figure::{Sheet, ticks};
use crate::store::history_file::StoredHistory;

/// Most jobs in one figure. Chosen: more lines cannot be distinguished.
const MAX_JOBS: usize = 20;

/// A job of the figure.
struct Run {
    row: usize,
    history: StoredHistory,
}

impl Run {
    fn times(&self) -> &[f64] {
        self.history.history.column("time")
    }

    /// Values of a quantity; empty when the job does not have it.
    fn values(&self, name: &str) -> &[f64] {
        match self.history.tracks.get(name) {
            Some(values) => values,
            None if COLUMNS.iter().any(|column| column.name == name) => {
                self.history.history.column(name)
            }
            None => &[],
        }
    }
}

/// A quantity: name, SI unit, meaning.
struct Quantity {
    name: String,
    unit: String,
    meaning: String,
}

/// The time axis: its ends, s, and the unit in which it is shown.
struct TimeAxis {
    ends: [f64; 2],
    unit: Unit,
}

/// Draws columns of histories over time. `range` gives the ends of the time axis, s, where they differ
/// from the ends of the histories.
///
/// # Errors
/// An unknown column, too many jobs, an empty range; the errors of `read`.
pub fn svg(
    source: &Source<'_>,
    columns: &[String],
    range: [Option<f64>; 2],
    read: &dyn Fn(&JobId) -> Result<StoredHistory>,
) -> Result<String> {
    let stored: Vec<usize> =
        source.rows.iter().copied().filter(|row| has_history(source, *row)).collect();
    let runs = runs(source, &stored, columns, read)?;
    let quantities: Vec<Quantity> =
        columns.iter().map(|name| quantity(name.trim(), &runs)).collect::<Result<_>>()?;
    let time = time_axis(&runs, range)?;
    let mut panels: Vec<Panel> =
        quantities.iter().map(|quantity| panel(source, quantity, &runs, &time)).collect();
    let title = match quantities.as_slice() {
        [quantity] => title(&quantity.meaning, &quantity.name),
        several => {
            let names: Vec<&str> = several.iter().map(|quantity| quantity.name.as_str()).collect();
            format!("Histories of {}", names.join(", "))
        }
    };
    // The title of the figure replaces that of a single panel.
    if let [panel] = panels.as_mut_slice() {
        panel.title.clear();
    }
    let (parameters, notes) = parameters::varying(source.table, &stored, &[]);
    let mut notes: Vec<String> = if parameters.is_empty() { Vec::new() } else { notes };
    notes.extend(without_history(source));
    let plots = Plots {
        sheet: Sheet {
            title,
            subtitle: source.subtitle(),
            legends: legends(source, &parameters, &runs),
            notes,
        },
        x: Axis {
            label: time.unit.label("time"),
            spread: Spread::Linear,
            range: time.ends.map(|end| time.unit.shown(end)),
            ticks: Vec::new(),
            names: false,
        },
        panels,
        across: 1,
    };
    Ok(plots.svg())
}

/// Reads the histories of these rows.
fn runs(
    source: &Source<'_>,
    rows: &[usize],
    columns: &[String],
    read: &dyn Fn(&JobId) -> Result<StoredHistory>,
) -> Result<Vec<Run>> {
    if rows.len() > MAX_JOBS {
        return Err(invalid_option(
            "--history",
            &columns.join(","),
            format!("{} jobs in one figure", rows.len()),
            format!("{MAX_JOBS} jobs at most"),
            "choose some with --jobs ID,ID or --where CONDITION",
        ));
    }
    let mut runs = Vec::with_capacity(rows.len());
    for row in rows {
        if let Some(id) = job(source, *row) {
            runs.push(Run { row: *row, history: read(&id)? });
        }
    }
    Ok(runs)
}

/// The time axis: from the first to the last time of all histories, or the ends that `range` gives.
fn time_axis(runs: &[Run], range: [Option<f64>; 2]) -> Result<TimeAxis> {
    let times = runs.iter().flat_map(Run::times);
    let ends = times.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], time| {
        [low.min(*time), high.max(*time)]
    });
    let mut ends = if runs.is_empty() { [0.0, 1.0] } else { ends };
    for (end, given) in ends.iter_mut().zip(range) {
        *end = given.unwrap_or(*end);
    }
    if ends[0].total_cmp(&ends[1]).is_ge() {
        if range != [None, None] {
            return Err(invalid_option(
                "--from, --to",
                &format!("{} s to {} s", ends[0], ends[1]),
                "the time range is empty",
                "--from TIME before --to TIME, both within the run",
                "",
            ));
        }
        ends[1] = ends[0] + 1.0;
    }
    Ok(TimeAxis { ends, unit: Unit::fit("s", ends) })
}

/// Whether the job of a row has a stored history.
pub fn has_history(source: &Source<'_>, row: usize) -> bool {
    let hash = source.table.column("content_hash");
    hash.is_some_and(|column| matches!(column.cells[row], Value::Text(_)))
}

fn job(source: &Source<'_>, row: usize) -> Option<JobId> {
    match source.table.column("job").map(|column| &column.cells[row]) {
        Some(Value::Text(id)) => JobId::from_digits(id),
        _ => None,
    }
}

/// The quantity with that name: a column of the history, or an extra quantity of a job.
fn quantity(name: &str, runs: &[Run]) -> Result<Quantity> {
    let shown = || COLUMNS.iter().filter(|column| column.name != "time");
    if let Some(column) = shown().find(|column| column.name == name) {
        return Ok(Quantity {
            name: name.to_owned(),
            unit: column.unit.to_owned(),
            meaning: column.meaning.to_owned(),
        });
    }
    let found = runs.iter().find_map(|run| run.history.labels.get(name));
    if let Some((unit, meaning)) = found {
        return Ok(Quantity {
            name: name.to_owned(),
            unit: unit.clone(),
            meaning: meaning.clone(),
        });
    }
    let mut known: Vec<&str> = shown().map(|column| column.name).collect();
    for track in runs.iter().flat_map(|run| run.history.labels.keys()) {
        if !known.contains(&track.as_str()) {
            known.push(track);
        }
    }
    Err(unknown_name("--history", name, "no such history column", &known))
}

/// The panel of a quantity: one line per job.
fn panel(source: &Source<'_>, quantity: &Quantity, runs: &[Run], time: &TimeAxis) -> Panel {
    let [start, end] = time.ends;
    let inside = |run: &Run| -> Vec<f64> {
        let pairs = run.times().iter().zip(run.values(&quantity.name));
        pairs.filter(|(t, _)| (start..=end).contains(*t)).map(|(_, value)| *value).collect()
    };
    let values: Vec<f64> = runs.iter().flat_map(inside).filter(|value| value.is_finite()).collect();
    let unit = Unit::fit(&quantity.unit, values.iter().copied());
    let extent = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(unit.shown(*value)), high.max(unit.shown(*value))]
    });
    let (low, high) =
        if values.is_empty() { (0.0, 1.0) } else { ticks::padded(extent[0], extent[1]) };
    let line = |(series, run): (usize, &Run)| {
        let failed = outcome::has_failed(source, run.row);
        history_line(series, run, quantity, &unit, time, failed)
    };
    let message = if runs.is_empty() {
        "nothing to draw: none of these jobs has a history"
    } else if values.is_empty() {
        "nothing to draw: no value in this time range"
    } else {
        ""
    };
    Panel {
        title: quantity.meaning.clone(),
        label: unit.label(&quantity.name),
        range: [low, high],
        lines: runs.iter().enumerate().map(line).collect(),
        lane: Vec::new(),
        message: message.to_owned(),
    }
}

/// The line of one job. Non-finite values interrupt it; a cross marks its last point if the job failed.
fn history_line(
    series: usize,
    run: &Run,
    quantity: &Quantity,
    unit: &Unit,
    time: &TimeAxis,
    failed: bool,
) -> Line {
    let [start, end] = time.ends.map(|end| time.unit.shown(end));
    let points: Vec<[f64; 2]> = run
        .times()
        .iter()
        .zip(run.values(&quantity.name))
        .map(|(t, value)| [time.unit.shown(*t), unit.shown(*value)])
        .collect();
    let finite = |point: &[f64; 2]| point[1].is_finite();
    let pieces: Vec<Vec<[f64; 2]>> = points
        .chunk_by(|a, b| finite(a) == finite(b))
        .filter(|piece| finite(&piece[0]))
        .map(<[_]>::to_vec)
        .collect();
    let last = pieces.last().and_then(|piece| piece.last()).copied();
    let visible = |point: &[f64; 2]| (start..=end).contains(&point[0]);
    let crosses = last.filter(|point| failed && visible(point)).into_iter().collect();
    Line { series, pieces, marks: Vec::new(), sparse_markers: true, crosses }
}

fn legends(source: &Source<'_>, parameters: &[Parameter<'_>], runs: &[Run]) -> Vec<Legend> {
    let entry = |(series, run): (usize, &Run)| {
        let values: Vec<String> =
            parameters.iter().map(|parameter| parameter.of_row(run.row)).collect();
        let mut text = if values.is_empty() {
            format!("job {}", run.history.job.short())
        } else {
            values.join(", ")
        };
        let status = outcome::status(source, run.row);
        let verdict = outcome::verdict(source, run.row);
        if status != Status::Done.name() {
            text = format!("{text} ({status})");
        } else if !verdict.is_empty() && verdict != Verdict::Deployed.name() {
            text = format!("{text} ({verdict})");
        }
        (Sample::Series(series), text)
    };
    let lines = Legend {
        heading: parameters::heading(parameters),
        entries: runs.iter().enumerate().map(entry).collect(),
    };
    let failed = runs.iter().any(|run| outcome::has_failed(source, run.row));
    let crosses = if failed {
        vec![(Sample::Cross, "end of a run that failed".to_owned())]
    } else {
        Vec::new()
    };
    vec![lines, Legend { heading: String::new(), entries: crosses }]
}

/// A note with the number of points without a history, by status.
fn without_history(source: &Source<'_>) -> Option<String> {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for row in source.rows.iter().filter(|row| !has_history(source, **row)) {
        let status = outcome::status(source, *row);
        match counts.iter_mut().find(|(known, _)| *known == status) {
            Some((_, count)) => *count += 1,
            None => counts.push((status, 1)),
        }
    }
    let texts: Vec<String> = counts.iter().map(|(status, n)| format!("{n} {status}")).collect();
    (!texts.is_empty()).then(|| format!("Without a history: {}.", texts.join(", ")))
}
