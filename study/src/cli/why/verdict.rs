//! The numbers behind a verdict: ratios of the last tenth of the run against their thresholds.

use billow_solver::output::measures::{REFERENCE_PRESSURES, Verdict};
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
        let text = "none: this design has no static states to compare with";
        lines.push(("verdict", text.to_owned()));
    }
    lines.extend(near_threshold(cells).map(|text| ("near", text)));
    if let Some(time) = cells.number(ColumnId::TDeployed) {
        let since =
            format!("both thresholds reached at {} s and kept for 20 ms", brief_number(time));
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
        format!("{mean} ≥ {least}, at every sample of that tenth: deployed; {margin} above")
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

/// A note when the final pressure is above the largest pressure of the static states.
fn reference(cells: &Cells) -> Option<String> {
    let largest = REFERENCE_PRESSURES[REFERENCE_PRESSURES.len() - 1];
    let pressure = cells.number(ColumnId::FinalPressure).filter(|pressure| *pressure > largest)?;
    Some(format!(
        "static states are computed up to {largest} Pa and taken as constant above; the final \
         pressure is {} Pa",
        brief_number(pressure)
    ))
}

fn near_threshold(cells: &Cells) -> Option<String> {
    let margin = percent(cells.number(ColumnId::NearThresholdMargin)?);
    let (answer, would) =
        if is_near_threshold(cells) { ("yes", "would") } else { ("no", "would not") };
    let change = format!("a change of the ratios by less than {margin}");
    Some(format!("{answer}: {change} {would} change the verdict"))
}
