//! A mangled study either plans or gives an error with its file, problem and allowed values.

use std::collections::BTreeSet;
use std::fs;

use billow_study::input::study_file;
use billow_study::study::Study;
use billow_study::study::plan::next_jobs;
use serde_json::{Value as Json, json};

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

/// What a mangled text may have anywhere, separated by blanks; `é` and the byte order mark are not ASCII.
const SNIPPETS: &str = "1e999 -1e308 1e-320 -0 null true \"\" { } [ ] , : \" 99999999999999999999 \u{feff} \u{0} é \
    \\u0000 \\ud800 deg \"5\tg/s\" \"NaN\" 6.0 4294967296 {\"from\":1,\"to\":9,\"step\":1e-9} \"N\t==\" \
    {\"from\":4,\"to\":6,\"steps\":2} [[[[ \"(((((\" 0.04 \"40\tmm\" 1e-300";

fn mangle_bytes(text: &str, random: &mut Random) -> Vec<u8> {
    let snippets: Vec<&str> = SNIPPETS.split(' ').collect();
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
            3 => drop(bytes.splice(start..start, random.pick(&snippets).bytes())),
            4 => drop(bytes.splice(start..end, random.pick(&snippets).bytes())),
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
    let values = json!([
        null, true, 0, -1, 1e300, -1e-300, 6.5, 6, 1, 0.5, "5 g/s", "40 mm", "30 deg", "x", "direct", "height",
        "angles", [], {}, [5, 6], {"from": 1, "to": 2, "steps": 2}, "N > 4 and feasible", 4_294_967_301_u64,
        u64::MAX, {"bisect": [0, 1]}, "isothermal", 1000, "1 um"
    ]);
    let values = values.as_array().unwrap();
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
                    members.insert(name.to_owned(), random.pick(values).clone());
                }
                2 => drop(members.insert("strategy".to_owned(), json!(["direct"]))),
                _ => mangle_tree(&mut members[&name], random),
            }
        }
        Json::Array(items) if !items.is_empty() && random.below(4) > 0 => {
            let index = random.below(items.len());
            mangle_tree(&mut items[index], random);
        }
        other => *other = random.pick(values).clone(),
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
        let study = study_file::text_of(&bytes, "fuzz.json")
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
    println!("{planned} planned, {refused} refused");
    // Both outcomes are frequent.
    assert!(planned > 5_000 && refused > 5_000, "{planned} planned, {refused} refused");
}
