//! Sparse Cholesky factorisation of a film's stiffness, front by front.
//!
//! ```text
//! K + diag(shift) = L Lᵀ
//! ```
//!
//! Elimination of a front ([`super::plan`], [`super::dense`]) leaves a Schur complement,
//! which is added to the parent front (I. Duff, J. Reid, "The multifrontal solution of indefinite sparse
//! symmetric linear systems", 1983). All additions have a fixed order.

use nalgebra::{DMatrix, Matrix3};

use super::dense::{Front, clear, factor_panel, solve_backward, solve_forward, update_complement};
use super::plan::{FaceEntries, FrontFace, Plan, plan};
use super::unknowns::Unknowns;
use crate::geometry::field::Field;
use crate::mechanics::forces::tangent::Stiffness;
use crate::platform::simd::{InstructionSet, Lanes, WIDTH};

/// Lower bound of a pivot over its diagonal entry for the matrix to count as positive definite. Chosen:
/// about fifty rounding errors of the entry.
const MIN_PIVOT_RATIO: f64 = 1e-14;

/// The order of elimination of a film's unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Elimination {
    plans: Vec<Plan>,
    /// Where the panel of each front begins in the factor, and its length in all.
    starts: Vec<usize>,
    unknowns: usize,
}

/// The factor L, and the memory that its computation needs. One serves any number of factorisations.
#[derive(Debug, Clone, Default)]
pub struct Factor {
    /// Panels of all fronts, one after the other.
    panels: Vec<Lanes>,
    /// Schur complements that their parents have not received yet.
    complements: Vec<Vec<Lanes>>,
    /// Memory of received complements.
    spare: Vec<Vec<Lanes>>,
    /// Diagonal of the assembled matrix without the shift.
    diagonal: Vec<f64>,
    /// Values of a front during a substitution.
    values: Vec<Lanes>,
    sums: Vec<Lanes>,
}

/// A front during assembly.
struct Assembly<'a> {
    front: Front,
    panel: &'a mut [Lanes],
    complement: &'a mut [Lanes],
}

impl Assembly<'_> {
    /// An entry of the lower triangle.
    fn entry(&mut self, row: usize, column: usize) -> &mut f64 {
        let pivots = self.front.pivots;
        if column < pivots {
            let (group, lane) = self.front.panel_entry(row, column);
            &mut self.panel[group].0[lane]
        } else {
            let (start, lane) = Front::complement_row(row - pivots);
            &mut self.complement[start + column - pivots].0[lane]
        }
    }

    /// Adds the stiffness of a face, column by column, and its diagonal to `diagonal`.
    fn add_face(
        &mut self,
        (stiffness, size): (&[f64], usize),
        face: &FrontFace,
        unknowns: &[u32],
        diagonal: &mut [f64],
    ) {
        match &face.entries {
            FaceEntries::Components(entries) => {
                for (index, (column, from)) in entries.iter().enumerate() {
                    let (column, from) = (*column as usize, *from as usize);
                    let stiffness = &stiffness[from * size..(from + 1) * size];
                    diagonal[unknowns[column] as usize] += stiffness[from];
                    for (row, to) in &entries[index..] {
                        *self.entry(*row as usize, column) += stiffness[*to as usize];
                    }
                }
            }
            FaceEntries::Oblique(entries) => {
                for (column, corner, along) in entries {
                    let columns = &stiffness[3 * corner * size..];
                    for (row, other, across) in entries {
                        let block = Matrix3::from_fn(|i, k| columns[k * size + 3 * other + i]);
                        let force = (block * along).dot(across);
                        if row == column {
                            // Two entries with the same unknown both count.
                            diagonal[unknowns[*column as usize] as usize] += force;
                        }
                        if row >= column {
                            *self.entry(*row as usize, *column as usize) += force;
                        }
                    }
                }
            }
        }
    }

    /// Adds the Schur complement of a child, row block by row block.
    fn add_child(&mut self, complement: &[Lanes], in_parent: &[u32]) {
        let pivots = self.front.pivots;
        // Child and parent have the same order: the first columns go to the panel, the others above.
        let in_panel = in_parent.partition_point(|position| (*position as usize) < pivots);
        let mut start = 0;
        for (block, rows) in in_parent.chunks(WIDTH).enumerate() {
            let first = block * WIDTH;
            let columns = &complement[start..start + first + rows.len()];
            start += first + WIDTH;
            let split = in_panel.min(columns.len());
            let mut targets = [(0, 0); WIDTH];
            for (target, row) in targets.iter_mut().zip(rows) {
                *target = self.front.panel_row(*row as usize);
            }
            let (eliminated, above) = columns.split_at(split);
            add_block(self.panel, &targets, rows.len(), first, 0..split, eliminated, |column| {
                in_parent[column] as usize
            });
            for (target, row) in targets.iter_mut().zip(rows) {
                if let Some(above) = (*row as usize).checked_sub(pivots) {
                    *target = Front::complement_row(above);
                }
            }
            let columns = split..columns.len();
            add_block(self.complement, &targets, rows.len(), first, columns, above, |column| {
                in_parent[column] as usize - pivots
            });
        }
    }
}

/// Adds the lower triangle of some columns of a row block. `targets` says where each row begins in `into`,
/// `place` which column of it a column goes to.
fn add_block(
    into: &mut [Lanes],
    targets: &[(usize, usize); WIDTH],
    rows: usize,
    first_row: usize,
    columns: core::ops::Range<usize>,
    block: &[Lanes],
    place: impl Fn(usize) -> usize,
) {
    for (column, lanes) in columns.zip(block) {
        let at = place(column);
        if rows == WIDTH && column <= first_row {
            for (value, (group, lane)) in lanes.0.iter().zip(targets) {
                into[group + at].0[lane % WIDTH] += value;
            }
        } else {
            let first = column.saturating_sub(first_row);
            for (value, (group, lane)) in lanes.0[..rows].iter().zip(targets).skip(first) {
                into[group + at].0[lane % WIDTH] += value;
            }
        }
    }
}

impl Elimination {
    /// The elimination of these unknowns, coupled by the stiffness of faces and of patches of any number of nodes. Its
    /// dissection uses the positions (m).
    pub fn new(
        faces: &[[u32; 3]],
        patches: &[Vec<u32>],
        unknowns: &Unknowns,
        positions: &Field,
    ) -> Self {
        let faces = faces.iter().map(|nodes| &nodes[..]);
        let coupled: Vec<&[u32]> = faces.chain(patches.iter().map(|nodes| &nodes[..])).collect();
        let plans = plan(&coupled, unknowns, positions);
        let mut starts = vec![0];
        let mut length = 0;
        for plan in &plans {
            length += plan.front.panel_length();
            starts.push(length);
        }
        Self { plans, starts, unknowns: unknowns.len() }
    }

    /// Factorises the stiffness of each face and of each patch, plus a shift of the diagonal (N/m). `false` if the
    /// matrix is not positive definite.
    pub fn factor(
        &self,
        instruction_set: InstructionSet,
        (stiffness, patches): (&[Stiffness], &[DMatrix<f64>]),
        shift: &[f64],
        factor: &mut Factor,
    ) -> bool {
        let Factor { panels, complements, spare, diagonal, .. } = factor;
        panels.resize(self.starts.last().copied().unwrap_or(0), Lanes::default());
        spare.extend(complements.drain(..).filter(|memory| memory.capacity() > 0));
        complements.resize(self.plans.len(), Vec::new());
        diagonal.clear();
        diagonal.resize(self.unknowns, 0.0);
        let mut min_pivots = Vec::new();
        for (index, plan) in self.plans.iter().enumerate() {
            let front = plan.front;
            let panel = &mut panels[self.starts[index]..self.starts[index + 1]];
            let mut complement = spare.pop().unwrap_or_default();
            let length = front.complement_length();
            complement.resize(length.max(complement.len()), Lanes::default());
            clear(instruction_set, &mut complement[..length]);
            clear(instruction_set, panel);
            let mut assembly = Assembly { front, panel, complement: &mut complement };
            let eliminated = &plan.unknowns[..front.pivots];
            for (pivot, unknown) in eliminated.iter().enumerate() {
                *assembly.entry(pivot, pivot) = shift[*unknown as usize];
            }
            for unused in front.pivots..front.columns() {
                // Rows of unused columns lie in the last pivot block.
                let group = unused / WIDTH * front.columns() + unused;
                assembly.panel[group].0[unused % WIDTH] = 1.0;
            }
            for face in &plan.faces {
                let matrix = match face.face.checked_sub(stiffness.len()) {
                    None => (stiffness[face.face].as_slice(), 9),
                    Some(patch) => (patches[patch].as_slice(), patches[patch].nrows()),
                };
                assembly.add_face(matrix, face, &plan.unknowns, diagonal);
            }
            for child in &plan.children {
                let received = core::mem::take(&mut complements[*child]);
                assembly.add_child(&received, &self.plans[*child].in_parent);
                spare.push(received);
            }
            min_pivots.clear();
            min_pivots.extend(
                eliminated
                    .iter()
                    .map(|unknown| *unknown as usize)
                    .map(|unknown| MIN_PIVOT_RATIO * (diagonal[unknown].max(0.0) + shift[unknown])),
            );
            if factor_panel(instruction_set, panel, front, &min_pivots).is_some() {
                spare.push(complement);
                return false;
            }
            update_complement(instruction_set, panel, front, &mut complement);
            complements[index] = complement;
        }
        true
    }

    /// Displacements (m) from forces (N), both along the unknowns: L Lᵀ x = f.
    pub fn solve(
        &self,
        instruction_set: InstructionSet,
        factor: &mut Factor,
        forces: &[f64],
    ) -> Vec<f64> {
        let mut all = forces.to_vec();
        let Factor { panels, values, sums, .. } = factor;
        for (plan, start) in self.plans.iter().zip(&self.starts) {
            let front = plan.front;
            if front.pivots == 0 {
                continue;
            }
            gather(plan, &all, values);
            let panel = &panels[*start..*start + front.panel_length()];
            solve_forward(instruction_set, panel, front, values);
            scatter(plan, values, front.size, &mut all);
        }
        for (plan, start) in self.plans.iter().zip(&self.starts).rev() {
            let front = plan.front;
            if front.pivots == 0 {
                continue;
            }
            gather(plan, &all, values);
            let panel = &panels[*start..*start + front.panel_length()];
            sums.resize(front.columns().max(sums.len()), Lanes::default());
            solve_backward(instruction_set, panel, front, values, sums);
            scatter(plan, values, front.pivots, &mut all);
        }
        all
    }
}

/// The values of a front's unknowns in the blocks of its panel's rows.
fn gather(plan: &Plan, all: &[f64], values: &mut Vec<Lanes>) {
    let front = plan.front;
    values.clear();
    values.resize(front.pivot_blocks() + front.blocks_above(), Lanes::default());
    let (eliminated, above) = plan.unknowns.split_at(front.pivots);
    let (low, high) = values.split_at_mut(front.pivot_blocks());
    for (blocks, unknowns) in [(low, eliminated), (high, above)] {
        for (block, unknowns) in blocks.iter_mut().zip(unknowns.chunks(WIDTH)) {
            for (value, unknown) in block.0.iter_mut().zip(unknowns) {
                *value = all[*unknown as usize];
            }
        }
    }
}

/// Writes the values of the first `count` unknowns of a front.
fn scatter(plan: &Plan, values: &[Lanes], count: usize, all: &mut [f64]) {
    let front = plan.front;
    let (eliminated, above) = plan.unknowns[..count].split_at(front.pivots.min(count));
    let (low, high) = values.split_at(front.pivot_blocks());
    for (blocks, unknowns) in [(low, eliminated), (high, above)] {
        for (block, unknowns) in blocks.iter().zip(unknowns.chunks(WIDTH)) {
            for (value, unknown) in block.0.iter().zip(unknowns) {
                all[*unknown as usize] = *value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DVector, Vector3};

    use super::*;
    use crate::geometry::shapes::{grid, nodes_where, pseudo_random};
    use crate::mechanics::film_model::FilmModel;
    use crate::mechanics::supports::Supports;
    use crate::scene::Film;
    use crate::scene::film_support::{FilmSupport, Hold, PlaneBody};

    /// Held, oblique and free nodes, and a rigid plane that moves several corners of a face.
    #[test]
    fn the_solution_satisfies_the_assembled_equations() {
        let shell = grid(6, 5, 0.3, 0.25);
        let on = |hold: Hold, nodes: Vec<u32>| FilmSupport {
            name: String::new(),
            nodes,
            hold,
            motion: None,
        };
        let body = PlaneBody { normal: Vector3::z(), mass: 0.1, velocity: 0.0, force: 1.0 };
        let supports = [
            on(Hold::Components([true; 3]), nodes_where(&shell, |x| x.x <= 0.0)),
            on(Hold::Components([true, true, false]), nodes_where(&shell, |x| x.x >= 0.299)),
            on(Hold::Body(body), nodes_where(&shell, |x| x.x >= 0.299)),
        ];
        let model = FilmModel::of_shell(&Film::PAPER_ELASTIC, &shell).unwrap();
        let positions = Field::of(&shell.positions);
        let unknowns = Unknowns::new(&model, &Supports::new(&supports, &positions));
        let random = pseudo_random(9 * model.elements(), 3);
        let stiffness: Vec<Stiffness> = random
            .chunks(9)
            .map(|columns| {
                let half = Stiffness::from_fn(|i, j| columns[j][i % 3] + columns[i][j % 3]);
                half * half.transpose()
            })
            .collect();
        let shift = vec![0.1; unknowns.len()];
        let mut full = DMatrix::from_diagonal(&DVector::from_vec(shift.clone()));
        for (face, stiffness) in model.triangles.iter().zip(&stiffness) {
            let moves = |corner: usize| &unknowns.of_node[face[corner] as usize];
            for (i, j) in (0..9).map(|index| (index / 3, index % 3)) {
                for (row, across) in moves(i) {
                    for (column, along) in moves(j) {
                        let block = stiffness.fixed_view::<3, 3>(3 * i, 3 * j);
                        full[(*row as usize, *column as usize)] += across.dot(&(block * along));
                    }
                }
            }
        }
        let elimination = Elimination::new(&model.triangles, &[], &unknowns, &positions);
        let forces: Vec<f64> = (0..unknowns.len()).map(|k| libm::sin(k as f64)).collect();
        let mut factor = Factor::default();
        // The second factorisation uses the memory of the first.
        for _ in 0..2 {
            let set = InstructionSet::detect();
            assert!(elimination.factor(set, (&stiffness, &[]), &shift, &mut factor));
            let found = DVector::from_vec(elimination.solve(set, &mut factor, &forces));
            let error = (&full * found - DVector::from_vec(forces.clone())).amax();
            assert!(error < 1e-8, "{error}");
        }
        let indefinite: Vec<f64> = shift.iter().map(|_| -1e4).collect();
        let set = InstructionSet::detect();
        assert!(!elimination.factor(set, (&stiffness, &[]), &indefinite, &mut factor));
    }
}
