//! Distances of many pairs at once, eight at a time.
//!
//! The closest points of [`super::distance`], with every region computed and the right one chosen:
//! the same operations in the same order, so the same bits.

#![allow(clippy::inline_always, reason = "inside the loop over pairs")]

use super::distance::point_triangle;
use super::topology::Topology;
use crate::simd::{Lanes, Path, Vectors, WIDTH, dispatch, gather_vectors};
use crate::state::Field;

/// 0 below 0, 1 above 1.
#[inline(always)]
fn clamped(value: Lanes) -> Lanes {
    let one = Lanes::splat(1.0);
    let low = (-value).if_positive(Lanes::default(), value);
    (low - one).if_positive(one, low)
}

/// above/below within 0 and 1; 0 where below is not above 0.
#[inline(always)]
fn share(above: Lanes, below: Lanes) -> Lanes {
    below.if_positive(clamped(above.over(below)), Lanes::default())
}

/// Σ w x squared.
#[inline(always)]
fn squared(weights: [Lanes; 4], x: [Vectors; 4]) -> Lanes {
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| x[k].scale(weights[k]));
    let between = a + b + c + d;
    between.dot(between)
}

/// Squared distances of segments, m²: [`super::distance::segment_segment`].
#[inline(always)]
fn segments([a, b, c, d]: [Vectors; 4]) -> Lanes {
    let (one, none) = (Lanes::splat(1.0), Lanes::default());
    let (u, v, r) = (b - a, d - c, a - c);
    let (uu, vv, uv) = (u.dot(u), v.dot(v), u.dot(v));
    let (ur, vr) = (u.dot(r), v.dot(r));
    let determinant = uu * vv - uv * uv;
    let parallel = Lanes::splat(1e-12) * uu * vv;
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
fn triangles([p, a, b, c]: [Vectors; 4]) -> Lanes {
    let (one, none) = (Lanes::splat(1.0), Lanes::default());
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
    let undone = Lanes::splat(f64::NAN);
    // From the last region to the first: each takes what the ones before it left.
    let mut weights = [one - v - w, v, w].map(|own| sum.if_positive(own, undone));
    let mut take = |outside: Lanes, own: [Lanes; 3]| {
        for (weight, own) in weights.iter_mut().zip(own) {
            *weight = outside.if_positive(*weight, own);
        }
    };
    let (along, back) = (d4 - d3, d5 - d6);
    let w = along.over(along + back);
    take(va.max(-along).max(-back), [none, one - w, w]);
    let w = d2.over(d2 - d6);
    take(vb.max(-d2).max(d6), [one - w, none, w]);
    take((-d6).max(d5 - d6), [none, none, one]);
    let v = d1.over(d1 - d3);
    take(vc.max(-d1).max(d3), [one - v, v, none]);
    take((-d3).max(d4 - d3), [none, one, none]);
    take(d1.max(d2), [one, none, none]);
    squared([one, -weights[0], -weights[1], -weights[2]], [p, a, b, c])
}

/// Eight of the pairs; the last are filled up with the first.
#[inline(always)]
fn eight(pairs: &[[u32; 2]]) -> [[u32; 2]; WIDTH] {
    let mut own = [pairs[0]; WIDTH];
    own[..pairs.len()].copy_from_slice(pairs);
    own
}

#[inline(always)]
fn place(places: &Field, nodes: &[[u32; 4]; WIDTH], corner: usize) -> Vectors {
    let mut at = [0; WIDTH];
    for lane in 0..WIDTH {
        at[lane] = nodes[lane][corner];
    }
    gather_vectors([&places.x, &places.y, &places.z], &at)
}

#[inline(always)]
fn edge_kernel(topology: &Topology, places: &Field, pairs: &[[u32; 2]], gaps: &mut Vec<f64>) {
    for chunk in pairs.chunks(WIDTH) {
        let own = eight(chunk);
        let mut nodes = [[0; 4]; WIDTH];
        for lane in 0..WIDTH {
            let [a, b] = topology.edges[own[lane][0] as usize];
            let [c, d] = topology.edges[own[lane][1] as usize];
            nodes[lane] = [a, b, c, d];
        }
        let x = [0, 1, 2, 3].map(|corner| place(places, &nodes, corner));
        let found = segments(x).sqrt();
        gaps.extend_from_slice(&found.0[..chunk.len()]);
    }
}

#[inline(always)]
fn element_kernel(topology: &Topology, places: &Field, pairs: &[[u32; 2]], gaps: &mut Vec<f64>) {
    for chunk in pairs.chunks(WIDTH) {
        let own = eight(chunk);
        let mut nodes = [[0; 4]; WIDTH];
        for lane in 0..WIDTH {
            let [a, b, c] = topology.triangles[own[lane][1] as usize];
            nodes[lane] = [own[lane][0], a, b, c];
        }
        let x = [0, 1, 2, 3].map(|corner| place(places, &nodes, corner));
        let found = triangles(x).sqrt();
        gaps.extend_from_slice(&found.0[..chunk.len()]);
    }
}

dispatch! {
    /// Adds the distances (m) of edges and edges at these places (m) to `gaps`.
    pub fn edge_gaps / edge_kernel(
        topology: &Topology,
        places: &Field,
        pairs: &[[u32; 2]],
        gaps: &mut Vec<f64>,
    )
}

dispatch! {
    fn element_gaps_of_sound / element_kernel(
        topology: &Topology,
        places: &Field,
        pairs: &[[u32; 2]],
        gaps: &mut Vec<f64>,
    )
}

/// Adds the distances (m) of nodes and elements at these places (m) to `gaps`.
pub fn element_gaps(
    path: Path,
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
            for path in Path::ALL {
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
