//! The studies of the trials. Each is written as `s.json` and has its results in `results/s`.

use serde_json::{Value, json};

fn study(end_time: &str, grid: &Value) -> Value {
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

/// Piston jobs with these flows, kg/s.
fn pistons(flows: impl Iterator<Item = f64>) -> Value {
    json!({ "model": ["piston"], "N": [5, 6], "mass_flow_rate": flows.collect::<Vec<_>>() })
}

/// Film jobs on a mesh of these subdivisions.
fn films(end_time: &str, subdivisions: u32, flows: &Value) -> Value {
    let grid = json!({
        "model": ["film"], "N": [6], "subdivisions": [subdivisions], "mass_flow_rate": flows
    });
    study(end_time, &grid)
}

/// 40 piston jobs and 4 film jobs: half a second.
pub fn mixed() -> Value {
    let mut grid = pistons((1..=20).map(|flow| 0.0002 * f64::from(flow)));
    let film = |(panels, flow)| json!({ "model": "film", "N": panels, "mass_flow_rate": flow });
    grid["points"] = [(5, 0.001), (5, 0.005), (6, 0.001), (6, 0.005)].map(film).as_slice().into();
    study("0.05 s", &grid)
}

/// The search of an optimum, each of its 12 points with three samples of film: generation after generation.
pub fn search() -> Value {
    let mut study = films("0.02 s", 2, &json!([]));
    study["grid"] = json!({});
    study["design"]["N"] = json!(6);
    study["limits"] = json!({ "peak_vz": "< 20 m/s" });
    let flows = json!(["1 g/s", "5 g/s"]);
    study["optimise"] =
        json!({ "minimise": "t_50_z_rim", "over": { "mass_flow_rate": flows }, "budget": 12 });
    study["samples"] =
        json!({ "number": 3, "of": { "film.thickness": { "normal": ["25 um", "4 %"] } } });
    study
}

/// 4 piston jobs, 2 film jobs: every kind of stored file.
pub fn small() -> Value {
    let flows = json!(["2 g/s", "3 g/s"]);
    study("0.01 s", &json!({ "model": ["piston", "film"], "N": [5, 6], "mass_flow_rate": flows }))
}

/// Film jobs of a second each.
pub fn film() -> Value {
    films("0.04 s", 5, &json!(["1 g/s", "2 g/s", "5 g/s"]))
}

/// 20,000 piston jobs.
pub fn large() -> Value {
    study("0.05 s", &pistons((1..=10_000).map(|flow| 1e-6 * f64::from(flow))))
}

/// One film job on a fine mesh.
pub fn fine() -> Value {
    films("1 s", 40, &json!(["2 g/s"]))
}
