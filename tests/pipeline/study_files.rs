//! The shipped study files: each is valid by the schema, plans, and is listed with its question.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use billow_study::input::schema::study_schema;
use billow_study::job::JobId;
use billow_study::study::plan::{Generation, next_jobs};
use billow_study::study::{MAX_POINTS, Study};

use crate::support::assert_valid;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../studies")
}

fn shipped() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        // A file of maps (`make stability`) is no study.
        .filter(|path| !path.ends_with("stability.json"))
        .collect();
    files.sort();
    assert!(files.len() >= 3, "{files:?}");
    files
}

/// The file that a run stores is the same study.
#[test]
fn every_shipped_study_is_valid_and_plans_the_same_jobs_from_its_stored_file() {
    let schema = study_schema();
    jsonschema::meta::validate(&schema).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let readme = fs::read_to_string(folder().join("README.md")).unwrap();
    for path in shipped() {
        let name = path.file_name().unwrap().to_str().unwrap();
        assert!(readme.contains(&format!("`{name}`")), "{name} is not listed in README.md");
        let study = Study::load(&path, &[]).unwrap();
        assert!(study.question.ends_with('?'), "{name}");
        let generation = next_jobs(&study, &[]).unwrap();
        assert!(generation.points.iter().any(|point| point.infeasible.is_none()), "{name}");

        let resolved = serde_json::to_string(study.file()).unwrap();
        for text in [&fs::read_to_string(&path).unwrap(), &resolved] {
            assert_valid(&validator, text);
        }
        let again = Study::from_text(&resolved, "study.json", "x", &[], MAX_POINTS);
        let again = again.unwrap_or_else(|error| panic!("{name}: {error}"));
        let ids = |generation: &Generation| -> Vec<JobId> {
            generation.points.iter().map(|point| point.job.id.clone()).collect()
        };
        assert_eq!(ids(&next_jobs(&again, &[]).unwrap()), ids(&generation), "{name}");
        assert_eq!(again.file(), study.file(), "{name}");
        assert_eq!(again.parameter_names(), study.parameter_names(), "{name}");
        assert_eq!((&again.name, &again.question), (&study.name, &study.question));
    }
}

#[test]
fn schema_and_plan_print_json() {
    let billow = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_billow"));
        let output = command.args(arguments).current_dir(folder()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        (serde_json::from_slice(&output.stdout).unwrap(), output.stderr)
    };
    let (schema, _): (serde_json::Value, _) = billow(&["keys", "--schema"]);
    assert_eq!(schema, study_schema());

    let (plan, stderr): (serde_json::Value, _) = billow(&["plan", "designs.json", "--json"]);
    let rows = plan.as_array().unwrap();
    assert_eq!(rows.len(), 108);
    for row in rows {
        let job = row["status"] == "job";
        assert_eq!((row["reason"].is_null(), row["phi"].is_number()), (job, job), "{row}");
        assert!(job || row["nearest"].as_str().unwrap().contains("M = 3"), "{row}");
    }
    // At the paper's ratio, two storeys of six panels cannot reach 1 m, three can.
    let feasible = |storeys: u64| {
        rows.iter().any(|row| {
            (&row["N"], &row["M"]) == (&6.into(), &storeys.into())
                && row["alpha1_over_phi"] == 1.0
                && row["status"] == "job"
        })
    };
    assert!(!feasible(2) && feasible(3) && feasible(4));
    assert!(String::from_utf8(stderr).unwrap().contains("78 jobs, 0 duplicates, 30 infeasible"));
}
