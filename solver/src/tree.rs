//! A tree of boxes: which of many primitives come near a box.
//!
//! Built anew at every search by halving along the longest side of the centres; ties go by number,
//! so the same places give the same tree.

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
    /// Smallest box round these points.
    pub fn of(points: &[Vector3<f64>]) -> Self {
        let mut bounds = Self { low: points[0], high: points[0] };
        for point in &points[1..] {
            bounds.low = bounds.low.inf(point);
            bounds.high = bounds.high.sup(point);
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
    pub fn with(self, other: Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    /// Whether two boxes meet.
    pub fn meets(&self, other: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }
}

/// Primitives at a leaf, at most.
const LEAF: usize = 4;

/// A tree over the boxes of primitives.
#[derive(Debug, Clone, Default)]
pub struct Tree {
    order: Vec<u32>,
    nodes: Vec<Branch>,
}

#[derive(Debug, Clone, Copy)]
struct Branch {
    bounds: Bounds,
    from: u32,
    to: u32,
    /// Second child; 0 at a leaf. The first follows at once.
    second: u32,
}

/// A place in a list as the elements count, in 32 bits.
fn index(at: usize) -> u32 {
    u32::try_from(at).expect("under 2^32")
}

impl Tree {
    /// The tree of these boxes.
    ///
    /// # Panics
    /// At 2³² boxes.
    pub fn new(boxes: &[Bounds]) -> Self {
        let count = index(boxes.len());
        let mut tree = Self { order: (0..count).collect(), nodes: Vec::new() };
        let centres: Vec<Vector3<f64>> = boxes.iter().map(|b| b.low + b.high).collect();
        let mut order = core::mem::take(&mut tree.order);
        if !order.is_empty() {
            tree.grow(boxes, &centres, &mut order, 0);
        }
        tree.order = order;
        tree
    }

    fn grow(&mut self, boxes: &[Bounds], centres: &[Vector3<f64>], own: &mut [u32], from: usize) {
        let bounds =
            own[1..].iter().fold(boxes[own[0] as usize], |all, at| all.with(boxes[*at as usize]));
        let here = self.nodes.len();
        let (first, last) = (index(from), index(from + own.len()));
        self.nodes.push(Branch { bounds, from: first, to: last, second: 0 });
        if own.len() <= LEAF {
            return;
        }
        let spread: Vec<Vector3<f64>> = own.iter().map(|at| centres[*at as usize]).collect();
        let spread = Bounds::of(&spread);
        let axis = (spread.high - spread.low).imax();
        let middle = own.len() / 2;
        own.select_nth_unstable_by(middle, |a, b| {
            centres[*a as usize][axis].total_cmp(&centres[*b as usize][axis]).then(a.cmp(b))
        });
        let (low, high) = own.split_at_mut(middle);
        // Which of each half comes where is the selection's own business: put it in order.
        low.sort_unstable();
        high.sort_unstable();
        self.grow(boxes, centres, low, from);
        self.nodes[here].second = index(self.nodes.len());
        self.grow(boxes, centres, high, from + middle);
    }

    /// Calls `found` with every primitive at a leaf whose box meets `bounds`.
    pub fn query(&self, bounds: &Bounds, mut found: impl FnMut(u32)) {
        let mut at = 0;
        let mut later = [0_u32; 64];
        let mut depth = 0;
        if self.nodes.is_empty() {
            return;
        }
        loop {
            let branch = &self.nodes[at as usize];
            let meets = branch.bounds.meets(bounds);
            if meets && branch.second != 0 {
                later[depth] = branch.second;
                depth += 1;
                at += 1;
                continue;
            }
            if meets {
                for own in &self.order[branch.from as usize..branch.to as usize] {
                    found(*own);
                }
            }
            if depth == 0 {
                return;
            }
            depth -= 1;
            at = later[depth];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_what_brute_force_finds() {
        let at = |k: u32| {
            let x = f64::from(k * 37 % 101);
            let y = f64::from(k * 53 % 97);
            let z = f64::from(k * 11 % 89);
            Vector3::new(x, y, z)
        };
        let boxes: Vec<Bounds> =
            (0..300).map(|k| Bounds::of(&[at(k), at(k) + Vector3::new(4.0, 2.0, 6.0)])).collect();
        let tree = Tree::new(&boxes);
        for (own, bounds) in boxes.iter().enumerate() {
            let near = bounds.grown(5.0);
            let mut found = Vec::new();
            tree.query(&near, |other| {
                if boxes[other as usize].meets(&near) {
                    found.push(other as usize);
                }
            });
            found.sort_unstable();
            let brute: Vec<usize> = (0..300).filter(|k| boxes[*k].meets(&near)).collect();
            assert_eq!(found, brute, "{own}");
        }
        Tree::new(&[]).query(&boxes[0], |_| panic!("nothing is there"));
    }
}
