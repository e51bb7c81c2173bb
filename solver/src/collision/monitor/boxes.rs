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

mod fit;
mod sweep;

use super::motion::mean_displacement;
use crate::geometry::field::Field;
use crate::platform::simd::InstructionSet;
use fit::{Range, fit_boxes, range_of};
use sweep::{Cell, sweep_cell};

/// Width of a cell over the mean width of the boxes. Chosen: in wider cells more boxes are compared, in narrower ones
/// a box lies in more cells.
const CELL_WIDTH: f64 = 3.0;

/// Largest number of cells along an axis. Chosen: it bounds memory where boxes differ much in size.
const MAX_CELLS: usize = 256;

/// Number of pairs after which they are tested. Chosen: small against the memory of a film, large against a group of
/// lanes.
pub const BATCH: usize = 4096;

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
    /// First entry of each cell; then the number of all.
    starts: Vec<u32>,
    /// Next entry of each cell while they are filled.
    next: Vec<u32>,
    /// Elements of all cells.
    entries: Vec<u32>,
    /// The elements of one cell.
    cell: Cell,
    /// Pairs found since the last batch.
    pairs: Vec<[u32; 2]>,
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
    #[inline]
    fn index(&self, axis: usize, x: f32) -> u16 {
        let cell = (f64::from(x) - self.origin[axis]) * self.cells_per_length[axis];
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        let cell = cell.clamp(0.0, (self.cells[axis] - 1) as f64) as u16;
        cell
    }
}

/// An integer in the same order as the numbers.
#[inline]
fn ordered(x: f32) -> u32 {
    let bits = x.to_bits();
    if bits >> 31 == 0 { bits | 0x8000_0000 } else { !bits }
}

impl BoxPairs {
    /// Finds all pairs of elements that share no node and whose boxes over these frames overlap when
    /// each is widened by `reach` (m), and gives them to `take` in batches, the lower number of a pair first.
    /// Several frames must have the same nodes. The mean motion of the film from the first frame to each
    /// other one is taken off.
    ///
    /// Returns the number of pairs; ends and returns `None` once there are more than `most`, of which `take` may have had
    /// some.
    pub fn find(
        &mut self,
        instruction_set: InstructionSet,
        triangles: &[[u32; 3]],
        frames: &[&Field],
        reach: f64,
        most: usize,
        mut take: impl FnMut(&[[u32; 2]]),
    ) -> Option<usize> {
        self.pairs.clear();
        let mut taken = 0;
        self.fit(instruction_set, triangles, frames, reach);
        let ranges =
            self.boxes.each_ref().map(|[lower, upper]| range_of(instruction_set, lower, upper));
        let (grid, sweep) = choose_grid(ranges, triangles.len());
        self.order.clear();
        let keys = self.boxes[sweep][0].iter().zip(0_u64..);
        self.order.extend(keys.map(|(x, element)| u64::from(ordered(*x)) << 32 | element));
        self.order.sort_unstable();
        self.fill_cells(&grid);
        let Self { boxes, covered, starts, entries, cell, pairs, .. } = self;
        let ends = [&boxes[sweep], &boxes[grid.axes[0]], &boxes[grid.axes[1]]];
        for row in 0..grid.cells[1] {
            for column in 0..grid.cells[0] {
                let index = row * grid.cells[0] + column;
                let members = &entries[starts[index] as usize..starts[index + 1] as usize];
                if members.len() < 2 {
                    continue;
                }
                let here = [column, row].map(|k| u16::try_from(k).unwrap_or(u16::MAX));
                cell.fill(members, ends, covered, here);
                sweep_cell(instruction_set, cell, triangles, pairs);
                if taken + pairs.len() > most {
                    return None;
                }
                if pairs.len() >= BATCH {
                    taken += pairs.len();
                    take(pairs);
                    pairs.clear();
                }
            }
        }
        take(pairs);
        Some(taken + pairs.len())
    }

    /// Fits the boxes to the frames.
    fn fit(
        &mut self,
        instruction_set: InstructionSet,
        triangles: &[[u32; 3]],
        frames: &[&Field],
        reach: f64,
    ) {
        for column in self.boxes.iter_mut().flatten() {
            column.clear();
            column.resize(triangles.len(), 0.0);
        }
        let (first, last) = (frames[0], frames[frames.len() - 1]);
        if frames.len() == 1 {
            fit_boxes(instruction_set, triangles, [first; 2], [0.0; 3], reach, &mut self.boxes);
        } else {
            let shift = mean_displacement(first, last);
            fit_boxes(instruction_set, triangles, [first, last], shift, reach, &mut self.boxes);
        }
    }

    /// Puts the elements into the cells that their boxes cover, in the order of the sweep.
    fn fill_cells(&mut self, grid: &Grid) {
        let Self { boxes, order, covered, starts, next, entries, .. } = self;
        let [[left, right], [bottom, top]] = grid.axes.map(|axis| &boxes[axis]);
        covered.clear();
        covered.extend((0..order.len()).map(|element| {
            [
                [grid.index(0, left[element]), grid.index(0, right[element])],
                [grid.index(1, bottom[element]), grid.index(1, top[element])],
            ]
        }));
        starts.clear();
        starts.resize(grid.cells[0] * grid.cells[1] + 1, 0);
        for [columns, rows] in &*covered {
            for row in rows[0]..=rows[1] {
                for column in columns[0]..=columns[1] {
                    starts[usize::from(row) * grid.cells[0] + usize::from(column) + 1] += 1;
                }
            }
        }
        let mut sum = 0;
        for start in &mut *starts {
            sum += *start;
            *start = sum;
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

/// A grid, and the axis of the sweep: the one along which boxes are shortest relative to the film.
fn choose_grid(ranges: [Range; 3], elements: usize) -> (Grid, usize) {
    let (length, width) =
        (ranges.map(|range| range.length()), ranges.map(|range| range.widths / elements as f64));
    let share = |axis: usize| width[axis] / length[axis].max(f64::MIN_POSITIVE);
    let sweep = (0..3).fold(2, |best, axis| if share(axis) < share(best) { axis } else { best });
    let axes = [(sweep + 1) % 3, (sweep + 2) % 3];
    // At most about as many cells as elements.
    #[expect(clippy::cast_precision_loss, reason = "a bound")]
    let most = (elements as f64).sqrt().clamp(1.0, MAX_CELLS as f64);
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
    let origin = axes.map(|axis| f64::from(ranges[axis].ends[0]));
    (Grid { axes, origin, cells_per_length, cells }, sweep)
}

#[cfg(test)]
mod tests;
