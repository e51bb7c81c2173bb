//! Factorisation of a constant sparse matrix that is solved often: its uncoupled parts, eight alike at a time.
//!
//! ```text
//! A = L D Lᵀ        L unit lower triangular, D diagonal
//! ```
//!
//! Sets of rows that nothing couples are factorised apart. Those with the same connections have the same pattern of L,
//! so eight of them are solved together, one a lane. The order of elimination is that of [`super::order`].

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;

use super::order::dissect;
use crate::geometry::field::Field;
use crate::platform::simd::{InstructionSet, WIDTH, dispatch};

/// The factor L D Lᵀ of a constant matrix.
#[derive(Debug, Clone)]
pub struct ConstantFactor {
    groups: Vec<Group<WIDTH>>,
    /// Sets that few others are like.
    single: Vec<Group<1>>,
}

/// Memory of a solution.
#[derive(Debug, Clone, Default)]
pub struct Work {
    groups: Vec<[f64; WIDTH]>,
    single: Vec<[f64; 1]>,
}

/// Fewest sets with the same connections that are solved together. Chosen: fewer leave most lanes empty.
const MIN_TOGETHER: usize = 4;

/// The factors of up to W sets of rows with the same connections, in the order of elimination.
#[derive(Debug, Clone)]
struct Group<const W: usize> {
    /// Row of the matrix at each place and lane; the number of rows in a lane without a set.
    places: Vec<[u32; W]>,
    /// Where the entries of L below the diagonal begin in each column, and their number in all.
    starts: Vec<usize>,
    /// Row and value of each entry, column by column.
    rows: Vec<u32>,
    lower: Vec<[f64; W]>,
    /// 1/D.
    inverse_pivots: Vec<[f64; W]>,
}

/// Rows of a symmetric matrix: its entries by column.
pub type Rows = Vec<BTreeMap<u32, f64>>;

impl ConstantFactor {
    /// Factorises a positive definite matrix. `positions`: of each row, for the dissection.
    ///
    /// # Panics
    /// If the matrix is not positive definite.
    pub fn new(matrix: &Rows, positions: &[Vector3<f64>]) -> Self {
        // Sets of rows by their connections; the rows of a set keep their order.
        let mut alike: BTreeMap<Vec<Vec<u32>>, Vec<Vec<u32>>> = BTreeMap::new();
        for set in connected_sets(matrix) {
            alike.entry(connections(matrix, &set)).or_default().push(set);
        }
        let mut all = Self { groups: Vec::new(), single: Vec::new() };
        for (connections, sets) in &alike {
            let order = elimination_order(connections, &sets[0], positions);
            for sets in sets.chunks(WIDTH) {
                if sets.len() >= MIN_TOGETHER {
                    all.groups.push(Group::new(matrix, connections, &order, sets));
                } else {
                    let alone = sets.chunks(1);
                    all.single
                        .extend(alone.map(|set| Group::new(matrix, connections, &order, set)));
                }
            }
        }
        all
    }

    /// Sets x to the solution of A x = b; `work` is memory.
    pub fn solve(&self, set: InstructionSet, b: &[f64], x: &mut [f64], work: &mut Work) {
        for group in &self.groups {
            group.gather(b, &mut work.groups);
            let Group { starts, rows, lower, inverse_pivots, .. } = group;
            substitute_groups(set, starts, rows, lower, inverse_pivots, &mut work.groups);
            group.scatter(&work.groups, x);
        }
        for group in &self.single {
            group.gather(b, &mut work.single);
            let Group { starts, rows, lower, inverse_pivots, .. } = group;
            substitute_kernel(starts, rows, lower, inverse_pivots, &mut work.single);
            group.scatter(&work.single, x);
        }
    }
}

impl<const W: usize> Group<W> {
    fn gather(&self, b: &[f64], values: &mut Vec<[f64; W]>) {
        values.clear();
        let value = |row: u32| b.get(row as usize).copied().unwrap_or(0.0);
        values.extend(self.places.iter().map(|rows| rows.map(value)));
    }

    fn scatter(&self, values: &[[f64; W]], x: &mut [f64]) {
        for (rows, values) in self.places.iter().zip(values) {
            for (row, value) in rows.iter().zip(values) {
                if let Some(x) = x.get_mut(*row as usize) {
                    *x = *value;
                }
            }
        }
    }

    /// The factor of these sets; `order` is that of the elimination of their rows.
    fn new(matrix: &Rows, connections: &[Vec<u32>], order: &[u32], sets: &[Vec<u32>]) -> Self {
        let none = u32::try_from(matrix.len()).expect("under 2^32");
        let lanes = |local: u32| {
            core::array::from_fn(|lane| sets.get(lane).map_or(none, |set| set[local as usize]))
        };
        let places: Vec<[u32; W]> = order.iter().map(|local| lanes(*local)).collect();
        let columns = columns(connections, order);
        let mut starts = vec![0];
        for rows in &columns {
            starts.push(starts[starts.len() - 1] + rows.len());
        }
        let rows: Vec<u32> = columns.into_iter().flatten().collect();
        let entry = |row: usize, column: usize| {
            // A lane without a set has the matrix 1.
            let of_none = if row == column { 1.0 } else { 0.0 };
            core::array::from_fn(|lane| match places[row][lane] {
                at if at == none => of_none,
                at => matrix[at as usize].get(&places[column][lane]).copied().unwrap_or(0.0),
            })
        };
        let mut pivots: Vec<[f64; W]> = (0..order.len()).map(|k| entry(k, k)).collect();
        let mut lower: Vec<[f64; W]> = Vec::with_capacity(rows.len());
        for column in 0..order.len() {
            let of_column = starts[column]..starts[column + 1];
            lower.extend(rows[of_column].iter().map(|row| entry(*row as usize, column)));
        }
        for column in 0..order.len() {
            let of_column = starts[column]..starts[column + 1];
            for k in of_column.clone() {
                let row = rows[k] as usize;
                for lane in 0..W {
                    let scaled = lower[k][lane] / pivots[column][lane];
                    pivots[row][lane] -= scaled * lower[k][lane];
                }
                for other in of_column.start..k {
                    // Both rows lie below this column, so their entry exists.
                    let target = rows[other] as usize;
                    let at = rows[starts[target]..starts[target + 1]].binary_search(&rows[k]);
                    let at = starts[target] + at.expect("an entry of the factor");
                    for lane in 0..W {
                        let scaled = lower[k][lane] / pivots[column][lane];
                        lower[at][lane] -= scaled * lower[other][lane];
                    }
                }
            }
            for k in of_column {
                for lane in 0..W {
                    lower[k][lane] /= pivots[column][lane];
                }
            }
        }
        let positive = pivots.iter().flatten().all(|pivot| *pivot > 0.0);
        assert!(positive, "the matrix is positive definite");
        let inverse_pivots = pivots.iter().map(|pivot| pivot.map(f64::recip)).collect();
        Self { places, starts, rows, lower, inverse_pivots }
    }
}

/// The sets of rows that the matrix couples, each ascending.
fn connected_sets(matrix: &Rows) -> Vec<Vec<u32>> {
    let mut seen = vec![false; matrix.len()];
    let mut sets = Vec::new();
    for first in 0..matrix.len() {
        let (mut stack, mut set) = (vec![first], Vec::new());
        while let Some(row) = stack.pop() {
            if !core::mem::replace(&mut seen[row], true) {
                set.push(u32::try_from(row).expect("under 2^32"));
                stack.extend(matrix[row].keys().map(|column| *column as usize));
            }
        }
        if !set.is_empty() {
            set.sort_unstable();
            sets.push(set);
        }
    }
    sets
}

/// The other rows of a set that each row is coupled with, by their places in the set.
fn connections(matrix: &Rows, set: &[u32]) -> Vec<Vec<u32>> {
    let place = |row: &u32| set.binary_search(row).expect("a row of the set");
    let place = |row: &u32| u32::try_from(place(row)).expect("under 2^32");
    let others = |row: &u32| {
        let columns = matrix[*row as usize].keys().filter(|column| *column != row);
        columns.map(place).collect()
    };
    set.iter().map(others).collect()
}

/// The order of elimination of a set of rows, by their places in it.
fn elimination_order(
    connections: &[Vec<u32>],
    set: &[u32],
    positions: &[Vector3<f64>],
) -> Vec<u32> {
    let positions: Vec<_> = set.iter().map(|row| positions[*row as usize]).collect();
    let all = (0_u32..).zip(set).map(|(place, _)| place).collect();
    let tree = dissect(all, connections, &Field::of(&positions));
    tree.into_iter().flat_map(|separator| separator.nodes).collect()
}

/// The rows below the diagonal in each column of L, ascending, both in the order of elimination.
fn columns(connections: &[Vec<u32>], order: &[u32]) -> Vec<Vec<u32>> {
    let mut rank = vec![0_u32; order.len()];
    for (index, place) in (0_u32..).zip(order) {
        rank[*place as usize] = index;
    }
    let mut columns: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); order.len()];
    for (column, place) in (0_u32..).zip(order) {
        let below = connections[*place as usize].iter().map(|other| rank[*other as usize]);
        columns[column as usize].extend(below.filter(|row| *row > column));
        // The first row below is the column that the elimination of this one changes first.
        let rows = columns[column as usize].clone();
        if let Some(first) = rows.first() {
            columns[*first as usize].extend(rows.iter().filter(|row| *row > first));
        }
    }
    columns.into_iter().map(|rows| rows.into_iter().collect()).collect()
}

#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "an iterator is not inlined into a target feature")]
fn substitute_kernel<const W: usize>(
    starts: &[usize],
    rows: &[u32],
    lower: &[[f64; W]],
    inverse_pivots: &[[f64; W]],
    values: &mut [[f64; W]],
) {
    let count = values.len();
    for column in 0..count {
        let value = values[column];
        for k in starts[column]..starts[column + 1] {
            let (row, lower) = (&mut values[rows[k] as usize], &lower[k]);
            for lane in 0..W {
                row[lane] -= lower[lane] * value[lane];
            }
        }
    }
    for column in (0..count).rev() {
        let (mut value, inverse) = (values[column], &inverse_pivots[column]);
        for lane in 0..W {
            value[lane] *= inverse[lane];
        }
        for k in starts[column]..starts[column + 1] {
            let (row, lower) = (&values[rows[k] as usize], &lower[k]);
            for lane in 0..W {
                value[lane] -= lower[lane] * row[lane];
            }
        }
        values[column] = value;
    }
}

dispatch! {
    fn substitute_groups / substitute_kernel(
        starts: &[usize],
        rows: &[u32],
        lower: &[[f64; WIDTH]],
        inverse_pivots: &[[f64; WIDTH]],
        values: &mut [[f64; WIDTH]],
    )
}
