//! A job: one scene to run, known by the hash of all that decides its result.

pub mod executor;
pub mod point;
pub mod references;
pub mod row;

use std::fmt::{self, Write as _};

use billow_solver::PHYSICS_VERSION;
use billow_solver::scene::Scene;
use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::input::value::Value;

/// Name of a job: 32 lower-case hexadecimal digits, the first half of the SHA-256 of the canonical
/// JSON of its scene and the physics version.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JobId(String);

impl JobId {
    /// The id of a scene under this physics version.
    pub fn of(scene: &Scene) -> Self {
        #[derive(Serialize)]
        struct Identity<'a> {
            physics_version: u32,
            scene: &'a Scene,
        }
        let text = canonical_json(&Identity { physics_version: PHYSICS_VERSION, scene });
        let mut digits = String::with_capacity(32);
        for byte in &Sha256::digest(text.as_bytes())[..16] {
            let _ = write!(digits, "{byte:02x}");
        }
        Self(digits)
    }

    /// Wraps the digits of an id read back from disk.
    pub fn from_digits(digits: &str) -> Option<Self> {
        let sound = digits.len() == 32
            && digits.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b));
        sound.then(|| Self(digits.to_owned()))
    }

    /// The digits.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The first eight digits, as tables print it; commands accept any unique prefix.
    pub fn short(&self) -> &str {
        &self.0[..8]
    }
}

impl fmt::Display for JobId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// The varied parameters of a point, in the order of the study's axes: name and value (SI).
pub type Parameters = Vec<(String, Value)>;

/// Parameters as "N=5 M=2".
pub fn label(parameters: &Parameters) -> String {
    let texts: Vec<String> =
        parameters.iter().map(|(name, value)| format!("{name}={value}")).collect();
    texts.join(" ")
}

/// How many leading characters two ids have in common.
pub fn agreement(one: &str, other: &str) -> usize {
    one.bytes().zip(other.bytes()).take_while(|(one, other)| one == other).count()
}

/// One scene to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// Name.
    pub id: JobId,
    /// The parameters that tell it from its neighbours.
    pub parameters: Parameters,
    /// All that is computed.
    pub scene: Scene,
}

/// Canonical JSON of plain data: no spaces, keys sorted, every number in the shortest digits that
/// read back as it, so that 8 and 8.0, −0 and 0 are the same.
///
/// # Panics
/// For data JSON cannot hold (a map with keys that are no text): a mistake in code.
pub fn canonical_json<T: Serialize>(data: &T) -> String {
    let value = serde_json::to_value(data).unwrap_or_else(|error| unreachable!("{error}"));
    let mut text = String::new();
    write_canonical(&value, &mut text);
    text
}

fn write_canonical(value: &serde_json::Value, text: &mut String) {
    match value {
        serde_json::Value::Number(number) => match number.as_f64() {
            // Whole numbers beyond 2^53 keep their own digits: as floats they would collide.
            Some(float) if float.abs() < 9_007_199_254_740_992.0 => {
                // −0 + 0 is 0; Display writes a whole float without a point, in shortest digits.
                let _ = write!(text, "{}", float + 0.0);
            }
            _ => {
                let _ = write!(text, "{number}");
            }
        },
        serde_json::Value::Array(items) => {
            text.push('[');
            for (at, item) in items.iter().enumerate() {
                text.push_str(if at > 0 { "," } else { "" });
                write_canonical(item, text);
            }
            text.push(']');
        }
        serde_json::Value::Object(members) => {
            // Sorted here, whatever order the map keeps.
            let mut members: Vec<_> = members.iter().collect();
            members.sort_by_key(|(key, _)| *key);
            text.push('{');
            for (at, (key, item)) in members.into_iter().enumerate() {
                text.push_str(if at > 0 { "," } else { "" });
                let _ = write!(text, "{}:", serde_json::Value::from(key.as_str()));
                write_canonical(item, text);
            }
            text.push('}');
        }
        other => {
            let _ = write!(text, "{other}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn canonical_json_sorts_keys_and_shortens_numbers() {
        let value =
            serde_json::json!({"b": [8.0, 8, -0.0, 0.04, 25.4e-6], "a": {"y": null, "x": "é\""}});
        let expected = r#"{"a":{"x":"é\"","y":null},"b":[8,8,0,0.04,0.0000254]}"#;
        assert_eq!(canonical_json(&value), expected);
    }

    #[test]
    fn ids_read_back_are_checked() {
        assert!(JobId::from_digits(&"0123456789abcdef".repeat(2)).is_some());
        for wrong in ["", "0123", &"0123456789ABCDEF".repeat(2), &"g".repeat(32)] {
            assert_eq!(JobId::from_digits(wrong), None);
        }
    }
}
