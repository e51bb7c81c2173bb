//! The answer of a study as JSON keys.

use serde_json::{Value, json};

use crate::analysis::answer::{Answer, Importance, Searches};
use crate::analysis::ranking::Ranking;
use crate::input::value::json_value;
use crate::print::json_objects;

use super::comparisons::BEFORE_INFLOW;
use super::headline::headline;

/// The answer as JSON keys.
pub fn json(answer: &Answer) -> Value {
    let all = || answer.comparisons.iter();
    let compared =
        all().filter_map(|(name, ranking)| Some(comparison_json(name, ranking.as_ref().ok()?)));
    let not_compared = all().filter_map(|(parameter, ranking)| {
        let reason = ranking.as_ref().err()?;
        Some(json!({"parameter": parameter, "reason": reason}))
    });
    let no_effect = answer.no_effect.iter().map(|(parameter, measure)| {
        json!({"parameter": parameter, "measure": measure.name(), "reason": BEFORE_INFLOW})
    });
    json!({
        "question": answer.question,
        "answer": headline(answer),
        "assumptions": answer.assumptions,
        "jobs": answer.counts.jobs(),
        "near_threshold": answer.counts.near_threshold,
        "still_moving": answer.still_moving,
        "worst": answer.worst,
        "fastest": answer.fastest,
        "hardest": answer.hardest,
        "most_energy": answer.most_energy,
        "trust": answer.trust,
        "film_stress_over_modulus": answer.largest_strain,
        "comparisons": compared.collect::<Vec<_>>(),
        "not_compared": not_compared.collect::<Vec<_>>(),
        "no_effect": no_effect.collect::<Vec<_>>(),
        "points_with_runs": answer.points,
        "mixed": answer.mixed,
        "verdict_depends_on": answer.sensitivity,
        "safe": answer.safety,
        "tolerances": answer.tolerances,
        "importance": answer.importance.iter().map(importance_json).collect::<Vec<_>>(),
        "optimum": answer.optimum,
        "borders": answer.searches.as_ref().map(borders_json),
    })
}

fn importance_json((measure, found): &(String, Importance)) -> Value {
    let mut found = json!(found);
    found["measure"] = json!(measure);
    found
}

/// The searches: the rows of `billow table --borders`.
fn borders_json(searches: &Searches) -> Value {
    json!({
        "parameter": searches.parameter,
        "unit": searches.unit,
        "criterion": searches.criterion,
        "searches": json_objects(&searches.table()),
    })
}

/// The values of a parameter: the rows of `billow compare --rank`, and the best ones.
fn comparison_json(name: &str, ranking: &Ranking) -> Value {
    let value = |position: usize| json_value(&ranking.candidates[position].values[0]);
    let measures = ranking.measures.iter().map(|measure| {
        let equal = (0..measure.equal.len()).filter(|position| measure.equal[*position]);
        json!({
            "measure": measure.column.name,
            "sets": measure.sets,
            "tolerance": measure.tolerance.limit,
            "best": measure.best.map(value),
            "equal": equal.map(value).collect::<Vec<_>>(),
        })
    });
    let left_out = ranking.left_out.iter();
    let left_out = left_out
        .map(|(values, reason)| json!({"value": values.first().map(json_value), "reason": reason}));
    json!({
        "parameter": name,
        "with_it": ranking.carried,
        "sets": ranking.sets,
        "values": json_objects(&ranking.table()),
        "measures": measures.collect::<Vec<_>>(),
        "left_out": left_out.collect::<Vec<_>>(),
    })
}
