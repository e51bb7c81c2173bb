//! Pairs of elements whose boxes overlap: a sweep along one axis in the cells of a grid over the two others.
//!
//! ```text
//! box of an element: smallest and largest coordinates of its nodes in all frames, widened by the reach
//! pair: the boxes overlap in x, y and z, and the elements share no node
//! ```
//!
//! Elements are sorted by the lower ends of their boxes along one axis and put, in that order, into the
//! cells of a grid over the two others that their boxes cover. In each cell an element is compared with
//! those that begin before it ends. A pair is taken in the cell that contains the larger lower ends of
//! its boxes, so it is found once. A pair depends on the frames alone. See D. Baraff and A. Witkin,
//! "Physically based modeling", SIGGRAPH course notes, 1997, for the sweep.
//!
//! Ends are rounded to `f32`. Rounding is monotonic, so boxes that overlap still overlap.

#![allow(clippy::inline_always, reason = "inside the loop over candidates")]
#![allow(clippy::needless_bitwise_bool, reason = "no branches: the compiler makes masks of them")]

use super::motion::mean_displacement;
use crate::geometry::field::Field;
use crate::platform::simd::{InstructionSet, dispatch};

/// Width of a cell over the mean width of the boxes. Chosen.
const CELL_WIDTH: f64 = 1.0;

/// Largest number of cells along an axis. Chosen: it bounds memory where boxes differ much in size.
const MAX_CELLS: usize = 256;

/// Boxes that are compared together.
const LANES: usize = 16;

/// Whether an element's lowest cell along the first and the second axis of the grid is this one.
const STARTS_HERE: [u32; 2] = [1, 2];

/// Ends of boxes along one axis, one entry for each box: lower ends and upper ends, m.
type Ends = [Vec<f32>; 2];

/// Finds the pairs; holds scratch memory.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BoxPairs {
    /// Boxes of the elements along x, y, z.
    boxes: [Ends; 3],
    /// Lower end along the sweep axis, as an ordered integer, and element; sorted.
    order: Vec<u64>,
    /// Lowest and highest cell of each element along both axes of the grid.
    covered: Vec<[[u16; 2]; 2]>,
    /// First entry of each cell, then the number of entries.
    starts: Vec<u32>,
    /// Next entry of each cell, while the cells are filled.
    next: Vec<u32>,
    /// Elements of all cells.
    entries: Vec<u32>,
    /// The elements of one cell.
    cell: Cell,
    /// The pairs found last, the lower number first.
    pub pairs: Vec<[u32; 2]>,
}

/// Boxes of the elements of one cell in the order of the sweep, padded with empty boxes.
#[derive(Debug, Clone, PartialEq, Default)]
struct Cell {
    elements: Vec<u32>,
    /// Ends along the sweep axis and the two axes of the grid.
    ends: [Ends; 3],
    /// Bits of [`STARTS_HERE`].
    flags: Vec<u32>,
}

/// A grid over two axes.
struct Grid {
    axes: [usize; 2],
    origin: [f64; 2],
    cells_per_length: [f64; 2],
    cells: [usize; 2],
}

impl Grid {
    /// The cell of a coordinate (m) along an axis of the grid; the first one if it is NaN.
    fn index(&self, axis: usize, x: f32) -> u16 {
        let cell = (f64::from(x) - self.origin[axis]) * self.cells_per_length[axis];
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        let cell = cell.clamp(0.0, (self.cells[axis] - 1) as f64) as u16;
        cell
    }
}

/// An integer in the same order as the numbers.
fn ordered(x: f32) -> u32 {
    let bits = x.to_bits();
    if bits >> 31 == 0 { bits | 0x8000_0000 } else { !bits }
}

impl BoxPairs {
    /// Finds all pairs of elements that share no node and whose boxes over these frames overlap when
    /// each is widened by `reach` (m). Several frames must have the same nodes. The mean motion of the
    /// film from the first frame to each other one is taken off.
    ///
    /// Ends and returns `false` once there are more than `most` pairs.
    pub fn find(
        &mut self,
        instruction_set: InstructionSet,
        triangles: &[[u32; 3]],
        frames: &[&Field],
        reach: f64,
        most: usize,
    ) -> bool {
        self.pairs.clear();
        self.fit(triangles, frames, reach);
        let (grid, sweep) = self.choose_grid();
        self.sort(sweep);
        self.fill_cells(&grid);
        for row in 0..grid.cells[1] {
            for column in 0..grid.cells[0] {
                let cell = row * grid.cells[0] + column;
                let members = self.starts[cell] as usize..self.starts[cell + 1] as usize;
                if members.len() < 2 {
                    continue;
                }
                let [column, row] = [column, row].map(|k| u16::try_from(k).unwrap_or(u16::MAX));
                self.cell.clear();
                for element in &self.entries[members] {
                    let index = *element as usize;
                    let [[first_column, _], [first_row, _]] = self.covered[index];
                    let flags = STARTS_HERE[0] * u32::from(first_column == column)
                        + STARTS_HERE[1] * u32::from(first_row == row);
                    let ends = [sweep, grid.axes[0], grid.axes[1]]
                        .map(|axis| [self.boxes[axis][0][index], self.boxes[axis][1][index]]);
                    self.cell.push(*element, ends, flags);
                }
                self.cell.pad();
                sweep_cell(instruction_set, &self.cell, triangles, &mut self.pairs);
                if self.pairs.len() > most {
                    return false;
                }
            }
        }
        true
    }

    /// Fits the boxes to the frames.
    fn fit(&mut self, triangles: &[[u32; 3]], frames: &[&Field], reach: f64) {
        for axis in 0..3 {
            let [lower_ends, upper_ends] = &mut self.boxes[axis];
            lower_ends.clear();
            upper_ends.clear();
            lower_ends.resize(triangles.len(), f32::INFINITY);
            upper_ends.resize(triangles.len(), f32::NEG_INFINITY);
            for frame in frames {
                let shift = mean_displacement(frames[0], frame)[axis];
                let column = [&frame.x, &frame.y, &frame.z][axis];
                let ends = lower_ends.iter_mut().zip(upper_ends.iter_mut());
                for ([a, b, c], (lower, upper)) in triangles.iter().zip(ends) {
                    let [a, b, c] = [a, b, c].map(|node| column[*node as usize]);
                    // NaN is left out.
                    let (lowest, highest) = (a.min(b).min(c) - shift, a.max(b).max(c) - shift);
                    *lower = lower.min(to_f32(lowest - reach));
                    *upper = upper.max(to_f32(highest + reach));
                }
            }
        }
    }

    /// A grid, and the axis of the sweep: the one along which boxes are shortest relative to the film.
    fn choose_grid(&self) -> (Grid, usize) {
        let mut origin = [0.0; 3];
        let (mut length, mut width) = ([0.0; 3], [0.0; 3]);
        for (axis, [lower, upper]) in self.boxes.iter().enumerate() {
            let lowest = lower.iter().copied().fold(f32::INFINITY, f32::min);
            let highest = upper.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            let widths = lower.iter().zip(upper).map(|(a, b)| f64::from(*b) - f64::from(*a));
            origin[axis] = f64::from(lowest);
            length[axis] = f64::from(highest) - f64::from(lowest);
            width[axis] = widths.sum::<f64>() / lower.len() as f64;
        }
        let share = |axis: usize| width[axis] / length[axis].max(f64::MIN_POSITIVE);
        let sweep =
            (0..3).fold(2, |best, axis| if share(axis) < share(best) { axis } else { best });
        let axes = [(sweep + 1) % 3, (sweep + 2) % 3];
        // At most about as many cells as elements.
        #[expect(clippy::cast_precision_loss, reason = "a bound")]
        let most = (self.boxes[0][0].len() as f64).sqrt().clamp(1.0, MAX_CELLS as f64);
        let cells = axes.map(|axis| {
            let cells = length[axis] / (CELL_WIDTH * width[axis]);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
            let cells = if cells.is_finite() { cells.clamp(1.0, most) as usize } else { 1 };
            cells
        });
        let per_length = |k: usize| {
            let scale = cells[k] as f64 / length[axes[k]];
            if scale.is_finite() { scale } else { 0.0 }
        };
        let cells_per_length = [per_length(0), per_length(1)];
        (Grid { axes, origin: axes.map(|axis| origin[axis]), cells_per_length, cells }, sweep)
    }

    /// Sorts the elements by the lower ends of their boxes along an axis.
    fn sort(&mut self, sweep: usize) {
        self.order.clear();
        let lower = self.boxes[sweep][0].iter().zip(0_u64..);
        self.order.extend(lower.map(|(x, element)| u64::from(ordered(*x)) << 32 | element));
        self.order.sort_unstable();
    }

    /// Puts the elements into the cells that their boxes cover, in the order of the sweep.
    fn fill_cells(&mut self, grid: &Grid) {
        let Self { boxes, order, covered, starts, next, entries, .. } = self;
        covered.clear();
        for element in 0..order.len() {
            covered.push(
                [0, 1].map(|k| {
                    boxes[grid.axes[k]].each_ref().map(|ends| grid.index(k, ends[element]))
                }),
            );
        }
        starts.clear();
        starts.resize(grid.cells[0] * grid.cells[1] + 1, 0);
        for [columns, rows] in &*covered {
            for row in rows[0]..=rows[1] {
                for column in columns[0]..=columns[1] {
                    starts[usize::from(row) * grid.cells[0] + usize::from(column) + 1] += 1;
                }
            }
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        next.clear();
        next.extend_from_slice(starts);
        entries.clear();
        entries.resize(starts[starts.len() - 1] as usize, 0);
        for key in &*order {
            #[expect(clippy::cast_possible_truncation, reason = "the lower half is the element")]
            let element = *key as u32;
            let [columns, rows] = covered[element as usize];
            for row in rows[0]..=rows[1] {
                for column in columns[0]..=columns[1] {
                    let cell = usize::from(row) * grid.cells[0] + usize::from(column);
                    entries[next[cell] as usize] = element;
                    next[cell] += 1;
                }
            }
        }
    }
}

/// The nearest `f32`, infinite beyond its range.
#[expect(clippy::cast_possible_truncation, reason = "rounding is intended")]
fn to_f32(x: f64) -> f32 {
    x as f32
}

impl Cell {
    fn clear(&mut self) {
        self.elements.clear();
        self.flags.clear();
        self.ends.iter_mut().flatten().for_each(Vec::clear);
    }

    fn push(&mut self, element: u32, ends: [[f32; 2]; 3], flags: u32) {
        self.elements.push(element);
        self.flags.push(flags);
        for (columns, [lower, upper]) in self.ends.iter_mut().zip(ends) {
            columns[0].push(lower);
            columns[1].push(upper);
        }
    }

    /// Adds boxes of NaN, which overlap none, so that a group of lanes can begin at every element.
    fn pad(&mut self) {
        for _ in 0..LANES {
            self.flags.push(0);
            for columns in &mut self.ends {
                columns[0].push(f32::NAN);
                columns[1].push(f32::NAN);
            }
        }
    }
}

/// Sixteen values from a column.
#[inline(always)]
fn group(column: &[f32], first: usize) -> [f32; LANES] {
    let mut values = [0.0; LANES];
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
            let mut mask = 0_u32;
            for lane in 0..LANES {
                let overlaps = (lows[lane] <= end)
                    & (a[lane] <= x[1])
                    & (x[0] <= b[lane])
                    & (c[lane] <= y[1])
                    & (y[0] <= d[lane]);
                mask |= u32::from(overlaps) << lane;
            }
            while mask != 0 {
                let other = first + mask.trailing_zeros() as usize;
                mask &= mask - 1;
                if flags | cell.flags[other] == STARTS_HERE[0] | STARTS_HERE[1] {
                    push_pair([cell.elements[position], cell.elements[other]], triangles, pairs);
                }
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
    fn sweep_cell / sweep_kernel(cell: &Cell, triangles: &[[u32; 3]], pairs: &mut Vec<[u32; 2]>)
}

#[cfg(test)]
mod tests;
