//! An order of the film's elements in which neighbours on the film are near.
//!
//! The film is halved again and again: from an element far from all others of its part, outward
//! over shared edges; the first half of what is met so is one part, the rest the other. Whatever the
//! film does later, a part stays a patch of it.

use std::collections::VecDeque;

/// The order of elements whose sides (edges) these are; `edges`: how many there are. Parts are not
/// halved below `patch` elements.
pub fn of_elements(sides: &[[u32; 3]], edges: usize, patch: usize) -> Vec<u32> {
    let mut at_edge: Vec<Vec<u32>> = vec![Vec::new(); edges];
    for (element, own) in (0_u32..).zip(sides) {
        for side in own {
            at_edge[*side as usize].push(element);
        }
    }
    let mut walk = Walk { sides, at_edge, part: vec![0; sides.len()], met: Vec::new() };
    let mut order: Vec<u32> = (0_u32..).take(sides.len()).collect();
    // Parts yet to be halved: where they start and end in the order; each has a number of its own.
    let mut later = vec![(0, order.len())];
    let mut number = 0;
    while let Some((from, to)) = later.pop() {
        if to - from <= patch {
            continue;
        }
        number += 1;
        let own = &mut order[from..to];
        for element in own.iter() {
            walk.part[*element as usize] = number;
        }
        walk.outward(own);
        let far = own[own.len() - 1];
        let start = own.iter().position(|element| *element == far).unwrap_or(0);
        own.swap(0, start);
        walk.outward(own);
        // The halves are filled up to whole patches, so that leaves of a tree are patches.
        let middle = from + (to - from).next_power_of_two() / 2;
        later.extend([(from, middle), (middle, to)]);
    }
    order
}

struct Walk<'a> {
    sides: &'a [[u32; 3]],
    at_edge: Vec<Vec<u32>>,
    /// Part each element is in now.
    part: Vec<u32>,
    met: Vec<bool>,
}

impl Walk<'_> {
    /// Puts the elements of one part in the order in which a walk outward from its first meets them; of
    /// pieces that hang together nowhere one after the other.
    fn outward(&mut self, own: &mut [u32]) {
        self.met.resize(self.sides.len(), false);
        let part = self.part[own[0] as usize];
        let mut found = Vec::with_capacity(own.len());
        let mut queue = VecDeque::new();
        for start in own.iter() {
            if core::mem::replace(&mut self.met[*start as usize], true) {
                continue;
            }
            queue.push_back(*start);
            while let Some(element) = queue.pop_front() {
                found.push(element);
                for side in self.sides[element as usize] {
                    for next in &self.at_edge[side as usize] {
                        let at = *next as usize;
                        if self.part[at] == part && !core::mem::replace(&mut self.met[at], true) {
                            queue.push_back(*next);
                        }
                    }
                }
            }
        }
        for element in &found {
            self.met[*element as usize] = false;
        }
        own.copy_from_slice(&found);
    }
}

#[cfg(test)]
mod tests {
    use crate::collision::contact::topology::Topology;

    #[test]
    fn every_element_comes_once_and_patches_hang_together() {
        let at = |i: u32, j: u32| j * 9 + i;
        let mut triangles = Vec::new();
        for j in 0..8 {
            for i in 0..8 {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        // Shuffled, so that numbers say nothing.
        let shuffled: Vec<_> = (0..128).map(|k| triangles[k * 37 % 128]).collect();
        let topology = Topology::new(81, &shuffled);
        let order = super::of_elements(&topology.sides, topology.edges.len(), 4);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..128));
        // Sixteen elements of a patch, eight cells' worth, lie within a few cells.
        for patch in order.chunks(16) {
            let nodes = patch.iter().flat_map(|element| shuffled[*element as usize]);
            let (columns, rows): (Vec<u32>, Vec<u32>) =
                nodes.map(|node| (node % 9, node / 9)).unzip();
            let span = |of: &[u32]| of.iter().max().unwrap() - of.iter().min().unwrap();
            assert!(span(&columns) * span(&rows) <= 36, "{columns:?} {rows:?}");
        }
    }
}
