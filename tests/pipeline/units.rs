//! Units of the study in tables, answers and charts; likely forgotten units; keys of the study as columns.

use std::fs;

use serde_json::{Value, json};

use crate::support::{TestFolder, grid, json_of, paper_design, small_grid, stderr};

/// Two flow rates in g/s, one temperature in °C, a loss factor in %.
fn study() -> Value {
    let mut study = grid(&json!({
        "mass_flow_rate": ["1 g/s", 0.005], "inflow_temperature": ["20 degC"]
    }));
    study["design"]["N"] = json!(5);
    study["design"]["M"] = json!(3);
    study["design"]["alpha1_over_phi"] = json!(1);
    study["film"] = json!({"loss_factor": "1.5 %"});
    study
}

/// Lines of a table as words.
fn words(table: &str) -> Vec<Vec<&str>> {
    table.lines().map(|line| line.split_whitespace().collect()).collect()
}

#[test]
fn tables_show_the_units_of_the_study() {
    let folder = TestFolder::new(&study());
    let said = folder.stdout(&["run", "grid.json", "-q"]);
    assert!(said.contains("mass_flow_rate=5 g/s"), "{said}");
    assert!(said.contains("inflow_temperature=20 degC"), "{said}");
    assert!(said.contains("median t_90_z_rim_since_release 0.1225 s with 5 g/s (best)"), "{said}");
    assert!(said.contains("--by mass_flow_rate --base \"1 g/s\""), "{said}");

    let columns = ["--columns", "mass_flow_rate,inflow_temperature,t_90_z_rim"];
    let table = |more: &[&str]| folder.stdout(&[&["table", "-q"], &columns[..], more].concat());
    let shown = table(&[]);
    assert_eq!(words(&shown)[1], ["(g/s)", "(degC)", "(s)"]);
    assert_eq!(words(&shown)[2][..2], ["1", "20"]);
    assert_eq!(words(&shown)[3][..2], ["5", "20"]);
    let si = table(&["--si"]);
    assert_eq!(words(&si)[1], ["(kg/s)", "(K)", "(s)"]);
    assert_eq!(words(&si)[2][..2], ["0.001", "293.15"]);
    let asked = table(&["--units", "t_90_z_rim=ms,gas.mass_flow_rate=kg/h"]);
    assert_eq!(words(&asked)[1], ["(kg/h)", "(degC)", "(ms)"]);
    assert_eq!(words(&asked)[2][0], "3.6");
    // Outputs for programs are SI.
    assert_eq!(folder.rows("results/grid")[0]["mass_flow_rate"], 0.001);
    assert_eq!(table(&["--format", "csv"]), table(&["--format", "csv", "--si"]));
    assert!(table(&["--format", "csv"]).contains("\n0.001,293.15,"));

    // Units of the study, which are no other study.
    let mut other = study();
    other["units"] = json!({"t_90_z_rim": "us"});
    fs::write(folder.path().join("grid.json"), other.to_string()).unwrap();
    let output = folder.run(&["table", "grid.json"]);
    assert!(!stderr(&output).contains("is not the study"), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("(us)"));

    let plan = folder.stdout(&["plan", "grid.json", "-q"]);
    assert!(["(g/s)", "(degC)"].iter().all(|unit| words(&plan)[1].contains(unit)), "{plan}");
    let by = ["compare", "-q", "--by", "mass_flow_rate", "--base", "1 g/s"];
    let compared = folder.stdout(&by);
    assert!(words(&compared)[1].starts_with(&["(degC)", "(g/s)", "(s)"]), "{compared}");
}

#[test]
fn a_likely_forgotten_unit_is_a_warning() {
    let mut axes = small_grid()["grid"].clone();
    axes["residual_gas_mass"] = json!([0.05]);
    axes["mass_flow_rate"] = json!([1, 2, "800 g/s"]);
    let folder = TestFolder::new(&grid(&axes));
    let plan = stderr(&folder.run(&["plan", "grid.json"]));
    for expected in [
        "warning: grid.json: grid.residual_gas_mass[0] = 0.05: is 0.05 kg, outside the plausible range, \
         0 to 0.02 kg: is a unit missing?\n  next: if 0.05 g is meant, write \"0.05 g\"",
        "grid.mass_flow_rate[0] = 1 (and 1 more): is 1 kg/s",
        "grid.mass_flow_rate[2] = \"800 g/s\": is outside the plausible range, 0 to 500 g/s\n",
    ] {
        assert!(plan.contains(expected), "{plan}");
    }
    let set = stderr(&folder.run(&["plan", "grid.json", "--set", "solver.end_time=500"]));
    assert!(set.contains("warning: --set solver.end_time=500: solver.end_time = 500: is 500 s"));
    assert!(!stderr(&folder.run(&["plan", "grid.json", "-q"])).contains("warning"));
    let sane = TestFolder::new(&small_grid());
    assert!(!stderr(&sane.run(&["run", "grid.json"])).contains("warning"));
}

#[test]
fn times_that_do_not_fit_the_run_are_warnings() {
    let mut study = study();
    study["strategies"] = json!({
        "late": {"inflow": [{"from": "700 ms"}]},
        "long": {"inflow": [{"from": 0, "to": "2 s"}]},
        "hold": {"release_time": "590 ms"},
        "unused": {"inflow": [{"from": "9 s"}]},
    });
    study["grid"] = json!({
        "strategy": ["direct", "late", "long", "hold"], "residual_gas_mass": ["10 g"]
    });
    study["gas"] = json!({"mass_flow_rate": "5 g/s"});
    study["outputs"] = json!({"sample_interval": "100 ms"});
    let folder = TestFolder::new(&study);
    for command in ["plan", "run"] {
        let said = stderr(&folder.run(&[command, "grid.json"]));
        for expected in [
            "gas.residual_gas_mass = 0.01 kg (and 3 more): enters at gas.burst_rate (0.005 kg/s) \
             for 2 s, beyond solver.end_time (0.6 s): only 30 % enter",
            "strategies.late.inflow[0].from = 0.7 s: is after solver.end_time (0.6 s)",
            "strategies.long.inflow[0].to = 2 s: is after solver.end_time (0.6 s): the part after it, \
             70 % of its gas, is ignored",
            "strategies.hold.release_time = 0.59 s: leaves 0.01 s of a run of 0.6 s",
            "outputs.sample_interval = 0.1 s (and 3 more): gives 7 sample(s) in a run of 0.6 s",
        ] {
            assert!(said.contains(expected), "{expected}: {said}");
        }
        assert!(!said.contains("unused"), "{said}");
    }
}

#[test]
fn a_scene_warns_as_well() {
    let scene = json!({
        "design": paper_design(1),
        "film": {"density": 1.4},
        "gas": {"windows": [{"from": 0, "to": 1, "mass_flow_rate": "5 g/s"}]},
        "solver": {"end_time": "1 us"},
        "outputs": {"sample_interval": 1, "frames": 0},
    });
    let folder = TestFolder::new(&scene);
    let output = folder.run(&["solve", "grid.json"]);
    let said = stderr(&output);
    for expected in [
        "film.density = 1.4: is 1.4 kg/m3, outside the plausible range",
        "if 1.4 g/cm3 is meant",
        "gas.windows[0].to = 1 s: is after solver.end_time (1e-6 s)",
        "outputs.sample_interval = 1 s: gives 1 sample(s) in a run of 1e-6 s",
    ] {
        assert!(said.contains(expected), "{expected}: {said}");
    }
}

/// The studies of the README; those of `studies/` are planned where their job ids are tested.
#[test]
fn studies_of_the_readme_give_no_warning() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let readme = fs::read_to_string(format!("{root}/README.md")).unwrap();
    let blocks = readme.split("```json\n").skip(1).filter_map(|rest| rest.split("```").next());
    let folder = TestFolder::new(&study());
    for block in blocks {
        fs::write(folder.path().join("readme.json"), block).unwrap();
        let output = folder.run(&["plan", "readme.json"]);
        assert!(output.status.success(), "{block}: {}", stderr(&output));
        assert!(!stderr(&output).contains("warning"), "{block}: {}", stderr(&output));
    }
}

#[test]
fn keys_of_the_study_are_columns() {
    let folder = TestFolder::finished(&study());
    let condition = "film.loss_factor > 1 % and design.N == 5 and gas.mass_flow_rate > '2 g/s'";
    let columns = "film.loss_factor,design.N,end_time,gas.mass_flow_rate,solver.model";
    let asked = ["table", "-q", "--where", condition, "--columns", columns];
    let table = folder.stdout(&asked);
    assert_eq!(words(&table)[0].join(","), columns);
    assert_eq!(words(&table)[1], ["(%)", "(s)", "(g/s)"]);
    assert_eq!(words(&table)[2..], [["1.5", "5", "0.6", "5", "piston"]]);
    assert_eq!(json_of(&folder, &asked)[0]["film.loss_factor"], 0.015);
    let sorted = folder.stdout(&["table", "-q", "--sort", "final_temperature:desc"]);
    assert!(words(&sorted)[0].contains(&"final_temperature"), "{sorted}");
}
