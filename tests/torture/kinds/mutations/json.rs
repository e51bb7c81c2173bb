//! Changes of the structure of a JSON file.

use serde_json::{Value, json};

use crate::harness::random::Random;

/// Changes of one file, at most.
const MAX_CHANGES: usize = 3;
/// Numbers that are put in.
const NUMBERS: [f64; 16] = [
    0.0,
    -0.0,
    -1.0,
    1.0,
    2.0,
    3.0,
    7.0,
    0.5,
    1e-3,
    1e3,
    1e9,
    1e20,
    -1e20,
    1e-308,
    5e-324,
    f64::MAX,
];
/// Factors of a number that stands there.
const SCALES: [f64; 13] = [-1.0, 0.0, 1e-6, 1e-3, 0.1, 0.5, 0.999, 1.001, 1.1, 2.0, 10.0, 1e3, 1e6];
/// Whole numbers up to this one have no other neighbour in `f64`.
const MAX_WHOLE: f64 = 9e15;
/// Texts that are put in.
const TEXTS: [&str; 15] = [
    "", " ", "1", "1 m", "1e999 m", "-1 g/s", "1 m/", "NaN", "inf", "1 parsec", "\u{0}", "𝟙 m",
    "${x}", "1 / 0", "film",
];
/// Members of a long list.
const LONG: usize = 3_000;
/// Levels of a deep list.
const DEEP: usize = 300;

/// The text of a value with a few changes.
pub fn mutated(value: &Value, random: &mut Random) -> Vec<u8> {
    let mut value = value.clone();
    for _ in 0..=random.below(MAX_CHANGES) {
        let mut places = Vec::new();
        list(&value, String::new(), &mut places);
        let (place, other) = (random.pick(&places).clone(), random.pick(&places).clone());
        change(&mut value, &place, &other, random);
    }
    let text = if random.below(2) == 0 {
        serde_json::to_string(&value)
    } else {
        serde_json::to_string_pretty(&value)
    };
    text.unwrap_or_default().into_bytes()
}

/// The JSON pointers of a value and of all values in it.
fn list(value: &Value, at: String, places: &mut Vec<String>) {
    match value {
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(index, item)| {
                list(item, format!("{at}/{index}"), places);
            });
        }
        Value::Object(members) => {
            members.iter().for_each(|(name, member)| list(member, format!("{at}/{name}"), places));
        }
        _ => {}
    }
    places.push(at);
}

/// Changes the value at a place, or its name; `other`: another place.
fn change(value: &mut Value, place: &str, other: &str, random: &mut Random) {
    let other = value.pointer(other).cloned().unwrap_or_default();
    let (parent, name) = place.rsplit_once('/').unwrap_or_default();
    match (random.below(6), value.pointer_mut(parent)) {
        (0, Some(Value::Object(members))) => drop(members.remove(name)),
        (1, Some(Value::Object(members))) => {
            let member = members.remove(name).unwrap_or_default();
            members.insert(format!("{name}s"), member);
        }
        (0 | 1, Some(Value::Array(items))) if !items.is_empty() => {
            items.remove(random.below(items.len()));
        }
        (2, Some(Value::Array(items))) => items.push(other),
        (kind, _) => {
            let Some(here) = value.pointer_mut(place) else { return };
            *here = match here {
                _ if kind == 2 => other,
                Value::Number(number) if kind > 3 => {
                    number_value(number.as_f64().unwrap_or(1.0) * random.pick(&SCALES))
                }
                Value::String(text) if kind > 3 => scaled_text(text, *random.pick(&SCALES)),
                _ => other_value(random),
            };
        }
    }
}

/// A number, without a fraction if it is whole.
fn number_value(number: f64) -> Value {
    let whole = number.fract() == 0.0 && number.abs() < MAX_WHOLE;
    let integer = whole.then(|| format!("{number:.0}").parse::<i64>().ok()).flatten();
    integer.map_or_else(|| json!(number), |integer| json!(integer))
}

/// A text that begins with a number, as in "500 mm", with another number; any other text is doubled.
fn scaled_text(text: &str, scale: f64) -> Value {
    let parts = text.split_once(' ');
    match parts.and_then(|(number, unit)| Some((number.parse::<f64>().ok()?, unit))) {
        Some((number, unit)) => json!(format!("{} {unit}", number * scale)),
        None => json!(format!("{text}{text}")),
    }
}

fn other_value(random: &mut Random) -> Value {
    match random.below(12) {
        0 => Value::Null,
        1 => json!(random.below(2) == 0),
        2..6 => json!(random.pick(&NUMBERS)),
        6..9 => json!(random.pick(&TEXTS)),
        9 => json!(random.pick(&[json!([]), json!({})])),
        10 => json!("x".repeat(LONG)),
        _ => match random.below(3) {
            0 => json!(vec![1; LONG]),
            1 => (0..DEEP).fold(json!(1), |inner, _| json!([inner])),
            _ => json!({ "from": 0, "to": 1e9, "step": 1e-3 }),
        },
    }
}
