//! Sparse Cholesky of a film's stiffness, front by front.
//!
//! ```text
//! K + diag(shift) = L Lᵀ
//! ```
//!
//! Each separator ([`super::order`]) is a front: a dense matrix of its own unknowns and of those
//! above it that its elements touch. What is left of a front after its own unknowns are eliminated
//! is added to the front above (I. Duff, J. Reid, "The multifrontal solution of indefinite sparse
//! symmetric linear systems", 1983). All additions have a fixed order.

use nalgebra::Vector3;

use super::dense::{Front, eliminate};
use super::order::dissect;
use super::tangent::Stiffness;
use super::unknowns::Unknowns;
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::InstructionSet;

/// How little may be left of a diagonal entry for a matrix to count as positive definite.
const PIVOT: f64 = 1e-14;

/// One unknown of a face: its place in the front, the corner it moves, and along what.
type Move = (u32, usize, Vector3<f64>);

/// What is constant of a front.
#[derive(Debug, Clone, PartialEq)]
struct Plan {
    front: Front,
    /// Its own unknowns, then those above it.
    unknowns: Vec<u32>,
    children: Vec<usize>,
    /// Where the unknowns above it stand in its parent.
    in_parent: Vec<u32>,
    /// Faces added here with the unknowns they have.
    faces: Vec<(usize, Vec<Move>)>,
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

impl Elimination {
    /// For this film with these unknowns, cut where its nodes are now (m).
    ///
    /// # Panics
    /// At 2³² unknowns.
    pub fn new(model: &FilmModel, unknowns: &Unknowns, places: &Field) -> Self {
        let faces: Vec<[u32; 3]> = model.triangles.iter().chain(&model.closure).copied().collect();
        let free = |node: u32| !unknowns.own[node as usize].is_empty();
        let mut neighbours = vec![Vec::new(); model.nodes()];
        for face in &faces {
            for a in face.iter().filter(|node| free(**node)) {
                let others = face.iter().filter(|b| *b != a && free(**b));
                neighbours[*a as usize].extend(others.copied());
            }
        }
        for own in &mut neighbours {
            own.sort_unstable();
            own.dedup();
        }
        let nodes = (0_u32..).take(model.nodes()).filter(|node| free(*node)).collect();
        let tree = dissect(nodes, &neighbours, places);

        let root = tree.len() - 1;
        let mut own: Vec<Vec<u32>> = tree
            .iter()
            .map(|set| set.nodes.iter().flat_map(|n| unknowns.own[*n as usize].clone()).collect())
            .collect();
        own[root].extend(unknowns.planes..u32::try_from(unknowns.len()).expect("under 2^32"));
        let (mut set, mut rank) = (vec![root; unknowns.len()], vec![0; unknowns.len()]);
        for (at, unknown) in own.iter().flatten().enumerate() {
            rank[*unknown as usize] = at;
        }
        for (index, unknowns) in own.iter().enumerate() {
            for unknown in unknowns {
                set[*unknown as usize] = index;
            }
        }
        let moves = |face: &[u32; 3]| -> Vec<Move> {
            let corner = |(corner, node): (usize, &u32)| {
                let moves = unknowns.of_node[*node as usize].iter();
                moves.map(move |(unknown, direction)| (*unknown, corner, *direction))
            };
            face.iter().enumerate().flat_map(corner).collect()
        };
        let mut added: Vec<Vec<(usize, Vec<Move>)>> = vec![Vec::new(); tree.len()];
        for (index, face) in faces.iter().enumerate() {
            let moves = moves(face);
            if let Some(first) = moves.iter().map(|(unknown, ..)| set[*unknown as usize]).min() {
                added[first].push((index, moves));
            }
        }
        let mut plans: Vec<Plan> = Vec::with_capacity(tree.len());
        for (index, (separator, faces)) in tree.into_iter().zip(added).enumerate() {
            let children = separator.children.iter();
            let below = children.flat_map(|child| {
                let plan = &plans[*child];
                plan.unknowns[plan.front.pivots..].iter().copied()
            });
            let here = faces.iter().flat_map(|(_, moves)| moves.iter().map(|(own, ..)| *own));
            let mut above: Vec<u32> =
                below.chain(here).filter(|unknown| set[*unknown as usize] > index).collect();
            above.sort_unstable_by_key(|unknown| rank[*unknown as usize]);
            above.dedup();
            let pivots = own[index].len();
            let mut all = core::mem::take(&mut own[index]);
            all.extend(above);
            let front = Front { pivots, size: all.len() };
            plans.push(Plan {
                front,
                unknowns: all,
                children: separator.children,
                in_parent: Vec::new(),
                faces,
            });
        }
        // Both lists are in the order of elimination, and a front's own begin its list.
        let locate = |plan: &Plan, unknown: u32| -> u32 {
            let at = plan
                .unknowns
                .binary_search_by_key(&rank[unknown as usize], |own| rank[*own as usize]);
            u32::try_from(at.expect("an unknown of the front")).expect("under 2^32")
        };
        for index in 0..plans.len() {
            for (at, child) in plans[index].children.clone().into_iter().enumerate() {
                debug_assert!(plans[index].children[at] == child);
                let above = plans[child].unknowns[plans[child].front.pivots..].to_vec();
                plans[child].in_parent =
                    above.into_iter().map(|unknown| locate(&plans[index], unknown)).collect();
            }
            let mut faces = core::mem::take(&mut plans[index].faces);
            for (unknown, ..) in faces.iter_mut().flat_map(|(_, moves)| moves) {
                *unknown = locate(&plans[index], *unknown);
            }
            plans[index].faces = faces;
        }
        Self { plans, unknowns: unknowns.len() }
    }

    /// Numbers L has.
    pub fn entries(&self) -> usize {
        self.plans.iter().map(|plan| plan.front.pivots * plan.front.stride()).sum()
    }

    /// Diagonal of a stiffness given face by face, film first, N/m.
    pub fn diagonal(&self, stiffness: &[Stiffness]) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.unknowns];
        for plan in &self.plans {
            for (face, moves) in &plan.faces {
                for (local, corner, direction) in moves {
                    let block = stiffness[*face].fixed_view::<3, 3>(3 * corner, 3 * corner);
                    diagonal[plan.unknowns[*local as usize] as usize] +=
                        direction.dot(&(block * direction));
                }
            }
        }
        diagonal
    }

    /// Factors a stiffness given face by face, film first, with a shift of its diagonal (both N/m);
    /// `None` where that is not positive definite.
    pub fn factor(
        &self,
        path: InstructionSet,
        stiffness: &[Stiffness],
        shift: &[f64],
    ) -> Option<Factor> {
        let diagonal = self.diagonal(stiffness);
        let mut columns = Vec::with_capacity(self.plans.len());
        let mut left: Vec<Vec<f64>> = vec![Vec::new(); self.plans.len()];
        for (index, plan) in self.plans.iter().enumerate() {
            let (front, stride) = (plan.front, plan.front.stride());
            let mut matrix = vec![0.0; front.area()];
            let own = &plan.unknowns[..front.pivots];
            for (at, unknown) in own.iter().enumerate() {
                matrix[at * stride + at] = shift[*unknown as usize];
            }
            for (face, moves) in &plan.faces {
                add_face(&mut matrix, stride, &stiffness[*face], moves);
            }
            for child in &plan.children {
                let rest = core::mem::take(&mut left[*child]);
                extend(&mut matrix, stride, &rest, &self.plans[*child]);
            }
            let least: Vec<f64> = own
                .iter()
                .map(|unknown| *unknown as usize)
                .map(|unknown| PIVOT * (diagonal[unknown].max(0.0) + shift[unknown]))
                .collect();
            if eliminate(path, &mut matrix, front, &least).is_some() {
                return None;
            }
            left[index] = matrix.split_off(front.pivots * stride);
            matrix.shrink_to_fit();
            columns.push(matrix);
        }
        Some(Factor { columns })
    }

    /// Displacements (m) under forces (N) along the unknowns.
    pub fn solve(&self, factor: &Factor, forces: &[f64]) -> Vec<f64> {
        let mut all = forces.to_vec();
        let mut local = Vec::new();
        for (plan, columns) in self.plans.iter().zip(&factor.columns) {
            local.clear();
            local.extend(plan.unknowns.iter().map(|unknown| all[*unknown as usize]));
            for (at, column) in columns.chunks_exact(plan.front.stride()).enumerate() {
                let value = local[at] / column[at];
                local[at] = value;
                for (own, entry) in local[at + 1..].iter_mut().zip(&column[at + 1..]) {
                    *own -= entry * value;
                }
            }
            for (unknown, value) in plan.unknowns.iter().zip(&local) {
                all[*unknown as usize] = *value;
            }
        }
        for (plan, columns) in self.plans.iter().zip(&factor.columns).rev() {
            local.clear();
            local.extend(plan.unknowns.iter().map(|unknown| all[*unknown as usize]));
            for (at, column) in columns.chunks_exact(plan.front.stride()).enumerate().rev() {
                let mut value = local[at];
                for (own, entry) in local[at + 1..].iter().zip(&column[at + 1..]) {
                    value -= entry * own;
                }
                local[at] = value / column[at];
            }
            for (unknown, value) in plan.unknowns[..plan.front.pivots].iter().zip(&local) {
                all[*unknown as usize] = *value;
            }
        }
        all
    }
}

/// Adds a face's stiffness to the lower triangle of a front.
fn add_face(matrix: &mut [f64], stride: usize, stiffness: &Stiffness, moves: &[Move]) {
    for (column, corner, along) in moves {
        let pushes = stiffness.fixed_view::<9, 3>(0, 3 * corner) * along;
        for (row, other, across) in moves {
            // Both orders of a pair come by; where two moves share an unknown both count.
            if row >= column {
                let push = pushes.fixed_view::<3, 1>(3 * other, 0).dot(across);
                matrix[*column as usize * stride + *row as usize] += push;
            }
        }
    }
}

/// Adds what is left of a child.
fn extend(matrix: &mut [f64], stride: usize, rest: &[f64], child: &Plan) {
    let (pivots, own) = (child.front.pivots, child.front.stride());
    for (j, column) in child.in_parent.iter().enumerate() {
        let from = &rest[j * own + pivots..j * own + child.front.size];
        let into = &mut matrix[*column as usize * stride..(*column as usize + 1) * stride];
        // The order is that of the parent, so what is lower stays lower.
        for (row, entry) in child.in_parent[j..].iter().zip(&from[j..]) {
            into[*row as usize] += entry;
        }
    }
}
