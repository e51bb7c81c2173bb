//! The best and the worst value of each parameter by the headline measures, and what is not compared.

use std::fmt::Write as _;

use crate::analysis::answer::{Effect, Effects, Extremes, MeasureEffect};
use crate::analysis::compare::{Tolerance, ToleranceSource};
use crate::input::value::{Value, brief_number};
use crate::job::row::HEADLINE;
use crate::store::table::Table;
use crate::study::Study;

/// Most characters in a line.
pub const MAX_LINE_WIDTH: usize = 120;
/// Most values of a parameter that a line names. Chosen: more values need a chart.
pub const MAX_VALUES: usize = 6;

/// Prints on stderr the best and the worst value of each parameter that varies in some rows of a table. With limits
/// the safest values are the best ones, and of a search its border: `billow rank`, `billow borders`.
pub fn print(study: Option<&Study>, table: &Table, rows: &[usize]) {
    // A table without its study cannot say which parameters change together.
    let has_best = |study: &&Study| study.result_limits().is_empty() && study.searched().is_none();
    let Some(study) = study.filter(has_best) else { return };
    let effects =
        Effects::of(table, rows, &study.replicates(), &HEADLINE, &|name| study.zipped_with(name));
    for text in lines(&effects) {
        let mut topic = "best:";
        for line in wrapped(&text, 6) {
            eprintln!("{topic:<5} {line}");
            topic = "";
        }
    }
}

/// One line per parameter, without indentation: for each measure the best and the worst value, with their
/// medians.
pub fn lines(effects: &Effects) -> Vec<String> {
    effects.effects.iter().map(line).collect()
}

fn line(effect: &Effect) -> String {
    let mut parts: Vec<String> =
        effect.measures.iter().map(|measure| part(effect, measure)).collect();
    parts.extend(partly_deployed(effect));
    let sets: Vec<usize> = effect.measures.iter().map(|measure| measure.sets).collect();
    let mut line = format!("{}: {}", effect.parameter, parts.join("; "));
    if let (Some(least), Some(most)) = (sets.iter().min(), sets.iter().max()) {
        let range = if least == most { most.to_string() } else { format!("{least} to {most}") };
        let _ = write!(line, "; over {range} set{}", if *most == 1 { "" } else { "s" });
    }
    line
}

/// One measure: its best and worst values.
fn part(effect: &Effect, measure: &MeasureEffect) -> String {
    let name = measure.measure.name();
    // The extreme value with its median, then the values that are equal to it.
    let shown = |indices: &[usize], mark: &str| {
        let texts: Vec<String> = indices
            .iter()
            .take(MAX_VALUES)
            .map(|index| effect.shown.quantity(&effect.values[*index]))
            .collect();
        let more = indices.len() - texts.len();
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let median = indices.first().and_then(|index| measure.medians[*index]);
        let median = median.map_or_else(|| "-".to_owned(), |median| measure.shown.brief(median));
        format!("{}{more} {median} ({mark})", texts.join(", "))
    };
    match &measure.extremes {
        Extremes::Equal if !is_within(measure) => {
            format!("{name} equal within the ranges of the runs")
        }
        Extremes::Equal => format!("{name} equal within {}", within(&measure.tolerance)),
        Extremes::Range { lowest, highest } => {
            format!("{name} {}, {}", shown(lowest, "lowest"), shown(highest, "highest"))
        }
        Extremes::Judged { best, worst } if best.is_empty() => {
            format!("{name} {}, no best: no value always deploys", shown(worst, "worst"))
        }
        Extremes::Judged { best, worst } if best.first() == worst.first() => {
            format!("{name} {}", shown(best, "worst, but no other value always deploys"))
        }
        Extremes::Judged { best, worst } => {
            format!("{name} {}, {}", shown(best, "best"), shown(worst, "worst"))
        }
    }
}

/// The values that do not deploy in every job.
fn partly_deployed(effect: &Effect) -> Option<String> {
    let partly = effect.values.iter().zip(&effect.deployed);
    let mut texts: Vec<String> = partly
        .filter(|(_, (deployed, jobs))| deployed < jobs)
        .map(|(value, (deployed, jobs))| {
            format!("{} {deployed} of {jobs}", effect.shown.quantity(value))
        })
        .collect();
    let more = texts.len().saturating_sub(MAX_VALUES);
    texts.truncate(MAX_VALUES);
    if more > 0 {
        texts.push(format!("and {more} more values not always"));
    }
    (!texts.is_empty()).then(|| format!("deployed and trusted: {}", texts.join(", ")))
}

/// What is not compared, and why: parameters, and values of a parameter.
pub fn left_out(effects: &Effects) -> Vec<String> {
    let mut lines: Vec<String> = effects
        .not_compared
        .iter()
        .map(|(parameter, reason)| format!("{parameter}: {reason}"))
        .collect();
    for effect in &effects.effects {
        // One line per value and reason, with the measures concerned.
        let mut reasons: Vec<(&Option<Value>, &str, Vec<&str>)> = Vec::new();
        for (value, measure, reason) in &effect.left_out {
            match reasons.iter_mut().find(|(known, text, _)| *known == value && text == reason) {
                Some((_, _, measures)) => measures.push(measure.name()),
                None => reasons.push((value, reason, vec![measure.name()])),
            }
        }
        // Of many values, as those of a search, the number says enough.
        let listed = if effect.values.len() > MAX_VALUES { 0 } else { MAX_VALUES };
        let more = reasons.len().saturating_sub(listed);
        lines.extend(reasons.iter().take(listed).map(|(value, reason, measures)| {
            let value = value.as_ref().map(|value| format!(" {}", effect.shown.quantity(value)));
            let value = value.unwrap_or_default();
            format!("{}{value} in {}: {reason}", effect.parameter, measures.join(", "))
        }));
        if more > 0 {
            let name = &effect.parameter;
            lines.push(match listed {
                0 => format!(
                    "{name}: {more} of its {} values (--json lists them)",
                    effect.values.len()
                ),
                _ => format!("{name}: {more} more values (--json lists them)"),
            });
        }
    }
    lines
}

/// Whether all medians are within the tolerance of the measure.
fn is_within(measure: &MeasureEffect) -> bool {
    let medians = || measure.medians.iter().flatten().copied();
    let ends = medians().reduce(f64::min).zip(medians().reduce(f64::max));
    ends.is_none_or(|(least, largest)| measure.tolerance.is_tie(least, largest))
}

/// Within what values are equal. Mesh errors differ from pair to pair.
pub fn within(tolerance: &Tolerance) -> String {
    let limit = limit(tolerance);
    match tolerance.source {
        ToleranceSource::MeshError => format!("their mesh errors (median {limit})"),
        _ => limit,
    }
}

/// The limit of a tolerance: "5 %", or an absolute difference.
pub fn limit(tolerance: &Tolerance) -> String {
    if matches!(tolerance.source, ToleranceSource::Unknown | ToleranceSource::Ranges) {
        "rounding".to_owned()
    } else if tolerance.absolute {
        brief_number(tolerance.limit)
    } else {
        format!("{} %", brief_number(100.0 * tolerance.limit))
    }
}

/// Breaks a line at its semicolons so that it fits beside `indent` characters.
pub fn wrapped(line: &str, indent: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for part in line.split_inclusive("; ") {
        let length = part.trim_end().chars().count();
        match lines.last_mut() {
            Some(last) if indent + last.chars().count() + length <= MAX_LINE_WIDTH => {
                last.push_str(part);
            }
            _ => lines.push(part.to_owned()),
        }
    }
    lines.iter().map(|line| line.trim_end().to_owned()).collect()
}
