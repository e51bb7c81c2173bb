//! The id of a job.
//!
//! ```text
//! id = first 16 bytes of SHA-256(canonical JSON of {physics_version, scene}), in hexadecimal digits
//! ```

use std::fmt;
use std::io::{self, Write};

use billow_solver::PHYSICS_VERSION;
use billow_solver::scene::Scene;
use serde::{Deserialize, Serialize};
use serde_json::Serializer;
use serde_json::ser::{CompactFormatter, Formatter};
use sha2::{Digest, Sha256};

/// Bytes of the hash that an id keeps.
const ID_BYTES: usize = 16;
/// Digits of an id.
const DIGITS: usize = 2 * ID_BYTES;
/// Whole numbers from here on are not all exact as `f64`: 2^53.
const FIRST_INEXACT_INTEGER: f64 = 9_007_199_254_740_992.0;

/// Id of a job: 32 lower-case hexadecimal digits, the first half of the SHA-256 of the canonical
/// JSON of its scene and the physics version.
#[derive(Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct JobId([u8; DIGITS]);

impl JobId {
    /// The id of a scene under this physics version.
    pub fn of(scene: &Scene) -> Self {
        #[derive(Serialize)]
        struct Identity<'a> {
            physics_version: u32,
            scene: &'a Scene,
        }
        let text = canonical_json(&Identity { physics_version: PHYSICS_VERSION, scene });
        let digit = |four_bits: u8| b"0123456789abcdef"[usize::from(four_bits)];
        let mut digits = [0; DIGITS];
        let hash = Sha256::digest(text.as_bytes());
        for (pair, byte) in digits.chunks_exact_mut(2).zip(&hash) {
            pair.copy_from_slice(&[digit(byte >> 4), digit(byte & 15)]);
        }
        Self(digits)
    }

    /// The id with these digits, as read from disk; `None` for a text that is not an id.
    pub fn from_digits(digits: &str) -> Option<Self> {
        let digits: [u8; DIGITS] = digits.as_bytes().try_into().ok()?;
        let is_digit = |byte: &u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(byte);
        digits.iter().all(is_digit).then_some(Self(digits))
    }

    /// The digits.
    pub fn as_str(&self) -> &str {
        // Digits are ASCII.
        std::str::from_utf8(&self.0).unwrap_or_default()
    }

    /// The first eight digits, as tables print them. Commands accept any unique prefix.
    pub fn short(&self) -> &str {
        &self.as_str()[..8]
    }
}

impl fmt::Display for JobId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Debug for JobId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl From<JobId> for String {
    fn from(id: JobId) -> Self {
        id.as_str().to_owned()
    }
}

impl TryFrom<String> for JobId {
    type Error = String;

    fn try_from(digits: String) -> Result<Self, String> {
        Self::from_digits(&digits)
            .ok_or_else(|| format!("{digits:?} is not a job id ({DIGITS} hexadecimal digits)"))
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
    // The map of a JSON value is sorted.
    let sorted = serde_json::to_value(data).unwrap_or_else(|error| unreachable!("{error}"));
    let mut text = Vec::new();
    let mut serializer = Serializer::with_formatter(&mut text, Canonical);
    sorted.serialize(&mut serializer).unwrap_or_else(|error| unreachable!("{error}"));
    String::from_utf8(text).unwrap_or_else(|error| unreachable!("{error}"))
}

/// Writes numbers in their shortest digits.
struct Canonical;

impl Formatter for Canonical {
    fn write_f64<W: ?Sized + Write>(&mut self, writer: &mut W, value: f64) -> io::Result<()> {
        #[expect(clippy::cast_possible_truncation, reason = "whole and below 2^53")]
        if value.abs() >= FIRST_INEXACT_INTEGER {
            // Larger numbers keep their exponent: their digits would look like those of a whole number.
            CompactFormatter.write_f64(writer, value)
        } else if value.fract() == 0.0 {
            // −0 too is written as 0.
            CompactFormatter.write_i64(writer, value as i64)
        } else {
            write!(writer, "{value}")
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn canonical_json_sorts_keys_and_shortens_numbers() {
        #[derive(Serialize)]
        struct Unsorted {
            b: serde_json::Value,
            a: BTreeMap<&'static str, Option<&'static str>>,
            ab: [f64; 4],
        }
        let value = Unsorted {
            b: serde_json::json!([8, 1_u64 << 60, {}]),
            a: BTreeMap::from([("y", None), ("x", Some("é\""))]),
            ab: [8.0, -0.0, 25.4e-6, 1e17],
        };
        let expected = r#"{"a":{"x":"é\"","y":null},"ab":[8,0,0.0000254,1e+17],"b":[8,1152921504606846976,{}]}"#;
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
