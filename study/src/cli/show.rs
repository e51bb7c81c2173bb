//! `billow show`: prints everything stored for one job.

use std::io::Write;

use billow_solver::output::events::Event;
use billow_solver::output::history::COLUMNS;

use super::limits;
use super::options::{OutputOptions, QuietOption, UnitsOption};
use super::print::{Heading, print_quantities, print_rows};
use super::remedies;
use super::target::{StudyArgs, current_name, folder_of_job};
use super::{Format, output_error};
use crate::accuracy::{NO_ERROR_REASON, is_error_column};
use crate::input::keys::{self, KEYS};
use crate::input::renamed;
use crate::input::units::DisplayUnits;
use crate::input::value::Value;
use crate::job::JobId;
use crate::job::row::ColumnGroup;
use crate::platform::error::{Error, Result};
use crate::platform::nearest::did_you_mean;
use crate::scene::summary;
use crate::store::history_file::{self, StoredHistory};
use crate::store::stored::Stored;

/// Columns of a history that a table shows by default.
const DEFAULT_COLUMNS: [&str; 8] = [
    "time",
    "z_rim",
    "vz",
    "volume",
    "pressure",
    "temperature",
    "kinetic_energy",
    "ledger_residual",
];

/// Arguments of `billow show`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The job: the first digits of its id.
    pub job: String,
    #[command(flatten)]
    study: StudyArgs,
    /// Print only the scene of the job, as JSON.
    #[arg(long, conflicts_with_all = ["history", "columns", "every"])]
    pub scene: bool,
    /// Print the history: one row per sample.
    #[arg(long)]
    pub history: bool,
    /// Columns of the history, comma-separated, or "all" [default: the main columns; all for csv
    /// and json].
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "history")]
    pub columns: Vec<String>,
    /// Print every N-th sample of the history, and the last one [default: 1].
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1,
        requires = "history",
        hide_default_value = true
    )]
    pub every: usize,
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Runs `billow show`.
///
/// # Errors
/// An unknown job; a history or results that cannot be read.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let root = folder_of_job(&args.job, &args.study)?;
    let (stored, id) = super::stored::read_job(&root, &args.job)?;
    if args.scene {
        let scene = scene(&stored, &id)?;
        return writeln!(out, "{scene:#}").map_err(output_error);
    }
    if args.history {
        let history = history_of(&stored, &id)?;
        return print_history(&history, args, stored.study.display_units(), out);
    }
    let rows = rows(&stored, &id);
    let format = args.output.format();
    let rows = if format == Format::Table { in_units(rows, args, &stored)? } else { rows };
    print_rows(&["group", "name", "value", "unit", "meaning"], &rows, format, out)
}

/// The rows with their values in the units that a reader asks for.
fn in_units(
    mut rows: Vec<Vec<Value>>,
    args: &Args,
    stored: &Stored<'_>,
) -> Result<Vec<Vec<Value>>> {
    // Name, value and unit are the cells 1, 2 and 3; a scene names its keys by their paths.
    let named = |row: &[Value]| {
        let name = row[1].to_string();
        keys::index(&name).map_or(name, |index| keys::short_name(index).to_owned())
    };
    let si = |name: &str| {
        let row = rows.iter().find(|row| named(row) == name)?;
        row.get(3).map(ToString::to_string)
    };
    let units = args.units.apply(stored.study.display_units(), &si)?;
    for row in &mut rows {
        let Some(Value::Text(si)) = row.get(3) else { continue };
        let unit = units.of(&named(row), si);
        if unit.is_chosen() && !unit.symbol().is_empty() {
            row[2] = unit.value(&row[2]);
            row[3] = Value::Text(unit.symbol().to_owned());
        }
    }
    Ok(rows)
}

fn history_of(stored: &Stored<'_>, id: &JobId) -> Result<StoredHistory> {
    history_file::read(&stored.history_path(id)?)
}

/// The scene of a job: the stored one if the job has run, else the one that will run.
fn scene(stored: &Stored<'_>, id: &JobId) -> Result<serde_json::Value> {
    let is_stored = stored.record(id).is_some_and(|record| record.file_hash.is_some());
    let broken = |error: serde_json::Error| Error::Disk {
        path: stored.results.job_path(id),
        problem: format!("its scene is not valid JSON: {error}"),
    };
    match stored.point(id) {
        Some(point) if !is_stored && point.job.id == *id => {
            serde_json::to_value(&point.job.scene).map_err(broken)
        }
        _ => serde_json::from_str(&history_of(stored, id)?.scene).map_err(broken),
    }
}

/// One row per quantity: group, name, value, unit, meaning.
fn rows(stored: &Stored<'_>, id: &JobId) -> Vec<Vec<Value>> {
    let text = |text: &str| Value::Text(text.to_owned());
    let point = stored.point(id);
    let mut rows = vec![vec![text("job"), text("job"), text(id.as_str()), text("")]];
    for (name, value) in point.iter().flat_map(|point| &point.job.parameters) {
        let unit = text(stored.study.unit(name));
        let meaning = keys::find(name).map_or("", |index| KEYS[index].doc);
        rows.push(vec![text("parameters"), text(name), value.clone(), unit, text(meaning)]);
    }
    let cells = stored.cells_of_job(id);
    for group in ColumnGroup::ALL {
        let group_cells =
            cells.iter().filter(|(column, value)| column.group == group && **value != Value::Null);
        rows.extend(group_cells.map(|(column, value)| {
            let noisy = if column.id.is_noisy() { "noisy: " } else { "" };
            let (unit, meaning) = (text(column.unit), text(&format!("{noisy}{}", column.meaning)));
            vec![text(group.name()), text(column.name), value.clone(), unit, meaning]
        }));
    }
    let outcomes = rows.iter().rposition(|row| row[0] == text(ColumnGroup::Outcome.name()));
    let after = outcomes.map_or(rows.len(), |last| last + 1);
    rows.splice(after..after, limits::rows(stored, &cells));
    let about = remedies::lines(stored, id, &cells).into_iter();
    rows.extend(about.map(|(topic, about)| vec![text("remedies"), text(topic), text(&about)]));
    rows.extend(mesh_errors(stored, id));
    rows.extend(events(stored, id));
    // The row is shown even if its file cannot be read: the error is then one of the rows.
    match scene(stored, id) {
        Ok(scene) => rows.extend(summary::rows(&scene).into_iter().map(|mut pair| {
            let name = current_path(&pair[0].to_string());
            let key = KEYS.iter().find(|key| key.path == name);
            let meaning = key.map_or("", |key| key.doc);
            let value = pair.pop().unwrap_or(Value::Null);
            vec![text("scene"), text(&name), value, text(unit(&name)), text(meaning)]
        })),
        Err(error) => rows.push(vec![text("scene"), text("error"), text(&error.to_string())]),
    }
    rows
}

/// The decisions of the step controller; none for a job without a history.
fn events(stored: &Stored<'_>, id: &JobId) -> Vec<Vec<Value>> {
    let Ok(history) = history_of(stored, id) else { return Vec::new() };
    let text = |text: &str| Value::Text(text.to_owned());
    let row = |event: &Event| {
        let (name, meaning) = (event.kind.name(), event.kind.meaning());
        vec![text("events"), text(name), Value::Number(event.time), text("s"), text(meaning)]
    };
    history.events.iter().map(row).collect()
}

/// The mesh errors of a job's row, or why it has none.
fn mesh_errors(stored: &Stored<'_>, id: &JobId) -> Vec<Vec<Value>> {
    let Some(table) = stored.table_of(id) else { return Vec::new() };
    let is_shown = |name: &str| is_error_column(name) || name == NO_ERROR_REASON;
    let columns = table.columns.iter().filter(|column| is_shown(&column.name));
    columns
        .filter(|column| column.cells[0] != Value::Null)
        .map(|column| {
            let [name, unit, meaning] =
                [&column.name, &column.unit, &column.meaning].map(|text| Value::Text(text.clone()));
            let group = Value::Text(ColumnGroup::Measures.name().to_owned());
            vec![group, name, column.cells[0].clone(), unit, meaning]
        })
        .collect()
}

/// The path of a value in a stored scene as a file has it: with the current name of its key, and the
/// number of a list item in brackets.
fn current_path(stored: &str) -> String {
    let mut path = String::with_capacity(stored.len());
    for part in stored.split('.') {
        if !path.is_empty() && part.parse::<usize>().is_ok() {
            path.push('[');
            path.push_str(part);
            path.push(']');
        } else {
            path.push_str(if path.is_empty() { "" } else { "." });
            path.push_str(part);
        }
    }
    renamed::current(&path).unwrap_or(path)
}

/// SI unit of a number in a scene, given its dotted key; empty without a unit.
fn unit(key_path: &str) -> &'static str {
    let key = KEYS.iter().find(|key| key.path == key_path);
    match key.map(|key| key.kind) {
        Some(keys::KeyKind::Quantity(quantity)) => quantity.dimension.si(),
        _ => match key_path.rsplit('.').next().unwrap_or(key_path) {
            "from" | "to" | "release_time" | "end_time" | "sample_interval" => "s",
            "rate" | "mass_flow_rate" => "kg/s",
            "initial_mass" => "kg",
            "temperature" => "K",
            "gas_constant" | "cp" => "J/(kg K)",
            "gravity" => "m/s2",
            "coefficient" => "W/(m2 K)",
            _ => "",
        },
    }
}

fn print_history(
    stored: &StoredHistory,
    args: &Args,
    units: &DisplayUnits,
    out: &mut dyn Write,
) -> Result<()> {
    let format = args.output.format();
    let columns = stored.history.iter().map(|(column, values)| (column.name, values));
    let tracks = stored.tracks.iter().map(|(name, values)| (name.as_str(), values.as_slice()));
    let all: Vec<(&str, &[f64])> = columns.chain(tracks).collect();
    let all_names: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
    let every = args.every;
    if every == 0 {
        return Err(Error::invalid_option("--every", "0", "must be positive", "1 or more", ""));
    }
    let columns: Vec<(&str, &[f64])> = match args.columns.as_slice() {
        [] if format == Format::Table => {
            all.iter().filter(|(name, _)| DEFAULT_COLUMNS.contains(name)).copied().collect()
        }
        [] => all,
        [name] if name == "all" => all,
        names => names.iter().map(|name| find(&all, name.trim())).collect::<Result<_>>()?,
    };
    let samples = stored.history.len();
    let kept = (0..samples).filter(|sample| sample % every == 0 || sample + 1 == samples);
    let rows: Vec<Vec<Value>> = kept
        .map(|sample| {
            let value = |(_, values): &(&str, &[f64])| {
                values.get(sample).map_or(Value::Null, |value| Value::Number(*value))
            };
            columns.iter().map(value).collect()
        })
        .collect();
    let units = args.units.apply(units, &|name| {
        let known = all_names.contains(&name);
        known.then(|| si_of_column(name).to_owned())
    })?;
    let headings: Vec<Heading> = columns
        .iter()
        .map(|(name, _)| Heading {
            name: (*name).to_owned(),
            unit: units.of(name, si_of_column(name)),
        })
        .collect();
    print_quantities(&headings, &rows, format, out)?;
    if format == Format::Table && !args.quiet.quiet {
        eprintln!("{} of {samples} samples", rows.len());
    }
    Ok(())
}

/// SI unit of a column of a history; empty for a series whose unit is not stored.
fn si_of_column(name: &str) -> &'static str {
    COLUMNS.iter().find(|column| column.name == name).map_or("", |column| column.unit)
}

fn find<'a>(all: &[(&'a str, &'a [f64])], name: &str) -> Result<(&'a str, &'a [f64])> {
    let names = || all.iter().map(|(name, _)| *name);
    let current = current_name("--columns", name);
    all.iter().find(|(known, _)| *known == current).copied().ok_or_else(|| {
        let hint = did_you_mean(name, names());
        let allowed = names().collect::<Vec<_>>().join(", ");
        let problem = "no such column in this history";
        Error::invalid_option("--columns", name, problem, allowed, hint.unwrap_or_default())
    })
}
