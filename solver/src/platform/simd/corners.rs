//! Gather of node values to the corners of kites, and scatter of corner forces back to nodes. All
//! node indices are checked once, when [`Corners`] is built.

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use super::{Vectors, WIDTH, Wide};

/// Nodes at the four corners of kites, eight kites a block.
///
/// Invariant: every index in `blocks` is below `nodes`. The kernels therefore do not check indices again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Corners {
    nodes: usize,
    /// Node of each corner and lane.
    blocks: Vec<[[u32; WIDTH]; 4]>,
    /// For each block, one more than the largest node of it and of all blocks before it; for the last
    /// block, the number of nodes.
    reach: Vec<usize>,
}

impl Corners {
    /// The corners of `kites` over `nodes` nodes. Free lanes of the last block repeat one node, the
    /// first of that block.
    ///
    /// # Panics
    /// When a kite names a node at or above `nodes`.
    pub fn new(kites: &[[u32; 4]], nodes: usize) -> Self {
        assert!(kites.iter().flatten().all(|node| (*node as usize) < nodes), "a node out of range");
        let block = |chunk: &[[u32; 4]]| {
            let node =
                |corner: usize, lane: usize| chunk.get(lane).map_or(chunk[0][0], |t| t[corner]);
            [0, 1, 2, 3].map(|corner| core::array::from_fn(|lane| node(corner, lane)))
        };
        let blocks: Vec<[[u32; WIDTH]; 4]> = kites.chunks(WIDTH).map(block).collect();
        let largest = |block: &[[u32; WIDTH]; 4]| block.iter().flatten().max().map_or(0, |k| *k);
        let mut reach: Vec<usize> = blocks
            .iter()
            .scan(0, |reach, block| {
                *reach = (largest(block) as usize + 1).max(*reach);
                Some(*reach)
            })
            .collect();
        if let Some(last) = reach.last_mut() {
            *last = nodes;
        }
        Self { nodes, blocks, reach }
    }

    /// Sets to zero the sums that `block` is the first to add to. `cleared` of them are zero already;
    /// returns their new number.
    ///
    /// Clearing all sums before the first block would evict them from the cache before their use.
    #[inline(always)]
    pub fn clear_sums(&self, block: usize, cleared: usize, sums: &mut [NodeSum]) -> usize {
        let reach = self.reach[block];
        for sum in &mut sums[cleared..reach] {
            *sum = NodeSum::default();
        }
        reach
    }

    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.blocks.len()
    }
}

/// Three columns over the nodes, with the corners to gather at.
///
/// Invariant: each column is at least as long as `corners.nodes`.
#[derive(Debug, Clone, Copy)]
pub struct Columns<'a> {
    corners: &'a Corners,
    columns: [&'a [f64]; 3],
}

impl<'a> Columns<'a> {
    /// The x, y and z columns of a node quantity.
    ///
    /// # Panics
    /// When a column is shorter than the number of nodes.
    #[inline(always)]
    pub fn new(corners: &'a Corners, columns: [&'a [f64]; 3]) -> Self {
        let [x, y, z] = columns;
        let nodes = corners.nodes;
        let complete = x.len() >= nodes && y.len() >= nodes && z.len() >= nodes;
        assert!(complete, "one value a node");
        Self { corners, columns }
    }

    /// The vectors at the four corners of a block's kites from lane `first` on.
    #[inline(always)]
    pub fn corners<L: Wide>(&self, block: usize, first: usize) -> [Vectors<L>; 4] {
        let [a, b, c, d] = &self.corners.blocks[block];
        [
            self.gather(&a[first..]),
            self.gather(&b[first..]),
            self.gather(&c[first..]),
            self.gather(&d[first..]),
        ]
    }

    /// The vectors at the first of these nodes of `self.corners`.
    #[inline(always)]
    #[expect(
        unsafe_code,
        reason = "indices are checked in `Corners::new`, columns in `Columns::new`"
    )]
    fn gather<L: Wide>(&self, nodes: &[u32]) -> Vectors<L> {
        let nodes = &nodes[..L::COUNT];
        let [x, y, z] = self.columns;
        // SAFETY: `corners` alone calls this, with nodes of `self.corners`: each is below its number of
        // nodes, which is at most the length of each column (both invariants).
        unsafe {
            Vectors { x: L::gather(x, nodes), y: L::gather(y, nodes), z: L::gather(z, nodes) }
        }
    }
}

/// The nodes of a group of elements from `start` on, one list for each corner, and the number of elements in it. Lanes
/// past the last element repeat the first one of the group.
#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "an iterator is not inlined into a target feature")]
pub fn nodes_of(triangles: &[[u32; 3]], start: usize) -> ([[u32; WIDTH]; 3], usize) {
    let count = if triangles.len() - start < WIDTH { triangles.len() - start } else { WIDTH };
    let mut nodes = [[0; WIDTH]; 3];
    for lane in 0..WIDTH {
        let corners = triangles[start + if lane < count { lane } else { 0 }];
        for k in 0..3 {
            nodes[k][lane] = corners[k];
        }
    }
    (nodes, count)
}

/// The vectors at these indices of three columns.
///
/// # Panics
/// When an index is not below the length of every column.
#[inline(always)]
#[expect(unsafe_code, reason = "indices are checked here")]
pub fn vectors_at<L: Wide>([x, y, z]: [&[f64]; 3], indices: &[u32; WIDTH]) -> Vectors<L> {
    let mut last = 0;
    for index in indices {
        last = if *index > last { *index } else { last };
    }
    let last = last as usize;
    assert!(last < x.len() && last < y.len() && last < z.len(), "an index out of range");
    // SAFETY: `last`, the largest index, is below the length of each column.
    unsafe {
        Vectors { x: L::gather(x, indices), y: L::gather(y, indices), z: L::gather(z, indices) }
    }
}

/// Sums over the elements at a node, in one cache line. Entries 0 to 2 are x, y, z; entry 3 is padding
/// without meaning.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C, align(64))]
pub struct NodeSum {
    /// Internal force of the film, N.
    pub film: [f64; 4],
    /// Sum of the element normals (x1 − x0) × (x2 − x0), which is 6 ∂V/∂x, m².
    pub normal: [f64; 4],
}

impl NodeSum {
    /// Adds another sum entry by entry.
    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        for k in 0..4 {
            self.film[k] += other.film[k];
        }
        for k in 0..4 {
            self.normal[k] += other.normal[k];
        }
    }
}

impl Corners {
    /// Adds the forces and normals of a block's kites, from a lane on, to their corners s, a, t, b: kite by kite, and
    /// for each kite corner by corner. `film` holds the forces on the four corners. Corners s and t
    /// receive the normal of the whole kite, a that of the first element, b that of the second.
    ///
    /// # Panics
    /// When there are fewer sums than nodes.
    #[inline(always)]
    #[expect(unsafe_code, reason = "indices are checked in `Corners::new`, the sums here")]
    pub fn scatter<L: Wide>(
        &self,
        (block, first_lane): (usize, usize),
        film: &[Vectors<L>; 4],
        [whole, first, second]: &[Vectors<L>; 3],
        sums: &mut [NodeSum],
    ) {
        assert!(sums.len() >= self.nodes, "one sum a node");
        let rows = [
            L::to_node_sums(&film[0], whole),
            L::to_node_sums(&film[1], first),
            L::to_node_sums(&film[2], whole),
            L::to_node_sums(&film[3], second),
        ];
        let nodes = &self.blocks[block];
        for lane in 0..L::COUNT {
            for corner in 0..4 {
                // SAFETY: every node is below `self.nodes` (invariant), and `sums` has at least as many
                // entries (asserted above).
                let sum =
                    unsafe { sums.get_unchecked_mut(nodes[corner][first_lane + lane] as usize) };
                sum.add(&rows[corner][lane]);
            }
        }
    }
}
