//! Topology of a triangle mesh: its edges, and the features a closest point can lie on.
//!
//! A feature is an element, an edge or a node. Features have consecutive numbers: first the
//! elements, then the edges, then the nodes.

use std::collections::{BTreeMap, BTreeSet};

/// Number of an element, edge or node among all features of a mesh.
pub type Feature = u32;

/// Edges and incidences of a triangle mesh; constant.
#[derive(Debug, Clone, PartialEq)]
pub struct Topology {
    /// Nodes of each element.
    pub triangles: Vec<[u32; 3]>,
    /// Nodes of each edge, the lower number first.
    pub edges: Vec<[u32; 2]>,
    /// Edges of each element: between its nodes 0-1, 1-2, 2-0.
    pub element_edges: Vec<[u32; 3]>,
    /// Number of elements at each edge.
    elements_at_edge: Vec<u32>,
    /// Number of elements at each node.
    elements_at_node: Vec<u32>,
    ignored: Ignored,
}

/// Pairs of film that nothing tests: those of elements that touch or cross at the start.
#[derive(Debug, Clone, PartialEq, Default)]
struct Ignored {
    node_elements: BTreeSet<[u32; 2]>,
    edge_elements: BTreeSet<[u32; 2]>,
    edges: BTreeSet<[u32; 2]>,
}

/// An index in the 32 bits that elements use.
fn index(value: usize) -> u32 {
    u32::try_from(value).expect("under 2^32")
}

impl Topology {
    /// The topology of `triangles` over `nodes` nodes. Edges are numbered in the order of their
    /// nodes.
    pub fn new(nodes: usize, triangles: &[[u32; 3]]) -> Self {
        let mut numbers = BTreeMap::new();
        for &[a, b, c] in triangles {
            for [p, q] in [[a, b], [b, c], [c, a]] {
                numbers.insert([p.min(q), p.max(q)], 0_u32);
            }
        }
        for (next, number) in (0..).zip(numbers.values_mut()) {
            *number = next;
        }
        let edges: Vec<[u32; 2]> = numbers.keys().copied().collect();
        let mut elements_at_edge = vec![0; edges.len()];
        let mut elements_at_node = vec![0; nodes];
        let element_edges: Vec<[u32; 3]> = triangles
            .iter()
            .map(|&[a, b, c]| {
                for node in [a, b, c] {
                    elements_at_node[node as usize] += 1;
                }
                [[a, b], [b, c], [c, a]].map(|[p, q]| {
                    let edge = numbers[&[p.min(q), p.max(q)]];
                    elements_at_edge[edge as usize] += 1;
                    edge
                })
            })
            .collect();
        Self {
            triangles: triangles.to_vec(),
            edges,
            element_edges,
            elements_at_edge,
            elements_at_node,
            ignored: Ignored::default(),
        }
    }

    /// Has every pair of a node, an edge or an element of one element with one of another ignored, for these pairs of
    /// elements.
    pub fn ignore(&mut self, pairs: &[[u32; 2]]) {
        for [a, b] in pairs {
            for [a, b] in [[*a, *b], [*b, *a]] {
                let (edges, other) =
                    (self.element_edges[a as usize], self.element_edges[b as usize]);
                self.ignored.node_elements.extend(self.triangles[a as usize].map(|node| [node, b]));
                self.ignored.edge_elements.extend(edges.map(|edge| [edge, b]));
                let of_edge = |edge: u32| other.map(|other| [edge, other]);
                self.ignored.edges.extend(edges.iter().flat_map(|edge| of_edge(*edge)));
            }
        }
    }

    /// Whether any pair is ignored.
    pub fn has_ignored(&self) -> bool {
        !self.ignored.edges.is_empty()
    }

    /// Whether a node and an element are ignored.
    pub fn ignores_node(&self, node: u32, element: u32) -> bool {
        self.has_ignored() && self.ignored.node_elements.contains(&[node, element])
    }

    /// Whether two edges are ignored.
    pub fn ignores_edges(&self, a: u32, b: u32) -> bool {
        self.has_ignored() && self.ignored.edges.contains(&[a, b])
    }

    /// Whether an edge and an element are ignored.
    pub fn ignores_edge(&self, edge: u32, element: u32) -> bool {
        self.has_ignored() && self.ignored.edge_elements.contains(&[edge, element])
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.elements_at_node.len()
    }

    /// The feature of `element` that a closest point lies on. `weights` are the point's barycentric
    /// coordinates in the element; a coordinate counts as zero only if it is exactly zero.
    pub fn feature(&self, element: u32, weights: [f64; 3]) -> Feature {
        let nonzero = weights.map(|weight| weight != 0.0);
        let elements = index(self.triangles.len());
        let (nodes, edges) =
            (self.triangles[element as usize], self.element_edges[element as usize]);
        match nonzero {
            [true, true, false] => elements + edges[0],
            [false, true, true] => elements + edges[1],
            [true, false, true] => elements + edges[2],
            [true, false, false] => self.node_feature(nodes[0]),
            [false, true, false] => self.node_feature(nodes[1]),
            [false, false, true] => self.node_feature(nodes[2]),
            _ => element,
        }
    }

    fn node_feature(&self, node: u32) -> Feature {
        index(self.triangles.len() + self.edges.len()) + node
    }

    /// Number of elements that contain a feature.
    pub fn elements_at(&self, feature: Feature) -> u32 {
        let (elements, edges) = (self.triangles.len(), self.edges.len());
        let feature = feature as usize;
        if feature < elements {
            1
        } else if feature < elements + edges {
            self.elements_at_edge[feature - elements]
        } else {
            self.elements_at_node[feature - elements - edges]
        }
    }

    /// Nodes of a feature: three, two or one, the last one repeated to three entries.
    fn nodes_of(&self, feature: Feature) -> [u32; 3] {
        let (elements, edges) = (self.triangles.len(), self.edges.len());
        let feature = feature as usize;
        if feature < elements {
            self.triangles[feature]
        } else if feature < elements + edges {
            let [a, b] = self.edges[feature - elements];
            [a, b, b]
        } else {
            [index(feature - elements - edges); 3]
        }
    }

    /// Whether two features share a node.
    pub fn share_node(&self, a: Feature, b: Feature) -> bool {
        let nodes_of_b = self.nodes_of(b);
        self.nodes_of(a).iter().any(|node| nodes_of_b.contains(node))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_share_the_feature_of_their_common_edge() {
        let topology = Topology::new(4, &[[0, 1, 2], [2, 1, 3]]);
        assert_eq!(topology.edges, [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]);
        assert_eq!(topology.feature(0, [0.2, 0.3, 0.5]), 0);
        let shared = topology.feature(0, [0.0, 0.3, 0.7]);
        assert_eq!(shared, topology.feature(1, [0.7, 0.3, 0.0]));
        assert_eq!(topology.elements_at(shared), 2);
        let corner = topology.feature(1, [0.0, 0.0, 1.0]);
        assert_eq!(topology.elements_at(corner), 1);
        assert!(topology.share_node(shared, 0) && topology.share_node(corner, 1));
        assert!(!topology.share_node(corner, 0));
    }
}
