//! `billow why`: why a job ended as it did, in plain words.

use std::fmt::Write as _;
use std::io::Write;
use std::path::PathBuf;

use billow_solver::output::audit::MAX_LEDGER_RESIDUAL;
use billow_solver::output::measures::REFERENCE_PRESSURES;
use billow_solver::output::outcome::FailureKind;
use serde_json::{Map, json};

use super::print::print_rows;
use super::target::folder_of_job;
use super::{Format, Global, output_error};
use crate::input::value::{Value, brief_number, json_value};
use crate::job::row::{Cells, ColumnId};
use crate::job::{JobId, Status};
use crate::platform::error::Result;
use crate::platform::files::Disk;
use crate::scene::summary;
use crate::store::history_file;
use crate::store::results::Results;
use crate::store::stored::Stored;

/// Arguments of `billow why`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The job: the first digits of its id.
    pub job: String,
    /// Study file, or folder of its results [default: the only one under results].
    pub study: Option<PathBuf>,
}

/// One line of the answer: what it is about, and what it says.
type Line = (&'static str, String);

/// Runs `billow why`.
///
/// # Errors
/// A job that is not there; results that cannot be read.
pub fn run(args: &Args, global: &Global, out: &mut dyn Write) -> Result<()> {
    let root = folder_of_job(&args.job, args.study.as_deref(), global)?;
    let stored = Stored::read(Results::new(&Disk, &root))?;
    let id = stored.job(&args.job)?;
    let cells = match (stored.point(&id), stored.record(&id)) {
        (Some(point), _) => stored.cells(point),
        (None, Some(record)) => record.cells.clone(),
        (None, None) => Cells::new(Status::Pending),
    };
    let lines = reasons(&stored, &id, &cells)?;
    match global.format() {
        Format::Table => {
            writeln!(out, "job {}: {}", stored.label(&id), headline(&cells))
                .map_err(output_error)?;
            for (about, text) in &lines {
                writeln!(out, "  {about:<9} {text}").map_err(output_error)?;
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

/// Kinetic energy below which a deployment is none, J: a thousandth of the paper's slowest.
const LITTLE: f64 = 5e-3;

fn headline(cells: &Cells) -> String {
    let close = if *cells.get(ColumnId::NearThreshold) == Value::Bool(true) {
        ", near a threshold"
    } else {
        ""
    };
    match cells.text(ColumnId::Verdict) {
        "" => cells.status().name().to_owned(),
        verdict => format!("{}, {verdict}{close}", cells.status()),
    }
}

/// All there is to say.
fn reasons(stored: &Stored<'_>, id: &JobId, cells: &Cells) -> Result<Vec<Line>> {
    let mut lines: Vec<Line> = Vec::new();
    let root = stored.results.root().display();
    let short = id.short();
    let next = match cells.status() {
        Status::Done => {
            lines.extend(verdict(cells));
            let motion = motion(stored, id).filter(|_| cells.text(ColumnId::Verdict) != "deployed");
            let longer = "a longer solver.end_time: the run ended while the film was on its way";
            let next = motion.as_ref().map(|_| longer.to_owned());
            lines.extend(motion.map(|said| ("motion", said)));
            next.unwrap_or_else(|| format!("billow show {short} {root} --history"))
        }
        Status::Pending => {
            let invalidated = stored.journal.invalidated.contains_key(id);
            let said = if invalidated {
                "invalidated to be run again, and not run yet"
            } else {
                "not run yet"
            };
            lines.push(("status", said.to_owned()));
            format!("billow run of its study, or billow rerun {short} {root}")
        }
        status => {
            lines.extend(failure(cells, status));
            let energy = cells.number(ColumnId::PeakKineticEnergy).unwrap_or(f64::INFINITY);
            if status == Status::Failed(FailureKind::EnergyDrift) && energy < LITTLE {
                lines.push((
                    "energy",
                    format!(
                        "hardly any moved (peak kinetic energy {} J): the folded mesh's own strain is \
                         as large, and no balance can be told",
                        brief_number(energy)
                    ),
                ));
                "does gas flow in before solver.end_time? look at gas.mass_flow_rate and at the \
                 inflow windows of its strategy, whose times count from the start of the run"
                    .to_owned()
            } else {
                advice(status, short, &root.to_string())
            }
        }
    };
    lines.extend(trust(cells));
    if stored.point(id).is_none() {
        lines.push(("study", "the study as it is now does not have this job".to_owned()));
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

/// Share of its last volume by which the volume of film on its way changes in a tenth of its run.
const GROWING: f64 = 0.02;
/// Share of its largest kinetic energy that film on its way has, over a tenth of its run.
const MOVING: f64 = 0.05;

/// How a job still moved in the last tenth of its run, in words; `None` where it did not, or its history
/// cannot say.
fn motion(stored: &Stored<'_>, id: &JobId) -> Option<String> {
    let history = history_file::read(&stored.history_path(id).ok()?).ok()?.history;
    let of = |name: &str| history.column(name);
    let (time, volume, energy) = (of("time"), of("volume"), of("kinetic_energy"));
    let end = time.last()?;
    let from = time.partition_point(|own| *own < 0.9 * end);
    let growth = 1.0 - volume.get(from)? / volume.last()?;
    let largest = energy.iter().copied().fold(0.0, f64::max);
    let tenth = &energy[from..];
    let moving = tenth.iter().sum::<f64>() / (tenth.len() as f64 * largest);
    (growth.abs() > GROWING || moving > MOVING).then(|| {
        let (growth, moving) = (100.0 * growth, share(moving));
        format!(
            "in the last tenth its volume still changed by {} %, at {moving} of its largest kinetic energy",
            brief_number(growth)
        )
    })
}

/// A ratio against its threshold: measure, value, threshold, relative margin.
fn against(cells: &Cells, measure: ColumnId, threshold: ColumnId) -> Option<(f64, f64, f64)> {
    let (value, threshold) = (cells.number(measure)?, cells.number(threshold)?);
    Some((value, threshold, value / threshold - 1.0))
}

fn share(margin: f64) -> String {
    format!("{} %", brief_number((100.0 * margin).abs()))
}

/// The numbers behind a verdict.
fn verdict(cells: &Cells) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    let full = against(cells, ColumnId::VolumeRatio, ColumnId::DeployedVolumeThreshold);
    let low = against(cells, ColumnId::VolumeRatio, ColumnId::StalledVolumeThreshold);
    let high = against(cells, ColumnId::HeightRatio, ColumnId::DeployedHeightThreshold);
    let verdict = cells.text(ColumnId::Verdict);
    if let (Some((value, full, above)), Some((_, low, over))) = (full, low) {
        let mean = format!("volume_ratio {} (mean of the last tenth)", brief_number(value));
        let text = match verdict {
            "deployed" => {
                let margin = share(above);
                format!(
                    "{mean}, and never below the {full} it takes to be deployed; {margin} above"
                )
            }
            "stalled" => format!("{mean} < {low}, so it stalled; {} below", share(over)),
            _ if above >= 0.0 => {
                format!("{mean}, where it takes {full} all through that tenth to be deployed")
            }
            _ => format!(
                "{mean} < {full}, so not deployed ({} below); ≥ {low}, so not stalled ({} above)",
                share(above),
                share(over)
            ),
        };
        lines.push(("volume", text));
    }
    if let Some((value, wanted, margin)) = high {
        let (sign, word) = if margin >= 0.0 { ("≥", "above") } else { ("<", "below") };
        let (value, margin) = (brief_number(value), share(margin));
        let ratio = format!("height_ratio {value} (least of the last tenth)");
        let text = format!("{ratio} {sign} {wanted} it takes to be deployed; {margin} {word}");
        lines.push(("height", text));
    }
    let largest = REFERENCE_PRESSURES[REFERENCE_PRESSURES.len() - 1];
    if let Some(pressure) = cells.number(ColumnId::FinalPressure).filter(|own| *own > largest) {
        let text = format!(
            "static states are known up to {largest} Pa and taken as constant above; the gas ends at {} Pa",
            brief_number(pressure)
        );
        lines.push(("reference", text));
    }
    if verdict.is_empty() {
        let text = "none: the design has no static states to hold it against";
        lines.push(("verdict", text.to_owned()));
    }
    if let Some(margin) = cells.number(ColumnId::NearThresholdMargin) {
        let close = *cells.get(ColumnId::NearThreshold) == Value::Bool(true);
        let (said, would) = if close { ("yes", "would") } else { ("no", "would not") };
        let margin = share(margin);
        let change = format!("a change of the ratios by less than {margin}");
        lines.push(("threshold", format!("{said}: {change} {would} change the verdict")));
    }
    if let Some(time) = cells.number(ColumnId::TDeployed) {
        let since = format!("from {} s on both thresholds held 20 ms", brief_number(time));
        let later = if verdict == "deployed" { "" } else { "; it did not stay there" };
        lines.push(("held", format!("{since}{later}")));
    }
    lines
}

/// Where and why there is no result.
fn failure(cells: &Cells, status: Status) -> Vec<Line> {
    let what = match status {
        Status::Infeasible => "no fold pattern meets this design, so nothing was run",
        Status::Invalid => "the model refused the scene before its first step",
        Status::Panicked => "the program met a state it did not expect: a mistake in billow",
        Status::Failed(FailureKind::Unstable) => {
            "the state left all bounds: no number, or energy out of nothing"
        }
        Status::Failed(FailureKind::EnergyDrift) => {
            "the energy ledger did not balance, so what was computed is no result"
        }
        Status::Failed(FailureKind::InvertedVolume) => {
            "the enclosed volume fell to nothing or turned inside out"
        }
        Status::Failed(FailureKind::StepLimit) => {
            "it took all the steps solver.step_limit allows before its end time"
        }
        Status::Failed(FailureKind::Interpenetrated) => {
            "film passed through film, or lay through film"
        }
        Status::Pending
        | Status::Done
        | Status::Cancelled
        | Status::Paused
        | Status::NoEquilibrium => "it stopped before its end time",
    };
    let mut lines = vec![("status", format!("{status}: {what}"))];
    if let Some(time) = cells.number(ColumnId::StopTime) {
        lines.push(("time", format!("{} s", brief_number(time))));
    }
    for (about, column) in [
        ("location", ColumnId::StopLocation),
        ("reason", ColumnId::Reason),
        ("nearest", ColumnId::Nearest),
    ] {
        if !cells.text(column).is_empty() {
            let alone = if column == ColumnId::Nearest {
                " (each for a change of that key alone)"
            } else {
                ""
            };
            lines.push((about, format!("{}{alone}", cells.text(column))));
        }
    }
    lines
}

/// What to do about a failure.
fn advice(status: Status, short: &str, root: &str) -> String {
    let look = format!("billow show {short} {root} --history");
    match status {
        Status::Infeasible => {
            "take a nearest value, or leave the point out with a grid filter".to_owned()
        }
        Status::Invalid => "change the key the reason names".to_owned(),
        Status::Panicked => format!("report the reason with {root}/study.json and the job id"),
        Status::Failed(FailureKind::StepLimit) => {
            format!("{look}: where the steps went; then raise solver.step_limit")
        }
        Status::Failed(FailureKind::Unstable | FailureKind::EnergyDrift) => {
            format!("{look}; then a finer step (billow schema: solver)")
        }
        _ => look,
    }
}

/// What the audit says.
fn trust(cells: &Cells) -> Vec<Line> {
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

/// The same as keys.
fn keys(stored: &Stored<'_>, id: &JobId, cells: &Cells, lines: &[Line]) -> serde_json::Value {
    let parameters = stored.point(id).map(|point| {
        let own = point.job.parameters.iter();
        own.map(|(name, value)| (name.clone(), json_value(value))).collect::<Map<_, _>>()
    });
    let checks: Vec<serde_json::Value> = [
        (ColumnId::VolumeRatio, ColumnId::DeployedVolumeThreshold),
        (ColumnId::HeightRatio, ColumnId::DeployedHeightThreshold),
        (ColumnId::VolumeRatio, ColumnId::StalledVolumeThreshold),
    ]
    .into_iter()
    .filter_map(|(measure, threshold)| {
        let (value, least, margin) = against(cells, measure, threshold)?;
        Some(json!({
            "measure": measure.name(), "value": value, "threshold": threshold.name(),
            "least": least, "margin": margin,
        }))
    })
    .collect();
    let mut keys = json!({
        "job": id.as_str(),
        "parameters": parameters,
        "ledger_bound": MAX_LEDGER_RESIDUAL,
        "checks": checks,
        "why": lines.iter().map(|(about, text)| format!("{about}: {text}")).collect::<Vec<_>>(),
    });
    for column in [
        ColumnId::Status,
        ColumnId::Verdict,
        ColumnId::NearThreshold,
        ColumnId::NearThresholdMargin,
        ColumnId::Reason,
        ColumnId::Nearest,
        ColumnId::StopTime,
        ColumnId::StopLocation,
        ColumnId::LedgerResidual,
        ColumnId::GasResidual,
        ColumnId::Passages,
        ColumnId::Intersections,
    ] {
        keys[column.name()] = json_value(cells.get(column));
    }
    keys
}
