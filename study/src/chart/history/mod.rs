//! Histories of several jobs in one figure: one line per job, one row of panels per quantity.

use std::collections::BTreeMap;

use billow_solver::output::history::COLUMNS;
use billow_solver::output::measures::Verdict;

use super::encoding::{Encoding, PREFERRED_LINES};
use super::names;
use super::parameters;
use super::time_axis::TimeAxis;
use super::{Source, invalid_option, outcome};
use crate::input::value::Value;
use crate::job::{JobId, Status};
use crate::platform::error::Result;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Axis, Line, Panel, Plots};
use crate::render::figure::scale::Spread;
use crate::render::figure::style::{Fill, Series};
use crate::render::figure::{Sheet, columns as columns_of};
use crate::store::history_file::StoredHistory;

mod quantity;

use quantity::{Drawn, Quantity, drawn, quantity};

/// Most jobs in one figure. Chosen: 12 panels with a few lines each.
pub const MAX_JOBS: usize = 48;
/// Most lines in a panel of a quantity that rings. Chosen: more cover each other.
const MAX_RINGING_LINES: usize = 3;
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
    let stored: Vec<usize> =
        source.rows.iter().copied().filter(|row| has_history(source, *row)).collect();
    let runs = runs(source, &stored, columns, read)?;
    let quantities: Vec<Quantity> =
        columns.iter().map(|name| quantity(name.trim(), &runs)).collect::<Result<_>>()?;
    let histories: Vec<&StoredHistory> = runs.values().map(|run| &run.history).collect();
    let time = TimeAxis::new(&histories, range)?;
    let drawn: Vec<Drawn<'_>> =
        quantities.iter().map(|quantity| drawn(quantity, &runs, &time)).collect();

    let chosen = Source { rows: stored.clone(), ..source.clone() };
    let (others, mut notes) = parameters::varying(source.table, &stored, &[]);
    let asked = columns.join(",");
    let encoding = |preferred: usize| {
        Encoding::new(&chosen, others.clone(), &[], preferred, false, ("--history", &asked))
    };
    let rings = drawn.iter().any(|drawn| drawn.rings);
    let encoding = if rings && drawn.len() == 1 {
        encoding(MAX_RINGING_LINES).or_else(|_| encoding(PREFERRED_LINES))?
    } else {
        encoding(PREFERRED_LINES)?
    };
    let facets = &encoding.panels.panels;
    let across = columns_of(facets.len());
    let mut panels: Vec<Panel> = Vec::new();
    for drawn in &drawn {
        for (title, rows) in facets {
            let mut panel = panel(source, drawn, rows, &runs, &encoding);
            panel.title = names::capital(title);
            panels.push(panel);
        }
        // The next quantity starts a row.
        while quantities.len() > 1 && !panels.len().is_multiple_of(across) {
            panels.push(Panel { blank: true, range: drawn.range, ..Panel::default() });
        }
    }
    let plain: Vec<&str> = quantities.iter().map(|quantity| quantity.name.plain.as_str()).collect();
    notes.extend(time.note.clone());
    notes.extend(source.shared_job_note());
    notes.extend(not_drawn(source, runs.len()));
    let plots = Plots {
        sheet: Sheet {
            title: source.title_or(&format!("{} over time", plain.join(", "))),
            subtitle: source.subtitle(),
            legends: legends(source, &encoding, &runs),
            notes,
        },
        x: Axis {
            label: time.unit.label("Time t"),
            spread: Spread::Linear,
            range: time.ends.map(|end| time.unit.shown(end)),
            ticks: Vec::new(),
            names: false,
        },
        panels,
        across,
    };
    Ok(plots.svg())
}

/// Reads the histories of these rows, by job; a job with several rows has that of the first one.
fn runs<'a>(
    source: &Source<'a>,
    rows: &[usize],
    columns: &[String],
    read: &dyn Fn(&JobId) -> Result<StoredHistory>,
) -> Result<BTreeMap<&'a str, Run>> {
    let mut first: BTreeMap<&str, usize> = BTreeMap::new();
    for row in rows {
        first.entry(source.job(*row)).or_insert(*row);
    }
    if first.len() > MAX_JOBS {
        return Err(invalid_option(
            "--history",
            &columns.join(","),
            format!("{} jobs in one figure", first.len()),
            format!("{MAX_JOBS} jobs at most"),
            "choose some with --jobs ID,ID or --where CONDITION",
        ));
    }
    let mut runs = BTreeMap::new();
    for (job, row) in first {
        if let Some(id) = JobId::from_digits(job) {
            runs.insert(job, Run { row, history: read(&id)? });
        }
    }
    Ok(runs)
}

/// Whether the job of a row has a stored history.
pub fn has_history(source: &Source<'_>, row: usize) -> bool {
    let hash = source.table.column("content_hash");
    hash.is_some_and(|column| matches!(column.cells[row], Value::Text(_)))
}

/// The panel of a quantity: one line per job of these rows.
fn panel(
    source: &Source<'_>,
    drawn: &Drawn<'_>,
    rows: &[usize],
    runs: &BTreeMap<&str, Run>,
    encoding: &Encoding<'_>,
) -> Panel {
    let mut jobs: Vec<&str> = Vec::new();
    let mut lines: Vec<(usize, Line)> = Vec::new();
    for row in rows {
        let job = source.job(*row);
        // Points that are one job are one line.
        if let Some(run) = runs.get(job).filter(|_| !jobs.contains(&job)) {
            jobs.push(job);
            let (index, series) = encoding.line(*row);
            lines.push((index, history_line(source, series, run, drawn)));
        }
    }
    lines.sort_by_key(|(index, _)| *index);
    let empty = lines.iter().all(|(_, line)| line.pieces.is_empty());
    let message = if runs.is_empty() {
        "nothing to draw: none of these jobs has a history"
    } else if empty {
        "nothing to draw: no value in this time range"
    } else {
        ""
    };
    Panel {
        label: drawn.quantity.name.label(&drawn.unit),
        range: drawn.range,
        lines: lines.into_iter().map(|(_, line)| line).collect(),
        message: message.to_owned(),
        ..Panel::default()
    }
}

/// The line of one job. Non-finite values interrupt it. A cross marks its last point if the job failed, a
/// marker its last visible point if the capsule did not deploy.
fn history_line(source: &Source<'_>, series: Series, run: &Run, drawn: &Drawn<'_>) -> Line {
    let Drawn { quantity, unit, time, rings, .. } = drawn;
    let [start, end] = time.ends.map(|end| time.unit.shown(end));
    let points: Vec<[f64; 2]> = run
        .times()
        .iter()
        .zip(run.values(&quantity.symbol))
        .map(|(t, value)| [time.unit.shown(*t), unit.shown(*value)])
        .collect();
    let finite = |point: &[f64; 2]| point[1].is_finite();
    let visible = |point: &&[f64; 2]| (start..=end).contains(&point[0]);
    let last = points.iter().rfind(|point| finite(point)).filter(visible).copied();
    let crosses = last.filter(|_| outcome::has_failed(source, run.row)).into_iter().collect();
    let marker = not_deployed(source, run.row);
    let end = points.iter().rfind(|point| finite(point) && visible(point));
    let marks = marker.and_then(|fill| end.map(|point| (*point, fill))).into_iter().collect();
    // Of the points beyond the axis only the next ones are needed.
    let first = points.partition_point(|point| point[0] < start).saturating_sub(1);
    let past = (points.partition_point(|point| point[0] <= time.unit.shown(time.ends[1])) + 1)
        .min(points.len());
    let pieces: Vec<Vec<[f64; 2]>> = points[first.min(past)..past]
        .chunk_by(|a, b| finite(a) == finite(b))
        .filter(|piece| finite(&piece[0]))
        .map(<[_]>::to_vec)
        .collect();
    Line { series, pieces, marks, sparse_markers: true, crosses, rings: *rings }
}

/// The marker at the end of a line: of a done job that is not deployed.
fn not_deployed(source: &Source<'_>, row: usize) -> Option<Fill> {
    let verdict = outcome::verdict(source, row).filter(|verdict| *verdict != Verdict::Deployed)?;
    Some(outcome::fill(Some(verdict)))
}

/// The legends of the lines, and of the marks at their ends.
fn legends(
    source: &Source<'_>,
    encoding: &Encoding<'_>,
    runs: &BTreeMap<&str, Run>,
) -> Vec<Legend> {
    let mut legends = encoding.legends(false);
    let mut ends: Vec<(Sample, String)> = Vec::new();
    for verdict in [Verdict::Partial, Verdict::Stalled] {
        let of_verdict = |run: &&Run| outcome::verdict(source, run.row) == Some(verdict);
        let count = runs.values().filter(of_verdict).count();
        if count > 0 {
            let sample = Sample::Marker(outcome::fill(Some(verdict)));
            ends.push((sample, format!("{} ({count})", verdict.name())));
        }
    }
    for status in Status::all().filter(|status| status.is_failure()) {
        let of_status = |run: &&Run| source.table.status(run.row) == Some(status);
        let count = runs.values().filter(of_status).count();
        if count > 0 {
            ends.push((Sample::Cross, format!("failed: {} ({count})", status.name())));
        }
    }
    let deployed = |run: &&Run| outcome::verdict(source, run.row) == Some(Verdict::Deployed);
    let deployed = runs.values().filter(deployed).count();
    let heading = if deployed > 0 {
        format!("Outcome, at the end of a line (number of jobs); no mark: deployed ({deployed})")
    } else {
        "Outcome, at the end of a line (number of jobs)".to_owned()
    };
    legends.push(Legend { heading, entries: ends });
    legends
}

/// A note with the number of points without a line, by status.
fn not_drawn(source: &Source<'_>, lines: usize) -> Option<String> {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for row in source.rows.iter().filter(|row| !has_history(source, **row)) {
        let status = outcome::status(source, *row);
        match counts.iter_mut().find(|(known, _)| *known == status) {
            Some((_, count)) => *count += 1,
            None => counts.push((status, 1)),
        }
    }
    let texts: Vec<String> = counts.iter().map(|(status, n)| format!("{n} {status}")).collect();
    let missing: usize = counts.iter().map(|(_, count)| count).sum();
    let (points, noun) = (source.rows.len(), if lines == 1 { "line" } else { "lines" });
    (missing > 0).then(|| {
        format!(
            "{lines} {noun} for {points} points; {missing} have no history: {}.",
            texts.join(", ")
        )
    })
}
