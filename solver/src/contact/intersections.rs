//! How often film lies through film: edges that pierce elements, over the whole mesh.

use nalgebra::Vector3;

use super::gaps::{edge_gaps, element_gaps};
use super::topology::Topology;
use crate::proximity::boxes::Boxes;
use crate::proximity::lookout::{Lookout, Sought, nearer};
use crate::simd::Path;
use crate::state::Field;

/// Every edge and element at these places (m) that pierce each other and share no node, in order.
pub fn intersections(topology: &Topology, places: &Field) -> Vec<(u32, u32)> {
    let boxes = Boxes::new(&topology.patches, places);
    let mut found = Vec::new();
    nearer(Sought::Piercings, topology, &boxes, 0.0, |_, [edge, element]| {
        if pierces(topology, places, edge, element) {
            found.push((edge, element));
        }
    });
    found.sort_unstable();
    found
}

/// Counts intersections again and again while film moves, looking only at what may have met since.
#[derive(Debug, Clone, PartialEq)]
pub struct Piercings {
    lookout: Lookout,
    /// Where the film was at the last look, m.
    last: Field,
    // Room for pairs.
    ends: Vec<[u32; 2]>,
    sides: Vec<[u32; 2]>,
    /// Intersections at the last look.
    pub count: u64,
}

impl Piercings {
    /// Looks for the first time, at these places (m).
    pub fn new(topology: &Topology, places: &Field) -> Self {
        let lookout = Lookout::new(Sought::Piercings, topology, BIN * places.size());
        let mut own =
            Self { lookout, last: places.clone(), ends: Vec::new(), sides: Vec::new(), count: 0 };
        own.look(topology, places);
        own
    }

    /// Counts the intersections at these places (m).
    pub fn look(&mut self, topology: &Topology, places: &Field) {
        self.lookout.travel(&self.last, places);
        self.last.copy_from(places);
        let (mut count, ends, sides) = (0, &mut self.ends, &mut self.sides);
        let gaps = |_, pairs: &[[u32; 2]], gaps: &mut Vec<f64>| {
            distances(topology, places, pairs, [ends, sides], gaps);
            for ([edge, element], gap) in pairs.iter().zip(gaps) {
                if pierces(topology, places, *edge, *element) {
                    *gap = 0.0;
                }
            }
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

/// Distances (m) of edges and elements that do not pierce each other: the least of those of the edge's
/// ends from the element, and of the edge from the element's sides.
fn distances(
    topology: &Topology,
    places: &Field,
    pairs: &[[u32; 2]],
    [ends, sides]: [&mut Vec<[u32; 2]>; 2],
    gaps: &mut Vec<f64>,
) {
    ends.clear();
    sides.clear();
    for [edge, element] in pairs {
        ends.extend(topology.edges[*edge as usize].map(|end| [end, *element]));
        sides.extend(topology.sides[*element as usize].map(|side| [*edge, side]));
    }
    let (mut from_ends, mut from_sides) = (Vec::new(), Vec::new());
    element_gaps(Path::best(), topology, places, ends, &mut from_ends);
    edge_gaps(Path::best(), topology, places, sides, &mut from_sides);
    let own = from_ends.chunks_exact(2).zip(from_sides.chunks_exact(3));
    gaps.extend(own.map(|(ends, sides)| {
        ends.iter().chain(sides).fold(f64::INFINITY, |least, gap| least.min(*gap))
    }));
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
