//! `billow chart`: draws charts of the results of a study, as SVG and PNG.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::options::{OutputOptions, QuietOption, SetOption, UnitsOption, parameter_name};
use super::picture::{self, Picture, refused};
use super::results::{self, StudyArgs};
use super::{Format, output_error};
use crate::analysis::answer::Answer;
use crate::analysis::replicates::Condensed;
use crate::chart::Source;
use crate::chart::borders::Searched;
use crate::chart::kinds::{self, ChartKind};
use crate::chart::runs::Replicated;
use crate::input::keys::numerical::MESH_PARAMETER;
use crate::input::value::Value;
use crate::job::JobId;
use crate::platform::error::{Error, Result};
use crate::platform::files::{Disk, Files, disk_error};
use crate::print::print_rows;
use crate::store::results::Results;
use crate::store::stored::Stored;
use crate::store::table::{Table, select};
use crate::study::{Meshes, Study};

pub mod work_precision;

/// Arguments of `billow chart`.
#[derive(Debug, Default, clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Draw these columns of the histories over time, comma-separated: one line per job, one panel
    /// per column.
    #[arg(long, value_name = "COLUMNS", value_delimiter = ',', conflicts_with_all = ["measure"])]
    history: Vec<String>,
    /// Draw this column of the table, over a parameter (--over) or two (--map), or alone: which input makes its spread, of
    /// samples and grids; how the search of an optimum went on; or as a tornado how much each factor changes it, of points
    /// that vary one factor at a time. `safe` and `verdict` are the
    /// proportion of runs that are safe, or deployed, as a map; without --map over the first two parameters that
    /// vary.
    #[arg(long, value_name = "COLUMN", groups = ["with_over", "with_map"])]
    measure: Option<String>,
    /// Draw the borders that the search of the study found, over the first other parameter with numbers, or
    /// that of --over.
    #[arg(long, group = "with_over", conflicts_with_all = ["history", "measure"])]
    borders: bool,
    /// Draw work-precision diagrams, what each model, mesh and step costs and how large its error is, and print
    /// the configurations on the front; in CSV and JSON every configuration.
    #[arg(long, conflicts_with_all = ["history", "measure", "borders", "runs", "jobs", "condition", "title", "out"])]
    work_precision: bool,
    /// The cost of work-precision diagrams: element-steps, or seconds of this machine [default: work].
    #[arg(long, value_enum, requires = "work_precision")]
    cost: Option<work_precision::CostName>,
    /// Draw the measure, or the borders, over this parameter. Every other parameter that varies gives
    /// lines or panels; nothing is averaged but the runs of a point, of which the chart shows median and
    /// range.
    #[arg(
        long,
        value_name = "PARAMETER",
        requires = "with_over",
        conflicts_with = "map",
        value_parser = parameter_name
    )]
    over: Option<String>,
    /// Draw one line per combination of these parameters, one or two, comma-separated; the others that vary give
    /// panels [default: as many lines as are legible].
    #[arg(
        long,
        value_name = "PARAMETERS",
        value_delimiter = ',',
        requires = "over",
        value_parser = parameter_name
    )]
    by: Vec<String>,
    /// Draw the measure as a map over two parameters.
    #[arg(
        long,
        value_name = "X,Y",
        value_delimiter = ',',
        requires = "with_map",
        value_parser = parameter_name
    )]
    map: Vec<String>,
    /// Draw each run; replicates are parameters as any other [default: median and range of the runs of a
    /// point].
    #[arg(long)]
    runs: bool,
    /// Only these jobs: first digits of their ids, comma-separated.
    #[arg(long, value_name = "IDS", value_delimiter = ',')]
    jobs: Vec<String>,
    /// Only rows for which this condition holds, as in `N == 6 and mass_flow_rate >= '2 g/s'`.
    #[arg(long = "where", value_name = "CONDITION", conflicts_with = "jobs")]
    condition: Option<String>,
    /// Title of the chart [default: quantity and axes].
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// Start of the time axis: s, or with a unit.
    #[arg(long, value_name = "TIME", requires = "history")]
    from: Option<String>,
    /// End of the time axis: s, or with a unit [default: soon after the last film has settled].
    #[arg(long, value_name = "TIME", requires = "history")]
    to: Option<String>,
    /// File to write, .svg or .png, or folder for both [default: the folder charts of the results].
    #[arg(long, value_name = "FILE|DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

impl Args {
    fn note(&self, text: &str) {
        if !self.quiet.quiet {
            eprintln!("note: {text}");
        }
    }

    /// Whether a chart needs the answer: those that fit the study, and a measure alone.
    fn asks_answer(&self) -> bool {
        !self.is_one() || (self.measure.is_some() && self.over.is_none() && self.map.is_empty())
    }

    /// Whether the options ask for one chart.
    fn is_one(&self) -> bool {
        !self.history.is_empty() || self.measure.is_some() || self.borders
    }

    /// The one chart that the options ask for.
    fn kind(&self, source: &Source<'_>) -> Result<ChartKind> {
        let by = self.by.clone();
        if !self.history.is_empty() {
            let names = self.history.iter().map(|name| name.trim().to_owned());
            return Ok(ChartKind::History(names.collect()));
        }
        let Some(measure) = self.measure.as_ref().map(|name| name.trim().to_owned()) else {
            return Ok(ChartKind::Borders(self.over.clone(), by));
        };
        if let Some(over) = &self.over {
            return Ok(ChartKind::Over(measure, over.clone(), by));
        }
        let axes = match self.map.clone() {
            none if none.is_empty() => None,
            axes => Some(<[String; 2]>::try_from(axes).map_err(|axes| {
                refused("--map", &axes.join(","), "not two parameters", "--map X,Y")
            })?),
        };
        ChartKind::map(source, measure, axes)
    }

    /// The parameters whose runs a chart condenses: the replicates of the study that it does not name. Chosen jobs and
    /// `--runs` are drawn one by one.
    fn condensed(&self, study: &Study) -> Vec<String> {
        if self.runs || !self.jobs.is_empty() {
            return Vec::new();
        }
        let named = [&self.by[..], &self.map, self.over.as_slice()].concat();
        study.replicates().into_iter().filter(|name| !named.contains(name)).collect()
    }
}

/// Runs `billow chart`: prints the paths of the pictures.
///
/// # Errors
/// Results that cannot be read; an unknown column or parameter; a picture that cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    if let Some(file) = args.history.iter().find(|name| name.contains(".h5")) {
        let problem = "is a file, not a column of a history";
        let allowed = "columns, as in z_rim,pressure, of a study";
        let next = "billow frames FILE draws the shapes of a history file; docs/guide/results.md reads its columns";
        return Err(Error::invalid_option("--history", file, problem, allowed, next));
    }
    let range = [time("--from", args.from.as_deref())?, time("--to", args.to.as_deref())?];
    let out_file = args.out.as_deref().filter(|path| path.extension().is_some() && !path.is_dir());
    if let Some(path) = out_file {
        Picture::of(path)?;
    }
    if !args.is_one() {
        let one = "one chart: --history, --measure or --borders";
        if let Some(path) = out_file {
            let path = path.display().to_string();
            let allowed = format!("{one}; or a folder");
            return Err(refused("--out", &path, "one file for several charts", &allowed));
        }
        if let Some(title) = &args.title {
            return Err(refused("--title", title, "one title for several charts", one));
        }
    }
    let mut opened = results::open(&args.study, &args.set.set, &args.units, None)?;
    if args.work_precision {
        let cost = args.cost.unwrap_or_default();
        return work_precision::run(&opened, cost, args.output.format(), out);
    }
    opened.add_keys(&[], args.condition.as_deref());
    let mut written: Vec<PathBuf> = Vec::new();
    draw(args, (&opened.stored, &opened.table, None), range, &|_| true, &mut |kind, svg| {
        if let Some(path) = out_file {
            picture::write(path, &svg)?;
            written.push(path.to_owned());
        } else {
            let folder = args.out.clone().unwrap_or_else(|| opened.stored.results.charts_path());
            written.extend(write(&folder, &kind.file_name(), &svg)?);
        }
        Ok(())
    })?;
    print(&written, args.output.format(), out)
}

/// The charts of a study that no options choose, but for histories: each with its name and SVG.
///
/// # Errors
/// Those of the charts.
pub(super) fn of_answer(
    (stored, table, answer): (&Stored<'_>, &Table, &Answer),
) -> Result<Vec<(String, String)>> {
    let mut charts = Vec::new();
    let args = Args { quiet: QuietOption { quiet: true }, ..Args::default() };
    let is_drawn = |kind: &ChartKind| !matches!(kind, ChartKind::History(_));
    draw(&args, (stored, table, Some(answer)), [None; 2], &is_drawn, &mut |kind, svg| {
        charts.push((kind.file_name(), svg));
        Ok(())
    })?;
    Ok(charts)
}

/// Draws the charts that the options choose and that `is_drawn` lets through, with this range of time, and gives each to
/// `each`.
fn draw(
    args: &Args,
    (stored, table, answer): (&Stored<'_>, &Table, Option<&Answer>),
    range: [Option<f64>; 2],
    is_drawn: &dyn Fn(&ChartKind) -> bool,
    each: &mut dyn FnMut(&ChartKind, String) -> Result<()>,
) -> Result<()> {
    let (results, study) = (&stored.results, &stored.study);
    let (name, replicates) = (study_name(results), args.condensed(study));
    let (searched, all_replicates) = (study.searched(), study.replicates());
    let borders = if searched.is_some() { stored.borders() } else { Vec::new() };
    let criterion = searched.map(|(_, on)| on.text(study.result_limits())).unwrap_or_default();
    let search = searched.map(|(parameter, _)| Searched {
        parameter,
        criterion: &criterion,
        replicates: &all_replicates,
        replicate_count: study.replicate_count(),
        borders: &borders,
    });
    let limits = study.result_limits();
    let computed;
    let answer = match answer {
        None if study.asks_beyond_rows() && args.asks_answer() => {
            computed = Answer::of(stored, table);
            Some(&computed)
        }
        other => other,
    };
    let single = Source { limits, search, answer, ..source(args, &name, table)? };
    let is_mesh = |name: &String| name == MESH_PARAMETER;
    let meshes = if replicates.iter().any(is_mesh) { study.meshes() } else { Meshes::default() };
    let condensed =
        (!replicates.is_empty()).then(|| Condensed::of(single.table, &single.rows, &replicates));
    let source = condensed.as_ref().map_or_else(
        || single.clone(),
        |condensed| Source {
            table: &condensed.table,
            rows: (0..condensed.table.rows()).collect(),
            runs: Some(Replicated {
                condensed,
                single: table,
                names: &replicates,
                meshes: &meshes,
            }),
            ..single.clone()
        },
    );
    let charts = if args.is_one() {
        vec![(args.kind(&source)?, source)]
    } else {
        let (charts, notes) = kinds::standard(&source);
        for note in &notes {
            args.note(note);
        }
        charts
    };
    let read = |id: &JobId| results.read_history(id, stored.record(id));
    for (kind, source) in charts.iter().filter(|(kind, _)| is_drawn(kind)) {
        let svg = match kind.svg(source, range, &read) {
            // A standard chart may not fit this study; then it shows fewer points, or is skipped.
            Err(Error::Input(error)) if !args.is_one() => {
                let fewer = kind.reduced(source);
                let drawn = fewer.as_ref().and_then(|fewer| kind.svg(fewer, range, &read).ok());
                let choice = fewer.filter(|_| drawn.is_some()).map(|fewer| fewer.choice);
                let place = choice.map_or_else(
                    || format!("no {}", kind.file_name()),
                    |choice| format!("{} {choice}", kind.file_name()),
                );
                args.note(&format!("{place}: {}", error.problem));
                match drawn {
                    Some(svg) => svg,
                    None => continue,
                }
            }
            svg => svg?,
        };
        each(kind, svg)?;
    }
    Ok(())
}

/// The rows that `--jobs` or `--where` choose.
fn source<'a>(args: &Args, study: &'a str, table: &'a Table) -> Result<Source<'a>> {
    let rows = if args.jobs.is_empty() {
        select::filtered(table, args.condition.as_deref())?
    } else {
        select::jobs(table, &args.jobs)?
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
    Ok(Source {
        study,
        table,
        rows,
        choice,
        title,
        limits: &[],
        runs: None,
        search: None,
        answer: None,
    })
}

/// Name of the results folder; the whole path when it has no last part, as in ".".
fn study_name(results: &Results<'_>) -> String {
    let root = results.root();
    root.file_name()
        .map_or_else(|| root.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// Writes a chart in every format to the folder of charts. Returns the paths.
fn write(folder: &Path, name: &str, svg: &str) -> Result<Vec<PathBuf>> {
    Disk.create_folder(folder).map_err(|error| disk_error(folder, &error))?;
    let paths = Picture::ALL.map(|format| folder.join(format!("{name}.{}", format.extension())));
    for path in &paths {
        picture::write(path, svg)?;
    }
    Ok(paths.to_vec())
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
