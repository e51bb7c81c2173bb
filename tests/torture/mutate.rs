//! Changes of bytes and of JSON.

use serde_json::{Value, json};

use crate::random::Random;

/// Changes of one file, at most.
const MAX_CHANGES: usize = 4;
/// Longest part that is removed, doubled or moved.
const MAX_PART: usize = 200;
/// Bytes that are put in.
const BYTES: [&[u8]; 12] =
    [b"\0", b"\xff", b"\xc3", b"\n", b"\r\n", b"{", b"}", b"]", b"\"", b"\\", b"1e999", b"-0"];
/// Numbers that are put in.
const NUMBERS: [f64; 16] =
    [0.0, -0.0, -1.0, 1.0, 2.0, 3.0, 7.0, 0.5, 1e-3, 1e3, 1e9, 1e20, -1e20, 1e-308, 5e-324, 1e308];
/// Factors of a number that stands there.
const SCALES: [f64; 13] = [-1.0, 0.0, 1e-6, 1e-3, 0.1, 0.5, 0.999, 1.001, 1.1, 2.0, 10.0, 1e3, 1e6];
/// Texts that are put in.
const TEXTS: [&str; 15] = [
    "", " ", "1", "1 m", "1e999 m", "-1 g/s", "1 m/", "NaN", "inf", "1 parsec", "\u{0}", "𝟙 m",
    "${x}", "1 / 0", "film",
];
/// Members of a long list, levels of a deep one.
const LONG: usize = 3_000;
const DEEP: usize = 300;

/// The bytes with a few changes.
pub fn bytes(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(MAX_CHANGES) {
        let at = random.below(bytes.len() + 1);
        let end = (at + 1 + random.below(MAX_PART)).min(bytes.len());
        match random.below(7) {
            0 if !bytes.is_empty() => flip(&mut bytes, random),
            1 => bytes.truncate(at),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let part = bytes[at..end].to_vec();
                let place = random.below(bytes.len() + 1);
                bytes.splice(place..place, part);
            }
            4 => bytes[at..end].reverse(),
            5 => digit(&mut bytes, at, random),
            _ => drop(bytes.splice(at..at, random.pick(&BYTES).iter().copied())),
        }
    }
    bytes
}

/// Flips one bit.
pub fn flip(bytes: &mut [u8], random: &mut Random) {
    bytes[random.below(bytes.len())] ^= 1 << random.below(8);
}

/// Changes the first digit after a place.
pub fn digit(bytes: &mut [u8], at: usize, random: &mut Random) {
    if let Some(digit) = bytes[at..].iter_mut().find(|byte| byte.is_ascii_digit()) {
        let change = u8::try_from(1 + random.below(9)).unwrap_or(1);
        *digit = b'0' + (*digit - b'0' + change) % 10;
    }
}

/// The text of a JSON value with a few changes.
pub fn json(value: &Value, random: &mut Random) -> Vec<u8> {
    let mut value = value.clone();
    for _ in 0..random.below(MAX_CHANGES).max(1) {
        let mut places = Vec::new();
        list(&value, String::new(), &mut places);
        let (place, other) = (random.pick(&places).clone(), random.pick(&places).clone());
        change(&mut value, &place, &other, random);
    }
    let text = if random.below(2) == 0 { format!("{value}") } else { format!("{value:#}") };
    if random.below(4) == 0 { bytes(text.as_bytes(), random) } else { text.into_bytes() }
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
                    // Without a fraction if it is whole.
                    let number = number.as_f64().unwrap_or(1.0) * random.pick(&SCALES);
                    serde_json::from_str(&number.to_string()).unwrap_or_default()
                }
                Value::String(text) if kind > 3 => scaled_text(text, *random.pick(&SCALES)),
                _ => other_value(random),
            };
        }
    }
}

/// A text that begins with a number, as in "500 mm", with another number; any other text is doubled.
fn scaled_text(text: &str, scale: f64) -> Value {
    let parts = text.split_once(' ');
    match parts.and_then(|(number, unit)| Some((number.parse::<f64>().ok()?, unit))) {
        Some((number, unit)) => json!(format!("{} {unit}", number * scale)),
        None => json!(text.repeat(2)),
    }
}

fn other_value(random: &mut Random) -> Value {
    match random.below(15) {
        0 => Value::Null,
        1 => json!(random.below(2) == 0),
        2..6 => json!(random.pick(&NUMBERS)),
        6..9 => json!(random.pick(&TEXTS)),
        9 => json!([]),
        10 => json!({}),
        11 => json!("x".repeat(LONG)),
        12 => json!(vec![1; LONG]),
        13 => (0..DEEP).fold(json!(1), |inner, _| json!([inner])),
        _ => json!({ "from": 0, "to": 1e9, "step": 1e-3 }),
    }
}
