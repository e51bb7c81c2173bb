//! Continuation to a static equilibrium: descending pressures, held nodes moved in parts, relaxation if
//! Newton's method fails.
//!
//! ```text
//! p_k = p_0 (p/p_0)^(k/n),  k = 0 … n      p_0 = 0.5 E t/L
//! c_k = max(0.01 p_k L/(E t), c), at least 0.001 while p_k L/(E t) ≥ 0.008; c in the last step
//! ```
//!
//! Slack or flat film of extent L converges fastest under a pressure p0 that makes it taut everywhere;
//! the equilibrium then follows the pressure down to p. Film that starts full, near its shape, begins at
//! a tenth of that pressure. From there, and from a known equilibrium, the first attempt goes to a near p in
//! one step; if it fails, pressures descend as above. At intermediate pressures film has a compression
//! fraction `c_k` in proportion to the pressure, so that its shape hardly depends on it and each pressure
//! needs few steps; the last step has the fraction of the film. Wrinkled film has many energy minima near
//! each other. Descending pressures reach the minimum that continues the taut film, with its symmetry; a
//! start at the final pressure ends with dents.

use nalgebra::Vector3;

use super::equations::Equations;
use super::newton::{
    Continues, Equilibrium, FIRST_SHIFT, NEAR_SHIFT, NewtonSearch, StaticFailure,
    StaticFailureKind, Tolerances, extent, tensile_stiffness,
};
use super::relaxation::Relaxation;
use crate::geometry::field::Field;
use crate::integrators::{FilmSimulation, SimulationSettings};
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::pressure::volume;
use crate::mechanics::gas::GasState;
use crate::mechanics::resultants::thickness;
use crate::mechanics::supports::Supports;
use crate::system::{FilmSystem, PressureLoad};

/// p L/(E t) of the first pressure. Chosen.
const FIRST_LOAD: f64 = 0.5;
/// p L/(E t) of the first pressure for film that starts full. Chosen.
const FIRST_LOAD_FULL: f64 = 0.05;
/// Lower bound of V/A^(3/2) of full film: 0.094 for a sphere, 0 for flat film. Chosen.
const MIN_FULLNESS: f64 = 0.03;
/// Compression fraction of an intermediate step over its p L/(E t). Chosen.
const COMPRESSION_PER_LOAD: f64 = 0.01;
/// Lower bound of the compression fraction of an intermediate step whose p L/(E t) is at least
/// [`MIN_COMPRESSION_LOAD`]. Chosen.
const MIN_COMPRESSION: f64 = 1e-3;
/// p L/(E t) from which [`MIN_COMPRESSION`] holds. Chosen.
const MIN_COMPRESSION_LOAD: f64 = 8e-3;
/// Upper bound of the ratio of two successive pressures. Chosen.
const MAX_PRESSURE_RATIO: f64 = 4.0;
/// Upper bound of the ratio of a known equilibrium's pressure to the pressure asked for in one step. Chosen.
const MAX_DIRECT_RATIO: f64 = 12.0;
/// Upper bound of the number of Newton steps of an attempt in one step. Chosen.
const DIRECT_ITERATIONS: u32 = 40;
/// Upper bound of the number of Newton steps of a whole search. Chosen.
const SEARCH_ITERATIONS: u32 = 2000;
/// Number of parts of the motion of held nodes, one attempt after the other. Chosen.
const MOTION_PARTS: [u32; 3] = [1, 4, 16];
/// Steps of the relaxation after a failure of Newton's method. Chosen.
const RELAXATION_STEPS: u64 = 20_000;

/// Tolerances of intermediate equilibria. Chosen.
const INTERMEDIATE: Tolerances = Tolerances { residual: 1e-3, step: 1e-3, iterations: 80 };

/// Finds the static equilibrium of film under its fixed overpressure from these positions (m), with moving supports at the
/// end of their motion. `from` (Pa): the overpressure at which the positions already are an equilibrium,
/// if they are; the continuation starts there.
pub fn settle(
    film: &FilmSystem,
    positions: &Field,
    from: Option<f64>,
    tolerances: &Tolerances,
    continues: Continues<'_>,
) -> Result<Equilibrium, StaticFailure> {
    let mut continuation = Continuation {
        film,
        equations: Equations::new(film, positions),
        tolerances,
        continues,
        iterations: 0,
    };
    let stages = stages(film, positions, from);
    if let Some(before) = short_path(film, positions, from, stages[0]) {
        match continuation.run_short(positions, &before) {
            Err(failure) if failure.kind != StaticFailureKind::Stopped => {}
            ended => return ended,
        }
    }
    let moves = !film.supports.movers.is_empty();
    let attempts = if moves { &MOTION_PARTS[..] } else { &MOTION_PARTS[..1] };
    let mut last = None;
    for parts in attempts {
        match continuation.run(positions, &stages, *parts) {
            Ok(found) => return Ok(found),
            Err(failure) if failure.kind == StaticFailureKind::Stopped => return Err(failure),
            Err(failure) => last = Some(failure),
        }
    }
    Err(last.expect("at least one attempt"))
}

/// One load of the continuation.
#[derive(Debug, Clone, Copy)]
struct Stage {
    /// Overpressure, Pa.
    overpressure: f64,
    /// Compression fraction.
    compression: f64,
}

impl Stage {
    /// The load of film, which is fixed.
    fn of(film: &FilmSystem) -> Self {
        let overpressure = film.overpressure_at(f64::NAN);
        Self { overpressure, compression: film.model.material.compression }
    }
}

/// The loads of the continuation; the final one is last.
fn stages(film: &FilmSystem, positions: &Field, from: Option<f64>) -> Vec<Stage> {
    let unit = tensile_stiffness(&film.model) / extent(positions);
    let last = Stage::of(film);
    let Stage { overpressure: pressure, compression } = last;
    if pressure == 0.0 {
        return vec![last];
    }
    let intermediate = |overpressure: f64| {
        let load = overpressure.abs() / unit;
        let min = if load >= MIN_COMPRESSION_LOAD { MIN_COMPRESSION } else { 0.0 };
        let compression = compression.max(min).max(COMPRESSION_PER_LOAD * load);
        Stage { overpressure, compression }
    };
    let first_load =
        if fullness(&film.model, positions) > MIN_FULLNESS { FIRST_LOAD_FULL } else { FIRST_LOAD };
    let first = from.map_or(first_load * unit, f64::abs);
    let ratio = (first / pressure.abs()).max(1.0);
    let count = (libm::log(ratio) / libm::log(MAX_PRESSURE_RATIO)).ceil();
    let mut all = Vec::new();
    // A known equilibrium is not computed again.
    let mut k = if from.is_some() { 1.0 } else { 0.0 };
    while k < count {
        all.push(intermediate(pressure * libm::pow(ratio, (count - k) / count)));
        k += 1.0;
    }
    all.extend([intermediate(pressure), last]);
    all
}

/// The loads before the last of a path in one step: the first stage, or none from a known equilibrium.
/// `None` if the pressure is too far away, or the film neither known nor full.
fn short_path(
    film: &FilmSystem,
    positions: &Field,
    from: Option<f64>,
    first: Stage,
) -> Option<Vec<Stage>> {
    let limit = MAX_DIRECT_RATIO * Stage::of(film).overpressure.abs();
    let near = |pressure: f64| pressure.abs() <= limit;
    if let Some(from) = from {
        return near(from).then(Vec::new);
    }
    let full = fullness(&film.model, positions) > MIN_FULLNESS;
    (full && near(first.overpressure)).then(|| vec![first])
}

/// V/A^(3/2), A the film's area free of stress.
fn fullness(model: &FilmModel, positions: &Field) -> f64 {
    let area: f64 = (0..model.elements())
        .map(|element| model.volume[element] / thickness(model, element))
        .sum();
    volume(model, positions) / (area * area.sqrt())
}

/// A continuation in progress.
struct Continuation<'a, 'b> {
    film: &'a FilmSystem,
    equations: Equations,
    tolerances: &'a Tolerances,
    continues: Continues<'b>,
    iterations: u32,
}

impl Continuation<'_, '_> {
    /// Moves held nodes, then follows these loads, and in one step takes the load asked for.
    fn run_short(
        &mut self,
        positions: &Field,
        before: &[Stage],
    ) -> Result<Equilibrium, StaticFailure> {
        let mut positions = positions.clone();
        move_held(&self.film.supports, &mut positions, 1.0);
        for stage in before {
            positions = self.approach(positions, *stage, FIRST_SHIFT)?;
        }
        let limit = self.tolerances.iterations.min(DIRECT_ITERATIONS);
        let tolerances = Tolerances { iterations: limit, ..*self.tolerances };
        let found = self.equilibrium(positions, Stage::of(self.film), NEAR_SHIFT, &tolerances);
        self.counted(found)
    }

    /// Moves held nodes in `parts`, then follows the loads.
    fn run(
        &mut self,
        positions: &Field,
        stages: &[Stage],
        parts: u32,
    ) -> Result<Equilibrium, StaticFailure> {
        let mut positions = positions.clone();
        for part in 1..=parts {
            move_held(&self.film.supports, &mut positions, f64::from(part) / f64::from(parts));
            if part < parts {
                positions = self.approach(positions, stages[0], FIRST_SHIFT)?;
            }
        }
        let (last, before) = stages.split_last().expect("the load asked for");
        let mut shift = FIRST_SHIFT;
        for stage in before {
            positions = self.approach(positions, *stage, shift)?;
            shift = NEAR_SHIFT;
        }
        let found = match self.equilibrium(positions, *last, shift, self.tolerances) {
            Err(failure) if !is_final(&failure) => match relaxed(self.film, &failure.positions) {
                Some(positions) => self.equilibrium(positions, *last, FIRST_SHIFT, self.tolerances),
                None => Err(failure),
            },
            found => found,
        };
        self.counted(found)
    }

    /// A result with the number of steps of the whole search.
    fn counted(
        &self,
        found: Result<Equilibrium, StaticFailure>,
    ) -> Result<Equilibrium, StaticFailure> {
        let iterations = self.iterations;
        match found {
            Ok(found) => Ok(Equilibrium { iterations, ..found }),
            Err(failure) => Err(StaticFailure { iterations, ..failure }),
        }
    }

    /// Positions near the equilibrium of an intermediate load.
    fn approach(
        &mut self,
        positions: Field,
        stage: Stage,
        shift: f64,
    ) -> Result<Field, StaticFailure> {
        match self.equilibrium(positions, stage, shift, &INTERMEDIATE) {
            Ok(found) => Ok(found.positions),
            Err(failure) if is_final(&failure) => Err(failure),
            Err(failure) => Ok(*failure.positions),
        }
    }

    /// The equilibrium of one load. Counts its steps.
    fn equilibrium(
        &mut self,
        positions: Field,
        stage: Stage,
        shift: f64,
        tolerances: &Tolerances,
    ) -> Result<Equilibrium, StaticFailure> {
        let mut film = self.film.clone();
        film.pressure_load = PressureLoad::Overpressure(stage.overpressure);
        film.model.material.compression = stage.compression;
        let remaining = SEARCH_ITERATIONS.saturating_sub(self.iterations);
        let tolerances =
            &Tolerances { iterations: tolerances.iterations.min(remaining), ..*tolerances };
        let mut search = NewtonSearch::new(&film, &mut self.equations, positions);
        let found = search.run(shift, tolerances, &mut *self.continues);
        self.iterations += match &found {
            Ok(found) => found.iterations,
            Err(failure) => failure.iterations,
        };
        found
    }
}

/// Whether a failure leaves no positions to continue from.
fn is_final(failure: &StaticFailure) -> bool {
    matches!(failure.kind, StaticFailureKind::Stopped | StaticFailureKind::NotFinite)
}

/// Moves held nodes to this fraction of their motion.
fn move_held(supports: &Supports, positions: &mut Field, fraction: f64) {
    for mover in &supports.movers {
        let start = mover.motion.from;
        let time = start + (mover.motion.to - start) * fraction;
        for (node, target) in mover.positions(time) {
            let node = node as usize;
            let position = positions.get(node);
            positions.set(node, position + mover.held * (target - position));
        }
    }
}

/// Positions after a damped motion from these (m); `None` if they are not finite.
fn relaxed(film: &FilmSystem, positions: &Field) -> Option<Field> {
    let mut system = film.clone();
    // Moving supports are at the end of their motion.
    system.supports.movers.clear();
    let settings =
        SimulationSettings { cfl: Relaxation::default().cfl, ..SimulationSettings::default() };
    let at_rest = Field::zeros(film.model.nodes());
    let overpressure = Stage::of(film).overpressure;
    let film =
        FilmSimulation::new(system, settings, positions.clone(), at_rest, GasState::default());
    let relaxation = Relaxation { step_limit: RELAXATION_STEPS, ..Relaxation::default() };
    // An unfinished relaxation is a good start too, as long as it is finite.
    let film = match relaxation.relax_at(film, overpressure) {
        Ok(film) => film,
        Err(unsettled) => unsettled.film,
    };
    let (_, state, _) = film.into_parts();
    let finite = state.positions.iter().all(|position: Vector3<f64>| position.norm().is_finite());
    finite.then_some(state.positions)
}
