//! A job: one scene to run, known by the hash of all that decides its result.

use std::fmt;

use billow_solver::scene::Scene;

use crate::value::Value;

/// Name of a job: 32 lower-case hexadecimal digits, the first half of the SHA-256 of the canonical
/// JSON of its scene and the physics version.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JobId(String);

impl JobId {
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
