//! From study text to jobs: ids, grids, filters, overrides, generations.
#![expect(clippy::float_cmp, reason = "planning moves numbers, it computes none: they are equal")]

use billow_study::input::value::Value;
use billow_study::job::{JobId, Status};
use billow_study::platform::error::InputError;
use billow_study::study::finished::FinishedRow;
use billow_study::study::plan::{Generation, PlanCounts, next_jobs};
use billow_study::study::{MAX_POINTS, Study};
use serde_json::{Value as Json, json};

use crate::support::{TestFolder, stderr};

fn try_study(json: &Json, sets: &[&str]) -> Result<Study, InputError> {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    Study::from_text(&json.to_string(), "test.json", "test", &sets, MAX_POINTS)
}

fn plan(json: &Json, sets: &[&str]) -> Generation {
    let study = try_study(json, sets).unwrap_or_else(|error| panic!("{error}"));
    next_jobs(&study, &[]).unwrap()
}

fn id(json: &Json) -> JobId {
    let generation = plan(json, &[]);
    assert_eq!(generation.points.len(), 1);
    generation.points[0].job.id.clone()
}

/// The shortest study of the paper's capsule.
fn capsule() -> Json {
    json!({
        "design": {"N": 6, "M": 3, "bottom_radius": 0.5, "top_radius": 0.365, "height": 1},
        "gas": {"mass_flow_rate": 0.005},
        "solver": {"model": "piston", "end_time": 0.5},
    })
}

fn with_grid(grid: Json) -> Json {
    let mut study = capsule();
    study["grid"] = grid;
    study
}

fn column(generation: &Generation, name: &str) -> Vec<Value> {
    let value = |point: &billow_study::job::point::Point| {
        let parameters = &point.job.parameters;
        parameters.iter().find(|(key, _)| key == name).map(|(_, value)| value.clone()).unwrap()
    };
    generation.points.iter().map(value).collect()
}

fn integers(values: &[i64]) -> Vec<Value> {
    values.iter().map(|value| Value::Integer(*value)).collect()
}

fn numbers(values: &[f64]) -> Vec<Value> {
    values.iter().map(|value| Value::Number(*value)).collect()
}

#[test]
fn equal_values_give_the_same_job_id() {
    let expected = id(&capsule());
    let changed = |pointer: &str, value: &Json| {
        let mut study = capsule();
        let (parent, leaf) = pointer.rsplit_once('/').unwrap();
        study.pointer_mut(parent).unwrap()[leaf] = value.clone();
        id(&study)
    };
    for (pointer, value) in [
        ("/design/N", json!(6.0)),
        ("/design/height", json!(1.0)),
        ("/design/height", json!("1000 mm")),
        ("/design/bottom_radius", json!("50 cm")),
        ("/design/stowed_height", json!(0.04)),
        ("/design/stowed_height", json!("40 mm")),
        ("/design/fit", json!("cone")),
        ("/film", json!({"thickness": "25.4 um", "temperature": "293 K", "compression": -0.0})),
        ("/gas/mass_flow_rate", json!("5 g/s")),
        ("/gas/residual_gas_mass", json!(0)),
        ("/gas/species", json!("nitrogen")),
        ("/gas/species", json!({"cp": 1_038.810_68, "gas_constant": 296.803_052})),
        ("/gas/residual_gas", json!("stored")),
        ("/gravity", json!(-0.0)),
        ("/strategy", json!("direct")),
        ("/strategies", json!({"direct": {"inflow": [{"from": 0, "to": 0.5}]}})),
        ("/strategies", json!({"direct": {"inflow": [{"to": "9 s"}, {"mass_flow_rate": 0}]}})),
        ("/supports", json!([{"on": "bottom_ring", "fix": "zyx"}])),
        (
            "/supports",
            json!([{"on": "bottom_ring", "fix": "z"}, {"fix": "xy", "on": "bottom_ring"}]),
        ),
        ("/solver/stepping", json!({"adaptive": 1e-9})),
        ("/seed", json!(0)),
        ("/question", json!("Another question?")),
        ("/version", json!(1)),
    ] {
        assert_eq!(changed(pointer, &value), expected, "{pointer} = {value}");
    }
    let reversed = r#"{"solver": {"end_time": 0.5, "model": "piston"}, "gas": {"mass_flow_rate": 0.005},
        "design": {"height": 1, "top_radius": 0.365, "bottom_radius": 0.5, "M": 3, "N": 6}}"#;
    let study = Study::from_text(reversed, "f", "x", &[], MAX_POINTS).unwrap();
    assert_eq!(next_jobs(&study, &[]).unwrap().points[0].job.id, expected);
    // Other values give another id.
    for (pointer, value) in [
        ("/design/N", json!(5)),
        ("/design/height", json!("1001 mm")),
        ("/gas/mass_flow_rate", json!("5.000001 g/s")),
        ("/gas/heat_transfer", json!("adiabatic")),
        ("/seed", json!(1)),
        ("/solver/stepping", json!({"fixed": "10 us"})),
        ("/supports", json!([{"on": "bottom_ring", "fix": "z"}])),
    ] {
        assert_ne!(changed(pointer, &value), expected, "{pointer} = {value}");
    }
}

#[test]
fn a_grid_is_the_product_in_the_order_of_the_file() {
    let text = r#"{"design": {"bottom_radius": 0.5, "top_radius": 0.365, "height": 1},
        "gas": {"mass_flow_rate": 0.005}, "solver": {"model": "piston", "end_time": 0.5},
        "grid": {"N": [5, 6], "M": [4, 3], "film.thickness": ["25.4 um", "12.7 um"]}}"#;
    let study = Study::from_text(text, "f", "x", &[], MAX_POINTS).unwrap();
    assert_eq!(study.parameter_names(), ["N", "M", "thickness"]);
    let generation = next_jobs(&study, &[]).unwrap();
    assert_eq!(generation.number, 0);
    assert_eq!(column(&generation, "N"), integers(&[5, 5, 5, 5, 6, 6, 6, 6]));
    assert_eq!(column(&generation, "M"), integers(&[4, 4, 3, 3, 4, 4, 3, 3]));
    let thin = [25.4e-6, 12.7e-6];
    assert_eq!(column(&generation, "thickness"), numbers(&thin.repeat(4)));
    assert_eq!(generation.points[1].job.scene.film.thickness.to_bits(), 12.7e-6_f64.to_bits());
}

#[test]
fn ranges_give_the_values_a_list_would() {
    for (key, range, values) in [
        (
            "mass_flow_rate",
            json!({"from": "1 g/s", "to": "5 g/s", "step": "2 g/s"}),
            vec![0.001, 0.003, 0.005],
        ),
        (
            "mass_flow_rate",
            json!({"from": 0.001, "to": 0.1, "steps": 3, "spacing": "log"}),
            vec![0.001, 0.01, 0.1],
        ),
        (
            "compression",
            json!({"from": 0, "to": 1, "steps": 11}),
            vec![0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0],
        ),
        ("compression", json!({"from": 0.1, "to": 0.7, "step": 0.2}), vec![0.1, 0.3, 0.5, 0.7]),
    ] {
        let generation = plan(&with_grid(json!({key: range})), &[]);
        assert_eq!(column(&generation, key), numbers(&values), "{range}");
    }
    let whole = plan(&with_grid(json!({"N": {"from": 5, "to": 8, "step": 1}})), &[]);
    assert_eq!(column(&whole, "N"), integers(&[5, 6, 7, 8]));
}

#[test]
fn zip_points_and_filter_select_the_jobs() {
    let generation = plan(
        &with_grid(json!({
            "zip": [{"N": [5, 6, 8], "M": [3, 3, 4]}],
            "seed": [1, 2],
            "points": [{"M": 5}, {"N": 7, "seed": 9}],
            "filter": "not (N == 8 and seed == 2) and M < 6",
        })),
        &[],
    );
    assert_eq!(column(&generation, "N"), integers(&[5, 6, 8, 5, 6, 6, 7]));
    assert_eq!(column(&generation, "M"), integers(&[3, 3, 4, 3, 3, 5, 3]));
    assert_eq!(column(&generation, "seed"), integers(&[1, 1, 1, 2, 2, 0, 9]));

    let only = plan(&with_grid(json!({"points": [{"N": 5}, {"N": 6}]})), &[]);
    assert_eq!(column(&only, "N"), integers(&[5, 6]));

    let solved = with_grid(json!({"M": [1, 2, 3, 4, 5], "filter": "feasible and phi > '30 deg'"}));
    assert_eq!(column(&plan(&solved, &[]), "M"), integers(&[3, 4, 5]));
    let answers = plan(&with_grid(json!({"M": [1, 2]})), &[]);
    let reason = answers.points[0].infeasible.as_ref().unwrap();
    assert!(reason.nearest.iter().any(|near| near.key == "M" && near.value == 2.0), "{reason:?}");
    assert_eq!(answers.points[1].infeasible, None);
}

#[test]
fn strategies_resolve_to_windows() {
    let mut study = capsule();
    study["gas"]["residual_gas_mass"] = "0.05 g".into();
    study["strategies"] = json!({
        "delayed": {"release_time": 0.1, "inflow": [{"from": 0.3, "to": 0.4, "mass_flow_rate": "1 g/s"}]},
        "preinflate": {"preinflation_mass": "0.15 g", "inflow": []},
    });
    study["strategy"] = "delayed".into();
    study["grid"] = json!({"residual_gas": ["burst", "stored"]});
    let generation = plan(&study, &[]);
    let burst = &generation.points[0].job.scene;
    let windows: Vec<[f64; 3]> = burst
        .gas
        .windows
        .iter()
        .map(|window| [window.from, window.to, window.mass_flow_rate])
        .collect();
    assert_eq!(windows.len(), 2);
    assert_eq!(windows[0][0], 0.1);
    assert!((windows[0][1] - 0.11).abs() < 1e-15 && windows[0][2] == 0.005);
    assert_eq!(windows[1], [0.3, 0.4, 0.001]);
    assert_eq!((burst.gas.initial_mass, burst.release_time), (0.0, 0.1));
    let stored = &generation.points[1].job.scene;
    assert_eq!((stored.gas.initial_mass, stored.gas.windows.len()), (5e-5, 1));

    study["grid"] = json!({"strategies.delayed.inflow[0].mass_flow_rate": ["1 g/s", "2 g/s"],
        "strategies.delayed.release_time": [0, 0.1]});
    let generation = plan(&study, &[]);
    assert_eq!(generation.points.len(), 4);
    let names = |generation: &Generation| -> Vec<String> {
        generation.points[0].job.parameters.iter().map(|(name, _)| name.clone()).collect()
    };
    let varied = names(&generation);
    assert!(varied.iter().any(|name| name == "strategies.delayed.inflow[0].mass_flow_rate"));
    // A list is another axis; inflow windows are a list of their own.
    for (list, points) in [("preinflation_mass=[0, 1e-4]", 8), ("inflow=[{\"from\": 0}]", 4)] {
        let generation = plan(&study, &[&format!("strategies.delayed.{list}")]);
        assert_eq!(generation.points.len(), points, "{list}: {:?}", names(&generation));
    }

    study["grid"] = json!({"strategy": ["preinflate"], "residual_gas": ["stored"]});
    let mass = plan(&study, &[]).points[0].job.scene.gas.initial_mass;
    assert!((mass - 2e-4).abs() < 1e-18);
}

#[test]
fn overrides_come_before_expansion() {
    let study = with_grid(json!({"N": [5, 6], "M": [3]}));
    let generation = plan(&study, &["grid.N=[8]", "thickness=12.7 um", "gas.species=helium"]);
    assert_eq!(column(&generation, "N"), integers(&[8]));
    let scene = &generation.points[0].job.scene;
    assert_eq!(scene.film.thickness, 12.7e-6);
    assert!(scene.gas.species.gas_constant > 2000.0);
    // The cp of carbon dioxide changes with its temperature, unless the study gives one.
    let changes = |settings: &[&str]| plan(&study, settings).points[0].job.scene.gas.species;
    assert!(changes(&["gas.species=CO2"]).vibrates());
    let given = changes(&[r#"gas.species={"gas_constant": 188.924, "cp": 846}"#]);
    assert!(!given.vibrates() && given.cp == 846.0);

    // One value in place of an axis; one value as an axis; a list as an axis.
    let generation = plan(&study, &["N=7"]);
    assert_eq!(generation.points.len(), 1);
    assert_eq!(generation.points[0].job.scene.design.folded().unwrap().panels, 7);
    assert_eq!(column(&plan(&study, &["grid.N=7"]), "N"), integers(&[7]));
    let generation = plan(&study, &["M=[2, 4]", "N=7"]);
    assert_eq!(column(&generation, "M"), integers(&[2, 4]));
}

#[test]
fn a_filter_keeps_single_points_and_every_point_is_counted() {
    // N 6 and M 3 fold at both angles; the points repeat one of them, and leave the filter.
    let json = with_grid(json!({
        "N": [5, 6], "M": [3, 4], "filter": "N == 6 and M == 3",
        "points": [{"N": 6, "M": 3}, {"N": 5, "M": 4}]
    }));
    let study = try_study(&json, &[]).unwrap();
    let generation = next_jobs(&study, &[]).unwrap();
    assert_eq!(column(&generation, "N"), integers(&[6, 5]), "the filter is for the product");
    let counts = PlanCounts::of(&study, &generation);
    assert_eq!((counts.points, counts.duplicates, counts.filtered), (3, 1, 3));
    assert_eq!(counts.jobs + counts.infeasible, 2);
}

#[test]
fn a_generation_depends_only_on_the_finished_rows() {
    let study = try_study(&with_grid(json!({"M": [1, 3, 4]})), &[]).unwrap();
    let all = next_jobs(&study, &[]).unwrap();
    assert_eq!(all.points.len(), 3);
    let finished: Vec<FinishedRow> = all
        .points
        .iter()
        .map(|point| FinishedRow {
            id: point.job.id.clone(),
            status: Status::Done,
            verdict: None,
            limits: Vec::new(),
            minimised: vec![],
        })
        .collect();
    assert_eq!(next_jobs(&study, &finished[..2]), Some(all.clone()));
    let mut other_order = finished[1..].to_vec();
    other_order.reverse();
    // The first point is infeasible: it has a row but no job.
    assert_eq!(next_jobs(&study, &other_order), None);
    assert_eq!(next_jobs(&study, &finished), None);
}

#[test]
fn a_window_ends_when_its_mass_is_inside() {
    let study = |window: Json| {
        let mut study = capsule();
        study["solver"]["end_time"] = json!(2);
        study["strategies"] = json!({"fill": {"inflow": [window]}});
        study["strategy"] = json!("fill");
        study
    };
    let by_end = study(json!({"from": "0.5 s", "to": "0.9 s", "mass_flow_rate": "5 g/s"}));
    let by_mass = study(json!({"from": "0.5 s", "mass": "2 g", "mass_flow_rate": "5 g/s"}));
    assert_eq!(id(&by_mass), id(&by_end));
    // The rate may be that of the study, or of the grid.
    assert_eq!(id(&study(json!({"from": "0.5 s", "mass": "2 g"}))), id(&by_end));
    let both = study(json!({"from": "0.5 s", "to": "0.9 s", "mass": "2 g"}));
    let error = try_study(&both, &[]).unwrap_err().to_string();
    assert!(error.contains("strategies.fill.inflow[0].mass") && error.contains("both"), "{error}");
}

#[test]
fn values_that_a_table_shows_alike_are_noted() {
    let notes = |heights: Json| {
        let planned = TestFolder::new(&with_grid(json!({ "height": heights })));
        stderr(&planned.run(&["plan", "grid.json"]))
    };
    // 0.1 + 0.2 is not 0.3.
    let said = notes(json!([0.1 + 0.2, 0.5, 0.3]));
    let note =
        "note: height has two values that a table shows as 0.3: 0.3 and 0.30000000000000004\n";
    assert!(said.contains(note), "{said}");
    assert!(!notes(json!([0.1, 0.3, 0.3001])).contains("shows as"));
}
