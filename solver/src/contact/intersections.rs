//! How often film lies through film: edges that pierce elements, over the whole mesh.

use nalgebra::Vector3;

use super::distance::{point_triangle, segment_segment};
use super::topology::Topology;
use crate::proximity::boxes::Boxes;
use crate::proximity::lookout::{Lookout, Sought, nearer};
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
    /// Distance from the plane of an element with which an edge beside it may wait, m.
    clear: f64,
    /// Intersections at the last look.
    pub count: u64,
}

impl Piercings {
    /// Looks for the first time, at these places (m).
    pub fn new(topology: &Topology, places: &Field) -> Self {
        let lookout = Lookout::new(Sought::Piercings, topology, BIN * places.size());
        let mut own = Self { lookout, last: places.clone(), clear: BIN * places.size(), count: 0 };
        own.look(topology, places);
        own
    }

    /// Counts the intersections at these places (m).
    pub fn look(&mut self, topology: &Topology, places: &Field) {
        self.lookout.travel(&self.last, places);
        self.last.copy_from(places);
        let (mut count, clear) = (0, self.clear);
        let gaps = |_, pairs: &[[u32; 2]], gaps: &mut Vec<f64>| {
            let gap = |[edge, element]: &[u32; 2]| {
                let beside = beside(topology, places, *edge, *element);
                if beside > clear {
                    beside
                } else if pierces(topology, places, *edge, *element) {
                    0.0
                } else {
                    distance(topology, places, *edge, *element)
                }
            };
            gaps.extend(pairs.iter().map(gap));
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

/// Distance of an edge and an element that do not pierce each other, m.
fn distance(topology: &Topology, places: &Field, edge: u32, element: u32) -> f64 {
    let place = |node: u32| places.get(node as usize);
    let [p, q] = topology.edges[edge as usize].map(place);
    let [a, b, c] = topology.triangles[element as usize].map(place);
    let ends = [p, q].map(|end| point_triangle(&[end, a, b, c]).squared);
    let sides = [[a, b], [b, c], [c, a]].map(|[u, v]| segment_segment(&[p, q, u, v]).squared);
    let least = ends.into_iter().chain(sides).fold(f64::INFINITY, f64::min);
    least.sqrt()
}

/// Least distance of the ends of an edge from the plane of an element, m, where both are on one side
/// of it: the two are not nearer than that. 0 where they are not, or the element has no area.
fn beside(topology: &Topology, places: &Field, edge: u32, element: u32) -> f64 {
    let place = |node: u32| places.get(node as usize);
    let [p, q] = topology.edges[edge as usize].map(place);
    let [a, b, c] = topology.triangles[element as usize].map(place);
    let normal = (b - a).cross(&(c - a));
    let (start, end) = (normal.dot(&(p - a)), normal.dot(&(q - a)));
    let size = normal.norm();
    if start * end > 0.0 && size > 0.0 { start.abs().min(end.abs()) / size } else { 0.0 }
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
