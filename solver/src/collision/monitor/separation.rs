//! Planes that separate two primitives on straight motions, eight pairs at a time.
//!
//! ```text
//! min n·(p − q) > |n| d at every frame        p nodes of one primitive, q of the other
//! ```
//!
//! Symbols: n normal of a plane; d a distance, m. On a straight motion n·(p − q) is linear in time for a
//! fixed n, so what holds at both ends holds in between. Tried as n, from the positions of the first
//! frame: the normals of the elements, or the common normal of two edges, in both directions; the vector
//! between the centroids; of an edge, also the part of that vector normal to it.
//!
//! A pair that no plane separates may still be apart. NaN counts as not separated. The gap of a pair is the
//! largest d of these planes at which one of them separates it: a lower bound of its distance.

#![allow(clippy::inline_always, reason = "inside the loop over pairs")]
#![allow(clippy::needless_range_loop, reason = "an iterator is not inlined into a target feature")]

use crate::geometry::field::Field;
use crate::geometry::topology::Topology;
use crate::platform::simd::{Lanes, Vectors, WIDTH, Wide, dispatch_wide, vectors_at};

/// One or two frames, and the distance d at which a pair counts as separated, m.
#[derive(Debug, Clone, Copy)]
pub struct Motion<'a> {
    /// The first frame.
    pub from: &'a Field,
    /// The last frame; it may be the first.
    pub to: &'a Field,
    /// d, m.
    pub distance: f64,
}

/// The primitives of a pair, and when they may meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairTest {
    /// A node and an element, on the motion.
    NodeElement,
    /// Two edges, on the motion.
    Edges,
    /// Two elements, on the motion.
    Elements,
    /// An edge and an element, at the first frame.
    EdgeElementNow,
    /// Two elements, at the first frame.
    ElementsNow,
}

/// Positions of the nodes of one primitive in both frames; unused entries repeat a node.
type Corners<L> = [[Vectors<L>; 3]; 2];

#[inline(always)]
fn min<L: Wide>(a: L, b: L) -> L {
    -((-a).max(-b))
}

/// The smallest and the largest n·p over the first `COUNT` points.
#[inline(always)]
fn extent<L: Wide, const COUNT: usize>(normal: Vectors<L>, points: &[Vectors<L>; 3]) -> [L; 2] {
    let first = normal.dot(points[0]);
    let mut extent = [first; 2];
    for k in 1..COUNT {
        let along = normal.dot(points[k]);
        extent = [min(extent[0], along), extent[1].max(along)];
    }
    extent
}

/// The smallest n·(p − q) over both frames, less |n| d; over |n| if `UNIT`. The larger of those of n and −n if `BOTH`.
#[inline(always)]
fn margin<
    L: Wide,
    const FIRST: usize,
    const SECOND: usize,
    const FRAMES: usize,
    const UNIT: bool,
    const BOTH: bool,
>(
    normal: Vectors<L>,
    first: &Corners<L>,
    second: &Corners<L>,
    distance: L,
) -> L {
    // Of n, then of −n.
    let mut least = [L::splat(0.0); 2];
    for frame in 0..FRAMES {
        let [low, high] = extent::<L, FIRST>(normal, &first[frame]);
        let [other_low, other_high] = extent::<L, SECOND>(normal, &second[frame]);
        let gaps = [low - other_high, other_low - high];
        least = if frame == 0 { gaps } else { [min(least[0], gaps[0]), min(least[1], gaps[1])] };
    }
    let least = if BOTH { least[0].max(least[1]) } else { least[0] };
    let length = normal.dot(normal).sqrt();
    if UNIT {
        // A normal of length 0 separates nothing.
        least.over(length + L::splat(f64::MIN_POSITIVE)) - distance
    } else {
        least - distance * length
    }
}

/// Sum of the first `COUNT` points.
#[inline(always)]
fn sum<L: Wide, const COUNT: usize>(points: &[Vectors<L>; 3]) -> Vectors<L> {
    let mut sum = points[0];
    for k in 1..COUNT {
        sum = sum + points[k];
    }
    sum
}

/// The largest margin of all normals tried: positive if a plane separates the pair.
#[inline(always)]
fn largest_margin<
    L: Wide,
    const FIRST: usize,
    const SECOND: usize,
    const FRAMES: usize,
    const UNIT: bool,
>(
    first: &Corners<L>,
    second: &Corners<L>,
    distance: L,
) -> L {
    let ([a, b, c], [d, e, f]) = (first[0], second[0]);
    // Centroids times the product of the numbers of nodes.
    let between = sum::<L, FIRST>(&first[0]).scale(L::splat(SECOND as f64))
        - sum::<L, SECOND>(&second[0]).scale(L::splat(FIRST as f64));
    let mut largest =
        margin::<L, FIRST, SECOND, FRAMES, UNIT, false>(between, first, second, distance);
    if SECOND == 3 {
        let normal = (e - d).cross(f - d);
        largest = largest
            .max(margin::<L, FIRST, SECOND, FRAMES, UNIT, true>(normal, first, second, distance));
    }
    if FIRST == 3 {
        let normal = (b - a).cross(c - a);
        largest = largest
            .max(margin::<L, FIRST, SECOND, FRAMES, UNIT, true>(normal, first, second, distance));
    }
    if FIRST == 2 {
        let edge = b - a;
        let along = edge.dot(between).over(edge.dot(edge));
        let across = between - edge.scale(along);
        largest = largest
            .max(margin::<L, FIRST, SECOND, FRAMES, UNIT, false>(across, first, second, distance));
        if SECOND == 2 {
            let normal = edge.cross(e - d);
            largest = largest.max(margin::<L, FIRST, SECOND, FRAMES, UNIT, true>(
                normal, first, second, distance,
            ));
        }
    }
    largest
}

/// Positions of the nodes of eight primitives.
#[inline(always)]
fn corners_at<L: Wide, const COUNT: usize, const FRAMES: usize>(
    motion: &Motion<'_>,
    nodes: &[[u32; WIDTH]; 3],
) -> Corners<L> {
    let from: [&[f64]; 3] = [&motion.from.x, &motion.from.y, &motion.from.z];
    let first = vectors_at::<L>(from, &nodes[0]);
    let mut corners = [[first; 3]; 2];
    for k in 1..COUNT {
        corners[0][k] = vectors_at(from, &nodes[k]);
    }
    if FRAMES == 2 {
        let to: [&[f64]; 3] = [&motion.to.x, &motion.to.y, &motion.to.z];
        for k in 0..COUNT {
            corners[1][k] = vectors_at(to, &nodes[k]);
        }
    }
    corners
}

/// Nodes of the primitive with this number that has `COUNT` nodes.
#[inline(always)]
fn nodes_of<const COUNT: usize>(topology: &Topology, index: u32) -> [u32; 3] {
    if COUNT == 1 {
        [index; 3]
    } else if COUNT == 2 {
        let [a, b] = topology.edges[index as usize];
        [a, b, b]
    } else {
        topology.triangles[index as usize]
    }
}

/// The largest margins of up to eight pairs from `start` on, and the number of these pairs.
#[inline(always)]
fn margins_of<
    L: Wide,
    const FIRST: usize,
    const SECOND: usize,
    const FRAMES: usize,
    const UNIT: bool,
>(
    topology: &Topology,
    pairs: &[[u32; 2]],
    start: usize,
    motion: &Motion<'_>,
) -> (Lanes, usize) {
    let count = if pairs.len() - start < WIDTH { pairs.len() - start } else { WIDTH };
    let (mut first, mut second) = ([[0; WIDTH]; 3], [[0; WIDTH]; 3]);
    for lane in 0..WIDTH {
        let [a, b] = pairs[start + if lane < count { lane } else { 0 }];
        let (a, b) = (nodes_of::<FIRST>(topology, a), nodes_of::<SECOND>(topology, b));
        for k in 0..3 {
            first[k][lane] = a[k];
            second[k][lane] = b[k];
        }
    }
    let first = corners_at::<L, FIRST, FRAMES>(motion, &first);
    let second = corners_at::<L, SECOND, FRAMES>(motion, &second);
    let distance = L::splat(motion.distance);
    let margins = largest_margin::<L, FIRST, SECOND, FRAMES, UNIT>(&first, &second, distance);
    (margins.lanes(), count)
}

/// Adds the pairs that no plane separates to `close`.
#[inline(always)]
fn filter<L: Wide, const FIRST: usize, const SECOND: usize, const FRAMES: usize>(
    topology: &Topology,
    pairs: &[[u32; 2]],
    motion: &Motion<'_>,
    close: &mut Vec<[u32; 2]>,
) {
    let mut start = 0;
    while start < pairs.len() {
        let (margins, count) =
            margins_of::<L, FIRST, SECOND, FRAMES, false>(topology, pairs, start, motion);
        for lane in 0..count {
            // Written so that NaN counts as not separated.
            let separated = margins.0[lane] > 0.0;
            if !separated {
                close.push(pairs[start + lane]);
            }
        }
        start += WIDTH;
    }
}

/// Adds to `gaps` by how much the gap of each pair exceeds d, m.
#[inline(always)]
fn measure<L: Wide, const FIRST: usize, const SECOND: usize, const FRAMES: usize>(
    topology: &Topology,
    pairs: &[[u32; 2]],
    motion: &Motion<'_>,
    gaps: &mut Vec<f64>,
) {
    let mut start = 0;
    while start < pairs.len() {
        let (margins, count) =
            margins_of::<L, FIRST, SECOND, FRAMES, true>(topology, pairs, start, motion);
        for lane in 0..count {
            gaps.push(margins.0[lane]);
        }
        start += WIDTH;
    }
}

#[inline(always)]
fn filter_kernel<L: Wide>(
    kind: PairTest,
    topology: &Topology,
    pairs: &[[u32; 2]],
    motion: &Motion<'_>,
    close: &mut Vec<[u32; 2]>,
) {
    match kind {
        PairTest::NodeElement => filter::<L, 1, 3, 2>(topology, pairs, motion, close),
        PairTest::Edges => filter::<L, 2, 2, 2>(topology, pairs, motion, close),
        PairTest::Elements => filter::<L, 3, 3, 2>(topology, pairs, motion, close),
        PairTest::EdgeElementNow => filter::<L, 2, 3, 1>(topology, pairs, motion, close),
        PairTest::ElementsNow => filter::<L, 3, 3, 1>(topology, pairs, motion, close),
    }
}

#[inline(always)]
fn measure_kernel<L: Wide>(
    kind: PairTest,
    topology: &Topology,
    pairs: &[[u32; 2]],
    motion: &Motion<'_>,
    gaps: &mut Vec<f64>,
) {
    match kind {
        PairTest::NodeElement => measure::<L, 1, 3, 2>(topology, pairs, motion, gaps),
        PairTest::Edges => measure::<L, 2, 2, 2>(topology, pairs, motion, gaps),
        PairTest::Elements => measure::<L, 3, 3, 2>(topology, pairs, motion, gaps),
        PairTest::EdgeElementNow => measure::<L, 2, 3, 1>(topology, pairs, motion, gaps),
        PairTest::ElementsNow => measure::<L, 3, 3, 1>(topology, pairs, motion, gaps),
    }
}

dispatch_wide! {
    /// Adds the pairs that no plane separates to `close`.
    pub fn filter_pairs / filter_kernel(
        kind: PairTest,
        topology: &Topology,
        pairs: &[[u32; 2]],
        motion: &Motion<'_>,
        close: &mut Vec<[u32; 2]>,
    )
}
dispatch_wide! {
    /// Adds to `gaps` by how much the gap of each pair exceeds the distance of the motion, m.
    pub fn measure_pairs / measure_kernel(
        kind: PairTest,
        topology: &Topology,
        pairs: &[[u32; 2]],
        motion: &Motion<'_>,
        gaps: &mut Vec<f64>,
    )
}
