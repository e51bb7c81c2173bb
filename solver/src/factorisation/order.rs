//! Order of elimination: nested dissection of the nodes.
//!
//! The algorithm cuts a set of nodes at the median of a coordinate, or of the distance along edges from an
//! end of the set. The separator is a smallest set of nodes that touches every edge between the two sides
//! (a vertex cover, from a largest matching by D. König's theorem): without it the two sides share no
//! element. Of the four cuts it takes the one with the smallest separator. A separator is eliminated after
//! the two sides, so the factor of a surface with n nodes has O(n log n) entries (A. George, "Nested
//! dissection of a regular finite element mesh", 1973).

use std::collections::VecDeque;

use crate::geometry::field::Field;
use crate::platform::simd::Column;

/// A set of nodes eliminated together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Separator {
    /// Nodes, ascending.
    pub nodes: Vec<u32>,
    /// Indices of the sets it separates, all smaller than its own index.
    pub children: Vec<usize>,
}

/// Largest number of nodes of a set that is not cut. Chosen.
const MAX_LEAF_NODES: usize = 12;

/// The separators of these nodes, children before parents; the last is the root.
pub fn dissect(nodes: Vec<u32>, neighbours: &[Vec<u32>], positions: &Field) -> Vec<Separator> {
    let mut dissection = Dissection {
        neighbours,
        positions,
        side: vec![Side::Outside; neighbours.len()],
        number: vec![0; neighbours.len()],
        tree: Vec::new(),
    };
    dissection.dissect(nodes);
    dissection.tree
}

/// Where a node lies during a cut.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    Outside,
    Low,
    High,
    Separator,
}

/// A dissection in progress.
struct Dissection<'a> {
    neighbours: &'a [Vec<u32>],
    positions: &'a Field,
    /// Side of each node; outside between cuts.
    side: Vec<Side>,
    /// Scratch: a number of each node.
    number: Vec<u32>,
    tree: Vec<Separator>,
}

/// Mark of a node without a number.
const NONE: u32 = u32::MAX;

impl Dissection<'_> {
    /// Dissects a set and appends its separators to the tree; returns the index of its root.
    fn dissect(&mut self, mut nodes: Vec<u32>) -> usize {
        if nodes.len() > MAX_LEAF_NODES
            && let Some([low, high, separator]) = self.smallest_cut(&nodes)
        {
            let children = [low, high].map(|half| self.dissect(half)).to_vec();
            self.tree.push(Separator { nodes: separator, children });
        } else {
            nodes.sort_unstable();
            self.tree.push(Separator { nodes, children: Vec::new() });
        }
        self.tree.len() - 1
    }

    /// Lower side, upper side and separator of the cut with the smallest separator, an uneven cut counting
    /// more. Of equal cuts the first. `None` if every cut leaves a side without nodes.
    fn smallest_cut(&mut self, nodes: &[u32]) -> Option<[Vec<u32>; 3]> {
        let axes = [&self.positions.x, &self.positions.y, &self.positions.z];
        let along = |axis: &Column| -> Vec<(f64, u32)> {
            nodes.iter().map(|node| (axis[*node as usize], *node)).collect()
        };
        let mut keys = axes.map(along).to_vec();
        keys.push(self.distances(nodes));
        let cuts = keys.into_iter().map(|keys| self.cut(keys));
        cuts.filter(|[low, high, _]| !low.is_empty() && !high.is_empty()).min_by_key(
            |[low, high, separator]| {
                separator.len() * (nodes.len() + low.len().abs_diff(high.len()))
            },
        )
    }

    /// Distance of each node, in edges, from a node at an end of the set. Nodes that it does not reach are
    /// farthest.
    fn distances(&mut self, nodes: &[u32]) -> Vec<(f64, u32)> {
        for node in nodes {
            self.side[*node as usize] = Side::Low;
        }
        let mut start = nodes[0];
        // The farthest node from the farthest node lies at an end of the set.
        for _ in 0..3 {
            for node in nodes {
                self.number[*node as usize] = NONE;
            }
            self.number[start as usize] = 0;
            let mut queue = VecDeque::from([start]);
            while let Some(node) = queue.pop_front() {
                start = node;
                for other in &self.neighbours[node as usize] {
                    let other = *other as usize;
                    if self.side[other] == Side::Low && self.number[other] == NONE {
                        self.number[other] = self.number[node as usize] + 1;
                        queue.push_back(u32::try_from(other).expect("a node"));
                    }
                }
            }
        }
        for node in nodes {
            self.side[*node as usize] = Side::Outside;
        }
        nodes.iter().map(|node| (f64::from(self.number[*node as usize]), *node)).collect()
    }

    /// Cuts a set at the median of its keys: lower side, upper side, separator.
    fn cut(&mut self, mut keys: Vec<(f64, u32)>) -> [Vec<u32>; 3] {
        let half = keys.len() / 2;
        keys.select_nth_unstable_by(half, |a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
        let (low, high) = keys.split_at(half);
        for (_, node) in low {
            self.side[*node as usize] = Side::Low;
        }
        for (_, node) in high {
            self.side[*node as usize] = Side::High;
        }
        let borders = |node: u32, other: Side| {
            self.neighbours[node as usize].iter().any(|n| self.side[*n as usize] == other)
        };
        let border = |half: &[(f64, u32)], other: Side| {
            let nodes = half.iter().map(|(_, node)| *node);
            let mut found: Vec<u32> = nodes.filter(|node| borders(*node, other)).collect();
            found.sort_unstable();
            found
        };
        let (below, above) = (border(low, Side::High), border(high, Side::Low));
        for node in self.cover(&below, &above) {
            self.side[node as usize] = Side::Separator;
        }
        let of_side = |side: Side| {
            let nodes = keys.iter().map(|(_, node)| *node);
            let mut found: Vec<u32> = nodes.filter(|n| self.side[*n as usize] == side).collect();
            found.sort_unstable();
            found
        };
        let sides = [Side::Low, Side::High, Side::Separator].map(of_side);
        for (_, node) in keys {
            self.side[node as usize] = Side::Outside;
        }
        sides
    }

    /// A smallest set of nodes that touches every edge between two borders.
    fn cover(&mut self, below: &[u32], above: &[u32]) -> Vec<u32> {
        for (index, node) in (0_u32..).zip(above) {
            self.number[*node as usize] = index;
        }
        let edges = |node: &u32| -> Vec<usize> {
            let others = self.neighbours[*node as usize].iter();
            let above = others.filter(|other| self.side[**other as usize] == Side::High);
            above.map(|other| self.number[*other as usize] as usize).collect()
        };
        let edges: Vec<Vec<usize>> = below.iter().map(edges).collect();
        let mut matching = Matching {
            edges: &edges,
            of_above: vec![None; above.len()],
            of_below: vec![None; below.len()],
            seen: vec![usize::MAX; above.len()],
        };
        for node in 0..below.len() {
            matching.augment(node, node);
        }
        let (reached_below, reached_above) = matching.alternating();
        let below = below.iter().zip(reached_below).filter(|(_, reached)| !reached);
        let above = above.iter().zip(reached_above).filter(|(_, reached)| *reached);
        below.chain(above).map(|(node, _)| *node).collect()
    }
}

/// A matching between two borders.
struct Matching<'a> {
    /// Nodes above that each node below has an edge to.
    edges: &'a [Vec<usize>],
    of_above: Vec<Option<usize>>,
    of_below: Vec<Option<usize>>,
    /// The last search that met each node above.
    seen: Vec<usize>,
}

impl Matching<'_> {
    /// Matches a node below, moving other partners along a path if needed; `false` if no path exists.
    fn augment(&mut self, below: usize, search: usize) -> bool {
        for above in &self.edges[below] {
            if self.seen[*above] == search {
                continue;
            }
            self.seen[*above] = search;
            let free = match self.of_above[*above] {
                None => true,
                Some(partner) => self.augment(partner, search),
            };
            if free {
                self.of_above[*above] = Some(below);
                self.of_below[below] = Some(*above);
                return true;
            }
        }
        false
    }

    /// Nodes below and above that alternating paths from unmatched nodes below reach.
    fn alternating(&self) -> (Vec<bool>, Vec<bool>) {
        let mut below: Vec<bool> = self.of_below.iter().map(Option::is_none).collect();
        let mut above = vec![false; self.of_above.len()];
        let mut open: Vec<usize> = (0..below.len()).filter(|node| below[*node]).collect();
        while let Some(node) = open.pop() {
            for other in &self.edges[node] {
                above[*other] = true;
                if let Some(partner) = self.of_above[*other]
                    && !core::mem::replace(&mut below[partner], true)
                {
                    open.push(partner);
                }
            }
        }
        (below, above)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separated_sets_share_no_edge() {
        let (wide, high) = (23_u32, 17_u32);
        let mut positions = Field::zeros((wide * high) as usize);
        let mut neighbours = vec![Vec::new(); positions.len()];
        for j in 0..high {
            for i in 0..wide {
                let node = (j * wide + i) as usize;
                positions.x[node] = f64::from(i);
                positions.y[node] = f64::from(j);
                for (k, l) in [(i + 1, j), (i, j + 1), (i + 1, j + 1)] {
                    if k < wide && l < high {
                        neighbours[node].push(l * wide + k);
                        neighbours[(l * wide + k) as usize].push(j * wide + i);
                    }
                }
            }
        }
        let tree = dissect((0..wide * high).collect(), &neighbours, &positions);
        // Every node once, and an edge only within a set or with one above it.
        let mut set = vec![usize::MAX; positions.len()];
        for (index, separator) in tree.iter().enumerate() {
            for node in &separator.nodes {
                assert_eq!(set[*node as usize], usize::MAX);
                set[*node as usize] = index;
            }
        }
        let mut parent = vec![usize::MAX; tree.len()];
        for (index, separator) in tree.iter().enumerate() {
            separator.children.iter().for_each(|child| parent[*child] = index);
        }
        let above = |mut low: usize, high: usize| {
            while low < high {
                low = parent[low];
            }
            low == high
        };
        for (node, others) in neighbours.iter().enumerate() {
            for other in others {
                let (a, b) = (set[node], set[*other as usize]);
                assert!(above(a.min(b), a.max(b)), "{node} {other}");
            }
        }
        assert!(tree.last().unwrap().nodes.len() <= high as usize + 1);
    }
}
