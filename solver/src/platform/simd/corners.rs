//! From nodes to elements and back: gathers and sums, checked once.

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use super::{Vectors, WIDTH, Wide};

/// The four corners of kites, eight kites a block, checked once to lie within a number of nodes so that
/// a kernel need not check them again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Corners {
    nodes: usize,
    blocks: Vec<[[u32; WIDTH]; 4]>,
    /// Nodes up to the farthest of each block and of those before it; of the last, all.
    reach: Vec<usize>,
}

impl Corners {
    /// The corners of these kites over `nodes` nodes; the last block is filled up with kites of one node
    /// alone.
    ///
    /// # Panics
    /// When a kite names a node that is not there.
    pub fn new(kites: &[[u32; 4]], nodes: usize) -> Self {
        assert!(kites.iter().flatten().all(|node| (*node as usize) < nodes), "nodes there are");
        assert!(nodes <= 1 << 31, "at most 2^31 nodes");
        let block = |chunk: &[[u32; 4]]| {
            let node =
                |corner: usize, lane: usize| chunk.get(lane).map_or(chunk[0][0], |t| t[corner]);
            [0, 1, 2, 3].map(|corner| core::array::from_fn(|lane| node(corner, lane)))
        };
        let blocks: Vec<[[u32; WIDTH]; 4]> = kites.chunks(WIDTH).map(block).collect();
        let farthest = |block: &[[u32; WIDTH]; 4]| block.iter().flatten().max().map_or(0, |k| *k);
        let mut reach: Vec<usize> = blocks
            .iter()
            .scan(0, |reach, block| {
                *reach = (farthest(block) as usize + 1).max(*reach);
                Some(*reach)
            })
            .collect();
        if let Some(last) = reach.last_mut() {
            *last = nodes;
        }
        Self { nodes, blocks, reach }
    }

    /// Begins anew the sums a block is the first to add to, `begun` of which are; how many are then.
    ///
    /// All at once would be written long before anything is added to them, and leave the cache.
    #[inline(always)]
    pub fn begin(&self, block: usize, begun: usize, sums: &mut [NodeSum]) -> usize {
        let reach = self.reach[block];
        for sum in &mut sums[begun..reach] {
            *sum = NodeSum::default();
        }
        reach
    }

    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.blocks.len()
    }
}

/// Three columns over the nodes, checked once to reach as far as the corners do.
#[derive(Debug, Clone, Copy)]
pub struct Columns<'a> {
    corners: &'a Corners,
    columns: [&'a [f64]; 3],
}

impl<'a> Columns<'a> {
    /// These columns, at these corners.
    ///
    /// # Panics
    /// When a column is shorter than there are nodes.
    #[inline(always)]
    pub fn new(corners: &'a Corners, columns: [&'a [f64]; 3]) -> Self {
        let [x, y, z] = columns;
        let nodes = corners.nodes;
        let whole = x.len() >= nodes && y.len() >= nodes && z.len() >= nodes;
        assert!(whole, "one value a node");
        Self { corners, columns }
    }

    /// The vectors at the four corners of a block's kites.
    #[inline(always)]
    pub fn corners<L: Wide>(&self, block: usize) -> [Vectors<L>; 4] {
        let [a, b, c, d] = &self.corners.blocks[block];
        [self.gather(a), self.gather(b), self.gather(c), self.gather(d)]
    }

    #[inline(always)]
    #[expect(unsafe_code, reason = "places are checked when `Corners` is made, columns in `new`")]
    fn gather<L: Wide>(&self, at: &[u32; WIDTH]) -> Vectors<L> {
        let [x, y, z] = self.columns;
        // SAFETY: every node is below the number of nodes, which is at most 2^31, and so are the columns
        // long.
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
#[repr(C, align(64))]
pub struct NodeSum {
    /// Force of the film, N.
    pub film: [f64; 4],
    /// Six times ∂V/∂x, m².
    pub normal: [f64; 4],
}

impl NodeSum {
    /// Adds another.
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
    /// Adds what each kite of a block gives to its corners s, a, t, b, kite by kite and for each corner
    /// by corner: the force on that corner; the normal of both halves to s and t, of its own to a and b.
    ///
    /// # Panics
    /// When there are fewer sums than nodes.
    #[inline(always)]
    #[expect(unsafe_code, reason = "nodes are checked when `Corners` is made, sums here")]
    pub fn scatter<L: Wide>(
        &self,
        block: usize,
        film: &[Vectors<L>; 4],
        [whole, first, second]: &[Vectors<L>; 3],
        sums: &mut [NodeSum],
    ) {
        assert!(sums.len() >= self.nodes, "one sum a node");
        let rows = [
            L::rows(&film[0], whole),
            L::rows(&film[1], first),
            L::rows(&film[2], whole),
            L::rows(&film[3], second),
        ];
        let nodes = &self.blocks[block];
        for lane in 0..WIDTH {
            for corner in 0..4 {
                // SAFETY: every node is below `self.nodes`, and there are as many sums.
                let sum = unsafe { sums.get_unchecked_mut(nodes[corner][lane] as usize) };
                sum.add(&rows[corner][lane]);
            }
        }
    }
}
