//! `billow plan`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};

mod forecast;

use forecast::forecast;

use super::print::{self, print_rows};
use super::run::results_folder;
use super::{Format, Global, memory, notes};
use crate::input::value::{Value, short_number};
use crate::job::Parameters;
use crate::job::point::Point;
use crate::platform::error::Result;
use crate::platform::files::Disk;
use crate::store::results::Results;
use crate::study::Study;
use crate::study::plan::{Generation, next_jobs};

/// Arguments of `billow plan`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The study file.
    #[arg(value_name = "STUDY")]
    pub study: PathBuf,
}

/// Runs `billow plan`: one row a point on `out`, a closing line on stderr.
///
/// # Errors
/// When the study is not sound or the output cannot be written.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let study = Study::load(&args.study, &global.set)?;
    let Some(generation) = next_jobs(&study, &[]) else { return Ok(()) };
    let format = global.format();
    let names = study.parameter_names();
    let rows: Vec<Vec<Value>> =
        generation.points.iter().map(|point| row(point, format == Format::Table)).collect();
    print_rows(&columns(&names), &rows, format, out)?;
    if !global.quiet {
        if format == Format::Table {
            eprintln!("units: {}", units(&study));
        }
        eprintln!("{}: {}", study.name, summary(&generation));
        tell_the_rest(&args.study, &study, &generation, global)?;
        notes::print(&study);
    }
    Ok(())
}

/// Says how many of the jobs are finished in the results folder, where it is this study's, and what the
/// others will cost.
fn tell_the_rest(
    file: &Path,
    study: &Study,
    generation: &Generation,
    global: &Global,
) -> Result<()> {
    let root = results_folder(global, study);
    let results = Results::new(&Disk, &root);
    let ours = results.owner()?.as_deref() == Some(study.name.as_str());
    let records = if ours { results.journal()?.records } else { BTreeMap::new() };
    let jobs = generation.points.iter().filter(|point| point.infeasible.is_none());
    let (there, missing): (Vec<&Point>, Vec<&Point>) =
        jobs.partition(|point| records.contains_key(&point.job.id));
    if !there.is_empty() {
        let jobs = print::count(there.len() + missing.len(), "job");
        eprintln!("{}: {} of {jobs} there already", root.display(), there.len());
    }
    if let Err(error) = memory::check(&file.display().to_string(), study) {
        eprintln!("{error}");
        return Ok(());
    }
    let references = results.references().into_iter().map(|(id, _)| id).collect();
    if let Some(text) = forecast(&missing, references) {
        eprintln!("{text}");
    }
    Ok(())
}

/// What the fold solves; a parameter of the same name is what was asked for, so it keeps its column
/// and the solved one is told apart.
const SOLVED: [&str; 4] = ["phi", "half_angle", "top_radius", "height"];

/// Units of what is printed.
fn units(study: &Study) -> String {
    let parameters = study.parameter_names();
    let own = parameters.iter().map(|name| (name.as_str(), study.unit(name)));
    let solved = [("phi", "rad"), ("half_angle", "rad"), ("top_radius", "m"), ("height", "m")];
    let units: Vec<String> = own
        .chain(solved.into_iter().filter(|(name, _)| !parameters.iter().any(|own| own == name)))
        .filter(|(_, unit)| !matches!(*unit, "" | "1"))
        .map(|(name, unit)| format!("{name} {unit}"))
        .collect();
    units.join(", ")
}

fn columns(parameters: &[String]) -> Vec<String> {
    let mut columns = vec!["job".to_owned()];
    columns.extend(parameters.iter().cloned());
    columns.push("status".to_owned());
    columns.extend(SOLVED.iter().map(|name| {
        let taken = parameters.iter().any(|parameter| parameter == name);
        if taken { format!("{name}_resolved") } else { (*name).to_owned() }
    }));
    columns.extend(["reason", "nearest", "note"].map(str::to_owned));
    columns
}

fn row(point: &Point, short: bool) -> Vec<Value> {
    let id = if short { point.job.id.short() } else { point.job.id.as_str() };
    let mut row = vec![Value::Text(id.to_owned())];
    row.extend(point.job.parameters.iter().map(|(_, value)| value.clone()));
    let text = |text: &str| Value::Text(text.to_owned());
    match &point.infeasible {
        None => {
            row.push(text("job"));
            row.extend(solved(point));
            row.extend([Value::Null, Value::Null]);
        }
        Some(infeasible) => {
            row.push(text("infeasible"));
            row.extend(solved(point));
            row.push(text(&infeasible.reason));
            row.push(match infeasible.nearest.as_slice() {
                [] => Value::Null,
                _ => Value::Text(infeasible.nearest_text()),
            });
        }
    }
    row.push(if point.merged.is_empty() { Value::Null } else { Value::Text(note(&point.merged)) });
    row
}

/// The cells of [`SOLVED`].
fn solved(point: &Point) -> [Value; SOLVED.len()] {
    point.solved.map_or([const { Value::Null }; SOLVED.len()], |solved| {
        [solved.phi, solved.half_angle, solved.top_radius, solved.height].map(Value::Number)
    })
}

/// Which points are the same job as this one; beyond a few, how many.
fn note(merged: &[Parameters]) -> String {
    const SHOWN: usize = 3;
    let mut texts: Vec<String> = merged
        .iter()
        .take(SHOWN)
        .map(|parameters| {
            let values: Vec<String> = parameters
                .iter()
                .map(|(name, value)| match value {
                    Value::Number(number) => format!("{name} = {}", short_number(*number)),
                    other => format!("{name} = {other}"),
                })
                .collect();
            if values.is_empty() { "the same point".to_owned() } else { values.join(", ") }
        })
        .collect();
    if merged.len() > SHOWN {
        texts.push(format!("and {} more", merged.len() - SHOWN));
    }
    format!("same job as {}", texts.join("; "))
}

fn summary(generation: &Generation) -> String {
    let count = |number: usize, one: &str, many: &str| {
        format!("{number} {}", if number == 1 { one } else { many })
    };
    let points = &generation.points;
    let infeasible = points.iter().filter(|point| point.infeasible.is_some()).count();
    let merged: usize = points.iter().map(|point| point.merged.len()).sum();
    let mut text = count(points.len() - infeasible, "job", "jobs");
    if infeasible > 0 {
        let _ = write!(text, ", {}", count(infeasible, "infeasible point", "infeasible points"));
    }
    if merged > 0 {
        let _ = write!(text, ", {}", count(merged, "point merged", "points merged"));
    }
    text
}
