//! Histories of several jobs in one figure: one line per job, one row of panels per quantity. The runs that
//! repeat a point are one line, their median, with a band (`medians`).

use std::collections::BTreeMap;

use billow_solver::output::history::COLUMNS;
use billow_solver::output::measures::Verdict;

use super::encoding::{Encoding, PREFERRED_LINES};
use super::names;
use super::parameters;
use super::time_axis::{TIME_AXIS_COLUMNS, TimeAxis};
use super::{Source, invalid_option, outcome};
use crate::input::value::Value;
use crate::job::{JobId, Status};
use crate::platform::error::Result;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Axis, Line, Panel, Plots};
use crate::render::figure::scale::Spread;
use crate::render::figure::{Sheet, columns as columns_of};
use crate::store::history_file::StoredHistory;

mod line;
mod medians;
mod quantity;

use line::history_line;
use quantity::{Drawn, Quantity, drawn, quantity};

/// Most jobs in one figure. Chosen: 12 panels with a few lines each.
pub const MAX_JOBS: usize = 48;
/// Most lines in a panel of a quantity that oscillates. Chosen: more cover each other.
const MAX_THIN_LINES: usize = 3;
/// Most runs behind the lines of a figure. Chosen: what is drawn of their histories is in memory together, some 200 kB of a
/// run with 6000 samples.
const MAX_RUNS: usize = 2000;

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
    let (mut others, mut notes) = parameters::varying(source.table, &stored, &[]);
    if source.runs.is_some() {
        others = parameters::strategy_first(others);
    }
    let asked = columns.join(",");
    let encoding = |preferred: usize| {
        Encoding::new(&chosen, others.clone(), &[], preferred, false, ("--history", &asked))
    };
    let thin = drawn.iter().any(|drawn| drawn.thin);
    let encoding = if thin && drawn.len() == 1 {
        encoding(MAX_THIN_LINES).or_else(|_| encoding(PREFERRED_LINES))?
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
    let lines = if source.runs.is_some() { stored.len() } else { runs.len() };
    notes.extend(not_drawn(source, lines));
    notes.extend(source.runs_notes(None));
    let plots = Plots {
        sheet: Sheet {
            title: source.title_or(&format!("{} over time", plain.join(", "))),
            subtitle: source.subtitle(),
            legends: legends(&chosen, &encoding, &runs),
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
    let single = Source { rows: rows.to_vec(), ..source.clone() }.single();
    let mut first: BTreeMap<&str, usize> = BTreeMap::new();
    for row in single.rows.iter().filter(|row| has_history(&single, **row)) {
        first.entry(single.job(*row)).or_insert(*row);
    }
    let (varying, _) = parameters::varying(source.table, rows, &[]);
    let varying: Vec<&str> = varying.iter().map(parameters::Parameter::name).collect();
    let seeds = if source.runs.is_some() { "" } else { parameters::fix_seeds(&varying) };
    let too_many = |number: usize, noun: &str, limit: usize| {
        Err(invalid_option(
            "--history",
            &columns.join(","),
            format!("{number} {noun} in one figure"),
            format!("{limit} {noun} at most"),
            format!("choose some with --jobs ID,ID or --where CONDITION{seeds}"),
        ))
    };
    if source.runs.is_some() && rows.len() > MAX_JOBS {
        return too_many(rows.len(), "points", MAX_JOBS);
    }
    let (noun, limit) = if source.runs.is_some() { ("runs", MAX_RUNS) } else { ("jobs", MAX_JOBS) };
    if first.len() > limit {
        return too_many(first.len(), noun, limit);
    }
    let mut runs = BTreeMap::new();
    let names = columns.iter().map(|name| name.trim());
    let names: Vec<&str> = names.chain(TIME_AXIS_COLUMNS).collect();
    for (job, row) in first {
        if let Some(id) = JobId::from_digits(job) {
            let mut history = read(&id)?;
            history.keep(&names);
            runs.insert(job, Run { row, history });
        }
    }
    Ok(runs)
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
        if jobs.contains(&job) {
            continue;
        }
        let (index, series) = encoding.line(*row);
        let line = if source.runs.is_some() {
            medians::line(source, *row, series, runs, drawn)
        } else {
            runs.get(job).map(|run| history_line(source, series, run, drawn))
        };
        if let Some(line) = line {
            jobs.push(job);
            lines.push((index, line));
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

/// The legends of the lines, and of the marks at their ends.
fn legends(
    source: &Source<'_>,
    encoding: &Encoding<'_>,
    runs: &BTreeMap<&str, Run>,
) -> Vec<Legend> {
    let mut legends = encoding.legends(false);
    if source.has_replicates() {
        legends.extend(medians::legends(source));
        return legends;
    }
    let single = source.single();
    let source = &single;
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
