//! Changes of the structure of a JSON file.

use serde_json::{Map, Value, json};

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
        let target = random.below(size(&value));
        change(&mut value, target, random);
    }
    let text = if random.below(2) == 0 {
        serde_json::to_string(&value)
    } else {
        serde_json::to_string_pretty(&value)
    };
    text.unwrap_or_default().into_bytes()
}

/// Number of values in a tree.
fn size(value: &Value) -> usize {
    1 + match value {
        Value::Array(items) => items.iter().map(size).sum(),
        Value::Object(members) => members.values().map(size).sum::<usize>(),
        _ => 0,
    }
}

/// Changes the value with that number, counted from the root.
fn change(value: &mut Value, target: usize, random: &mut Random) {
    if target == 0 {
        return change_here(value, random);
    }
    let mut rest = target - 1;
    let children: Vec<&mut Value> = match value {
        Value::Array(items) => items.iter_mut().collect(),
        Value::Object(members) => members.values_mut().collect(),
        _ => return,
    };
    for child in children {
        let size = size(child);
        if rest < size {
            return change(child, rest, random);
        }
        rest -= size;
    }
}

fn change_here(value: &mut Value, random: &mut Random) {
    match value {
        Value::Object(members) if random.below(4) > 0 => change_members(members, random),
        Value::Array(items) if !items.is_empty() && random.below(4) > 0 => {
            change_items(items, random);
        }
        Value::Number(number) if random.below(4) > 0 => {
            *value = number_value(number.as_f64().unwrap_or(1.0) * random.pick(&SCALES));
        }
        Value::String(text) if random.below(4) > 0 => {
            let other = scaled_text(text, *random.pick(&SCALES));
            *value = other.map_or_else(|| other_value(random), Value::String);
        }
        _ => *value = other_value(random),
    }
}

/// A number, without a fraction if it is whole.
fn number_value(number: f64) -> Value {
    let whole = number.fract() == 0.0 && number.abs() < MAX_WHOLE;
    let integer = whole.then(|| format!("{number:.0}").parse::<i64>().ok()).flatten();
    integer.map_or_else(|| json!(number), |integer| json!(integer))
}

/// A text that begins with a number, as in "500 mm", with another number.
fn scaled_text(text: &str, scale: f64) -> Option<String> {
    let (number, unit) = text.split_once(' ')?;
    let number: f64 = number.parse().ok()?;
    Some(format!("{} {unit}", number * scale))
}

fn change_members(members: &mut Map<String, Value>, random: &mut Random) {
    let names: Vec<String> = members.keys().cloned().collect();
    if names.is_empty() {
        return drop(members.insert("x".to_owned(), other_value(random)));
    }
    let name = random.pick(&names).clone();
    let other = random.pick(&names).clone();
    match random.below(5) {
        0 => drop(members.remove(&name)),
        1 => {
            let value = members.remove(&name).unwrap_or_default();
            members.insert(format!("{name}s"), value);
        }
        2 => {
            let (a, b) = (members[&name].clone(), members[&other].clone());
            members.insert(name, b);
            members.insert(other, a);
        }
        3 => {
            let copy = members[&name].clone();
            members.insert(other, copy);
        }
        _ => drop(members.insert(name, other_value(random))),
    }
}

fn change_items(items: &mut Vec<Value>, random: &mut Random) {
    let (a, b) = (random.below(items.len()), random.below(items.len()));
    match random.below(5) {
        0 => drop(items.remove(a)),
        1 => items.insert(a, items[b].clone()),
        2 => items.swap(a, b),
        3 => items.clear(),
        _ => items[a] = other_value(random),
    }
}

fn other_value(random: &mut Random) -> Value {
    match random.below(12) {
        0 => Value::Null,
        1 => json!(random.below(2) == 0),
        2..6 => json!(random.pick(&NUMBERS)),
        6..9 => json!(random.pick(&TEXTS)),
        9 => json!([]),
        10 => json!({}),
        _ => match random.below(4) {
            0 => json!("x".repeat(LONG)),
            1 => json!(vec![1; LONG]),
            2 => (0..DEEP).fold(json!(1), |inner, _| json!([inner])),
            _ => json!({ "from": 0, "to": 1e9, "step": 1e-3 }),
        },
    }
}
