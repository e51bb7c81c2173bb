//! From nodes to elements and back: gathers and sums, checked once.

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use super::{Vectors, WIDTH, Wide};

/// The corners of elements, eight elements a block, checked once to lie within a number of nodes so
/// that a kernel need not check them again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Corners {
    nodes: usize,
    blocks: Vec<[[u32; WIDTH]; 3]>,
}

impl Corners {
    /// The corners of these triangles over `nodes` nodes; the last block is filled up with triangles of
    /// one node thrice.
    ///
    /// # Panics
    /// When a triangle names a node that is not there.
    pub fn new(triangles: &[[u32; 3]], nodes: usize) -> Self {
        assert!(triangles.iter().flatten().all(|node| (*node as usize) < nodes), "nodes there are");
        assert!(nodes <= 1 << 31, "at most 2^31 nodes");
        let block = |chunk: &[[u32; 3]]| {
            let node =
                |corner: usize, lane: usize| chunk.get(lane).map_or(chunk[0][0], |t| t[corner]);
            [0, 1, 2].map(|corner| core::array::from_fn(|lane| node(corner, lane)))
        };
        Self { nodes, blocks: triangles.chunks(WIDTH).map(block).collect() }
    }

    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.blocks.len()
    }

    /// The nodes of one corner of a block's elements.
    pub fn nodes(&self, block: usize, corner: usize) -> &[u32; WIDTH] {
        &self.blocks[block][corner]
    }

    /// Three columns over the nodes, at one corner of a block's elements.
    ///
    /// # Panics
    /// When a column is shorter than there are nodes.
    #[inline(always)]
    #[expect(unsafe_code, reason = "places are checked when `Corners` is made, columns here")]
    pub fn gather<L: Wide>(
        &self,
        block: usize,
        corner: usize,
        [x, y, z]: [&[f64]; 3],
    ) -> Vectors<L> {
        let whole = x.len() >= self.nodes && y.len() >= self.nodes && z.len() >= self.nodes;
        assert!(whole, "one value a node");
        let at = &self.blocks[block][corner];
        // SAFETY: every node is below `self.nodes`, which is at most 2^31, and so are the columns long.
        unsafe { Vectors { x: L::gather(x, at), y: L::gather(y, at), z: L::gather(z, at) } }
    }
}

/// The vectors at these places of three columns of one length.
///
/// # Panics
/// When a place is beyond the columns, or 2^31 or more.
#[inline(always)]
#[expect(unsafe_code, reason = "places are checked here")]
pub fn vectors_at<L: Wide>([x, y, z]: [&[f64]; 3], at: &[u32; WIDTH]) -> Vectors<L> {
    let mut last = 0;
    for place in at {
        last = if *place > last { *place } else { last };
    }
    let last = last as usize;
    assert!(last < x.len() && last < y.len() && last < z.len(), "one value a place");
    assert!(last < 1 << 31, "below 2^31");
    // SAFETY: every place is below 2^31 and the length of the columns.
    unsafe { Vectors { x: L::gather(x, at), y: L::gather(y, at), z: L::gather(z, at) } }
}

/// A node's sums over its elements, in one line of the cache: x, y, z and a number without meaning.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(align(64))]
pub struct NodeSum {
    /// Force of the film, N.
    pub film: [f64; 4],
    /// ∂V/∂x, m².
    pub area: [f64; 4],
}

impl NodeSum {
    /// Adds another.
    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        for k in 0..4 {
            self.film[k] += other.film[k];
        }
        for k in 0..4 {
            self.area[k] += other.area[k];
        }
    }
}

impl Corners {
    /// Adds what each element of a block gives to its corners, element by element and for each corner
    /// by corner: the force on that corner, and one area for all three.
    ///
    /// # Panics
    /// When there are fewer sums than nodes.
    #[inline(always)]
    #[expect(unsafe_code, reason = "nodes are checked when `Corners` is made, sums here")]
    pub fn scatter<L: Wide>(
        &self,
        block: usize,
        film: &[Vectors<L>; 3],
        area: &Vectors<L>,
        sums: &mut [NodeSum],
    ) {
        assert!(sums.len() >= self.nodes, "one sum a node");
        let rows = [L::rows(&film[0], area), L::rows(&film[1], area), L::rows(&film[2], area)];
        let nodes = &self.blocks[block];
        for lane in 0..WIDTH {
            for corner in 0..3 {
                // SAFETY: every node is below `self.nodes`, and there are as many sums.
                let sum = unsafe { sums.get_unchecked_mut(nodes[corner][lane] as usize) };
                sum.add(&rows[corner][lane]);
            }
        }
    }
}
