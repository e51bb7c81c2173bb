//! Intersections: edges that pass through elements, over the whole mesh.
//!
//! ```text
//! n·(p − a) and n·(q − a) have different signs, and the edge crosses the plane inside the element
//! ```
//!
//! Symbols: p, q ends of the edge; n normal and a a node of the element.

use nalgebra::Vector3;

use super::distance_batch::{edge_edge_distances, node_element_distances};
use super::separating_planes::edge_element_separations;
use crate::collision::broad_phase::collision_mesh::CollisionMesh;
use crate::collision::broad_phase::kdop::KDops;
use crate::collision::broad_phase::query::QueryKind;
use crate::collision::broad_phase::scheduler::CandidateScheduler;
use crate::collision::broad_phase::traversal::pairs_within_bounds;
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;
use crate::platform::simd::InstructionSet;

/// Every edge and element that intersect at these positions (m) and share no node, in order.
pub fn intersections(mesh: &CollisionMesh, positions: &Field) -> Vec<(u32, u32)> {
    let kdops = KDops::new(&mesh.hierarchy, positions);
    let mut found = Vec::new();
    pairs_within_bounds(QueryKind::Intersection, mesh, &kdops, 0.0, |_, [edge, element]| {
        if intersects(&mesh.topology, positions, edge, element) {
            found.push((edge, element));
        }
    });
    found.sort_unstable();
    found
}

/// Counts the intersections of moving film. A pair is tested again only after it may have met.
#[derive(Debug, Clone, PartialEq)]
pub struct IntersectionCounter {
    scheduler: CandidateScheduler,
    instruction_set: InstructionSet,
    /// Positions at the last update, m.
    positions: Field,
    scratch: Scratch,
    /// Number of intersections at the last update.
    pub count: u64,
}

impl IntersectionCounter {
    /// Counts the intersections at these positions (m).
    pub fn new(mesh: &CollisionMesh, positions: &Field, instruction_set: InstructionSet) -> Self {
        let bin_width = mesh.bin_width(positions);
        let kind = QueryKind::Intersection;
        let mut counter = Self {
            scheduler: CandidateScheduler::new(kind, mesh, bin_width, instruction_set),
            instruction_set,
            positions: positions.clone(),
            scratch: Scratch::default(),
            count: 0,
        };
        counter.update(mesh, positions);
        counter
    }

    /// Counts the intersections at these positions (m).
    pub fn update(&mut self, mesh: &CollisionMesh, positions: &Field) {
        self.scheduler.advance(mesh, &self.positions, positions);
        self.positions.copy_from(positions);
        let (instruction_set, topology) = (self.instruction_set, &mesh.topology);
        let (mut count, scratch) = (0, &mut self.scratch);
        let distances = |_, pairs: &[[u32; 2]], distances: &mut Vec<f64>| {
            edge_element_separations(instruction_set, topology, positions, pairs, distances);
            scratch.measure_unseparated(instruction_set, topology, positions, pairs, distances);
        };
        self.scheduler.query_now(mesh, positions, distances, |_, [edge, element]| {
            // Film that touches without passing through has the distance zero too.
            count += u64::from(intersects(topology, positions, edge, element));
        });
        self.count = count;
    }
}

/// Scratch memory for pairs without a separating plane.
#[derive(Debug, Clone, PartialEq, Default)]
struct Scratch {
    /// Index of each such pair.
    indices: Vec<usize>,
    /// Ends of the edge, with the element.
    ends: Vec<[u32; 2]>,
    /// The edge, with the edges of the element.
    sides: Vec<[u32; 2]>,
    /// Distances of [`Self::ends`], m.
    end_distances: Vec<f64>,
    /// Distances of [`Self::sides`], m.
    side_distances: Vec<f64>,
}

impl Scratch {
    /// Replaces each separation (m) that is not positive, or NaN, by the distance of the pair (m). The
    /// distance is 0 if the pair intersects; else it is the smallest distance of an end of the edge
    /// from the element, and of the edge from an edge of the element.
    fn measure_unseparated(
        &mut self,
        instruction_set: InstructionSet,
        topology: &Topology,
        positions: &Field,
        pairs: &[[u32; 2]],
        distances: &mut [f64],
    ) {
        let Self { indices, ends, sides, end_distances, side_distances } = self;
        indices.clear();
        ends.clear();
        sides.clear();
        end_distances.clear();
        side_distances.clear();
        for (index, ([edge, element], distance)) in pairs.iter().zip(&mut *distances).enumerate() {
            if *distance > 0.0 {
                continue;
            }
            *distance = 0.0;
            if !intersects(topology, positions, *edge, *element) {
                indices.push(index);
                ends.extend(topology.edges[*edge as usize].map(|end| [end, *element]));
                let element_edges = topology.element_edges[*element as usize];
                sides.extend(element_edges.map(|side| [*edge, side]));
            }
        }
        node_element_distances(instruction_set, topology, positions, ends, end_distances);
        edge_edge_distances(instruction_set, topology, positions, sides, side_distances);
        let measured = end_distances.chunks_exact(2).zip(side_distances.chunks_exact(3));
        for (index, (ends, sides)) in indices.iter().zip(measured) {
            let smallest = ends.iter().chain(sides).fold(f64::INFINITY, |min, d| min.min(*d));
            distances[*index] = smallest;
        }
    }
}

/// Whether an edge passes through an element.
fn intersects(topology: &Topology, positions: &Field, edge: u32, element: u32) -> bool {
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
mod tests {
    use super::*;

    #[test]
    fn crossing_triangles_intersect_and_stacked_triangles_do_not() {
        let v = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let mesh = CollisionMesh::new(6, &[[0, 1, 2], [3, 4, 5]]);
        let stacked = [
            v(0.0, 0.0, 0.0),
            v(1.0, 0.0, 0.0),
            v(0.0, 1.0, 0.0),
            v(0.0, 0.0, 0.01),
            v(1.0, 0.0, 0.01),
            v(0.0, 1.0, 0.01),
        ];
        assert!(intersections(&mesh, &Field::of(&stacked)).is_empty());
        let mut crossing = stacked;
        crossing[5] = v(0.2, 0.2, -0.5);
        assert!(!intersections(&mesh, &Field::of(&crossing)).is_empty());
    }
}
