//! Bounding-volume hierarchy over the elements of a mesh: the tree, without the volumes.
//!
//! ```text
//!             1                 tree node k is the parent of 2k and 2k + 1
//!        2         3
//!      4   5     6   7          last row: leaves, one element each
//! ```
//!
//! Elements that are neighbours on the film stay close however the film folds, so the tree is
//! constant. Each mesh node and each edge belongs to the first leaf that contains it, so that no
//! pair of primitives appears twice. The bounding volume of a leaf contains its whole element.

use core::ops::Range;

use super::bisection;

/// An index that points to nothing.
pub const NO_INDEX: u32 = u32::MAX;

/// One element, and the nodes and edges that belong to its leaf.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leaf {
    /// Element; [`NO_INDEX`] in an empty leaf.
    pub element: u32,
    /// Nodes of the element.
    pub corners: [u32; 3],
    /// Those nodes of the element that belong to this leaf; [`NO_INDEX`] for the others.
    pub nodes: [u32; 3],
    /// Those edges of the element that belong to this leaf, between its corners 0-1, 1-2, 2-0;
    /// [`NO_INDEX`] for the others.
    pub edges: [u32; 3],
}

impl Leaf {
    /// A leaf without an element.
    const EMPTY: Self = Self {
        element: NO_INDEX,
        corners: [NO_INDEX; 3],
        nodes: [NO_INDEX; 3],
        edges: [NO_INDEX; 3],
    };

    /// The two nodes of edge `side` (0, 1 or 2) of the element.
    #[inline]
    pub fn edge_nodes(&self, side: usize) -> [u32; 2] {
        [self.corners[side], self.corners[(side + 1) % 3]]
    }
}

/// A complete binary tree over the elements of a mesh; constant.
#[derive(Debug, Clone, PartialEq)]
pub struct Hierarchy {
    /// The last row of the tree. Its length is a power of two; the leaves at its end may be empty.
    leaves: Vec<Leaf>,
}

impl Hierarchy {
    /// The hierarchy over `triangles`. `nodes` and `edges` are the numbers of nodes and edges of the
    /// mesh; `element_edges` are the edges of each element.
    pub fn new(
        nodes: usize,
        triangles: &[[u32; 3]],
        element_edges: &[[u32; 3]],
        edges: usize,
    ) -> Self {
        let order = bisection::element_order(element_edges, edges, 1);
        let (mut assigned_nodes, mut assigned_edges) = (vec![false; nodes], vec![false; edges]);
        let assign = |assigned: &mut Vec<bool>, index: u32| {
            let before = core::mem::replace(&mut assigned[index as usize], true);
            if before { NO_INDEX } else { index }
        };
        let mut leaves: Vec<Leaf> = order
            .iter()
            .map(|element| {
                let corners = triangles[*element as usize];
                let edges = element_edges[*element as usize];
                Leaf {
                    element: *element,
                    corners,
                    nodes: corners.map(|node| assign(&mut assigned_nodes, node)),
                    edges: edges.map(|edge| assign(&mut assigned_edges, edge)),
                }
            })
            .collect();
        leaves.resize(leaves.len().next_power_of_two(), Leaf::EMPTY);
        Self { leaves }
    }

    /// One more than the largest index of a tree node. The root has index 1; index 0 is unused.
    pub fn end(&self) -> usize {
        2 * self.leaves.len()
    }

    /// Index of the first leaf. This is also the number of leaves.
    pub fn first_leaf(&self) -> usize {
        self.leaves.len()
    }

    /// Indices of all leaves.
    pub fn leaves(&self) -> Range<usize> {
        self.first_leaf()..self.end()
    }

    /// The leaf with this index.
    #[inline]
    pub fn leaf(&self, index: usize) -> &Leaf {
        &self.leaves[index - self.leaves.len()]
    }

    /// Whether the elements of two leaves share a mesh node, or are the same element.
    #[inline]
    pub fn share_mesh_node(&self, a: usize, b: usize) -> bool {
        let (a, b) = (self.corners(a), self.corners(b));
        a.iter().any(|node| b.contains(node))
    }

    /// Mesh nodes of the element of a leaf; none if the leaf is empty.
    #[inline]
    pub fn corners(&self, index: usize) -> &[u32] {
        let leaf = self.leaf(index);
        if leaf.element == NO_INDEX { &[] } else { &leaf.corners }
    }
}

/// Adds the pairs of children of a pair of tree nodes to `pairs`. The children of a node paired with
/// itself include each child paired with itself.
#[inline]
pub(super) fn push_child_pairs([a, b]: [u32; 2], pairs: &mut Vec<[u32; 2]>) {
    if a == b {
        pairs.extend([[2 * a, 2 * a], [2 * a + 1, 2 * a + 1], [2 * a, 2 * a + 1]]);
    } else {
        for a in [2 * a, 2 * a + 1] {
            pairs.extend([[a, 2 * b], [a, 2 * b + 1]]);
        }
    }
}
