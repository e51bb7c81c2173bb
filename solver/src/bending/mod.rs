//! Bending of film between the edges of its mesh: one moment an edge.
//!
//! ```text
//! D = E t³/(12(1−ν²))
//! u_e = 2 tan(θ_e/2)                    turn of the film at an edge; θ angle between the two elements
//! t_T + t_T' = u_e − ū_e                slopes of both elements at the edge add up to the turn
//! S_T = Σ_i (2 t_i/h_i) n_i nᵢᵀ         curvature of an element; n_i normal of its edge i in its plane, h_i height
//! Π = Σ_T A_T D/2 ((1−ν) S:S + ν (tr S)²),  the smallest for all t
//! ```
//!
//! With the element matrix K of Π in t, and its inverse C, the moments that balance at every edge are
//!
//! ```text
//! Ĉ m = u − ū        Ĉ = Σ_T C_T, constant        Π = ½ m·(u − ū)        f = −Σ_e m_e ∂u_e/∂x
//! ```
//!
//! so no slope is an unknown of the motion, and Π is a function of the positions alone. For small turns this is the
//! plate element of L. S. D. Morley (1968), which is that of edge directors (E. Grinspun and others, "Computing
//! discrete shape operators on general meshes", 2006) and, with moments as unknowns, that of Hellan, Herrmann and
//! Johnson. It converges on every mesh tried (`docs/theory/bending.md`).
//!
//! The moment is zero on free edges, and on fold lines that turn freely. A crease is a fold line with stiffness:
//!
//! ```text
//! t_T + t_T' + m/(k l) = θ − θ̄        k = D/L*, l its length, θ̄ its rest angle
//! ```
//!
//! Film and creases may yield ([`Film::yield_moment`], M a metre). The curvature of the arc that touches both elements in
//! their middles, times D, is |m|/l: it stays below M. What an edge has yielded, p, is part of the state of the film:
//!
//! ```text
//! Ĉ m = u − ū − p        |m| ≤ M l        ṗ m ≥ 0, and 0 where |m| < M l
//! p_e ← p_e + sgn(m_e) (|m_e| − M l_e)/k_e    until |m| ≤ 1.01 M l; k_e: upper bound of Π over ½ (u − ū)²
//! ```
//!
//! An element that is held at all its nodes does not bend: film beside it is clamped. Beyond
//! [`hinges::MAX_SMOOTH_TURN`] the turn grows in proportion to θ.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use nalgebra::{DMatrix, SVector, Vector3};

use crate::factorisation::constant::{ConstantFactor, Work};
use crate::geometry::field::Field;
use crate::geometry::shell::Shell;
use crate::mechanics::energy_term::{EnergyTerm, Prepared, Yielding};
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::{InstructionSet, NodeSum};
use crate::scene::Film;

mod compliance;
pub mod hinges;
mod second_gradients;

use hinges::{HingeBlock, Hinges, largest_slope};

/// The bending energy of film. Constant during a run.
#[derive(Debug)]
pub struct Bending {
    hinges: Hinges,
    /// Factor of Ĉ.
    compliance: ConstantFactor,
    /// Upper bound of the energy over ½ (u − ū)² at each hinge, N m.
    stiffness: Vec<f64>,
    /// Largest moment of each hinge, N m; empty for film that does not yield.
    yield_moments: Vec<f64>,
    /// Upper bound of ω² of the film's masses, rad²/s².
    frequency_squared: f64,
    instruction_set: InstructionSet,
    /// Memory of an evaluation.
    scratch: Mutex<Scratch>,
}

#[derive(Debug, Clone, Default)]
struct Scratch {
    /// Shape of the hinges, block by block.
    blocks: Vec<HingeBlock>,
    /// u − ū of each hinge, less what it has yielded.
    turns: Vec<f64>,
    /// Of the solution for moments.
    work: Work,
    sums: Vec<NodeSum>,
}

impl Bending {
    /// The further energies of the film of a shell: its bending, if it has any. `held`: as in [`Self::new`].
    pub fn terms(
        film: &Film,
        model: &FilmModel,
        shell: &Shell,
        instruction_set: InstructionSet,
        held: impl Fn(u32) -> bool,
    ) -> Vec<Arc<dyn EnergyTerm>> {
        let new = || -> Arc<dyn EnergyTerm> {
            Arc::new(Self::new(film, model, shell, instruction_set, held))
        };
        film.bending.then(new).into_iter().collect()
    }

    /// The bending of the film of a shell. `held`: whether supports hold a node in all directions.
    pub fn new(
        film: &Film,
        model: &FilmModel,
        shell: &Shell,
        instruction_set: InstructionSet,
        held: impl Fn(u32) -> bool,
    ) -> Self {
        let rigid: Vec<bool> =
            model.triangles.iter().map(|nodes| nodes.iter().all(|node| held(*node))).collect();
        let hinges = Hinges::new(model, shell, &rigid, film.creases);
        let crease_stiffness =
            film.creases.map_or(0.0, |creases| film.bending_stiffness() / creases.length_scale);
        let mut scratch = Scratch::default();
        let (matrix, stiffness) = compliance::assembled(model, &hinges, &rigid, crease_stiffness);
        let compliance = ConstantFactor::new(&matrix, &compliance::middles(&hinges, shell));
        scratch.sums = vec![NodeSum::default(); model.nodes()];
        let yield_moments = film.yield_moment.map_or_else(Vec::new, |moment| {
            hinges.lengths.iter().map(|length| moment * length).collect()
        });
        let frequency_squared = frequency_squared(&hinges, &stiffness, &model.mass);
        let scratch = Mutex::new(scratch);
        Self {
            hinges,
            compliance,
            stiffness,
            yield_moments,
            frequency_squared,
            instruction_set,
            scratch,
        }
    }

    /// Computes the shapes of the hinges, and u − ū less what they have yielded, at these positions (m).
    fn measured(&self, positions: &Field, yielded: &[f64]) -> MutexGuard<'_, Scratch> {
        // A panic elsewhere leaves the memory of an evaluation complete: every one fills it again.
        let mut scratch = self.scratch.lock().unwrap_or_else(PoisonError::into_inner);
        let Scratch { blocks, turns, .. } = &mut *scratch;
        self.hinges.measure(self.instruction_set, positions, blocks, turns);
        for (turn, yielded) in turns.iter_mut().zip(yielded) {
            *turn -= yielded;
        }
        scratch
    }

    /// The moments (N m) of the hinges at these turns.
    fn solve(&self, turns: &[f64], work: &mut Work) -> Vec<f64> {
        let mut moments = vec![0.0; turns.len()];
        self.compliance.solve(self.instruction_set, turns, &mut moments, work);
        moments
    }

    /// [`Self::measured`], and the moments (N m) of the hinges.
    fn moments(&self, positions: &Field, yielded: &[f64]) -> (MutexGuard<'_, Scratch>, Vec<f64>) {
        let mut scratch = self.measured(positions, yielded);
        let Scratch { turns, work, .. } = &mut *scratch;
        let moments = self.solve(&turns[..self.hinges.len()], work);
        (scratch, moments)
    }
}

impl EnergyTerm for Bending {
    fn energy(&self, positions: &Field, yielded: &[f64]) -> f64 {
        let (scratch, moments) = self.moments(positions, yielded);
        0.5 * dot(&moments, &scratch.turns)
    }

    fn add_forces(&self, positions: &Field, yielded: &[f64], forces: &mut Field) {
        let (mut scratch, mut moments) = self.moments(positions, yielded);
        let Scratch { blocks, sums, .. } = &mut *scratch;
        self.hinges.add_forces(self.instruction_set, blocks, &mut moments, sums);
        add_sums(sums, forces);
    }

    fn yield_values(&self) -> usize {
        self.yield_moments.len()
    }

    /// Each round lowers Π plus M l times what yields, so moments fall to about M l; what the rounds leave yields later.
    fn let_yield(&self, positions: &Field, yielded: &mut [f64]) -> Yielding {
        if self.yield_moments.is_empty() {
            return Yielding::default();
        }
        let (mut scratch, mut moments) = self.moments(positions, yielded);
        let Scratch { turns, work, .. } = &mut *scratch;
        let stored = 0.5 * dot(&moments, turns);
        let before = yielded.to_vec();
        for _ in 0..MAX_ROUNDS {
            let (mut any, mut held) = (false, true);
            for (hinge, (moment, largest)) in moments.iter().zip(&self.yield_moments).enumerate() {
                let excess = moment.abs() - largest;
                if excess > 0.0 {
                    any = true;
                    let more = (excess / self.stiffness[hinge]).copysign(*moment);
                    yielded[hinge] += more;
                    turns[hinge] -= more;
                    held &= excess <= MAX_EXCESS * largest;
                }
            }
            if !any {
                break;
            }
            moments = self.solve(&turns[..self.hinges.len()], work);
            if held {
                break;
            }
        }
        let more: Vec<f64> = yielded.iter().zip(before).map(|(now, before)| now - before).collect();
        Yielding { work: dot(&moments, &more), released: stored - 0.5 * dot(&moments, turns) }
    }

    fn patches(&self) -> Vec<Vec<u32>> {
        self.hinges.nodes.iter().map(|nodes| nodes.to_vec()).collect()
    }

    /// Each hinge for itself: k (∂u/∂x)(∂u/∂x)ᵀ + m ∂²u/∂x². The first part is an upper bound of that of K.
    fn stiffness(&self, positions: &Field, yielded: &[f64], patches: &mut [DMatrix<f64>]) {
        let (scratch, moments) = self.moments(positions, yielded);
        let second = self.hinges.second_gradients(positions);
        for (hinge, patch) in patches.iter_mut().enumerate() {
            let gradient = Hinges::gradient(&scratch.blocks, hinge);
            let column = SVector::<f64, 12>::from_fn(|row, _| gradient[row / 3][row % 3]);
            let bound = column * column.transpose() * self.stiffness[hinge];
            patch.copy_from(&(bound + second[hinge] * moments[hinge]));
        }
    }

    /// K = (∂u/∂x)ᵀ Ĉ⁻¹ ∂u/∂x + Σ m ∂²u/∂x², from the patches.
    fn add_product(&self, stiffness: &Prepared<'_>, displacements: &Field, products: &mut Field) {
        let mut scratch = self.measured(stiffness.positions, &[]);
        let Scratch { blocks, sums, work, .. } = &mut *scratch;
        let mut turns = Vec::with_capacity(self.hinges.len());
        for (hinge, (nodes, patch)) in self.hinges.nodes.iter().zip(stiffness.patches).enumerate() {
            let gradient = Hinges::gradient(blocks, hinge);
            let moves = displacements.at(*nodes);
            let turn: f64 = moves.iter().zip(gradient).map(|(u, slope)| slope.dot(u)).sum();
            // The patch without its bound is m ∂²u/∂x².
            let along = SVector::<f64, 12>::from_fn(|row, _| moves[row / 3][row % 3]);
            let bent = patch * along;
            let bound = self.stiffness[hinge] * turn;
            for (corner, node) in nodes.iter().enumerate() {
                let node = *node as usize;
                let part = bent.fixed_rows::<3>(3 * corner) - gradient[corner] * bound;
                products.set(node, products.get(node) + part);
            }
            turns.push(turn);
        }
        let mut moments = self.solve(&turns, work);
        for moment in &mut moments {
            *moment = -*moment;
        }
        self.hinges.add_forces(self.instruction_set, blocks, &mut moments, sums);
        add_sums(sums, products);
    }

    /// It acts across the film, which is stiff only along itself.
    fn is_slow(&self) -> bool {
        true
    }

    /// With the masses of the film that it was made for.
    fn frequency_squared(&self, _: &[f64]) -> f64 {
        self.frequency_squared
    }
}

/// Rounds of yielding at most. Chosen: they halve a moment of 2 M l in creases of an L* down to a twentieth of the height
/// of the elements, and a step of motion adds less.
const MAX_ROUNDS: u32 = 200;
/// How far above M l, as a share of it, moments may be before the last round. Chosen: below the errors of a mesh.
const MAX_EXCESS: f64 = 1e-2;

/// The product of two columns, without what one has past the end of the other.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add_sums(sums: &[NodeSum], forces: &mut Field) {
    for (node, sum) in sums.iter().enumerate() {
        let [x, y, z, _] = sum.film;
        forces.set(node, forces.get(node) + Vector3::new(x, y, z));
    }
}

/// The largest sum over a row of M^−½ K M^−½, rad²/s², for the upper bound of K with the largest slope ∂u/∂θ.
fn frequency_squared(hinges: &Hinges, stiffness: &[f64], mass: &[f64]) -> f64 {
    let mut rows = vec![0.0; mass.len()];
    for ((nodes, leverages), stiffness) in hinges.nodes.iter().zip(&hinges.leverages).zip(stiffness)
    {
        let scaled: [f64; 4] = core::array::from_fn(|corner| {
            leverages[corner] * largest_slope() / mass[nodes[corner] as usize].sqrt()
        });
        let sum: f64 = scaled.iter().sum();
        for (node, entry) in nodes.iter().zip(scaled) {
            rows[*node as usize] += stiffness * entry * sum;
        }
    }
    rows.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
