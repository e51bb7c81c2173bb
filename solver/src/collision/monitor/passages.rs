//! Whether film went through film: told by an audit that shares with contact what is next to what, but
//! no bound and no decision.
//!
//! ```text
//! node and element:  (b − a) × (c − a)·(p − a) = 0 at a t where p lies inside the element
//! two edges:         (b − a) × (d − c)·(c − a) = 0 at a t where the lines meet inside both
//! ```
//!
//! All points move in straight lines from t = 0 to t = 1, so the left sides are cubics; their roots
//! are bracketed by those of their derivatives. Candidates come from boxes of its own.
//! [`passages`] looks at one straight motion, [`super::watch`] at a run.

use core::fmt;

use nalgebra::Vector3;

use crate::collision::broad_phase::kdop::KDops;
use crate::collision::broad_phase::scheduler::{CandidateKind, QueryKind, nearer};
use crate::collision::contact::distance::{Closest, point_triangle, segment_segment};
use crate::collision::contact::topology::Topology;
use crate::geometry::field::Field;

/// One passage.
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
        /// The other.
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

    fn places(self, topology: &Topology, places: &Field) -> Four {
        self.nodes(topology).map(|node| places.get(node as usize))
    }

    /// Closest points of the pair.
    pub(super) fn closest(self, topology: &Topology, places: &Field) -> Closest {
        let x = self.places(topology, places);
        match self {
            Self::Node { .. } => point_triangle(&x),
            Self::Edge { .. } => segment_segment(&x),
        }
    }

    /// The line between the closest points here, where a plane across it parts the pair: closest points
    /// are known to rounding only, of edges as good as parallel to less. Else nought, across which
    /// nothing is parted.
    pub(super) fn parting(
        self,
        topology: &Topology,
        at: &Field,
        closest: &Closest,
    ) -> Vector3<f64> {
        let between = closest.between;
        if self.stays_apart(topology, at, &between) { between } else { Vector3::zeros() }
    }

    /// Whether a plane across the line between the closest points at the start of a straight way still
    /// parts the pair at its end: it parted it at the start, and so on the whole way.
    pub(super) fn stays_apart(
        self,
        topology: &Topology,
        to: &Field,
        between: &Vector3<f64>,
    ) -> bool {
        let along = self.places(topology, to).map(|x| between.dot(&x));
        let (one, other) = along.split_at(match self {
            Self::Node { .. } => 1,
            Self::Edge { .. } => 2,
        });
        let least = one.iter().copied().fold(f64::INFINITY, f64::min);
        let most = other.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        least - most > CLEAR * between.norm_squared()
    }

    /// Whether the pair passes through itself on the straight way between two places of its nodes.
    pub(super) fn happens(self, topology: &Topology, from: &Field, to: &Field) -> bool {
        let nodes = self.nodes(topology).map(|node| node as usize);
        let (x, y) = (nodes.map(|node| from.get(node)), nodes.map(|node| to.get(node)));
        match self {
            Self::Node { .. } => {
                let ways = [(2, 1), (3, 1), (0, 1)];
                roots(&x, &y, ways).into_iter().flatten().any(|t| node_inside(&between(&x, &y, t)))
            }
            Self::Edge { .. } => {
                let ways = [(1, 0), (3, 2), (2, 0)];
                roots(&x, &y, ways).into_iter().flatten().any(|t| edges_inside(&between(&x, &y, t)))
            }
        }
    }
}

/// Share of its distance a pair must keep to count as parted, so that rounding does not count.
const CLEAR: f64 = 1e-3;

/// Share of their lengths within which two edges count as meeting where both are in one plane.
const MEET: f64 = 1e-6;

type Four = [Vector3<f64>; 4];

fn between(x: &Four, y: &Four, t: f64) -> Four {
    core::array::from_fn(|k| x[k] + (y[k] - x[k]) * t)
}

/// Roots in [0, 1] of the cubic (u × v)·w, each the way between two of four points.
fn roots(x: &Four, y: &Four, ways: [(usize, usize); 3]) -> [Option<f64>; 3] {
    let [u, v, w] = ways.map(|(to, from)| x[to] - x[from]);
    let [du, dv, dw] = ways.map(|(to, from)| (y[to] - x[to]) - (y[from] - x[from]));
    let c0 = u.cross(&v).dot(&w);
    let mixed = du.cross(&v) + u.cross(&dv);
    let c1 = mixed.dot(&w) + u.cross(&v).dot(&dw);
    let c2 = du.cross(&dv).dot(&w) + mixed.dot(&dw);
    let c3 = du.cross(&dv).dot(&dw);
    let value = |t: f64| ((c3 * t + c2) * t + c1) * t + c0;
    // Between the roots of the derivative the cubic runs one way.
    let (a, b, c) = (3.0 * c3, 2.0 * c2, c1);
    let mut cuts = [0.0, 1.0, 1.0, 1.0];
    let inside = b * b - 4.0 * a * c;
    if inside > 0.0 {
        let q = -0.5 * (b + inside.sqrt() * if b < 0.0 { -1.0 } else { 1.0 });
        let mut turns = [q / a, c / q];
        if turns[0] > turns[1] {
            turns.swap(0, 1);
        }
        let valid = |t: f64| if t > 0.0 && t < 1.0 { Some(t) } else { None };
        for (cut, turn) in cuts[1..].iter_mut().zip(turns.into_iter().filter_map(valid)) {
            *cut = turn;
        }
    }
    core::array::from_fn(|k| {
        let (mut low, mut high) = (cuts[k], cuts[k + 1]);
        let (first, last) = (value(low), value(high));
        if low >= high || (first > 0.0) == (last > 0.0) {
            return None;
        }
        for _ in 0..60 {
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

/// Whether the first point, in the plane of the others, lies inside them.
fn node_inside([p, a, b, c]: &Four) -> bool {
    let normal = (b - a).cross(&(c - a));
    let side = |u: &Vector3<f64>, v: &Vector3<f64>| normal.dot(&(v - u).cross(&(p - u)));
    side(a, b) >= 0.0 && side(b, c) >= 0.0 && side(c, a) >= 0.0
}

/// Whether two segments in one plane cross inside both.
fn edges_inside([a, b, c, d]: &Four) -> bool {
    let normal = (b - a).cross(&(d - c));
    let below = normal.norm_squared();
    if below == 0.0 {
        return false;
    }
    let s = (c - a).cross(&(d - c)).dot(&normal) / below;
    let t = (c - a).cross(&(b - a)).dot(&normal) / below;
    // Edges on one line have no sound crossing: the points must be one.
    let apart = (a + (b - a) * s) - (c + (d - c) * t);
    let size = (b - a).norm() + (d - c).norm();
    (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) && apart.norm() <= MEET * size
}

/// The passage a pair may make.
pub(super) fn passage(couple: CandidateKind, [first, second]: [u32; 2]) -> Passage {
    match couple {
        CandidateKind::NodeElement | CandidateKind::EdgeElement => {
            Passage::Node { node: first, element: second }
        }
        CandidateKind::EdgeEdge => Passage::Edge { edge: first, other: second },
    }
}

/// Every passage on the straight way between two places of all nodes, in order.
pub fn passages(topology: &Topology, from: &Field, to: &Field) -> Vec<Passage> {
    let mut boxes = KDops::new(&topology.patches, from);
    boxes.hold(&topology.patches, to);
    let mut found = Vec::new();
    nearer(QueryKind::Collision, topology, &boxes, 0.0, |couple, pair| {
        let own = passage(couple, pair);
        if own.happens(topology, from, to) {
            found.push(own);
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

    /// A triangle at rest, and a node or an edge that flies.
    pub fn scene(flier: &[Vector3<f64>], way: Vector3<f64>) -> (Topology, Field, Field) {
        let mut places = vec![v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)];
        let still = places.len();
        places.extend(flier);
        let topology = Topology::new(places.len(), &[[0, 1, 2], [3, 4, 5]]);
        let after: Vec<_> =
            places.iter().enumerate().map(|(k, x)| if k < still { *x } else { x + way }).collect();
        (topology, Field::of(&places), Field::of(&after))
    }

    #[test]
    fn nodes_and_edges_through_film_are_counted() {
        // A corner first, through the middle.
        let corner = [v(0.3, 0.3, 0.1), v(0.3, 0.8, 3.0), v(0.8, 0.3, 3.0)];
        let (topology, from, to) = scene(&corner, v(0.0, 0.0, -0.2));
        assert_eq!(passages(&topology, &from, &to), [Passage::Node { node: 3, element: 0 }]);
        // Beside it.
        let (topology, from, to) = scene(&corner.map(|x| x + v(1.0, 0.0, 0.0)), v(0.0, 0.0, -0.2));
        assert!(passages(&topology, &from, &to).is_empty());
        // An edge over an edge, no node through anything.
        let edge = [v(0.5, -0.2, 0.1), v(0.5, 0.2, 0.1), v(0.5, 0.0, 2.0)];
        let (topology, from, to) = scene(&edge, v(0.0, 0.0, -0.2));
        let found = passages(&topology, &from, &to);
        assert!(found.iter().any(|p| matches!(p, Passage::Edge { .. })), "{found:?}");
    }

    proptest! {
        /// The boxes find what looking at all pairs finds.
        #[test]
        fn nothing_is_missed(
            places in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 12),
            ways in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 12),
        ) {
            let topology = Topology::new(12, &[[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]]);
            let from: Vec<Vector3<f64>> = places.into_iter().map(Vector3::from).collect();
            let to: Vec<Vector3<f64>> =
                from.iter().zip(ways).map(|(x, way)| x + Vector3::from(way)).collect();
            let (from, to) = (Field::of(&from), Field::of(&to));
            let mut all = Vec::new();
            for node in 0..12 {
                for element in 0..4 {
                    let own = topology.triangles[element as usize].contains(&node);
                    if !own {
                        all.push(Passage::Node { node, element });
                    }
                }
            }
            let edges = u32::try_from(topology.edges.len()).unwrap();
            for edge in 0..edges {
                for other in edge + 1..edges {
                    let own = topology.edges[edge as usize];
                    if !topology.edges[other as usize].iter().any(|node| own.contains(node)) {
                        all.push(Passage::Edge { edge, other });
                    }
                }
            }
            all.retain(|passage| passage.happens(&topology, &from, &to));
            prop_assert_eq!(passages(&topology, &from, &to), all);
        }
    }
}
