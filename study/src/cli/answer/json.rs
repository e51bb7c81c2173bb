//! The answer of a study as JSON keys.

use serde_json::{Map, json};

use super::effects::sets;
use crate::analysis::answer::{Answer, Depends, Effect, Extreme, Extremes, PointCounts, Trust};
use crate::input::value::json_value;
use crate::job::row::HEADLINE;

mod judged;

/// The answer as JSON keys.
pub fn json(answer: &Answer) -> serde_json::Value {
    json!({
        "question": answer.question,
        "jobs": answer.counts.jobs(),
        "near_threshold": answer.counts.near_threshold,
        "fastest": extreme_json(answer.fastest.as_ref(), HEADLINE[0].name()),
        "hardest": extreme_json(answer.hardest.as_ref(), "peak_vz"),
        "most_energy": extreme_json(answer.most_energy.as_ref(), "peak_kinetic_energy"),
        "trust": answer.trust.map(|trust| trust_json(&trust, answer.largest_strain)),
        "medians": answer.effects.effects.iter().map(effect_json).collect::<Vec<_>>(),
        "not_compared": answer.effects.not_compared.iter()
            .map(|(parameter, reason)| json!({"parameter": parameter, "reason": reason}))
            .collect::<Vec<_>>(),
        "points_with_runs": answer.points.as_ref().map(points_json),
        "verdict_depends_on": answer.depends.as_ref().map(depends_json),
        "safe": answer.safety.as_ref().map(judged::safety),
        "pairwise": {
            "parameter": answer.choice,
            "pairs": answer.pairwise.iter().map(judged::versus).collect::<Vec<_>>(),
        },
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

fn depends_json(depends: &Depends) -> serde_json::Value {
    let choices = depends.choices.iter();
    let choices: Map<_, _> = choices.map(|(name, points)| (name.clone(), json!(points))).collect();
    json!({ "points": depends.points, "of": depends.of, "choices": choices })
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

fn effect_json(effect: &Effect) -> serde_json::Value {
    let values = effect.values.iter().enumerate().map(|(index, value)| {
        let mut keys = Map::new();
        keys.insert("value".to_owned(), json_value(value));
        for measure in &effect.measures {
            keys.insert(measure.measure.name().to_owned(), json!(measure.medians[index]));
        }
        let (deployed, jobs) = effect.deployed[index];
        keys.insert("deployed".to_owned(), deployed.into());
        keys.insert("jobs".to_owned(), jobs.into());
        serde_json::Value::from(keys)
    });
    let listed = |indices: &[usize]| -> Vec<serde_json::Value> {
        indices.iter().map(|index| json_value(&effect.values[*index])).collect()
    };
    let measures = effect.measures.iter().map(|measure| {
        let mut keys = json!({
            "measure": measure.measure.name(),
            "sets": measure.sets,
            "tolerance": measure.tolerance.limit,
            "equal": measure.extremes == Extremes::Equal,
        });
        match &measure.extremes {
            Extremes::Equal => {}
            Extremes::Judged { best, worst } => {
                keys["best"] = listed(best).into();
                keys["worst"] = listed(worst).into();
            }
            Extremes::Range { lowest, highest } => {
                keys["lowest"] = listed(lowest).into();
                keys["highest"] = listed(highest).into();
            }
        }
        keys
    });
    let left_out = effect.left_out.iter().map(|(value, measure, reason)| {
        let value = value.as_ref().map(json_value);
        json!({"value": value, "measure": measure.name(), "reason": reason})
    });
    json!({
        "parameter": effect.parameter,
        "unit": effect.unit,
        "with_it": effect.carried,
        "sets": sets(effect),
        "values": values.collect::<Vec<_>>(),
        "measures": measures.collect::<Vec<_>>(),
        "left_out": left_out.collect::<Vec<_>>(),
    })
}
