//! The sweep in one cell: pairs of elements whose boxes overlap, sixteen compared together.
//!
//! ```text
//! lower_b ≤ upper_a  and  lower_a ≤ upper_b        along every axis, for b after a in the order of the lower ends
//! ```
//!
//! Symbols: lower, upper ends of the boxes of elements a and b, m. A pair counts only in the cell that contains the
//! larger lower ends of its boxes.

#![allow(clippy::inline_always, reason = "inside the loop over candidates")]
#![allow(clippy::needless_bitwise_bool, reason = "no branches: the compiler makes masks of them")]
#![allow(clippy::needless_range_loop, reason = "an iterator is not inlined into a target feature")]

use super::Ends;
use crate::platform::simd::dispatch;

/// Boxes that are compared together.
const LANES: usize = 16;

/// Whether an element's lowest cell along the first and the second axis of the grid is this one.
const STARTS_HERE: [u32; 2] = [1, 2];

/// Boxes of the elements of one cell in the order of the sweep, padded with empty boxes.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Cell {
    elements: Vec<u32>,
    /// Ends along the sweep axis and the two axes of the grid.
    ends: [Ends; 3],
    /// Bits of [`STARTS_HERE`].
    flags: Vec<u32>,
}

impl Cell {
    /// Replaces the elements by these. `here`: column and row of the cell. The boxes added at the end are NaN and
    /// overlap none, so that a group of lanes can begin at every element.
    pub(super) fn fill(
        &mut self,
        members: &[u32],
        ends: [&Ends; 3],
        covered: &[[[u16; 2]; 2]],
        here: [u16; 2],
    ) {
        self.elements.clear();
        self.elements.extend_from_slice(members);
        for (columns, ends) in self.ends.iter_mut().zip(ends) {
            for (column, ends) in columns.iter_mut().zip(ends) {
                column.clear();
                column.extend(members.iter().map(|element| ends[*element as usize]));
                column.extend([f32::NAN; LANES]);
            }
        }
        self.flags.clear();
        self.flags.extend(members.iter().map(|element| {
            let [[column, _], [row, _]] = covered[*element as usize];
            STARTS_HERE[0] * u32::from(column == here[0])
                + STARTS_HERE[1] * u32::from(row == here[1])
        }));
        self.flags.extend([0; LANES]);
    }
}

/// Sixteen values from a column.
#[inline(always)]
fn group<T: Copy + Default>(column: &[T], first: usize) -> [T; LANES] {
    let mut values = [T::default(); LANES];
    values.copy_from_slice(&column[first..first + LANES]);
    values
}

#[inline(always)]
fn sweep_kernel(cell: &Cell, triangles: &[[u32; 3]], pairs: &mut Vec<[u32; 2]>) {
    let [[low, high], [low_x, high_x], [low_y, high_y]] = &cell.ends;
    let count = cell.elements.len();
    for position in 0..count {
        let (end, flags) = (high[position], cell.flags[position]);
        let (x, y) = ([low_x[position], high_x[position]], [low_y[position], high_y[position]]);
        let mut first = position + 1;
        while first < count && low[first] <= end {
            let lows = group(low, first);
            let (a, b) = (group(low_x, first), group(high_x, first));
            let (c, d) = (group(low_y, first), group(high_y, first));
            let others = group(&cell.flags, first);
            let mut mask = 0_u32;
            for lane in 0..LANES {
                let overlaps = (lows[lane] <= end)
                    & (a[lane] <= x[1])
                    & (x[0] <= b[lane])
                    & (c[lane] <= y[1])
                    & (y[0] <= d[lane])
                    & (flags | others[lane] == STARTS_HERE[0] | STARTS_HERE[1]);
                mask |= u32::from(overlaps) << lane;
            }
            while mask != 0 {
                let other = first + mask.trailing_zeros() as usize;
                mask &= mask - 1;
                push_pair([cell.elements[position], cell.elements[other]], triangles, pairs);
            }
            first += LANES;
        }
    }
}

/// Adds a pair of elements unless they share a node.
#[inline(always)]
fn push_pair([a, b]: [u32; 2], triangles: &[[u32; 3]], pairs: &mut Vec<[u32; 2]>) {
    let ([p, q, r], other) = (triangles[a as usize], triangles[b as usize]);
    let mut shared = false;
    for node in other {
        shared |= (node == p) | (node == q) | (node == r);
    }
    if !shared {
        pairs.push(if a < b { [a, b] } else { [b, a] });
    }
}

dispatch! {
    /// Adds the pairs of a cell that belong to it.
    pub(super) fn sweep_cell / sweep_kernel(cell: &Cell, triangles: &[[u32; 3]], pairs: &mut Vec<[u32; 2]>)
}
