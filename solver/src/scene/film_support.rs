//! What holds film, as plain data.

use nalgebra::Vector3;

use super::motion::Motion;

/// One support.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmSupport {
    /// Name, as reactions are told by.
    pub name: String,
    /// Nodes, in ascending order.
    pub nodes: Vec<u32>,
    /// What is held.
    pub hold: Hold,
    /// How what is held moves; `None` stands.
    pub motion: Option<Motion>,
}

/// What a support holds of its nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hold {
    /// These displacement components: x, y, z.
    Components([bool; 3]),
    /// The component along this unit normal: a rigid plane that stands.
    Plane(Vector3<f64>),
    /// The component along a rigid plane's normal; the plane moves along it as a free body.
    Body(PlaneBody),
}

/// A rigid plane that moves along its normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneBody {
    /// Unit normal.
    pub normal: Vector3<f64>,
    /// Its mass without the film bound to it, kg.
    pub mass: f64,
    /// Its velocity along the normal at the start, m/s.
    pub velocity: f64,
    /// A constant force on it along the normal, N (weight included, where there is any).
    pub force: f64,
}
