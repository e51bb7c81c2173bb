//! The unknowns of supported film: displacements of nodes along their free directions, and the travel
//! of rigid planes.
//!
//! ```text
//! u_i = Σ_k d_ik q_k          d: free unit directions; normals of the planes of a node
//! r_k = Σ_i d_ik·f_i          + the constant force of a plane
//! ```
//!
//! A node without mass (a vertex of closing faces) has no unknowns: it is held, or follows a rim.

use nalgebra::{Matrix3, Vector3};

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::supports::Supports;

/// The unknown displacements.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknowns {
    /// Unknowns that move each node, with their direction: first those of the node alone, then those of its
    /// planes.
    pub of_node: Vec<Vec<(u32, Vector3<f64>)>>,
    /// Range of the unknowns of each node alone.
    pub node_range: Vec<core::ops::Range<u32>>,
    /// First unknown of the rigid planes; one per plane, in their order.
    pub first_plane: u32,
    /// Mass moved by each unknown, kg.
    pub mass: Vec<f64>,
    /// Constant force along each unknown, N.
    pub force: Vec<f64>,
}

/// Orthonormal basis of the image of a projector: the free directions.
fn free_directions(projector: &Matrix3<f64>) -> Vec<Vector3<f64>> {
    let mut rest = *projector;
    let mut found = Vec::new();
    // A diagonal entry of a projector is the squared length of the projection of that axis.
    for _ in 0..3 {
        let axis =
            (0..3).fold(
                0,
                |largest, k| if rest[(k, k)] > rest[(largest, largest)] { k } else { largest },
            );
        if rest[(axis, axis)] <= 1e-9 {
            break;
        }
        let direction = rest.column(axis).normalize();
        rest -= direction * direction.transpose();
        found.push(direction);
    }
    found
}

/// Scalar product of two vectors along the unknowns.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Unknowns {
    /// The unknowns of a film with these supports.
    pub fn new(model: &FilmModel, supports: &Supports) -> Self {
        let mut all = Self {
            of_node: vec![Vec::new(); model.nodes()],
            node_range: vec![0..0; model.nodes()],
            first_plane: 0,
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
            all.node_range[node] = first..count;
        }
        all.first_plane = count;
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

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.mass.len()
    }

    /// Whether there are no unknowns.
    pub fn is_empty(&self) -> bool {
        self.mass.is_empty()
    }

    /// Forces along the unknowns, N, from forces on the nodes (N) and the constant forces.
    pub fn gather(&self, forces: &Field) -> Vec<f64> {
        let mut along = self.force.clone();
        self.add(forces, &mut along);
        along
    }

    /// Adds forces on the nodes (N) along the unknowns.
    pub fn add(&self, forces: &Field, along: &mut [f64]) {
        for (node, moves) in self.of_node.iter().enumerate() {
            let force = forces.get(node);
            for (unknown, direction) in moves {
                along[*unknown as usize] += direction.dot(&force);
            }
        }
    }

    /// Moves the nodes by `fraction` times these displacements along the unknowns (m).
    pub fn shift(&self, positions: &mut Field, by: &[f64], fraction: f64) {
        for (node, moves) in self.of_node.iter().enumerate() {
            if !moves.is_empty() {
                positions.set(node, positions.get(node) + self.displacement(node, by) * fraction);
            }
        }
    }

    /// Displacement of a node, m, from displacements along the unknowns (m).
    pub fn displacement(&self, node: usize, by: &[f64]) -> Vector3<f64> {
        let moves = self.of_node[node].iter();
        moves.map(|(unknown, direction)| direction * by[*unknown as usize]).sum()
    }

    /// Largest displacement of any node, m.
    pub fn largest(&self, by: &[f64]) -> f64 {
        let squared =
            (0..self.of_node.len()).map(|node| self.displacement(node, by).norm_squared());
        squared.fold(0.0, f64::max).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_directions_span_the_image_of_a_projector() {
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
