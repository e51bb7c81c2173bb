//! Supports of a film of any shape.

use nalgebra::Vector3;

use super::motion::Motion;

/// One support.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmSupport {
    /// Name, used for its reaction.
    pub name: String,
    /// Nodes, in ascending order.
    pub nodes: Vec<u32>,
    /// Directions held.
    pub hold: Hold,
    /// Prescribed motion in the held directions; `None` for a fixed support.
    pub motion: Option<Motion>,
}

/// The directions in which a support holds its nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hold {
    /// These displacement components: x, y, z.
    Components([bool; 3]),
    /// The component along this unit normal: a fixed rigid plane.
    Plane(Vector3<f64>),
    /// The component along the normal of a rigid plane that moves along it as a free body.
    Body(PlaneBody),
}

/// A rigid plane that moves along its normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneBody {
    /// Unit normal.
    pub normal: Vector3<f64>,
    /// Mass without that of the film bound to it, kg.
    pub mass: f64,
    /// Initial velocity along the normal, m/s.
    pub velocity: f64,
    /// Constant force along the normal, N, including any weight.
    pub force: f64,
}
