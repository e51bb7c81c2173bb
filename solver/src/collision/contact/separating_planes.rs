//! How far edges and elements are apart at least, eight pairs at a time.
//!
//! ```text
//! d ≥ max over n of  min n·(p − a), n·(q − a)       n: ± normal of the element, outward across its sides
//! ```
//!
//! Symbols: p, q ends of the edge; a a node of the element on the plane across n; n of unit length. The
//! element lies behind each of these planes, so what lies before one is that far away at least. Of
//! what lies before none of them nothing is said.

#![allow(clippy::inline_always, reason = "inside the loop over pairs")]

use super::distance_batch::{eight, place};
use super::topology::Topology;
use crate::geometry::field::Field;
use crate::platform::simd::{Vectors, WIDTH, Wide, dispatch_wide};

/// Square of the sine of an element's first angle, below which nothing is said of it.
const SLIVER: f64 = 1e-8;

#[inline(always)]
fn least<L: Wide>(one: L, other: L) -> L {
    -((-one).max(-other))
}

/// How far an edge lies before a plane with this normal, of any length, through a point.
#[inline(always)]
fn before<L: Wide>(normal: Vectors<L>, [p, q]: [Vectors<L>; 2], on: Vectors<L>) -> L {
    let ends = least(normal.dot(p - on), normal.dot(q - on));
    ends.over(normal.dot(normal).sqrt())
}

#[inline(always)]
fn apart<L: Wide>(edge: [Vectors<L>; 2], [a, b, c]: [Vectors<L>; 3]) -> L {
    let normal = (b - a).cross(c - a);
    let (start, end) = (normal.dot(edge[0] - a), normal.dot(edge[1] - a));
    let above = least(start, end).max(least(-start, -end)).over(normal.dot(normal).sqrt());
    let across = before((b - a).cross(normal), edge, a)
        .max(before((c - b).cross(normal), edge, b))
        .max(before((a - c).cross(normal), edge, c));
    // Of a sliver rounding turns the normal: nothing is said of it.
    let flat = normal.dot(normal) - (b - a).dot(b - a) * (c - a).dot(c - a) * SLIVER;
    flat.if_positive(above.max(across), L::splat(-1.0))
}

#[inline(always)]
fn apart_kernel<L: Wide>(
    topology: &Topology,
    places: &Field,
    pairs: &[[u32; 2]],
    gaps: &mut Vec<f64>,
) {
    for chunk in pairs.chunks(WIDTH) {
        let own = eight(chunk);
        let (mut edges, mut elements) = ([[0; 2]; WIDTH], [[0; 3]; WIDTH]);
        for lane in 0..WIDTH {
            edges[lane] = topology.edges[own[lane][0] as usize];
            elements[lane] = topology.triangles[own[lane][1] as usize];
        }
        let edge = [place::<L, 2>(places, &edges, 0), place(places, &edges, 1)];
        let element = [
            place::<L, 3>(places, &elements, 0),
            place(places, &elements, 1),
            place(places, &elements, 2),
        ];
        let found = apart(edge, element).lanes();
        gaps.extend_from_slice(&found.0[..chunk.len()]);
    }
}

dispatch_wide! {
    /// Adds what edges and elements at these places (m) are apart at least (m) to `gaps`; not above 0, or
    /// no number, where nothing is said.
    pub fn edges_apart / apart_kernel(
        topology: &Topology,
        places: &Field,
        pairs: &[[u32; 2]],
        gaps: &mut Vec<f64>,
    )
}

#[cfg(test)]
mod tests {
    use super::super::distance::{point_triangle, segment_segment};
    use super::*;
    use crate::platform::simd::InstructionSet;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    fn told(places: &[Vector3<f64>]) -> f64 {
        let topology = Topology::new(6, &[[0, 1, 2], [3, 4, 5]]);
        let edge = topology.edges.iter().position(|ends| *ends == [3, 4]).expect("is there");
        let pair = [u32::try_from(edge).expect("few edges"), 0];
        let mut gaps = [f64::NAN; 3];
        for (path, gap) in InstructionSet::ALL.into_iter().zip(&mut gaps) {
            let mut own = Vec::new();
            edges_apart(path, &topology, &Field::of(places), &[pair], &mut own);
            *gap = own[0];
        }
        assert_eq!(gaps.map(f64::to_bits), [gaps[0].to_bits(); 3], "{gaps:?}");
        gaps[0]
    }

    proptest! {
        #[test]
        fn what_is_told_is_never_too_far(
            places in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 6),
            (u, v, s) in (0.0..1.0_f64, 0.0..1.0_f64, 0.0..1.0_f64),
        ) {
            let mut x: Vec<Vector3<f64>> = places.into_iter().map(Vector3::from).collect();
            let [a, b, c, p, q] = [x[0], x[1], x[2], x[3], x[4]];
            let ends = [p, q].map(|end| point_triangle(&[end, a, b, c]).squared);
            let sides = [[a, b], [b, c], [c, a]].map(|[d, e]| segment_segment(&[p, q, d, e]).squared);
            let least = ends.into_iter().chain(sides).fold(f64::INFINITY, f64::min).sqrt();
            prop_assert!(told(&x) <= least * (1.0 + 1e-9));
            // Through a point of the element nothing is told.
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let middle = a + (b - a) * u + (c - a) * v;
            x[4] = middle + (middle - p) * s;
            prop_assert!(told(&x) <= 1e-12);
        }
    }

    #[test]
    fn what_lies_above_or_beside_is_told_apart() {
        let v = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let place = |p: Vector3<f64>, q: Vector3<f64>| {
            told(&[v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0), p, q, v(9.0, 9.0, 9.0)])
        };
        assert!((place(v(0.2, 0.2, 0.3), v(0.8, 0.8, 0.5)) - 0.3).abs() < 1e-15);
        assert!((place(v(0.2, 0.2, -0.3), v(0.8, 0.8, -0.5)) - 0.3).abs() < 1e-15);
        assert!((place(v(0.5, -0.2, -1.0), v(0.5, -0.3, 1.0)) - 0.2).abs() < 1e-15);
    }
}
