//! The id of a job.
//!
//! ```text
//! id = first 16 bytes of SHA-256(canonical JSON of {physics_version, scene}), in hexadecimal digits
//! ```

use std::fmt::{self, Write as _};

use billow_solver::PHYSICS_VERSION;
use billow_solver::scene::Scene;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Bytes of the hash that an id keeps.
const ID_BYTES: usize = 16;
/// Whole numbers from here on are not all exact as `f64`: 2^53.
const FIRST_INEXACT_INTEGER: f64 = 9_007_199_254_740_992.0;

/// Id of a job: 32 lower-case hexadecimal digits, the first half of the SHA-256 of the canonical
/// JSON of its scene and the physics version.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
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
        let mut digits = String::with_capacity(2 * ID_BYTES);
        for byte in &Sha256::digest(text.as_bytes())[..ID_BYTES] {
            let _ = write!(digits, "{byte:02x}");
        }
        Self(digits)
    }

    /// The id with these digits, as read from disk; `None` for a text that is not an id.
    pub fn from_digits(digits: &str) -> Option<Self> {
        let valid = digits.len() == 2 * ID_BYTES
            && digits.bytes().all(|byte| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte));
        valid.then(|| Self(digits.to_owned()))
    }

    /// The digits.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The first eight digits, as tables print them. Commands accept any unique prefix.
    pub fn short(&self) -> &str {
        &self.0[..8]
    }
}

impl fmt::Display for JobId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Number of leading bytes that two ids have in common.
pub fn common_prefix_length(a: &str, b: &str) -> usize {
    a.bytes().zip(b.bytes()).take_while(|(a, b)| a == b).count()
}

/// Canonical JSON of plain data: no spaces, sorted keys, every number in the shortest digits that
/// read back as the same number. So 8 and 8.0 are the same, and so are −0 and 0.
///
/// # Panics
/// For data that JSON cannot hold (a map with keys that are not texts). This is a mistake in code.
pub fn canonical_json<T: Serialize>(data: &T) -> String {
    let value = serde_json::to_value(data).unwrap_or_else(|error| unreachable!("{error}"));
    let mut text = String::new();
    write_canonical(&value, &mut text);
    text
}

fn write_canonical(value: &serde_json::Value, text: &mut String) {
    match value {
        serde_json::Value::Number(number) => match number.as_f64() {
            // Larger whole numbers keep their digits: different ones would be equal as floats.
            Some(float) if float.abs() < FIRST_INEXACT_INTEGER => {
                // −0 + 0 is 0. Display writes a whole float without a decimal point.
                let _ = write!(text, "{}", float + 0.0);
            }
            _ => {
                let _ = write!(text, "{number}");
            }
        },
        serde_json::Value::Array(items) => {
            text.push('[');
            for (index, item) in items.iter().enumerate() {
                text.push_str(if index > 0 { "," } else { "" });
                write_canonical(item, text);
            }
            text.push(']');
        }
        serde_json::Value::Object(members) => {
            // Sorted here: the order must not depend on the map type.
            let mut members: Vec<_> = members.iter().collect();
            members.sort_by_key(|(key, _)| *key);
            text.push('{');
            for (index, (key, item)) in members.into_iter().enumerate() {
                text.push_str(if index > 0 { "," } else { "" });
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
    fn only_32_lower_case_hexadecimal_digits_are_an_id() {
        assert!(JobId::from_digits(&"0123456789abcdef".repeat(2)).is_some());
        for wrong in ["", "0123", &"0123456789ABCDEF".repeat(2), &"g".repeat(32)] {
            assert_eq!(JobId::from_digits(wrong), None);
        }
    }
}
