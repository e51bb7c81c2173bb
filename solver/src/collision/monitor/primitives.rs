//! Which primitives of two elements can pass through each other or intersect.
//!
//! ```text
//! passage        node and element, edge and edge
//! intersection   edge and element
//! ```
//!
//! Each node and each edge belongs to the first element that contains it, and its path lies in the box
//! of that element. So each pair of primitives belongs to one pair of elements: of an element and a
//! primitive, to the element and that of the primitive. Primitives of a pair share no node. Elements
//! that share a node always overlap; their primitives are listed once.

use crate::geometry::topology::Topology;

/// Largest distance of the crossing points of two edges, as a share of the sum of their lengths, at
/// which edges in one plane count as crossing. Chosen: it excludes edges on one line, whose crossing
/// points have no meaning, and covers rounding.
pub const MAX_CROSSING_DISTANCE: f64 = 1e-6;

/// Pairs of a node and an element.
pub const NODES: usize = 0;
/// Pairs of two edges, the lower number first.
pub const EDGES: usize = 1;

/// Which nodes and edges belong to each element; constant.
#[derive(Debug, Clone, PartialEq)]
pub struct Primitives {
    /// Whether each node of an element belongs to it.
    nodes: Vec<[bool; 3]>,
    /// Whether each edge of an element belongs to it.
    edges: Vec<[bool; 3]>,
}

impl Primitives {
    /// The primitives of a mesh.
    pub fn new(topology: &Topology) -> Self {
        let mut node_taken = vec![false; topology.nodes()];
        let mut edge_taken = vec![false; topology.edges.len()];
        let take = |taken: &mut Vec<bool>, indices: &[u32; 3]| {
            indices.map(|index| !core::mem::replace(&mut taken[index as usize], true))
        };
        Self {
            nodes: topology.triangles.iter().map(|nodes| take(&mut node_taken, nodes)).collect(),
            edges: topology
                .element_edges
                .iter()
                .map(|edges| take(&mut edge_taken, edges))
                .collect(),
        }
    }

    /// Adds the pairs of two elements that can pass through each other.
    pub fn push_passages(
        &self,
        topology: &Topology,
        pair: [u32; 2],
        pairs: &mut [Vec<[u32; 2]>; 2],
    ) {
        let [first, second] = pair.map(|element| element as usize);
        for (a, b, element) in [(first, second, pair[1]), (second, first, pair[0])] {
            let corners = topology.triangles[b];
            for (node, belongs) in topology.triangles[a].into_iter().zip(self.nodes[a]) {
                if belongs && !corners.contains(&node) {
                    pairs[NODES].push([node, element]);
                }
            }
        }
        for (edge, belongs) in topology.element_edges[first].into_iter().zip(self.edges[first]) {
            if !belongs {
                continue;
            }
            let [p, q] = topology.edges[edge as usize];
            let others = topology.element_edges[second].into_iter().zip(self.edges[second]);
            for (other, belongs) in others {
                let [r, s] = topology.edges[other as usize];
                if belongs && p != r && p != s && q != r && q != s {
                    pairs[EDGES].push([edge.min(other), edge.max(other)]);
                }
            }
        }
    }

    /// Adds the edges and elements of two elements that can intersect, the edge first.
    pub fn push_intersections(
        &self,
        topology: &Topology,
        pair: [u32; 2],
        pairs: &mut Vec<[u32; 2]>,
    ) {
        for [a, b] in [pair, [pair[1], pair[0]]] {
            let corners = topology.triangles[b as usize];
            let edges = topology.element_edges[a as usize].into_iter();
            for (edge, belongs) in edges.zip(self.edges[a as usize]) {
                let ends = topology.edges[edge as usize];
                if belongs && !ends.iter().any(|node| corners.contains(node)) {
                    pairs.push([edge, b]);
                }
            }
        }
    }
}

/// Calls `visit` with every pair of elements that share a node, once, the lower number first.
pub fn adjacent_elements(topology: &Topology, mut visit: impl FnMut([u32; 2])) {
    let mut at_node: Vec<Vec<u32>> = vec![Vec::new(); topology.nodes()];
    for (element, nodes) in (0..).zip(&topology.triangles) {
        for node in nodes {
            at_node[*node as usize].push(element);
        }
    }
    let mut others = Vec::new();
    for (element, nodes) in (0_u32..).zip(&topology.triangles) {
        others.clear();
        for node in nodes {
            others.extend(at_node[*node as usize].iter().filter(|other| **other > element));
        }
        others.sort_unstable();
        others.dedup();
        for other in &others {
            visit([element, *other]);
        }
    }
}
