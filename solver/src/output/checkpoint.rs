//! The whole state of a run of film, to and from text, bit for bit.
//!
//! ```text
//! {"format": "billow-checkpoint", "version": 1, "physics_version": …, "scene": "…", "state": …, "run": …}
//! ```
//!
//! JSON, every number in the shortest digits that read back as it. A run goes on from any step, also
//! within an inflow window, packed, or on the way of a moving support: what is constant comes from the
//! scene again, and `scene` says which one that must be. What a state holds belongs to the physics version.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::PHYSICS_VERSION;

/// Name of the format.
pub const FORMAT: &str = "billow-checkpoint";
/// Version of the format this program writes, and the newest it reads.
pub const VERSION: u32 = 1;

/// A run of film between two steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Checkpoint<S, R> {
    format: String,
    version: u32,
    physics_version: u32,
    /// Fingerprint of the scene: whatever tells it from every other.
    scene: String,
    /// All that changes in the film.
    pub state: S,
    /// How far the run is.
    pub run: R,
}

/// Why a text is no checkpoint to go on from.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CheckpointError {
    /// No checkpoint, or a damaged one.
    #[error("no sound checkpoint: {0}")]
    Unsound(String),
    /// Written by a newer program.
    #[error("a checkpoint of version {found}; this program reads up to {VERSION}")]
    Newer {
        /// Its version.
        found: u32,
    },
    /// The solver has changed since.
    #[error("computed by physics version {found}; this program has {PHYSICS_VERSION}")]
    Physics {
        /// Its physics version.
        found: u32,
    },
    /// Of another scene.
    #[error("of another scene: the scene, or a file it names, has changed since")]
    Scene,
}

/// What every version of the format has.
#[derive(Deserialize)]
struct Head {
    format: String,
    version: u32,
    physics_version: u32,
}

impl<S: Serialize + DeserializeOwned + Clone, R: Serialize + DeserializeOwned + Clone>
    Checkpoint<S, R>
{
    /// Takes down a run of the scene of that fingerprint.
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

    /// As text.
    ///
    /// # Errors
    /// [`CheckpointError::Unsound`] for a number JSON cannot hold; no accepted step leaves one.
    pub fn to_text(&self) -> Result<String, CheckpointError> {
        let unsound = |error: serde_json::Error| CheckpointError::Unsound(error.to_string());
        let text = serde_json::to_string(self).map_err(unsound)?;
        // A number that is none is written as null, which no number reads: refused now, not later.
        Self::from_text(&text, &self.scene)?;
        Ok(text)
    }

    /// Reads a checkpoint of the scene of that fingerprint.
    ///
    /// # Errors
    /// [`CheckpointError`].
    pub fn from_text(text: &str, scene: &str) -> Result<Self, CheckpointError> {
        let unsound = |error: serde_json::Error| CheckpointError::Unsound(error.to_string());
        let head: Head = serde_json::from_str(text).map_err(unsound)?;
        if head.format != FORMAT {
            return Err(CheckpointError::Unsound(format!("its format is {:?}", head.format)));
        }
        if head.version > VERSION {
            return Err(CheckpointError::Newer { found: head.version });
        }
        if head.physics_version != PHYSICS_VERSION {
            return Err(CheckpointError::Physics { found: head.physics_version });
        }
        let checkpoint: Self = serde_json::from_str(text).map_err(unsound)?;
        if checkpoint.scene != scene {
            return Err(CheckpointError::Scene);
        }
        Ok(checkpoint)
    }
}
