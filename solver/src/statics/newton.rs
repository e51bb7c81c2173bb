//! Newton's method for a static state.
//!
//! ```text
//! (K + μ ω² M) d = r            r: forces along the unknowns
//! x ← x + α d                    |d·r(x + α d)| ≤ ½ d·r(x)
//! ```
//!
//! Symbols: K tangent stiffness, M lumped mass, ω largest frequency of an element, so that ω² M is
//! of K's size; μ a shift that makes the matrix positive definite, raised where it is not, lowered
//! wherever a whole step is taken. The share α is found from the residual along the step alone: that
//! is the slope of the energy where there is one, and exists where there is none (open film under a
//! follower pressure). A step that goes on from where that slope falls loses energy.

use core::ops::ControlFlow;

use nalgebra::Vector3;

use super::factor::{Elimination, Factor};
use super::tangent::{self, Stiffness};
use super::unknowns::Unknowns;
use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::membrane::{NodeForces, ViscousHistory, assemble_membrane};
use crate::mechanics::forces::pressure::add_closure;
use crate::mechanics::resultants::thickness;
use crate::mechanics::supports::Supports;
use crate::platform::simd::InstructionSet;

/// Film, what holds it, and what loads it.
#[derive(Debug, Clone, Copy)]
pub struct Loaded<'a> {
    /// The film.
    pub model: &'a FilmModel,
    /// What holds it. Movers hold where the nodes are; they move nothing here.
    pub supports: &'a Supports,
    /// Overpressure, Pa.
    pub overpressure: f64,
    /// Acceleration of gravity, m/s².
    pub gravity: Vector3<f64>,
    /// Instruction set; the bits are the same on each.
    pub path: InstructionSet,
}

/// When a state counts as found, and when the search ends without one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settling {
    /// Residual force over the load, root of sums of squares.
    pub residual: f64,
    /// Largest displacement of Newton's next step over the size of the film.
    pub step: f64,
    /// Steps after which the search ends.
    pub iterations: u32,
}

impl Default for Settling {
    fn default() -> Self {
        Self { residual: 1e-7, step: 1e-6, iterations: 400 }
    }
}

/// How a search stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Iteration {
    /// Steps taken.
    pub index: u32,
    /// Residual force over the load.
    pub residual: f64,
    /// Largest displacement of the next step before it is cut, m.
    pub step: f64,
    /// μ.
    pub shift: f64,
    /// Share α of the last step.
    pub share: f64,
}

/// Hears of every step; may end the search.
pub type TunnellingMonitor<'a> = &'a mut dyn FnMut(&Iteration) -> ControlFlow<()>;

/// Why no state of rest was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StaticFailureKind {
    /// Not within the steps allowed.
    IterationLimit,
    /// No step along any direction lowers the residual, and it is not small.
    Stalled,
    /// A force is no number.
    NotFinite,
    /// The watcher ended the search.
    Stopped,
}

/// A search that found no state of rest.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "no static state ({kind:?}) after {iterations} Newton steps: residual {residual:e} of the load, \
     largest at node {node}"
)]
pub struct StaticFailure {
    /// What ended it.
    pub kind: StaticFailureKind,
    /// Residual force over the load.
    pub residual: f64,
    /// Node with the largest residual force.
    pub node: usize,
    /// Steps taken.
    pub iterations: u32,
    /// Where the nodes were left, m: no answer, but a start for another attempt.
    pub places: Box<Field>,
}

/// A static state as Newton's method leaves it.
#[derive(Debug, Clone, PartialEq)]
pub struct Rest {
    /// Places of the nodes, m.
    pub places: Field,
    /// Forces of film, pressure and weight on the nodes, N: what supports have to bear.
    pub forces: Field,
    /// Steps taken.
    pub iterations: u32,
    /// Residual force over the load.
    pub residual: f64,
    /// μ of the last step.
    pub shift: f64,
}

/// Least μ: what keeps rigid motions and slack film from being undetermined.
const LEAST_SHIFT: f64 = 1e-12;
/// μ of the first step.
const FIRST_SHIFT: f64 = 1e-7;
/// Largest μ: more moves nothing.
const LARGEST_SHIFT: f64 = 1e4;
/// μ up to which a small step means a state of rest.
const SETTLED_SHIFT: f64 = 1e-6;
/// Largest displacement of a step over the size of the film.
const LONGEST: f64 = 0.1;
/// Looks a line search may take.
const LOOKS: u32 = 40;
/// Part of the slope at the start that may be left.
const SLOPE_LEFT: f64 = 0.5;

/// Finds the state of rest nearest downhill from these places (m); held nodes stay where they are.
///
/// # Errors
/// [`StaticFailure`] when none is found: an unsettled state is never an answer.
pub fn equilibrium(
    loaded: &Loaded<'_>,
    places: Field,
    settling: &Settling,
    watch: TunnellingMonitor<'_>,
) -> Result<Rest, StaticFailure> {
    let unknowns = Unknowns::new(loaded.model, loaded.supports);
    let elimination = Elimination::new(loaded.model, &unknowns, &places);
    let mut search = CandidateList::new(loaded, unknowns, places);
    search.run(&elimination, settling, watch)
}

/// A search under way.
struct CandidateList<'a> {
    loaded: &'a Loaded<'a>,
    unknowns: Unknowns,
    places: Field,
    /// Room: trial places, what a pass remembers, node forces.
    trial: Field,
    past: Vec<[ViscousHistory; 2]>,
    nodes: NodeForces,
    /// Forces on nodes and along the unknowns at the last places looked at.
    forces: Field,
    along: Vec<f64>,
    iterations: u32,
}

impl<'a> CandidateList<'a> {
    fn new(loaded: &'a Loaded<'a>, unknowns: Unknowns, places: Field) -> Self {
        let model = loaded.model;
        Self {
            loaded,
            unknowns,
            trial: places.clone(),
            places,
            past: ViscousHistory::at_rest(model),
            nodes: NodeForces::new(model),
            forces: Field::zeros(model.nodes()),
            along: Vec::new(),
            iterations: 0,
        }
    }

    /// Forces with the nodes where they are, moved by `share` of `by` (m).
    fn look(&mut self, by: &[f64], share: f64) {
        self.trial.clone_from(&self.places);
        if !by.is_empty() {
            self.unknowns.shift(&mut self.trial, by, share);
        }
        let Loaded { model, overpressure, gravity, path, .. } = *self.loaded;
        let _ = assemble_membrane(path, model, &self.trial, 0.0, &mut self.past, &mut self.nodes);
        let _ = add_closure(model, &self.trial, &mut self.nodes);
        for node in 0..model.nodes() {
            let force = self.nodes.film(node)
                + self.nodes.area(node) * overpressure
                + gravity * model.mass[node];
            self.forces.set(node, force);
        }
        self.along = self.unknowns.gather(&self.forces);
    }

    /// Size of the load: pressure, weight, what pushes planes, and what supports bear.
    fn load(&self) -> f64 {
        let Loaded { model, overpressure, gravity, supports, .. } = *self.loaded;
        let mut sum: f64 = self.unknowns.force.iter().map(|force| force * force).sum();
        for node in 0..model.nodes() {
            let push = self.nodes.area(node) * overpressure;
            let force = self.forces.get(node);
            let borne = force - supports.projector(node) * force;
            sum += push.norm_squared() + borne.norm_squared();
            sum += (gravity * model.mass[node]).norm_squared();
        }
        sum.sqrt()
    }

    fn residual(&self) -> f64 {
        let load = self.load();
        let left = self.along.iter().map(|force| force * force).sum::<f64>().sqrt();
        // Film nothing loads is at rest where nothing pulls it.
        if left > 0.0 { left / load } else { 0.0 }
    }

    /// Stiffness of every face, film first.
    fn stiffness(&self) -> Vec<Stiffness> {
        let Loaded { model, overpressure, .. } = *self.loaded;
        let film = (0..model.elements()).map(|element| {
            tangent::elastic(model, &self.places, element)
                + tangent::pressure(model.triangles[element], &self.places, overpressure)
        });
        let closure =
            model.closure.iter().map(|face| tangent::pressure(*face, &self.places, overpressure));
        film.chain(closure).collect()
    }

    fn failure(&self, kind: StaticFailureKind) -> StaticFailure {
        let size = |node: usize| {
            let moves = self.unknowns.of_node[node].iter();
            let squares = moves.map(|(unknown, _)| self.along[*unknown as usize]);
            squares.map(|force| force * force).sum::<f64>()
        };
        let node = (0..self.places.len()).fold(0, |worst, node| {
            // No number counts as worst.
            if size(node) <= size(worst) { worst } else { node }
        });
        StaticFailure {
            kind,
            residual: self.residual(),
            node,
            iterations: self.iterations,
            places: Box::new(self.places.clone()),
        }
    }

    fn run(
        &mut self,
        elimination: &Elimination,
        settling: &Settling,
        watch: TunnellingMonitor<'_>,
    ) -> Result<Rest, StaticFailure> {
        let size = extent(&self.places);
        let omega = self.loaded.model.largest_frequency();
        let mass: Vec<f64> = self.unknowns.mass.iter().map(|m| m * omega * omega).collect();
        let (mut shift, mut share) = (FIRST_SHIFT, 0.0);
        self.look(&[], 0.0);
        loop {
            let residual = self.residual();
            if !residual.is_finite() {
                return Err(self.failure(StaticFailureKind::NotFinite));
            }
            let stiffness = self.stiffness();
            let factor = loop {
                let shifts: Vec<f64> = mass.iter().map(|mass| mass * shift).collect();
                if let Some(factor) = elimination.factor(self.loaded.path, &stiffness, &shifts) {
                    break factor;
                }
                shift *= 10.0;
                if shift > LARGEST_SHIFT {
                    return Err(self.failure(StaticFailureKind::Stalled));
                }
            };
            let (step, along) = self.step(elimination, &factor);
            let way = self.unknowns.largest(&step);
            let iteration = Iteration { index: self.iterations, residual, step: way, shift, share };
            if watch(&iteration).is_break() {
                return Err(self.failure(StaticFailureKind::Stopped));
            }
            if residual <= settling.residual
                && way <= settling.step * size
                && shift <= SETTLED_SHIFT
            {
                return Ok(Rest {
                    places: self.places.clone(),
                    forces: self.forces.clone(),
                    iterations: self.iterations,
                    residual,
                    shift,
                });
            }
            if self.iterations >= settling.iterations {
                return Err(self.failure(StaticFailureKind::IterationLimit));
            }
            let longest = if way > LONGEST * size { LONGEST * size / way } else { 1.0 };
            share = self.search(&step, along, longest);
            self.unknowns.shift(&mut self.places, &step, share);
            self.iterations += 1;
            if share >= 0.5 {
                shift = (shift * 0.1).max(LEAST_SHIFT);
            } else if share < 0.05 {
                shift *= 10.0;
            }
        }
    }

    /// The next step (m along the unknowns) and what the forces do along it, J.
    fn step(&self, elimination: &Elimination, factor: &Factor) -> (Vec<f64>, f64) {
        let step = elimination.solve(factor, &self.along);
        let work = dot(&step, &self.along);
        (step, work)
    }

    /// The share of a step to take, at most about `longest`; forces are left as they are there.
    fn search(&mut self, step: &[f64], start: f64, longest: f64) -> f64 {
        let (mut low, mut high) = ([0.0, start], [f64::INFINITY, 0.0]);
        let mut share = longest;
        for _ in 0..LOOKS {
            self.look(step, share);
            let work = dot(step, &self.along);
            if work.abs() <= SLOPE_LEFT * start {
                return share;
            }
            if work > 0.0 {
                // Downhill still, and steeply: on, but not past a few whole steps.
                low = [share, work];
                if high[0].is_infinite() && share >= 4.0 * longest {
                    return share;
                }
            } else {
                high = [share, work];
            }
            share = if high[0].is_infinite() { 2.0 * share } else { between(low, high) };
        }
        // As far as it surely goes downhill.
        self.look(step, low[0]);
        low[0]
    }
}

/// Where the work of a step vanishes between two shares, kept away from both.
fn between(low: [f64; 2], high: [f64; 2]) -> f64 {
    let width = high[0] - low[0];
    let part = low[1] / (low[1] - high[1]);
    // Where the far end is no number, or very steep, the near one decides.
    let part = if part.is_finite() { part.clamp(0.1, 0.9) } else { 0.1 };
    low[0] + part * width
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// E t of the thickest film, N/m.
pub(super) fn tensile_stiffness(model: &FilmModel) -> f64 {
    let thickest = (0..model.elements()).map(|element| thickness(model, element));
    thickest.fold(0.0, f64::max) * model.material.youngs_modulus
}

/// Longest diagonal of the box round these places, m.
pub(super) fn extent(places: &Field) -> f64 {
    let side = |axis: &[f64]| {
        let low = axis.iter().copied().fold(f64::INFINITY, f64::min);
        axis.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low
    };
    Vector3::new(side(&places.x), side(&places.y), side(&places.z)).norm()
}
