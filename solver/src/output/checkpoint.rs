//! Checkpoints: the complete state of a film run as text, exact to the bit.
//!
//! ```text
//! {"checksum": "…", "format": "billow-checkpoint", "version": 7, "physics_version": …, "scene": "…",
//!  "state": …, "run": …}
//! ```
//!
//! JSON with its checksum ([`crate::platform::seal`]); every number has the shortest digits that read back to
//! the same bits. A run resumes from any step: within an inflow window, packed, or while a support moves.
//! Everything constant comes from the scene; `scene` is the fingerprint of the scene that this must be. The
//! fields of the state belong to the version of the format and the physics version: a checkpoint of other
//! versions is refused.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::PHYSICS_VERSION;
use crate::platform::seal;

/// Name of the format.
pub const FORMAT: &str = "billow-checkpoint";
/// Version of the format this program writes and reads.
pub const VERSION: u32 = 7;

/// A run of film between two steps.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Checkpoint<S, R> {
    #[serde(rename = "format")]
    _format: String,
    #[serde(rename = "version")]
    _version: u32,
    #[serde(rename = "physics_version")]
    _physics_version: u32,
    /// Fingerprint of the scene.
    scene: String,
    /// Everything that changes in the film.
    pub state: S,
    /// Samples, tracks and frames so far.
    pub run: R,
}

/// Why a text is not a valid checkpoint.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CheckpointError {
    /// Not a checkpoint, or a damaged one.
    #[error("not a valid checkpoint: {0}")]
    Invalid(String),
    /// Written in another version of the format.
    #[error("checkpoint format version {found}; this program reads version {VERSION}")]
    Version {
        /// Version of the checkpoint.
        found: u32,
    },
    /// Computed by another physics version.
    #[error("checkpoint of physics version {found}; this program has {PHYSICS_VERSION}")]
    Physics {
        /// Physics version of the checkpoint.
        found: u32,
    },
    /// The checkpoint of another scene.
    #[error("checkpoint of another scene: the scene, or a file it names, has changed")]
    Scene,
}

/// The fields that every version of the format has.
#[derive(Deserialize)]
struct Head {
    format: String,
    version: u32,
    physics_version: u32,
}

/// A checkpoint as it is written.
#[derive(Serialize)]
struct Written<'a, S, R> {
    format: &'a str,
    version: u32,
    physics_version: u32,
    scene: &'a str,
    state: &'a S,
    run: &'a R,
}

fn invalid(error: impl core::fmt::Display) -> CheckpointError {
    CheckpointError::Invalid(error.to_string())
}

impl<S: Serialize + DeserializeOwned, R: Serialize + DeserializeOwned> Checkpoint<S, R> {
    /// The checkpoint of a run of the scene with this fingerprint, as text.
    ///
    /// # Errors
    /// [`CheckpointError::Invalid`] for a number that is not finite; no accepted step leaves one.
    pub fn text(scene: &str, state: &S, run: &R) -> Result<String, CheckpointError> {
        let (format, version, physics_version) = (FORMAT, VERSION, PHYSICS_VERSION);
        let written = Written { format, version, physics_version, scene, state, run };
        let text = serde_json::to_string(&written).map_err(invalid)?;
        // JSON writes NaN as null, which does not read as a number: fail now, not at the resume.
        Self::read(&text, scene)?;
        Ok(seal::seal(&text))
    }

    /// Reads a checkpoint of the scene with this fingerprint.
    pub fn from_text(text: &str, scene: &str) -> Result<Self, CheckpointError> {
        Self::read(&seal::open(text).map_err(invalid)?, scene)
    }

    /// Reads the text without its checksum.
    fn read(text: &str, scene: &str) -> Result<Self, CheckpointError> {
        let head: Head = serde_json::from_str(text).map_err(invalid)?;
        if head.format != FORMAT {
            return Err(CheckpointError::Invalid(format!("its format is {:?}", head.format)));
        }
        if head.version != VERSION {
            return Err(CheckpointError::Version { found: head.version });
        }
        if head.physics_version != PHYSICS_VERSION {
            return Err(CheckpointError::Physics { found: head.physics_version });
        }
        let checkpoint: Self = serde_json::from_str(text).map_err(invalid)?;
        if checkpoint.scene != scene {
            return Err(CheckpointError::Scene);
        }
        Ok(checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Numbers = Checkpoint<Vec<f64>, Option<f64>>;

    fn text() -> String {
        Numbers::text("scene", &vec![0.1 + 0.2, -0.0, 1e-300], &None).unwrap()
    }

    #[test]
    fn a_checkpoint_is_read_back_for_its_scene_alone() {
        let found = Numbers::from_text(&text(), "scene").unwrap();
        assert_eq!((found.state, found.run), (vec![0.1 + 0.2, -0.0, 1e-300], None));
        assert_eq!(Numbers::from_text(&text(), "other"), Err(CheckpointError::Scene));
        assert!(Numbers::text("scene", &vec![f64::NAN], &None).is_err());
    }

    /// 300 changes: a flipped bit, a cut, a doubled piece.
    #[test]
    fn every_changed_text_is_refused() {
        let valid = text().into_bytes();
        let mut number = 1_u64;
        for round in 0..300 {
            // A linear congruential generator (D. E. Knuth, The Art of Computer Programming, 3.3.4).
            number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let at = usize::try_from((number >> 33) % valid.len() as u64).unwrap();
            let mut changed = valid.clone();
            match round % 10 {
                8 => changed.truncate(at),
                9 => changed.extend_from_slice(&valid[at..]),
                bit => changed[at] ^= 1 << bit,
            }
            let refused = String::from_utf8(changed)
                .map_or(true, |text| Numbers::from_text(&text, "scene").is_err());
            assert!(refused, "change {round} at byte {at}");
        }
    }

    #[test]
    fn other_versions_are_refused_by_their_number() {
        let object = seal::open(&text()).unwrap();
        for version in [VERSION - 1, VERSION + 1] {
            let number = |version| format!("\"version\":{version}");
            let other = object.replace(&number(VERSION), &number(version));
            let refused = Numbers::from_text(&seal::seal(&other), "scene");
            assert_eq!(refused, Err(CheckpointError::Version { found: version }));
        }
        // A text without a checksum was changed.
        assert!(matches!(Numbers::from_text(&object, "scene"), Err(CheckpointError::Invalid(_))));
    }
}
