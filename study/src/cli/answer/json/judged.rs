//! JSON keys of the parts of the answer that need limits, strategies or searches.

use serde_json::{Map, Value, json};

use crate::analysis::answer::{Found, PointMargin, SafeCounts, Safety, Searches};
use crate::input::value::json_value;
use crate::study::SearchResult;

/// The safe points.
pub fn safety(safety: &Safety) -> Value {
    let mut keys = counts(&safety.counts);
    keys.insert("limits".to_owned(), json!(safety.limits));
    let missed = safety.missed.iter();
    let missed: Map<_, _> =
        missed.map(|(measure, points)| (measure.clone(), json!(points))).collect();
    keys.insert("missed".to_owned(), missed.into());
    keys.insert("nearest".to_owned(), json!(safety.nearest.as_ref().map(margin)));
    keys.into()
}

fn counts(counts: &SafeCounts) -> Map<String, Value> {
    let numbers = [
        ("points", counts.points),
        ("safe", counts.safe),
        ("mixed", counts.mixed),
        ("not_judged", counts.not_judged),
    ];
    numbers.map(|(name, number)| (name.to_owned(), json!(number))).into_iter().collect()
}

fn margin(margin: &PointMargin) -> Value {
    let parameters = margin.point.parameters.iter();
    let parameters: Map<_, _> =
        parameters.map(|(name, value, _)| (name.clone(), json_value(value))).collect();
    json!({
        "smallest_margin": margin.point.value,
        "smallest_margin_of": margin.measure,
        "job": margin.point.job,
        "parameters": parameters,
    })
}

/// The searches.
pub fn searches(searches: &Searches) -> Value {
    json!({
        "parameter": searches.parameter,
        "unit": searches.unit,
        "criterion": searches.criterion,
        "searches": searches.found.iter().map(|f| found(searches, f)).collect::<Vec<_>>(),
    })
}

fn found(searches: &Searches, found: &Found) -> Value {
    let parameters = found.parameters.iter();
    let parameters: Map<_, _> =
        parameters.map(|(name, value, _)| (name.clone(), json_value(value))).collect();
    let mut keys = json!({
        "parameters": parameters,
        "outcome": found.outcome(),
        "met_below": found.met_below(),
        "range": found.range(),
        "limit": found.limit,
        "values": found.border.levels.len(),
        "not_decided": found.undecided(searches.replicates),
        "open": found.sum(|level| level.open),
        "not_judged": found.sum(|level| level.not_judged),
    });
    match &found.border.outcome {
        SearchResult::Border { low, high, .. } => {
            keys["low"] = (*low).into();
            keys["high"] = (*high).into();
        }
        SearchResult::NotMonotone(changes) => keys["changes"] = json!(changes),
        _ => {}
    }
    keys
}
