//! The film in patches: a tree over its elements.
//!
//! ```text
//!             1                 node k holds what 2k and 2k + 1 hold
//!        2         3
//!      4   5     6   7          the last row: leaves, one element each
//! ```
//!
//! Neighbours on the film stay neighbours however it folds, so the tree is constant. Every node and
//! every edge belongs to the first leaf that has it; a leaf's box holds them all.

use super::bisection;

/// A number that is none: the place of a node or an edge that belongs to another leaf.
pub const NONE: u32 = u32::MAX;

/// One element, and what of it belongs to this leaf.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leaf {
    /// Element; [`NONE`] of a place in the last row that is left over.
    pub element: u32,
    /// Its nodes.
    pub corners: [u32; 3],
    /// Those that belong to this leaf, or [`NONE`].
    pub nodes: [u32; 3],
    /// Edges that belong to this leaf, or [`NONE`]: between its corners 0-1, 1-2, 2-0.
    pub edges: [u32; 3],
}

impl Leaf {
    /// A place left over.
    const EMPTY: Self =
        Self { element: NONE, corners: [NONE; 3], nodes: [NONE; 3], edges: [NONE; 3] };

    /// The nodes of one of its edges.
    #[inline]
    pub fn ends(&self, edge: usize) -> [u32; 2] {
        [self.corners[edge], self.corners[(edge + 1) % 3]]
    }
}

/// Film in patches: constant.
#[derive(Debug, Clone, PartialEq)]
pub struct Hierarchy {
    /// The last row of the tree; as many as a power of two.
    leaves: Vec<Leaf>,
}

impl Hierarchy {
    /// The patches of these elements over so many nodes; `sides`: their edges, of which there are `edges`.
    pub fn new(nodes: usize, triangles: &[[u32; 3]], sides: &[[u32; 3]], edges: usize) -> Self {
        let order = bisection::of_elements(sides, edges, 1);
        let (mut taken_nodes, mut taken_edges) = (vec![false; nodes], vec![false; edges]);
        let own = |taken: &mut Vec<bool>, number: u32| {
            let other = core::mem::replace(&mut taken[number as usize], true);
            if other { NONE } else { number }
        };
        let mut leaves: Vec<Leaf> = order
            .iter()
            .map(|element| {
                let corners = triangles[*element as usize];
                let edges = sides[*element as usize];
                Leaf {
                    element: *element,
                    corners,
                    nodes: corners.map(|node| own(&mut taken_nodes, node)),
                    edges: edges.map(|edge| own(&mut taken_edges, edge)),
                }
            })
            .collect();
        leaves.resize(leaves.len().next_power_of_two(), Leaf::EMPTY);
        Self { leaves }
    }

    /// Number of nodes of the tree and one, its root being 1.
    pub fn tree(&self) -> usize {
        2 * self.leaves.len()
    }

    /// First node of the tree's last row.
    pub fn leaves(&self) -> usize {
        self.leaves.len()
    }

    /// One leaf, by its node of the tree.
    #[inline]
    pub fn leaf(&self, node: usize) -> &Leaf {
        &self.leaves[node - self.leaves.len()]
    }

    /// Whether two leaves are one, or share a node of the film.
    #[inline]
    pub fn share(&self, one: usize, two: usize) -> bool {
        let (one, two) = (self.corners(one), self.corners(two));
        one.iter().any(|node| two.contains(node))
    }

    /// Nodes of the film in a leaf.
    #[inline]
    pub fn corners(&self, node: usize) -> &[u32] {
        let leaf = self.leaf(node);
        if leaf.element == NONE { &[] } else { &leaf.corners }
    }
}
