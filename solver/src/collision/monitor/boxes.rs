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
#![allow(clippy::needless_range_loop, reason = "an iterator is not inlined into a target feature")]

use super::motion::mean_displacement;
use crate::geometry::field::Field;
use crate::platform::simd::{
    InstructionSet, Vectors, WIDTH, Wide, dispatch, dispatch_wide, vectors_at,
};

/// Width of a cell over the mean width of the boxes. Chosen: in wider cells more boxes are compared, in narrower ones
/// a box lies in more cells.
const CELL_WIDTH: f64 = 3.0;

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
    /// Slot of each element along the sweep axis.
    slots: Vec<u32>,
    /// Lowest and highest cell of each element along both axes of the grid.
    covered: Vec<[[u16; 2]; 2]>,
    /// First entry of each cell, or first element of each slot; then the number of all.
    starts: Vec<u32>,
    /// Next entry of each cell, or next element of each slot, while they are filled.
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

/// Where boxes are along one axis.
#[derive(Debug, Clone, Copy)]
struct Range {
    /// Lowest and highest end, m.
    ends: [f32; 2],
    /// Sum of all widths, m.
    widths: f64,
}

impl Range {
    /// Length, m.
    fn length(&self) -> f64 {
        f64::from(self.ends[1]) - f64::from(self.ends[0])
    }
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
        self.fit(instruction_set, triangles, frames, reach);
        let ranges =
            self.boxes.each_ref().map(|[lower, upper]| range_of(instruction_set, lower, upper));
        let (grid, sweep) = choose_grid(ranges, triangles.len());
        self.sort(sweep, ranges[sweep]);
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
                if pairs.len() > most {
                    return false;
                }
            }
        }
        true
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

    /// Sorts the elements by the lower ends of their boxes along an axis: into slots, then each slot.
    fn sort(&mut self, sweep: usize, range: Range) {
        let Self { boxes, order, slots, starts, next, .. } = self;
        let lower = &boxes[sweep][0];
        let scale = (lower.len() as f64 - 1.0) / range.length();
        let scale = if scale.is_finite() { scale } else { 0.0 };
        let origin = f64::from(range.ends[0]);
        slots.clear();
        starts.clear();
        starts.resize(lower.len() + 1, 0);
        for x in lower {
            // The first slot if it is NaN.
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
            let slot =
                ((f64::from(*x) - origin) * scale).clamp(0.0, lower.len() as f64 - 1.0) as u32;
            slots.push(slot);
            starts[slot as usize + 1] += 1;
        }
        add_up(starts);
        next.clear();
        next.extend_from_slice(starts);
        order.clear();
        order.resize(lower.len(), 0);
        for ((x, slot), element) in lower.iter().zip(&*slots).zip(0_u64..) {
            let place = &mut next[*slot as usize];
            order[*place as usize] = u64::from(ordered(*x)) << 32 | element;
            *place += 1;
        }
        for range in starts.windows(2) {
            if range[1] - range[0] > 1 {
                order[range[0] as usize..range[1] as usize].sort_unstable();
            }
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
        add_up(starts);
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

/// Makes of numbers, each one place further, the numbers of all before.
fn add_up(starts: &mut [u32]) {
    let mut sum = 0;
    for start in starts {
        sum += *start;
        *start = sum;
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

impl Cell {
    /// Replaces the elements by these. `here`: column and row of the cell. The boxes added at the end are NaN and
    /// overlap none, so that a group of lanes can begin at every element.
    fn fill(
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

#[inline(always)]
fn min<L: Wide>(a: L, b: L) -> L {
    -((-a).max(-b))
}

/// The smallest and the largest of three values, lane by lane. NaN may be left out.
#[inline(always)]
fn ends_of<L: Wide>(a: L, b: L, c: L) -> [L; 2] {
    [min(min(a, b), c), a.max(b).max(c)]
}

#[inline(always)]
fn fit_kernel<L: Wide>(
    triangles: &[[u32; 3]],
    [from, to]: [&Field; 2],
    shift: [f64; 3],
    reach: f64,
    boxes: &mut [Ends; 3],
) {
    let moving = !core::ptr::eq(from, to);
    let from: [&[f64]; 3] = [&from.x, &from.y, &from.z];
    let to: [&[f64]; 3] = [&to.x, &to.y, &to.z];
    let shift = Vectors { x: L::splat(shift[0]), y: L::splat(shift[1]), z: L::splat(shift[2]) };
    let reach = L::splat(reach);
    let mut start = 0;
    while start < triangles.len() {
        let count = if triangles.len() - start < WIDTH { triangles.len() - start } else { WIDTH };
        let mut nodes = [[0; WIDTH]; 3];
        for lane in 0..WIDTH {
            let corners = triangles[start + if lane < count { lane } else { 0 }];
            for k in 0..3 {
                nodes[k][lane] = corners[k];
            }
        }
        let a = vectors_at::<L>(from, &nodes[0]);
        let b = vectors_at::<L>(from, &nodes[1]);
        let c = vectors_at::<L>(from, &nodes[2]);
        let mut ends = [ends_of(a.x, b.x, c.x), ends_of(a.y, b.y, c.y), ends_of(a.z, b.z, c.z)];
        if moving {
            let a = vectors_at::<L>(to, &nodes[0]) - shift;
            let b = vectors_at::<L>(to, &nodes[1]) - shift;
            let c = vectors_at::<L>(to, &nodes[2]) - shift;
            let last = [ends_of(a.x, b.x, c.x), ends_of(a.y, b.y, c.y), ends_of(a.z, b.z, c.z)];
            for axis in 0..3 {
                ends[axis] = [min(ends[axis][0], last[axis][0]), ends[axis][1].max(last[axis][1])];
            }
        }
        for axis in 0..3 {
            let (lower, upper) = ((ends[axis][0] - reach).lanes(), (ends[axis][1] + reach).lanes());
            for lane in 0..count {
                boxes[axis][0][start + lane] = to_f32(lower.0[lane]);
                boxes[axis][1][start + lane] = to_f32(upper.0[lane]);
            }
        }
        start += WIDTH;
    }
}

dispatch_wide! {
    /// Fits boxes to the elements at two frames, or at one that is given twice. `shift` (m) is taken off the second.
    fn fit_boxes / fit_kernel(
        triangles: &[[u32; 3]],
        frames: [&Field; 2],
        shift: [f64; 3],
        reach: f64,
        boxes: &mut [Ends; 3],
    )
}

/// The nearest `f32`, infinite beyond its range.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "rounding is intended")]
fn to_f32(x: f64) -> f32 {
    x as f32
}

#[inline(always)]
fn range_kernel(lower: &[f32], upper: &[f32]) -> Range {
    let (mut lowest, mut highest) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
    let mut widths = [0.0_f64; LANES];
    for index in 0..lower.len() {
        let lane = index % LANES;
        let (low, high) = (lower[index], upper[index]);
        // NaN is left out.
        lowest[lane] = if low < lowest[lane] { low } else { lowest[lane] };
        highest[lane] = if high > highest[lane] { high } else { highest[lane] };
        widths[lane] += f64::from(high) - f64::from(low);
    }
    Range {
        ends: [
            lowest.into_iter().fold(f32::INFINITY, f32::min),
            highest.into_iter().fold(f32::NEG_INFINITY, f32::max),
        ],
        widths: widths.into_iter().sum(),
    }
}

dispatch! {
    fn range_of / range_kernel(lower: &[f32], upper: &[f32]) -> Range
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
    fn sweep_cell / sweep_kernel(cell: &Cell, triangles: &[[u32; 3]], pairs: &mut Vec<[u32; 2]>)
}

#[cfg(test)]
mod tests;
