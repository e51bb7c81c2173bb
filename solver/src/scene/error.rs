//! Errors of a scene.

use crate::geometry::fold::FoldError;

/// Why a scene cannot run. A run that stops early is not an error; see
/// [`crate::output::outcome::Stop`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// The fold design is invalid or infeasible.
    #[error(transparent)]
    Fold(#[from] FoldError),
    /// A key of the scene is out of range, or the model does not support its value.
    #[error("{key}: {problem}")]
    Invalid {
        /// Dotted key, as in the scene's JSON.
        key: String,
        /// What is wrong, what is allowed.
        problem: String,
    },
}

impl SceneError {
    /// An invalid value at this key.
    pub fn invalid(key: impl Into<String>, problem: impl core::fmt::Display) -> Self {
        Self::Invalid { key: key.into(), problem: problem.to_string() }
    }
}
