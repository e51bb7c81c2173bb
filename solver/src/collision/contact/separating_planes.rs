//! Lower bounds of the distances of edges and elements from separating planes, eight pairs at a time.
//!
//! ```text
//! d ≥ max over n of  min n·(p − a), n·(q − a)       n: ± normal of the element, or outward normal of a side
//! ```
//!
//! Symbols: p, q ends of the edge; n unit normal of a plane; a a node of the element on that plane.
//! The element lies behind each of these planes, so an edge in front of one is at least that far away.
//! If the edge is in front of none of them, there is no bound.

#![allow(clippy::inline_always, reason = "inside the loop over pairs")]

use super::distance_batch::{corner_positions, fill_lanes};
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;
use crate::platform::simd::{Vectors, WIDTH, Wide, dispatch_wide};

/// Squared sine of an element's first angle below which it gets no bound. Chosen: rounding turns the
/// normal of such a sliver.
const MIN_SQUARED_SINE: f64 = 1e-8;

/// The smaller of each pair of numbers.
#[inline(always)]
fn min<L: Wide>(a: L, b: L) -> L {
    -((-a).max(-b))
}

/// Distance by which an edge is in front of the plane through `point` with this normal of any length,
/// m; negative behind it.
#[inline(always)]
fn distance_in_front<L: Wide>(normal: Vectors<L>, [p, q]: [Vectors<L>; 2], point: Vectors<L>) -> L {
    let closer_end = min(normal.dot(p - point), normal.dot(q - point));
    closer_end.over(normal.dot(normal).sqrt())
}

/// Lower bound of the distance, m; not positive or NaN if there is none.
#[inline(always)]
fn separation<L: Wide>(edge: [Vectors<L>; 2], [a, b, c]: [Vectors<L>; 3]) -> L {
    let normal = (b - a).cross(c - a);
    let (start, end) = (normal.dot(edge[0] - a), normal.dot(edge[1] - a));
    let across_face = min(start, end).max(min(-start, -end)).over(normal.dot(normal).sqrt());
    let across_sides = distance_in_front((b - a).cross(normal), edge, a)
        .max(distance_in_front((c - b).cross(normal), edge, b))
        .max(distance_in_front((a - c).cross(normal), edge, c));
    let is_no_sliver =
        normal.dot(normal) - (b - a).dot(b - a) * (c - a).dot(c - a) * MIN_SQUARED_SINE;
    is_no_sliver.if_positive(across_face.max(across_sides), L::splat(-1.0))
}

#[inline(always)]
fn separation_kernel<L: Wide>(
    topology: &Topology,
    positions: &Field,
    pairs: &[[u32; 2]],
    separations: &mut Vec<f64>,
) {
    for chunk in pairs.chunks(WIDTH) {
        let lanes = fill_lanes(chunk);
        let (mut edges, mut elements) = ([[0; 2]; WIDTH], [[0; 3]; WIDTH]);
        for lane in 0..WIDTH {
            edges[lane] = topology.edges[lanes[lane][0] as usize];
            elements[lane] = topology.triangles[lanes[lane][1] as usize];
        }
        let edge = [
            corner_positions::<L, 2>(positions, &edges, 0),
            corner_positions(positions, &edges, 1),
        ];
        let element = [
            corner_positions::<L, 3>(positions, &elements, 0),
            corner_positions(positions, &elements, 1),
            corner_positions(positions, &elements, 2),
        ];
        let values = separation(edge, element).lanes();
        separations.extend_from_slice(&values.0[..chunk.len()]);
    }
}

dispatch_wide! {
    /// Appends lower bounds of the distances (m) of pairs of an edge and an element at these positions
    /// (m) to `separations`. A value that is not positive, or NaN, means that there is no bound.
    pub fn edge_element_separations / separation_kernel(
        topology: &Topology,
        positions: &Field,
        pairs: &[[u32; 2]],
        separations: &mut Vec<f64>,
    )
}

#[cfg(test)]
mod tests {
    use super::super::distance::{point_triangle, segment_segment};
    use super::*;
    use crate::platform::simd::InstructionSet;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    /// The bound for the edge between nodes 3 and 4 and the element of nodes 0, 1, 2.
    fn bound(positions: &[Vector3<f64>]) -> f64 {
        let topology = Topology::new(6, &[[0, 1, 2], [3, 4, 5]]);
        let edge = topology.edges.iter().position(|ends| *ends == [3, 4]).expect("an edge");
        let pair = [u32::try_from(edge).expect("few edges"), 0];
        let bounds = InstructionSet::ALL.map(|instruction_set| {
            let (positions, mut bounds) = (Field::of(positions), Vec::new());
            edge_element_separations(instruction_set, &topology, &positions, &[pair], &mut bounds);
            bounds[0]
        });
        assert_eq!(bounds.map(f64::to_bits), [bounds[0].to_bits(); 3], "{bounds:?}");
        bounds[0]
    }

    proptest! {
        #[test]
        fn distance_is_never_overestimated(
            positions in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 6),
            (u, v, s) in (0.0..1.0_f64, 0.0..1.0_f64, 0.0..1.0_f64),
        ) {
            let mut x: Vec<Vector3<f64>> = positions.into_iter().map(Vector3::from).collect();
            let [a, b, c, p, q] = [x[0], x[1], x[2], x[3], x[4]];
            let ends = [p, q].map(|end| point_triangle(&[end, a, b, c]).squared);
            let sides = [[a, b], [b, c], [c, a]].map(|[d, e]| segment_segment(&[p, q, d, e]).squared);
            let least = ends.into_iter().chain(sides).fold(f64::INFINITY, f64::min).sqrt();
            prop_assert!(bound(&x) <= least * (1.0 + 1e-9));
            // An edge through a point of the element has no bound.
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let middle = a + (b - a) * u + (c - a) * v;
            x[4] = middle + (middle - p) * s;
            prop_assert!(bound(&x) <= 1e-12);
        }
    }

    #[test]
    fn edges_above_below_and_beside_an_element_are_separated() {
        let v = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let separation = |p: Vector3<f64>, q: Vector3<f64>| {
            bound(&[v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0), p, q, v(9.0, 9.0, 9.0)])
        };
        assert!((separation(v(0.2, 0.2, 0.3), v(0.8, 0.8, 0.5)) - 0.3).abs() < 1e-15);
        assert!((separation(v(0.2, 0.2, -0.3), v(0.8, 0.8, -0.5)) - 0.3).abs() < 1e-15);
        assert!((separation(v(0.5, -0.2, -1.0), v(0.5, -0.3, 1.0)) - 0.2).abs() < 1e-15);
    }
}
