//! Why a scene cannot be run.

use crate::geometry::fold::FoldError;

/// Why a scene cannot be run at all (a run that stops short is no error: see
/// [`crate::output::outcome::Stop`]).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// The fold design is invalid or infeasible.
    #[error(transparent)]
    Fold(#[from] FoldError),
    /// A key of the scene is out of range, or asks for what the model cannot do.
    #[error("{key}: {problem}")]
    Invalid {
        /// Dotted key, as in the scene's JSON.
        key: String,
        /// What is wrong, what is allowed.
        problem: String,
    },
}
