//! An order of the elements in which neighbours on the film have nearby positions in the order.
//!
//! The mesh is bisected recursively. Each part is traversed breadth-first over shared edges, from an
//! element far from the others; the first half of the traversal is one child, the rest is the other.
//! The order depends on connectivity alone, so it stays useful however the film folds.

use std::collections::VecDeque;

/// The order of elements with these edges; `edges` is the number of edges. Parts of at most
/// `max_part_size` elements are not bisected further.
pub fn element_order(element_edges: &[[u32; 3]], edges: usize, max_part_size: usize) -> Vec<u32> {
    let mut elements_at_edge: Vec<Vec<u32>> = vec![Vec::new(); edges];
    for (element, edges) in (0_u32..).zip(element_edges) {
        for edge in edges {
            elements_at_edge[*edge as usize].push(element);
        }
    }
    let mut traversal = Traversal {
        element_edges,
        elements_at_edge,
        part_of_element: vec![0; element_edges.len()],
        visited: Vec::new(),
    };
    let mut order: Vec<u32> = (0_u32..).take(element_edges.len()).collect();
    // Parts to bisect, as ranges of the order. Each part gets a new number.
    let mut pending = vec![(0, order.len())];
    let mut part_number = 0;
    while let Some((start, end)) = pending.pop() {
        if end - start <= max_part_size {
            continue;
        }
        part_number += 1;
        let part = &mut order[start..end];
        for element in part.iter() {
            traversal.part_of_element[*element as usize] = part_number;
        }
        // The last element of a traversal is far from its first one: start again from there.
        traversal.sort_breadth_first(part);
        let farthest = part[part.len() - 1];
        let seed = part.iter().position(|element| *element == farthest).unwrap_or(0);
        part.swap(0, seed);
        traversal.sort_breadth_first(part);
        // The first half has a power of two of elements, so that halves are subtrees of the hierarchy.
        let middle = start + (end - start).next_power_of_two() / 2;
        pending.extend([(start, middle), (middle, end)]);
    }
    order
}

/// Breadth-first traversal within one part.
struct Traversal<'a> {
    element_edges: &'a [[u32; 3]],
    elements_at_edge: Vec<Vec<u32>>,
    /// Number of the part that contains each element.
    part_of_element: Vec<u32>,
    visited: Vec<bool>,
}

impl Traversal<'_> {
    /// Sorts the elements of one part breadth-first from its first element. Components that are not
    /// connected follow one after the other.
    fn sort_breadth_first(&mut self, part: &mut [u32]) {
        self.visited.resize(self.element_edges.len(), false);
        let part_number = self.part_of_element[part[0] as usize];
        let mut sorted = Vec::with_capacity(part.len());
        let mut queue = VecDeque::new();
        for seed in part.iter() {
            if core::mem::replace(&mut self.visited[*seed as usize], true) {
                continue;
            }
            queue.push_back(*seed);
            while let Some(element) = queue.pop_front() {
                sorted.push(element);
                for edge in self.element_edges[element as usize] {
                    for neighbour in &self.elements_at_edge[edge as usize] {
                        let index = *neighbour as usize;
                        if self.part_of_element[index] == part_number
                            && !core::mem::replace(&mut self.visited[index], true)
                        {
                            queue.push_back(*neighbour);
                        }
                    }
                }
            }
        }
        for element in &sorted {
            self.visited[*element as usize] = false;
        }
        part.copy_from_slice(&sorted);
    }
}

#[cfg(test)]
mod tests {
    use crate::geometry::topology::Topology;

    #[test]
    fn the_order_is_a_permutation_and_its_blocks_are_compact() {
        let node = |i: u32, j: u32| j * 9 + i;
        let mut triangles = Vec::new();
        for j in 0..8 {
            for i in 0..8 {
                let [a, b, c, d] = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        // Shuffled, so that element numbers carry no information.
        let shuffled: Vec<_> = (0..128).map(|k| triangles[k * 37 % 128]).collect();
        let topology = Topology::new(81, &shuffled);
        let order = super::element_order(&topology.element_edges, topology.edges.len(), 4);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..128));
        // The sixteen elements of a block fill eight cells; they span few rows and columns.
        for block in order.chunks(16) {
            let nodes = block.iter().flat_map(|element| shuffled[*element as usize]);
            let (columns, rows): (Vec<u32>, Vec<u32>) =
                nodes.map(|node| (node % 9, node / 9)).unzip();
            let span = |of: &[u32]| of.iter().max().unwrap() - of.iter().min().unwrap();
            assert!(span(&columns) * span(&rows) <= 36, "{columns:?} {rows:?}");
        }
    }
}
