//! What is sought of two elements: the pairs of their primitives that share no node.
//!
//! ```text
//! meetings    node and element of each other, edge and edge        film that passes through film
//! piercings   edge and element of each other                       film that lies through film
//! ```
//!
//! A node and an edge belong to one leaf only, so every pair of primitives is of one pair of leaves.

use super::hierarchy::{Hierarchy, NONE};

/// What a lookout is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QueryKind {
    /// Nodes and elements, edges and edges, that share no node.
    Collision,
    /// Edges and elements that share no node.
    Intersection,
}

/// A kind of pairs of primitives that share no node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CandidateKind {
    /// A node and an element.
    NodeElement,
    /// Two edges, the lower number first.
    EdgeEdge,
    /// An edge and an element.
    EdgeElement,
}

impl QueryKind {
    /// The kinds of pairs sought.
    pub(super) fn couples(self) -> [Option<CandidateKind>; 2] {
        match self {
            Self::Collision => [Some(CandidateKind::NodeElement), Some(CandidateKind::EdgeEdge)],
            Self::Intersection => [Some(CandidateKind::EdgeElement), None],
        }
    }
}

/// Pairs of primitives, those of one kind apart from those of the other.
pub(super) type Pairs = [Vec<[u32; 2]>; 2];

/// Adds the pairs of primitives of two leaves that share no node.
pub(super) fn primitives(
    sought: QueryKind,
    patches: &Hierarchy,
    one: usize,
    two: usize,
    pairs: &mut Pairs,
) {
    // The three nodes and edges of one element share nodes.
    if one == two {
        return;
    }
    let (one, two) = (patches.leaf(one), patches.leaf(two));
    let [first, second] = pairs;
    for (a, b) in [(one, two), (two, one)] {
        let has = |node: u32| b.corners[0] == node || b.corners[1] == node || b.corners[2] == node;
        match sought {
            QueryKind::Collision => {
                for node in a.nodes {
                    if node != NONE && !has(node) {
                        first.push([node, b.element]);
                    }
                }
            }
            QueryKind::Intersection => {
                for (at, edge) in a.edges.into_iter().enumerate() {
                    let [p, q] = a.ends(at);
                    if edge != NONE && !has(p) && !has(q) {
                        first.push([edge, b.element]);
                    }
                }
            }
        }
    }
    if sought == QueryKind::Collision {
        for (at, edge) in one.edges.into_iter().enumerate() {
            if edge == NONE {
                continue;
            }
            let [p, q] = one.ends(at);
            for (at, other) in two.edges.into_iter().enumerate() {
                let [r, s] = two.ends(at);
                if other != NONE && p != r && p != s && q != r && q != s {
                    second.push([edge.min(other), edge.max(other)]);
                }
            }
        }
    }
}
