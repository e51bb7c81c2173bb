//! Drawing order of triangles (painter's algorithm), without cutting any of them.
//!
//! Where two triangles overlap on the page, the one that is farther there is drawn first. All such pairs are
//! the edges of a graph, and the drawing order is a topological order of it (Newell, Newell and Sancha 1972).
//! The depth of the centroids alone is not sufficient: in two layers of packed film the near corners of the
//! lower layer are nearer than the far corners of the upper one. A cycle has no correct order; then the
//! farthest triangle of those that remain is drawn next.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// A position on the page.
pub type Position = [f64; 2];

/// A triangle on the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle {
    /// Corners.
    pub corners: [Position; 3],
    /// Depth of each corner: a larger depth is nearer to the eye.
    pub depths: [f64; 3],
}

/// Overlap, over the area of the smaller triangle, below which two triangles only touch.
const MIN_OVERLAP: f64 = 1e-6;

impl Triangle {
    /// Twice the signed area on the page, positive for counter-clockwise corners.
    fn signed_double_area(&self) -> f64 {
        let [a, b, c] = self.corners;
        cross(a, b, c)
    }

    /// Depth of the centroid.
    fn centroid_depth(&self) -> f64 {
        self.depths.iter().sum::<f64>() / 3.0
    }

    /// Depth at a position of the page, by barycentric coordinates.
    fn depth(&self, p: Position) -> f64 {
        let [a, b, c] = self.corners;
        let parts = [cross(p, b, c), cross(a, p, c), cross(a, b, p)];
        parts.iter().zip(self.depths).map(|(part, depth)| part * depth).sum::<f64>()
            / self.signed_double_area()
    }

    /// Lower and upper corner of the bounding box.
    fn bounds(&self) -> [Position; 2] {
        let [a, b, c] = self.corners;
        let bound =
            |pick: fn(f64, f64) -> f64| [0, 1].map(|axis| pick(pick(a[axis], b[axis]), c[axis]));
        [bound(f64::min), bound(f64::max)]
    }
}

/// Twice the signed area of a triangle.
fn cross(a: Position, b: Position, c: Position) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Indices of the triangles in drawing order. The order is deterministic.
pub fn order(triangles: &[Triangle]) -> Vec<usize> {
    let mut by_depth: Vec<usize> = (0..triangles.len()).collect();
    by_depth
        .sort_by(|a, b| triangles[*a].centroid_depth().total_cmp(&triangles[*b].centroid_depth()));
    let mut rank = vec![0; triangles.len()];
    for (position, triangle) in by_depth.iter().enumerate() {
        rank[*triangle] = position;
    }
    let Overlaps { above, mut below } = overlaps(triangles);
    let mut drawn = vec![false; triangles.len()];
    let mut order = Vec::with_capacity(triangles.len());
    let mut free: BinaryHeap<Reverse<usize>> = by_depth
        .iter()
        .filter(|triangle| below[**triangle] == 0)
        .map(|triangle| Reverse(rank[*triangle]))
        .collect();
    let mut remaining = by_depth.iter();
    while order.len() < triangles.len() {
        let next = match free.pop() {
            Some(Reverse(rank)) => by_depth[rank],
            // A cycle: take the farthest of the remaining triangles.
            None => match remaining.find(|triangle| !drawn[**triangle]) {
                Some(triangle) => *triangle,
                None => break,
            },
        };
        if drawn[next] {
            continue;
        }
        drawn[next] = true;
        order.push(next);
        for upper in &above[next] {
            below[*upper] -= 1;
            if below[*upper] == 0 && !drawn[*upper] {
                free.push(Reverse(rank[*upper]));
            }
        }
    }
    order
}

/// Which triangles lie above which.
struct Overlaps {
    /// For each triangle, those directly above it.
    above: Vec<Vec<usize>>,
    /// For each triangle, the number of those below it.
    below: Vec<usize>,
}

fn overlaps(triangles: &[Triangle]) -> Overlaps {
    let mut overlaps =
        Overlaps { above: vec![Vec::new(); triangles.len()], below: vec![0; triangles.len()] };
    for_each_near_pair(triangles, |a, b| {
        let Some(common) = common_position(&triangles[a], &triangles[b]) else { return };
        let depths = [triangles[a].depth(common), triangles[b].depth(common)];
        let (lower, upper) = match depths[0].total_cmp(&depths[1]) {
            Ordering::Less => (a, b),
            Ordering::Greater => (b, a),
            Ordering::Equal => return,
        };
        overlaps.above[lower].push(upper);
        overlaps.below[upper] += 1;
    });
    overlaps
}

/// Calls `call` once for each pair of triangles with overlapping bounds, the smaller index first. Triangles
/// without an area on the page are ignored.
fn for_each_near_pair(triangles: &[Triangle], mut call: impl FnMut(usize, usize)) {
    let bounds: Vec<[Position; 2]> = triangles.iter().map(Triangle::bounds).collect();
    let has_area = |index: &usize| triangles[*index].signed_double_area() != 0.0;
    let mut from_left: Vec<usize> = (0..triangles.len()).filter(has_area).collect();
    from_left.sort_by(|a, b| bounds[*a][0][0].total_cmp(&bounds[*b][0][0]));
    for (place, a) in from_left.iter().enumerate() {
        let [[_, bottom], [right, top]] = bounds[*a];
        let reached = |b: &&usize| bounds[**b][0][0] < right;
        for b in from_left[place + 1..].iter().take_while(reached) {
            let [[_, low], [_, high]] = bounds[*b];
            if low < top && bottom < high {
                call(*a.min(b), *a.max(b));
            }
        }
    }
}

/// Centroid of the area that two triangles have in common on the page; `None` when they only touch. The
/// area is found by clipping the first triangle at the edges of the second (Sutherland and Hodgman 1974).
fn common_position(first: &Triangle, second: &Triangle) -> Option<Position> {
    let mut corners = first.corners.to_vec();
    let [mut a, b, mut c] = second.corners;
    if second.signed_double_area() < 0.0 {
        (a, c) = (c, a);
    }
    for [from, to] in [[a, b], [b, c], [c, a]] {
        let side = |position: Position| cross(from, to, position);
        let mut kept = Vec::with_capacity(corners.len() + 1);
        for (index, end) in corners.iter().enumerate() {
            let start = corners[(index + corners.len() - 1) % corners.len()];
            let (s, e) = (side(start), side(*end));
            if (s > 0.0 && e < 0.0) || (s < 0.0 && e > 0.0) {
                let t = s / (s - e);
                kept.push([0, 1].map(|axis| start[axis] + t * (end[axis] - start[axis])));
            }
            if e >= 0.0 {
                kept.push(*end);
            }
        }
        corners = kept;
    }
    let (mut area, mut middle) = (0.0, [0.0; 2]);
    for pair in corners.windows(2).skip(1) {
        let part = cross(corners[0], pair[0], pair[1]);
        area += part;
        for axis in 0..2 {
            middle[axis] += part * (corners[0][axis] + pair[0][axis] + pair[1][axis]) / 3.0;
        }
    }
    let smaller = first.signed_double_area().abs().min(second.signed_double_area().abs());
    (area.abs() > MIN_OVERLAP * smaller).then(|| middle.map(|sum| sum / area))
}

#[cfg(test)]
mod tests;
