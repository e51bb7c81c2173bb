//! In which order unknowns are eliminated: nested dissection of the nodes by their places.
//!
//! A set of nodes is cut at the median of a coordinate; the nodes on one side that have neighbours
//! on the other separate the rest into two sets that share no element. Of three coordinates the one
//! with the fewest separating nodes is taken. Separators are eliminated after what they separate:
//! on a surface of n nodes the factor then has O(n log n) entries (A. George, "Nested dissection of
//! a regular finite element mesh", 1973).

use crate::geometry::field::Field;

/// One set of nodes eliminated together, with the sets it separates.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Separator {
    /// Nodes, in ascending order.
    pub nodes: Vec<u32>,
    /// Indices of the sets below it, all smaller than its own.
    pub children: Vec<usize>,
}

/// Nodes of a set that is cut no further.
const LEAF: usize = 12;

/// Separators of these nodes, children before parents; the last is the root.
pub fn dissect(nodes: Vec<u32>, neighbours: &[Vec<u32>], places: &Field) -> Vec<Separator> {
    let mut tree = Vec::new();
    let mut side = vec![0_u8; neighbours.len()];
    cut(nodes, neighbours, places, &mut side, &mut tree);
    tree
}

fn cut(
    mut nodes: Vec<u32>,
    neighbours: &[Vec<u32>],
    places: &Field,
    side: &mut [u8],
    tree: &mut Vec<Separator>,
) -> usize {
    if nodes.len() > LEAF {
        let cuts = [&places.x, &places.y, &places.z]
            .map(|axis| halves(&mut nodes, axis, neighbours, side));
        let best = cuts.into_iter().min_by_key(|[_, _, between]| between.len());
        if let Some([low, high, between]) = best
            && !low.is_empty()
        {
            let children =
                [low, high].map(|half| cut(half, neighbours, places, side, tree)).to_vec();
            tree.push(Separator { nodes: between, children });
            return tree.len() - 1;
        }
    }
    nodes.sort_unstable();
    tree.push(Separator { nodes, children: Vec::new() });
    tree.len() - 1
}

/// The two sides of a cut across an axis, and what separates them.
fn halves(
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
    let beside = |node: &u32| neighbours[*node as usize].iter().any(|n| side[*n as usize] == 1);
    let (mut between, rest): (Vec<u32>, Vec<u32>) = low.iter().partition(|node| beside(node));
    between.sort_unstable();
    let high = high.to_vec();
    for node in &high {
        side[*node as usize] = 0;
    }
    [rest, high, between]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_separator_separates_has_no_common_edge() {
        let (wide, high) = (23_u32, 17_u32);
        let mut places = Field::zeros((wide * high) as usize);
        let mut neighbours = vec![Vec::new(); places.len()];
        for j in 0..high {
            for i in 0..wide {
                let node = (j * wide + i) as usize;
                places.x[node] = f64::from(i);
                places.y[node] = f64::from(j);
                for (k, l) in [(i + 1, j), (i, j + 1), (i + 1, j + 1)] {
                    if k < wide && l < high {
                        neighbours[node].push(l * wide + k);
                        neighbours[(l * wide + k) as usize].push(j * wide + i);
                    }
                }
            }
        }
        let tree = dissect((0..wide * high).collect(), &neighbours, &places);
        // Every node once, and an edge only within a set or with one above it.
        let mut set = vec![usize::MAX; places.len()];
        for (index, own) in tree.iter().enumerate() {
            for node in &own.nodes {
                assert_eq!(set[*node as usize], usize::MAX);
                set[*node as usize] = index;
            }
        }
        let mut parent = vec![usize::MAX; tree.len()];
        for (index, own) in tree.iter().enumerate() {
            own.children.iter().for_each(|child| parent[*child] = index);
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
