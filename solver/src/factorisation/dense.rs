//! Partial Cholesky factorisation of a dense front: eliminates its first unknowns and leaves the Schur
//! complement of the others.
//!
//! ```text
//! A = [A11 A21ᵀ; A21 A22]      A11 = L11 L11ᵀ,  L21 = A21 L11⁻ᵀ,  S = A22 − L21 L21ᵀ
//! ```
//!
//! The panel holds [A11; A21], later [L11; L21]; the complement holds A22, later S. Both are stored in
//! blocks of eight rows, and a block column by column, so that a kernel reads memory in order. The rows of
//! A11 and of A21 each begin a block. Unused rows are zero; unused columns of the panel are those of the
//! identity. The complement has the blocks of its lower triangle only.
//!
//! Every entry takes its subtractions in the order of columns, so every instruction set gives the same bits.

#![allow(clippy::inline_always, reason = "inside the elimination")]

use crate::platform::simd::{InstructionSet, Lanes, WIDTH, Wide, dispatch_wide};

/// Number of columns updated together. Chosen: their sums fit sixteen registers of four values.
const TILE: usize = 4;

/// Size of a front.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Front {
    /// Number of unknowns to eliminate.
    pub pivots: usize,
    /// Number of unknowns.
    pub size: usize,
}

impl Front {
    /// Number of stored columns of the panel.
    pub fn columns(self) -> usize {
        self.pivots.next_multiple_of(TILE)
    }

    /// Number of row blocks of A11.
    pub fn pivot_blocks(self) -> usize {
        self.pivots.div_ceil(WIDTH)
    }

    /// Number of row blocks of A21.
    pub fn blocks_above(self) -> usize {
        (self.size - self.pivots).div_ceil(WIDTH)
    }

    /// Stored length of the panel.
    pub fn panel_length(self) -> usize {
        (self.pivot_blocks() + self.blocks_above()) * self.columns()
    }

    /// Stored length of the complement.
    pub fn complement_length(self) -> usize {
        block_start(self.blocks_above())
    }

    /// Where the panel stores an entry: its group of eight and its place in it.
    pub fn panel_entry(self, row: usize, column: usize) -> (usize, usize) {
        let (start, lane) = self.panel_row(row);
        (start + column, lane)
    }

    /// Where the panel stores the first entry of a row.
    pub fn panel_row(self, row: usize) -> (usize, usize) {
        let row =
            if row < self.pivots { row } else { self.pivot_blocks() * WIDTH + row - self.pivots };
        (row / WIDTH * self.columns(), row % WIDTH)
    }

    /// Where the complement stores the first entry of a row; rows count from the first one above the pivots.
    pub fn complement_row(row: usize) -> (usize, usize) {
        (block_start(row / WIDTH), row % WIDTH)
    }
}

/// Where the complement stores the first column of a row block.
fn block_start(block: usize) -> usize {
    block * (block + 1) / 2 * WIDTH
}

#[inline(always)]
fn clear_kernel<L: Wide>(groups: &mut [Lanes]) {
    for lanes in groups {
        L::splat(0.0).store(&mut lanes.0, 0);
    }
}

dispatch_wide! {
    /// Sets every value to zero.
    pub fn clear / clear_kernel(groups: &mut [Lanes])
}

/// The first `L` of a group of eight.
#[inline(always)]
fn load<L: Wide>(lanes: &Lanes) -> L {
    L::load(&lanes.0, 0)
}

/// Subtracts `row[k] * factors[k][FIRST + c]` from sum c, for every k in order.
#[inline(always)]
fn subtract<L: Wide, const FIRST: usize>(
    row: &[Lanes],
    factors: &[Lanes],
    [mut a, mut b, mut c, mut d]: [L; TILE],
) -> [L; TILE] {
    for (lanes, factors) in row.iter().zip(factors) {
        let lanes = load::<L>(lanes);
        a = a - lanes * factors.0[FIRST];
        b = b - lanes * factors.0[FIRST + 1];
        c = c - lanes * factors.0[FIRST + 2];
        d = d - lanes * factors.0[FIRST + 3];
    }
    [a, b, c, d]
}

/// Subtracts the product of a row block with four rows of another block, given by the lane of the first.
#[inline(always)]
fn update<L: Wide>(row: &[Lanes], factors: &[Lanes], lane: usize, into: &mut [Lanes]) {
    let sums = [load::<L>(&into[0]), load(&into[1]), load(&into[2]), load(&into[3])];
    let [a, b, c, d] = if lane == 0 {
        subtract::<L, 0>(row, factors, sums)
    } else {
        subtract::<L, 4>(row, factors, sums)
    };
    a.store(&mut into[0].0, 0);
    b.store(&mut into[1].0, 0);
    c.store(&mut into[2].0, 0);
    d.store(&mut into[3].0, 0);
}

/// The diagonal block of a tile: entries of L11 below the diagonal, and one over each diagonal entry.
struct Diagonal {
    lower: [[f64; TILE]; TILE],
    inverse: [f64; TILE],
}

impl Diagonal {
    /// Factorises the block of these rows; `Err` with the column whose pivot is not above its bound.
    #[inline(always)]
    fn of(tile: &[Lanes], lane: usize, min_pivots: [f64; TILE]) -> Result<Self, usize> {
        let (mut lower, mut inverse) = ([[0.0; TILE]; TILE], [0.0; TILE]);
        for column in 0..TILE {
            for row in column..TILE {
                let mut entry = tile[column].0[lane + row];
                for (left, right) in lower[row].iter().zip(&lower[column]).take(column) {
                    entry -= left * right;
                }
                if row == column {
                    // Written so that NaN is refused too.
                    let positive = entry > min_pivots[column];
                    if !positive {
                        return Err(column);
                    }
                    lower[row][row] = entry.sqrt();
                    inverse[row] = 1.0 / lower[row][row];
                } else {
                    lower[row][column] = entry * inverse[column];
                }
            }
        }
        Ok(Self { lower, inverse })
    }

    /// Multiplies a row block of the tile by L11⁻ᵀ.
    #[inline(always)]
    fn solve<L: Wide>(&self, tile: &mut [Lanes]) {
        let Self { lower: l, inverse } = self;
        let a = load::<L>(&tile[0]) * inverse[0];
        let b = (load::<L>(&tile[1]) - a * l[1][0]) * inverse[1];
        let c = (load::<L>(&tile[2]) - a * l[2][0] - b * l[2][1]) * inverse[2];
        let d = (load::<L>(&tile[3]) - a * l[3][0] - b * l[3][1] - c * l[3][2]) * inverse[3];
        a.store(&mut tile[0].0, 0);
        b.store(&mut tile[1].0, 0);
        c.store(&mut tile[2].0, 0);
        d.store(&mut tile[3].0, 0);
    }

    /// Writes the block itself, and zeros above its diagonal.
    #[inline(always)]
    fn store(&self, tile: &mut [Lanes], lane: usize) {
        for (column, lanes) in tile[..TILE].iter_mut().enumerate() {
            lanes.0[..lane + column].fill(0.0);
            for row in column..TILE {
                lanes.0[lane + row] = self.lower[row][column];
            }
        }
    }
}

#[inline(always)]
fn factor_panel_kernel<L: Wide>(
    panel: &mut [Lanes],
    front: Front,
    min_pivots: &[f64],
) -> Option<usize> {
    let columns = front.columns();
    for from in (0..columns).step_by(TILE) {
        let (block, lane) = (from / WIDTH, from % WIDTH);
        let (before, rest) = panel.split_at_mut(block * columns);
        debug_assert_eq!(before.len(), block * columns);
        let (pivot_row, below) = rest.split_at_mut(columns);
        let (factors, tile) = pivot_row.split_at_mut(from);
        update::<L>(factors, factors, lane, tile);
        // An unused column has the pivot 1.
        let bound = |column: usize| min_pivots.get(from + column).copied().unwrap_or(0.0);
        let diagonal = match Diagonal::of(tile, lane, [bound(0), bound(1), bound(2), bound(3)]) {
            Ok(diagonal) => diagonal,
            Err(column) => return Some(from + column),
        };
        diagonal.solve::<L>(tile);
        diagonal.store(tile, lane);
        for row in below.chunks_exact_mut(columns) {
            let (done, tile) = row.split_at_mut(from);
            update::<L>(done, factors, lane, tile);
            diagonal.solve::<L>(tile);
        }
    }
    None
}

dispatch_wide! {
    /// Factorises the panel of a front. Stops at the first column whose pivot is not above its bound in
    /// `min_pivots`, and returns it.
    pub fn factor_panel / factor_panel_kernel(
        panel: &mut [Lanes],
        front: Front,
        min_pivots: &[f64],
    ) -> Option<usize>
}

#[inline(always)]
fn update_by_four_kernel<L: Wide>(panel: &[Lanes], front: Front, complement: &mut [Lanes]) {
    let columns = front.columns();
    let above = &panel[front.pivot_blocks() * columns..];
    for (block, row) in above.chunks_exact(columns).enumerate() {
        let into = &mut complement[block_start(block)..block_start(block + 1)];
        let factors = above.chunks_exact(columns);
        for (into, factors) in into.chunks_exact_mut(WIDTH).zip(factors) {
            let (low, high) = into.split_at_mut(TILE);
            update::<L>(row, factors, 0, low);
            update::<L>(row, factors, TILE, high);
        }
    }
}

#[inline(always)]
fn update_by_eight_kernel<L: Wide>(panel: &[Lanes], front: Front, complement: &mut [Lanes]) {
    let columns = front.columns();
    let above = &panel[front.pivot_blocks() * columns..];
    for (block, row) in above.chunks_exact(columns).enumerate() {
        let into = &mut complement[block_start(block)..block_start(block + 1)];
        let factors = above.chunks_exact(columns);
        for (into, factors) in into.chunks_exact_mut(WIDTH).zip(factors) {
            let mut low = [load::<L>(&into[0]), load(&into[1]), load(&into[2]), load(&into[3])];
            let mut high = [load::<L>(&into[4]), load(&into[5]), load(&into[6]), load(&into[7])];
            for (lanes, Lanes(f)) in row.iter().zip(factors) {
                let lanes = load::<L>(lanes);
                let ([a, b, c, d], [e, g, h, i]) = (low, high);
                low = [a - lanes * f[0], b - lanes * f[1], c - lanes * f[2], d - lanes * f[3]];
                high = [e - lanes * f[4], g - lanes * f[5], h - lanes * f[6], i - lanes * f[7]];
            }
            for (c, sum) in low.into_iter().chain(high).enumerate() {
                sum.store(&mut into[c].0, 0);
            }
        }
    }
}

dispatch_wide! {
    fn update_by_four / update_by_four_kernel(panel: &[Lanes], front: Front, complement: &mut [Lanes])
}

dispatch_wide! {
    fn update_by_eight / update_by_eight_kernel(panel: &[Lanes], front: Front, complement: &mut [Lanes])
}

/// Subtracts L21 L21ᵀ from the complement.
pub fn update_complement(
    instruction_set: InstructionSet,
    panel: &[Lanes],
    front: Front,
    complement: &mut [Lanes],
) {
    if front.pivots == 0 {
        return;
    }
    // A tile of eight columns has more sums than AVX2 has registers.
    match instruction_set {
        InstructionSet::Avx512 => update_by_eight(instruction_set, panel, front, complement),
        _ => update_by_four(instruction_set, panel, front, complement),
    }
}

#[inline(always)]
fn solve_forward_kernel<L: Wide>(panel: &[Lanes], front: Front, values: &mut [Lanes]) {
    let columns = front.columns();
    for (block, row) in panel.chunks_exact(columns).enumerate() {
        let (done, values) = values.split_at_mut(block);
        let mut sum = load::<L>(&values[0]);
        let full = columns.min(block * WIDTH);
        for (row, values) in row[..full].chunks(WIDTH).zip(done) {
            for (lanes, value) in row.iter().zip(&values.0) {
                sum = sum - load::<L>(lanes) * *value;
            }
        }
        let mut sum = sum.lanes().0;
        for (column, lanes) in row[full..].iter().enumerate().take(WIDTH) {
            let value = sum[column] / lanes.0[column];
            for (sum, entry) in sum.iter_mut().zip(&lanes.0) {
                *sum -= entry * value;
            }
            sum[column] = value;
        }
        values[0] = Lanes(sum);
    }
}

dispatch_wide! {
    /// Forward substitution: solves L11 y = f for the first unknowns and subtracts L21 y from the others.
    /// Values are in the blocks of the panel's rows.
    pub fn solve_forward / solve_forward_kernel(panel: &[Lanes], front: Front, values: &mut [Lanes])
}

#[inline(always)]
fn solve_backward_kernel<L: Wide>(
    panel: &[Lanes],
    front: Front,
    values: &mut [Lanes],
    sums: &mut [Lanes],
) {
    let (columns, pivot_blocks) = (front.columns(), front.pivot_blocks());
    sums[..columns].fill(Lanes::default());
    let (eliminated, above) = panel.split_at(pivot_blocks * columns);
    for (row, values) in above.chunks_exact(columns).zip(&values[pivot_blocks..]) {
        add_products::<L>(row, values, sums);
    }
    for (block, row) in eliminated.chunks_exact(columns).enumerate().rev() {
        let first = block * WIDTH;
        let values = &mut values[block].0;
        let diagonal = &row[first..columns.min(first + WIDTH)];
        for (column, lanes) in diagonal.iter().enumerate().rev() {
            let mut value = values[column] - sums[first + column].sum();
            for (entry, below) in lanes.0.iter().zip(&*values).take(diagonal.len()).skip(column + 1)
            {
                value -= entry * below;
            }
            values[column] = value / lanes.0[column];
        }
        add_products::<L>(&row[..first], &Lanes(*values), sums);
    }
}

/// Adds the products of a row block with the values of its rows to the sum of each column.
#[inline(always)]
fn add_products<L: Wide>(row: &[Lanes], values: &Lanes, sums: &mut [Lanes]) {
    let values = load::<L>(values);
    for (lanes, sum) in row.iter().zip(sums) {
        (load::<L>(sum) + load::<L>(lanes) * values).store(&mut sum.0, 0);
    }
}

dispatch_wide! {
    /// Backward substitution: solves L11ᵀ x = y − L21ᵀ z, z the values of the unknowns above. `sums` is
    /// scratch, one for each column.
    pub fn solve_backward / solve_backward_kernel(
        panel: &[Lanes],
        front: Front,
        values: &mut [Lanes],
        sums: &mut [Lanes],
    )
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    /// Panel and complement of the lower triangle of a matrix.
    fn stored(full: &DMatrix<f64>, front: Front) -> (Vec<Lanes>, Vec<Lanes>) {
        let mut panel = vec![Lanes::default(); front.panel_length()];
        let mut complement = vec![Lanes::default(); front.complement_length()];
        for unused in front.pivots..front.columns() {
            panel[unused / WIDTH * front.columns() + unused].0[unused % WIDTH] = 1.0;
        }
        for column in 0..front.size {
            for row in column..front.size {
                *entry(&mut panel, &mut complement, front, row, column) = full[(row, column)];
            }
        }
        (panel, complement)
    }

    fn entry<'a>(
        panel: &'a mut [Lanes],
        complement: &'a mut [Lanes],
        front: Front,
        row: usize,
        column: usize,
    ) -> &'a mut f64 {
        if column < front.pivots {
            let (group, lane) = front.panel_entry(row, column);
            &mut panel[group].0[lane]
        } else {
            let (start, lane) = Front::complement_row(row - front.pivots);
            &mut complement[start + column - front.pivots].0[lane]
        }
    }

    #[test]
    fn partial_elimination_gives_the_same_bits_on_every_instruction_set() {
        for (pivots, size) in [(1, 1), (3, 7), (6, 6), (5, 21), (16, 33), (30, 31), (12, 60)] {
            let front = Front { pivots, size };
            let half = DMatrix::from_fn(size, size, |i, j| libm::sin((3 * i + 7 * j) as f64));
            let full = &half * half.transpose() + DMatrix::identity(size, size);
            let done = InstructionSet::ALL.map(|instruction_set| {
                let (mut panel, mut complement) = stored(&full, front);
                let bounds = vec![0.0; pivots];
                assert_eq!(factor_panel(instruction_set, &mut panel, front, &bounds), None);
                update_complement(instruction_set, &panel, front, &mut complement);
                let lower = DMatrix::from_fn(size, size, |i, j| {
                    if i < j { 0.0 } else { *entry(&mut panel, &mut complement, front, i, j) }
                });
                let values = vec![Lanes::splat(1.0); front.pivot_blocks() + front.blocks_above()];
                let (mut forward, mut backward) = (values.clone(), values);
                solve_forward(instruction_set, &panel, front, &mut forward);
                let sums = &mut vec![Lanes::default(); front.columns()];
                solve_backward(instruction_set, &panel, front, &mut backward, sums);
                let unknown = |values: &[Lanes], row: usize| {
                    let (first, row) =
                        if row < pivots { (0, row) } else { (front.pivot_blocks(), row - pivots) };
                    values[first + row / WIDTH].0[row % WIDTH]
                };
                let forward = DVector::from_fn(size, |row, _| unknown(&forward, row));
                let backward = DVector::from_fn(size, |row, _| unknown(&backward, row));
                (lower, forward, backward)
            });
            let (lower, forward, backward) = &done[0];
            let product = |i: usize, j: usize| -> f64 {
                (0..=j.min(pivots - 1)).map(|k| lower[(i, k)] * lower[(j, k)]).sum()
            };
            for j in 0..size {
                for i in j..size {
                    let rest = if j < pivots { 0.0 } else { lower[(i, j)] };
                    assert!((product(i, j) + rest - full[(i, j)]).abs() < 1e-11, "{i} {j}");
                }
            }
            for row in 0..size {
                let terms = |columns: core::ops::Range<usize>| -> f64 {
                    columns.map(|k| lower[(row, k)] * forward[k]).sum()
                };
                let rest =
                    if row < pivots { terms(0..row + 1) } else { terms(0..pivots) + forward[row] };
                assert!((rest - 1.0).abs() < 1e-11, "{row}");
            }
            for column in 0..pivots {
                let sum: f64 = (column..size).map(|k| lower[(k, column)] * backward[k]).sum();
                assert!((sum - 1.0).abs() < 1e-11, "{column}");
            }
            assert!(done.iter().all(|other| *other == done[0]), "{pivots} {size}");
        }
    }

    #[test]
    fn a_pivot_below_its_bound_is_returned() {
        let front = Front { pivots: 2, size: 2 };
        let full = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 3.0]);
        let (mut panel, _) = stored(&full, front);
        assert_eq!(factor_panel(InstructionSet::Scalar, &mut panel, front, &[0.0; 2]), Some(1));
    }
}
