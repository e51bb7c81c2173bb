//! `billow show`: everything stored of one job.

use std::io::Write;
use std::path::PathBuf;

use billow_solver::output::history::COLUMNS;

use super::print::print_rows;
use super::target::{current_name, folder_of_job};
use super::{Format, Global, output_error};
use crate::input::keys::{self, KEYS};
use crate::input::value::Value;
use crate::job::row::{Cells, ColumnGroup};
use crate::job::{JobId, Status};
use crate::platform::error::{Error, InputError, Result};
use crate::platform::files::Disk;
use crate::scene::summary;
use crate::store::history_file::{self, StoredHistory};
use crate::store::results::Results;
use crate::store::stored::Stored;

/// Columns of a history shown where nobody names any, on a terminal.
const SHOWN: [&str; 8] = [
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
    /// Study file, or folder of its results [default: the only one under results].
    pub study: Option<PathBuf>,
    /// The scene it was computed from alone, JSON.
    #[arg(long, conflicts_with_all = ["history", "columns", "every"])]
    pub scene: bool,
    /// Its history: one row a sample.
    #[arg(long)]
    pub history: bool,
    /// Columns of the history, comma-separated, or "all" [default: the main ones; all for csv and
    /// json].
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "history")]
    pub columns: Vec<String>,
    /// Every N-th sample of the history, and the last one [default: 1].
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1,
        requires = "history",
        hide_default_value = true
    )]
    pub every: usize,
}

/// Runs `billow show`.
///
/// # Errors
/// A job that is not there; a history or results that cannot be read.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let root = folder_of_job(&args.job, args.study.as_deref(), global)?;
    let stored = Stored::read(Results::new(&Disk, &root))?;
    let id = stored.job(&args.job)?;
    if args.scene {
        let scene = scene(&stored, &id)?;
        return writeln!(out, "{scene:#}").map_err(output_error);
    }
    if args.history {
        let history = history_of(&stored, &id)?;
        return print_history(&history, args, global, out);
    }
    let rows = rows(&stored, &id);
    print_rows(&["group", "name", "value", "unit", "meaning"], &rows, global.format(), out)
}

fn history_of(stored: &Stored<'_>, id: &JobId) -> Result<StoredHistory> {
    history_file::read(&stored.history_path(id)?)
}

/// The scene a job was, or will be, computed from: the stored one where there is one.
fn scene(stored: &Stored<'_>, id: &JobId) -> Result<serde_json::Value> {
    let left = stored.record(id).is_some_and(|record| record.file_hash.is_some());
    let broken = |error: serde_json::Error| Error::Disk {
        path: stored.results.job_path(id),
        problem: format!("its scene is no JSON: {error}"),
    };
    match stored.point(id) {
        Some(point) if !left => serde_json::to_value(&point.job.scene).map_err(broken),
        _ => serde_json::from_str(&history_of(stored, id)?.scene).map_err(broken),
    }
}

/// One row a quantity: group, name, value, unit, meaning.
fn rows(stored: &Stored<'_>, id: &JobId) -> Vec<Vec<Value>> {
    let text = |text: &str| Value::Text(text.to_owned());
    let point = stored.point(id);
    let mut rows = vec![vec![text("job"), text("job"), text(id.as_str()), text("")]];
    for (name, value) in point.iter().flat_map(|point| &point.job.parameters) {
        let unit = text(stored.study.unit(name));
        let meaning = keys::find(name).map_or("", |at| KEYS[at].doc);
        rows.push(vec![text("parameters"), text(name), value.clone(), unit, text(meaning)]);
    }
    let recorded = stored.record(id).map(|record| record.cells.clone());
    let cells = match point {
        Some(point) => stored.cells(point),
        None => recorded.unwrap_or_else(|| Cells::new(Status::Pending)),
    };
    for wanted in ColumnGroup::ALL {
        let own =
            cells.iter().filter(|(column, value)| column.group == wanted && **value != Value::Null);
        rows.extend(own.map(|(column, value)| {
            let (unit, meaning) = (text(column.unit), text(column.meaning));
            vec![text(wanted.name()), text(column.name), value.clone(), unit, meaning]
        }));
    }
    // A row without its file is still worth showing: the error is one of its rows.
    match scene(stored, id) {
        Ok(scene) => rows.extend(summary::rows(&scene).into_iter().map(|mut pair| {
            let name = pair[0].to_string();
            let key = KEYS.iter().find(|key| key.path == name);
            let meaning = key.map_or("", |key| key.doc);
            let value = pair.pop().unwrap_or(Value::Null);
            vec![text("scene"), text(&name), value, text(unit(&name)), text(meaning)]
        })),
        Err(error) => rows.push(vec![text("scene"), text("error"), text(&error.to_string())]),
    }
    rows
}

/// SI unit of a scene's number, by its place in it; empty where the scene's words are its own.
fn unit(path: &str) -> &'static str {
    let key = KEYS.iter().find(|key| key.path == path);
    match key.map(|key| key.kind) {
        Some(keys::KeyKind::Quantity(quantity)) => quantity.dimension.si(),
        _ => match path.rsplit('.').next().unwrap_or(path) {
            "from" | "to" | "release_time" | "end_time" | "sample_interval" => "s",
            "rate" => "kg/s",
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
    global: &Global,
    out: &mut dyn Write,
) -> Result<()> {
    let format = global.format();
    let own = stored.history.iter().map(|(column, values)| (column.name, values));
    let tracks = stored.tracks.iter().map(|(name, values)| (name.as_str(), values.as_slice()));
    let all: Vec<(&str, &[f64])> = own.chain(tracks).collect();
    let every = args.every;
    if every == 0 {
        return Err(refused("--every", "0", "no sample would be shown", "1 or more", ""));
    }
    let columns: Vec<(&str, &[f64])> = match args.columns.as_slice() {
        [] if format == Format::Table => {
            all.iter().filter(|(name, _)| SHOWN.contains(name)).copied().collect()
        }
        [] => all,
        [one] if one == "all" => all,
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
    let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    print_rows(&names, &rows, format, out)?;
    if format == Format::Table && !global.quiet {
        let units: Vec<String> = COLUMNS
            .iter()
            .filter(|column| names.contains(&column.name) && column.unit != "1")
            .map(|column| format!("{} {}", column.name, column.unit))
            .collect();
        eprintln!("units: {}; {} of {samples} samples", units.join(", "), rows.len());
    }
    Ok(())
}

fn find<'a>(all: &[(&'a str, &'a [f64])], name: &str) -> Result<(&'a str, &'a [f64])> {
    let names = || all.iter().map(|(name, _)| *name);
    let current = current_name("--columns", name);
    all.iter().find(|(own, _)| *own == current).copied().ok_or_else(|| {
        let hint = keys::nearest(name, names()).map(|near| format!("did you mean {near}?"));
        let allowed = names().collect::<Vec<_>>().join(", ");
        let problem = "no such column in this history";
        refused("--columns", name, problem, &allowed, &hint.unwrap_or_default())
    })
}

fn refused(flag: &str, value: &str, problem: &str, allowed: &str, hint: &str) -> Error {
    InputError {
        file: flag.to_owned(),
        key: String::new(),
        value: value.to_owned(),
        problem: problem.to_owned(),
        allowed: allowed.to_owned(),
        hint: hint.to_owned(),
    }
    .into()
}
