//! JSON keys of the parts of the answer that need limits, strategies or searches.

use serde_json::{Map, Value, json};

use crate::analysis::answer::{
    Found, Loads, MeasureVersus, PointMargin, SafeCounts, Safety, Searches, Versus,
};
use crate::input::value::json_value;
use crate::study::SearchResult;

/// The safe points.
pub fn safety(safety: &Safety) -> Value {
    let by = safety.by.as_ref().map(|by| {
        let values = by.values.iter().map(|value| {
            let mut keys = counts(&value.counts);
            keys.insert("value".to_owned(), json_value(&value.value));
            keys.insert("safest".to_owned(), json!(value.safest.as_ref().map(margin)));
            keys
        });
        json!({ "parameter": by.parameter, "values": values.collect::<Vec<_>>() })
    });
    let mut keys = counts(&safety.counts);
    keys.insert("limits".to_owned(), json!(safety.limits));
    let missed = safety.missed.iter();
    let missed: Map<_, _> =
        missed.map(|(measure, points)| (measure.clone(), json!(points))).collect();
    keys.insert("missed".to_owned(), missed.into());
    keys.insert("nearest".to_owned(), json!(safety.nearest.as_ref().map(margin)));
    keys.insert("by".to_owned(), json!(by));
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

/// Two values of a choice.
pub fn versus(versus: &Versus) -> Value {
    json!({
        "value": json_value(&versus.value),
        "than": json_value(&versus.than),
        "loads": match versus.loads {
            Loads::Gentler => "gentler",
            Loads::MostlyGentler => "mostly_gentler",
            Loads::Equal => "equal",
            Loads::Mixed => "mixed",
            Loads::Unknown => "unknown",
        },
        "pairs": versus.pairs,
        "only_value_deploys": versus.only_value,
        "only_than_deploys": versus.only_than,
        "measures": versus.measures.iter().map(measure).collect::<Vec<_>>(),
    })
}

fn measure(measure: &MeasureVersus) -> Value {
    json!({
        "measure": measure.measure.name(),
        "pairs": measure.pairs,
        "lower": measure.lower,
        "higher": measure.higher,
        "ties": measure.ties,
        "only_value": measure.only_value,
        "only_than": measure.only_than,
        "median_ratio": measure.ratio,
        "tolerance": measure.tolerance.limit,
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
