//! `billow advise`: the cheapest of all models and meshes that keeps an error, from the table of mesh errors. It runs
//! nothing.

use std::io::Write;
use std::path::PathBuf;

use super::Format;
use super::options::{OutputOptions, QuietOption, SetOption};
use super::print::{Heading, count, fraction, print_quantities};
use crate::accuracy::choice::cost;
use crate::accuracy::features::STEP;
use crate::accuracy::{
    Choice, MeshErrors, Method, PROMISED, Promised, Tolerances, all_but_peak_vz, choices,
};
use crate::input::fraction::{RELATIVE_ERROR, relative_error};
use crate::input::keys;
use crate::input::value::{Value, brief_number};
use crate::job::point::Point;
use crate::platform::error::{Error, Result};
use crate::platform::nearest::did_you_mean;
use crate::study::{Study, features};
use billow_solver::scene::ModelKind;

/// Relative error that measures must keep where the command gives none.
const DEFAULT_TOLERANCE: &str = "5 %";

/// Arguments of `billow advise`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The study file.
    study: PathBuf,
    /// Relative error that each measure must keep, as in 0.02 or "2 %" [default: 5 %].
    #[arg(long, value_name = "FRACTION")]
    tolerance: Option<String>,
    /// The measures that must keep it, comma-separated [default: all but `peak_vz`].
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
    let scenes: Vec<_> = study.points().iter().filter_map(features).collect();
    let table = MeshErrors::shipped();
    let choices = choices(table, &scenes).map_err(|gap| {
        let allowed = "scenes that the table of mesh errors covers: docs/guide/accuracy.md";
        let hint = hint(&study);
        Error::invalid_option("study", &study.name, format!("no advice: {gap}"), allowed, hint)
    })?;
    let format = args.output.format();
    let errors = PROMISED.map(|promised| match format {
        Format::Table => promised.measure.name().to_owned(),
        Format::Csv | Format::Json => format!("{}_relative_error", promised.measure.name()),
    });
    let headings: Vec<Heading> = ["method", "cost"]
        .into_iter()
        .chain(errors.iter().map(String::as_str))
        .chain(["keeps_tolerance"])
        .map(Heading::plain)
        .collect();
    let cells: Vec<Vec<Value>> =
        choices.iter().map(|choice| row(choice, &tolerances, format)).collect();
    print_quantities(&headings, &cells, format, out)?;
    if format == Format::Table && !args.quiet.quiet {
        print_advice(&study, table, &choices, &tolerances);
    }
    Ok(())
}

/// What to do where the table does not cover a study.
fn hint(study: &Study) -> String {
    let meshless = |point: &&Point| point.job.scene.solver.model != ModelKind::Film;
    match study.points().iter().find(meshless) {
        None => {
            let search = study.searched();
            let values = search.map_or_else(String::new, |(parameter, _)| {
                format!(", and a list of values of {parameter} instead of bisect")
            });
            format!(
                "run some points with \"solver\": {{\"meshes\": [4, 6, 8]}}{values}: the errors in their rows follow \
                 from the three runs, without the table"
            )
        }
        Some(point) => {
            let model = keys::model(point.job.scene.solver.model).name;
            format!(
                "run one point with \"grid\": {{\"model\": [\"film\", \"{model}\"]}} and compare the two: \
                 billow compare STUDY --by model --base film"
            )
        }
    }
}

/// The tolerance of each promised measure.
fn tolerances(args: &Args) -> Result<Tolerances> {
    let text = args.tolerance.as_deref().unwrap_or(DEFAULT_TOLERANCE);
    let tolerance = relative_error(text).ok_or_else(|| {
        Error::invalid_option("--tolerance", text, "not a relative error", RELATIVE_ERROR, "")
    })?;
    if args.measures.is_empty() {
        return Ok(all_but_peak_vz(Some(tolerance)));
    }
    let names = || PROMISED.iter().map(|promised| promised.measure.name());
    let mut tolerances: Tolerances = [None; PROMISED.len()];
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

fn row(choice: &Choice, tolerances: &Tolerances, format: Format) -> Vec<Value> {
    let number = |number: f64| {
        if number.is_finite() { fraction(number, format) } else { Value::Null }
    };
    let mut row = vec![Value::Text(choice.method.name()), Value::Number(choice.cost)];
    row.extend(choice.errors.map(number));
    row.push(Value::Bool(choice.keeps(tolerances)));
    row
}

/// The recommendation, on stderr: method, saving, how to set it, what it does not promise.
fn print_advice(study: &Study, table: &MeshErrors, choices: &[Choice], tolerances: &Tolerances) {
    eprintln!(
        "{}; relative errors that 9 of 10 runs keep, the largest over the points, - where the table has no such runs; cost: \
         over a run on n {}",
        count(study.point_count(), "point"),
        table.reference
    );
    let chosen = PROMISED.iter().zip(tolerances).filter(|(_, tolerance)| tolerance.is_some());
    let (limits, changes): (Vec<_>, Vec<_>) = chosen.partition(|(promised, _)| promised.has_limit);
    let names = |list: &[(&Promised, &Option<f64>)]| {
        list.iter().map(|(promised, _)| promised.measure.name()).collect::<Vec<_>>().join(", ")
    };
    let recommended = choices.iter().find(|choice| choice.keeps(tolerances));
    if let Some(choice) = recommended {
        let method = &choice.method;
        let saving = saving(study, table, choice.cost);
        eprintln!("advice: {} ({saving}); {}", method.name(), setting(method, study));
        let tolerances: Vec<String> = PROMISED
            .iter()
            .zip(tolerances)
            .filter_map(|(promised, tolerance)| {
                let percent = brief_number(100.0 * (*tolerance)?);
                Some(format!("{} {percent} %", promised.measure.name()))
            })
            .collect();
        eprintln!("asked: {}", tolerances.join(", "));
    } else if choices.is_empty() {
        eprintln!("advice: none: the table has no runs of such scenes; {}", hint(study));
    } else {
        let keys = PROMISED.iter().enumerate().filter(|(index, _)| tolerances[*index].is_some());
        let best = keys.map(|(index, promised)| {
            let possible = choices.iter().filter(|choice| choice.refusal.is_none());
            let errors = possible.map(|choice| choice.errors[index]);
            let least = errors.fold(f64::INFINITY, f64::min);
            format!("{} {:.1} %", promised.measure.name(), 100.0 * least)
        });
        let best = best.collect::<Vec<_>>().join(", ");
        eprintln!(
            "advice: none: no method of the table keeps this; the smallest errors are {best}"
        );
    }
    let mut refused: Vec<(&'static str, &str)> = choices
        .iter()
        .filter_map(|choice| {
            Some((keys::model(choice.method.model).name, choice.refusal.as_deref()?))
        })
        .collect();
    refused.dedup();
    for (model, refusal) in refused {
        eprintln!("{model} cannot compute these scenes: {refusal}");
    }
    if let Some(choice) = recommended.filter(|choice| choice.method.meshes.is_empty()) {
        let model = choice.method.name();
        eprintln!(
            "limits: {model} has no contact of film and cannot lock: it estimates times and speeds only"
        );
    }
    eprintln!(
        "step: every error is that of the default step (solver.cfl {STEP}); for another step the table has no runs and \
         billow gives no advice"
    );
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

/// The cost of a method over that of the study as it stands.
fn saving(study: &Study, table: &MeshErrors, cost_of_method: f64) -> String {
    let points = study.points();
    // A point runs on each of its meshes.
    let runs_of_one = study.meshes().len().max(1) as f64;
    let all: f64 = points.iter().map(|point| cost(table, &Method::of(&point.job.scene))).sum();
    let now = all * runs_of_one / points.len().max(1) as f64;
    if cost_of_method < now {
        format!("{:.1} times cheaper than now", now / cost_of_method)
    } else {
        format!("{:.1} times the cost of now", cost_of_method / now)
    }
}

/// What a study file must have for a method; the model only where a point has another.
fn setting(method: &Method, study: &Study) -> String {
    let mut solver = Vec::new();
    if study.points().iter().any(|point| point.job.scene.solver.model != method.model) {
        solver.push(format!("\"model\": \"{}\"", keys::model(method.model).name));
    }
    if method.meshes.len() > 1 {
        let meshes: Vec<String> = method.meshes.iter().map(ToString::to_string).collect();
        solver.push(format!("\"meshes\": [{}]", meshes.join(", ")));
    }
    let mut sections = Vec::new();
    if !solver.is_empty() {
        sections.push(format!("\"solver\": {{{}}}", solver.join(", ")));
    }
    if let [n] = method.meshes[..] {
        sections.push(format!("\"design\": {{\"subdivisions\": {n}}}"));
    }
    if sections.is_empty() { "as it is".to_owned() } else { sections.join(", ") }
}
