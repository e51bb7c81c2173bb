//! The pairs of primitives that a query looks for: film that would pass through film.
//!
//! ```text
//! node and element, edge and edge       primitives of a pair never share a node
//! ```
//!
//! Each node and each edge belongs to one leaf of the hierarchy only, so each pair of primitives
//! belongs to exactly one pair of leaves.

use serde::{Deserialize, Serialize};

use super::hierarchy::{Hierarchy, NO_INDEX};

/// The kind of a pair of primitives that share no node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PairKind {
    /// A node and an element.
    NodeElement,
    /// Two edges, the lower number first.
    EdgeEdge,
}

impl PairKind {
    /// Both kinds, in the order of candidates and contacts.
    pub const ALL: [Self; 2] = [Self::NodeElement, Self::EdgeEdge];
}

/// Candidates, one list for each kind, in the order of [`PairKind::ALL`].
pub(super) type Candidates = [Vec<[u32; 2]>; 2];

/// Adds the candidates of two leaves to `candidates`.
pub(super) fn push_candidates(
    hierarchy: &Hierarchy,
    first_leaf: usize,
    second_leaf: usize,
    candidates: &mut Candidates,
) {
    // The primitives of one element always share nodes.
    if first_leaf == second_leaf {
        return;
    }
    let (first_leaf, second_leaf) = (hierarchy.leaf(first_leaf), hierarchy.leaf(second_leaf));
    let [node_element, edge_edge] = candidates;
    for (a, b) in [(first_leaf, second_leaf), (second_leaf, first_leaf)] {
        let in_b = |node: u32| b.corners[0] == node || b.corners[1] == node || b.corners[2] == node;
        for node in a.nodes {
            if node != NO_INDEX && !in_b(node) {
                node_element.push([node, b.element]);
            }
        }
    }
    for (side, edge) in first_leaf.edges.into_iter().enumerate() {
        if edge == NO_INDEX {
            continue;
        }
        let [p, q] = first_leaf.edge_nodes(side);
        for (side, other) in second_leaf.edges.into_iter().enumerate() {
            let [r, s] = second_leaf.edge_nodes(side);
            if other != NO_INDEX && p != r && p != s && q != r && q != s {
                edge_edge.push([edge.min(other), edge.max(other)]);
            }
        }
    }
}
