//! Sparse Cholesky factorisation of a film's stiffness, front by front.
//!
//! ```text
//! K + diag(shift) = L Lᵀ
//! ```
//!
//! Each separator ([`super::order`]) is a front: a dense matrix of its own unknowns and of those unknowns
//! above it that its faces touch. Elimination of its own unknowns leaves a Schur complement, which is
//! added to the parent front (I. Duff, J. Reid, "The multifrontal solution of indefinite sparse symmetric
//! linear systems", 1983). All additions have a fixed order.

use nalgebra::Vector3;

use super::dense::{Front, eliminate};
use super::order::{Separator, dissect};
use super::tangent::Stiffness;
use super::unknowns::Unknowns;
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::InstructionSet;

/// Lower bound of a pivot over its diagonal entry for the matrix to count as positive definite. Chosen:
/// about fifty rounding errors of the entry.
const MIN_PIVOT_RATIO: f64 = 1e-14;

/// One unknown of a face: its index in the front, the corner it moves, and the direction.
type FaceUnknown = (u32, usize, Vector3<f64>);

/// A face of a front with its unknowns.
type FrontFace = (usize, Vec<FaceUnknown>);

/// The constant data of a front.
#[derive(Debug, Clone, PartialEq)]
struct Plan {
    front: Front,
    /// Its own unknowns, then those above it, both in the order of elimination.
    unknowns: Vec<u32>,
    /// Indices of the fronts whose Schur complements it receives.
    children: Vec<usize>,
    /// Position in the parent of each unknown above it.
    in_parent: Vec<u32>,
    /// Faces assembled into this front.
    faces: Vec<FrontFace>,
}

/// The order of elimination of a film's unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Elimination {
    plans: Vec<Plan>,
    unknowns: usize,
}

/// The factor L.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    columns: Vec<Vec<f64>>,
}

/// Where each unknown is eliminated.
struct Schedule {
    /// Unknowns of each separator, in the order of elimination.
    of_separator: Vec<Vec<u32>>,
    /// Separator of each unknown.
    separator: Vec<usize>,
    /// Rank of each unknown in the order of elimination.
    rank: Vec<usize>,
}

impl Schedule {
    /// Nodes in the order of the tree; the unknowns of rigid planes belong to its root.
    fn new(tree: &[Separator], unknowns: &Unknowns) -> Self {
        let root = tree.len() - 1;
        let of_node = |node: &u32| unknowns.node_range[*node as usize].clone();
        let mut of_separator: Vec<Vec<u32>> =
            tree.iter().map(|set| set.nodes.iter().flat_map(of_node).collect()).collect();
        let count = u32::try_from(unknowns.len()).expect("under 2^32");
        of_separator[root].extend(unknowns.first_plane..count);
        let mut separator = vec![root; unknowns.len()];
        let mut rank = vec![0; unknowns.len()];
        for (index, unknown) in of_separator.iter().flatten().enumerate() {
            rank[*unknown as usize] = index;
        }
        for (index, unknowns) in of_separator.iter().enumerate() {
            for unknown in unknowns {
                separator[*unknown as usize] = index;
            }
        }
        Self { of_separator, separator, rank }
    }

    /// Position of an unknown in a front: both are in the order of elimination.
    fn position(&self, plan: &Plan, unknown: u32) -> u32 {
        let position = plan
            .unknowns
            .binary_search_by_key(&self.rank[unknown as usize], |other| self.rank[*other as usize]);
        u32::try_from(position.expect("an unknown of the front")).expect("under 2^32")
    }
}

/// Nodes with unknowns that share a face with each node with unknowns, ascending.
fn neighbours(model: &FilmModel, faces: &[[u32; 3]], free: impl Fn(u32) -> bool) -> Vec<Vec<u32>> {
    let mut neighbours = vec![Vec::new(); model.nodes()];
    for face in faces {
        for node in face.iter().filter(|node| free(**node)) {
            let others = face.iter().filter(|other| *other != node && free(**other));
            neighbours[*node as usize].extend(others.copied());
        }
    }
    for nodes in &mut neighbours {
        nodes.sort_unstable();
        nodes.dedup();
    }
    neighbours
}

/// The unknowns that move a face; those of its first corner come first.
fn unknowns_of_face(face: &[u32; 3], unknowns: &Unknowns) -> Vec<FaceUnknown> {
    let corner = |(corner, node): (usize, &u32)| {
        let of_node = unknowns.of_node[*node as usize].iter();
        of_node.map(move |(unknown, direction)| (*unknown, corner, *direction))
    };
    face.iter().enumerate().flat_map(corner).collect()
}

/// Assigns each face to the first separator that eliminates one of its unknowns.
fn faces_of_separators(
    faces: &[[u32; 3]],
    unknowns: &Unknowns,
    schedule: &Schedule,
) -> Vec<Vec<FrontFace>> {
    let mut assigned: Vec<Vec<FrontFace>> = vec![Vec::new(); schedule.of_separator.len()];
    for (index, face) in faces.iter().enumerate() {
        let face_unknowns = unknowns_of_face(face, unknowns);
        let separators =
            face_unknowns.iter().map(|(unknown, ..)| schedule.separator[*unknown as usize]);
        if let Some(first) = separators.min() {
            assigned[first].push((index, face_unknowns));
        }
    }
    assigned
}

/// The fronts, children before parents. Positions in parents and fronts are not set yet.
fn fronts(tree: Vec<Separator>, faces: Vec<Vec<FrontFace>>, schedule: &Schedule) -> Vec<Plan> {
    let mut plans: Vec<Plan> = Vec::with_capacity(tree.len());
    for (index, (separator, faces)) in tree.into_iter().zip(faces).enumerate() {
        let from_children = separator.children.iter().flat_map(|child| {
            let plan = &plans[*child];
            plan.unknowns[plan.front.pivots..].iter().copied()
        });
        let from_faces = faces.iter().flat_map(|(_, of_face)| of_face.iter().map(|(u, ..)| *u));
        let mut above: Vec<u32> = from_children
            .chain(from_faces)
            .filter(|unknown| schedule.separator[*unknown as usize] > index)
            .collect();
        above.sort_unstable_by_key(|unknown| schedule.rank[*unknown as usize]);
        above.dedup();
        let mut unknowns = schedule.of_separator[index].clone();
        let pivots = unknowns.len();
        unknowns.extend(above);
        let front = Front { pivots, size: unknowns.len() };
        let children = separator.children;
        plans.push(Plan { front, unknowns, children, in_parent: Vec::new(), faces });
    }
    plans
}

/// Sets the positions of the children's unknowns, and of the unknowns of faces, in each front.
fn locate(plans: &mut [Plan], schedule: &Schedule) {
    for index in 0..plans.len() {
        for child in plans[index].children.clone() {
            let above = plans[child].unknowns[plans[child].front.pivots..].to_vec();
            let parent = &plans[index];
            plans[child].in_parent =
                above.into_iter().map(|unknown| schedule.position(parent, unknown)).collect();
        }
        let mut faces = core::mem::take(&mut plans[index].faces);
        for (unknown, ..) in faces.iter_mut().flat_map(|(_, of_face)| of_face) {
            *unknown = schedule.position(&plans[index], *unknown);
        }
        plans[index].faces = faces;
    }
}

impl Elimination {
    /// The elimination of these unknowns of a film. Its dissection uses the positions (m).
    ///
    /// # Panics
    /// At 2³² unknowns.
    pub fn new(model: &FilmModel, unknowns: &Unknowns, positions: &Field) -> Self {
        let faces: Vec<[u32; 3]> = model.triangles.iter().chain(&model.closure).copied().collect();
        let free = |node: u32| !unknowns.node_range[node as usize].is_empty();
        let neighbours = neighbours(model, &faces, free);
        let nodes = (0_u32..).take(model.nodes()).filter(|node| free(*node)).collect();
        let tree = dissect(nodes, &neighbours, positions);
        let schedule = Schedule::new(&tree, unknowns);
        let faces = faces_of_separators(&faces, unknowns, &schedule);
        let mut plans = fronts(tree, faces, &schedule);
        locate(&mut plans, &schedule);
        Self { plans, unknowns: unknowns.len() }
    }

    /// Number of stored entries of L.
    pub fn entries(&self) -> usize {
        self.plans.iter().map(|plan| plan.front.pivots * plan.front.stride()).sum()
    }

    /// Diagonal of the stiffness matrix from the stiffness of each face, film first, N/m.
    pub fn diagonal(&self, stiffness: &[Stiffness]) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.unknowns];
        for plan in &self.plans {
            for (face, unknowns) in &plan.faces {
                for (local, corner, direction) in unknowns {
                    let block = stiffness[*face].fixed_view::<3, 3>(3 * corner, 3 * corner);
                    diagonal[plan.unknowns[*local as usize] as usize] +=
                        direction.dot(&(block * direction));
                }
            }
        }
        diagonal
    }

    /// Factorises the stiffness of each face, film first, plus a shift of the diagonal (both N/m). `None` if
    /// the matrix is not positive definite.
    pub fn factor(
        &self,
        instruction_set: InstructionSet,
        stiffness: &[Stiffness],
        shift: &[f64],
    ) -> Option<Factor> {
        let diagonal = self.diagonal(stiffness);
        let mut columns = Vec::with_capacity(self.plans.len());
        let mut schur_complements: Vec<Vec<f64>> = vec![Vec::new(); self.plans.len()];
        for (index, plan) in self.plans.iter().enumerate() {
            let (front, stride) = (plan.front, plan.front.stride());
            let mut matrix = vec![0.0; front.area()];
            let eliminated = &plan.unknowns[..front.pivots];
            for (index, unknown) in eliminated.iter().enumerate() {
                matrix[index * stride + index] = shift[*unknown as usize];
            }
            for (face, unknowns) in &plan.faces {
                add_face(&mut matrix, stride, &stiffness[*face], unknowns);
            }
            for child in &plan.children {
                let complement = core::mem::take(&mut schur_complements[*child]);
                add_child(&mut matrix, stride, &complement, &self.plans[*child]);
            }
            let min_pivots: Vec<f64> = eliminated
                .iter()
                .map(|unknown| *unknown as usize)
                .map(|unknown| MIN_PIVOT_RATIO * (diagonal[unknown].max(0.0) + shift[unknown]))
                .collect();
            if eliminate(instruction_set, &mut matrix, front, &min_pivots).is_some() {
                return None;
            }
            schur_complements[index] = matrix.split_off(front.pivots * stride);
            matrix.shrink_to_fit();
            columns.push(matrix);
        }
        Some(Factor { columns })
    }

    /// Displacements (m) from forces (N), both along the unknowns: L Lᵀ x = f.
    pub fn solve(&self, factor: &Factor, forces: &[f64]) -> Vec<f64> {
        let mut all = forces.to_vec();
        let mut local = Vec::new();
        for (plan, columns) in self.plans.iter().zip(&factor.columns) {
            local.clear();
            local.extend(plan.unknowns.iter().map(|unknown| all[*unknown as usize]));
            for (index, column) in columns.chunks_exact(plan.front.stride().max(1)).enumerate() {
                let value = local[index] / column[index];
                local[index] = value;
                for (value_below, entry) in local[index + 1..].iter_mut().zip(&column[index + 1..])
                {
                    *value_below -= entry * value;
                }
            }
            for (unknown, value) in plan.unknowns.iter().zip(&local) {
                all[*unknown as usize] = *value;
            }
        }
        for (plan, columns) in self.plans.iter().zip(&factor.columns).rev() {
            local.clear();
            local.extend(plan.unknowns.iter().map(|unknown| all[*unknown as usize]));
            for (index, column) in
                columns.chunks_exact(plan.front.stride().max(1)).enumerate().rev()
            {
                let mut value = local[index];
                for (value_below, entry) in local[index + 1..].iter().zip(&column[index + 1..]) {
                    value -= entry * value_below;
                }
                local[index] = value / column[index];
            }
            for (unknown, value) in plan.unknowns[..plan.front.pivots].iter().zip(&local) {
                all[*unknown as usize] = *value;
            }
        }
        all
    }
}

/// Adds the stiffness of a face to the lower triangle of a front.
fn add_face(matrix: &mut [f64], stride: usize, stiffness: &Stiffness, unknowns: &[FaceUnknown]) {
    for (column, corner, along) in unknowns {
        let forces = stiffness.fixed_view::<9, 3>(0, 3 * corner) * along;
        for (row, other, across) in unknowns {
            // Only the lower triangle. Two entries with the same unknown both count.
            if row >= column {
                let force = forces.fixed_view::<3, 1>(3 * other, 0).dot(across);
                matrix[*column as usize * stride + *row as usize] += force;
            }
        }
    }
}

/// Adds the Schur complement of a child.
fn add_child(matrix: &mut [f64], stride: usize, complement: &[f64], child: &Plan) {
    let (pivots, child_stride) = (child.front.pivots, child.front.stride());
    for (j, column) in child.in_parent.iter().enumerate() {
        let from = &complement[j * child_stride + pivots..j * child_stride + child.front.size];
        let into = &mut matrix[*column as usize * stride..(*column as usize + 1) * stride];
        // Child and parent have the same order, so the lower triangle stays lower.
        for (row, entry) in child.in_parent[j..].iter().zip(&from[j..]) {
            into[*row as usize] += entry;
        }
    }
}
