//! `billow chart`: draws charts of the results of a study, as SVG and PNG.

use std::io::Write;
use std::path::PathBuf;

mod asked;
mod question;

use self::asked::{Asked, kind, of_outcome};
use self::question::Question;
use super::options::{OutputOptions, QuietOption, SetOption, UnitsOption};
use super::picture::{self, Picture, refused};
use super::print::print_rows;
use super::target::{self, StudyArgs, Target};
use super::{Format, best, output_error};
use crate::analysis::replicates::Condensed;
use crate::chart::map::Judged;
use crate::chart::runs::Replicated;
use crate::chart::standard::{self, ChartKind};
use crate::chart::{Source, borders, history, map, over};
use crate::input::keys::numerical::MESH_PARAMETER;
use crate::input::value::Value;
use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::files::{Disk, Files, disk_error};
use crate::store::history_file::StoredHistory;
use crate::store::results::Results;
use crate::store::table::Table;

/// Arguments of `billow chart`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Draw these columns of the histories over time, comma-separated: one line per job, one panel
    /// per column.
    #[arg(long, value_name = "COLUMNS", value_delimiter = ',', conflicts_with_all = ["measure"])]
    pub history: Vec<String>,
    /// Draw this column of the table, over a parameter (--over) or two (--map). In a map `safe` and
    /// `verdict` are the proportion of runs that are safe, or deployed.
    #[arg(long, value_name = "COLUMN", groups = ["with_over", "with_map"])]
    pub measure: Option<String>,
    /// Draw the map of outcomes: the proportion of safe runs (without limits: of deployed runs) over the
    /// two parameters that change it the most, or those of --map.
    #[arg(long, group = "with_map", conflicts_with_all = ["history", "measure", "borders"])]
    pub outcome: bool,
    /// Draw the borders that the search of the study found, over the first other parameter with numbers, or
    /// that of --over.
    #[arg(long, group = "with_over", conflicts_with_all = ["history", "measure", "outcome"])]
    pub borders: bool,
    /// Draw the measure, or the borders, over this parameter. Every other parameter that varies gives
    /// lines or panels; nothing is averaged but the runs of a point, of which the chart shows median and
    /// range.
    #[arg(long, value_name = "PARAMETER", requires = "with_over", conflicts_with = "map")]
    pub over: Option<String>,
    /// Draw one line per combination of these parameters, comma-separated; the other parameters
    /// that vary give panels [default: as many lines as are legible].
    #[arg(long, value_name = "PARAMETERS", value_delimiter = ',', requires = "over")]
    pub by: Vec<String>,
    /// Draw the measure, or the outcome, as a map over two parameters.
    #[arg(long, value_name = "X,Y", value_delimiter = ',', requires = "with_map")]
    pub map: Vec<String>,
    /// Draw each run; replicates are parameters as any other [default: median and range of the runs of a
    /// point].
    #[arg(long)]
    pub runs: bool,
    /// Only these jobs: first digits of their ids, comma-separated.
    #[arg(long, value_name = "IDS", value_delimiter = ',')]
    pub jobs: Vec<String>,
    /// Only rows for which this condition holds, as in `N == 6 and mass_flow_rate >= '2 g/s'`.
    #[arg(long = "where", value_name = "CONDITION", conflicts_with = "jobs")]
    pub condition: Option<String>,
    /// Title of the chart [default: quantity and axes].
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// Start of the time axis: s, or with a unit.
    #[arg(long, value_name = "TIME", requires = "history")]
    pub from: Option<String>,
    /// End of the time axis: s, or with a unit [default: soon after the last film has settled].
    #[arg(long, value_name = "TIME", requires = "history")]
    pub to: Option<String>,
    /// File to write, .svg or .png [default: both, in the folder charts of the results].
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Runs `billow chart`: prints the paths of the pictures.
///
/// # Errors
/// Results that cannot be read; an unknown column or parameter; a picture that cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let asked = kind(args)?;
    let range = [time("--from", args.from.as_deref())?, time("--to", args.to.as_deref())?];
    if let Some(path) = &args.out {
        Picture::of(path)?;
    }
    let mut target = target::open(&args.study, &args.set.set, &args.units)?;
    target.add_keys(&[], args.condition.as_deref())?;
    let Target { results, study, table, records, .. } = target;
    let name = study_name(&results);
    let question = Question::read(&results, study.as_ref())?;
    let single = Source {
        limits: &question.limits,
        search: question.search(),
        ..source(args, &name, &table)?
    };
    let replicates = question.replicates(args, asked.as_ref());
    let is_mesh = |name: &String| name == MESH_PARAMETER;
    let meshes = if replicates.iter().any(is_mesh) { question.meshes.clone() } else { Vec::new() };
    let condensed =
        (!replicates.is_empty()).then(|| Condensed::of(single.table, &single.rows, &replicates));
    let source = condensed.as_ref().map_or_else(
        || single.clone(),
        |condensed| Source {
            table: &condensed.table,
            rows: (0..condensed.table.rows()).collect(),
            runs: Some(Replicated {
                condensed,
                single: &table,
                names: &replicates,
                meshes: &meshes,
            }),
            ..single.clone()
        },
    );
    let standard = asked.is_none();
    let chosen_axes = matches!(&asked, Some(Asked::Outcome(axes)) if axes.is_empty());
    let kinds = match asked {
        Some(Asked::One(kind)) => vec![kind],
        Some(Asked::Outcome(axes)) => vec![outcome(&source, axes)?],
        None => standard_kinds(&source, args.quiet.quiet),
    };
    let read = |id: &JobId| results.read_history(id, records.get(id));
    let mut written: Vec<PathBuf> = Vec::new();
    for kind in &kinds {
        match draw(&source, kind, range, &read) {
            Ok(svg) => written.extend(write(args, &results, kind, &svg)?),
            // A standard chart may not fit this study; then it shows fewer points, or is skipped, with a
            // message.
            Err(Error::Input(error)) if standard => {
                let note = |text: String| {
                    if !args.quiet.quiet {
                        eprintln!("billow: {text}");
                    }
                };
                let fewer =
                    if question.is_asked() { standard::reduced(&source, kind) } else { None };
                let drawn = fewer.as_ref().map(|fewer| draw(&source, fewer, range, &read));
                if let (Some(Ok(svg)), Some(ChartKind::At(_, _, choice))) = (&drawn, &fewer) {
                    note(format!("{} {choice}: {}", kind.file_name(), error.problem));
                    written.extend(write(args, &results, kind, svg)?);
                } else {
                    note(format!("no {}: {}", kind.file_name(), error.problem));
                }
            }
            Err(error) if chosen_axes => return Err(of_outcome(error)),
            Err(error) => return Err(error),
        }
    }
    print(&written, args.output.format(), out)?;
    if !args.quiet.quiet && args.output.format() == Format::Table {
        best::print(study.as_ref(), &table, &single.rows);
    }
    Ok(())
}

/// The map of outcomes.
fn outcome(source: &Source<'_>, axes: Vec<String>) -> Result<ChartKind> {
    let given = <[String; 2]>::try_from(axes).ok();
    let axes = given.or_else(|| standard::outcome_axes(source)).ok_or_else(|| {
        let problem = "a map needs two parameters that vary";
        refused("--outcome", "", problem, "a study that varies two, without its replicates")
    })?;
    Ok(ChartKind::Map(Judged::of(source).name().to_owned(), axes))
}

/// The rows that `--jobs` or `--where` choose.
fn source<'a>(args: &Args, study: &'a str, table: &'a Table) -> Result<Source<'a>> {
    let rows = if args.jobs.is_empty() {
        target::filtered(table, args.condition.as_deref())?
    } else {
        target::jobs(table, &args.jobs)?
    };
    if rows.is_empty() {
        let condition = args.condition.as_deref().unwrap_or("");
        let allowed = "a condition that at least one row fulfils; a number without a unit is SI, a \
                       unit is written as in mass_flow_rate == '5 g/s'";
        return Err(refused("--where", condition, "no row fulfils this condition", allowed));
    }
    let choice = match (&args.condition, args.jobs.len()) {
        (Some(condition), _) => format!("where {}", condition.trim()),
        (None, 0) => String::new(),
        (None, _) => "(chosen jobs)".to_owned(),
    };
    let title = args.title.clone().unwrap_or_default();
    Ok(Source { study, table, rows, choice, title, limits: &[], runs: None, search: None })
}

/// Name of the results folder; the whole path when it has no last part, as in ".".
fn study_name(results: &Results<'_>) -> String {
    let root = results.root();
    root.file_name()
        .map_or_else(|| root.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// The standard charts; a message on stderr says what is missing and why.
fn standard_kinds(source: &Source<'_>, quiet: bool) -> Vec<ChartKind> {
    let (kinds, notes) = standard::kinds(source);
    for note in notes.iter().filter(|_| !quiet) {
        eprintln!("note: {note}");
    }
    kinds
}

/// Writes a chart to the file asked for, or in every format to the folder of charts. Returns the paths.
fn write(args: &Args, results: &Results<'_>, kind: &ChartKind, svg: &str) -> Result<Vec<PathBuf>> {
    if let Some(path) = &args.out {
        picture::write(path, svg)?;
        return Ok(vec![path.clone()]);
    }
    let folder = results.charts_path();
    Disk.create_folder(&folder).map_err(|error| disk_error(&folder, &error))?;
    let path =
        |format: Picture| folder.join(format!("{}.{}", kind.file_name(), format.extension()));
    let paths = Picture::ALL.map(path).to_vec();
    for path in &paths {
        picture::write(path, svg)?;
    }
    Ok(paths)
}

fn draw(
    source: &Source<'_>,
    kind: &ChartKind,
    range: [Option<f64>; 2],
    read: &dyn Fn(&JobId) -> Result<StoredHistory>,
) -> Result<String> {
    match kind {
        ChartKind::History(columns) => history::svg(source, columns, range, read),
        ChartKind::Over(measure, parameter, by) => over::svg(source, measure, parameter, by),
        ChartKind::Map(measure, [x, y]) => map::svg(source, measure, [x, y]),
        ChartKind::Borders(over, by) => borders::svg(source, over.as_deref(), by),
        ChartKind::At(kind, rows, _) => {
            let choice = [source.choice.as_str(), "at middle values"].join(" ").trim().to_owned();
            draw(&Source { rows: rows.clone(), choice, ..source.clone() }, kind, range, read)
        }
    }
}

/// A time on the command line, s.
fn time(option: &str, text: Option<&str>) -> Result<Option<f64>> {
    text.map(|text| picture::seconds(option, text)).transpose()
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
