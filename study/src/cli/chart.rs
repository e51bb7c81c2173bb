//! `billow chart`: draws charts of a study's results, as SVG and PNG.

use std::io::Write;
use std::path::PathBuf;

use super::picture::{self, Picture, refused};
use super::print::print_rows;
use super::target::{self, Target};
use super::{Format, Global, output_error};
use crate::chart::standard::{self, Kind};
use crate::chart::{Source, history, map, over};
use crate::input::value::Value;
use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::files::{Disk, Files, disk_error};
use crate::store::history_file::{self, StoredHistory};

/// Arguments of `billow chart`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Study file, or folder of its results [default: the only one under results].
    pub study: Option<PathBuf>,
    /// Draw these columns of histories over time, comma-separated: one line a job, one panel a
    /// column.
    #[arg(long, value_name = "COLUMNS", value_delimiter = ',', conflicts_with_all = ["measure"])]
    pub history: Vec<String>,
    /// Draw this column of the table, over a parameter (--over) or two (--map).
    #[arg(long, value_name = "COLUMN")]
    pub measure: Option<String>,
    /// The parameter a measure is drawn over; every other one that varies tells lines or panels
    /// apart, nothing is averaged.
    #[arg(long, value_name = "PARAMETER", requires = "measure", conflicts_with = "map")]
    pub over: Option<String>,
    /// The parameters that tell lines apart, comma-separated; the others that vary tell panels
    /// apart [default: as many lines as are legible].
    #[arg(long, value_name = "PARAMETERS", value_delimiter = ',', requires = "over")]
    pub by: Vec<String>,
    /// Draw a measure as a map over two parameters.
    #[arg(long, value_name = "X,Y", value_delimiter = ',', requires = "measure")]
    pub map: Vec<String>,
    /// Only these jobs: ids or beginnings of ids, comma-separated.
    #[arg(long, value_name = "IDS", value_delimiter = ',')]
    pub jobs: Vec<String>,
    /// Only rows of which this holds, as in `N == 6 and mass_flow_rate >= '2 g/s'`.
    #[arg(long = "where", value_name = "CONDITION", conflicts_with = "jobs")]
    pub condition: Option<String>,
    /// Histories from this time on: s, or with a unit.
    #[arg(long, value_name = "TIME", requires = "history")]
    pub from: Option<String>,
    /// Histories up to this time: s, or with a unit.
    #[arg(long, value_name = "TIME", requires = "history")]
    pub to: Option<String>,
    /// File to write, .svg or .png [default: both, into the folder charts of the results].
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// Runs `billow chart`: prints the paths of what it drew.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let asked = kind(args)?;
    let range = [time("--from", args.from.as_deref())?, time("--to", args.to.as_deref())?];
    if let Some(path) = &args.out {
        Picture::of(path)?;
    }
    let Target { results, table } = target::open(args.study.as_deref(), global)?;
    let rows = if args.jobs.is_empty() {
        target::filtered(&table, args.condition.as_deref())?
    } else {
        target::jobs(&table, &args.jobs)?
    };
    if rows.is_empty() {
        let condition = args.condition.as_deref().unwrap_or("");
        return Err(refused(
            "--where",
            condition,
            "holds of no row",
            "a condition that holds of a row; numbers are SI unless they carry a unit, as in \
             mass_flow_rate == '5 g/s'",
        ));
    }
    let choice = match (&args.condition, args.jobs.len()) {
        (Some(condition), _) => format!("where {}", condition.trim()),
        (None, 0) => String::new(),
        (None, _) => "(chosen jobs)".to_owned(),
    };
    let root = results.root();
    // "." has no name of its own.
    let name = root
        .file_name()
        .map_or_else(|| root.display().to_string(), |name| name.to_string_lossy().into_owned());
    let source = Source { study: &name, table: &table, rows, choice };
    let asked_for = asked.is_some();
    let kinds = if let Some(kind) = asked { vec![kind] } else { standard_kinds(&source, global) };
    let read = |id: &JobId| history_file::read(&results.job_path(id));
    let mut written: Vec<PathBuf> = Vec::new();
    for kind in &kinds {
        let svg = match draw(&source, kind, range, &read) {
            Ok(svg) => svg,
            // What nobody asked for by name may not fit this study.
            Err(Error::Input(error)) if !asked_for => {
                if !global.quiet {
                    eprintln!("billow: no {}: {}", kind.file_name(), error.problem);
                }
                continue;
            }
            Err(error) => return Err(error),
        };
        if let Some(path) = &args.out {
            picture::write(path, &svg)?;
            written.push(path.clone());
        } else {
            let folder = results.charts_path();
            Disk.create_folder(&folder).map_err(|error| disk_error(&folder, &error))?;
            for format in Picture::ALL {
                let path = folder.join(format!("{}.{}", kind.file_name(), format.ending()));
                picture::write(&path, &svg)?;
                written.push(path);
            }
        }
    }
    print(&written, global.format(), out)
}

/// The charts drawn where none is asked for; what is left out is told.
fn standard_kinds(source: &Source<'_>, global: &Global) -> Vec<Kind> {
    let (kinds, notes) = standard::kinds(source);
    for note in notes.iter().filter(|_| !global.quiet) {
        eprintln!("billow: {note}");
    }
    kinds
}

fn draw(
    source: &Source<'_>,
    kind: &Kind,
    range: [Option<f64>; 2],
    read: &dyn Fn(&JobId) -> Result<StoredHistory>,
) -> Result<String> {
    match kind {
        Kind::History(columns) => history::svg(source, columns, range, read),
        Kind::Over(measure, parameter, by) => over::svg(source, measure, parameter, by),
        Kind::Map(measure, [x, y]) => map::svg(source, measure, [x, y]),
    }
}

/// The chart asked for, if one is.
fn kind(args: &Args) -> Result<Option<Kind>> {
    if !args.history.is_empty() {
        let columns = args
            .history
            .iter()
            .map(|name| target::current_name("--history", name.trim()).to_owned());
        return Ok(Some(Kind::History(columns.collect())));
    }
    let measure = args
        .measure
        .as_deref()
        .map(|name| target::current_name("--measure", name.trim()).to_owned());
    let Some(measure) = measure else {
        return match &args.out {
            None => Ok(None),
            Some(path) => Err(refused(
                "--out",
                &path.display().to_string(),
                "one file for several charts",
                "say which: --history, --measure … --over, or --measure … --map",
            )),
        };
    };
    match (args.over.clone(), args.map.as_slice()) {
        (Some(over), _) => {
            let by = args.by.iter().map(|name| name.trim().to_owned()).collect();
            Ok(Some(Kind::Over(measure, over, by)))
        }
        (None, [x, y]) => Ok(Some(Kind::Map(measure, [x, y].map(|name| name.trim().to_owned())))),
        (None, []) => Err(refused(
            "--measure",
            &measure,
            "does not say over what",
            "--over PARAMETER, or --map X,Y",
        )),
        (None, several) => {
            Err(refused("--map", &several.join(","), "not two parameters", "--map X,Y"))
        }
    }
}

/// A time given on the command line, s.
fn time(flag: &str, text: Option<&str>) -> Result<Option<f64>> {
    text.map(|text| picture::seconds(flag, text)).transpose()
}

fn print(paths: &[PathBuf], format: Format, out: &mut dyn Write) -> Result<()> {
    let texts = paths.iter().map(|path| path.display().to_string());
    if format == Format::Table {
        for text in texts {
            writeln!(out, "{text}").map_err(output_error)?;
        }
        return Ok(());
    }
    let rows: Vec<Vec<Value>> = texts.map(|text| vec![Value::Text(text)]).collect();
    print_rows(&["file"], &rows, format, out)
}
