//! Lines of the answer on samples: how probable it is that a point is safe, quantiles, and what makes the spread.

use std::fmt::Write as _;

use super::parameters_text;
use crate::analysis::answer::{MESH, Part, Quantile, Tolerance};
use crate::input::units::DisplayUnit;
use crate::input::value::brief_number;
use crate::job::proportion::Proportion;
use crate::print::{MAX_VALUES, count};

/// For each point a line, then one for each measure.
pub(super) fn lines(points: &[Tolerance]) -> Vec<String> {
    let mut lines: Vec<String> = points.iter().take(MAX_VALUES).flat_map(of_point).collect();
    if points.len() > MAX_VALUES {
        lines.push(format!("and {} more", count(points.len() - MAX_VALUES, "point")));
    }
    lines
}

fn of_point(point: &Tolerance) -> Vec<String> {
    let mut text = parameters_text(&point.parameters);
    if !text.is_empty() {
        text.push_str(": ");
    }
    if point.safe.of > 0 {
        text.push_str(&probability(point));
    } else {
        let _ = write!(text, "{}", count(point.samples, "sample"));
    }
    if let Some((job, margin, measure)) = &point.nearest {
        let job = &job[..8.min(job.len())];
        let _ = write!(
            text,
            "; smallest margin {} % of {measure}: job {job}",
            brief_number(100.0 * margin)
        );
    }
    let measures = point.measures.iter().map(|spread| {
        let quantiles: Vec<String> =
            spread.quantiles.iter().map(|one| quantile(one, &spread.shown)).collect();
        let mut text = format!("  {}: {} of the samples", spread.measure, quantiles.join(", "));
        if !spread.inputs.is_empty() {
            let _ = write!(text, "; their spread is made by {}", parts(&spread.inputs));
        }
        let deviation = spread.shown.of_difference().brief(spread.deviation);
        let _ = write!(
            text,
            "; standard deviation with all uncertainty {deviation}: {}",
            parts(&spread.budget)
        );
        if spread.budget.first().is_some_and(|largest| largest.name == MESH) {
            text.push_str(" (a finer mesh narrows it, more samples do not)");
        }
        for reason in &spread.without {
            let _ = write!(text, "; {reason}");
        }
        text
    });
    let measures: Vec<String> = measures.collect();
    [vec![text], measures].concat()
}

/// "safe with a probability of 75 to 92 % (55 of 64 samples safe, 6 unsafe, 3 within their uncertainty)".
pub(super) fn probability(point: &Tolerance) -> String {
    let [low, high] = point.safe_between.map(|end| 100.0 * end);
    let Proportion { met, of } = point.safe;
    let noun = match point.samples {
        samples if samples == of => "samples".to_owned(),
        samples => format!("runs of {samples} samples"),
    };
    let within = of - met - point.not_safe - point.without_result;
    let mut text =
        format!("safe with a probability of {low:.0} to {high:.0} % ({met} of {of} {noun} safe");
    for (number, what) in [
        (point.not_safe, "unsafe"),
        (within, "within their uncertainty"),
        (point.without_result, "without a result"),
    ] {
        if number > 0 {
            let _ = write!(text, ", {number} {what}");
        }
    }
    text.push(')');
    text
}

/// "thickness 63 % (45 to 81), friction 2 % (0 to 6)".
fn parts(parts: &[Part]) -> String {
    let percent = |part: f64| format!("{:.0}", 100.0 * part);
    let text = |part: &Part| {
        let between = part.between.map_or_else(String::new, |[low, high]| {
            format!(" ({} to {})", percent(low), percent(high))
        });
        format!("{} {} %{between}", part.name, percent(part.part))
    };
    parts.iter().map(text).collect::<Vec<_>>().join(", ")
}

/// "95 % below 24.1 m/s (22.8 to 27)".
fn quantile(one: &Quantile, unit: &DisplayUnit) -> String {
    let ends = match one.between {
        [Some(low), Some(high)] => format!("{} to {}", end(low, unit), end(high, unit)),
        [None, Some(high)] => format!("at most {}", end(high, unit)),
        [Some(low), None] => format!("at least {}", end(low, unit)),
        [None, None] => "too few samples".to_owned(),
    };
    format!("{} % below {} ({ends})", brief_number(100.0 * one.p), unit.brief(one.value))
}

fn end(si: f64, unit: &DisplayUnit) -> String {
    brief_number(unit.number(si))
}
