//! `billow plan`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write;
use std::path::PathBuf;

use billow_solver::ladder::{self, Cost};
use billow_solver::scene::ModelKind;

use super::print::print_rows;
use super::{Format, Global, notes};
use crate::error::Result;
use crate::job::{Parameters, canonical_json};
use crate::plan::{Generation, next_jobs};
use crate::point::Point;
use crate::study::Study;
use crate::value::{Value, short_number};

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
        if let Some(text) = forecast(&generation) {
            eprintln!("{text}");
        }
        notes::print(&study);
    }
    Ok(())
}

/// Nanoseconds an element and step of the film model take on one core, about: measured on the paper's
/// capsule at n 5 over half a second.
const NS: f64 = 130.0;
/// Meshes that are made to foretell a cost, at most.
const MESHES: usize = 100;

/// What the jobs will cost, about; nothing for models that cost next to nothing.
fn forecast(generation: &Generation) -> Option<String> {
    let mut known: BTreeMap<String, Cost> = BTreeMap::new();
    let (mut jobs, mut element_steps) = (0_usize, 0.0);
    for point in generation.points.iter().filter(|point| point.infeasible.is_none()) {
        let scene = &point.job.scene;
        if scene.solver.model == ModelKind::Piston {
            continue;
        }
        let decides = (&scene.design, &scene.film, &scene.solver, scene.outputs.sample_interval);
        let key = canonical_json(&decides);
        if !known.contains_key(&key) {
            if known.len() == MESHES {
                return Some(format!(
                    "forecast: over {MESHES} meshes, none made to foretell a cost"
                ));
            }
            known.insert(key.clone(), ladder::cost(scene).ok()?);
        }
        let cost = known[&key];
        jobs += 1;
        element_steps += cost.elements as f64 * cost.steps as f64;
    }
    (jobs > 0).then(|| {
        format!(
            "forecast: {jobs} {} of film, {} million element-steps, about {} of one core",
            if jobs == 1 { "job" } else { "jobs" },
            short_number(libm::round(element_steps / 1e6)),
            spent(element_steps * NS * 1e-9)
        )
    })
}

fn spent(seconds: f64) -> String {
    match seconds {
        _ if seconds < 120.0 => format!("{} s", libm::ceil(seconds)),
        _ if seconds < 7200.0 => format!("{} min", libm::ceil(seconds / 60.0)),
        _ => format!("{} h", libm::ceil(seconds / 3600.0)),
    }
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
