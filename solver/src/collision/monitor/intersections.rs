//! Intersections: edges that pass through elements, over the whole mesh.
//!
//! ```text
//! n·(p − a) and n·(q − a) have different signs, and the edge crosses the plane inside the element
//! ```
//!
//! Symbols: p, q ends of the edge; n normal and a a node of the element. The pairs come from the
//! monitor's search, at one frame. Where a block of its steps ends at that frame, they are those of elements that no
//! plane separates on the motion of the block, and of elements that share a node.

use nalgebra::Vector3;

use super::query::{EDGE_ELEMENTS, Pairs, QueryKind};
use super::tracking::PairTracker;
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;
use crate::platform::simd::InstructionSet;

/// Every edge and element that intersect at these positions (m) and share no node, in order.
pub fn intersections(topology: &Topology, positions: &Field) -> Vec<(u32, u32)> {
    let mut pairs = Pairs::default();
    let set = InstructionSet::detect();
    PairTracker::new(QueryKind::Intersections, topology, positions, set).find_without_history(
        topology,
        [positions; 2],
        0.0,
        &mut pairs,
    );
    let pairs = pairs[EDGE_ELEMENTS].iter().filter(|pair| intersects(topology, positions, **pair));
    let mut found: Vec<(u32, u32)> = pairs.map(|[edge, element]| (*edge, *element)).collect();
    found.sort_unstable();
    found
}

/// Counts the intersections of moving film, at each time from its positions alone.
#[derive(Debug, Clone, PartialEq)]
pub struct IntersectionCounter {
    tracker: PairTracker,
    /// Positions at the last update, m.
    last: Field,
    /// Scratch memory: pairs that may intersect.
    pairs: Pairs,
    /// Number of intersections at the last update.
    pub count: u64,
}

impl IntersectionCounter {
    /// Counts the intersections at these positions (m). Of elements without a common node only those in `elements` may
    /// intersect.
    pub fn new(
        topology: &Topology,
        positions: &Field,
        elements: &[[u32; 2]],
        instruction_set: InstructionSet,
    ) -> Self {
        let kind = QueryKind::Intersections;
        let tracker = PairTracker::new(kind, topology, positions, instruction_set);
        let (last, pairs) = (positions.clone(), Pairs::default());
        let mut counter = Self { tracker, last, pairs, count: 0 };
        counter.update_among(topology, positions, elements);
        counter
    }

    /// Counts the intersections at these positions (m).
    pub fn update(&mut self, topology: &Topology, positions: &Field) {
        self.tracker.advance(topology, &self.last, positions);
        self.tracker.find(topology, [&self.last, positions], &mut self.pairs);
        self.count(topology, positions);
    }

    /// The same as [`Self::update`]. Of elements without a common node only those in `elements` may intersect.
    pub fn update_among(&mut self, topology: &Topology, positions: &Field, elements: &[[u32; 2]]) {
        self.tracker.advance(topology, &self.last, positions);
        self.tracker.find_among(topology, positions, elements, &mut self.pairs);
        self.count(topology, positions);
    }

    fn count(&mut self, topology: &Topology, positions: &Field) {
        self.last.copy_from(positions);
        let pairs = self.pairs[EDGE_ELEMENTS].iter();
        let found = pairs.filter(|pair| intersects(topology, positions, **pair));
        self.count = found.count() as u64;
    }
}

/// Whether an edge passes through an element.
fn intersects(topology: &Topology, positions: &Field, [edge, element]: [u32; 2]) -> bool {
    if topology.ignores_edge(edge, element) {
        return false;
    }
    segment_intersects_triangle(
        positions.at(topology.edges[edge as usize]),
        positions.at(topology.triangles[element as usize]),
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
                let mut counter = IntersectionCounter::new(&topology, &x, &[], set);
                counter.update(&topology, &x);
                prop_assert_eq!(counter.count, all.len() as u64);
            }
        }
    }
}
