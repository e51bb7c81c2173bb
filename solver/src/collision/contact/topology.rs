//! What borders on what: edges, and how many elements meet at each edge and node.

use std::collections::BTreeMap;

use crate::collision::broad_phase::adjacent::AdjacentPairs;
use crate::collision::broad_phase::hierarchy::Hierarchy;
use crate::collision::broad_phase::scheduler::QueryKind;

/// A feature of the film a node can be nearest to.
pub type Feature = u32;

/// Borders of a film's elements: constant.
#[derive(Debug, Clone, PartialEq)]
pub struct Topology {
    /// Nodes of each element.
    pub triangles: Vec<[u32; 3]>,
    /// Nodes of each edge, the lower first.
    pub edges: Vec<[u32; 2]>,
    /// Edges of each element: between its nodes 0-1, 1-2, 2-0.
    pub sides: Vec<[u32; 3]>,
    /// The film in patches of neighbours.
    pub patches: Hierarchy,
    /// Pairs of elements that share a node, by what is sought of them.
    stars: [AdjacentPairs; 2],
    /// Elements at each edge.
    at_edge: Vec<u32>,
    /// Elements at each node.
    at_node: Vec<u32>,
}

/// A place in a list as the elements count, in 32 bits.
fn index(at: usize) -> u32 {
    u32::try_from(at).expect("under 2^32")
}

impl Topology {
    /// The borders of these elements over `nodes` nodes.
    pub fn new(nodes: usize, triangles: &[[u32; 3]]) -> Self {
        let mut numbers = BTreeMap::new();
        for &[a, b, c] in triangles {
            for [p, q] in [[a, b], [b, c], [c, a]] {
                numbers.insert([p.min(q), p.max(q)], 0_u32);
            }
        }
        for (number, own) in (0..).zip(numbers.values_mut()) {
            *own = number;
        }
        let edges: Vec<[u32; 2]> = numbers.keys().copied().collect();
        let (mut at_edge, mut at_node) = (vec![0; edges.len()], vec![0; nodes]);
        let sides: Vec<[u32; 3]> = triangles
            .iter()
            .map(|&[a, b, c]| {
                for node in [a, b, c] {
                    at_node[node as usize] += 1;
                }
                [[a, b], [b, c], [c, a]].map(|[p, q]| {
                    let side = numbers[&[p.min(q), p.max(q)]];
                    at_edge[side as usize] += 1;
                    side
                })
            })
            .collect();
        let patches = Hierarchy::new(nodes, triangles, &sides, edges.len());
        let stars = [QueryKind::Collision, QueryKind::Intersection]
            .map(|sought| AdjacentPairs::new(sought, nodes, &patches));
        Self { triangles: triangles.to_vec(), edges, sides, patches, stars, at_edge, at_node }
    }

    /// Pairs of elements that share a node, and what is sought of them.
    pub fn stars(&self, sought: QueryKind) -> &AdjacentPairs {
        match sought {
            QueryKind::Collision => &self.stars[0],
            QueryKind::Intersection => &self.stars[1],
        }
    }

    /// The feature of an element that a closest point with these weights (of its three nodes; nought
    /// where exactly nought) lies on: an element, an edge or a node.
    pub fn feature(&self, element: u32, weights: [f64; 3]) -> Feature {
        let on = weights.map(|weight| weight != 0.0);
        let faces = index(self.triangles.len());
        let own = element as usize;
        match on {
            [true, true, false] => faces + self.sides[own][0],
            [false, true, true] => faces + self.sides[own][1],
            [true, false, true] => faces + self.sides[own][2],
            [true, false, false] => self.node_feature(self.triangles[own][0]),
            [false, true, false] => self.node_feature(self.triangles[own][1]),
            [false, false, true] => self.node_feature(self.triangles[own][2]),
            _ => element,
        }
    }

    fn node_feature(&self, node: u32) -> Feature {
        index(self.triangles.len() + self.edges.len()) + node
    }

    /// Elements that have this feature.
    pub fn elements_at(&self, feature: Feature) -> u32 {
        let (faces, edges) = (self.triangles.len(), self.edges.len());
        let feature = feature as usize;
        if feature < faces {
            1
        } else if feature < faces + edges {
            self.at_edge[feature - faces]
        } else {
            self.at_node[feature - faces - edges]
        }
    }

    /// Nodes of a feature: three, two or one, filled up with the last.
    fn nodes_of(&self, feature: Feature) -> [u32; 3] {
        let (faces, edges) = (self.triangles.len(), self.edges.len());
        let own = feature as usize;
        if own < faces {
            self.triangles[own]
        } else if own < faces + edges {
            let [a, b] = self.edges[own - faces];
            [a, b, b]
        } else {
            [index(own - faces - edges); 3]
        }
    }

    /// Whether two features share a node.
    pub fn border(&self, a: Feature, b: Feature) -> bool {
        let b = self.nodes_of(b);
        self.nodes_of(a).iter().any(|node| b.contains(node))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_of_two_triangles() {
        let topology = Topology::new(4, &[[0, 1, 2], [2, 1, 3]]);
        assert_eq!(topology.edges, [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]);
        assert_eq!(topology.feature(0, [0.2, 0.3, 0.5]), 0);
        let shared = topology.feature(0, [0.0, 0.3, 0.7]);
        assert_eq!(shared, topology.feature(1, [0.7, 0.3, 0.0]));
        assert_eq!(topology.elements_at(shared), 2);
        let corner = topology.feature(1, [0.0, 0.0, 1.0]);
        assert_eq!(topology.elements_at(corner), 1);
        assert!(topology.border(shared, 0) && topology.border(corner, 1));
        assert!(!topology.border(corner, 0));
    }
}
