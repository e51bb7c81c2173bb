//! The linear system of a Newton step, and its solution.
//!
//! ```text
//! A = w M + K_faces + K_terms + K_pairs + κ g gᵀ          A d = r
//! P = w M + K_faces + K_patches + diag(K_pairs) + κ g gᵀ  P⁻¹ by Cholesky, the gas by Sherman and Morrison
//! ```
//!
//! Symbols: w weight of the inertia, 1/s²; K of membrane and pressure on faces; of the further energies, and near it,
//! patch by patch; of contacts and plates; κ g gᵀ stiffness of the gas, which is never a dense matrix. Conjugate
//! gradients with P as preconditioner solve it; without pairs and further energies A = P, and one solution is exact.
//! Where P is not positive definite, w grows.

use nalgebra::Matrix3;

use crate::factorisation::conjugate_gradients::conjugate_gradients;
use crate::factorisation::factor::{Elimination, Factor};
use crate::factorisation::unknowns::{Unknowns, dot};
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::tangent::{self, Stiffness};
use crate::platform::simd::InstructionSet;
use crate::system::{Evaluation, FilmState, FilmSystem, TermStiffness, Workspace};

/// Residual of conjugate gradients over the right side, in the norm of P⁻¹. Chosen: a Newton step needs no more.
const MAX_RESIDUAL: f64 = 1e-4;
/// First weight that is added where P is not positive definite, over w, and its growth. Chosen.
const FIRST_SHIFT: f64 = 1.0;
const SHIFT_GROWTH: f64 = 8.0;
/// Attempts to make P positive definite. Chosen: the last weight dominates any stiffness.
const MAX_SHIFTS: u32 = 30;

/// Where the stiffness of an element belongs: its face, and the corner of the face that each of its corners is.
type Place = (usize, [usize; 3]);

/// The linear system of a film with its supports.
#[derive(Debug, Clone)]
pub(super) struct LinearSystem {
    pub(super) unknowns: Unknowns,
    elimination: Elimination,
    factor: Factor,
    faces: Vec<[u32; 3]>,
    places: Vec<Place>,
    stiffness: Vec<Stiffness>,
    terms: TermStiffness,
    pairs: Vec<([u32; 2], Matrix3<f64>)>,
    /// Diagonal of w M, and of the pairs, along the unknowns.
    inertia: Vec<f64>,
    pair_diagonal: Vec<f64>,
    gas: Option<GasTerm>,
    scratch: [Field; 2],
}

/// κ, g along the unknowns, F⁻¹ g, and κ/(1 + κ g·F⁻¹ g).
#[derive(Debug, Clone)]
struct GasTerm {
    factor: f64,
    gradient: Vec<f64>,
    solved: Vec<f64>,
    share: f64,
}

impl LinearSystem {
    /// The system of film whose order of elimination is that of some positions (m).
    pub(super) fn new(system: &FilmSystem, state: &FilmState, ordered_at: &Field) -> Self {
        let model = &system.model;
        let unknowns = Unknowns::new(model, &system.supports);
        let (faces, terms) = (model.faces(), TermStiffness::new(system));
        let elimination = Elimination::new(&faces, &terms.nodes, &unknowns, ordered_at);
        let places = places(system, state, &faces);
        let zeros = || Field::zeros(model.nodes());
        Self {
            stiffness: vec![Stiffness::zeros(); faces.len()],
            terms,
            inertia: vec![0.0; unknowns.len()],
            pair_diagonal: vec![0.0; unknowns.len()],
            unknowns,
            elimination,
            factor: Factor::default(),
            faces,
            places,
            pairs: Vec::new(),
            gas: None,
            scratch: [zeros(), zeros()],
        }
    }

    /// Prepares A and P at positions (m) and a time (s), which evaluation and workspace are of. `false` if no weight
    /// makes P positive definite.
    pub(super) fn prepare(
        &mut self,
        system: &FilmSystem,
        state: &FilmState,
        (positions, time): (&Field, f64),
        (evaluation, workspace): (&Evaluation, &Workspace),
        weight: f64,
    ) -> bool {
        self.stiffness.fill(Stiffness::zeros());
        let overpressure = system.overpressure_at(evaluation.gas_pressure);
        let faces = system.face_stiffness(&state.creep, positions, overpressure);
        for ((_, stiffness), (face, corners)) in faces.zip(&self.places) {
            add_permuted(&mut self.stiffness[*face], &stiffness, corners);
        }
        self.terms.prepare(system, positions, overpressure, &state.yielded);
        let pairs = &mut self.pairs;
        pairs.clear();
        system.pair_stiffness((positions, time), workspace, &mut |nodes, block| {
            pairs.push((nodes, *block));
        });
        self.set_pair_diagonal();
        self.gas = None;
        if !self.factorise(system.instruction_set, weight) {
            return false;
        }
        if let Some(gas) = system.gas_stiffness(evaluation, workspace) {
            let mut gradient = vec![0.0; self.unknowns.len()];
            self.unknowns.add(&gas.gradient, &mut gradient);
            let set = system.instruction_set;
            let solved = self.elimination.solve(set, &mut self.factor, &gradient);
            let share = gas.factor / (1.0 + gas.factor * dot(&gradient, &solved));
            self.gas = Some(GasTerm { factor: gas.factor, gradient, solved, share });
        }
        true
    }

    /// The diagonal of `K_pairs`: at least what a pair can add.
    fn set_pair_diagonal(&mut self) {
        self.pair_diagonal.fill(0.0);
        for ([first, second], block) in &self.pairs {
            if first == second {
                for (unknown, direction) in &self.unknowns.of_node[*first as usize] {
                    let entry = direction.dot(&(block * direction));
                    self.pair_diagonal[*unknown as usize] += entry.max(0.0);
                }
            }
        }
    }

    fn factorise(&mut self, set: InstructionSet, weight: f64) -> bool {
        let mut total = weight;
        let mut added = FIRST_SHIFT * weight;
        for _ in 0..MAX_SHIFTS {
            for (entry, mass) in self.inertia.iter_mut().zip(&self.unknowns.mass) {
                *entry = total * mass;
            }
            let diagonal = self.inertia.iter().zip(&self.pair_diagonal);
            let shift: Vec<f64> = diagonal.map(|(inertia, pairs)| inertia + pairs).collect();
            let matrices = (&self.stiffness[..], &self.terms.patches[..]);
            if self.elimination.factor(set, matrices, &shift, &mut self.factor) {
                return true;
            }
            total = weight + added;
            added *= SHIFT_GROWTH;
        }
        false
    }

    /// P⁻¹ r.
    fn precondition(&mut self, set: InstructionSet, r: &[f64]) -> Vec<f64> {
        let mut z = self.elimination.solve(set, &mut self.factor, r);
        if let Some(gas) = &self.gas {
            let along = gas.share * dot(&gas.gradient, &z);
            for (value, solved) in z.iter_mut().zip(&gas.solved) {
                *value -= along * solved;
            }
        }
        z
    }

    /// A d.
    fn product(&mut self, system: &FilmSystem, d: &[f64]) -> Vec<f64> {
        let [moves, forces] = &mut self.scratch;
        for node in 0..moves.len() {
            moves.set(node, self.unknowns.displacement(node, d));
        }
        for column in [&mut forces.x, &mut forces.y, &mut forces.z] {
            column.fill(0.0);
        }
        tangent::add_products(&self.faces, &self.stiffness, moves, forces);
        self.terms.add_product(system, moves, forces);
        for ([first, second], block) in &self.pairs {
            let force = block * moves.get(*second as usize);
            let first = *first as usize;
            forces.set(first, forces.get(first) + force);
        }
        let mut out: Vec<f64> = self.inertia.iter().zip(d).map(|(m, d)| m * d).collect();
        self.unknowns.add(forces, &mut out);
        if let Some(gas) = &self.gas {
            let along = gas.factor * dot(&gas.gradient, d);
            for (value, gradient) in out.iter_mut().zip(&gas.gradient) {
                *value += along * gradient;
            }
        }
        out
    }

    /// d of A d = r, a direction of descent: where A has no positive curvature along a direction, the sum so far.
    pub(super) fn solve(&mut self, system: &FilmSystem, r: &[f64]) -> Vec<f64> {
        let set = system.instruction_set;
        let z = self.precondition(set, r);
        if self.pairs.is_empty() && system.energy_terms.is_empty() {
            return z;
        }
        let start = (r, z);
        conjugate_gradients(
            self,
            start,
            MAX_RESIDUAL,
            |all, r| all.precondition(set, r),
            |all, d| all.product(system, d),
        )
    }
}

/// Adds the stiffness of an element to that of a face with the same nodes in another order.
fn add_permuted(into: &mut Stiffness, stiffness: &Stiffness, corners: &[usize; 3]) {
    for (i, to_row) in corners.iter().enumerate() {
        for (j, to_column) in corners.iter().enumerate() {
            let block = stiffness.fixed_view::<3, 3>(3 * i, 3 * j);
            let mut target = into.fixed_view_mut::<3, 3>(3 * to_row, 3 * to_column);
            target += block;
        }
    }
}

/// The place of each element of [`FilmSystem::face_stiffness`]: the elements of film with loss have the order of
/// the element loop.
fn places(system: &FilmSystem, state: &FilmState, faces: &[[u32; 3]]) -> Vec<Place> {
    let model: &FilmModel = &system.model;
    let sorted = |nodes: &[u32; 3]| {
        let mut nodes = *nodes;
        nodes.sort_unstable();
        nodes
    };
    let mut known: Vec<([u32; 3], usize)> =
        faces.iter().enumerate().map(|(face, nodes)| (sorted(nodes), face)).collect();
    known.sort_unstable();
    let place = |nodes: [u32; 3], closing: bool| {
        let key = sorted(&nodes);
        let first = known.partition_point(|(other, _)| *other < key);
        let same = known[first..].iter().take_while(|(other, _)| *other == key);
        // A closing face may have the nodes of an element.
        let of_kind = |face: &usize| (*face >= model.triangles.len()) == closing;
        let face = same.map(|(_, face)| *face).find(of_kind).expect("a face of the film");
        let corner = |node: &u32| faces[face].iter().position(|other| other == node);
        let corners = nodes.each_ref().map(|node| corner(node).expect("a corner"));
        (face, corners)
    };
    let all = system.face_stiffness(&state.creep, &state.positions, 0.0);
    let nodes: Vec<[u32; 3]> = all.map(|(nodes, _)| nodes).collect();
    let elements = nodes.len() - model.closure.len();
    let kinds = (0..nodes.len()).map(|index| index >= elements);
    nodes.iter().zip(kinds).map(|(nodes, closing)| place(*nodes, closing)).collect()
}
