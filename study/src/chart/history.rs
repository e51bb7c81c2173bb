//! Histories of several jobs in one figure: a panel a quantity, a line a job.

use billow_solver::output::history::COLUMNS;

use super::vary::{self, Parameter};
use super::{Source, outcome, refused, titled, unknown};
use crate::input::value::Value;
use crate::job::{JobId, Status};
use crate::platform::error::Result;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::plot::{Axis, Line, Panel, Plots};
use crate::render::figure::scale::Spread;
use crate::render::figure::unit::Unit;
use crate::render::figure::{Sheet, ticks};
use crate::store::history_file::StoredHistory;

/// Jobs in one figure, at most: more lines cannot be told apart.
const JOBS: usize = 20;

/// A job of the figure.
struct Run {
    row: usize,
    history: StoredHistory,
}

/// A quantity: its name, SI unit, meaning.
struct Quantity {
    name: String,
    unit: String,
    meaning: String,
}

/// Draws columns of histories over time, from `range[0]` to `range[1]` (s) where they are given.
///
/// # Errors
/// A column no history has, too many jobs, an empty range; whatever `read` gives for a file.
pub fn svg(
    source: &Source<'_>,
    columns: &[String],
    range: [Option<f64>; 2],
    read: &dyn Fn(&JobId) -> Result<StoredHistory>,
) -> Result<String> {
    let stored: Vec<usize> =
        source.rows.iter().copied().filter(|row| has_history(source, *row)).collect();
    if stored.len() > JOBS {
        return Err(refused(
            "--history",
            &columns.join(","),
            format!("{} jobs in one figure", stored.len()),
            format!("{JOBS} jobs at most"),
            "choose some with --jobs ID,ID or --where CONDITION",
        ));
    }
    let mut runs = Vec::with_capacity(stored.len());
    for row in &stored {
        if let Some(id) = job(source, *row) {
            runs.push(Run { row: *row, history: read(&id)? });
        }
    }
    let quantities: Vec<Quantity> =
        columns.iter().map(|name| quantity(name.trim(), &runs)).collect::<Result<_>>()?;
    let times = || runs.iter().flat_map(|run| run.history.history.column("time"));
    let ends = times().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], time| {
        [low.min(*time), high.max(*time)]
    });
    let mut ends = if runs.is_empty() { [0.0, 1.0] } else { ends };
    for (end, given) in ends.iter_mut().zip(range) {
        *end = given.unwrap_or(*end);
    }
    let empty = ends[0].total_cmp(&ends[1]).is_ge();
    if empty && range != [None, None] {
        return Err(refused(
            "--from, --to",
            &format!("{} s to {} s", ends[0], ends[1]),
            "no time is between them",
            "--from TIME before --to TIME, both within the run",
            "",
        ));
    }
    if empty {
        ends[1] = ends[0] + 1.0;
    }
    let time = Unit::fit("s", ends);
    let panels: Vec<Panel> =
        quantities.iter().map(|quantity| panel(source, quantity, &runs, &time, ends)).collect();
    let alone = panels.len() == 1;
    let title = match quantities.as_slice() {
        [one] => titled(&one.meaning, &one.name),
        several => {
            let names: Vec<&str> = several.iter().map(|each| each.name.as_str()).collect();
            format!("Histories of {}", names.join(", "))
        }
    };
    let (parameters, notes) = vary::varying(source.table, &stored, &[]);
    let mut notes: Vec<String> = if parameters.is_empty() { Vec::new() } else { notes };
    notes.extend(missing(source));
    let plots = Plots {
        sheet: Sheet {
            title,
            subtitle: source.subtitle(),
            legends: legends(source, &parameters, &runs),
            notes,
        },
        x: Axis {
            label: time.label("time"),
            spread: Spread::Linear,
            range: ends.map(|end| time.shown(end)),
            ticks: Vec::new(),
            names: false,
        },
        panels: panels
            .into_iter()
            .map(|panel| Panel { title: if alone { String::new() } else { panel.title }, ..panel })
            .collect(),
        across: 1,
    };
    Ok(plots.svg())
}

/// Whether a history is stored of a row's job.
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

/// The quantity of that name, of a history or of what a job follows beside it.
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
    Err(unknown("--history", name, "no such history column", &known))
}

/// Values of a quantity; empty where a job has none of it.
fn series<'a>(run: &'a Run, name: &str) -> &'a [f64] {
    match run.history.tracks.get(name) {
        Some(values) => values,
        None if COLUMNS.iter().any(|column| column.name == name) => {
            run.history.history.column(name)
        }
        None => &[],
    }
}

fn panel(
    source: &Source<'_>,
    quantity: &Quantity,
    runs: &[Run],
    time: &Unit,
    [from, to]: [f64; 2],
) -> Panel {
    let inside = |run: &Run| -> Vec<f64> {
        let pairs = run.history.history.column("time").iter().zip(series(run, &quantity.name));
        pairs.filter(|(at, _)| (from..=to).contains(*at)).map(|(_, value)| *value).collect()
    };
    let values: Vec<f64> = runs.iter().flat_map(inside).filter(|value| value.is_finite()).collect();
    let unit = Unit::fit(&quantity.unit, values.iter().copied());
    let reach = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(unit.shown(*value)), high.max(unit.shown(*value))]
    });
    let (low, high) = if values.is_empty() { (0.0, 1.0) } else { ticks::roomy(reach[0], reach[1]) };
    let line = |(number, run): (usize, &Run)| {
        let times = run.history.history.column("time");
        let points: Vec<[f64; 2]> = times
            .iter()
            .zip(series(run, &quantity.name))
            .map(|(at, value)| [time.shown(*at), unit.shown(*value)])
            .collect();
        // What is no number breaks the line.
        let finite = |point: &[f64; 2]| point[1].is_finite();
        let runs: Vec<Vec<[f64; 2]>> = points
            .chunk_by(|one, other| finite(one) == finite(other))
            .filter(|run| finite(&run[0]))
            .map(<[_]>::to_vec)
            .collect();
        let last = runs.last().and_then(|run| run.last()).copied();
        let failed = outcome::has_failed(source, run.row);
        let visible = |point: &[f64; 2]| (time.shown(from)..=time.shown(to)).contains(&point[0]);
        let crosses = last.filter(|point| failed && visible(point)).into_iter().collect();
        Line { series: number, runs, marks: Vec::new(), sparse: true, crosses }
    };
    let words = if runs.is_empty() {
        "nothing to draw: none of these jobs has a history"
    } else if values.is_empty() {
        "nothing to draw: no value in this time"
    } else {
        ""
    };
    Panel {
        title: quantity.meaning.clone(),
        label: unit.label(&quantity.name),
        range: [low, high],
        lines: runs.iter().enumerate().map(line).collect(),
        lane: Vec::new(),
        words: words.to_owned(),
    }
}

fn legends(source: &Source<'_>, parameters: &[Parameter<'_>], runs: &[Run]) -> Vec<Legend> {
    let entry = |(number, run): (usize, &Run)| {
        let values: Vec<String> = parameters.iter().map(|each| each.of_row(run.row)).collect();
        let mut text = if values.is_empty() {
            format!("job {}", run.history.job.short())
        } else {
            values.join(", ")
        };
        let status = outcome::status(source, run.row);
        let verdict = outcome::verdict(source, run.row);
        if status != Status::Done.name() {
            text = format!("{text} ({status})");
        } else if !matches!(verdict, "" | "deployed") {
            text = format!("{text} ({verdict})");
        }
        (Sample::Series(number), text)
    };
    let lines = Legend {
        heading: vary::heading(parameters),
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

/// Which points have no history, in words.
fn missing(source: &Source<'_>) -> Option<String> {
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
