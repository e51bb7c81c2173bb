//! Supports of the film: node components that are fixed, move as prescribed, or move with a rigid plane.
//!
//! ```text
//! v⁺ = v⁻ + P a h                                               P: projector onto free directions
//! n·v⁺ = V,  V⁺ = V⁻ + h (F + Σ n·f_i)/(M + Σ m_i)              rigid plane of mass M as a free body
//! v⁺ = (x(t + Δt) − x)/Δt                                       prescribed, in the held directions
//! ```
//!
//! A held component is not part of the momentum balance: the support takes the force on it. A fixed
//! support does no work. The work of a moving support is in the energy ledger.

use nalgebra::{Matrix3, Vector3};

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::WIDTH;
use crate::scene::film_support::{FilmSupport, Hold, PlaneBody};
use crate::scene::motion::Motion;

/// All supports of a film.
#[derive(Debug, Clone, PartialEq)]
pub struct Supports {
    /// Free components along the axes.
    pub free: FreeComponents,
    /// Nodes held along directions that are not axes, in ascending order, with P.
    pub oblique: Vec<(u32, Matrix3<f64>)>,
    /// Nodes that move as prescribed.
    pub movers: Vec<PrescribedNodes>,
    /// Rigid planes that move as free bodies.
    pub bodies: Vec<RigidPlane>,
}

/// Free components of each node along the axes: 1 for a free component, 0 for a held one.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeComponents {
    field: Field,
    /// For each block of eight nodes, whether any component is held. Most blocks are free, and the
    /// kernels skip their factors.
    held: Vec<bool>,
}

impl FreeComponents {
    /// All components of `nodes` nodes are free.
    pub fn all(nodes: usize) -> Self {
        Self { field: Field::repeat(1.0, nodes), held: vec![false; nodes.div_ceil(WIDTH)] }
    }

    /// Components of a node, each 1 or 0.
    pub fn get(&self, node: usize) -> Vector3<f64> {
        self.field.get(node)
    }

    /// Sets the components of a node, each 1 or 0.
    pub fn set(&mut self, node: usize, free: Vector3<f64>) {
        self.field.set(node, free);
        let first = node / WIDTH * WIDTH;
        let end = self.field.len().min(first + WIDTH);
        let all_free = Vector3::repeat(1.0);
        self.held[node / WIDTH] = (first..end).any(|node| self.field.get(node) != all_free);
    }

    /// Components of all nodes.
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// Whether any component is held of the eight nodes from `first` on; `first` is a multiple of eight.
    #[inline]
    pub fn any_held(&self, first: usize) -> bool {
        self.held[first / WIDTH]
    }
}

/// Nodes that move as prescribed in their held directions.
#[derive(Debug, Clone, PartialEq)]
pub struct PrescribedNodes {
    /// Nodes.
    pub nodes: Vec<u32>,
    /// Their initial positions, m.
    pub start: Vec<Vector3<f64>>,
    /// Projector onto the held directions.
    pub held: Matrix3<f64>,
    /// Motion of all nodes.
    pub motion: Motion,
    /// Additional displacement of each node at the end of the motion, m; it grows with the motion.
    pub displacements: Vec<Vector3<f64>>,
}

impl PrescribedNodes {
    /// Each node with its prescribed position at `time` (s), m.
    pub fn positions(&self, time: f64) -> impl Iterator<Item = (u32, Vector3<f64>)> + '_ {
        let fraction = self.motion.fraction(time);
        let nodes = self.nodes.iter().zip(self.start.iter().zip(&self.displacements));
        nodes.map(move |(node, (start, displacement))| {
            (*node, self.motion.position(*start, time) + displacement * fraction)
        })
    }
}

/// A rigid plane and the nodes bound to it.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidPlane {
    /// Nodes.
    pub nodes: Vec<u32>,
    /// Normal, mass, initial velocity and force of the plane.
    pub plane: PlaneBody,
}

impl RigidPlane {
    /// Mass of the plane and of the film bound to it, kg.
    pub fn mass(&self, model: &FilmModel) -> f64 {
        self.plane.mass + self.nodes.iter().map(|node| model.mass[*node as usize]).sum::<f64>()
    }
}

impl Hold {
    /// Projector onto the held directions.
    pub fn projector(&self) -> Matrix3<f64> {
        match self {
            Self::Components(held) => {
                Matrix3::from_diagonal(&Vector3::from(held.map(|held| f64::from(u8::from(held)))))
            }
            Self::Plane(normal) | Self::Body(PlaneBody { normal, .. }) => {
                normal * normal.transpose()
            }
        }
    }

    /// The held directions, as unit vectors.
    fn directions(&self) -> Vec<Vector3<f64>> {
        match self {
            Self::Components(held) => {
                let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
                held.iter().zip(axes).filter(|(held, _)| **held).map(|(_, axis)| axis).collect()
            }
            Self::Plane(normal) | Self::Body(PlaneBody { normal, .. }) => vec![*normal],
        }
    }
}

/// Smallest length of a unit direction, after the part along other held directions is removed, at which
/// it counts as a new direction. Chosen: above rounding, below any intended angle (rad).
const MIN_INDEPENDENT_LENGTH: f64 = 1e-9;

impl Supports {
    /// No supports, for `nodes` nodes.
    pub fn none(nodes: usize) -> Self {
        Self {
            free: FreeComponents::all(nodes),
            oblique: Vec::new(),
            movers: Vec::new(),
            bodies: Vec::new(),
        }
    }

    /// The supports of nodes with these initial positions (m). Supports on the same node add up.
    pub fn new(supports: &[FilmSupport], positions: &Field) -> Self {
        let mut all = Self::none(positions.len());
        let mut directions: Vec<Vec<Vector3<f64>>> = vec![Vec::new(); positions.len()];
        for support in supports {
            for node in &support.nodes {
                for mut direction in support.hold.directions() {
                    let held = &mut directions[*node as usize];
                    for known in held.iter() {
                        direction -= known * known.dot(&direction);
                    }
                    if direction.norm() > MIN_INDEPENDENT_LENGTH {
                        held.push(direction.normalize());
                    }
                }
            }
            if let Hold::Body(plane) = support.hold {
                all.bodies.push(RigidPlane { nodes: support.nodes.clone(), plane });
            } else if let Some(motion) = support.motion {
                all.movers.push(PrescribedNodes {
                    nodes: support.nodes.clone(),
                    start: support.nodes.iter().map(|node| positions.get(*node as usize)).collect(),
                    held: support.hold.projector(),
                    motion,
                    displacements: vec![Vector3::zeros(); support.nodes.len()],
                });
            }
        }
        for (node, held) in (0_u32..).zip(&directions) {
            let mut projector = Matrix3::identity();
            for direction in held {
                projector -= direction * direction.transpose();
            }
            let axis_aligned = (0..3).all(|k| {
                let row: Vec<f64> = (0..3).map(|l| projector[(k, l)]).collect();
                // Exactly 0, or exactly 1 on the diagonal; otherwise the node is oblique.
                row.iter()
                    .enumerate()
                    .all(|(l, p)| p.abs() <= 0.0 || (l == k && (p - 1.0).abs() <= 0.0))
            });
            if axis_aligned {
                all.free.set(node as usize, projector.diagonal());
            } else if held.len() == 3 {
                all.free.set(node as usize, Vector3::zeros());
            } else {
                all.oblique.push((node, projector));
            }
        }
        all
    }

    /// Whether a node is held in all three directions.
    pub fn hold_fully(&self, node: u32) -> bool {
        self.projector(node as usize) == Matrix3::zeros()
    }

    /// P of a node: projector onto its free directions.
    pub fn projector(&self, node: usize) -> Matrix3<f64> {
        match self.oblique.binary_search_by_key(&node, |(node, _)| *node as usize) {
            Ok(index) => self.oblique[index].1,
            Err(_) => Matrix3::from_diagonal(&self.free.get(node)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn support(nodes: Vec<u32>, hold: Hold) -> FilmSupport {
        FilmSupport { name: String::new(), nodes, hold, motion: None }
    }

    #[test]
    fn supports_on_one_node_add_up() {
        let slant = Vector3::new(1.0, 1.0, 0.0).normalize();
        let supports = [
            support(vec![0, 1, 2], Hold::Plane(slant)),
            support(vec![1, 2], Hold::Components([true, false, false])),
            support(vec![2, 3], Hold::Components([false, false, true])),
        ];
        let all = Supports::new(&supports, &Field::zeros(5));
        let free = |node: usize, v: [f64; 3]| all.projector(node) * Vector3::from(v);
        assert!((free(0, [1.0, -1.0, 5.0]) - Vector3::new(1.0, -1.0, 5.0)).norm() < 1e-15);
        assert!(free(0, [1.0, 1.0, 0.0]).norm() < 1e-15);
        // A slanted plane and x hold all but z.
        assert!((free(1, [1.0, 2.0, 3.0]) - Vector3::new(0.0, 0.0, 3.0)).norm() < 1e-15);
        assert_eq!(free(2, [1.0, 2.0, 3.0]), Vector3::zeros());
        assert_eq!(free(3, [1.0, 2.0, 3.0]), Vector3::new(1.0, 2.0, 0.0));
        assert_eq!(free(4, [1.0, 2.0, 3.0]), Vector3::new(1.0, 2.0, 3.0));
        assert_eq!(all.oblique.iter().map(|(node, _)| *node).collect::<Vec<_>>(), [0, 1]);
    }
}
