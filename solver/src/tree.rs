//! A tree of boxes: which of many primitives come near each other.
//!
//! ```text
//!             1                 node k holds the boxes of 2k and 2k + 1
//!        2         3
//!      4   5     6   7          the last row: leaves of four primitives each, in a given order
//! ```
//!
//! The order puts next to each other what is next to each other on the film, and stays that way
//! however the film folds: so the tree is filled in one pass, without sorting. Both sides of a pair
//! are sought in one walk down.

use nalgebra::Vector3;

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lowest corner, m.
    pub low: Vector3<f64>,
    /// Highest corner, m.
    pub high: Vector3<f64>,
}

impl Bounds {
    /// The box of nothing, which meets none.
    const NONE: Self = Self {
        low: Vector3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        high: Vector3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    /// Smallest box round these points.
    #[inline]
    pub fn of(points: &[Vector3<f64>]) -> Self {
        let mut bounds = Self { low: points[0], high: points[0] };
        for point in &points[1..] {
            bounds.low = lower(bounds.low, *point);
            bounds.high = higher(bounds.high, *point);
        }
        bounds
    }

    /// Grown by `way` (m) on every side.
    #[must_use]
    pub fn grown(self, way: f64) -> Self {
        Self { low: self.low.add_scalar(-way), high: self.high.add_scalar(way) }
    }

    /// Smallest box round both.
    #[must_use]
    #[inline]
    pub fn with(self, other: Self) -> Self {
        Self { low: lower(self.low, other.low), high: higher(self.high, other.high) }
    }

    /// Whether two boxes meet.
    #[inline]
    #[expect(
        clippy::needless_bitwise_bool,
        reason = "six comparisons are cheaper than six branches"
    )]
    pub fn meets(&self, other: &Self) -> bool {
        let (a, b) = (self, other);
        // All six at once: no branch but the last.
        (a.low.x <= b.high.x)
            & (b.low.x <= a.high.x)
            & (a.low.y <= b.high.y)
            & (b.low.y <= a.high.y)
            & (a.low.z <= b.high.z)
            & (b.low.z <= a.high.z)
    }
}

#[inline]
fn lower(a: Vector3<f64>, b: Vector3<f64>) -> Vector3<f64> {
    let least = |a: f64, b: f64| if b < a { b } else { a };
    Vector3::new(least(a.x, b.x), least(a.y, b.y), least(a.z, b.z))
}

#[inline]
fn higher(a: Vector3<f64>, b: Vector3<f64>) -> Vector3<f64> {
    let most = |a: f64, b: f64| if b > a { b } else { a };
    Vector3::new(most(a.x, b.x), most(a.y, b.y), most(a.z, b.z))
}

/// Primitives at a leaf.
const LEAF: usize = 4;

/// A tree over the boxes of primitives.
#[derive(Debug, Clone)]
pub struct Tree<'a> {
    /// Primitives, four at a leaf.
    order: &'a [u32],
    /// Their boxes, in that order.
    own: Vec<Bounds>,
    /// Boxes of the nodes; the first is none.
    nodes: Vec<Bounds>,
    /// Number of leaves, a power of two.
    leaves: usize,
}

impl<'a> Tree<'a> {
    /// The tree of these primitives, in this order, and their boxes.
    pub fn new(order: &'a [u32], bounds: impl Fn(u32) -> Bounds) -> Self {
        let own: Vec<Bounds> = order.iter().map(|primitive| bounds(*primitive)).collect();
        let leaves = order.len().div_ceil(LEAF).next_power_of_two();
        let mut nodes = vec![Bounds::NONE; 2 * leaves];
        for (leaf, boxes) in own.chunks(LEAF).enumerate() {
            nodes[leaves + leaf] = boxes.iter().fold(Bounds::NONE, |all, own| all.with(*own));
        }
        for node in (1..leaves).rev() {
            nodes[node] = nodes[2 * node].with(nodes[2 * node + 1]);
        }
        Self { order, own, nodes, leaves }
    }

    /// First of a leaf's primitives, and the one after its last.
    fn leaf(&self, node: usize) -> (usize, usize) {
        let from = (node - self.leaves) * LEAF;
        (from.min(self.order.len()), (from + LEAF).min(self.order.len()))
    }

    /// Calls `found` once with every two different primitives whose boxes meet.
    pub fn pairs(&self, mut found: impl FnMut(u32, u32)) {
        let mut later = vec![(1_usize, 1_usize)];
        while let Some((a, b)) = later.pop() {
            if a == b {
                if a < self.leaves {
                    later.extend([(2 * a, 2 * a), (2 * a + 1, 2 * a + 1), (2 * a, 2 * a + 1)]);
                } else {
                    let (from, to) = self.leaf(a);
                    for i in from..to {
                        for j in i + 1..to {
                            if self.own[i].meets(&self.own[j]) {
                                found(self.order[i], self.order[j]);
                            }
                        }
                    }
                }
            } else if self.nodes[a].meets(&self.nodes[b]) {
                // Two different nodes are always of one row.
                if a < self.leaves {
                    for a in [2 * a, 2 * a + 1] {
                        later.extend([(a, 2 * b), (a, 2 * b + 1)]);
                    }
                } else {
                    self.leaf_pairs(a, self, b, &mut found);
                }
            }
        }
    }

    /// Calls `found` once with every primitive of this tree and every one of another whose boxes meet.
    pub fn pairs_with(&self, other: &Tree<'_>, mut found: impl FnMut(u32, u32)) {
        let mut later = vec![(1_usize, 1_usize)];
        while let Some((a, b)) = later.pop() {
            if !self.nodes[a].meets(&other.nodes[b]) {
                continue;
            }
            match (a < self.leaves, b < other.leaves) {
                (true, true) => {
                    for a in [2 * a, 2 * a + 1] {
                        later.extend([(a, 2 * b), (a, 2 * b + 1)]);
                    }
                }
                (true, false) => later.extend([(2 * a, b), (2 * a + 1, b)]),
                (false, true) => later.extend([(a, 2 * b), (a, 2 * b + 1)]),
                (false, false) => self.leaf_pairs(a, other, b, &mut found),
            }
        }
    }

    fn leaf_pairs(&self, a: usize, other: &Tree<'_>, b: usize, found: &mut impl FnMut(u32, u32)) {
        let ((from, to), (first, last)) = (self.leaf(a), other.leaf(b));
        for i in from..to {
            for j in first..last {
                if self.own[i].meets(&other.own[j]) {
                    found(self.order[i], other.order[j]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxes(count: u32, step: u32) -> Vec<Bounds> {
        let at = |k: u32| {
            let x = f64::from(k * 37 * step % 101);
            let y = f64::from(k * 53 % 97);
            let z = f64::from(k * 11 % 89);
            Vector3::new(x, y, z)
        };
        (0..count).map(|k| Bounds::of(&[at(k), at(k) + Vector3::new(9.0, 7.0, 11.0)])).collect()
    }

    #[test]
    fn finds_what_brute_force_finds() {
        for (count, more) in [(0, 3), (1, 0), (5, 9), (300, 77)] {
            let (own, other) = (boxes(count, 1), boxes(more, 3));
            let order: Vec<u32> = (0..count).rev().collect();
            let others: Vec<u32> = (0..more).collect();
            let tree = Tree::new(&order, |k| own[k as usize]);
            let mut found = Vec::new();
            tree.pairs(|a, b| found.push([a.min(b), a.max(b)]));
            found.sort_unstable();
            let all = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
            let meet = |[a, b]: &[u32; 2]| own[*a as usize].meets(&own[*b as usize]);
            assert_eq!(found, all.filter(meet).collect::<Vec<_>>(), "{count}");

            let second = Tree::new(&others, |k| other[k as usize]);
            let mut found = Vec::new();
            tree.pairs_with(&second, |a, b| found.push([a, b]));
            found.sort_unstable();
            let all = (0..count).flat_map(|a| (0..more).map(move |b| [a, b]));
            let meet = |[a, b]: &[u32; 2]| own[*a as usize].meets(&other[*b as usize]);
            assert_eq!(found, all.filter(meet).collect::<Vec<_>>(), "{count} {more}");
        }
    }
}
