//! Supports of a capsule.

use serde::{Deserialize, Serialize};

/// One support.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// The nodes it holds.
    pub on: SupportLocation,
    /// The displacement components it holds: letters of "xyz", in that order.
    pub fix: String,
}

/// The nodes a support holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SupportLocation {
    /// All nodes of the bottom ring.
    BottomRing,
    /// All nodes of the top ring.
    TopRing,
    /// All nodes of the bottom cap and the bottom ring.
    BottomCap,
    /// All nodes of the top cap and the top ring.
    TopCap,
}
