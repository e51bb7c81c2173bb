//! The reference gap of a design, and the lengths that follow from it: the default contact distance and
//! the default amplitude of the imperfection. They are the same on every mesh of a design.
//!
//! ```text
//! g = min(smallest gap of a node and an element, mean edge length/20)    stowed, 16 subdivisions
//! contact distance 0.4 g                                                 amplitude 0.2 g
//! ```
//!
//! Facets are flat when stowed, so the smallest gap is that of a node next to a fold. It and the edges
//! are inversely proportional to the subdivisions; a coarse mesh therefore gives g.

use crate::collision::broad_phase::collision_mesh::CollisionMesh;
use crate::collision::contact::{DISTANCE_PER_GAP, default_distance};
use crate::geometry::field::Field;
use crate::geometry::fold::{Caps, FoldDesign, FoldError, FoldPattern};
use crate::geometry::mesh::{Mesh, Shape};

/// Subdivisions for which the reference gap is stated. Chosen: the gaps of this and coarser meshes are
/// not below it, so no pair is in contact at the start.
const REFERENCE_SUBDIVISIONS: u32 = 16;

/// Subdivisions of the mesh that is built to compute it. Chosen: the gap is inversely proportional to the
/// subdivisions from 3 on.
const COMPUTED_SUBDIVISIONS: u32 = 4;

/// Default amplitude of the imperfection over the reference gap. Chosen: it changes the gaps between
/// layers by much less than themselves, because layers move together.
const AMPLITUDE_PER_GAP: f64 = 0.2;

/// The reference gap of a design, m. Caps do not matter: an erected capsule with circular caps has that
/// of its stowed stack with polygon caps.
pub fn reference_gap(design: &FoldDesign) -> Result<f64, FoldError> {
    let design = FoldDesign { caps: Caps::Polygon, ..design.clone() };
    let stowed = Shape::Stowed(design.stowed_height);
    let mesh = Mesh::new(&FoldPattern::new(&design)?, COMPUTED_SUBDIVISIONS, stowed)?;
    let positions = Field::of(&mesh.positions);
    let mesh = CollisionMesh::new(positions.len(), &mesh.triangles);
    let gap = default_distance(&mesh, &positions, 0.0) / DISTANCE_PER_GAP;
    Ok(gap * f64::from(COMPUTED_SUBDIVISIONS) / f64::from(REFERENCE_SUBDIVISIONS))
}

/// Contact distance of the capsule of a design, m: the given one, or the default of the design.
pub fn contact_distance(given: Option<f64>, design: &FoldDesign) -> Result<f64, FoldError> {
    given.map_or_else(|| Ok(DISTANCE_PER_GAP * reference_gap(design)?), Ok)
}

/// Amplitude of the imperfection of a stowed capsule, m: the given one, or the default of the design;
/// `None` for seed 0.
pub fn imperfection_amplitude(
    design: &FoldDesign,
    seed: u64,
    given: Option<f64>,
) -> Result<Option<f64>, FoldError> {
    if seed == 0 || given.is_some() {
        return Ok(given.filter(|_| seed != 0));
    }
    Ok(Some(AMPLITUDE_PER_GAP * reference_gap(design)?))
}
