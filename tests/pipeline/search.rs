//! Replicates, limits and the search of a border: from the study file to the rows.

use billow_study::input::value::Value;
use billow_study::job::JobId;
use billow_study::platform::files::Disk;
use billow_study::store::results::Results;
use billow_study::store::stored::Stored;
use billow_study::study::{Border, SearchResult};
use serde_json::{Value as Json, json};

use crate::support::{TestFolder, grid};

/// A piston study that searches the mass flow rate at which the speed reaches its limit.
pub(crate) fn searching() -> Json {
    let mut study = grid(&json!({
        "N": [5, 6],
        "mass_flow_rate": {"bisect": ["1 g/s", "20 g/s"], "on": "peak_vz", "tolerance": "2 %", "spacing": "log"},
    }));
    study["design"]["M"] = json!(3);
    study["design"]["alpha1_over_phi"] = json!(1);
    study["limits"] = json!({"peak_vz": "< 40 m/s", "verdict": "deployed"});
    study
}

/// With five films in the place of seeds, which the piston ignores.
pub(crate) fn replicated() -> Json {
    let mut study = searching();
    let films = ["24 um", "25 um", "26 um", "27 um", "28 um"];
    study["replicates"] = json!({"film.thickness": films});
    study
}

fn borders(folder: &TestFolder) -> Vec<Border> {
    Stored::read(Results::new(&Disk, &folder.results())).unwrap().borders()
}

fn jobs(folder: &TestFolder) -> Vec<JobId> {
    let stored = Stored::read(Results::new(&Disk, &folder.results())).unwrap();
    stored.points.iter().map(|point| point.job.id.clone()).collect()
}

/// Rows of the runs, by their cells.
fn rows(folder: &TestFolder) -> Vec<Json> {
    serde_json::from_str(&folder.stdout(&["table", "results/grid", "--columns", "all", "--json"]))
        .unwrap()
}

#[test]
fn a_search_finds_the_border_of_a_limit_and_resumes() {
    let folder = TestFolder::finished(&searching());
    let found = borders(&folder);
    assert_eq!(found.len(), 2, "one search for each N");
    let rows = rows(&folder);
    for border in &found {
        let SearchResult::Border { low, high, met_below } = border.outcome else {
            panic!("{border:?}")
        };
        assert!(met_below && low < high && high <= 1.02 * low, "{low} to {high}");
        let number = |row: &Json, name: &str| row[name].as_f64().unwrap();
        let same =
            |row: &&Json| Value::Integer(row["N"].as_i64().unwrap()) == border.parameters[0].1;
        for row in rows.iter().filter(same) {
            let below = number(row, "mass_flow_rate") <= low;
            assert_eq!(number(row, "peak_vz") < 40.0, below, "{row}");
            assert_eq!(number(row, "margin_peak_vz") > 0.0, below, "{row}");
        }
        assert!(border.levels.len() <= 5 + 6, "{}", border.levels.len());
    }
    // Nothing more to do; a study that is planned again from study.json has the same jobs.
    let planned = jobs(&folder);
    assert!(folder.stdout(&["run", "grid.json", "-q"]).contains("nothing to run"));
    folder.stdout(&["run", "results/grid", "-q"]);
    assert_eq!(jobs(&folder), planned);
    // A job that is lost runs again, and the search goes on as before.
    let lost = planned.last().unwrap();
    std::fs::remove_file(Results::new(&Disk, &folder.results()).job_path(lost)).unwrap();
    let output = folder.stdout(&["run", "grid.json", "-q"]);
    assert!(output.contains("1 job run"), "{output}");
    assert_eq!((jobs(&folder), borders(&folder)), (planned, found));
}

#[test]
fn an_interrupted_search_plans_the_same_jobs() {
    let whole = TestFolder::finished(&searching());
    let parts = TestFolder::new(&searching());
    // First the ends of the search alone, as the jobs of a plain grid.
    parts.stdout(&["run", "grid.json", "-q", "--set", "grid.mass_flow_rate=[0.001, 0.02]"]);
    let output = parts.stdout(&["run", "grid.json", "-q"]);
    assert!(!output.contains("nothing to run"), "{output}");
    assert_eq!(jobs(&parts), jobs(&whole));
    assert_eq!(borders(&parts), borders(&whole));
}

#[test]
fn replicates_repeat_every_point_and_decide_together() {
    let folder = TestFolder::finished(&replicated());
    for border in borders(&folder) {
        let SearchResult::Border { low, high, met_below: true } = border.outcome else {
            panic!("{border:?}")
        };
        for level in &border.levels {
            assert_eq!((level.met.of, level.not_judged, level.open), (5, 0, 0));
            if level.value <= low {
                assert_eq!(level.met.met, 5, "{level:?}");
            } else if level.value >= high {
                assert_eq!(level.met.met, 0, "{level:?}");
            }
        }
        let names: Vec<&str> = border.parameters.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["N"], "neither the replicate nor what is searched");
    }
}

#[test]
fn a_search_runs_along_single_points_that_do_not_give_its_key() {
    let mut study = searching();
    study["grid"]["points"] = json!([
        {"N": 7, "heat_transfer": "adiabatic"},
        {"N": 7, "mass_flow_rate": "3 g/s"},
        // A point of the product counts once.
        {"N": 5},
    ]);
    study["grid"]["filter"] = json!("N < 7");
    let folder = TestFolder::finished(&study);
    let found = borders(&folder);
    let values: Vec<&Value> = found.iter().map(|border| &border.parameters[0].1).collect();
    assert_eq!(values, [5, 6, 7].map(Value::Integer).iter().collect::<Vec<_>>());
    for border in &found {
        let SearchResult::Border { low, high, .. } = border.outcome else { panic!("{border:?}") };
        assert!(high <= 1.02 * low, "the filter does not end a search of a single point");
    }
    assert!(
        found[2].levels.iter().all(|level| (level.value - 0.003).abs() > 1e-9),
        "not a value of the search"
    );
}

#[test]
fn a_filter_that_ends_a_search_is_reported() {
    let mut study = searching();
    study["grid"]["filter"] = json!("mass_flow_rate < '6 g/s' or mass_flow_rate > '6.5 g/s'");
    let folder = TestFolder::new(&study);
    let printed = folder.stdout(&["run", "grid.json", "-q"]);
    let found = borders(&folder);
    for border in &found {
        let SearchResult::Border { low, high, .. } = border.outcome else { panic!("{border:?}") };
        assert_eq!(border.filtered, high > 1.02 * low, "{low} to {high}");
    }
    let reported = printed.contains("the filter of the study ends this search");
    assert_eq!(reported, found.iter().any(|border| border.filtered));
}
