//! `billow advise`: the cheapest method that keeps a mesh error, from the table of mesh errors. It runs nothing.

use std::io::Write;
use std::path::PathBuf;

use super::Format;
use super::options::{OutputOptions, QuietOption, SetOption};
use super::print::{Heading, count, print_quantities};
use crate::accuracy::choice::cost;
use crate::accuracy::{Choice, Features, MeshErrors, Method, PROMISED, choices};
use crate::input::units::{self, Dimension};
use crate::input::value::Value;
use crate::platform::error::{Error, Result};
use crate::platform::nearest::did_you_mean;
use crate::study::Study;
use billow_solver::scene::{ModelKind, Scene};

/// Arguments of `billow advise`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The study file.
    study: PathBuf,
    /// Relative error that each measure must keep, as in 0.02 or "2 %".
    #[arg(long, value_name = "FRACTION")]
    tolerance: String,
    /// The measures that must keep it, comma-separated [default: `t_90_z_rim`, `peak_kinetic_energy`, `final_z_rim`,
    /// `final_volume`: those with a limit of fine meshes].
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    measures: Vec<String>,
    #[command(flatten)]
    set: SetOption,
    #[command(flatten)]
    output: OutputOptions,
    #[command(flatten)]
    quiet: QuietOption,
}

/// Runs `billow advise`: one row per method, the cheapest first.
///
/// # Errors
/// A study that is not valid, or that the table of mesh errors does not cover; an unknown measure.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let study = Study::load(&args.study, &args.set.set)?;
    let tolerances = tolerances(args)?;
    let scenes: Vec<(&Scene, Features)> = study
        .points()
        .iter()
        .filter_map(|point| {
            let solved = point.solved?;
            Some((&point.scene, Features::of(&point.scene, solved.top_radius, solved.height)))
        })
        .collect();
    let table = MeshErrors::shipped();
    let choices = choices(table, &scenes).map_err(|gap| {
        let allowed = "scenes that the table of mesh errors covers: docs/guide/accuracy.md";
        let hint = "run one point on two meshes and compare them: solver.meshes with three meshes estimates the error \
                    without the table";
        Error::invalid_option("study", &study.name, format!("no advice: {gap}"), allowed, hint)
    })?;
    let headings: Vec<Heading> = ["method", "cost"]
        .into_iter()
        .chain(PROMISED.iter().map(|promised| promised.error_column))
        .chain(["keeps_tolerance"])
        .map(Heading::plain)
        .collect();
    let cells: Vec<Vec<Value>> = choices.iter().map(|choice| row(choice, &tolerances)).collect();
    let format = args.output.format();
    print_quantities(&headings, &cells, format, out)?;
    if format == Format::Table && !args.quiet.quiet {
        print_advice(&study, table, &choices, &tolerances);
    }
    Ok(())
}

/// The tolerance of each promised measure.
fn tolerances(args: &Args) -> Result<[Option<f64>; PROMISED.len()]> {
    let text = args.tolerance.trim();
    let number = text.parse().ok().or_else(|| units::parse(text, Dimension::Number).ok());
    let tolerance = number.filter(|number| *number > 0.0 && *number < 1.0).ok_or_else(|| {
        let allowed = "above 0 and below 1, as 0.02 or \"2 %\"";
        Error::invalid_option("--tolerance", text, "not a relative error", allowed, "")
    })?;
    if args.measures.is_empty() {
        return Ok(PROMISED.map(|promised| promised.has_limit.then_some(tolerance)));
    }
    let names = || PROMISED.iter().map(|promised| promised.measure.name());
    let mut tolerances = [None; PROMISED.len()];
    for name in args.measures.iter().map(|name| name.trim()) {
        let index = names().position(|known| known == name).ok_or_else(|| {
            let near = did_you_mean(name, names()).unwrap_or_default();
            let allowed = names().collect::<Vec<_>>().join(", ");
            Error::invalid_option(
                "--measures",
                name,
                "not a measure with a known mesh error",
                allowed,
                near,
            )
        })?;
        tolerances[index] = Some(tolerance);
    }
    Ok(tolerances)
}

fn row(choice: &Choice, tolerances: &[Option<f64>; PROMISED.len()]) -> Vec<Value> {
    let number = |number: f64| {
        if number.is_finite() { Value::Number(number) } else { Value::Null }
    };
    let mut row = vec![Value::Text(choice.method.name()), Value::Number(choice.cost)];
    row.extend(choice.errors.map(number));
    row.push(Value::Bool(choice.keeps(tolerances)));
    row
}

/// The recommendation, on stderr: method, saving, how to set it, what it does not promise.
fn print_advice(
    study: &Study,
    table: &MeshErrors,
    choices: &[Choice],
    tolerances: &[Option<f64>; PROMISED.len()],
) {
    eprintln!(
        "{}; errors: of 9 of 10 runs, the largest over the points; cost: over a run on n {}",
        count(study.points().len(), "point"),
        table.reference
    );
    let chosen = PROMISED.iter().zip(tolerances).filter(|(_, tolerance)| tolerance.is_some());
    let (limits, changes): (Vec<_>, Vec<_>) = chosen.partition(|(promised, _)| promised.has_limit);
    let names = |list: &[(&crate::accuracy::Promised, &Option<f64>)]| {
        list.iter().map(|(promised, _)| promised.measure.name()).collect::<Vec<_>>().join(", ")
    };
    if let Some(choice) = choices.iter().find(|choice| choice.keeps(tolerances)) {
        let now = study.points().iter().map(|point| cost(table, &Method::of(&point.scene)));
        let now = now.fold(0.0, f64::max);
        let saving = if choice.cost < now {
            format!("{:.1} times cheaper than now", now / choice.cost)
        } else {
            format!("{:.1} times the cost of now", choice.cost / now)
        };
        eprintln!("advice: {} ({saving}); {}", choice.method.name(), setting(&choice.method));
    } else {
        let keys = PROMISED.iter().enumerate().filter(|(index, _)| tolerances[*index].is_some());
        let best = keys.map(|(index, promised)| {
            let errors = choices.iter().map(|choice| choice.errors[index]);
            let least = errors.fold(f64::INFINITY, f64::min);
            format!("{} {:.1} %", promised.measure.name(), 100.0 * least)
        });
        let best = best.collect::<Vec<_>>().join(", ");
        eprintln!(
            "advice: none: no method of the table keeps this; the smallest errors are {best}"
        );
    }
    if !limits.is_empty() {
        eprintln!("promised against the limit of fine meshes: {}", names(&limits));
    }
    if !changes.is_empty() {
        eprintln!(
            "promised up to n {} only, no limit is known: {}",
            table.reference,
            names(&changes)
        );
    }
}

/// How a study file asks for a method.
fn setting(method: &Method) -> String {
    match (method.model, method.meshes.as_slice()) {
        (ModelKind::Piston | ModelKind::Storeys, _) => {
            format!("\"solver\": {{\"model\": \"{}\"}}", method.name())
        }
        (ModelKind::Film, [n]) => format!("\"design\": {{\"subdivisions\": {n}}}"),
        (ModelKind::Film, meshes) => {
            let meshes: Vec<String> = meshes.iter().map(ToString::to_string).collect();
            format!("\"solver\": {{\"meshes\": [{}]}}", meshes.join(", "))
        }
    }
}
