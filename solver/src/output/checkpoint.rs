//! Checkpoints: the complete state of a film run as text, exact to the bit.
//!
//! ```text
//! {"format": "billow-checkpoint", "version": 2, "physics_version": …, "scene": "…", "state": …, "run": …}
//! ```
//!
//! JSON; every number has the shortest digits that read back to the same bits. A run resumes from any
//! step: within an inflow window, packed, or while a support moves. Everything constant comes from the
//! scene; `scene` is the fingerprint of the scene that this must be. The fields of the state belong to
//! the version of the format and the physics version: a checkpoint of other versions is refused.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::PHYSICS_VERSION;

/// Name of the format.
pub const FORMAT: &str = "billow-checkpoint";
/// Version of the format this program writes and reads.
pub const VERSION: u32 = 2;

/// A run of film between two steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Checkpoint<S, R> {
    format: String,
    version: u32,
    physics_version: u32,
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

impl<S: Serialize + DeserializeOwned + Clone, R: Serialize + DeserializeOwned + Clone>
    Checkpoint<S, R>
{
    /// The checkpoint of a run of the scene with this fingerprint.
    pub fn new(scene: &str, state: &S, run: &R) -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            physics_version: PHYSICS_VERSION,
            scene: scene.to_owned(),
            state: state.clone(),
            run: run.clone(),
        }
    }

    /// The checkpoint as text.
    ///
    /// # Errors
    /// [`CheckpointError::Invalid`] for a number that is not finite; no accepted step leaves one.
    pub fn to_text(&self) -> Result<String, CheckpointError> {
        let invalid = |error: serde_json::Error| CheckpointError::Invalid(error.to_string());
        let text = serde_json::to_string(self).map_err(invalid)?;
        // JSON writes NaN as null, which does not read as a number: fail now, not at the resume.
        Self::from_text(&text, &self.scene)?;
        Ok(text)
    }

    /// Reads a checkpoint of the scene with this fingerprint.
    ///
    /// # Errors
    /// [`CheckpointError`].
    pub fn from_text(text: &str, scene: &str) -> Result<Self, CheckpointError> {
        let invalid = |error: serde_json::Error| CheckpointError::Invalid(error.to_string());
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
