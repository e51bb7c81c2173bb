//! A mangled study either plans or gives an error with its file, problem and allowed values.

use std::collections::BTreeSet;
use std::fs;

use billow_study::input::study_file;
use billow_study::study::Study;
use billow_study::study::plan::next_jobs;
use serde_json::{Value as Json, json};

use crate::mutate;
use crate::random::Random;

/// A shipped study with short axes, so that it plans quickly.
fn shortened(path: &std::path::Path) -> Json {
    let mut study: Json = serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    let mut keep = 2;
    for (_, axis) in study["grid"].as_object_mut().unwrap() {
        match axis {
            Json::Array(items) => items.truncate(keep),
            range => *range = json!([6, 5]),
        }
        keep = 1;
    }
    study
}

#[test]
fn fifty_thousand_mangled_studies_plan_or_name_their_error() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../studies");
    let studies: Vec<Json> = ["first.json", "designs.json", "strategies.json", "folds.json"]
        .iter()
        .map(|name| shortened(&folder.join(name)))
        .collect();
    let mut random = Random::of_trial(20_261_121, "studies", 0);
    let (mut planned, mut refused) = (0_u32, 0_u32);
    for round in 0..50_000_u32 {
        let study = random.pick(&studies).clone();
        let text = match round % 2 {
            0 => mutate::bytes(format!("{study:#}").as_bytes(), &mut random),
            _ => mutate::json(&study, &mut random),
        };
        let study = study_file::text_of(&text, "fuzz.json")
            .and_then(|text| Study::from_text(text, "fuzz.json", "fuzz", &[], 24));
        match study {
            Ok(study) => {
                // At most the allowed number of points, and no job twice.
                let points = next_jobs(&study, &[]).unwrap().points;
                let ids: BTreeSet<_> = points.iter().map(|point| &point.job.id).collect();
                assert!((1..=24).contains(&points.len()) && ids.len() == points.len());
                planned += 1;
            }
            Err(error) => {
                assert!(!error.problem.is_empty() && !error.allowed.is_empty(), "{error:?}");
                assert!(error.to_string().starts_with("fuzz.json"), "{error}");
                refused += 1;
            }
        }
    }
    // Both outcomes are frequent.
    assert!(planned > 2_500 && refused > 2_500, "{planned} planned, {refused} refused");
}
