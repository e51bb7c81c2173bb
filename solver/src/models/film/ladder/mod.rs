//! The static equilibria with which the runs of one design are compared.
//!
//! ```text
//! p(x) = p_d 4^x                x: level;  p_d: design overpressure, p_d r/(E t) = 1e-4
//! rungs                         x = -3 … 10, whole numbers
//! between two rungs             linear in q = ln λ + λ/0.006, λ = p r/(E t); halved until that errs by less than
//!                               0.3 % at the middle, in volume and height
//! start of rung x ≥ 2           the erected shape
//! start of rung x < 2           rung x + 1
//! start of a middle             the upper end of its interval
//! ```
//!
//! A state is computed when a run needs it and then kept. Which states exist depends on the runs so far, but
//! each state depends on the design alone, since its start is fixed; and which states a pressure uses depends
//! on these states alone. So a run has the same reference whatever other runs did. The middle is a state
//! too; the error of linear interpolation in its halves is about a quarter of that in the whole: below 0.1 %.
//! Shapes of stiff film are linear in ln λ, those of compliant film nearly linear in λ.

use std::collections::BTreeMap;

use super::statics::{Erected, erected};
use crate::geometry::field::Field;
use crate::output::measures::{NoReference, StaticShape, design_overpressure};
use crate::platform::simd::InstructionSet;
use crate::scene::Scene;
use crate::scene::error::SceneError;
use crate::statics::{Continues, StaticFailure, StaticFailureKind};

mod interpolation;

use interpolation::{between, relative_error};

/// Ratio of the pressures of two rungs. Chosen: the start of a search is near enough, and one middle is
/// enough for stiff film.
const RUNG_RATIO: f64 = 4.0;
/// Steps of the grid of levels between two rungs: 2 to the power of the deepest halving.
const STEPS_PER_RUNG: i32 = 64;
/// Lowest rung. Chosen: p r/(E t) = 1.6e-6, below which the shape hardly depends on the pressure.
const LOWEST_RUNG: i32 = -3;
/// Highest rung. Chosen: p r/(E t) = 105, more than film bears.
const HIGHEST_RUNG: i32 = 10;
/// Lowest rung that starts from the erected shape. Chosen: p r/(E t) = 1.6e-3; below, the rung above is
/// nearer.
const LOWEST_ERECTED_RUNG: i32 = 2;
/// Largest error of linear interpolation at the middle of an interval, relative. Chosen: an accepted half
/// errs by about a quarter of it.
const MAX_MIDDLE_ERROR: f64 = 3e-3;

/// A level on the grid of levels: x times [`STEPS_PER_RUNG`].
pub type Level = i32;

/// Static equilibria of one design, film and supports.
#[derive(Debug, Clone)]
pub struct Ladder {
    instruction_set: InstructionSet,
    scene: Scene,
    /// p(0), Pa.
    design_overpressure: f64,
    /// Built when the first state is computed.
    capsule: Option<Erected>,
    states: BTreeMap<Level, Result<StaticShape, NoReference>>,
    /// Positions of computed states, m: starts of further states. Computed again if missing.
    positions: BTreeMap<Level, Field>,
}

impl Ladder {
    /// The ladder of a [`super::reference_scene`].
    pub fn new(instruction_set: InstructionSet, scene: &Scene) -> Result<Self, SceneError> {
        let film = &scene.film;
        Ok(Self {
            instruction_set,
            scene: scene.clone(),
            design_overpressure: design_overpressure(
                scene.design.mean_radius()?,
                film.youngs_modulus,
                film.thickness,
            ),
            capsule: None,
            states: BTreeMap::new(),
            positions: BTreeMap::new(),
        })
    }

    /// Number of equilibria computed so far.
    pub fn states(&self) -> usize {
        self.states.values().filter(|state| state.is_ok()).count()
    }

    /// Forgets the positions of the nodes, which take most memory. Results stay the same.
    pub fn forget_positions(&mut self) {
        self.positions.clear();
        self.capsule = None;
    }

    /// The design shape. `continues` is called at every iteration of a search; when it returns `false` the
    /// search ends.
    pub fn design(&mut self, continues: Continues<'_>) -> Result<StaticShape, NoReference> {
        self.state(0, continues)
    }

    /// The static shape at an overpressure (Pa). Below the lowest rung, also at 0 and below, it is that of
    /// the lowest rung, with the overpressure of that rung: a folded capsule without gas is stalled.
    pub fn at(
        &mut self,
        overpressure: f64,
        continues: Continues<'_>,
    ) -> Result<StaticShape, NoReference> {
        let lowest = LOWEST_RUNG * STEPS_PER_RUNG;
        if overpressure <= self.pressure(lowest) {
            return self.state(lowest, continues);
        }
        let rungs = (LOWEST_RUNG..HIGHEST_RUNG).map(|rung| rung * STEPS_PER_RUNG);
        let Some(low) =
            rungs.into_iter().find(|low| overpressure <= self.pressure(low + STEPS_PER_RUNG))
        else {
            let largest = self.pressure(HIGHEST_RUNG * STEPS_PER_RUNG);
            return Err(NoReference::Overload { overpressure, largest });
        };
        match self.interpolated(low, overpressure, continues) {
            // A state of the ladder is missing: one more search, for this pressure.
            Err(NoReference::NoEquilibrium { .. }) => {
                self.alone(overpressure, continues).map(|(shape, _)| shape)
            }
            found => found,
        }
    }

    /// The shape between the rung `low` and the next one, by halving.
    fn interpolated(
        &mut self,
        low: Level,
        overpressure: f64,
        continues: Continues<'_>,
    ) -> Result<StaticShape, NoReference> {
        let unit = self.design_overpressure;
        let (mut low, mut high) = (low, low + STEPS_PER_RUNG);
        loop {
            let above = self.state(high, continues)?;
            let below = self.state(low, continues)?;
            let middle_level = i32::midpoint(low, high);
            let middle = self.state(middle_level, continues)?;
            let upper_half = overpressure > middle.overpressure;
            let half = if upper_half { [middle, above] } else { [below, middle] };
            let error = relative_error(between(unit, [below, above], middle.overpressure), middle);
            if high - low == 2 || error <= MAX_MIDDLE_ERROR {
                return Ok(between(unit, half, overpressure));
            }
            *(if upper_half { &mut low } else { &mut high }) = middle_level;
        }
    }

    /// p(x), Pa.
    fn pressure(&self, level: Level) -> f64 {
        let x = f64::from(level) / f64::from(STEPS_PER_RUNG);
        self.design_overpressure * libm::pow(RUNG_RATIO, x)
    }

    /// The state of a level, computed if it is not known.
    fn state(
        &mut self,
        level: Level,
        continues: Continues<'_>,
    ) -> Result<StaticShape, NoReference> {
        if let Some(known) = self.states.get(&level) {
            return known.clone();
        }
        let found = self.compute(level, continues);
        if found != Err(NoReference::Stopped) {
            self.states.insert(level, found.clone());
        }
        found
    }

    /// Computes the state of a level and keeps its positions.
    fn compute(
        &mut self,
        level: Level,
        continues: Continues<'_>,
    ) -> Result<StaticShape, NoReference> {
        let overpressure = self.pressure(level);
        let capsule = match start_of(level) {
            None => self.capsule()?.clone(),
            Some(start) => match self.positions_of(start, continues) {
                Ok(positions) => {
                    let from = self.pressure(start);
                    self.capsule()?.at_equilibrium(positions, from)
                }
                Err(NoReference::Stopped) => return Err(NoReference::Stopped),
                Err(_) => self.capsule()?.clone(),
            },
        };
        let erected = capsule.equilibrium_at.is_none();
        let found = match Self::settled(capsule, overpressure, continues) {
            Err(NoReference::NoEquilibrium { .. }) if !erected => {
                self.alone(overpressure, continues)
            }
            found => found,
        };
        let (shape, positions) = found?;
        self.positions.insert(level, positions);
        Ok(shape)
    }

    /// The positions of the nodes of a level, m; computed again if they are not kept.
    fn positions_of(
        &mut self,
        level: Level,
        continues: Continues<'_>,
    ) -> Result<Field, NoReference> {
        self.state(level, continues)?;
        if !self.positions.contains_key(&level) {
            self.compute(level, continues)?;
        }
        Ok(self.positions[&level].clone())
    }

    /// Shape and positions at an overpressure (Pa), from the erected shape.
    fn alone(
        &mut self,
        overpressure: f64,
        continues: Continues<'_>,
    ) -> Result<(StaticShape, Field), NoReference> {
        let capsule = self.capsule()?.clone();
        Self::settled(capsule, overpressure, continues)
    }

    /// Shape and positions of the equilibrium of a capsule at this overpressure (Pa).
    fn settled(
        mut capsule: Erected,
        overpressure: f64,
        continues: Continues<'_>,
    ) -> Result<(StaticShape, Field), NoReference> {
        let found = capsule.settle_while(overpressure, continues);
        let state = found.map_err(|failure: StaticFailure| match failure.kind {
            StaticFailureKind::Stopped => NoReference::Stopped,
            _ => NoReference::NoEquilibrium { overpressure, problem: failure.to_string() },
        })?;
        let shape = StaticShape { overpressure, volume: state.volume, height: state.height };
        Ok((shape, state.positions))
    }

    /// The erected capsule.
    fn capsule(&mut self) -> Result<&Erected, NoReference> {
        let capsule = match self.capsule.take() {
            Some(capsule) => capsule,
            None => erected(self.instruction_set, &self.scene)
                .map_err(|error| NoReference::NoCapsule(error.to_string()))?,
        };
        Ok(self.capsule.insert(capsule))
    }
}

/// The level from whose positions the search of a level starts; `None` for the erected shape.
fn start_of(level: Level) -> Option<Level> {
    if level % STEPS_PER_RUNG != 0 {
        // The lowest bit of a middle is half the width of its interval.
        return Some(level + (1 << level.trailing_zeros()));
    }
    (level < LOWEST_ERECTED_RUNG * STEPS_PER_RUNG).then_some(level + STEPS_PER_RUNG)
}

#[cfg(test)]
mod tests;
