//! Passages of film through film on straight motions.
//!
//! ```text
//! node and element:  (b − a) × (c − a)·(p − a) = 0 at a t where p is inside the element
//! two edges:         (b − a) × (d − c)·(c − a) = 0 at a t where the edges cross inside both
//! ```
//!
//! All points move on straight lines from t = 0 to t = 1, so the left sides are cubic polynomials in
//! t. Their roots are bracketed by the roots of their derivatives.
//!
//! [`passages`] tests one straight motion of the whole mesh; the tunnelling monitor tests a run. The
//! tests use positions only, no bound or decision of the contact model.

use core::fmt;

use nalgebra::Vector3;

use super::primitives::{EDGES, MAX_CROSSING_DISTANCE, NODES};
use super::query::{Pairs, QueryKind};
use super::tracking::PairTracker;
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;
use crate::platform::simd::InstructionSet;

/// Number of bisections of a root's bracket. It shrinks to 2⁻⁶⁰ of its width, below the rounding error
/// of t.
const BISECTIONS: u32 = 60;

/// A passage of one primitive through another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Passage {
    /// A node through an element.
    Node {
        /// Node.
        node: u32,
        /// Element.
        element: u32,
    },
    /// An edge through an edge, the lower number first.
    Edge {
        /// Edge.
        edge: u32,
        /// The other edge.
        other: u32,
    },
}

impl fmt::Display for Passage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Node { node, element } => write!(f, "node {node} through element {element}"),
            Self::Edge { edge, other } => write!(f, "edge {edge} through edge {other}"),
        }
    }
}

impl Passage {
    pub(super) fn nodes(self, topology: &Topology) -> [u32; 4] {
        match self {
            Self::Node { node, element } => {
                let [a, b, c] = topology.triangles[element as usize];
                [node, a, b, c]
            }
            Self::Edge { edge, other } => {
                let [a, b] = topology.edges[edge as usize];
                let [c, d] = topology.edges[other as usize];
                [a, b, c, d]
            }
        }
    }

    fn positions(self, topology: &Topology, positions: &Field) -> FourPoints {
        positions.at(self.nodes(topology))
    }

    /// Whether this passage occurs on the straight motion between two positions of all nodes.
    pub fn occurs(self, topology: &Topology, from: &Field, to: &Field) -> bool {
        let is_ignored = match self {
            Self::Node { node, element } => topology.ignores_node(node, element),
            Self::Edge { edge, other } => topology.ignores_edges(edge, other),
        };
        if is_ignored {
            return false;
        }
        let (x, y) = (self.positions(topology, from), self.positions(topology, to));
        match self {
            Self::Node { .. } => {
                let vectors = [(2, 1), (3, 1), (0, 1)];
                let mut times = coplanar_times(&x, &y, vectors).into_iter().flatten();
                times.any(|t| node_inside_triangle(&interpolate(&x, &y, t)))
            }
            Self::Edge { .. } => {
                let vectors = [(1, 0), (3, 2), (2, 0)];
                let mut times = coplanar_times(&x, &y, vectors).into_iter().flatten();
                times.any(|t| edges_cross(&interpolate(&x, &y, t)))
            }
        }
    }
}

/// Positions of the four nodes of a pair, m.
type FourPoints = [Vector3<f64>; 4];

fn interpolate(x: &FourPoints, y: &FourPoints, t: f64) -> FourPoints {
    core::array::from_fn(|k| x[k] + (y[k] - x[k]) * t)
}

/// Times in [0, 1] at which (u × v)·w = 0. Each of u, v, w is the vector from the second to the first
/// of two of the four points, which move from `x` to `y`.
fn coplanar_times(
    x: &FourPoints,
    y: &FourPoints,
    vectors: [(usize, usize); 3],
) -> [Option<f64>; 3] {
    let [u, v, w] = vectors.map(|(to, from)| x[to] - x[from]);
    let [du, dv, dw] = vectors.map(|(to, from)| (y[to] - x[to]) - (y[from] - x[from]));
    let c0 = u.cross(&v).dot(&w);
    let mixed = du.cross(&v) + u.cross(&dv);
    let c1 = mixed.dot(&w) + u.cross(&v).dot(&dw);
    let c2 = du.cross(&dv).dot(&w) + mixed.dot(&dw);
    let c3 = du.cross(&dv).dot(&dw);
    let value = |t: f64| ((c3 * t + c2) * t + c1) * t + c0;
    // Between the roots of its derivative the cubic is monotonic.
    let (a, b, c) = (3.0 * c3, 2.0 * c2, c1);
    let mut brackets = [0.0, 1.0, 1.0, 1.0];
    let discriminant = b * b - 4.0 * a * c;
    if discriminant > 0.0 {
        let q = -0.5 * (b + discriminant.sqrt() * if b < 0.0 { -1.0 } else { 1.0 });
        let mut extrema = [q / a, c / q];
        if extrema[0] > extrema[1] {
            extrema.swap(0, 1);
        }
        let inside = |t: f64| if t > 0.0 && t < 1.0 { Some(t) } else { None };
        let extrema = extrema.into_iter().filter_map(inside);
        for (bracket, extremum) in brackets[1..].iter_mut().zip(extrema) {
            *bracket = extremum;
        }
    }
    core::array::from_fn(|k| {
        let (mut low, mut high) = (brackets[k], brackets[k + 1]);
        let (first, last) = (value(low), value(high));
        if low >= high || (first > 0.0) == (last > 0.0) {
            return None;
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if (value(middle) > 0.0) == (first > 0.0) {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(0.5 * (low + high))
    })
}

/// Whether the first point, which is in the plane of the others, is inside their triangle.
fn node_inside_triangle([p, a, b, c]: &FourPoints) -> bool {
    let normal = (b - a).cross(&(c - a));
    let side = |u: &Vector3<f64>, v: &Vector3<f64>| normal.dot(&(v - u).cross(&(p - u)));
    side(a, b) >= 0.0 && side(b, c) >= 0.0 && side(c, a) >= 0.0
}

/// Whether two segments in one plane cross inside both.
fn edges_cross([a, b, c, d]: &FourPoints) -> bool {
    let normal = (b - a).cross(&(d - c));
    let squared = normal.norm_squared();
    if squared == 0.0 {
        return false;
    }
    let s = (c - a).cross(&(d - c)).dot(&normal) / squared;
    let t = (c - a).cross(&(b - a)).dot(&normal) / squared;
    let between = (a + (b - a) * s) - (c + (d - c) * t);
    let length = (b - a).norm() + (d - c).norm();
    (0.0..=1.0).contains(&s)
        && (0.0..=1.0).contains(&t)
        && between.norm() <= MAX_CROSSING_DISTANCE * length
}

/// Calls `visit` with the passage that each pair may make.
pub(super) fn each_passage(pairs: &Pairs, mut visit: impl FnMut(Passage)) {
    for [node, element] in &pairs[NODES] {
        visit(Passage::Node { node: *node, element: *element });
    }
    for [edge, other] in &pairs[EDGES] {
        visit(Passage::Edge { edge: *edge, other: *other });
    }
}

/// All passages on the straight motion between two positions of all nodes, in order.
pub fn passages(topology: &Topology, from: &Field, to: &Field) -> Vec<Passage> {
    let mut pairs = Pairs::default();
    let set = InstructionSet::detect();
    PairTracker::new(QueryKind::Passages, topology, from, set).find_without_history(
        topology,
        [from, to],
        0.0,
        &mut pairs,
    );
    let mut found = Vec::new();
    each_passage(&pairs, |passage| {
        if passage.occurs(topology, from, to) {
            found.push(passage);
        }
    });
    found.sort_unstable();
    found
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    pub fn v(x: f64, y: f64, z: f64) -> Vector3<f64> {
        Vector3::new(x, y, z)
    }

    /// A fixed triangle and one that moves: topology, and positions before and after.
    pub fn scene(moving: &[Vector3<f64>], displacement: Vector3<f64>) -> (Topology, Field, Field) {
        let mut positions = vec![v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)];
        let fixed = positions.len();
        positions.extend(moving);
        let mesh = Topology::new(positions.len(), &[[0, 1, 2], [3, 4, 5]]);
        let moved =
            |(node, x): (usize, &Vector3<f64>)| if node < fixed { *x } else { x + displacement };
        let after: Vec<_> = positions.iter().enumerate().map(moved).collect();
        (mesh, Field::of(&positions), Field::of(&after))
    }

    #[test]
    fn passages_of_nodes_and_edges_are_found() {
        // A corner through the middle of the triangle.
        let corner = [v(0.3, 0.3, 0.1), v(0.3, 0.8, 3.0), v(0.8, 0.3, 3.0)];
        let (mesh, from, to) = scene(&corner, v(0.0, 0.0, -0.2));
        assert_eq!(passages(&mesh, &from, &to), [Passage::Node { node: 3, element: 0 }]);
        // A corner beside the triangle.
        let (mesh, from, to) = scene(&corner.map(|x| x + v(1.0, 0.0, 0.0)), v(0.0, 0.0, -0.2));
        assert!(passages(&mesh, &from, &to).is_empty());
        // An edge through an edge; no node through an element.
        let edge = [v(0.5, -0.2, 0.1), v(0.5, 0.2, 0.1), v(0.5, 0.0, 2.0)];
        let (mesh, from, to) = scene(&edge, v(0.0, 0.0, -0.2));
        let found = passages(&mesh, &from, &to);
        assert!(found.iter().any(|p| matches!(p, Passage::Edge { .. })), "{found:?}");
    }

    /// All passages on a straight motion, without a search.
    pub fn all_passages(topology: &Topology, from: &Field, to: &Field) -> Vec<Passage> {
        let mut all = Vec::new();
        for node in 0..u32::try_from(topology.nodes()).unwrap() {
            for (element, corners) in (0..).zip(&topology.triangles) {
                if !corners.contains(&node) {
                    all.push(Passage::Node { node, element });
                }
            }
        }
        for (edge, ends) in (0_u32..).zip(&topology.edges) {
            for (other, other_ends) in (0_u32..).zip(&topology.edges).skip(edge as usize + 1) {
                if !other_ends.iter().any(|node| ends.contains(node)) {
                    all.push(Passage::Edge { edge, other });
                }
            }
        }
        all.retain(|passage| passage.occurs(topology, from, to));
        all
    }

    proptest! {
        /// The search finds the same passages as a test of all pairs.
        #[test]
        fn no_passage_is_missed(
            positions in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 14),
            displacements in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 14),
            motion in prop::sample::select(vec![1.0, 0.1, 1e-3]),
            flat in prop::sample::select(vec![1.0, 1e-2, 0.0]),
        ) {
            let triangles = [[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11], [11, 12, 13], [2, 1, 3]];
            let topology = Topology::new(14, &triangles);
            let from: Vec<Vector3<f64>> =
                positions.into_iter().map(|[x, y, z]| v(x, y, flat * z)).collect();
            let to: Vec<Vector3<f64>> = from
                .iter()
                .zip(displacements)
                .map(|(x, u)| x + Vector3::from(u) * motion + v(5.0, 0.0, 0.0))
                .collect();
            let (from, to) = (Field::of(&from), Field::of(&to));
            let all = all_passages(&topology, &from, &to);
            prop_assert_eq!(passages(&topology, &from, &to), all);
        }
    }
}
