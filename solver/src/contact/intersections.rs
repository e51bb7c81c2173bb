//! How often film lies through film: edges that pierce elements, over the whole mesh.

use nalgebra::Vector3;

use super::topology::Topology;
use crate::state::Field;
use crate::tree::{Bounds, Tree};

/// Every edge and element at these places (m) that pierce each other and share no node, in order.
pub fn intersections(topology: &Topology, places: &Field) -> Vec<(u32, u32)> {
    let place = |node: u32| places.get(node as usize);
    let corners = |element: u32| topology.triangles[element as usize].map(place);
    let ends = |edge: u32| topology.edges[edge as usize].map(place);
    let order = &topology.order;
    let edges = Tree::new(&order.edges, |edge| Bounds::of(&ends(edge)));
    let elements = Tree::new(&order.elements, |element| Bounds::of(&corners(element)));
    let mut found = Vec::new();
    edges.pairs_with(&elements, |edge, element| {
        let nodes = topology.triangles[element as usize];
        let apart = !topology.edges[edge as usize].iter().any(|node| nodes.contains(node));
        if apart && pierces(ends(edge), corners(element)) {
            found.push((edge, element));
        }
    });
    found.sort_unstable();
    found
}

/// Whether a segment passes through a triangle.
fn pierces([p, q]: [Vector3<f64>; 2], [a, b, c]: [Vector3<f64>; 3]) -> bool {
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
