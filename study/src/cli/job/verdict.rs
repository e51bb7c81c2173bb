//! The numbers behind a verdict: ratios of the last tenth of the run against their thresholds.

use crate::platform::quote;
use billow_solver::output::measures::Verdict;

use super::{Inspected, percent};
use crate::input::value::{Value, brief_number};
use crate::job::row::{Cells, ColumnId};
use crate::print::TopicLine;

/// Relative change of the volume over the last tenth of a run above which the film still moves. Chosen:
/// well above the ringing of a deployed capsule.
const MIN_GROWTH: f64 = 0.02;
/// Mean kinetic energy of the last tenth of a run, over the largest one of the run, above which the film
/// still moves. Chosen as [`MIN_GROWTH`].
const MIN_MOTION: f64 = 0.05;

/// Measures and thresholds that decide the verdict.
const CHECKS: [[ColumnId; 2]; 3] = [
    [ColumnId::VolumeRatio, ColumnId::DeployedVolumeThreshold],
    [ColumnId::HeightRatio, ColumnId::DeployedHeightThreshold],
    [ColumnId::VolumeRatio, ColumnId::StalledVolumeThreshold],
];

/// A measure, its threshold, and the margin: measure / threshold − 1.
fn check(cells: &Cells, [measure, threshold]: [ColumnId; 2]) -> Option<[f64; 3]> {
    let (value, threshold) = (cells.number(measure)?, cells.number(threshold)?);
    Some([value, threshold, value / threshold - 1.0])
}

/// Whether a small change of the ratios would change the verdict.
pub(super) fn is_near_threshold(cells: &Cells) -> bool {
    *cells.get(ColumnId::NearThreshold) == Value::Bool(true)
}

/// Lines and next step of a job that reached its end time.
pub(super) fn explanation(job: &Inspected) -> (Vec<TopicLine>, String) {
    let cells = &job.cells;
    let is_deployed = cells.verdict() == Some(Verdict::Deployed);
    let mut lines: Vec<TopicLine> = Vec::new();
    lines.extend(volume(cells).map(|text| ("volume", text)));
    lines.extend(height(cells).map(|text| ("height", text)));
    lines.extend(reference(cells).map(|text| ("reference", text)));
    if cells.verdict().is_none() {
        let reason = cells.text(ColumnId::Reason);
        let reason = reason.strip_prefix("no verdict: ").unwrap_or(reason);
        let text = if reason.is_empty() { "the run was not compared" } else { reason };
        lines.push(("verdict", format!("none: {text}")));
    }
    if let Some(margin) = cells.number(ColumnId::NearThresholdMargin).map(percent) {
        let near = is_near_threshold(cells);
        let (answer, would) = if near { ("yes", "would") } else { ("no", "would not") };
        let change = format!("a change of the ratios by less than {margin}");
        lines.push(("near", format!("{answer}: {change} {would} change the verdict")));
    }
    if let Some(time) = cells.number(ColumnId::TDeployed).map(brief_number) {
        let later = if is_deployed { "" } else { ", but not until the end" };
        let what = if has_rings(cells) {
            "smoothed volume and height at both thresholds"
        } else {
            "smoothed volume at its threshold"
        };
        let text = format!("{what} at {time} s{later}");
        lines.push(("deployed", text));
    }
    if let Some(moving) = (!is_deployed).then(|| motion_at_the_end(job)).flatten() {
        lines.push(("motion", moving));
        let next = "a longer solver.end_time: the film was still moving at the end of the run";
        return (lines, next.to_owned());
    }
    let root = quote::path(job.stored.results.root());
    (lines, format!("billow job {} {root} --history", job.id.short()))
}

fn volume(cells: &Cells) -> Option<String> {
    let [value, least, above] = check(cells, CHECKS[0])?;
    let [_, low, above_low] = check(cells, CHECKS[2])?;
    let mean = format!("volume_ratio {} (mean of the last tenth)", brief_number(value));
    let (margin, low_margin) = (percent(above), percent(above_low));
    Some(match cells.verdict() {
        Some(Verdict::Deployed) => format!(
            "{mean} ≥ {least}, at every sample of that tenth: deployed; the mean is {margin} above"
        ),
        Some(Verdict::Stalled) => format!("{mean} < {low}: stalled; {low_margin} below"),
        _ if above >= 0.0 => {
            format!("{mean} ≥ {least}, but not at every sample of that tenth: not deployed")
        }
        _ => format!(
            "{mean} < {least}: not deployed ({margin} below); ≥ {low}: not stalled ({low_margin} above)"
        ),
    })
}

fn height(cells: &Cells) -> Option<String> {
    let [value, least, margin] = check(cells, CHECKS[1])?;
    let (sign, word) = if margin >= 0.0 { ("≥", "above") } else { ("<", "below") };
    let (value, margin) = (brief_number(value), percent(margin));
    if !has_rings(cells) {
        return Some(format!(
            "height_ratio {value} (least of the last tenth); it decides nothing: film that is no capsule may turn"
        ));
    }
    Some(format!(
        "height_ratio {value} (least of the last tenth) {sign} {least}, the threshold of deployed; {margin} {word}"
    ))
}

/// Whether the film has rings: a capsule.
fn has_rings(cells: &Cells) -> bool {
    cells.number(ColumnId::FinalZRim).is_some()
}

/// The static equilibrium that the run is compared with.
fn reference(cells: &Cells) -> Option<String> {
    let pressure = cells.number(ColumnId::ReferenceOverpressure)?;
    let last = cells.number(ColumnId::FinalOverpressure)?;
    let volume = brief_number(cells.number(ColumnId::ReferenceVolume)?);
    let height = brief_number(cells.number(ColumnId::ReferenceHeight)?);
    let (shape, shown) = (format!("{volume} m3 and {height} m"), brief_number(pressure));
    Some(if last < pressure {
        format!(
            "static equilibrium at {shown} Pa, the lowest one computed: {shape}; the final overpressure is {} Pa, \
             at which the shape is nearly the same",
            brief_number(last)
        )
    } else {
        format!(
            "static equilibrium at {shown} Pa, the mean overpressure of the last tenth: {shape}"
        )
    })
}

/// How a job moved in the last tenth of its run; `None` when it did not, or has no history.
fn motion_at_the_end(job: &Inspected) -> Option<String> {
    job.stored.record(&job.id)?.file_hash.as_ref()?;
    let history = match job.history() {
        Ok(stored) => stored.history,
        Err(error) => return Some(format!("unknown: {error}").replace("\n  next: ", "; next: ")),
    };
    let [time, volume, energy] =
        ["time", "volume", "kinetic_energy"].map(|name| history.column(name));
    let end = time.last()?;
    let start = time.partition_point(|sample| *sample < 0.9 * end);
    let growth = 1.0 - volume.get(start)? / volume.last()?;
    let largest = energy.iter().copied().fold(0.0, f64::max);
    let tenth = &energy[start..];
    let motion = tenth.iter().sum::<f64>() / (tenth.len() as f64 * largest);
    (growth.abs() > MIN_GROWTH || motion > MIN_MOTION).then(|| {
        let (growth, motion) = (brief_number(100.0 * growth), percent(motion));
        format!(
            "in the last tenth the volume changed by {growth} %; mean kinetic energy {motion} of its largest value"
        )
    })
}
