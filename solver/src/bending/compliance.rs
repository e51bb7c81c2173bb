//! The compliance Ĉ of the hinges: constant, so it is factorised once.
//!
//! ```text
//! K_ij = 4 A D/(h_i h_j) ((1−ν)(n_i·n_j)² + ν)      C = K⁻¹      Ĉ = Σ_T C = L D Lᵀ
//! ```
//!
//! A crease of length l and stiffness k for each metre adds 1/(k l) to its diagonal. The moment of an edge that is no
//! hinge is zero: its row is left out. A rigid element has no compliance. Hinges of
//! different facets are not coupled. Facets with the same connections are solved eight at a time, one a lane.

#![allow(clippy::inline_always, reason = "a kernel must be inlined into its instruction set")]

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix3, Vector3};

use super::hinges::Hinges;
use crate::factorisation::order::dissect;
use crate::geometry::field::Field;
use crate::geometry::shell::Shell;
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::{InstructionSet, WIDTH, dispatch};

/// The factor of Ĉ.
#[derive(Debug, Clone)]
pub(super) struct Compliance {
    groups: Vec<Group<WIDTH>>,
    /// Sets that few others are like.
    single: Vec<Group<1>>,
}

/// Memory of a solution.
#[derive(Debug, Clone, Default)]
pub(super) struct Work {
    groups: Vec<[f64; WIDTH]>,
    single: Vec<[f64; 1]>,
}

/// Fewest sets with the same connections that are solved together. Chosen: fewer leave most lanes empty.
const MIN_TOGETHER: usize = 4;

/// The factors of up to W sets of hinges with the same connections, in the order of elimination.
#[derive(Debug, Clone)]
struct Group<const W: usize> {
    /// Hinge of each place and lane; the number of hinges in a lane without a set.
    hinges: Vec<[u32; W]>,
    /// Where the entries of L below the diagonal begin in each column, and their number in all.
    starts: Vec<usize>,
    /// Row and value of each entry, column by column.
    rows: Vec<u32>,
    lower: Vec<[f64; W]>,
    /// 1/D.
    inverse_pivots: Vec<[f64; W]>,
}

/// Rows of a symmetric matrix.
type Rows = Vec<BTreeMap<u32, f64>>;

impl Compliance {
    /// Factorises Ĉ; `crease_stiffness`: N m/rad for each metre. Also returns for each hinge an upper bound of Π over ½ (u − ū)², N m.
    pub(super) fn factorised(
        model: &FilmModel,
        shell: &Shell,
        hinges: &Hinges,
        rigid: &[bool],
        crease_stiffness: f64,
    ) -> (Self, Vec<f64>) {
        let (matrix, bounds) = assembled(model, hinges, rigid, crease_stiffness);
        let middles = middles(hinges, shell);
        // Sets of hinges by their connections; hinges of a set are numbered in the order of its elements.
        let mut alike: BTreeMap<Vec<Vec<u32>>, Vec<Vec<u32>>> = BTreeMap::new();
        for set in connected_sets(&matrix) {
            alike.entry(connections(&matrix, &set)).or_default().push(set);
        }
        let mut all = Self { groups: Vec::new(), single: Vec::new() };
        for (connections, sets) in &alike {
            let order = elimination_order(connections, &sets[0], &middles);
            for sets in sets.chunks(WIDTH) {
                if sets.len() >= MIN_TOGETHER {
                    all.groups.push(Group::new(&matrix, connections, &order, sets));
                } else {
                    let alone = sets.chunks(1);
                    all.single
                        .extend(alone.map(|set| Group::new(&matrix, connections, &order, set)));
                }
            }
        }
        (all, bounds)
    }

    /// Solves Ĉ m = u.
    pub(super) fn solve(
        &self,
        set: InstructionSet,
        turns: &[f64],
        moments: &mut [f64],
        work: &mut Work,
    ) {
        for group in &self.groups {
            group.gather(turns, &mut work.groups);
            let Group { starts, rows, lower, inverse_pivots, .. } = group;
            substitute_groups(set, starts, rows, lower, inverse_pivots, &mut work.groups);
            group.scatter(&work.groups, moments);
        }
        for group in &self.single {
            group.gather(turns, &mut work.single);
            let Group { starts, rows, lower, inverse_pivots, .. } = group;
            substitute_kernel(starts, rows, lower, inverse_pivots, &mut work.single);
            group.scatter(&work.single, moments);
        }
    }
}

impl<const W: usize> Group<W> {
    fn gather(&self, turns: &[f64], values: &mut Vec<[f64; W]>) {
        values.clear();
        let turn = |hinge: u32| turns.get(hinge as usize).copied().unwrap_or(0.0);
        values.extend(self.hinges.iter().map(|hinges| hinges.map(turn)));
    }

    fn scatter(&self, values: &[[f64; W]], moments: &mut [f64]) {
        for (hinges, values) in self.hinges.iter().zip(values) {
            for (hinge, value) in hinges.iter().zip(values) {
                if let Some(moment) = moments.get_mut(*hinge as usize) {
                    *moment = *value;
                }
            }
        }
    }

    /// The factor of these sets; `order` is that of the elimination of their hinges.
    fn new(matrix: &Rows, connections: &[Vec<u32>], order: &[u32], sets: &[Vec<u32>]) -> Self {
        let none = u32::try_from(matrix.len()).expect("under 2^32");
        let lanes = |local: u32| {
            core::array::from_fn(|lane| sets.get(lane).map_or(none, |set| set[local as usize]))
        };
        let hinges: Vec<[u32; W]> = order.iter().map(|local| lanes(*local)).collect();
        let columns = columns(connections, order);
        let mut starts = vec![0];
        for rows in &columns {
            starts.push(starts[starts.len() - 1] + rows.len());
        }
        let rows: Vec<u32> = columns.into_iter().flatten().collect();
        let entry = |row: usize, column: usize| {
            // A lane without a set has the matrix 1.
            let of_none = if row == column { 1.0 } else { 0.0 };
            core::array::from_fn(|lane| match hinges[row][lane] {
                hinge if hinge == none => of_none,
                hinge => matrix[hinge as usize].get(&hinges[column][lane]).copied().unwrap_or(0.0),
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
        assert!(positive, "the compliance of bending is positive definite");
        let inverse_pivots = pivots.iter().map(|pivot| pivot.map(f64::recip)).collect();
        Self { hinges, starts, rows, lower, inverse_pivots }
    }
}

/// Ĉ by rows, and the upper bound of Π over ½ (u − ū)² at each hinge.
fn assembled(
    model: &FilmModel,
    hinges: &Hinges,
    rigid: &[bool],
    crease_stiffness: f64,
) -> (Rows, Vec<f64>) {
    let mut of_element: Vec<Vec<(usize, u32)>> = vec![Vec::new(); model.elements()];
    for (hinge, sides) in (0_u32..).zip(&hinges.sides) {
        for (element, corner) in sides {
            of_element[*element].push((*corner, hinge));
        }
    }
    let mut matrix: Rows = vec![BTreeMap::new(); hinges.len()];
    let mut bounds = vec![0.0; hinges.len()];
    // A crease turns by itself too, and the film beside it no more than all of its turn.
    for hinge in hinges.first_crease..hinges.len() {
        let row = u32::try_from(hinge).expect("under 2^32");
        matrix[hinge].insert(row, 1.0 / (crease_stiffness * hinges.lengths[hinge]));
        bounds[hinge] = crease_stiffness * hinges.lengths[hinge];
    }
    for (element, edges) in of_element.iter().enumerate().filter(|(element, _)| !rigid[*element]) {
        let stiffness = element_stiffness(model, element);
        let compliance = stiffness.try_inverse().expect("an element with an area");
        for (corner, hinge) in edges {
            // Both elements may take half of the turn; beside a rigid one, the other takes all of it.
            let alone = hinges.sides[*hinge as usize].iter().any(|(element, _)| rigid[*element]);
            let share = if alone { 1.0 } else { 0.5 };
            if (*hinge as usize) < hinges.first_crease {
                bounds[*hinge as usize] += share * share * stiffness.row(*corner).abs().sum();
            }
            for (other, column) in edges {
                let entry = matrix[*hinge as usize].entry(*column).or_insert(0.0);
                *entry += compliance[(*corner, *other)];
            }
        }
    }
    (matrix, bounds)
}

/// K of an element, N m.
fn element_stiffness(model: &FilmModel, element: usize) -> Matrix3<f64> {
    let [a, b, c, d] = model.inverse_shape.each_ref().map(|column| column[element]);
    // Gradients of the barycentric coordinates; that of a corner is −n/h of the edge opposite to it.
    let gradients = [[-(a + c), -(b + d)], [a, b], [c, d]];
    let material = &model.material;
    let poisson = material.poisson_ratio;
    let t = model.thickness;
    // A D: the volume carries the factor of the modulus of the element.
    let rigidity = model.volume[element] * material.plane_modulus() * t * t / 12.0;
    Matrix3::from_fn(|i, j| {
        let [p, q] = [gradients[i], gradients[j]];
        let dot = p[0] * q[0] + p[1] * q[1];
        let sizes = ((p[0] * p[0] + p[1] * p[1]) * (q[0] * q[0] + q[1] * q[1])).sqrt();
        4.0 * rigidity * ((1.0 - poisson) * dot * dot / sizes + poisson * sizes)
    })
}

/// The middle of each hinge's edge in the reference, m, for the dissection.
fn middles(hinges: &Hinges, shell: &Shell) -> Vec<Vector3<f64>> {
    let middle = |[(element, corner), _]: &[(usize, usize); 2]| {
        let at = |step: usize| shell.reference[*element][(corner + step) % 3];
        (0.5 * (at(1) + at(2))).push(0.0)
    };
    hinges.sides.iter().map(middle).collect()
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

/// The order of elimination of a set of hinges, by their places in it.
fn elimination_order(connections: &[Vec<u32>], set: &[u32], middles: &[Vector3<f64>]) -> Vec<u32> {
    let positions: Vec<_> = set.iter().map(|hinge| middles[*hinge as usize]).collect();
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
