//! The features of a scene as coordinates of the bias of a mesh.
//!
//! ```text
//! u = ln(x/x_base)        a feature whose base value is above 0: equal factors are equal distances
//! u = x/(x + x_half)      a mass of gas whose base value is 0: the first part of it changes the most
//! ```

use serde::{Deserialize, Serialize};

use super::features::FEATURES;

/// What the coordinates refer to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coordinates {
    /// The features of the base scene, SI: the scene from which most others differ in one feature.
    pub base: [f64; FEATURES],
    /// Value at which a feature with the base value 0 has the coordinate ½, SI; 0 for a feature that does not vary.
    pub half: [f64; FEATURES],
}

impl Coordinates {
    /// The coordinates of these features; 0 for those of the base scene.
    pub fn of(&self, values: &[f64; FEATURES]) -> [f64; FEATURES] {
        core::array::from_fn(|index| {
            let (value, base, half) = (values[index], self.base[index], self.half[index]);
            if base > 0.0 {
                libm::log(value / base)
            } else if value > 0.0 && half > 0.0 {
                value / (value + half)
            } else {
                0.0
            }
        })
    }
}
