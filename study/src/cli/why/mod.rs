//! `billow why`: explains why a job ended as it did.

use std::fmt::Write as _;
use std::io::Write;

use billow_solver::output::audit::{MAX_LEDGER_RESIDUAL, MAX_NUMERICAL_FRACTION};
use serde_json::{Map, json};

use super::limits;
use super::options::OutputOptions;
use super::print::print_rows;
use super::remedies::{self, Line};
use super::target::{StudyArgs, folder_of_job};
use super::{Format, output_error};
use crate::input::value::{Value, brief_number, json_value};
use crate::job::row::{Cells, ColumnId};
use crate::job::{JobId, Status};
use crate::platform::error::Result;
use crate::scene::summary;
use crate::store::stored::Stored;

mod failure;
mod motion;
mod verdict;

/// Arguments of `billow why`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The job: the first digits of its id.
    pub job: String,
    #[command(flatten)]
    study: StudyArgs,
    #[command(flatten)]
    output: OutputOptions,
}

/// Runs `billow why`.
///
/// # Errors
/// An unknown job; results that cannot be read.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let root = folder_of_job(&args.job, &args.study)?;
    let (stored, id) = super::stored::read_job(&root, &args.job)?;
    let cells = stored.cells_of_job(&id);
    let lines = explanation(&stored, &id, &cells)?;
    match args.output.format() {
        Format::Table => {
            writeln!(out, "job {}: {}", stored.label(&id), headline(&cells))
                .map_err(output_error)?;
            for (topic, text) in &lines {
                writeln!(out, "  {topic:<9} {text}").map_err(output_error)?;
            }
            Ok(())
        }
        format => {
            let json = keys(&stored, &id, &cells, &lines);
            if format == Format::Json {
                return writeln!(out, "{json}").map_err(output_error);
            }
            print_rows(&["quantity", "value"], &summary::rows(&json), format, out)
        }
    }
}

/// Status and verdict.
fn headline(cells: &Cells) -> String {
    let near = if verdict::is_near_threshold(cells) { ", near a threshold" } else { "" };
    match cells.text(ColumnId::Verdict) {
        "" => cells.status().name().to_owned(),
        verdict => format!("{}, {verdict}{near}", cells.status().name()),
    }
}

/// Every line of the explanation; the last one is the next step.
fn explanation(stored: &Stored<'_>, id: &JobId, cells: &Cells) -> Result<Vec<Line>> {
    let root = stored.results.root().display();
    let (mut lines, mut next) = match cells.status() {
        Status::Done => done(stored, id, cells),
        Status::Pending => pending(stored, id),
        status => failure::explanation(cells, status, id.short(), &root.to_string()),
    };
    lines.extend(limits::lines(stored, cells));
    lines.extend(audit(cells));
    lines.extend(damping(cells));
    lines.extend(remedies::lines(stored, id, cells));
    let shown = stored.point(id).map(|point| &point.job.id);
    if let Some(shown) = shown.filter(|shown| *shown != id) {
        next = format!("billow why {} {root}", shown.short());
    } else if remedies::next(stored, id).is_some() {
        next = format!("billow rerun {} {root} --remedy", id.short());
    }
    if stored.point(id).is_none() {
        lines.push(("study", "this job is no longer in the study".to_owned()));
    }
    if let Some(record) = stored.journal.records.get(id)
        && let Some(damage) = stored.results.damage(record)?
    {
        lines
            .push(("file", format!("{damage} by the next `billow run`; see billow doctor {root}")));
    }
    lines.push(("next", next));
    Ok(lines)
}

/// Lines and next step of a job that reached its end time.
fn done(stored: &Stored<'_>, id: &JobId, cells: &Cells) -> (Vec<Line>, String) {
    let mut lines = verdict::explanation(cells);
    if !verdict::is_deployed(cells)
        && let Some(moving) = motion::at_the_end(stored, id)
    {
        lines.push(("motion", moving));
        let next = "a longer solver.end_time: the film was still moving at the end of the run";
        return (lines, next.to_owned());
    }
    let root = stored.results.root().display();
    (lines, format!("billow show {} {root} --history", id.short()))
}

/// Lines and next step of a job that has not run.
fn pending(stored: &Stored<'_>, id: &JobId) -> (Vec<Line>, String) {
    let invalidated = stored.journal.invalidated.contains_key(id);
    let status = if invalidated { "invalidated, not run again yet" } else { "not run yet" };
    let root = stored.results.root().display();
    let next = format!("billow run of its study, or billow rerun {} {root}", id.short());
    (vec![("status", status.to_owned())], next)
}

/// Lines of the audit: energy ledger, passages and intersections.
fn audit(cells: &Cells) -> Vec<Line> {
    let Some(residual) = cells.number(ColumnId::LedgerResidual) else { return Vec::new() };
    let sign = if residual <= MAX_LEDGER_RESIDUAL { "≤" } else { ">" };
    let residual = brief_number(residual);
    let mut ledger = format!("largest residual {residual} {sign} {MAX_LEDGER_RESIDUAL}");
    if let Some(gas) = cells.number(ColumnId::GasResidual) {
        let _ = write!(ledger, "; gas balance {}", brief_number(gas));
    }
    let film = match (cells.get(ColumnId::Passages), cells.get(ColumnId::Intersections)) {
        (Value::Null, Value::Null) => {
            "passages and intersections are not counted by this model".to_owned()
        }
        (passages, intersections) => {
            format!("passages {passages}, intersections {intersections}")
        }
    };
    vec![("ledger", ledger), ("film", film)]
}

/// What the film's material and the method took of the work of the gas, where it matters.
fn damping(cells: &Cells) -> Vec<Line> {
    let large = |column| {
        let fraction: Option<f64> = cells.number(column);
        fraction.filter(|fraction| fraction.abs() > MAX_NUMERICAL_FRACTION)
    };
    let mut lines = Vec::new();
    if let Some(fraction) = large(ColumnId::MaterialLossFraction) {
        lines.push((
            "damping",
            format!(
                "the film's material took {} of the work of the gas (material_loss_fraction): film.loss_factor",
                percent(fraction)
            ),
        ));
    }
    if let Some(fraction) = large(ColumnId::NumericalFraction) {
        let verb = if fraction > 0.0 { "took" } else { "added" };
        lines.push((
            "damping",
            format!(
                "the method {verb} {} of the work of the gas until the first peak (numerical_fraction): kinetic \
                 energies and rebounds are wrong by about as much",
                percent(fraction)
            ),
        ));
    }
    lines
}

/// A fraction as a percentage, without its sign.
fn percent(fraction: f64) -> String {
    format!("{} %", brief_number((100.0 * fraction).abs()))
}

/// The explanation as JSON keys.
fn keys(stored: &Stored<'_>, id: &JobId, cells: &Cells, lines: &[Line]) -> serde_json::Value {
    let parameters = stored.point(id).map(|point| {
        let parameters = point.job.parameters.iter();
        parameters.map(|(name, value)| (name.clone(), json_value(value))).collect::<Map<_, _>>()
    });
    let texts = lines.iter().map(|(topic, text)| format!("{topic}: {text}"));
    let mut keys = json!({
        "job": id.as_str(),
        "parameters": parameters,
        "ledger_bound": MAX_LEDGER_RESIDUAL,
        "checks": verdict::checks(cells),
        "why": texts.collect::<Vec<_>>(),
    });
    for (name, value) in limits::keys(stored, cells) {
        keys[name] = value;
    }
    let attempt = remedies::next(stored, id);
    keys["next_remedy"] = attempt.as_ref().map(|next| next.text.as_str()).into();
    let point = stored.point(id).filter(|point| point.job.id == *id);
    keys["proposed"] = point.map(|point| remedies::proposed(cells, point)).into();
    for column in [
        ColumnId::Status,
        ColumnId::Verdict,
        ColumnId::NearThreshold,
        ColumnId::NearThresholdMargin,
        ColumnId::Reason,
        ColumnId::Nearest,
        ColumnId::StopTime,
        ColumnId::StopLocation,
        ColumnId::StopAudit,
        ColumnId::Remedy,
        ColumnId::FailedRemedies,
        ColumnId::LedgerResidual,
        ColumnId::GasResidual,
        ColumnId::Passages,
        ColumnId::Intersections,
    ] {
        keys[column.name()] = json_value(cells.get(column));
    }
    keys
}
