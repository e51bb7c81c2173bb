//! Stored runs of scenes with an exact answer, as runs of a scene.

use crate::exact_scenes::ExactScene;
use billow_study::analysis::work_precision::{Ending, Outcome, Quantity, Run, SceneRuns};
use billow_study::input::value::Value;
use billow_study::job::Status;

/// The runs of a stored scene.
pub fn from_stored(scene: &ExactScene) -> SceneRuns {
    let quantity = |known: &crate::exact_scenes::ExactQuantity| Quantity {
        name: known.name.clone(),
        unit: known.unit.clone(),
        meaning: known.meaning.clone(),
        exact: known.exact,
        is_course: false,
    };
    let runs = scene.runs.iter().map(|run| Run {
        configuration: scene
            .parameters
            .iter()
            .cloned()
            .zip(run.configuration.iter().map(value))
            .collect(),
        ending: match Status::from_name(&run.status) {
            Some(Status::Done) | None => Ending::Trusted,
            Some(status) => Ending::Failed(status),
        },
        elements: run.elements,
        steps: run.steps,
        implicit: run.implicit,
        seconds: Some(run.seconds),
        results: (0..scene.quantities.len())
            .map(|index| run.values.get(index).map(|number| Outcome::Number(*number)))
            .collect(),
        mesh_errors: Vec::new(),
    });
    SceneRuns {
        name: scene.name.clone(),
        meaning: scene.meaning.clone(),
        quantities: scene.quantities.iter().map(quantity).collect(),
        per_simulated_second: scene.per_simulated_second,
        runs: runs.collect(),
        without_result: 0,
    }
}

fn value(json: &serde_json::Value) -> Value {
    match json {
        serde_json::Value::String(text) => Value::Text(text.clone()),
        serde_json::Value::Bool(flag) => Value::Bool(*flag),
        serde_json::Value::Number(number) => match number.as_i64() {
            Some(whole) => Value::Integer(whole),
            None => number.as_f64().map_or(Value::Null, Value::Number),
        },
        _ => Value::Null,
    }
}
