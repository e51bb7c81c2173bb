//! Rigid plates that touch the film.

use nalgebra::Vector3;

use super::motion::Motion;

/// A rigid plate.
#[derive(Debug, Clone, PartialEq)]
pub struct Plate {
    /// Name, used for its force.
    pub name: String,
    /// A point of its surface at time 0, m.
    pub point: Vector3<f64>,
    /// Unit normal, towards the film.
    pub normal: Vector3<f64>,
    /// Prescribed translation; `None` for a fixed plate. A plate does not rotate.
    pub motion: Option<Motion>,
    /// Time at which it is removed, s; infinite for never.
    pub removal_time: f64,
}
