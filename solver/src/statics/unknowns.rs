//! What a static state is looked for in: places of free nodes along what is free of them, and the
//! travel of rigid planes.
//!
//! ```text
//! u_i = Σ_k d_ik q_k          d: unit directions nobody holds; normals of planes the node is bound to
//! r_k = Σ_i d_ik·f_i          + the constant force of a plane
//! ```
//!
//! A node without mass (the tip of closing faces) is moved by no force and counts as held, as in a
//! run.

use nalgebra::{Matrix3, Vector3};

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::supports::Supports;

/// Unknown displacements and what they move.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknowns {
    /// Unknowns each node moves by, with the direction: nodes' own first, then rigid planes'.
    pub of_node: Vec<Vec<(u32, Vector3<f64>)>>,
    /// Unknowns that belong to one node alone, as a range.
    pub own: Vec<core::ops::Range<u32>>,
    /// Where the unknowns of rigid planes begin; there is one a plane, in their order.
    pub planes: u32,
    /// Mass each moves, kg.
    pub mass: Vec<f64>,
    /// Constant force along each, N.
    pub force: Vec<f64>,
}

/// Unit directions a projector leaves free.
fn free_directions(projector: &Matrix3<f64>) -> Vec<Vector3<f64>> {
    let mut rest = *projector;
    let mut found = Vec::new();
    // A projector's diagonal entry is the squared length of what it leaves of that axis.
    for _ in 0..3 {
        let axis =
            (0..3).fold(0, |best, k| if rest[(k, k)] > rest[(best, best)] { k } else { best });
        if rest[(axis, axis)] <= 1e-9 {
            break;
        }
        let direction = rest.column(axis).normalize();
        rest -= direction * direction.transpose();
        found.push(direction);
    }
    found
}

impl Unknowns {
    /// Of a film held so.
    pub fn new(model: &FilmModel, supports: &Supports) -> Self {
        let mut all = Self {
            of_node: vec![Vec::new(); model.nodes()],
            own: vec![0..0; model.nodes()],
            planes: 0,
            mass: Vec::new(),
            force: Vec::new(),
        };
        let mut count = 0;
        for node in 0..model.nodes() {
            let first = count;
            if model.mass[node] > 0.0 {
                for direction in free_directions(&supports.projector(node)) {
                    all.of_node[node].push((count, direction));
                    all.mass.push(model.mass[node]);
                    count += 1;
                }
            }
            all.own[node] = first..count;
        }
        all.planes = count;
        for (plane, body) in (count..).zip(&supports.bodies) {
            for node in &body.nodes {
                all.of_node[*node as usize].push((plane, body.plane.normal));
            }
            all.mass.push(body.mass(model));
        }
        all.force = vec![0.0; all.mass.len()];
        for (plane, body) in (count..).zip(&supports.bodies) {
            all.force[plane as usize] = body.plane.force;
        }
        all
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.mass.len()
    }

    /// Whether all is held.
    pub fn is_empty(&self) -> bool {
        self.mass.is_empty()
    }

    /// Forces along the unknowns, N, of these forces on nodes.
    pub fn gather(&self, forces: &Field) -> Vec<f64> {
        let mut along = self.force.clone();
        for (node, moves) in self.of_node.iter().enumerate() {
            let force = forces.get(node);
            for (unknown, direction) in moves {
                along[*unknown as usize] += direction.dot(&force);
            }
        }
        along
    }

    /// Moves the nodes by these displacements (m) times `share`.
    pub fn shift(&self, places: &mut Field, by: &[f64], share: f64) {
        for (node, moves) in self.of_node.iter().enumerate() {
            if !moves.is_empty() {
                places.set(node, places.get(node) + self.of(node, by) * share);
            }
        }
    }

    /// Displacement of a node, m.
    pub fn of(&self, node: usize, by: &[f64]) -> Vector3<f64> {
        let moves = self.of_node[node].iter();
        moves.map(|(unknown, direction)| direction * by[*unknown as usize]).sum()
    }

    /// Largest displacement of a node, m.
    pub fn largest(&self, by: &[f64]) -> f64 {
        let squared = (0..self.of_node.len()).map(|node| self.of(node, by).norm_squared());
        squared.fold(0.0, f64::max).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_directions_span_what_a_projector_leaves() {
        let normal = Vector3::new(1.0, -2.0, 0.5).normalize();
        let plane = Matrix3::identity() - normal * normal.transpose();
        let line = normal * normal.transpose();
        for (projector, rank) in
            [(Matrix3::identity(), 3), (plane, 2), (line, 1), (Matrix3::zeros(), 0)]
        {
            let directions = free_directions(&projector);
            assert_eq!(directions.len(), rank);
            let mut sum = Matrix3::zeros();
            for direction in directions {
                sum += direction * direction.transpose();
            }
            assert!((sum - projector).norm() < 1e-14);
        }
    }
}
