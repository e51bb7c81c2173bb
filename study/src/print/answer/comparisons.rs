//! Lines of the answer on the values of each parameter: which is better, by how much, and what is not compared.

use std::fmt::Write as _;

use crate::analysis::answer::Answer;
use crate::analysis::compare::{Better, Tally};
use crate::analysis::ranking::{Basis, Candidate, RankedMeasure, Ranking};
use crate::input::value::{Value, brief_number};
use crate::job::row::{CellType, ColumnId, HEADLINE};
use crate::print::{MAX_VALUES, count};

/// Why a parameter has no effect on a measure.
pub(super) const BEFORE_INFLOW: &str = "its peak comes before the inflow that this changes";

/// One line per parameter. The border of a search says what its parameter does.
pub(super) fn lines(answer: &Answer) -> Vec<String> {
    let searched = answer.searches.as_ref().map(|searches| &searches.parameter);
    let compared = answer.comparisons.iter().filter(|(name, _)| Some(name) != searched);
    let ranked = compared.filter_map(|(_, ranking)| ranking.as_ref().ok());
    ranked.map(|ranking| line(answer, ranking)).collect()
}

fn line(answer: &Answer, ranking: &Ranking) -> String {
    let Some(by) = ranking.by.first() else { return String::new() };
    let mut parts = outcomes(ranking).into_iter().collect::<Vec<_>>();
    // Of a choice, as a strategy is, the speed counts too: both loads say which one is gentler.
    let with_speed = by.cell_type == CellType::Text;
    let is = |id: ColumnId, name: &str| id.name() == name || id.without_rings().name() == name;
    let is_shown = |measure: &&RankedMeasure| {
        let name = &measure.column.name;
        answer.worst.iter().any(|worst| worst.measure == *name)
            || HEADLINE.iter().any(|id| is(*id, name))
            || with_speed && is(ColumnId::PeakVz, name)
    };
    for (index, measure) in ranking.measures.iter().enumerate().filter(|(_, m)| is_shown(m)) {
        let name = &measure.column.name;
        let has_none = answer.no_effect.iter().any(|(b, m)| *b == by.name && m.name() == name);
        if has_none {
            parts.push(format!("{name} the same with each value: {BEFORE_INFLOW}"));
        } else {
            parts.extend(measured(ranking, index, measure));
        }
    }
    let mut text = format!("{}: {}; {}", by.name, parts.join("; "), count(ranking.sets, "set"));
    if !ranking.carried.is_empty() {
        let _ = write!(text, ", {} with it", ranking.carried.join(", "));
    }
    if ranking.outside > 0 {
        let _ = write!(text, "; {} in no set", count(ranking.outside, "point"));
    }
    text
}

pub(super) fn value(ranking: &Ranking, candidate: &Candidate) -> String {
    let value = candidate.values.first().unwrap_or(&Value::Null);
    ranking.by.first().map_or_else(String::new, |by| by.shown.quantity(value))
}

/// Some texts as a list, and the number of the others.
pub(super) fn listed(texts: impl Iterator<Item = String>) -> String {
    let mut texts: Vec<String> = texts.collect();
    let more = texts.len().saturating_sub(MAX_VALUES);
    if more > 0 {
        texts.truncate(MAX_VALUES);
        texts.push(format!("and {more} more"));
    }
    texts.join(", ")
}

/// How many points of each value are safe, with what limits them; without limits how many deploy, where not all do.
fn outcomes(ranking: &Ranking) -> Option<String> {
    let (word, met): (&str, fn(&Candidate) -> usize) = match ranking.basis {
        Basis::Limits => ("safe", |candidate| candidate.safe),
        Basis::Verdicts => ("deployed", |candidate| candidate.deployed),
        Basis::Measures => return None,
    };
    let all = ranking.candidates.iter().all(|candidate| met(candidate) == candidate.points);
    if ranking.basis == Basis::Verdicts && all {
        return None;
    }
    let text = |candidate: &Candidate| {
        let (name, met, points) = (value(ranking, candidate), met(candidate), candidate.points);
        let margin = candidate.margin.as_ref().map_or_else(String::new, |(margin, measure)| {
            format!(" (smallest_margin {}, {measure})", brief_number(*margin))
        });
        format!("{name} {met} of {points}{margin}")
    };
    Some(format!("{word} {}", listed(ranking.candidates.iter().map(text))))
}

/// The medians of a measure, the best one first; `None` where no value has one.
fn measured(ranking: &Ranking, index: usize, measure: &RankedMeasure) -> Option<String> {
    let name = &measure.column.name;
    let median = |position: usize| Some(ranking.candidates[position].measures[index]?.median);
    let mut order: Vec<usize> =
        (0..ranking.candidates.len()).filter(|position| median(*position).is_some()).collect();
    // The best value, then the others, the nearest to the best one first.
    let start = measure.best.and_then(median).unwrap_or(f64::NEG_INFINITY);
    let distance = |position: &usize| median(*position).map_or(f64::NAN, |m| (m - start).abs());
    match measure.best {
        Some(_) => order.sort_by(|a, b| distance(a).total_cmp(&distance(b))),
        None => order.sort_by(|a, b| {
            median(*a).partial_cmp(&median(*b)).unwrap_or(std::cmp::Ordering::Equal)
        }),
    }
    let first = *order.first()?;
    let all_equal = measure.best.is_some() && order.iter().all(|position| measure.equal[*position]);
    let text = |position: usize| {
        let (name, median) = (value(ranking, &ranking.candidates[position]), median(position)?);
        let mark = match &measure.against_best[position] {
            _ if all_equal || measure.best.is_none() => String::new(),
            None => " (best)".to_owned(),
            Some(_) if measure.equal[position] => " (equal)".to_owned(),
            Some(tally) => against(tally),
        };
        Some(format!("{} with {name}{mark}", measure.column.shown.brief(median)))
    };
    let texts = listed(order.iter().filter_map(|position| text(*position)));
    let equal = if all_equal && measure.best == Some(first) {
        format!(" equal within {}:", measure.tolerance.text())
    } else {
        String::new()
    };
    Some(format!("median {name}{equal} {texts}"))
}

/// How a value stands to the best one, pair by pair.
fn against(tally: &Tally) -> String {
    let pairs = tally.pairs();
    let ratio = tally
        .ratio
        .map_or_else(String::new, |ratio| format!("{} times, ", brief_number(ratio.median)));
    let worse = tally.count(Better::Base);
    let ties = match tally.count(Better::Tie) {
        0 => String::new(),
        ties => format!(", equal in {ties}"),
    };
    format!(" ({ratio}worse in {worse} of {pairs}{ties})")
}

/// What is not compared, and why: parameters, and values of a parameter.
pub(super) fn left_out(answer: &Answer) -> Vec<String> {
    let mut lines = Vec::new();
    for (name, ranking) in &answer.comparisons {
        match ranking {
            Err(reason) => lines.push(format!("{name}: {reason}")),
            Ok(ranking) if ranking.left_out.len() > MAX_VALUES => {
                let (left_out, all) = (ranking.left_out.len(), ranking.candidates.len());
                lines.push(format!("{name}: {left_out} of its {} values", left_out + all));
            }
            Ok(ranking) => {
                let left_out = ranking.left_out.iter();
                lines.extend(
                    left_out.map(|(values, why)| format!("{}: {why}", ranking.label(values))),
                );
            }
        }
    }
    lines
}
