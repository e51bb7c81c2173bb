//! `billow-checks bench`: every measurement is present and positive. No test asserts a speed.

use std::process::Output;

use billow_solver::platform::simd::InstructionSet;
use billow_solver::platform::stopwatch::Stage;
use serde_json::Value;

use crate::support::{checks, stderr};

const TARGETS: [&str; 12] = [
    "step_without_contact_n16",
    "speedup_over_reference_n16",
    "step_to_100_ms_n8",
    "step_to_100_ms_n16",
    "step_to_1500_ms_n8",
    "seconds_to_1500_ms_n8",
    "seconds_to_300_ms_n16",
    "hybrid_delayed_n8",
    "hybrid_preinflate_n8",
    "hybrid_delayed_n16",
    "hybrid_preinflate_n16",
    "mesh_scaling",
];

fn bench(flags: &[&str]) -> Output {
    checks(&[&["bench"], flags].concat()).output().expect("the binary runs")
}

fn report(flags: &[&str]) -> Value {
    let output = bench(flags);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

fn rows<'a>(report: &'a Value, name: &str) -> &'a [Value] {
    report[name].as_array().unwrap_or_else(|| panic!("{name}: rows"))
}

fn positive(row: &Value, key: &str) -> f64 {
    let value = row[key].as_f64().unwrap_or_else(|| panic!("{key}: a number in {row}"));
    assert!(value > 0.0 && value.is_finite(), "{key} in {row}");
    value
}

/// The instruction set of a row is available on this machine.
fn has_an_available_instruction_set(row: &Value) {
    let named = |set: &InstructionSet| set.available() && row["instruction_set"] == set.name();
    assert!(InstructionSet::ALL.iter().any(named), "{row}");
}

#[test]
fn every_part_has_its_rows() {
    let report = report(&["--quick", "--subdivisions", "1,2", "--json", "-q"]);
    assert_eq!(report["effort"], "quick");
    let machine = &report["machine"][0];
    has_an_available_instruction_set(machine);
    for key in ["cores", "copy_bytes_per_second", "cached_copy_bytes_per_second"] {
        positive(machine, key);
    }

    let stages = rows(&report, "stages");
    let at = |row: &Value| (row["subdivisions"].as_u64(), row["state"].as_str().map(str::to_owned));
    let found: Vec<_> = stages.iter().map(at).collect();
    let expected = [1, 2]
        .into_iter()
        .flat_map(|n| ["stowed", "rising", "end"].map(|state| (Some(n), Some(state.to_owned()))));
    assert_eq!(found, expected.collect::<Vec<_>>());
    for row in stages {
        let n = row["subdivisions"].as_u64().expect("a count");
        assert_eq!(row["elements"].as_u64(), Some(48 * n * n));
        // Null on a system that does not say.
        assert!(row.get("core_share").is_some(), "{row}");
        // Broad phase and monitor may have no work in a short run; their rows are still present.
        for stage in Stage::ALL {
            assert!(row[stage.name()].as_f64() >= Some(0.0), "{}: {row}", stage.name());
        }
        for key in ["membrane", "update", "output", "whole", "steps_per_second", "wall_per_second"]
        {
            positive(row, key);
        }
        let wall = 1e-9
            * positive(row, "whole")
            * positive(row, "elements")
            * positive(row, "steps_per_second");
        assert!((wall / positive(row, "wall_per_second") - 1.0).abs() < 1e-9, "{row}");
    }

    for row in rows(&report, "kernels") {
        has_an_available_instruction_set(row);
        positive(row, "ns_per_element_step");
    }
    let kernel =
        |name: &str| rows(&report, "kernels").iter().filter(|row| row["kernel"] == name).count();
    let sets = InstructionSet::ALL.iter().filter(|set| set.available()).count();
    assert_eq!(kernel("reference"), 2);
    assert_eq!((kernel("step"), kernel("film")), (2 * sets, 2 * sets));

    for row in rows(&report, "cases") {
        let steps = positive(row, "steps") * positive(row, "elements");
        let cost = 1e9 * positive(row, "wall_seconds") / steps;
        assert!((cost / positive(row, "ns_per_element_step") - 1.0).abs() < 1e-9, "{row}");
        assert_eq!((&row["passages"], &row["end_time"]), (&0.into(), &0.05.into()));
        assert!(row["ledger_residual"].as_f64() < Some(1e-2), "{row}");
    }
    assert_eq!(rows(&report, "cases").len(), 2);

    let hybrid = rows(&report, "hybrid");
    let runs = ["delayed", "preinflate"].map(|name| (name, ["explicit", "hybrid"]));
    let runs = [1, 2].into_iter().flat_map(|n| runs.map(|(strategy, pair)| (n, strategy, pair)));
    assert_eq!(hybrid.len(), 8);
    for (pair, (n, strategy, integrators)) in hybrid.chunks(2).zip(runs) {
        for (row, integrator) in pair.iter().zip(integrators) {
            assert_eq!(
                (&row["subdivisions"], &row["strategy"], &row["integrator"], &row["passages"]),
                (&n.into(), &strategy.into(), &integrator.into(), &0.into())
            );
            assert!(row["ledger_residual"].as_f64() < Some(1e-2), "{row}");
            assert!((positive(row, "elements") - f64::from(48 * n * n)).abs() < 0.5);
            positive(row, "steps");
        }
        let [explicit, hybrid] = pair else { panic!("a pair of runs") };
        let over = positive(explicit, "wall_seconds") / positive(hybrid, "wall_seconds");
        assert!(explicit["speedup"].is_null(), "{explicit}");
        assert!((over / positive(hybrid, "speedup") - 1.0).abs() < 1e-9, "{hybrid}");
        let volumes = positive(explicit, "volume") / positive(hybrid, "volume");
        assert!((volumes - 1.0).abs() < 0.1, "{explicit} {hybrid}");
    }

    let statics = rows(&report, "statics");
    assert_eq!(statics.len(), 2);
    for row in statics {
        assert!(positive(row, "states") >= 3.0, "{row}");
        positive(row, "wall_seconds");
    }

    // A quick bench of small meshes measures no target.
    let targets = rows(&report, "targets");
    let names: Vec<&str> = targets.iter().filter_map(|row| row["target"].as_str()).collect();
    assert_eq!(names, TARGETS);
    for row in targets {
        assert!(row["measured"].is_null() && row["met"].is_null(), "{row}");
        positive(row, "bound");
    }
    let unmeasured: Vec<&str> =
        rows(&report, "not_measured").iter().filter_map(Value::as_str).collect();
    assert_eq!((unmeasured, &report["targets_met"]), (TARGETS.to_vec(), &Value::Bool(false)));
}

#[test]
fn parts_are_selected_by_name() {
    let flags = ["--quick", "--subdivisions", "1", "--only", "cases", "--json"];
    let output = bench(&flags);
    let report: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    assert_eq!(rows(&report, "cases").len(), 1);
    for other in ["kernels", "stages", "hybrid", "statics"] {
        assert!(rows(&report, other).is_empty(), "{other}");
    }
    assert!(report["machine"][0]["copy_bytes_per_second"].is_null());
    assert!(stderr(&output).contains("run, n 1, 0.05 s"), "{}", stderr(&output));

    let flags = ["--quick", "--subdivisions", "1", "--only", "cases,kernels", "-q"];
    let table = bench(&flags);
    assert!(table.status.success() && table.stderr.is_empty(), "{}", stderr(&table));
    let text = String::from_utf8_lossy(&table.stdout).into_owned();
    for title in
        ["machine\n", "kernels\n", "cases\n", "targets\n", "targets met: no (not measured: "]
    {
        assert!(text.contains(title), "{title}: {text}");
    }
    assert!(!text.contains("stages\n"), "{text}");

    let csv = bench(&[&flags[..], &["--format", "csv"]].concat());
    let text = String::from_utf8_lossy(&csv.stdout).into_owned();
    assert!(text.starts_with("part,row,name,value\nmachine,0,cpu,"), "{text}");
    assert!(text.contains("\ncases,0,ns_per_element_step,"), "{text}");
    assert!(text.contains("\ntargets,0,target,step_without_contact_n16\n"), "{text}");
}

#[test]
fn invalid_flags_are_bad_input() {
    for (flags, words) in [
        (&["--only", "membrane"][..], "membrane"),
        (&["--subdivisions", "0"], "--subdivisions"),
        (&["--subdivisions", "five"], "five"),
        (&["--quick", "--full"], "cannot be used with"),
    ] {
        let output = bench(flags);
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {}", stderr(&output));
        assert!(output.stdout.is_empty());
        assert!(stderr(&output).contains(words), "{flags:?}: {}", stderr(&output));
    }
    let output = checks(&["bench", "--quick"]).env("BILLOW_SIMD", "neon").output();
    let output = output.expect("the binary runs");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("BILLOW_SIMD = neon: unknown instruction set"),
        "{}",
        stderr(&output)
    );
}
