//! Order of elimination: nested dissection of the nodes by their positions.
//!
//! The algorithm cuts a set of nodes at the median of a coordinate. The nodes of one side that have
//! neighbours on the other side are the separator: without them the two sides share no element. Of the
//! three coordinates it takes the one with the smallest separator. A separator is eliminated after the
//! two sides, so the factor of a surface with n nodes has O(n log n) entries (A. George, "Nested
//! dissection of a regular finite element mesh", 1973).

use crate::geometry::field::Field;

/// A set of nodes eliminated together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Separator {
    /// Nodes, ascending.
    pub nodes: Vec<u32>,
    /// Indices of the sets it separates, all smaller than its own index.
    pub children: Vec<usize>,
}

/// Largest number of nodes of a set that is not cut. Chosen.
const MAX_LEAF_NODES: usize = 12;

/// The separators of these nodes, children before parents; the last is the root.
pub fn dissect(nodes: Vec<u32>, neighbours: &[Vec<u32>], positions: &Field) -> Vec<Separator> {
    let mut tree = Vec::new();
    let mut side = vec![0_u8; neighbours.len()];
    dissect_set(nodes, neighbours, positions, &mut side, &mut tree);
    tree
}

/// Dissects a set and appends its separators to `tree`; returns the index of its root.
fn dissect_set(
    mut nodes: Vec<u32>,
    neighbours: &[Vec<u32>],
    positions: &Field,
    side: &mut [u8],
    tree: &mut Vec<Separator>,
) -> usize {
    if nodes.len() > MAX_LEAF_NODES {
        let cuts = [&positions.x, &positions.y, &positions.z]
            .map(|axis| split(&mut nodes, axis, neighbours, side));
        let best = cuts.into_iter().min_by_key(|[_, _, separator]| separator.len());
        if let Some([low, high, separator]) = best
            && !low.is_empty()
        {
            let children = [low, high]
                .map(|half| dissect_set(half, neighbours, positions, side, tree))
                .to_vec();
            tree.push(Separator { nodes: separator, children });
            return tree.len() - 1;
        }
    }
    nodes.sort_unstable();
    tree.push(Separator { nodes, children: Vec::new() });
    tree.len() - 1
}

/// Splits a set at the median of an axis: lower side without separator, upper side, separator.
fn split(
    nodes: &mut [u32],
    axis: &[f64],
    neighbours: &[Vec<u32>],
    side: &mut [u8],
) -> [Vec<u32>; 3] {
    nodes.sort_unstable_by(|a, b| {
        axis[*a as usize].total_cmp(&axis[*b as usize]).then_with(|| a.cmp(b))
    });
    let (low, high) = nodes.split_at(nodes.len() / 2);
    for node in high {
        side[*node as usize] = 1;
    }
    let borders_high =
        |node: &u32| neighbours[*node as usize].iter().any(|n| side[*n as usize] == 1);
    let (mut separator, rest): (Vec<u32>, Vec<u32>) =
        low.iter().partition(|node| borders_high(node));
    separator.sort_unstable();
    let high = high.to_vec();
    for node in &high {
        side[*node as usize] = 0;
    }
    [rest, high, separator]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separated_sets_share_no_edge() {
        let (wide, high) = (23_u32, 17_u32);
        let mut positions = Field::zeros((wide * high) as usize);
        let mut neighbours = vec![Vec::new(); positions.len()];
        for j in 0..high {
            for i in 0..wide {
                let node = (j * wide + i) as usize;
                positions.x[node] = f64::from(i);
                positions.y[node] = f64::from(j);
                for (k, l) in [(i + 1, j), (i, j + 1), (i + 1, j + 1)] {
                    if k < wide && l < high {
                        neighbours[node].push(l * wide + k);
                        neighbours[(l * wide + k) as usize].push(j * wide + i);
                    }
                }
            }
        }
        let tree = dissect((0..wide * high).collect(), &neighbours, &positions);
        // Every node once, and an edge only within a set or with one above it.
        let mut set = vec![usize::MAX; positions.len()];
        for (index, separator) in tree.iter().enumerate() {
            for node in &separator.nodes {
                assert_eq!(set[*node as usize], usize::MAX);
                set[*node as usize] = index;
            }
        }
        let mut parent = vec![usize::MAX; tree.len()];
        for (index, separator) in tree.iter().enumerate() {
            separator.children.iter().for_each(|child| parent[*child] = index);
        }
        let above = |mut low: usize, high: usize| {
            while low < high {
                low = parent[low];
            }
            low == high
        };
        for (node, others) in neighbours.iter().enumerate() {
            for other in others {
                let (a, b) = (set[node], set[*other as usize]);
                assert!(above(a.min(b), a.max(b)), "{node} {other}");
            }
        }
        assert!(tree.last().unwrap().nodes.len() <= high as usize + 1);
    }
}
