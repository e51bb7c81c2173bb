//! Intersections: edges that pass through elements, over the whole mesh.
//!
//! ```text
//! n·(p − a) and n·(q − a) have different signs, and the edge crosses the plane inside the element
//! ```
//!
//! Symbols: p, q ends of the edge; n normal and a a node of the element. The pairs come from the
//! monitor's search, at one frame.

use nalgebra::Vector3;

use super::motion::largest_motion;
use super::search::IntersectionSearch;
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;
use crate::platform::simd::InstructionSet;

/// How far nodes may move until the next search, over their motion since the last update. Chosen.
const REACH_PER_MOTION: f64 = 8.0;
/// Largest such reach over the mean edge length: film that moves more is searched at every update. Chosen.
const MAX_REACH: f64 = 0.1;
/// Pairs of elements with overlapping boxes for each element, at most, in a search with a reach. Chosen, as for the
/// near list.
const MAX_PAIRS: usize = 64;

/// Every edge and element that intersect at these positions (m) and share no node, in order.
pub fn intersections(topology: &Topology, positions: &Field) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    let mut search = IntersectionSearch::new(topology, InstructionSet::detect());
    search.find(topology, positions, 0.0, usize::MAX, &mut pairs);
    let pairs = pairs.into_iter().filter(|pair| intersects(topology, positions, *pair));
    let mut found: Vec<(u32, u32)> = pairs.map(|[edge, element]| (edge, element)).collect();
    found.sort_unstable();
    found
}

/// Counts the intersections of moving film, at each time from its positions alone.
#[derive(Debug, Clone, PartialEq)]
pub struct IntersectionCounter {
    search: IntersectionSearch,
    /// Mean edge length, m.
    edge_length: f64,
    /// Positions at the last search, m.
    reference: Field,
    /// How far every node may be from there for the pairs to be all that can intersect, m.
    reach: f64,
    /// Positions at the last update, m.
    last: Field,
    /// Pairs that may intersect.
    pairs: Vec<[u32; 2]>,
    /// Number of intersections at the last update.
    pub count: u64,
}

impl IntersectionCounter {
    /// Counts the intersections at these positions (m).
    pub fn new(topology: &Topology, positions: &Field, instruction_set: InstructionSet) -> Self {
        let search = IntersectionSearch::new(topology, instruction_set);
        let length =
            |[a, b]: &[u32; 2]| (positions.get(*a as usize) - positions.get(*b as usize)).norm();
        let sum: f64 = topology.edges.iter().map(length).sum();
        let edge_length = sum / topology.edges.len() as f64;
        let (reference, last, pairs) = (positions.clone(), positions.clone(), Vec::new());
        let mut counter =
            Self { search, edge_length, reference, reach: -1.0, last, pairs, count: 0 };
        counter.update(topology, positions);
        counter
    }

    /// Counts the intersections at these positions (m).
    pub fn update(&mut self, topology: &Topology, positions: &Field) {
        let moved = largest_motion(&self.last, positions);
        self.last.copy_from(positions);
        // Written so that NaN searches.
        let covered = largest_motion(&self.reference, positions) <= self.reach;
        if !covered {
            let wanted = REACH_PER_MOTION * moved;
            let near = wanted <= MAX_REACH * self.edge_length;
            let reach = if near { wanted } else { 0.0 };
            let most = MAX_PAIRS * topology.triangles.len();
            let found = self.search.find(topology, positions, reach, most, &mut self.pairs);
            self.reach = if found { reach } else { 0.0 };
            if !found {
                self.search.find(topology, positions, 0.0, usize::MAX, &mut self.pairs);
            }
            self.reference.copy_from(positions);
        }
        let found = self.pairs.iter().filter(|pair| intersects(topology, positions, **pair));
        self.count = found.count() as u64;
    }
}

/// Whether an edge passes through an element.
fn intersects(topology: &Topology, positions: &Field, [edge, element]: [u32; 2]) -> bool {
    let position = |node: u32| positions.get(node as usize);
    segment_intersects_triangle(
        topology.edges[edge as usize].map(position),
        topology.triangles[element as usize].map(position),
    )
}

/// Whether a segment passes through a triangle. Segments in the plane of the triangle do not.
fn segment_intersects_triangle([p, q]: [Vector3<f64>; 2], [a, b, c]: [Vector3<f64>; 3]) -> bool {
    let normal = (b - a).cross(&(c - a));
    let (start, end) = (normal.dot(&(p - a)), normal.dot(&(q - a)));
    // Both ends on one side of the plane, or both in it.
    if start * end > 0.0 || (start - end).abs() <= 0.0 {
        return false;
    }
    let hit = p + (q - p) * (start / (start - end));
    let side = |u: Vector3<f64>, v: Vector3<f64>| normal.dot(&(v - u).cross(&(hit - u)));
    side(a, b) >= 0.0 && side(b, c) >= 0.0 && side(c, a) >= 0.0
}

#[cfg(test)]
pub(super) mod tests {
    use proptest::prelude::*;

    use super::*;

    /// All intersections, without a search.
    pub fn all_intersections(topology: &Topology, positions: &Field) -> Vec<(u32, u32)> {
        let mut found = Vec::new();
        for (edge, ends) in (0..).zip(&topology.edges) {
            for (element, corners) in (0..).zip(&topology.triangles) {
                let shared = ends.iter().any(|node| corners.contains(node));
                if !shared && intersects(topology, positions, [edge, element]) {
                    found.push((edge, element));
                }
            }
        }
        found
    }

    #[test]
    fn crossing_triangles_intersect_and_stacked_triangles_do_not() {
        let v = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let topology = Topology::new(6, &[[0, 1, 2], [3, 4, 5]]);
        let stacked = [
            v(0.0, 0.0, 0.0),
            v(1.0, 0.0, 0.0),
            v(0.0, 1.0, 0.0),
            v(0.0, 0.0, 0.01),
            v(1.0, 0.0, 0.01),
            v(0.0, 1.0, 0.01),
        ];
        assert!(intersections(&topology, &Field::of(&stacked)).is_empty());
        let mut crossing = stacked;
        crossing[5] = v(0.2, 0.2, -0.5);
        assert!(!intersections(&topology, &Field::of(&crossing)).is_empty());
    }

    proptest! {
        /// The search finds the same intersections as a test of all pairs, on every instruction set.
        #[test]
        fn no_intersection_is_missed(
            positions in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 14),
            flat in prop::sample::select(vec![1.0, 1e-3, 1e-8, 0.0]),
        ) {
            let triangles = [[0, 1, 2], [2, 1, 3], [3, 4, 5], [6, 7, 8], [9, 10, 11], [11, 12, 13]];
            let topology = Topology::new(14, &triangles);
            let x: Vec<_> =
                positions.into_iter().map(|[x, y, z]| Vector3::new(x, y, flat * z)).collect();
            let x = Field::of(&x);
            let all = all_intersections(&topology, &x);
            prop_assert_eq!(&intersections(&topology, &x), &all);
            for set in InstructionSet::ALL {
                let counter = IntersectionCounter::new(&topology, &x, set);
                prop_assert_eq!(counter.count, all.len() as u64);
            }
        }
    }
}
