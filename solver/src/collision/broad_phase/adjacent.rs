//! Elements that share a node, waiting by what moves round that node.
//!
//! ```text
//! due = way + d      way = Σ over looks of 2 max |u_i − u_v|        i over the neighbours of node v
//! ```
//!
//! Symbols: u displacement of a node, m; d least distance of the primitives of two elements at v that share
//! no node, m. Every point of an element at v moves with a mean of its corners, so no farther from v than
//! the farthest of them. Such elements are never far apart, so a look at zones would find them due
//! again and again; but film one element wide moves together far more than a zone does.

use super::hierarchy::Hierarchy;
use super::query::{Pairs, QueryKind, primitives};
use crate::geometry::field::Field;

/// Share by which rounding could shorten a way at most.
const ROUNDING: f64 = 1.0 + 1e-9;

/// Pairs of elements that share a node, each with the lowest node they share: constant.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AdjacentPairs {
    /// The first pair of each node, and the end of the last's.
    starts: Vec<usize>,
    /// Where the primitives of each pair end.
    ends: Vec<[usize; 2]>,
    /// Pairs of primitives that share no node.
    primitives: Pairs,
}

impl AdjacentPairs {
    /// What is sought of elements that share one of so many nodes.
    pub fn new(sought: QueryKind, nodes: usize, patches: &Hierarchy) -> Self {
        let mut at_node = vec![Vec::new(); nodes];
        for leaf in patches.leaves()..patches.tree() {
            for node in patches.corners(leaf) {
                at_node[*node as usize].push(leaf);
            }
        }
        let mut stars = Self { starts: vec![0], ..Self::default() };
        for (node, leaves) in at_node.iter().enumerate() {
            for (at, one) in leaves.iter().enumerate() {
                for two in &leaves[at + 1..] {
                    let theirs = patches.corners(*two);
                    let shared = patches.corners(*one).iter().filter(|own| theirs.contains(own));
                    if shared.min().is_some_and(|lowest| *lowest as usize == node) {
                        stars.add(sought, patches, *one, *two);
                    }
                }
            }
            stars.starts.push(stars.ends.len());
        }
        stars
    }

    fn add(&mut self, sought: QueryKind, patches: &Hierarchy, one: usize, two: usize) {
        let before = [self.primitives[0].len(), self.primitives[1].len()];
        primitives(sought, patches, one, two, &mut self.primitives);
        let ends = [self.primitives[0].len(), self.primitives[1].len()];
        // What has no primitives waits for nothing.
        if ends != before {
            self.ends.push(ends);
        }
    }

    /// The primitives of a pair.
    #[inline]
    fn of(&self, pair: usize) -> [&[[u32; 2]]; 2] {
        let [first, second] = if pair == 0 { [0; 2] } else { self.ends[pair - 1] };
        let to = self.ends[pair];
        [&self.primitives[0][first..to[0]], &self.primitives[1][second..to[1]]]
    }
}

/// Pairs of elements that share a node, each waiting for its time.
#[derive(Debug, Clone, PartialEq)]
pub struct PendingAdjacentPairs {
    /// How far film round each node has come towards each other so far at most, m.
    ways: Vec<f64>,
    /// How far it comes now, m.
    reach: Vec<f64>,
    /// Way at which each pair is due, m.
    due: Vec<f64>,
    /// The first of them at each node, m.
    first: Vec<f64>,
}

impl PendingAdjacentPairs {
    /// Stars that have looked at nothing yet.
    pub fn new(stars: &AdjacentPairs) -> Self {
        let (nodes, pairs) = (stars.starts.len() - 1, stars.ends.len());
        let (ways, reach) = (vec![0.0; nodes], vec![0.0; nodes]);
        Self { ways, reach, due: vec![0.0; pairs], first: vec![0.0; nodes] }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.ways.len()
    }

    /// Has every pair wait for nothing.
    pub fn begin(&mut self) {
        self.due.fill(0.0);
        self.first.fill(0.0);
        self.ways.fill(0.0);
    }

    /// How far film round each node comes towards each other at most between two places of all nodes,
    /// m; `edges`: their ends.
    pub fn travel(&mut self, edges: &[[u32; 2]], from: &Field, to: &Field) -> &[f64] {
        self.reach.fill(0.0);
        for [a, b] in edges {
            let (a, b) = (*a as usize, *b as usize);
            let apart = (to.get(b) - from.get(b)) - (to.get(a) - from.get(a));
            let square = apart.norm_squared();
            for node in [a, b] {
                let own = self.reach[node];
                // What is no number stays: nothing waits for it.
                self.reach[node] = if square <= own || own.is_nan() { own } else { square };
            }
        }
        for reach in &mut self.reach {
            *reach = 2.0 * ROUNDING * reach.sqrt();
        }
        &self.reach
    }

    /// Goes where it was asked to travel.
    pub fn arrive(&mut self) {
        for (way, reach) in self.ways.iter_mut().zip(&self.reach) {
            *way += reach;
        }
    }

    /// Tells `look` of every pair that is due where film round each node comes so far (m) towards each
    /// other: its node, its number, its primitives of each kind.
    pub fn take(
        &mut self,
        stars: &AdjacentPairs,
        reach: &[f64],
        mut look: impl FnMut(usize, usize, [&[[u32; 2]]; 2]),
    ) {
        let until = self.ways.iter().zip(reach).map(|(way, reach)| way + reach);
        for (node, (first, until)) in self.first.iter_mut().zip(until).enumerate() {
            if *first > until {
                continue;
            }
            *first = f64::INFINITY;
            for pair in stars.starts[node]..stars.starts[node + 1] {
                let due = self.due[pair];
                if due > until {
                    *first = first.min(due);
                } else {
                    self.due[pair] = f64::INFINITY;
                    look(node, pair, stars.of(pair));
                }
            }
        }
    }

    /// Has a pair wait for a length (m) more.
    #[inline]
    pub fn put(&mut self, node: usize, pair: usize, length: f64) {
        let due = self.ways[node] + length;
        self.due[pair] = due;
        self.first[node] = self.first[node].min(due);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    use nalgebra::Vector3;
    use proptest::prelude::*;

    use crate::collision::contact::topology::Topology;

    /// What is sought of any two leaves that share a node, by looking at all of them.
    fn next_to_each_other(topology: &Topology) -> [BTreeSet<[u32; 2]>; 2] {
        let (patches, mut found) = (&topology.patches, Pairs::default());
        for one in patches.leaves()..patches.tree() {
            for two in one + 1..patches.tree() {
                let theirs = patches.corners(two);
                if patches.corners(one).iter().any(|node| theirs.contains(node)) {
                    primitives(QueryKind::Collision, patches, one, two, &mut found);
                }
            }
        }
        found.map(|pairs| pairs.into_iter().collect())
    }

    proptest! {
        /// No points of two elements that share a node come nearer by more than is told of it, and each
        /// pair of such elements is told of once.
        #[test]
        fn ways_are_bounds(
            from in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 7),
            to in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 7),
        ) {
            // A fan of six, and one that is apart.
            let triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5], [0, 5, 1], [1, 2, 6]];
            let topology = Topology::new(7, &triangles);
            let stars = topology.stars(QueryKind::Collision);
            let mut waiting = PendingAdjacentPairs::new(stars);
            let (from, to): (Vec<_>, Vec<_>) =
                from.into_iter().zip(to).map(|(x, y)| (Vector3::from(x), Vector3::from(y))).unzip();
            let reach =
                waiting.travel(&topology.edges, &Field::of(&from), &Field::of(&to)).to_vec();
            for (node, reach) in reach.iter().enumerate() {
                let own = |corners: &&[u32; 3]| corners.iter().any(|own| *own as usize == node);
                let nodes: Vec<usize> =
                    triangles.iter().filter(own).flatten().map(|own| *own as usize).collect();
                for p in &nodes {
                    for q in &nodes {
                        let closer = ((to[*p] - from[*p]) - (to[*q] - from[*q])).norm();
                        prop_assert!(closer <= *reach, "{closer} {reach}");
                    }
                }
            }
            let mut seen: [BTreeSet<[u32; 2]>; 2] = Default::default();
            waiting.take(stars, &reach, |_, _, told| {
                for (seen, told) in seen.iter_mut().zip(told) {
                    for pair in told {
                        assert!(seen.insert(*pair), "{pair:?} twice");
                    }
                }
            });
            prop_assert_eq!(seen, next_to_each_other(&topology));
            // Of what waits nothing is told before its time.
            waiting.put(0, 0, 1.0);
            let mut told = 0_u32;
            waiting.take(stars, &[0.5; 7], |_, _, _| told += 1);
            prop_assert_eq!(told, 0);
            waiting.take(stars, &[1.0; 7], |_, _, _| told += 1);
            prop_assert_eq!(told, 1);
        }
    }
}
