//! The numbers behind a verdict: ratios of the last tenth of the run against their thresholds.

use billow_solver::output::measures::Verdict;
use serde_json::json;

use super::{Line, percent};
use crate::input::value::{Value, brief_number};
use crate::job::row::{Cells, ColumnId};

/// Measures and thresholds that decide the verdict.
const CHECKS: [[ColumnId; 2]; 3] = [
    [ColumnId::VolumeRatio, ColumnId::DeployedVolumeThreshold],
    [ColumnId::HeightRatio, ColumnId::DeployedHeightThreshold],
    [ColumnId::VolumeRatio, ColumnId::StalledVolumeThreshold],
];

/// A measure compared with its threshold.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Check {
    value: f64,
    threshold: f64,
    /// value / threshold − 1.
    margin: f64,
}

impl Check {
    fn of(cells: &Cells, [measure, threshold]: [ColumnId; 2]) -> Option<Self> {
        let (value, threshold) = (cells.number(measure)?, cells.number(threshold)?);
        Some(Self { value, threshold, margin: value / threshold - 1.0 })
    }
}

/// Whether the verdict is deployed.
pub(super) fn is_deployed(cells: &Cells) -> bool {
    cells.verdict() == Some(Verdict::Deployed)
}

/// Whether a small change of the ratios would change the verdict.
pub(super) fn is_near_threshold(cells: &Cells) -> bool {
    *cells.get(ColumnId::NearThreshold) == Value::Bool(true)
}

/// The checks as JSON.
pub(super) fn checks(cells: &Cells) -> Vec<serde_json::Value> {
    let check = |[measure, threshold]: [ColumnId; 2]| {
        let check = Check::of(cells, [measure, threshold])?;
        Some(json!({
            "measure": measure.name(), "value": check.value, "threshold": threshold.name(),
            "least": check.threshold, "margin": check.margin,
        }))
    };
    CHECKS.into_iter().filter_map(check).collect()
}

/// The lines that explain a verdict.
pub(super) fn explanation(cells: &Cells) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    let verdict = cells.verdict();
    lines.extend(volume(cells, verdict).map(|text| ("volume", text)));
    lines.extend(height(cells).map(|text| ("height", text)));
    lines.extend(reference(cells).map(|text| ("reference", text)));
    if verdict.is_none() {
        let reason = cells.text(ColumnId::Reason);
        let reason = reason.strip_prefix("no verdict: ").unwrap_or(reason);
        let text = if reason.is_empty() { "the run was not compared" } else { reason };
        lines.push(("verdict", format!("none: {text}")));
    }
    lines.extend(near_threshold(cells).map(|text| ("near", text)));
    if let Some(time) = cells.number(ColumnId::TDeployed) {
        let since =
            format!("smoothed volume and height at both thresholds at {} s", brief_number(time));
        let later = if is_deployed(cells) { "" } else { ", but not until the end" };
        lines.push(("deployed", format!("{since}{later}")));
    }
    lines
}

fn volume(cells: &Cells, verdict: Option<Verdict>) -> Option<String> {
    let deployed = Check::of(cells, CHECKS[0])?;
    let stalled = Check::of(cells, CHECKS[2])?;
    let mean = format!("volume_ratio {} (mean of the last tenth)", brief_number(deployed.value));
    let (least, low) = (deployed.threshold, stalled.threshold);
    Some(if verdict == Some(Verdict::Deployed) {
        let margin = percent(deployed.margin);
        format!(
            "{mean} ≥ {least}, at every sample of that tenth: deployed; the mean is {margin} above"
        )
    } else if verdict == Some(Verdict::Stalled) {
        format!("{mean} < {low}: stalled; {} below", percent(stalled.margin))
    } else if deployed.margin >= 0.0 {
        format!("{mean} ≥ {least}, but not at every sample of that tenth: not deployed")
    } else {
        format!(
            "{mean} < {least}: not deployed ({} below); ≥ {low}: not stalled ({} above)",
            percent(deployed.margin),
            percent(stalled.margin)
        )
    })
}

fn height(cells: &Cells) -> Option<String> {
    let check = Check::of(cells, CHECKS[1])?;
    let (sign, word) = if check.margin >= 0.0 { ("≥", "above") } else { ("<", "below") };
    Some(format!(
        "height_ratio {} (least of the last tenth) {sign} {}, the threshold of deployed; {} {word}",
        brief_number(check.value),
        check.threshold,
        percent(check.margin)
    ))
}

/// The static equilibrium that the run is compared with.
fn reference(cells: &Cells) -> Option<String> {
    let number = |column| cells.number(column);
    let reference = number(ColumnId::ReferenceOverpressure)?;
    let (volume, height) = (number(ColumnId::ReferenceVolume)?, number(ColumnId::ReferenceHeight)?);
    let shape = format!("{} m3 and {} m", brief_number(volume), brief_number(height));
    let last = number(ColumnId::FinalOverpressure)?;
    Some(if last < reference {
        format!(
            "static equilibrium at {} Pa, the lowest one computed: {shape}; the final overpressure is {} Pa, \
             at which the shape is nearly the same",
            brief_number(reference),
            brief_number(last)
        )
    } else {
        format!(
            "static equilibrium at {} Pa, the mean overpressure of the last tenth: {shape}",
            brief_number(reference)
        )
    })
}

fn near_threshold(cells: &Cells) -> Option<String> {
    let margin = percent(cells.number(ColumnId::NearThresholdMargin)?);
    let (answer, would) =
        if is_near_threshold(cells) { ("yes", "would") } else { ("no", "would not") };
    let change = format!("a change of the ratios by less than {margin}");
    Some(format!("{answer}: {change} {would} change the verdict"))
}
