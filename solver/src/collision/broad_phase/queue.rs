//! A priority queue of pairs, ordered by the length at which each pair is due: a ring of bins.
//!
//! The length, for example a path length or an approach bound, only grows. A bin is a chain of blocks of equal size, which all
//! bins of a queue share: a block of an emptied bin serves the next bin that grows, so few pushes allocate.

/// Pairs in a block. Chosen: the last block of most bins is half full, and a longer bin has few blocks.
const BLOCK: usize = 32;
/// No block.
const NONE: u32 = u32::MAX;

/// Pairs that are pending until a growing length reaches their due length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PairQueue {
    /// Width of a bin, m.
    pub(super) bin_width: f64,
    /// Bins per metre.
    bins_per_length: f64,
    /// First bin that has not been emptied yet, counted from length 0.
    next_bin: u64,
    /// A ring of bins. Pairs that are due beyond its end are in its last bin; they are due early.
    ring: Vec<Bin>,
    /// The blocks of all bins.
    blocks: Vec<Block>,
    /// First block of no bin; [`NONE`] without any.
    free: u32,
    /// Pairs whose bin had been emptied already when they were pushed.
    overdue: Vec<[u32; 2]>,
}

/// A chain of blocks: all are full but the last one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Bin {
    first: u32,
    last: u32,
    /// Number of pairs in the last block; [`BLOCK`] in a bin without blocks.
    in_last: usize,
}

impl Bin {
    const EMPTY: Self = Self { first: NONE, last: NONE, in_last: BLOCK };
}

/// Pairs of one bin, and the block after them in its chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Block {
    pairs: [[u32; 2]; BLOCK],
    next: u32,
}

impl PairQueue {
    /// An empty queue of `bins` bins of this width (m) that starts at `length` (m).
    ///
    /// # Panics
    /// If `bins` is not a power of two.
    pub fn new(bin_width: f64, bins: usize, length: f64) -> Self {
        assert!(bins.is_power_of_two(), "the slot of a bin is found with a bit mask");
        let ring = vec![Bin::EMPTY; bins];
        let bins_per_length = 1.0 / bin_width;
        let mut queue = Self { bin_width, bins_per_length, ring, free: NONE, ..Self::default() };
        queue.next_bin = queue.bin_at(length);
        queue
    }

    /// Removes all pairs and starts again at `length` (m).
    pub fn restart(&mut self, length: f64) {
        self.overdue.clear();
        self.ring.fill(Bin::EMPTY);
        self.blocks.clear();
        self.free = NONE;
        self.next_bin = self.bin_at(length);
    }

    /// The bin of a length (m); the first bin if the length is negative or NaN.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    #[inline]
    fn bin_at(&self, length: f64) -> u64 {
        (length * self.bins_per_length) as u64
    }

    #[expect(clippy::cast_possible_truncation, reason = "below the length of the ring")]
    #[inline]
    fn slot(&self, bin: u64) -> usize {
        bin as usize & (self.ring.len() - 1)
    }

    /// Adds a pair that is due when the length reaches `due` (m). A negative or NaN `due` is due at
    /// the next [`Self::pop_until`].
    #[inline]
    pub fn push(&mut self, due: f64, pair: [u32; 2]) {
        let bin = self.bin_at(due).min(self.next_bin + (self.ring.len() as u64 - 1));
        if bin < self.next_bin {
            self.overdue.push(pair);
        } else {
            let slot = self.slot(bin);
            let Bin { last, in_last, .. } = self.ring[slot];
            if in_last < BLOCK {
                self.blocks[last as usize].pairs[in_last] = pair;
                self.ring[slot].in_last += 1;
            } else {
                self.push_to_new_block(slot, pair);
            }
        }
    }

    /// Appends a block with one pair to the bin in this slot.
    #[expect(clippy::cast_possible_truncation, reason = "pairs are counted with 32 bits")]
    fn push_to_new_block(&mut self, slot: usize, pair: [u32; 2]) {
        let new = if self.free == NONE {
            // Hundreds of queues: twice the memory at each growth would leave a quarter of all unused.
            if self.blocks.len() == self.blocks.capacity() {
                self.blocks.reserve_exact(self.blocks.len() / 4 + 1);
            }
            self.blocks.push(Block { pairs: [[0; 2]; BLOCK], next: NONE });
            self.blocks.len() as u32 - 1
        } else {
            let new = self.free;
            self.free = self.blocks[new as usize].next;
            new
        };
        let block = &mut self.blocks[new as usize];
        block.pairs[0] = pair;
        block.next = NONE;
        let bin = &mut self.ring[slot];
        if bin.first == NONE {
            bin.first = new;
        } else {
            self.blocks[bin.last as usize].next = new;
        }
        bin.last = new;
        bin.in_last = 1;
    }

    /// Moves the pairs that are due at lengths up to `length` (m) to `due`. Pairs from the same bin
    /// may come up to one bin early, pairs from beyond the ring earlier still; none comes late.
    pub fn pop_until(&mut self, length: f64, due: &mut Vec<[u32; 2]>) {
        due.append(&mut self.overdue);
        let last_bin = self.bin_at(length);
        // After one round the whole ring is empty.
        for _ in 0..self.ring.len() {
            if self.next_bin > last_bin {
                return;
            }
            let slot = self.slot(self.next_bin);
            self.empty(slot, due);
            self.next_bin += 1;
        }
        self.next_bin = self.next_bin.max(last_bin + 1);
    }

    /// Moves the pairs of the bin in this slot to `due`, in the order in which they were pushed.
    fn empty(&mut self, slot: usize, due: &mut Vec<[u32; 2]>) {
        let Bin { first, last, in_last } = core::mem::replace(&mut self.ring[slot], Bin::EMPTY);
        if first == NONE {
            return;
        }
        let mut block = first;
        while block != last {
            let Block { pairs, next } = &self.blocks[block as usize];
            due.extend_from_slice(pairs);
            block = *next;
        }
        let Block { pairs, next } = &mut self.blocks[last as usize];
        due.extend_from_slice(&pairs[..in_last]);
        *next = self.free;
        self.free = first;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_pair_is_popped_late_and_no_pair_is_lost() {
        let mut queue = PairQueue::new(0.5, 8, 0.0);
        // Within a bin, negative, beyond the ring, NaN, in a later bin.
        for (pair, due) in [(0, 1.2), (1, -1.0), (2, 1e9), (3, f64::NAN), (4, 3.9)] {
            queue.push(due, [pair, 0]);
        }
        let mut popped = Vec::new();
        queue.pop_until(1.1, &mut popped);
        let mut first: Vec<u32> = popped.drain(..).map(|[pair, _]| pair).collect();
        first.sort_unstable();
        assert_eq!(first, [0, 1, 3]);
        // Into a bin that has been emptied already: due at the next call.
        queue.push(1.0, [5, 0]);
        queue.pop_until(1.1, &mut popped);
        assert_eq!(popped, [[5, 0]]);
        popped.clear();
        queue.pop_until(100.0, &mut popped);
        popped.sort_unstable();
        assert_eq!(popped, [[2, 0], [4, 0]]);
        queue.push(100.2, [6, 0]);
        queue.pop_until(200.0, &mut popped);
        assert_eq!(popped.last(), Some(&[6, 0]));
    }

    #[test]
    fn bins_of_many_blocks_keep_their_order_and_share_their_memory() {
        let mut queue = PairQueue::new(1.0, 8, 0.0);
        let mut popped = Vec::new();
        let mut blocks = 0;
        for round in 0..20 {
            let start = f64::from(round);
            // Two bins in turn, the first of which is popped.
            for number in 0..100_u32 {
                queue.push(start + 0.5, [number, 0]);
                queue.push(start + 1.5, [number, 1]);
            }
            popped.clear();
            queue.pop_until(start + 0.9, &mut popped);
            let older = if round == 0 { 0 } else { 100 };
            assert_eq!(popped.len(), 100 + older);
            let number = |[number, _]: &[u32; 2]| *number;
            assert!(popped.chunks(100).all(|pairs| pairs.iter().map(number).eq(0..100)));
            if round == 2 {
                blocks = queue.blocks.len();
            }
        }
        assert_eq!(queue.blocks.len(), blocks);
        queue.restart(0.0);
        popped.clear();
        queue.pop_until(100.0, &mut popped);
        assert_eq!(popped, [[0; 2]; 0]);
    }
}
