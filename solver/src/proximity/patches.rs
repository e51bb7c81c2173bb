//! The film in patches of a few neighbouring elements, and a tree over them.
//!
//! ```text
//!             1                 node k holds what 2k and 2k + 1 hold
//!        2         3
//!      4   5     6   7          the last row: patches
//! ```
//!
//! Neighbours on the film stay neighbours however it folds, so patches and tree are constant. Every
//! node and every edge belongs to the first patch that has it; a patch's box holds them all.

use super::order;

/// Elements of a patch, a power of two.
pub const PATCH: usize = 1;

/// Lists of numbers, one a patch.
#[derive(Debug, Clone, PartialEq, Default)]
struct Lists {
    first: Vec<u32>,
    all: Vec<u32>,
}

impl Lists {
    fn of(lists: impl Iterator<Item = Vec<u32>>) -> Self {
        let mut own = Self { first: vec![0], all: Vec::new() };
        for list in lists {
            own.all.extend(list);
            own.first.push(u32::try_from(own.all.len()).expect("under 2^32"));
        }
        own
    }

    /// Those of one patch; none past the last.
    #[inline]
    fn get(&self, patch: usize) -> &[u32] {
        match self.first.get(patch..patch + 2) {
            Some(ends) => &self.all[ends[0] as usize..ends[1] as usize],
            None => &[],
        }
    }
}

/// Film in patches: constant.
#[derive(Debug, Clone, PartialEq)]
pub struct Patches {
    /// Number of places for patches in the last row of the tree, a power of two.
    leaves: usize,
    elements: Lists,
    nodes: Lists,
    edges: Lists,
    /// Every node of a patch's elements.
    corners: Lists,
}

impl Patches {
    /// The patches of these elements; `sides`: their edges, of which there are `edges`.
    pub fn new(nodes: usize, triangles: &[[u32; 3]], sides: &[[u32; 3]], edges: usize) -> Self {
        let order = order::of_elements(sides, edges, PATCH);
        let leaves = order.len().div_ceil(PATCH).next_power_of_two();
        let patches = || order.chunks(PATCH);
        let owned = |parts: &[[u32; 3]], count: usize| {
            let mut taken = vec![false; count];
            Lists::of(patches().map(|patch| {
                let all = patch.iter().flat_map(|element| parts[*element as usize]);
                all.filter(|part| !core::mem::replace(&mut taken[*part as usize], true)).collect()
            }))
        };
        let corners = Lists::of(patches().map(|patch| {
            let all = patch.iter().flat_map(|element| triangles[*element as usize]);
            let mut corners: Vec<u32> = all.collect();
            corners.sort_unstable();
            corners.dedup();
            corners
        }));
        Self {
            leaves,
            elements: Lists::of(patches().map(<[u32]>::to_vec)),
            nodes: owned(triangles, nodes),
            edges: owned(sides, edges),
            corners,
        }
    }

    /// Number of nodes of the tree and one, its root being 1.
    pub fn tree(&self) -> usize {
        2 * self.leaves
    }

    /// First node of the tree's last row.
    pub fn leaves(&self) -> usize {
        self.leaves
    }

    /// Nodes of the film in the elements of a leaf.
    #[inline]
    pub fn corners(&self, leaf: usize) -> &[u32] {
        self.corners.get(leaf - self.leaves)
    }

    /// Elements of a leaf.
    #[inline]
    pub fn elements(&self, leaf: usize) -> &[u32] {
        self.elements.get(leaf - self.leaves)
    }

    /// Nodes that belong to a leaf.
    #[inline]
    pub fn nodes(&self, leaf: usize) -> &[u32] {
        self.nodes.get(leaf - self.leaves)
    }

    /// Edges that belong to a leaf.
    #[inline]
    pub fn edges(&self, leaf: usize) -> &[u32] {
        self.edges.get(leaf - self.leaves)
    }
}
