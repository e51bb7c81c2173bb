//! How often film lies through film: edges that pierce elements, over the whole mesh.
//!
//! ```text
//! normal·(p − a) and normal·(q − a) of unlike sign, and where the edge meets the plane lies in the element
//! ```
//!
//! A plane that parts edge and element tells most pairs apart ([`super::separating_planes`]), and how long they
//! need not be looked at again; only of the others the distance is asked.

use nalgebra::Vector3;

use super::distance_batch::{edge_gaps, element_gaps};
use super::separating_planes::edges_apart;
use super::topology::Topology;
use crate::collision::broad_phase::kdop::KDops;
use crate::collision::broad_phase::scheduler::{CandidateScheduler, QueryKind, nearer};
use crate::geometry::field::Field;
use crate::platform::simd::InstructionSet;

/// Every edge and element at these places (m) that pierce each other and share no node, in order.
pub fn intersections(topology: &Topology, places: &Field) -> Vec<(u32, u32)> {
    let boxes = KDops::new(&topology.patches, places);
    let mut found = Vec::new();
    nearer(QueryKind::Intersection, topology, &boxes, 0.0, |_, [edge, element]| {
        if pierces(topology, places, edge, element) {
            found.push((edge, element));
        }
    });
    found.sort_unstable();
    found
}

/// Room for pairs no plane parts, and for what they are made of.
#[derive(Debug, Clone, PartialEq, Default)]
struct Room {
    unparted: Vec<usize>,
    ends: Vec<[u32; 2]>,
    sides: Vec<[u32; 2]>,
    from_ends: Vec<f64>,
    from_sides: Vec<f64>,
}

/// Counts intersections again and again while film moves, looking only at what may have met since.
#[derive(Debug, Clone, PartialEq)]
pub struct IntersectionCounter {
    lookout: CandidateScheduler,
    /// Where the film was at the last look, m.
    last: Field,
    room: Room,
    /// Intersections at the last look.
    pub count: u64,
}

impl IntersectionCounter {
    /// Looks for the first time, at these places (m).
    pub fn new(topology: &Topology, places: &Field) -> Self {
        let lookout =
            CandidateScheduler::new(QueryKind::Intersection, topology, BIN * places.size());
        let mut own = Self { lookout, last: places.clone(), room: Room::default(), count: 0 };
        own.look(topology, places);
        own
    }

    /// Counts the intersections at these places (m).
    pub fn look(&mut self, topology: &Topology, places: &Field) {
        self.lookout.travel(topology, &self.last, places);
        self.last.copy_from(places);
        let (mut count, room) = (0, &mut self.room);
        let gaps = |_, pairs: &[[u32; 2]], gaps: &mut Vec<f64>| {
            edges_apart(InstructionSet::detect(), topology, places, pairs, gaps);
            room.measure(topology, places, pairs, gaps);
        };
        self.lookout.now(topology, places, gaps, |_, [edge, element]| {
            // Film that touches is not through.
            count += u64::from(pierces(topology, places, edge, element));
        });
        self.count = count;
    }
}

/// Path of a bin, as a share of the film's size.
const BIN: f64 = 2e-3;

impl Room {
    /// Puts the distance (m) in place of each gap (m) that is not above 0, or no number: of pairs that do
    /// not pierce each other the least of those of the edge's ends from the element, and of the edge from
    /// the element's sides.
    fn measure(
        &mut self,
        topology: &Topology,
        places: &Field,
        pairs: &[[u32; 2]],
        gaps: &mut [f64],
    ) {
        let Self { unparted, ends, sides, from_ends, from_sides } = self;
        unparted.clear();
        ends.clear();
        sides.clear();
        from_ends.clear();
        from_sides.clear();
        for (at, ([edge, element], gap)) in pairs.iter().zip(&mut *gaps).enumerate() {
            if *gap > 0.0 {
                continue;
            }
            *gap = 0.0;
            if !pierces(topology, places, *edge, *element) {
                unparted.push(at);
                ends.extend(topology.edges[*edge as usize].map(|end| [end, *element]));
                sides.extend(topology.sides[*element as usize].map(|side| [*edge, side]));
            }
        }
        element_gaps(InstructionSet::detect(), topology, places, ends, from_ends);
        edge_gaps(InstructionSet::detect(), topology, places, sides, from_sides);
        let own = from_ends.chunks_exact(2).zip(from_sides.chunks_exact(3));
        for (at, (ends, sides)) in unparted.iter().zip(own) {
            gaps[*at] = ends.iter().chain(sides).fold(f64::INFINITY, |least, gap| least.min(*gap));
        }
    }
}

/// Whether an edge passes through an element.
fn pierces(topology: &Topology, places: &Field, edge: u32, element: u32) -> bool {
    let place = |node: u32| places.get(node as usize);
    passes(
        topology.edges[edge as usize].map(place),
        topology.triangles[element as usize].map(place),
    )
}

/// Whether a segment passes through a triangle.
fn passes([p, q]: [Vector3<f64>; 2], [a, b, c]: [Vector3<f64>; 3]) -> bool {
    let normal = (b - a).cross(&(c - a));
    let (start, end) = (normal.dot(&(p - a)), normal.dot(&(q - a)));
    // Both on the plane, or both on one side of it.
    if start * end > 0.0 || (start - end).abs() <= 0.0 {
        return false;
    }
    let hit = p + (q - p) * (start / (start - end));
    let side = |u: Vector3<f64>, v: Vector3<f64>| normal.dot(&(v - u).cross(&(hit - u)));
    side(a, b) >= 0.0 && side(b, c) >= 0.0 && side(c, a) >= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tangle_is_seen_and_a_stack_is_not() {
        let v = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let topology = Topology::new(6, &[[0, 1, 2], [3, 4, 5]]);
        let stack = [
            v(0.0, 0.0, 0.0),
            v(1.0, 0.0, 0.0),
            v(0.0, 1.0, 0.0),
            v(0.0, 0.0, 0.01),
            v(1.0, 0.0, 0.01),
            v(0.0, 1.0, 0.01),
        ];
        assert!(intersections(&topology, &Field::of(&stack)).is_empty());
        let mut tangle = stack;
        tangle[5] = v(0.2, 0.2, -0.5);
        assert!(!intersections(&topology, &Field::of(&tangle)).is_empty());
    }
}
