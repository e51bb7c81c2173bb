//! Invalid study files: one error each, exit code 2, empty stdout, no file written. A mangled text
//! either plans or gives an error with its file, problem and allowed values.

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;

use billow_study::input::study_file;
use billow_study::study::plan::next_jobs;
use billow_study::study::{PlanSize, Study};
use serde_json::{Value as Json, json};

/// A valid study with one value changed.
fn changed(pointer: &str, value: Json) -> Vec<u8> {
    let mut study = json!({
        "design": {"N": 6, "M": 3, "bottom_radius": 0.5, "top_radius": 0.365, "height": 1},
        "gas": {"mass_flow_rate": 0.005},
        "solver": {"model": "piston", "end_time": 0.5},
    });
    let (parent, leaf) = pointer.rsplit_once('/').unwrap();
    study.pointer_mut(parent).unwrap()[leaf] = value;
    study.to_string().into_bytes()
}

#[test]
#[expect(clippy::too_many_lines, reason = "a table of cases")]
fn every_invalid_file_gives_one_error() {
    let long = |text: &str| text.repeat(200_000);
    // Content of the file; parts of the error: key, value, problem, allowed values.
    let cases: Vec<(Vec<u8>, &[&str])> = vec![
        (b"".to_vec(), &["is empty", "allowed: JSON"]),
        (b"\xEF\xBB\xBF{}".to_vec(), &["byte order mark", "plain UTF-8"]),
        (b"{\"question\": \"\xFF\"}".to_vec(), &["not UTF-8 from byte 14"]),
        (
            b"{\"design\": {\"N\": 6,}}".to_vec(),
            &["json:1:19: design: invalid JSON: trailing comma", "  next: remove it"],
        ),
        (
            b"{\"design\": {\"N\": 6, \"N\": 5}}".to_vec(),
            &["json:1:21: design", "key \"N\" is given twice", "  1 | {"],
        ),
        (b"{\"gravity\": 1e999}".to_vec(), &["gravity", "number out of range"]),
        (b"[1, 2]".to_vec(), &["is a list, not an object"]),
        (long("[").into_bytes(), &["recursion limit"]),
        (
            changed("/desing", json!({})),
            &["desing = {}", "did you mean design?", "allowed: design"],
        ),
        (
            changed("/film", json!({"thicknes": 1})),
            &["film.thicknes = 1", "did you mean thickness?"],
        ),
        (changed("/thickness", json!(1)), &["thickness = 1", "did you mean film.thickness?"]),
        (
            changed("/design/N", json!(3)),
            &["design.N = 3", "out of range", "a whole number, 4 to 1000"],
        ),
        (changed("/design/N", json!(6.5)), &["design.N = 6.5", "not a whole number"]),
        (changed("/design/N", json!("6")), &["design.N = \"6\"", "without quotes"]),
        (
            changed("/design/height", json!("1 kg")),
            &["design.height = \"1 kg\"", "is a mass, not a length", "m, cm, mm"],
        ),
        (
            changed("/design/height", json!("1 furlong")),
            &["design.height", "unknown unit \"furlong\""],
        ),
        (changed("/design/height", json!("1000")), &["design.height = \"1000\"", "has no unit"]),
        (
            changed("/design/height", json!(null)),
            &["design.height = null", "is null, not a length"],
        ),
        (
            changed("/design/alpha1_over_phi", json!(1)),
            &["design.alpha1_over_phi = 1", "fit `cone` solves phi"],
        ),
        (changed("/design/fit", json!("height")), &["design.top_radius = 0.365", "fit `height`"]),
        (
            changed("/design/caps", json!("circular")),
            &["design.caps = \"circular\"", "cannot be sewn", "allowed: polygon"],
        ),
        (
            changed("/film", json!({"thickness": 25.4})),
            &["film.thickness = 25.4", "out of range", "um"],
        ),
        (
            changed("/solver", json!({"model": "piston"})),
            &["solver.end_time", "missing", "next: give it"],
        ),
        (
            changed("/solver/stepping", json!({"fixed": 1e-5, "adaptive": 1e-6})),
            &["solver.stepping", "both adaptive and fixed"],
        ),
        (changed("/version", json!(2)), &["version = 2", "newer format", "allowed: 1"]),
        (
            changed("/name", json!("../escape")),
            &["name = \"../escape\"", "cannot be the name of a results folder"],
        ),
        (
            changed("/strategy", json!("delaid")),
            &["strategy = \"delaid\"", "not a strategy", "direct"],
        ),
        (
            changed(
                "/strategies",
                json!({"late": {"inflow": [{"from": 3, "to": 1}]}, "direct": {"inflow": [{"from": 3, "to": 1}]}}),
            ),
            &["strategies.direct.inflow[0].to = 1", "ends before it begins"],
        ),
        (
            changed("/supports", json!([{"on": "roof", "fix": "z"}])),
            &["supports[0].on = \"roof\"", "bottom_ring, top_ring"],
        ),
        (
            changed("/supports", json!([{"on": "bottom_ring", "fix": "xy"}])),
            &["supports: model `piston` needs a fixed bottom", "allowed: at least one"],
        ),
        (
            changed(
                "/supports",
                json!([{"on": "bottom_ring", "fix": "xyz"}, {"on": "top_cap", "fix": "z"}]),
            ),
            &["supports[1].fix: model `piston` moves the top along z", "xy"],
        ),
        (changed("/gas/species", json!({"gas_constant": 300})), &["gas.species.cp", "missing"]),
        (
            changed("/outputs", json!({"sample_interval": "1 ns"})),
            &["outputs.sample_interval = 1e-9", "samples a run"],
        ),
        (changed("/grid", json!({"N": []})), &["grid.N = []", "empty axis"]),
        (changed("/grid", json!({"N": 6})), &["grid.N = 6", "not an axis", "design.N"]),
        (
            changed("/grid", json!({"N": [5, "six"]})),
            &["grid.N[1] = \"six\"", "not a whole number"],
        ),
        (
            changed("/grid", json!({"mass_flow": [1]})),
            &["grid.mass_flow = [1]", "not a key that a grid can vary"],
        ),
        (
            changed("/grid", json!({"N": [5], "design.N": [6]})),
            &["grid.design.N", "varies N", "already"],
        ),
        (
            changed("/grid", json!({"zip": [{"N": [5, 6], "M": [3]}]})),
            &["grid.zip[0].N = [5, 6]", "has 2 values, the first list 1"],
        ),
        (
            changed("/grid", json!({"mass_flow_rate": {"bisect": [0, 1]}})),
            &["grid.mass_flow_rate", "has no `on`"],
        ),
        (
            changed("/grid", json!({"seed": {"from": 0, "to": 1e15, "step": 1}})),
            &["grid.seed", "250000 points"],
        ),
        (
            changed("/grid", json!({"N": [5, 6], "filter": "N > 6"})),
            &["grid.filter = N > 6", "keeps none of the 2"],
        ),
        (
            changed("/grid", json!({"N": [5, 6], "filter": "N > bogus"})),
            &["grid.filter", "no variable is called bogus", "        ^^^^^"],
        ),
    ];
    assert!(cases.len() >= 20);
    for (number, (content, fragments)) in cases.iter().enumerate() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(format!("broken-{number}.json"));
        fs::write(&file, content).unwrap();
        let name = file.file_name().unwrap().to_str().unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_billow"))
            .args(["plan", name])
            .current_dir(folder.path())
            .output()
            .unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        let shown = String::from_utf8_lossy(&content[..content.len().min(300)]).into_owned();
        assert_eq!(output.status.code(), Some(2), "{shown}\n{stderr}");
        assert!(output.stdout.is_empty(), "{shown}");
        assert!(stderr.starts_with(&format!("billow: {name}:")), "{shown}\n{stderr}");
        assert_eq!(stderr.matches("billow: ").count(), 1, "one error: {stderr}");
        assert!(stderr.contains("allowed: "), "{stderr}");
        for fragment in *fragments {
            assert!(stderr.contains(fragment), "{fragment:?} is not in\n{stderr}");
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no file is written");
    }
}

#[test]
fn an_unreadable_file_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["absent.json", "."] {
        let output = Command::new(env!("CARGO_BIN_EXE_billow"))
            .args(["plan", name])
            .current_dir(folder.path())
            .output()
            .unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(
            stderr.starts_with(&format!("billow: {name}: cannot read the study file")),
            "{stderr}"
        );
        assert!(output.stdout.is_empty());
    }
}

/// `SplitMix64` (Steele, Lea, Flood 2014): small, seeded, the same everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, bound: usize) -> usize {
        usize::try_from(self.next() % u64::try_from(bound.max(1)).unwrap()).unwrap()
    }

    fn pick<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }
}

const SNIPPETS: &[&str] = &[
    "1e999",
    "-1e308",
    "1e-320",
    "-0",
    "null",
    "true",
    "\"\"",
    "{",
    "}",
    "[",
    "]",
    ",",
    ":",
    "\"",
    "99999999999999999999",
    "\u{feff}",
    "\u{0}",
    "é",
    "\\u0000",
    "\\ud800",
    " deg",
    "\"5 g/s\"",
    "\"NaN\"",
    "6.0",
    "4294967296",
    "{\"from\": 1, \"to\": 9, \"step\": 1e-9}",
    "\"N == \"",
    "{\"from\": 4, \"to\": 6, \"steps\": 2}",
    "[[[[",
    "\"(((((\"",
    "0.04",
    "\"40 mm\"",
    "1e-300",
];

fn mangle_bytes(text: &str, random: &mut Random) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=random.below(3) {
        let start = random.below(bytes.len());
        let end = (start + random.below(12)).min(bytes.len());
        match random.below(6) {
            0 => bytes[start] = u8::try_from(random.below(256)).unwrap(),
            1 => drop(bytes.drain(start..end)),
            2 => {
                let copy = bytes[start..end].to_vec();
                let target = random.below(bytes.len());
                bytes.splice(target..target, copy);
            }
            3 => drop(bytes.splice(start..start, random.pick(SNIPPETS).bytes())),
            4 => drop(bytes.splice(start..end, random.pick(SNIPPETS).bytes())),
            _ => {
                if let Some(digit) = bytes.iter_mut().skip(start).find(|byte| byte.is_ascii_digit())
                {
                    *digit = b'0' + u8::try_from(random.below(10)).unwrap();
                }
            }
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

fn mangle_tree(json: &mut Json, random: &mut Random) {
    let values = [
        json!(null),
        json!(true),
        json!(0),
        json!(-1),
        json!(1e300),
        json!(-1e-300),
        json!(6.5),
        json!(6),
        json!(1),
        json!(0.5),
        json!("5 g/s"),
        json!("40 mm"),
        json!("30 deg"),
        json!("x"),
        json!("direct"),
        json!("height"),
        json!("angles"),
        json!([]),
        json!({}),
        json!([5, 6]),
        json!({"from": 1, "to": 2, "steps": 2}),
        json!("N > 4 and feasible"),
        json!(4_294_967_301_u64),
        json!(u64::MAX),
        json!({"bisect": [0, 1]}),
        json!("isothermal"),
        json!(1000),
        json!("1 um"),
    ];
    match json {
        Json::Object(members) if !members.is_empty() && random.below(4) > 0 => {
            let names: Vec<String> = members.keys().cloned().collect();
            let name = random.pick(&names).clone();
            match random.below(10) {
                0 => drop(members.remove(&name)),
                1 => {
                    let keys = billow_study::input::keys::KEYS;
                    let key = random.pick(keys);
                    let name = if random.below(2) == 0 { key.leaf() } else { key.path };
                    members.insert(name.to_owned(), random.pick(&values).clone());
                }
                2 => drop(members.insert("strategy".to_owned(), json!(["direct"]))),
                _ => mangle_tree(&mut members[&name], random),
            }
        }
        Json::Array(items) if !items.is_empty() && random.below(4) > 0 => {
            let index = random.below(items.len());
            mangle_tree(&mut items[index], random);
        }
        other => *other = random.pick(&values).clone(),
    }
}

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
fn a_hundred_thousand_mangled_studies_plan_or_name_their_error() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../studies");
    let studies: Vec<Json> = ["first.json", "designs.json", "strategies.json", "folds.json"]
        .iter()
        .map(|name| shortened(&folder.join(name)))
        .collect();
    let texts: Vec<String> = studies.iter().map(|study| format!("{study:#}")).collect();
    let mut random = Random(20_261_121);
    let (mut planned, mut refused) = (0_u32, 0_u32);
    for round in 0..100_000_u32 {
        let which = random.below(studies.len());
        let bytes = if round % 2 == 0 {
            mangle_bytes(&texts[which], &mut random)
        } else {
            let mut study = studies[which].clone();
            for _ in 0..=random.below(2) {
                mangle_tree(&mut study, &mut random);
            }
            study.to_string().into_bytes()
        };
        let study = study_file::text_of(&bytes, "fuzz.json").and_then(|text| {
            Study::from_text(text, "fuzz.json", "fuzz", &[], PlanSize { points: 24 })
        });
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
    println!("{planned} planned, {refused} refused");
    // Both outcomes are frequent.
    assert!(planned > 5_000 && refused > 5_000, "{planned} planned, {refused} refused");
}
