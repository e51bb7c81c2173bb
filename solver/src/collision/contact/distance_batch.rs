//! Distances of many pairs, eight at a time.
//!
//! These kernels compute the closest points of [`super::distance`] without branches: every region is
//! computed, then the right one is selected. They do the same operations in the same order, so the
//! results are the same bits.

#![allow(clippy::inline_always, reason = "inside the loop over pairs")]

use super::distance::{PARALLEL_TOLERANCE, point_triangle};
use super::pair::{Pair, PairKind};
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;
use crate::platform::simd::{InstructionSet, Vectors, WIDTH, Wide, dispatch_wide, vectors_at};

/// `value`, at least 0 and at most 1.
#[inline(always)]
fn clamp<L: Wide>(value: L) -> L {
    let one = L::splat(1.0);
    let low = (-value).if_positive(L::splat(0.0), value);
    (low - one).if_positive(one, low)
}

/// The ratio of two numbers, at least 0 and at most 1; 0 if the denominator is not positive.
#[inline(always)]
fn clamped_ratio<L: Wide>(numerator: L, denominator: L) -> L {
    denominator.if_positive(clamp(numerator.over(denominator)), L::splat(0.0))
}

/// Squared length of Σ w x, m².
#[inline(always)]
fn squared_sum<L: Wide>(weights: [L; 4], x: [Vectors<L>; 4]) -> L {
    let (a, b) = (x[0].scale(weights[0]), x[1].scale(weights[1]));
    let (c, d) = (x[2].scale(weights[2]), x[3].scale(weights[3]));
    let between = a + b + c + d;
    between.dot(between)
}

/// Squared distances of segments, m²; see [`super::distance::segment_segment`].
#[inline(always)]
fn segment_segment_squared<L: Wide>([a, b, c, d]: [Vectors<L>; 4]) -> L {
    let (one, zero) = (L::splat(1.0), L::splat(0.0));
    let (u, v, r) = (b - a, d - c, a - c);
    let (uu, vv, uv) = (u.dot(u), v.dot(v), u.dot(v));
    let (ur, vr) = (u.dot(r), v.dot(r));
    let determinant = uu * vv - uv * uv;
    let parallel = L::splat(PARALLEL_TOLERANCE) * uu * vv;
    let s_free =
        (determinant - parallel).if_positive(clamped_ratio(uv * vr - ur * vv, determinant), zero);
    let t_free = vv.if_positive((uv * s_free + vr).over(vv), zero);
    let t = clamp(t_free);
    let s_at_end = clamped_ratio(uv * t - ur, uu);
    // s changes only if t was clamped, or if the second segment has no length.
    let s = (-t_free).if_positive(s_at_end, (t_free - one).if_positive(s_at_end, s_free));
    let s = vv.if_positive(s, s_at_end);
    squared_sum([one - s, s, t - one, -t], [a, b, c, d])
}

/// Squared distances of points and triangles, m²; see [`point_triangle`]. NaN for a triangle without
/// area.
#[inline(always)]
fn point_triangle_squared<L: Wide>([p, a, b, c]: [Vectors<L>; 4]) -> L {
    let (one, zero) = (L::splat(1.0), L::splat(0.0));
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    let vc = d1 * d4 - d3 * d2;
    let vb = d5 * d2 - d1 * d6;
    let va = d3 * d6 - d5 * d4;
    let sum = va + vb + vc;
    let (v, w) = (vb.over(sum), vc.over(sum));
    let nan = L::splat(f64::NAN);
    // The branches of `point_triangle` from the last to the first: an earlier branch replaces the
    // weights of a later one. A region is selected where its conditions are not positive.
    let mut weights = [one - v - w, v, w];
    weights = select(sum, weights, [nan; 3]);
    let (from_b, from_c) = (d4 - d3, d5 - d6);
    let w = from_b.over(from_b + from_c);
    weights = select(va.max(-from_b).max(-from_c), weights, [zero, one - w, w]);
    let w = d2.over(d2 - d6);
    weights = select(vb.max(-d2).max(d6), weights, [one - w, zero, w]);
    weights = select((-d6).max(d5 - d6), weights, [zero, zero, one]);
    let v = d1.over(d1 - d3);
    weights = select(vc.max(-d1).max(d3), weights, [one - v, v, zero]);
    weights = select((-d3).max(d4 - d3), weights, [zero, one, zero]);
    weights = select(d1.max(d2), weights, [one, zero, zero]);
    let [u, v, w] = weights;
    squared_sum([one, -u, -v, -w], [p, a, b, c])
}

/// `yes` where `condition` is positive, else `no`.
#[inline(always)]
fn select<L: Wide>(condition: L, yes: [L; 3], no: [L; 3]) -> [L; 3] {
    [
        condition.if_positive(yes[0], no[0]),
        condition.if_positive(yes[1], no[1]),
        condition.if_positive(yes[2], no[2]),
    ]
}

#[inline(always)]
fn distances_kernel<L: Wide>(
    kind: PairKind,
    topology: &Topology,
    positions: &Field,
    pairs: &[[u32; 2]],
    distances: &mut Vec<f64>,
) {
    for chunk in pairs.chunks(WIDTH) {
        // Lanes without a pair repeat the first.
        let mut nodes = [[0; WIDTH]; 4];
        for lane in 0..WIDTH {
            let [first, second] = chunk[if lane < chunk.len() { lane } else { 0 }];
            let of_pair = Pair { kind, first, second }.nodes(topology);
            for corner in 0..4 {
                nodes[corner][lane] = of_pair[corner];
            }
        }
        let columns: [&[f64]; 3] = [&positions.x, &positions.y, &positions.z];
        let x = [
            vectors_at::<L>(columns, &nodes[0]),
            vectors_at(columns, &nodes[1]),
            vectors_at(columns, &nodes[2]),
            vectors_at(columns, &nodes[3]),
        ];
        let squared = match kind {
            PairKind::NodeElement => point_triangle_squared(x),
            PairKind::EdgeEdge => segment_segment_squared(x),
        };
        distances.extend_from_slice(&squared.sqrt().lanes().0[..chunk.len()]);
    }
}

dispatch_wide! {
    fn distances_with_area / distances_kernel(
        kind: PairKind,
        topology: &Topology,
        positions: &Field,
        pairs: &[[u32; 2]],
        distances: &mut Vec<f64>,
    )
}

/// Appends the distances (m) of pairs of one kind at these positions (m) to `distances`.
pub fn distances(
    instruction_set: InstructionSet,
    kind: PairKind,
    topology: &Topology,
    positions: &Field,
    pairs: &[[u32; 2]],
    distances: &mut Vec<f64>,
) {
    let before = distances.len();
    distances_with_area(instruction_set, kind, topology, positions, pairs, distances);
    for (distance, [first, second]) in distances[before..].iter_mut().zip(pairs) {
        if kind == PairKind::NodeElement && distance.is_nan() {
            let pair = Pair { kind, first: *first, second: *second };
            let x = positions.at(pair.nodes(topology));
            *distance = point_triangle(&x).squared.sqrt();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::distance::segment_segment;
    use super::*;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    /// Points, many of them on a coarse grid, so that ends, corners and parallel edges occur often.
    fn points() -> impl Strategy<Value = Vec<Vector3<f64>>> {
        let grid = prop::array::uniform3(-3..3_i32).prop_map(|x| Vector3::from(x.map(f64::from)));
        let free = prop::array::uniform3(-1.0..1.0_f64).prop_map(Vector3::from);
        prop::collection::vec(prop_oneof![grid, free], 12)
    }

    proptest! {
        #[test]
        fn batches_give_the_bits_of_single_pairs(points in points()) {
            let topology = Topology::new(12, &[[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]]);
            let field = Field::of(&points);
            let edges: Vec<[u32; 2]> =
                (0..12).flat_map(|a| (a + 1..12).map(move |b| [a, b])).collect();
            let elements: Vec<[u32; 2]> =
                (0..12).flat_map(|node| (0..4).map(move |element| [node, element])).collect();
            let at = |node: u32| points[node as usize];
            for instruction_set in InstructionSet::ALL {
                let mut found = Vec::new();
                distances(
                    instruction_set, PairKind::EdgeEdge, &topology, &field, &edges, &mut found,
                );
                for ([a, b], distance) in edges.iter().zip(&found) {
                    let [p, q] = topology.edges[*a as usize].map(at);
                    let [r, s] = topology.edges[*b as usize].map(at);
                    let single = segment_segment(&[p, q, r, s]).squared.sqrt();
                    prop_assert_eq!(single.to_bits(), distance.to_bits(), "{} {}", single, distance);
                }
                found.clear();
                distances(
                    instruction_set, PairKind::NodeElement, &topology, &field, &elements, &mut found,
                );
                for ([node, element], distance) in elements.iter().zip(&found) {
                    let [a, b, c] = topology.triangles[*element as usize].map(at);
                    let single = point_triangle(&[at(*node), a, b, c]).squared.sqrt();
                    prop_assert_eq!(single.to_bits(), distance.to_bits(), "{} {}", single, distance);
                }
            }
        }
    }
}
