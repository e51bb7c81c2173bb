//! Lines of the answer on samples: how probable it is that a point is safe, quantiles, and what makes the spread.

use std::fmt::Write as _;

use super::{parameters_text, short_id};
use crate::analysis::answer::{Importance, MESH, MIN_SEEN, Part, Quantile, Tolerance};
use crate::input::units::DisplayUnit;
use crate::input::value::brief_number;
use crate::job::proportion::Proportion;
use crate::print::{MAX_VALUES, count};

/// Part of a spread below which an input is only named.
const MIN_SHOWN_PART: f64 = 0.01;

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
        let job = short_id(job);
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
        if !spread.inputs.parts.is_empty() {
            let _ = write!(text, "; their spread is made by {}", importance(&spread.inputs));
        }
        let deviation = spread.shown.of_difference().brief(spread.deviation);
        let _ = write!(
            text,
            "; standard deviation with all uncertainty {deviation}: {}",
            parts(&spread.budget)
        );
        if spread.budget.first().is_some_and(|largest| largest.name == MESH) {
            text.push_str(" (more samples do not narrow it)");
        }
        for reason in &spread.without {
            let _ = write!(text, "; {reason}");
        }
        text
    });
    let measures: Vec<String> = measures.collect();
    [vec![text], measures].concat()
}

/// "safe with a probability of 75 to 92 % (55 of 64 samples safe, 6 unsafe, 3 within their uncertainty; the values of 57 keep
/// the limits)".
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
    if within > 0 {
        let _ = write!(text, "; the values of {} keep the limits", point.kept);
    }
    text.push(')');
    text
}

/// For each measure of a grid a line.
pub(super) fn of_grid(measures: &[(String, Importance)]) -> Vec<String> {
    let line = |(name, found): &(String, Importance)| {
        format!("the spread of {name} is made by {}", importance(found))
    };
    measures.iter().map(line).collect()
}

/// "thickness 63 % (45 to 81), with others 70 % (66 to 75); … (a surrogate foresees 93 % of the variance of …)".
fn importance(found: &Importance) -> String {
    let (shown, small): (Vec<&Part>, Vec<&Part>) = found.parts.iter().partition(|part| {
        let largest = part.total.map_or(part.part, |(total, _)| total);
        largest >= MIN_SHOWN_PART || part.between.is_none()
    });
    let mut texts: Vec<String> = shown.into_iter().map(part).collect();
    if !small.is_empty() {
        let names: Vec<&str> = small.iter().map(|part| part.name.as_str()).collect();
        texts.push(format!("below 1 % {}", names.join(", ")));
    }
    let percent = |seen: f64| format!("{:.0} %", 100.0 * seen.max(0.0));
    let why = match (found.seen, found.indices) {
        (Some(seen), true) => format!("a surrogate foresees {} at points left out", percent(seen)),
        (Some(seen), false) if seen < MIN_SEEN => {
            format!("ranks: a surrogate foresees only {} at points left out", percent(seen))
        }
        _ => "ranks".to_owned(),
    };
    format!("{} ({why})", texts.join(", "))
}

fn parts(parts: &[Part]) -> String {
    parts.iter().map(part).collect::<Vec<_>>().join(", ")
}

/// "thickness 63 % (45 to 81)", "thickness 63 % (45 to 81), with others 70 % (66 to 75)".
fn part(part: &Part) -> String {
    let percent = |part: f64| format!("{:.0}", 100.0 * part);
    let of = |value: f64, between: Option<[f64; 2]>| {
        let between = between.map_or_else(String::new, |[low, high]| {
            format!(" ({} to {})", percent(low), percent(high))
        });
        format!("{} %{between}", percent(value))
    };
    let total =
        part.total.map(|(total, between)| format!(" and with others {}", of(total, Some(between))));
    format!("{} {}{}", part.name, of(part.part, part.between), total.unwrap_or_default())
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
