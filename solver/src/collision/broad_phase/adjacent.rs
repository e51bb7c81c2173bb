//! Pairs of elements that share a node: they are due when the film around that node has deformed
//! enough.
//!
//! ```text
//! due = b + d      b = Σ over queries of 2 max |u_i − u_v|        i over the neighbours of node v
//! ```
//!
//! Symbols: u displacement of a node, m; d smallest distance of the candidates of two elements at v,
//! m. The displacement of a point of an element, relative to v, is a mean of the relative
//! displacements of the corners, so it is at most their largest. Two such points approach each other
//! by at most twice that.
//!
//! Elements that share a node are never far apart, so the bounds of whole motion clusters would make
//! them due in almost every query. The film around one node moves together far more than the film of
//! a whole cluster.

use nalgebra::Vector3;

use super::hierarchy::Hierarchy;
use super::query::{Candidates, push_candidates};

/// Factor on a bound that covers rounding. Chosen: far above the relative error of a norm (about
/// 1e-15), far below any effect on cost.
const ROUNDING_FACTOR: f64 = 1.0 + 1e-9;

/// Pairs of elements that share a node, each listed at the lowest node that they share; constant.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AdjacentPairs {
    /// First pair of each node, then the number of pairs.
    starts: Vec<usize>,
    /// End of the candidates of each pair.
    ends: Vec<[usize; 2]>,
    /// Candidates of all pairs.
    candidates: Candidates,
}

impl AdjacentPairs {
    /// The pairs of elements that share one of `nodes` nodes and have candidates.
    pub fn new(nodes: usize, hierarchy: &Hierarchy) -> Self {
        let mut leaves_at_node = vec![Vec::new(); nodes];
        for leaf in hierarchy.leaves() {
            for node in hierarchy.corners(leaf) {
                leaves_at_node[*node as usize].push(leaf);
            }
        }
        let mut pairs = Self { starts: vec![0], ..Self::default() };
        for (node, leaves) in leaves_at_node.iter().enumerate() {
            for (position, a) in leaves.iter().enumerate() {
                for b in &leaves[position + 1..] {
                    let corners_of_b = hierarchy.corners(*b);
                    let corners_of_a = hierarchy.corners(*a).iter();
                    let shared = corners_of_a.filter(|corner| corners_of_b.contains(corner));
                    if shared.min().is_some_and(|lowest| *lowest as usize == node) {
                        pairs.push(hierarchy, *a, *b);
                    }
                }
            }
            pairs.starts.push(pairs.ends.len());
        }
        pairs
    }

    fn push(&mut self, hierarchy: &Hierarchy, a: usize, b: usize) {
        let before = [self.candidates[0].len(), self.candidates[1].len()];
        push_candidates(hierarchy, a, b, &mut self.candidates);
        let ends = [self.candidates[0].len(), self.candidates[1].len()];
        // A pair without candidates is never due.
        if ends != before {
            self.ends.push(ends);
        }
    }

    /// The candidates of a pair.
    #[inline]
    fn candidates_of(&self, pair: usize) -> [&[[u32; 2]]; 2] {
        let [first, second] = if pair == 0 { [0; 2] } else { self.ends[pair - 1] };
        let end = self.ends[pair];
        [&self.candidates[0][first..end[0]], &self.candidates[1][second..end[1]]]
    }
}

/// When each pair of [`AdjacentPairs`] is due.
#[derive(Debug, Clone, PartialEq)]
pub struct PendingAdjacentPairs {
    /// b of each node: upper bound of the approach around it so far, m.
    approach_bounds: Vec<f64>,
    /// Scratch memory: largest squared relative displacement around each node, m².
    squares: Vec<f64>,
    /// Approach bound at which each pair is due, m; infinite if the pair is not in the queue.
    due: Vec<f64>,
    /// Smallest due bound at each node, m.
    first_due: Vec<f64>,
}

impl PendingAdjacentPairs {
    /// All pairs, due at once.
    pub fn new(pairs: &AdjacentPairs) -> Self {
        let (nodes, count) = (pairs.starts.len() - 1, pairs.ends.len());
        Self {
            approach_bounds: vec![0.0; nodes],
            squares: vec![0.0; nodes],
            due: vec![0.0; count],
            first_due: vec![0.0; nodes],
        }
    }

    /// Makes every pair due at once.
    pub fn restart(&mut self) {
        self.due.fill(0.0);
        self.first_due.fill(0.0);
        self.approach_bounds.fill(0.0);
    }

    /// Adds these displacements of all nodes (m) to the approach so far; `edges`: the nodes of each edge.
    pub fn add_motion(&mut self, edges: &[[u32; 2]], displacements: &[Vector3<f64>]) {
        self.squares.fill(0.0);
        for [a, b] in edges {
            let (a, b) = (*a as usize, *b as usize);
            let relative = displacements[b] - displacements[a];
            let square = relative.norm_squared();
            for node in [a, b] {
                let largest = self.squares[node];
                // Once NaN, always NaN: pairs at this node are then always due.
                self.squares[node] =
                    if square <= largest || largest.is_nan() { largest } else { square };
            }
        }
        for (total, square) in self.approach_bounds.iter_mut().zip(&self.squares) {
            *total += 2.0 * ROUNDING_FACTOR * square.sqrt();
        }
    }

    /// Removes every pair of a node that is due when the film around the node approaches by `reach` (m) more, and calls
    /// `visit` with its number and its candidates of each kind.
    #[inline]
    pub fn pop_due(
        &mut self,
        pairs: &AdjacentPairs,
        node: usize,
        reach: f64,
        mut visit: impl FnMut(usize, [&[[u32; 2]]; 2]),
    ) {
        let (first_due, limit) = (&mut self.first_due[node], self.approach_bounds[node] + reach);
        if *first_due > limit {
            return;
        }
        *first_due = f64::INFINITY;
        for pair in pairs.starts[node]..pairs.starts[node + 1] {
            let due = self.due[pair];
            if due > limit {
                *first_due = first_due.min(due);
            } else {
                self.due[pair] = f64::INFINITY;
                visit(pair, pairs.candidates_of(pair));
            }
        }
    }

    /// Makes a pair due after the film around its node has approached by `length` (m) more.
    #[inline]
    pub fn push(&mut self, node: usize, pair: usize, length: f64) {
        let due = self.approach_bounds[node] + length;
        self.due[pair] = due;
        self.first_due[node] = self.first_due[node].min(due);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use crate::geometry::topology::Topology;

    /// The candidates of all pairs of leaves that share a node, by testing every pair.
    fn adjacent_candidates(hierarchy: &Hierarchy) -> [BTreeSet<[u32; 2]>; 2] {
        let mut candidates = Candidates::default();
        for a in hierarchy.leaves() {
            for b in a + 1..hierarchy.end() {
                if hierarchy.share_mesh_node(a, b) {
                    push_candidates(hierarchy, a, b, &mut candidates);
                }
            }
        }
        candidates.map(|pairs| pairs.into_iter().collect())
    }

    proptest! {
        /// No points of two elements that share a node approach each other by more than the bound,
        /// and each pair of such elements is visited once.
        #[test]
        fn approach_is_never_underestimated_and_each_pair_is_visited_once(
            from in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 7),
            to in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 7),
        ) {
            // A fan of five elements, and one more at an edge of the fan.
            let triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5], [0, 5, 1], [1, 2, 6]];
            let topology = Topology::new(7, &triangles);
            let hierarchy =
                Hierarchy::new(7, &triangles, &topology.element_edges, topology.edges.len());
            let pairs = AdjacentPairs::new(7, &hierarchy);
            let mut pending = PendingAdjacentPairs::new(&pairs);
            let (from, to): (Vec<_>, Vec<_>) =
                from.into_iter().zip(to).map(|(x, y)| (Vector3::from(x), Vector3::from(y))).unzip();
            let u: Vec<Vector3<f64>> = from.iter().zip(&to).map(|(from, to)| to - from).collect();
            pending.add_motion(&topology.edges, &u);
            let bounds = pending.approach_bounds.clone();
            for (node, bound) in bounds.iter().enumerate() {
                let at_node =
                    |corners: &&[u32; 3]| corners.iter().any(|corner| *corner as usize == node);
                let nodes: Vec<usize> =
                    triangles.iter().filter(at_node).flatten().map(|node| *node as usize).collect();
                for p in &nodes {
                    for q in &nodes {
                        let approach = (u[*p] - u[*q]).norm();
                        prop_assert!(approach <= *bound, "{approach} {bound}");
                    }
                }
            }
            let mut visited: [BTreeSet<[u32; 2]>; 2] = Default::default();
            for node in 0..topology.nodes() {
                pending.pop_due(&pairs, node, 0.0, |_, candidates| {
                    for (visited, candidates) in visited.iter_mut().zip(candidates) {
                        for pair in candidates {
                            assert!(visited.insert(*pair), "{pair:?} twice");
                        }
                    }
                });
            }
            prop_assert_eq!(visited, adjacent_candidates(&hierarchy));
            // A pending pair is not visited before it is due.
            pending.push(0, 0, 1.0);
            let mut visits = 0_u32;
            pending.pop_due(&pairs, 0, 0.5, |_, _| visits += 1);
            prop_assert_eq!(visits, 0);
            pending.pop_due(&pairs, 0, 1.0, |_, _| visits += 1);
            prop_assert_eq!(visits, 1);
        }
    }
}
