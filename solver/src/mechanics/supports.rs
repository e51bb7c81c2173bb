//! What holds film: components of nodes that stand, move as prescribed, or move with a rigid plane.
//!
//! ```text
//! v⁺ = v⁻ + P a h            P: onto the directions nobody holds
//! n·v⁺ = V,  V⁺ = V⁻ + h (F + Σ n·f_i)/(M + Σ m_i)            a plane of mass M as a free body
//! v⁺ = (path(t + Δt) − x)/Δt                                    prescribed, in what is held
//! ```
//!
//! A held component takes no part in the balance of momentum: the support bears whatever force acts
//! on it. A support that stands does no work; what moves does, and the ledger counts it.

use nalgebra::{Matrix3, Vector3};

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::WIDTH;
use crate::scene::film_support::{FilmSupport, Hold, PlaneBody};
use crate::scene::motion::Motion;

/// Which components of which nodes are held, and by what.
#[derive(Debug, Clone, PartialEq)]
pub struct Supports {
    /// What is free along the axes.
    pub free: Free,
    /// Nodes held along directions that are no axes, in ascending order, with P.
    pub oblique: Vec<(u32, Matrix3<f64>)>,
    /// What moves as prescribed.
    pub movers: Vec<Mover>,
    /// Rigid planes that move as free bodies.
    pub bodies: Vec<Body>,
}

/// What is free along the axes: 1 where a component of a node is, 0 where it is held.
#[derive(Debug, Clone, PartialEq)]
pub struct Free {
    field: Field,
    /// Whether any of eight nodes is held, from the first on: most are free, and need not be asked.
    held: Vec<bool>,
}

impl Free {
    /// All of this many nodes.
    pub fn all(nodes: usize) -> Self {
        Self { field: Field::repeat(1.0, nodes), held: vec![false; nodes.div_ceil(WIDTH)] }
    }

    /// Of a node.
    pub fn get(&self, node: usize) -> Vector3<f64> {
        self.field.get(node)
    }

    /// Says what is free of a node: components 1 or 0.
    pub fn set(&mut self, node: usize, free: Vector3<f64>) {
        self.field.set(node, free);
        let first = node / WIDTH * WIDTH;
        let end = self.field.len().min(first + WIDTH);
        let whole = Vector3::repeat(1.0);
        self.held[node / WIDTH] = (first..end).any(|own| self.field.get(own) != whole);
    }

    /// Of all nodes.
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// Whether anything is held of the nodes from `first` to seven after it; `first` a multiple of eight.
    #[inline]
    pub fn any_held(&self, first: usize) -> bool {
        self.held[first / WIDTH]
    }
}

/// Nodes that move as prescribed, in what is held of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Mover {
    /// Nodes.
    pub nodes: Vec<u32>,
    /// Where they start, m.
    pub start: Vec<Vector3<f64>>,
    /// Onto what is held.
    pub held: Matrix3<f64>,
    /// Their common path.
    pub motion: Motion,
    /// What each goes beside, growing as the motion does, m.
    pub beside: Vec<Vector3<f64>>,
}

impl Mover {
    /// Each node and where it has to be at `time` (s), m.
    pub fn places(&self, time: f64) -> impl Iterator<Item = (u32, Vector3<f64>)> + '_ {
        let part = self.motion.part(time);
        let ways = self.nodes.iter().zip(self.start.iter().zip(&self.beside));
        ways.map(move |(node, (start, beside))| {
            (*node, self.motion.place(*start, time) + beside * part)
        })
    }
}

/// A rigid plane and the nodes bound to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Nodes.
    pub nodes: Vec<u32>,
    /// The plane.
    pub plane: PlaneBody,
}

impl Body {
    /// Mass of the plane and of the film bound to it, kg.
    pub fn mass(&self, model: &FilmModel) -> f64 {
        self.plane.mass + self.nodes.iter().map(|node| model.mass[*node as usize]).sum::<f64>()
    }
}

impl Hold {
    /// Onto what is held.
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

    /// Unit directions held.
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

/// How little of a direction must be left over those held already for it to hold anything more.
const PARALLEL: f64 = 1e-9;

impl Supports {
    /// No supports for this many nodes.
    pub fn none(nodes: usize) -> Self {
        Self { free: Free::all(nodes), oblique: Vec::new(), movers: Vec::new(), bodies: Vec::new() }
    }

    /// These supports on nodes that start at these places (m).
    pub fn new(supports: &[FilmSupport], places: &Field) -> Self {
        let mut all = Self::none(places.len());
        let mut directions: Vec<Vec<Vector3<f64>>> = vec![Vec::new(); places.len()];
        for support in supports {
            for node in &support.nodes {
                for mut direction in support.hold.directions() {
                    let held = &mut directions[*node as usize];
                    for other in held.iter() {
                        direction -= other * other.dot(&direction);
                    }
                    if direction.norm() > PARALLEL {
                        held.push(direction.normalize());
                    }
                }
            }
            if let Hold::Body(plane) = support.hold {
                all.bodies.push(Body { nodes: support.nodes.clone(), plane });
            } else if let Some(motion) = support.motion {
                all.movers.push(Mover {
                    nodes: support.nodes.clone(),
                    start: support.nodes.iter().map(|node| places.get(*node as usize)).collect(),
                    held: support.hold.projector(),
                    motion,
                    beside: vec![Vector3::zeros(); support.nodes.len()],
                });
            }
        }
        for (node, held) in (0_u32..).zip(&directions) {
            let mut projector = Matrix3::identity();
            for direction in held {
                projector -= direction * direction.transpose();
            }
            let axes = (0..3).all(|k| {
                let row: Vec<f64> = (0..3).map(|l| projector[(k, l)]).collect();
                // Exactly 0, or 1 on the diagonal: anything else is oblique.
                row.iter()
                    .enumerate()
                    .all(|(l, p)| p.abs() <= 0.0 || (l == k && (p - 1.0).abs() <= 0.0))
            });
            if axes {
                all.free.set(node as usize, projector.diagonal());
            } else if held.len() == 3 {
                all.free.set(node as usize, Vector3::zeros());
            } else {
                all.oblique.push((node, projector));
            }
        }
        all
    }

    /// Holds the components of these nodes that `fix` names: letters of "xyz".
    pub fn hold(&mut self, nodes: &[u32], fix: &str) {
        for node in nodes {
            let node = *node as usize;
            let mut free = self.free.get(node);
            for axis in fix.chars() {
                match axis {
                    'x' => free.x = 0.0,
                    'y' => free.y = 0.0,
                    'z' => free.z = 0.0,
                    _ => {}
                }
            }
            self.free.set(node, free);
        }
    }

    /// P of a node: onto the directions nobody holds.
    pub fn projector(&self, node: usize) -> Matrix3<f64> {
        match self.oblique.binary_search_by_key(&node, |(own, _)| *own as usize) {
            Ok(at) => self.oblique[at].1,
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
        // A slanted plane and x leave z alone.
        assert!((free(1, [1.0, 2.0, 3.0]) - Vector3::new(0.0, 0.0, 3.0)).norm() < 1e-15);
        assert_eq!(free(2, [1.0, 2.0, 3.0]), Vector3::zeros());
        assert_eq!(free(3, [1.0, 2.0, 3.0]), Vector3::new(1.0, 2.0, 0.0));
        assert_eq!(free(4, [1.0, 2.0, 3.0]), Vector3::new(1.0, 2.0, 3.0));
        assert_eq!(all.oblique.iter().map(|(node, _)| *node).collect::<Vec<_>>(), [0, 1]);
    }
}
