//! Pairs of elements, and how far their elements may move until the pair must be tested again.
//!
//! ```text
//! s_a + s_b < due       then the elements a and b are apart         due = s_a + s_b + g at the last test
//! s_a + t < limit       then no pair of a is due                    limit = s_a + t + min (due − s_a − s_b) at the last look
//! ```
//!
//! Symbols: s path of an element ([`super::paths`]), m; g gap of the pair at the last test, m; t bound of all paths: no
//! path grows by more than it, m; the minimum is over the pairs whose first element is a.

use super::paths::Paths;

/// Pairs of elements with the path length at which each is due.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ApartPairs {
    /// The pairs.
    pairs: Vec<[u32; 2]>,
    /// Sum of the paths of the two elements at which each pair is due, m.
    due: Vec<f64>,
    /// First pair of each element, then the number of pairs.
    starts: Vec<u32>,
    /// Sum of its path and of the bound of all paths at which the pairs of each element must be looked at again, m.
    limits: Vec<f64>,
}

impl ApartPairs {
    /// Replaces the pairs by those that `fill` makes of an empty list; each is due at once. `elements`: their number.
    pub fn replace<R>(&mut self, elements: usize, fill: impl FnOnce(&mut Vec<[u32; 2]>) -> R) -> R {
        let Self { pairs, due, starts, limits } = self;
        pairs.clear();
        let result = fill(pairs);
        pairs.shrink_to_fit();
        pairs.sort_unstable();
        starts.clear();
        starts.resize(elements + 1, 0);
        for [first, _] in &*pairs {
            starts[*first as usize + 1] += 1;
        }
        for element in 0..elements {
            starts[element + 1] += starts[element];
        }
        due.clear();
        due.resize(pairs.len(), f64::NEG_INFINITY);
        limits.clear();
        limits.resize(elements, f64::NEG_INFINITY);
        result
    }

    /// The pairs, in order.
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    /// Replaces `due` by the numbers of the pairs that are due at these paths. A path that is NaN makes a pair due.
    /// Call [`Self::defer`] for each of them.
    pub fn due(&mut self, paths: &Paths, due: &mut Vec<u32>) {
        due.clear();
        let elements = self.limits.iter_mut().zip(&paths.of).zip(self.starts.windows(2));
        for ((limit, path), range) in elements {
            // Written so that NaN is looked at.
            if path + paths.bound < *limit {
                continue;
            }
            let mut least = f64::INFINITY;
            for number in range[0]..range[1] {
                let [_, other] = self.pairs[number as usize];
                let slack = self.due[number as usize] - (path + paths.of[other as usize]);
                // Written so that NaN is due.
                if slack > 0.0 {
                    least = least.min(slack);
                } else {
                    due.push(number);
                }
            }
            *limit = path + paths.bound + least;
        }
    }

    /// Makes a due pair due again after its elements have approached by its gap (m); at the next look if the gap is
    /// not positive, or NaN.
    pub fn defer(&mut self, number: u32, paths: &Paths, gap: f64) {
        let number = number as usize;
        let [first, second] = self.pairs[number].map(|element| element as usize);
        let gap = if gap > 0.0 { gap } else { f64::NEG_INFINITY };
        self.due[number] = paths.of[first] + paths.of[second] + gap;
        let limit = &mut self.limits[first];
        *limit = limit.min(paths.of[first] + paths.bound + gap);
    }
}
