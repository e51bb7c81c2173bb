//! Newton's method for a static equilibrium.
//!
//! ```text
//! (K + μ ω² M) d = r            r: forces along the unknowns
//! x ← x + α d                    |d·r(x + α d)| ≤ ½ d·r(x)
//! ```
//!
//! Symbols: K tangent stiffness; M lumped mass; ω largest frequency of an element, so that ω² M has the
//! size of K; μ a shift that makes the matrix positive definite. It grows while the matrix is not positive
//! definite and shrinks after a full step. The line search finds α from the residual along the step
//! alone. That is the slope of the energy, and it also exists without an energy (open film under a
//! follower pressure). A step to a smaller slope lowers the energy.
//!
//! ```text
//! |r| ≤ 4 ε E t max|x| √n        r is rounding: ε that of f64, n elements
//! ```
//! Such a residual ends the search whatever the tolerances ask: nothing lowers it, and a step from it along a rigid
//! motion, which only μ resists, may be long.

use nalgebra::Vector3;

use super::equations::Equations;
use crate::factorisation::unknowns::dot;
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::membrane::{ElementHistory, NodeForces, assemble_conservative};
use crate::mechanics::forces::pressure::add_closure;
use crate::mechanics::resultants::thickness;
use crate::system::FilmSystem;

/// Tolerances of an equilibrium, and the limit of steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// Upper bound of the residual force over the load (Euclidean norms), a fraction.
    pub residual: f64,
    /// Upper bound of the largest displacement of the next Newton step over the size of the film.
    pub step: f64,
    /// Number of steps after which the search fails.
    pub iterations: u32,
}

impl Default for Tolerances {
    fn default() -> Self {
        Self { residual: 1e-7, step: 1e-6, iterations: 400 }
    }
}

/// Called at every step of a search; `false` ends it.
pub type Continues<'a> = &'a mut dyn FnMut() -> bool;

/// Why a search found no equilibrium.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum StaticFailureKind {
    /// It reached the limit of steps.
    #[error("the search reached its limit of steps")]
    IterationLimit,
    /// No step lowers the residual, and the residual is not small.
    #[error("no step lowers the residual")]
    Stalled,
    /// A force is not finite.
    #[error("a force is not finite")]
    NotFinite,
    /// The caller ended the search.
    #[error("the search was stopped")]
    Stopped,
}

/// A search that found no equilibrium.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "no static equilibrium found: {kind}, after {iterations} Newton steps, residual {residual:e} of the load, \
     largest at node {node}"
)]
pub struct StaticFailure {
    /// Why it ended.
    pub kind: StaticFailureKind,
    /// Residual force over the load, a fraction.
    pub residual: f64,
    /// Node with the largest residual force.
    pub node: usize,
    /// Steps taken.
    pub iterations: u32,
    /// Last positions of the nodes, m: not a result, but a start for another attempt.
    pub positions: Box<Field>,
}

/// A static equilibrium found by Newton's method.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// Positions of the nodes, m.
    pub positions: Field,
    /// Forces of film, pressure and weight on the nodes, N. At held nodes the supports balance them.
    pub forces: Field,
    /// Steps taken.
    pub iterations: u32,
    /// Residual force over the load, a fraction.
    pub residual: f64,
}

/// Lower bound of μ. It determines rigid motions and slack film. Chosen.
const MIN_SHIFT: f64 = 1e-12;
/// μ of the first step from any positions. Chosen.
pub(super) const FIRST_SHIFT: f64 = 1e-7;
/// μ of the first step from an equilibrium under another load. Chosen.
pub(super) const NEAR_SHIFT: f64 = 1e-9;
/// Upper bound of μ. With a larger one steps are too small to move anything. Chosen.
const MAX_SHIFT: f64 = 1e4;
/// Upper bound of μ at an equilibrium: with a larger μ a small step proves nothing. Chosen.
const MAX_SETTLED_SHIFT: f64 = 1e-6;
/// Upper bound of a residual of rounding over ε E t max|x| √n. Measured on spheres of 50 to 50,000 elements at 1 Pa.
const ROUNDING: f64 = 4.0;
/// Upper bound of the largest displacement of a step over the size of the film. Chosen.
const MAX_STEP: f64 = 0.1;
/// Upper bound of the number of evaluations in a line search. Chosen.
const MAX_LINE_SEARCH_ITERATIONS: u32 = 40;
/// Upper bound of the slope after a line search over the slope at its start. Chosen.
const MAX_SLOPE_RATIO: f64 = 0.5;

/// Finds a static equilibrium of film under its fixed overpressure by descent from these positions (m). Held nodes
/// do not move; movers hold theirs at the present positions.
///
/// # Errors
/// [`StaticFailure`] if none is found: positions outside the tolerances are never a result.
pub fn equilibrium(
    film: &FilmSystem,
    positions: Field,
    tolerances: &Tolerances,
    continues: Continues<'_>,
) -> Result<Equilibrium, StaticFailure> {
    let mut equations = Equations::new(film, &positions);
    NewtonSearch::new(film, &mut equations, positions).run(FIRST_SHIFT, tolerances, continues)
}

/// A search in progress.
pub(super) struct NewtonSearch<'a> {
    film: &'a FilmSystem,
    equations: &'a mut Equations,
    /// p, Pa; NaN for film with gas.
    overpressure: f64,
    positions: Field,
    /// Scratch: trial positions, element histories, node forces.
    trial: Field,
    element_history: Vec<[ElementHistory; 2]>,
    nodes: NodeForces,
    /// Forces on the nodes, and along the unknowns, at the last trial positions.
    forces: Field,
    along: Vec<f64>,
    iterations: u32,
}

impl<'a> NewtonSearch<'a> {
    /// A search of film from these positions (m). `equations` serve any load of it.
    pub(super) fn new(
        film: &'a FilmSystem,
        equations: &'a mut Equations,
        positions: Field,
    ) -> Self {
        let model = &film.model;
        Self {
            film,
            equations,
            overpressure: film.overpressure_at(f64::NAN),
            trial: positions.clone(),
            positions,
            element_history: ElementHistory::zero(model),
            nodes: film.no_forces(),
            forces: Field::zeros(model.nodes()),
            along: Vec::new(),
            iterations: 0,
        }
    }

    /// Computes the forces at the positions plus `fraction` times `step` (m).
    fn evaluate(&mut self, step: &[f64], fraction: f64) {
        self.trial.clone_from(&self.positions);
        if !step.is_empty() {
            self.equations.unknowns.shift(&mut self.trial, step, fraction);
        }
        let model = &self.film.model;
        model.closure_nodes.place(&mut self.trial);
        let _ = assemble_conservative(
            self.film.instruction_set,
            model,
            &self.trial,
            &[],
            &mut self.element_history,
            &mut self.nodes,
        );
        let _ = add_closure(model, &self.trial, &mut self.nodes);
        self.film.term_forces(&self.trial, &self.film.unyielded(), &mut self.nodes);
        for node in 0..model.nodes() {
            self.forces.set(node, self.film.node_force(&self.nodes, self.overpressure, node));
        }
        self.along = self.equations.unknowns.gather(&self.forces);
    }

    /// Norm of the load, N: pressure, weight, forces on planes and support forces.
    fn load(&self) -> f64 {
        let FilmSystem { model, supports, gravity, .. } = self.film;
        let mut sum: f64 = self.equations.unknowns.force.iter().map(|force| force * force).sum();
        for node in 0..model.nodes() {
            let pressure = self.nodes.area(node) * self.overpressure;
            let force = self.forces.get(node);
            let support = force - supports.projector(node) * force;
            sum += pressure.norm_squared() + support.norm_squared();
            sum += (gravity * model.mass[node]).norm_squared();
        }
        sum.sqrt()
    }

    /// Residual force, N.
    fn residual_force(&self) -> f64 {
        self.along.iter().map(|force| force * force).sum::<f64>().sqrt()
    }

    /// Residual force over the load.
    fn residual(&self) -> f64 {
        let load = self.load();
        let residual = self.residual_force();
        // Without load and residual the film is in equilibrium.
        if residual > 0.0 { residual / load } else { 0.0 }
    }

    fn failure(&self, kind: StaticFailureKind) -> StaticFailure {
        let size = |node: usize| {
            let moves = self.equations.unknowns.of_node[node].iter();
            let squares = moves.map(|(unknown, _)| self.along[*unknown as usize]);
            squares.map(|force| force * force).sum::<f64>()
        };
        let node = (0..self.positions.len()).fold(0, |largest, node| {
            // NaN counts as the largest.
            if size(node) <= size(largest) { largest } else { node }
        });
        StaticFailure {
            kind,
            residual: self.residual(),
            node,
            iterations: self.iterations,
            positions: Box::new(self.positions.clone()),
        }
    }

    /// Runs the search. `first_shift` is μ of the first step.
    pub(super) fn run(
        &mut self,
        first_shift: f64,
        tolerances: &Tolerances,
        continues: Continues<'_>,
    ) -> Result<Equilibrium, StaticFailure> {
        let size = extent(&self.positions);
        let rounding = ROUNDING * rounding(&self.film.model, &self.positions);
        let (mut shift, mut fraction) = (first_shift, 0.0);
        // μ of the factor in memory.
        let mut factored: Option<f64> = None;
        self.evaluate(&[], 0.0);
        loop {
            let residual = self.residual();
            if !residual.is_finite() {
                return Err(self.failure(StaticFailureKind::NotFinite));
            }
            let rounds = self.residual_force() <= rounding;
            let is_small = rounds || residual <= tolerances.residual;
            let is_near = |displacement: f64| rounds || displacement <= tolerances.step * size;
            // After a full step the factor before it estimates the next step well enough.
            let settled =
                factored.filter(|shift| is_small && fraction >= 0.5 && *shift <= MAX_SETTLED_SHIFT);
            let estimate = settled.map(|_| self.step());
            if let Some(step) = estimate
                && is_near(self.equations.unknowns.largest(&step))
            {
                if !continues() {
                    return Err(self.failure(StaticFailureKind::Stopped));
                }
                return Ok(self.found(&step, residual));
            }
            shift = self.factor(shift)?;
            factored = Some(shift);
            let step = self.step();
            let along = dot(&step, &self.along);
            let displacement = self.equations.unknowns.largest(&step);
            if !continues() {
                return Err(self.failure(StaticFailureKind::Stopped));
            }
            if is_small && is_near(displacement) && shift <= MAX_SETTLED_SHIFT {
                return Ok(self.found(&step, residual));
            }
            if self.iterations >= tolerances.iterations {
                return Err(self.failure(StaticFailureKind::IterationLimit));
            }
            let max_step = MAX_STEP * size;
            let max_fraction = if displacement > max_step { max_step / displacement } else { 1.0 };
            fraction = self.line_search(&step, along, max_fraction);
            self.equations.unknowns.shift(&mut self.positions, &step, fraction);
            self.film.model.closure_nodes.place(&mut self.positions);
            self.iterations += 1;
            if fraction >= 0.5 {
                shift = (shift * 0.1).max(MIN_SHIFT);
            } else if fraction < 0.05 {
                shift *= 10.0;
            }
        }
    }

    /// Factorises the stiffness at the positions, with the smallest μ from `shift` on, in powers of ten,
    /// that makes it positive definite. Returns that μ.
    fn factor(&mut self, mut shift: f64) -> Result<f64, StaticFailure> {
        self.equations.assemble(self.film, self.overpressure, &self.positions);
        loop {
            if self.equations.factor(self.film, shift) {
                return Ok(shift);
            }
            shift *= 10.0;
            if shift > MAX_SHIFT {
                return Err(self.failure(StaticFailureKind::Stalled));
            }
        }
    }

    /// The equilibrium found, after a last full step, which is known already, if it lowers the residual:
    /// the reactions of a vessel then balance to rounding.
    fn found(&mut self, step: &[f64], residual: f64) -> Equilibrium {
        self.evaluate(step, 1.0);
        let mut last = self.residual();
        if last < residual {
            self.positions.clone_from(&self.trial);
        } else {
            self.evaluate(&[], 0.0);
            last = residual;
        }
        Equilibrium {
            positions: self.positions.clone(),
            forces: self.forces.clone(),
            iterations: self.iterations,
            residual: last,
        }
    }

    /// The step (m along the unknowns) by the factor in memory from the present forces.
    fn step(&mut self) -> Vec<f64> {
        self.equations.solve(self.film, &self.along)
    }

    /// The fraction α of a step to take: at most a few times `max_fraction`. Leaves the forces at the new
    /// positions.
    fn line_search(&mut self, step: &[f64], start: f64, max_fraction: f64) -> f64 {
        let (mut low, mut high) = ([0.0, start], [f64::INFINITY, 0.0]);
        let mut fraction = max_fraction;
        for _ in 0..MAX_LINE_SEARCH_ITERATIONS {
            self.evaluate(step, fraction);
            let work = dot(step, &self.along);
            if work.abs() <= MAX_SLOPE_RATIO * start {
                return fraction;
            }
            if work > 0.0 {
                // The energy still descends steeply: take a longer step, up to four times the first.
                low = [fraction, work];
                if high[0].is_infinite() && fraction >= 4.0 * max_fraction {
                    return fraction;
                }
            } else {
                high = [fraction, work];
            }
            fraction = if high[0].is_infinite() { 2.0 * fraction } else { between(low, high) };
        }
        // The longest step that surely lowers the energy.
        self.evaluate(step, low[0]);
        low[0]
    }
}

/// The fraction between `low` and `high` (fraction, work) at which the work vanishes by linear
/// interpolation, at least a tenth of the interval from both.
fn between(low: [f64; 2], high: [f64; 2]) -> f64 {
    let width = high[0] - low[0];
    let fraction = low[1] / (low[1] - high[1]);
    // If the work at `high` is not finite, stay near `low`.
    let fraction = if fraction.is_finite() { fraction.clamp(0.1, 0.9) } else { 0.1 };
    low[0] + fraction * width
}

/// ε E t max|x| √n, N: coordinates round, and strains with them.
fn rounding(model: &FilmModel, positions: &Field) -> f64 {
    let distance = positions.iter().fold(0.0, |largest: f64, x| largest.max(x.norm()));
    f64::EPSILON * tensile_stiffness(model) * distance * (model.elements() as f64).sqrt()
}

/// Largest tensile stiffness E t of the film, N/m.
pub(super) fn tensile_stiffness(model: &FilmModel) -> f64 {
    let thickest = (0..model.elements()).map(|element| thickness(model, element));
    thickest.fold(0.0, f64::max) * model.material.youngs_modulus
}

/// Diagonal of the bounding box of these positions, m.
pub(super) fn extent(positions: &Field) -> f64 {
    let side = |axis: &[f64]| {
        let low = axis.iter().copied().fold(f64::INFINITY, f64::min);
        axis.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low
    };
    Vector3::new(side(&positions.x), side(&positions.y), side(&positions.z)).norm()
}
