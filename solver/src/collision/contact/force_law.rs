//! One contact, and its force as a function of the gap.
//!
//! ```text
//! repulsion   F = k (o − d)²/(2 o)          E = k (o − d)³/(6 o)                        d < o
//! adhesion    F = −4 F_a s (1 − s)          E = −4 F_a range (1/6 − s²/2 + s³/3)        0 < s < 1
//!             s = (d − o)/range
//! ```
//!
//! Symbols: d gap, o offset, m; k stiffness, N/m; `F_a` largest adhesive force, N.

use serde::{Deserialize, Serialize};

use super::pair::Pair;
use crate::geometry::topology::Feature;

/// One contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// The pair. If several elements contain the feature, that of the element with the lowest number.
    pub pair: Pair,
    /// The feature closest to the node; 0 for two edges.
    pub feature: Feature,
    /// Offset o, m.
    pub offset: f64,
    /// Stiffness k, N/m.
    pub stiffness: f64,
    /// Gap d at the last update, m.
    pub gap: f64,
    /// Largest adhesive force `F_a`, N.
    pub adhesion: f64,
    /// Stored energy at the last update, J.
    pub energy: f64,
}

impl Contact {
    /// Energy stored by repulsion at a gap (m), J.
    pub fn stored_energy(&self, gap: f64) -> f64 {
        let penetration = (self.offset - gap).max(0.0);
        self.stiffness * penetration * penetration * penetration / (6.0 * self.offset)
    }

    /// Attractive force at a gap (m), N; zero at `range` (m) and more beyond the offset.
    pub fn adhesive_force(&self, gap: f64, range: f64) -> f64 {
        let share = (gap - self.offset) / range;
        if self.adhesion > 0.0 && share > 0.0 && share < 1.0 {
            4.0 * self.adhesion * share * (1.0 - share)
        } else {
            0.0
        }
    }

    /// Energy that separating the pair from a gap (m) costs against adhesion, J: 0 at the end of its range.
    pub fn adhesive_energy(&self, gap: f64, range: f64) -> f64 {
        let valid = self.adhesion > 0.0 && range > 0.0;
        if !valid {
            return 0.0;
        }
        let share = ((gap - self.offset) / range).clamp(0.0, 1.0);
        let remaining = 1.0 / 6.0 - share * share * (0.5 - share / 3.0);
        4.0 * self.adhesion * range * remaining
    }

    /// Slope of the attractive force with the gap, N/m.
    pub fn adhesive_stiffness(&self, gap: f64, range: f64) -> f64 {
        let share = (gap - self.offset) / range;
        if self.adhesion > 0.0 && share > 0.0 && share < 1.0 {
            4.0 * self.adhesion * (1.0 - 2.0 * share) / range
        } else {
            0.0
        }
    }

    /// Minus the slope of the repulsive force with the gap, N/m.
    pub fn repulsive_stiffness(&self, gap: f64) -> f64 {
        self.stiffness * (self.offset - gap).max(0.0) / self.offset
    }

    /// Repulsive force at a gap (m), N.
    pub fn repulsive_force(&self, gap: f64) -> f64 {
        let penetration = (self.offset - gap).max(0.0);
        0.5 * self.stiffness * penetration * penetration / self.offset
    }
}
