//! The studies of the trials. Each is written as `s.json` and has its results in `results/s`.

use serde_json::{Value, json};

use super::place::Place;
use super::program::{self, Finish};

/// Jobs at the same time in one run.
const THREADS: &str = "2";

/// Runs or resumes the study of a place.
pub fn run(place: &Place) -> Finish {
    program::run(place, &run_arguments())
}

/// Arguments of that run.
pub fn run_arguments() -> [&'static str; 5] {
    ["run", "s.json", "--quiet", "--threads", THREADS]
}

fn base(end_time: &str, grid: &Value) -> Value {
    json!({
        "question": "Does a disturbed run give the same answer?",
        "design": {
            "fit": "cone", "M": 3, "bottom_radius": "500 mm", "top_radius": "365 mm", "height": "1 m",
            "stowed_height": "40 mm", "subdivisions": 2
        },
        "solver": { "end_time": end_time },
        "outputs": { "sample_interval": "1 ms", "frames": 3 },
        "grid": grid
    })
}

/// 40 piston jobs and 4 film jobs: half a second.
pub fn mixed() -> Value {
    let flows: Vec<f64> = (1..=20).map(|flow| 0.0002 * f64::from(flow)).collect();
    let film =
        |panels: u32, flow: f64| json!({ "model": "film", "N": panels, "mass_flow_rate": flow });
    let points = [film(5, 0.001), film(5, 0.005), film(6, 0.001), film(6, 0.005)];
    let grid =
        json!({ "model": ["piston"], "N": [5, 6], "mass_flow_rate": flows, "points": points });
    base("0.05 s", &grid)
}

/// 4 piston jobs, 2 film jobs: every kind of stored file.
pub fn small() -> Value {
    base(
        "0.01 s",
        &json!({ "model": ["piston", "film"], "N": [5, 6], "mass_flow_rate": ["2 g/s", "3 g/s"] }),
    )
}

/// Film jobs of a second each.
pub fn film() -> Value {
    let mut study = base("0.04 s", &json!({ "mass_flow_rate": ["1 g/s", "2 g/s", "5 g/s"] }));
    study["design"]["N"] = json!(6);
    study["design"]["subdivisions"] = json!(5);
    study["solver"]["model"] = json!("film");
    study
}

/// A study of many jobs.
pub fn large(jobs: u32) -> Value {
    let flows: Vec<f64> = (1..=jobs / 2).map(|flow| 1e-6 * f64::from(flow)).collect();
    let mut study = base("0.05 s", &json!({ "N": [5, 6], "mass_flow_rate": flows }));
    study["solver"]["model"] = json!("piston");
    study
}

/// One film job on a fine mesh.
pub fn fine(subdivisions: u32) -> Value {
    let mut study = base("1 s", &json!({ "mass_flow_rate": ["2 g/s"] }));
    study["design"]["N"] = json!(6);
    study["design"]["subdivisions"] = json!(subdivisions);
    study["solver"]["model"] = json!("film");
    study
}
