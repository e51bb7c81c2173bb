//! The answer of a study as JSON keys.

use serde_json::{Map, json};

use crate::analysis::answer::{Answer, Extreme, PointCounts, Trust, VerdictSensitivity};
use crate::analysis::ranking::Ranking;
use crate::cli::print::json_objects;
use crate::input::value::json_value;
use crate::job::row::HEADLINE;

mod judged;

/// The answer as JSON keys.
pub fn json(answer: &Answer) -> serde_json::Value {
    let all = || answer.comparisons.iter();
    let compared =
        all().filter_map(|(name, ranking)| Some(comparison_json(name, ranking.as_ref().ok()?)));
    let not_compared = all().filter_map(|(parameter, ranking)| {
        let reason = ranking.as_ref().err()?;
        Some(json!({"parameter": parameter, "reason": reason}))
    });
    json!({
        "question": answer.question,
        "jobs": answer.counts.jobs(),
        "near_threshold": answer.counts.near_threshold,
        "fastest": extreme_json(answer.fastest.as_ref(), HEADLINE[0].name()),
        "hardest": extreme_json(answer.hardest.as_ref(), "peak_vz"),
        "most_energy": extreme_json(answer.most_energy.as_ref(), "peak_kinetic_energy"),
        "trust": answer.trust.map(|trust| trust_json(&trust, answer.largest_strain)),
        "comparisons": compared.collect::<Vec<_>>(),
        "not_compared": not_compared.collect::<Vec<_>>(),
        "points_with_runs": answer.points.as_ref().map(points_json),
        "verdict_depends_on": answer.sensitivity.as_ref().map(sensitivity_json),
        "safe": answer.safety.as_ref().map(judged::safety),
        "borders": answer.searches.as_ref().map(judged::searches),
    })
}

fn points_json(points: &PointCounts) -> serde_json::Value {
    json!({
        "points": points.points,
        "deployed": points.deployed,
        "mixed": points.mixed,
        "never": points.never,
        "not_decided": points.undecided,
        "replicates": points.replicates,
    })
}

fn sensitivity_json(found: &VerdictSensitivity) -> serde_json::Value {
    let choices = found.choices.iter();
    let choices: Map<_, _> = choices.map(|(name, points)| (name.clone(), json!(points))).collect();
    json!({ "points": found.points, "of": found.of, "choices": choices })
}

fn extreme_json(
    extreme: Option<&Extreme>,
    measure: &str,
) -> Option<Map<String, serde_json::Value>> {
    let extreme = extreme?;
    let parameters = extreme.parameters.iter();
    let parameters: Map<_, _> =
        parameters.map(|(name, value, _)| (name.clone(), json_value(value))).collect();
    let mut keys = Map::new();
    keys.insert("job".to_owned(), extreme.job.as_str().into());
    keys.insert("parameters".to_owned(), parameters.into());
    keys.insert(measure.to_owned(), extreme.value.into());
    keys.insert("others".to_owned(), extreme.others.into());
    keys.insert("within_mesh_error".to_owned(), extreme.within_error.into());
    keys.insert("extrapolated".to_owned(), extreme.extrapolated.into());
    keys.insert("trusted".to_owned(), extreme.trusted.into());
    Some(keys)
}

fn trust_json(trust: &Trust, largest_strain: f64) -> serde_json::Value {
    json!({
        "jobs": trust.jobs,
        "ledger_residual": trust.ledger_residual,
        "gas_residual": trust.gas_residual,
        "passages": trust.passages,
        "intersections": trust.intersections,
        "counted": trust.counted,
        "numerically_damped": trust.numerically_damped,
        "not_trusted": trust.not_trusted,
        "film_stress_over_modulus": largest_strain,
    })
}

/// The values of a parameter: the rows of `billow compare --rank`, and the best ones.
fn comparison_json(name: &str, ranking: &Ranking) -> serde_json::Value {
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
