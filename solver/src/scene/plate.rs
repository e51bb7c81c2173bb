//! Rigid plates the film lies against, as plain data.

use nalgebra::Vector3;

use super::motion::Motion;

/// A rigid plate.
#[derive(Debug, Clone, PartialEq)]
pub struct Plate {
    /// Name, as its force is told by.
    pub name: String,
    /// A point of it at the start, m.
    pub point: Vector3<f64>,
    /// Unit normal, towards the film.
    pub normal: Vector3<f64>,
    /// How it moves; `None` stands. A plate does not turn.
    pub motion: Option<Motion>,
    /// When it is gone, s; infinite for never.
    pub until: f64,
}
