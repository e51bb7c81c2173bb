//! `billow plan`: lists the jobs of a study.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;

mod advice;
mod forecast;
mod lengths;
mod results;

use forecast::forecast;

use super::changes;
use super::memory::Memory;
use super::options::{
    OutputOptions, QuietOption, ResultsOption, SetOption, ThreadsOption, UnitsOption,
};
use super::results::results_folder;
use crate::analysis::replicates::{fixed, point_key};
use crate::input::units::DisplayUnit;
use crate::input::value::Value;
use crate::job::Parameters;
use crate::job::point::Point;
use crate::job::row::CellType;
use crate::platform::error::Result;
use crate::platform::files::Disk;
use crate::print::{self, Format, notes, output_error, print_table, wrapped};
use crate::store::results::Results;
use crate::store::stored::other_physics;
use crate::store::table::{Column, Table};
use crate::study::Study;
use crate::study::assumptions::assumptions;
use crate::study::plan::{Generation, PlanCounts, next_jobs};

/// What stands before assumptions.
const ASSUMED: &str = "assumed: ";

/// Arguments of `billow plan`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Study file.
    #[arg(value_name = "STUDY")]
    pub study: PathBuf,
    #[command(flatten)]
    results: ResultsOption,
    #[command(flatten)]
    threads: ThreadsOption,
    #[command(flatten)]
    units: UnitsOption,
    #[command(flatten)]
    set: SetOption,
    /// Name the cheapest model and mesh that keep this relative error of `t_50_z_rim`, `t_90_z_rim`, `peak_kinetic_energy`,
    /// `final_z_rim` and `final_volume`, as in "5 %".
    #[arg(long, value_name = "ERROR")]
    accuracy: Option<String>,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Runs `billow plan`: one row per point on `out`; summary, forecast and notes on stderr.
///
/// # Errors
/// When the study is invalid or the output cannot be written.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let study = Study::load(&args.study, &args.set.set)?;
    let advice = advice::advice(&study, args.accuracy.as_deref())?;
    let Some(generation) = next_jobs(&study, &[]) else { return Ok(()) };
    let counts = PlanCounts::of(&study, &generation);
    print_points(args, &study, &generation, out)?;
    // What follows on stderr stands below.
    out.flush().map_err(output_error)?;
    if !args.quiet.quiet {
        eprintln!("{}: {}", study.name, summary(&study, &counts));
        let assumptions = assumptions(&generation.points, study.assumed()).join("; ");
        for line in wrapped(&assumptions, ASSUMED.len()) {
            eprintln!("{ASSUMED}{line}");
        }
        print_progress_and_forecast(args, &study, &generation)?;
        notes::print_warnings(&study);
        notes::print(&study);
        results::notes(&study, &counts)
            .into_iter()
            .chain(advice)
            .for_each(|note| eprintln!("{note}"));
    }
    Ok(())
}

/// Prints one row per point.
fn print_points(
    args: &Args,
    study: &Study,
    generation: &Generation,
    out: &mut dyn Write,
) -> Result<()> {
    let format = args.output.format();
    let units = args.units.apply(study.display_units(), &|name| si_unit(study, name))?;
    let unit = |name: &str| units.of(name, study.unit(name));
    let points = &generation.points;
    let column = |name: &str, shown: DisplayUnit, cell: &dyn Fn(&Point) -> Value| {
        // Cells of a parameter can be numbers and words.
        Column { shown, ..Column::plain(name, CellType::Text, points.iter().map(cell).collect()) }
    };
    let text = |name: &str, of: &dyn Fn(&Point) -> Option<String>| {
        column(name, DisplayUnit::si(""), &|point| of(point).map_or(Value::Null, Value::Text))
    };
    let parameters = study.parameter_names();
    let mut columns = vec![text("job", &|point| Some(point.job.id.as_str().to_owned()))];
    columns.extend(parameters.iter().enumerate().map(|(index, name)| {
        column(name, unit(name), &|point| point.job.parameters[index].1.clone())
    }));
    columns.push(text("status", &|point| {
        Some(if point.infeasible.is_none() { "job" } else { "infeasible" }.to_owned())
    }));
    columns.extend(SOLVED.iter().enumerate().map(|(index, (name, si))| {
        let is_parameter = parameters.iter().any(|parameter| parameter == name);
        let shown = if is_parameter { format!("{name}_resolved") } else { (*name).to_owned() };
        column(&shown, units.of(name, si), &|point| solved(point)[index].clone())
    }));
    let infeasible = |point: &Point| point.infeasible.clone();
    columns.push(text("reason", &|point| Some(infeasible(point)?.reason)));
    columns.push(text("nearest", &|point| {
        infeasible(point)
            .filter(|found| !found.nearest.is_empty())
            .map(|found| found.nearest_text())
    }));
    columns.push(text("note", &|point| (!point.merged.is_empty()).then(|| note(point, &unit))));
    let table = Table { columns };
    let rows: Vec<usize> = (0..table.rows()).collect();
    if format != Format::Table {
        return print_table(&table, &table.columns.iter().collect::<Vec<_>>(), &rows, format, out);
    }
    print_for_reader(table, &rows, &study.replicates(), out)
}

/// Prints the points to a reader: each once with the number of its runs, without columns that hold nothing.
fn print_for_reader(
    mut table: Table,
    rows: &[usize],
    replicates: &[String],
    out: &mut dyn Write,
) -> Result<()> {
    let mut firsts = rows.to_vec();
    if !replicates.is_empty() {
        let fixed = fixed(&table, replicates);
        let mut runs: BTreeMap<Vec<String>, i64> = BTreeMap::new();
        firsts.retain(|row| {
            let runs = runs.entry(point_key(&fixed, *row)).or_default();
            *runs += 1;
            *runs == 1
        });
        let of_row = |row: usize| Value::Integer(runs[&point_key(&fixed, row)]);
        let cells = rows.iter().map(|row| of_row(*row)).collect();
        let runs = Column::plain("runs", CellType::Integer, cells);
        table.columns.retain(|column| !replicates.contains(&column.name) && column.name != "job");
        table.columns.insert(0, runs);
    }
    table.columns.retain(|column| !column.is_empty());
    print_table(&table, &table.columns.iter().collect::<Vec<_>>(), &firsts, Format::Table, out)
}

/// Prints how many jobs are finished, if the results folder belongs to this study, the lengths in use,
/// and the estimated cost of the other jobs.
fn print_progress_and_forecast(args: &Args, study: &Study, generation: &Generation) -> Result<()> {
    let root = results_folder(&args.results, study);
    let results = Results::new(&Disk, &root);
    let same_study = results.owner()?.as_deref() == Some(study.name.as_str());
    let records = if same_study { results.journal()?.records } else { BTreeMap::new() };
    let jobs = generation.points.iter().filter(|point| point.infeasible.is_none());
    let (finished, missing): (Vec<&Point>, Vec<&Point>) =
        jobs.partition(|point| records.contains_key(&point.job.id));
    if !finished.is_empty() {
        let jobs = print::count(finished.len() + missing.len(), "job");
        eprintln!("{}: {} of {jobs} finished already", root.display(), finished.len());
    }
    changes::note_elsewhere(&results, study);
    if let Some(note) = changes::other_physics(&other_physics(&generation.points, &records)) {
        eprintln!("{}: {note}", root.display());
    }
    let memory = Memory::new(args.threads.count()?);
    memory.note(study).into_iter().for_each(|note| eprintln!("{note}"));
    // What does not fit is not built either.
    let fits = |point: &&Point| memory.fits(&point.job.scene);
    let missing: Vec<&Point> = missing.into_iter().filter(fits).collect();
    let fitting: Vec<&Point> = generation.points.iter().filter(fits).collect();
    if let Some(text) = lengths::in_use(&fitting) {
        eprintln!("{text}");
    }
    let searches = study.searched().is_some() || study.budget().is_some();
    let cost = forecast(&missing, searches, memory.threads);
    cost.into_iter().chain(memory.forecast(study)).for_each(|text| eprintln!("{text}"));
    Ok(())
}

/// Quantities that the fold design gives. A parameter of the same name keeps its column; the solved value
/// then stands in a column `NAME_resolved`.
const SOLVED: [(&str, &str); 4] =
    [("phi", "rad"), ("half_angle", "rad"), ("top_radius", "m"), ("height", "m")];

/// SI unit of a parameter or of a quantity of the fold; `None` for another name.
fn si_unit(study: &Study, name: &str) -> Option<String> {
    let solved = SOLVED.iter().find(|(solved, _)| *solved == name).map(|(_, unit)| *unit);
    let is_parameter = study.parameter_names().iter().any(|parameter| parameter == name);
    let unit = if is_parameter { Some(study.unit(name)) } else { solved };
    unit.map(str::to_owned)
}

/// The cells of [`SOLVED`].
fn solved(point: &Point) -> [Value; SOLVED.len()] {
    point.solved.map_or([const { Value::Null }; SOLVED.len()], |solved| {
        [solved.phi, solved.half_angle, solved.top_radius, solved.height].map(Value::Number)
    })
}

/// The points that are the same job as this one: the first three, and the number of the others.
fn note(point: &Point, unit: &dyn Fn(&str) -> DisplayUnit) -> String {
    const MAX_SHOWN: usize = 3;
    let merged: &[Parameters] = &point.merged;
    let mut texts: Vec<String> = merged
        .iter()
        .take(MAX_SHOWN)
        .map(|parameters| {
            if *parameters == point.job.parameters {
                return "this point, which the study gives again".to_owned();
            }
            let values: Vec<String> = parameters
                .iter()
                .map(|(name, value)| format!("{name} = {}", unit(name).quantity(value)))
                .collect();
            values.join(", ")
        })
        .collect();
    if merged.len() > MAX_SHOWN {
        texts.push(format!("and {} more", merged.len() - MAX_SHOWN));
    }
    format!("same job as {}", texts.join("; "))
}

/// The numbers of points and jobs, as one line.
fn summary(study: &Study, counts: &PlanCounts) -> String {
    format!(
        "{}: {}, {}, {} infeasible; {} filtered out",
        print::points_of_runs(study, counts.points, 0),
        print::count(counts.jobs, "job"),
        print::count(counts.duplicates, "duplicate"),
        counts.infeasible,
        counts.filtered
    )
}
