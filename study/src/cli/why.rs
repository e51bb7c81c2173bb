//! `billow why`: why a job ended as it did, in plain words.

use std::io::Write;
use std::path::PathBuf;

use billow_solver::audit::RESIDUAL_BOUND;
use serde_json::{Map, json};

use super::print::print_rows;
use super::target::folder;
use super::{Format, Global, output_error};
use crate::error::Result;
use crate::files::Disk;
use crate::job::JobId;
use crate::results::Results;
use crate::row::{self, Cells};
use crate::stored::Stored;
use crate::summary;
use crate::value::{Value, brief_number, json_value};

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
    let root = folder(args.study.as_deref(), global)?;
    let stored = Stored::read(Results::new(&Disk, &root))?;
    let id = stored.job(&args.job)?;
    let cells = match (stored.point(&id), stored.record(&id)) {
        (Some(point), _) => stored.cells(point),
        (None, Some(record)) => record.cells.clone(),
        (None, None) => Cells::new(row::PENDING),
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

fn headline(cells: &Cells) -> String {
    let close = if *cells.get("close") == Value::Bool(true) { ", close" } else { "" };
    match cells.text("verdict") {
        "" => cells.status().to_owned(),
        verdict => format!("{}, {verdict}{close}", cells.status()),
    }
}

/// All there is to say.
fn reasons(stored: &Stored<'_>, id: &JobId, cells: &Cells) -> Result<Vec<Line>> {
    let mut lines: Vec<Line> = Vec::new();
    let root = stored.results.root().display();
    let short = id.short();
    let next = match cells.status() {
        row::DONE => {
            lines.extend(verdict(cells));
            format!("billow show {short} {root} --history")
        }
        row::PENDING => {
            let withdrawn = stored.journal.withdrawn.contains_key(id);
            let said = if withdrawn {
                "withdrawn to be run again, and not run yet"
            } else {
                "not run yet"
            };
            lines.push(("status", said.to_owned()));
            format!("billow run of its study, or billow rerun {short} {root}")
        }
        status => {
            lines.extend(failure(cells, status));
            advice(status, short, &root.to_string())
        }
    };
    lines.extend(trust(cells));
    if stored.point(id).is_none() {
        lines.push(("study", "the study as it is now does not have this job".to_owned()));
    }
    if let Some(record) = stored.journal.records.get(id)
        && let Some(damage) = stored.results.damage(record)?
    {
        lines.push(("file", format!("{damage}: billow doctor {root}")));
    }
    lines.push(("next", next));
    Ok(lines)
}

fn number(cells: &Cells, name: &str) -> Option<f64> {
    if let Value::Number(number) = cells.get(name) { Some(*number) } else { None }
}

/// A ratio against its threshold: measure, value, threshold, relative margin.
fn against(cells: &Cells, measure: &str, threshold: &str) -> Option<(f64, f64, f64)> {
    let (value, threshold) = (number(cells, measure)?, number(cells, threshold)?);
    Some((value, threshold, value / threshold - 1.0))
}

fn share(margin: f64) -> String {
    format!("{} %", brief_number((100.0 * margin).abs()))
}

/// The numbers behind a verdict.
fn verdict(cells: &Cells) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    let full = against(cells, "volume_ratio", "deployed_volume_threshold");
    let low = against(cells, "volume_ratio", "stalled_volume_threshold");
    let high = against(cells, "height_ratio", "deployed_height_threshold");
    let verdict = cells.text("verdict");
    if let (Some((value, full, above)), Some((_, low, over))) = (full, low) {
        let value = format!("volume_ratio {}", brief_number(value));
        lines.push(("volume", match verdict {
            "deployed" => format!("{value} (mean of the last tenth of the run), and never below the {full} a deployed capsule needs; margin of the mean {}", share(above)),
            "stalled" => format!("{value} < {low}: below that a run is stalled; missed by {}", share(over)),
            _ if above >= 0.0 => format!("{value} on the mean of the last tenth reaches {full}, but a deployed capsule keeps it throughout"),
            _ => format!("{value} ≥ {low}, so not stalled ({} above); < {full}, so not deployed ({} below)", share(over), share(above)),
        }));
    }
    if let Some((value, wanted, margin)) = high {
        let (sign, word) = if margin >= 0.0 { ("≥", "above") } else { ("<", "below") };
        let value = brief_number(value);
        lines.push(("height", format!("height_ratio {value} {sign} {wanted} that a deployed capsule needs, {} {word} (least of the last tenth)", share(margin))));
    }
    if verdict.is_empty() {
        lines.push((
            "verdict",
            "none: the design has no static states to hold it against".to_owned(),
        ));
    }
    if let Some(margin) = number(cells, "close_margin") {
        let close = *cells.get("close") == Value::Bool(true);
        let would = if close { "would" } else { "would not" };
        lines.push((
            "close",
            format!(
                "{}: a change of the ratios by less than {} {would} change the verdict",
                if close { "yes" } else { "no" },
                share(margin)
            ),
        ));
    }
    if let Some(time) = number(cells, "t_deployed") {
        lines.push(("deployed", format!("from {} s on, held 20 ms", brief_number(time))));
    }
    lines
}

/// Where and why there is no result.
fn failure(cells: &Cells, status: &str) -> Vec<Line> {
    let what = match status {
        row::INFEASIBLE => "no fold pattern meets this design, so nothing was run",
        row::INVALID => "the model refused the scene before its first step",
        row::PANICKED => "the program met a state it did not expect: a mistake in billow",
        "unstable" => "the state left all bounds: no number, or energy out of nothing",
        "drifted" => "the energy ledger did not balance, so what was computed is no result",
        "inverted_volume" => "the enclosed volume fell to nothing or turned inside out",
        "step_limit" => "it took all the steps solver.step_limit allows before its end time",
        "interpenetrated" => "film passed through film, or lay through film",
        _ => "it stopped before its end time",
    };
    let mut lines = vec![("status", format!("{status}: {what}"))];
    if let Some(time) = number(cells, "stop_time") {
        lines.push(("time", format!("{} s", brief_number(time))));
    }
    for (about, name) in [("place", "stop_place"), ("reason", "reason"), ("nearest", "nearest")] {
        if !cells.text(name).is_empty() {
            let alone =
                if name == "nearest" { " (each for a change of that key alone)" } else { "" };
            lines.push((about, format!("{}{alone}", cells.text(name))));
        }
    }
    lines
}

/// What to do about a failure.
fn advice(status: &str, short: &str, root: &str) -> String {
    match status {
        row::INFEASIBLE => {
            "take a nearest value, or leave the point out with a grid filter".to_owned()
        }
        row::INVALID => "change the key the reason names".to_owned(),
        row::PANICKED => format!("report the reason with {root}/study.json and the job id"),
        "step_limit" => {
            "look where the steps went (billow show JOB --history), then raise solver.step_limit"
                .to_owned()
        }
        "unstable" | "drifted" => format!(
            "billow show {short} {root} --history; then a finer step (billow schema: solver)"
        ),
        _ => format!("billow show {short} {root} --history"),
    }
}

/// What the audit says.
fn trust(cells: &Cells) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    if let Some(residual) = number(cells, "ledger_residual") {
        let sign = if residual <= RESIDUAL_BOUND { "≤" } else { ">" };
        let gas = number(cells, "gas_residual")
            .map_or_else(String::new, |gas| format!("; gas balance {}", brief_number(gas)));
        lines.push((
            "ledger",
            format!("largest residual {} {sign} {RESIDUAL_BOUND}{gas}", brief_number(residual)),
        ));
        let count = |name: &str| match cells.get(name) {
            Value::Null => "not counted by this model".to_owned(),
            own => own.to_string(),
        };
        let (passages, intersections) = (count("passages"), count("intersections"));
        lines.push((
            "film",
            if passages == intersections && passages.starts_with("not") {
                format!("passages and intersections {passages}")
            } else {
                format!("passages {passages}, intersections {intersections}")
            },
        ));
    }
    lines
}

/// The same as keys.
fn keys(stored: &Stored<'_>, id: &JobId, cells: &Cells, lines: &[Line]) -> serde_json::Value {
    let parameters = stored.point(id).map(|point| {
        let own = point.job.parameters.iter();
        own.map(|(name, value)| (name.clone(), json_value(value))).collect::<Map<_, _>>()
    });
    let checks: Vec<serde_json::Value> = [
        ("volume_ratio", "deployed_volume_threshold"),
        ("height_ratio", "deployed_height_threshold"),
        ("volume_ratio", "stalled_volume_threshold"),
    ]
    .into_iter()
    .filter_map(|(measure, threshold)| {
        let (value, least, margin) = against(cells, measure, threshold)?;
        Some(json!({
            "measure": measure, "value": value, "threshold": threshold, "least": least,
            "margin": margin,
        }))
    })
    .collect();
    let mut keys = json!({
        "job": id.as_str(),
        "parameters": parameters,
        "ledger_bound": RESIDUAL_BOUND,
        "checks": checks,
        "why": lines.iter().map(|(about, text)| format!("{about}: {text}")).collect::<Vec<_>>(),
    });
    for name in [
        "status",
        "verdict",
        "close",
        "close_margin",
        "reason",
        "nearest",
        "stop_time",
        "stop_place",
        "ledger_residual",
        "gas_residual",
        "passages",
        "intersections",
    ] {
        keys[name] = json_value(cells.get(name));
    }
    keys
}
