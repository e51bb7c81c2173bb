//! Pairs waiting for a length that only grows to reach their number.

/// Pairs waiting for their time, in bins.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PairQueue {
    /// Width of a bin, m.
    pub(super) width: f64,
    /// Bins of a metre.
    per_length: f64,
    /// First bin not taken yet, counted from 0.
    reached: u64,
    /// A ring of bins; what is due beyond its end waits in the last.
    ring: Vec<Vec<[u32; 2]>>,
    /// What was put into a bin taken already.
    overdue: Vec<[u32; 2]>,
}

impl PairQueue {
    /// `count` bins, a power of two, of this width (m) from a length (m) on.
    ///
    /// # Panics
    /// For another count.
    pub fn new(width: f64, count: usize, from: f64) -> Self {
        assert!(count.is_power_of_two(), "so that a place in the ring is a mask");
        let ring = vec![Vec::new(); count];
        let per_length = 1.0 / width;
        let mut bins = Self { width, per_length, reached: 0, ring, overdue: Vec::new() };
        bins.reached = bins.number(from);
        bins
    }

    /// Empties all; counts from a length (m) on.
    pub fn begin(&mut self, from: f64) {
        self.overdue.clear();
        self.ring.iter_mut().for_each(Vec::clear);
        self.reached = self.number(from);
    }

    /// The bin of a length (m); the first where it is below 0, or no number.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    #[inline]
    fn number(&self, length: f64) -> u64 {
        (length * self.per_length) as u64
    }

    #[expect(clippy::cast_possible_truncation, reason = "below the length of the ring")]
    #[inline]
    fn place(&self, bin: u64) -> usize {
        // The length is a power of two.
        bin as usize & (self.ring.len() - 1)
    }

    /// Has a pair wait until the length is `due` (m).
    #[inline]
    pub fn put(&mut self, due: f64, pair: [u32; 2]) {
        let bin = self.number(due).min(self.reached + (self.ring.len() as u64 - 1));
        if bin < self.reached {
            self.overdue.push(pair);
        } else {
            let place = self.place(bin);
            self.ring[place].push(pair);
        }
    }

    /// Moves to `due` what is due until then (m).
    pub fn take(&mut self, until: f64, due: &mut Vec<[u32; 2]>) {
        due.append(&mut self.overdue);
        let last = self.number(until);
        // One round empties the ring.
        for _ in 0..self.ring.len() {
            if self.reached > last {
                return;
            }
            let place = self.place(self.reached);
            due.append(&mut self.ring[place]);
            self.reached += 1;
        }
        self.reached = self.reached.max(last + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_taken_late_and_nothing_is_lost() {
        let mut bins = PairQueue::new(0.5, 8, 0.0);
        // In a bin, before the first, beyond the ring, no number.
        for (pair, due) in [(0, 1.2), (1, -1.0), (2, 1e9), (3, f64::NAN), (4, 3.9)] {
            bins.put(due, [pair, 0]);
        }
        let mut taken = Vec::new();
        bins.take(1.1, &mut taken);
        let mut first: Vec<u32> = taken.drain(..).map(|[pair, _]| pair).collect();
        first.sort_unstable();
        assert_eq!(first, [0, 1, 3]);
        // Into a bin taken already: the next time.
        bins.put(1.0, [5, 0]);
        bins.take(1.1, &mut taken);
        assert_eq!(taken, [[5, 0]]);
        taken.clear();
        bins.take(100.0, &mut taken);
        taken.sort_unstable();
        assert_eq!(taken, [[2, 0], [4, 0]]);
        bins.put(100.2, [6, 0]);
        bins.take(200.0, &mut taken);
        assert_eq!(taken.last(), Some(&[6, 0]));
    }
}
