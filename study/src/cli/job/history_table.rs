//! The history of a job: one row per sample.

use std::io::Write;

use super::{Args, Inspected, si_unit};
use crate::cli::Format;
use crate::input::value::Value;
use crate::job::row::CellType;
use crate::platform::error::{Error, Result};
use crate::platform::nearest::did_you_mean;
use crate::print::print_table;
use crate::store::table::{Column, Table};

/// Columns of a table by default.
const DEFAULT_COLUMNS: [&str; 9] = [
    "time",
    "z_rim",
    "height",
    "vz",
    "volume",
    "pressure",
    "temperature",
    "kinetic_energy",
    "ledger_residual",
];

/// A series of a history: its name and one number per sample.
type Series<'a> = (&'a str, &'a [f64]);

pub(super) fn print(
    job: &Inspected,
    args: &Args,
    format: Format,
    out: &mut dyn Write,
) -> Result<()> {
    let stored = job.history()?;
    let columns = stored.history.iter().map(|(column, values)| (column.name, values));
    let tracks = stored.tracks.iter().map(|(name, values)| (name.as_str(), values.as_slice()));
    let all: Vec<Series<'_>> = columns.chain(tracks).collect();
    let columns: Vec<Series<'_>> = match args.columns.as_slice() {
        [] if format == Format::Table => {
            all.iter().filter(|(name, _)| DEFAULT_COLUMNS.contains(name)).copied().collect()
        }
        [] => all,
        [name] if name == "all" => all,
        names => names.iter().map(|name| find(&all, name.trim())).collect::<Result<_>>()?,
    };
    let samples = stored.history.len();
    let every = args.every.map_or(1, |every| every as usize);
    let kept = (0..samples).filter(|sample| sample % every == 0 || sample + 1 == samples);
    let kept: Vec<usize> = kept.collect();
    let column = |(name, values): &Series<'_>| {
        let cell = |value: Option<&f64>| value.map_or(Value::Null, |value| Value::Number(*value));
        let cells = (0..samples).map(|sample| cell(values.get(sample)));
        let si = si_unit(&job.stored, name).unwrap_or_default();
        let shown = job.stored.units.of(name, &si);
        Column { unit: si, shown, ..Column::plain(name, CellType::Number, cells.collect()) }
    };
    let table = Table { columns: columns.iter().map(column).collect() };
    let all: Vec<&Column> = table.columns.iter().collect();
    print_table(&table, &all, &kept, format, out)?;
    if format == Format::Table && !args.quiet.quiet {
        eprintln!("{} of {samples} samples", kept.len());
    }
    Ok(())
}

fn find<'a>(all: &[Series<'a>], name: &str) -> Result<Series<'a>> {
    let names = || all.iter().map(|(name, _)| *name);
    all.iter().find(|(known, _)| *known == name).copied().ok_or_else(|| {
        let hint = did_you_mean(name, names());
        let allowed = names().collect::<Vec<_>>().join(", ");
        let problem = "no such column in this history";
        Error::invalid_option("--columns", name, problem, allowed, hint.unwrap_or_default())
    })
}
