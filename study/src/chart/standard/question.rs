//! The standard charts of a study that asks a question: with limits, replicates or a search.

use std::collections::BTreeMap;

use super::middle::middle;
use super::{ChartKind, HISTORIES, MEASURES, axes, measured};
use crate::analysis::compare::{canonical, values};
use crate::chart::Source;
use crate::chart::history::has_history;
use crate::chart::map::{Judged, MAX_VALUES};
use crate::chart::parameters::STRATEGY;
use crate::job::row::DerivedColumn;

/// Most points whose histories are drawn together. Chosen: more lines hide each other.
const MAX_HISTORIES: usize = 8;

/// The charts, and messages about charts that are not drawn.
pub(super) fn kinds(source: &Source<'_>) -> (Vec<ChartKind>, Vec<String>) {
    let (mut kinds, mut notes) = (Vec::new(), Vec::new());
    // First the answer: the borders, or the map of outcomes.
    if source.search.is_some() {
        kinds.push(ChartKind::Borders(None, Vec::new()));
    } else if let Some(axes) = outcome_axes(source) {
        let judged = Judged::of(source);
        if source.rows.iter().any(|row| judged.proportion(source, *row).of > 0) {
            kinds.push(ChartKind::Map(judged.name().to_owned(), axes));
        } else {
            notes.push(format!("no map of outcomes: no job has a value of {}", judged.name()));
        }
    } else {
        notes.push("no map of outcomes: it needs two parameters that vary".to_owned());
    }
    let searched = source.search.map(|search| search.parameter.to_owned());
    if let Some(first) = searched.or_else(|| axes(source).into_iter().next()) {
        let limited: Vec<&str> = source.limits.iter().map(|limit| limit.measure.name()).collect();
        let names = std::iter::once(DerivedColumn::SmallestMargin.name());
        let numbers = limited.into_iter().filter(|name| *name != Judged::Deployed.name());
        let mut names: Vec<&str> = names.chain(numbers).collect();
        names.extend(MEASURES.iter().filter(|name| !names.contains(name)).collect::<Vec<_>>());
        let over = |measure: String| ChartKind::Over(measure, first.clone(), Vec::new());
        kinds.extend(measured(source, &names).into_iter().map(over));
    } else {
        notes.push("no chart of measures: no parameter varies".to_owned());
    }
    let (histories, note) = histories(source);
    kinds.extend(histories);
    notes.extend(note);
    (kinds, notes)
}

/// The histories: of all points, or of those at the middle values of every parameter but the strategy.
fn histories(source: &Source<'_>) -> (Vec<ChartKind>, Option<String>) {
    let rows: Vec<usize> =
        source.rows.iter().copied().filter(|row| has_history(source, *row)).collect();
    let each = |wrap: &dyn Fn(ChartKind) -> ChartKind| {
        HISTORIES.map(|column| wrap(ChartKind::History(vec![column.to_owned()]))).to_vec()
    };
    if rows.is_empty() {
        return (Vec::new(), Some("no histories: no job has one".to_owned()));
    }
    let stored = Source { rows, ..source.clone() };
    match middle(&stored, &[]) {
        Some((rows, choice)) if stored.rows.len() > MAX_HISTORIES => {
            let note = format!(
                "histories of {} of {} points, {choice} (the middle of the values); choose others: \
                 billow chart --history z_rim --where CONDITION",
                rows.len(),
                stored.rows.len()
            );
            let at = |kind| ChartKind::At(Box::new(kind), rows.clone(), choice.clone());
            (each(&at), Some(note))
        }
        _ => (each(&|kind| kind), None),
    }
}

/// The axes of a map of outcomes: of the parameters but the strategy the two that change the proportion the
/// most; with one such parameter, that and the strategy. Parameters with more values than fit are no axes,
/// while there are others. `None` without two parameters that vary.
pub fn outcome_axes(source: &Source<'_>) -> Option<[String; 2]> {
    let judged = Judged::of(source);
    let mut all = axes(source);
    let legible: Vec<String> =
        all.iter().filter(|name| is_legible(source, name)).cloned().collect();
    if legible.len() > 1 {
        all = legible;
    }
    let mut others: Vec<&String> = all.iter().filter(|name| *name != STRATEGY).collect();
    if others.len() > 2 {
        let effect = |name: &str| effect(source, judged, name);
        let mut ordered: Vec<(f64, &String)> =
            others.iter().map(|name| (effect(name), *name)).collect();
        ordered.sort_by(|a, b| b.0.total_cmp(&a.0));
        let chosen = [ordered[0].1, ordered[1].1];
        others.retain(|name| chosen.contains(name));
    }
    others.extend(all.iter().filter(|name| *name == STRATEGY));
    match others.as_slice() {
        [x, y, ..] => Some([(*x).clone(), (*y).clone()]),
        _ => None,
    }
}

/// Whether the values of a parameter fit along an axis.
fn is_legible(source: &Source<'_>, name: &str) -> bool {
    let common = source.common_values(&[name]);
    let rows = &common.as_ref().unwrap_or(source).rows;
    let column = source.table.parameters().find(|column| column.name == name);
    column.is_some_and(|column| values(column, rows).len() <= MAX_VALUES)
}

/// Largest difference of the mean proportion between two values of a parameter.
fn effect(source: &Source<'_>, judged: Judged, name: &str) -> f64 {
    let Some(column) = source.table.column(name) else { return 0.0 };
    let mut values: BTreeMap<String, (f64, f64)> = BTreeMap::new();
    for row in &source.rows {
        let proportion = judged.proportion(source, *row);
        if proportion.of > 0 {
            let known = values.entry(canonical(&column.cells[*row])).or_default();
            known.0 += proportion.met as f64 / proportion.of as f64;
            known.1 += 1.0;
        }
    }
    let means = || values.values().map(|(sum, count)| sum / count);
    let [low, high] =
        [means().fold(f64::INFINITY, f64::min), means().fold(f64::NEG_INFINITY, f64::max)];
    (high - low).max(0.0)
}
