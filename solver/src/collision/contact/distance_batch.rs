//! Distances of many pairs at once, eight at a time.
//!
//! The closest points of [`super::distance`], with every region computed and the right one chosen:
//! the same operations in the same order, so the same bits.

#![allow(clippy::inline_always, reason = "inside the loop over pairs")]

use super::distance::point_triangle;
use super::topology::Topology;
use crate::geometry::field::Field;
use crate::platform::simd::{InstructionSet, Vectors, WIDTH, Wide, dispatch_wide, vectors_at};

/// 0 below 0, 1 above 1.
#[inline(always)]
fn clamped<L: Wide>(value: L) -> L {
    let one = L::splat(1.0);
    let low = (-value).if_positive(L::splat(0.0), value);
    (low - one).if_positive(one, low)
}

/// above/below within 0 and 1; 0 where below is not above 0.
#[inline(always)]
fn share<L: Wide>(above: L, below: L) -> L {
    below.if_positive(clamped(above.over(below)), L::splat(0.0))
}

/// Σ w x squared.
#[inline(always)]
fn squared<L: Wide>(weights: [L; 4], x: [Vectors<L>; 4]) -> L {
    let (a, b) = (x[0].scale(weights[0]), x[1].scale(weights[1]));
    let (c, d) = (x[2].scale(weights[2]), x[3].scale(weights[3]));
    let between = a + b + c + d;
    between.dot(between)
}

/// Squared distances of segments, m²: [`super::distance::segment_segment`].
#[inline(always)]
fn segments<L: Wide>([a, b, c, d]: [Vectors<L>; 4]) -> L {
    let (one, none) = (L::splat(1.0), L::splat(0.0));
    let (u, v, r) = (b - a, d - c, a - c);
    let (uu, vv, uv) = (u.dot(u), v.dot(v), u.dot(v));
    let (ur, vr) = (u.dot(r), v.dot(r));
    let determinant = uu * vv - uv * uv;
    let parallel = L::splat(1e-12) * uu * vv;
    let first = (determinant - parallel).if_positive(share(uv * vr - ur * vv, determinant), none);
    let free = vv.if_positive((uv * first + vr).over(vv), none);
    let t = clamped(free);
    let ends = share(uv * t - ur, uu);
    // Past either end, or no segment at all.
    let inside = (-free).if_positive(ends, (free - one).if_positive(ends, first));
    let s = vv.if_positive(inside, ends);
    squared([one - s, s, t - one, -t], [a, b, c, d])
}

/// Squared distances of points and triangles, m²: [`point_triangle`]; no number where a triangle has no
/// area.
#[inline(always)]
fn triangles<L: Wide>([p, a, b, c]: [Vectors<L>; 4]) -> L {
    let (one, none) = (L::splat(1.0), L::splat(0.0));
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
    let undone = L::splat(f64::NAN);
    // From the last region to the first: each takes what the ones before it left.
    let mut own = [one - v - w, v, w];
    own = choose(sum, own, [undone; 3]);
    let (along, back) = (d4 - d3, d5 - d6);
    let w = along.over(along + back);
    own = choose(va.max(-along).max(-back), own, [none, one - w, w]);
    let w = d2.over(d2 - d6);
    own = choose(vb.max(-d2).max(d6), own, [one - w, none, w]);
    own = choose((-d6).max(d5 - d6), own, [none, none, one]);
    let v = d1.over(d1 - d3);
    own = choose(vc.max(-d1).max(d3), own, [one - v, v, none]);
    own = choose((-d3).max(d4 - d3), own, [none, one, none]);
    own = choose(d1.max(d2), own, [one, none, none]);
    squared([one, -own[0], -own[1], -own[2]], [p, a, b, c])
}

/// `yes` where `positive` is above 0, else `no`.
#[inline(always)]
fn choose<L: Wide>(positive: L, yes: [L; 3], no: [L; 3]) -> [L; 3] {
    [
        positive.if_positive(yes[0], no[0]),
        positive.if_positive(yes[1], no[1]),
        positive.if_positive(yes[2], no[2]),
    ]
}

/// Eight of the pairs; the last are filled up with the first.
#[inline(always)]
pub(super) fn eight(pairs: &[[u32; 2]]) -> [[u32; 2]; WIDTH] {
    let mut own = [pairs[0]; WIDTH];
    own[..pairs.len()].copy_from_slice(pairs);
    own
}

/// Places of one corner of eight primitives.
#[inline(always)]
pub(super) fn place<L: Wide, const N: usize>(
    places: &Field,
    nodes: &[[u32; N]; WIDTH],
    corner: usize,
) -> Vectors<L> {
    let mut at = [0; WIDTH];
    for lane in 0..WIDTH {
        at[lane] = nodes[lane][corner];
    }
    vectors_at([&places.x, &places.y, &places.z], &at)
}

#[inline(always)]
fn four<L: Wide>(places: &Field, nodes: &[[u32; 4]; WIDTH]) -> [Vectors<L>; 4] {
    [
        place(places, nodes, 0),
        place(places, nodes, 1),
        place(places, nodes, 2),
        place(places, nodes, 3),
    ]
}

#[inline(always)]
fn edge_kernel<L: Wide>(
    topology: &Topology,
    places: &Field,
    pairs: &[[u32; 2]],
    gaps: &mut Vec<f64>,
) {
    for chunk in pairs.chunks(WIDTH) {
        let own = eight(chunk);
        let mut nodes = [[0; 4]; WIDTH];
        for lane in 0..WIDTH {
            let [a, b] = topology.edges[own[lane][0] as usize];
            let [c, d] = topology.edges[own[lane][1] as usize];
            nodes[lane] = [a, b, c, d];
        }
        let found = segments::<L>(four(places, &nodes)).sqrt().lanes();
        gaps.extend_from_slice(&found.0[..chunk.len()]);
    }
}

#[inline(always)]
fn element_kernel<L: Wide>(
    topology: &Topology,
    places: &Field,
    pairs: &[[u32; 2]],
    gaps: &mut Vec<f64>,
) {
    for chunk in pairs.chunks(WIDTH) {
        let own = eight(chunk);
        let mut nodes = [[0; 4]; WIDTH];
        for lane in 0..WIDTH {
            let [a, b, c] = topology.triangles[own[lane][1] as usize];
            nodes[lane] = [own[lane][0], a, b, c];
        }
        let found = triangles::<L>(four(places, &nodes)).sqrt().lanes();
        gaps.extend_from_slice(&found.0[..chunk.len()]);
    }
}

dispatch_wide! {
    /// Adds the distances (m) of edges and edges at these places (m) to `gaps`.
    pub fn edge_gaps / edge_kernel(
        topology: &Topology,
        places: &Field,
        pairs: &[[u32; 2]],
        gaps: &mut Vec<f64>,
    )
}

dispatch_wide! {
    fn element_gaps_of_sound / element_kernel(
        topology: &Topology,
        places: &Field,
        pairs: &[[u32; 2]],
        gaps: &mut Vec<f64>,
    )
}

/// Adds the distances (m) of nodes and elements at these places (m) to `gaps`.
pub fn element_gaps(
    path: InstructionSet,
    topology: &Topology,
    places: &Field,
    pairs: &[[u32; 2]],
    gaps: &mut Vec<f64>,
) {
    let before = gaps.len();
    element_gaps_of_sound(path, topology, places, pairs, gaps);
    for (gap, [node, element]) in gaps[before..].iter_mut().zip(pairs) {
        if gap.is_nan() {
            let [a, b, c] = topology.triangles[*element as usize];
            let x = [*node, a, b, c].map(|node| places.get(node as usize));
            *gap = point_triangle(&x).squared.sqrt();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::distance::segment_segment;
    use super::*;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    /// Places on a coarse grid, so that ends, corners and parallel edges are met often.
    fn places() -> impl Strategy<Value = Vec<Vector3<f64>>> {
        let grid = prop::array::uniform3(-3..3_i32).prop_map(|x| Vector3::from(x.map(f64::from)));
        let free = prop::array::uniform3(-1.0..1.0_f64).prop_map(Vector3::from);
        prop::collection::vec(prop_oneof![grid, free], 12)
    }

    proptest! {
        #[test]
        fn every_path_gives_the_bits_of_one_pair_alone(places in places()) {
            let topology = Topology::new(12, &[[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]]);
            let field = Field::of(&places);
            let edges: Vec<[u32; 2]> =
                (0..12).flat_map(|a| (a + 1..12).map(move |b| [a, b])).collect();
            let elements: Vec<[u32; 2]> =
                (0..12).flat_map(|node| (0..4).map(move |element| [node, element])).collect();
            let at = |node: u32| places[node as usize];
            for path in InstructionSet::ALL {
                let mut gaps = Vec::new();
                edge_gaps(path, &topology, &field, &edges, &mut gaps);
                for ([a, b], gap) in edges.iter().zip(&gaps) {
                    let [p, q] = topology.edges[*a as usize].map(at);
                    let [r, s] = topology.edges[*b as usize].map(at);
                    let alone = segment_segment(&[p, q, r, s]).squared.sqrt();
                    prop_assert_eq!(alone.to_bits(), gap.to_bits(), "{} {}", alone, gap);
                }
                gaps.clear();
                element_gaps(path, &topology, &field, &elements, &mut gaps);
                for ([node, element], gap) in elements.iter().zip(&gaps) {
                    let [a, b, c] = topology.triangles[*element as usize].map(at);
                    let alone = point_triangle(&[at(*node), a, b, c]).squared.sqrt();
                    prop_assert_eq!(alone.to_bits(), gap.to_bits(), "{} {}", alone, gap);
                }
            }
        }
    }
}
