//! A priority queue of pairs, ordered by the length at which each pair is due: a ring of bins.
//!
//! The length, for example a path length or an approach bound, only grows.

/// Number of pairs for which an empty bin keeps memory, at most. Chosen: most bins are smaller, so that few
/// pushes allocate.
const MAX_KEPT_CAPACITY: usize = 64;

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
    ring: Vec<Vec<[u32; 2]>>,
    /// Pairs whose bin had been emptied already when they were pushed.
    overdue: Vec<[u32; 2]>,
}

impl PairQueue {
    /// An empty queue of `bins` bins of this width (m) that starts at `length` (m).
    ///
    /// # Panics
    /// If `bins` is not a power of two.
    pub fn new(bin_width: f64, bins: usize, length: f64) -> Self {
        assert!(bins.is_power_of_two(), "the slot of a bin is found with a bit mask");
        let ring = vec![Vec::new(); bins];
        let bins_per_length = 1.0 / bin_width;
        let mut queue = Self { bin_width, bins_per_length, next_bin: 0, ring, overdue: Vec::new() };
        queue.next_bin = queue.bin_at(length);
        queue
    }

    /// Removes all pairs and starts again at `length` (m).
    pub fn restart(&mut self, length: f64) {
        self.overdue.clear();
        self.ring.iter_mut().for_each(Vec::clear);
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
            self.ring[slot].push(pair);
        }
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
            empty(&mut self.ring[slot], due);
            self.next_bin += 1;
        }
        self.next_bin = self.next_bin.max(last_bin + 1);
    }
}

/// Moves the pairs of a bin to `due`. A bin that was large gives its memory back: the last bin, which holds all
/// pairs beyond the ring, is another one whenever a bin has been emptied.
fn empty(bin: &mut Vec<[u32; 2]>, due: &mut Vec<[u32; 2]>) {
    due.append(bin);
    if bin.capacity() > MAX_KEPT_CAPACITY {
        *bin = Vec::new();
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
}
