//! The way to a static state: pressures falling, held nodes moved in parts, relaxation where Newton's
//! method alone is lost.
//!
//! ```text
//! p_k = p_0 (p/p_0)^(k/n),  k = 0 … n      p_0 = 0.5 E t/L
//! c_k = 0.01 p_k L/(E t), and at least 0.001 down to p L/(E t) = 0.008; the film's own at the end
//! ```
//!
//! Film of extent L that starts slack or flat finds its place soonest under a pressure that
//! stretches it all over, and then follows the pressure down; what starts full, near its shape,
//! begins at a tenth of that. On the way film keeps a stiffness against compression in proportion to
//! the pressure, so that its shape hardly depends on it and follows the pressure in a few steps; that
//! is let go last. Wrinkled film has many minima of energy near each other: this way keeps to the one
//! the taut film passes into, with the symmetry it has, where a start at the pressure asked for ends
//! in dents.

use nalgebra::Vector3;

use super::newton::{
    Loaded, Rest, Settling, StaticFailure, StaticFailureKind, TunnellingMonitor, equilibrium,
    extent, tensile_stiffness,
};
use super::relaxation::Relaxation;
use crate::geometry::field::Field;
use crate::integrators::explicit::{Explicit, Parameters, PressureLoad};
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::pressure::volume;
use crate::mechanics::gas::GasState;
use crate::mechanics::resultants::thickness;
use crate::mechanics::supports::Supports;

/// p L/(E t) of the first pressure.
const FIRST_STRETCH: f64 = 0.5;
/// The same of film that starts full, and so near its shape.
const FULL_STRETCH: f64 = 0.05;
/// V/A^(3/2) above which film is full: 0.094 for a sphere, 0 for what lies flat.
const FULL: f64 = 0.03;
/// Compression fraction on the way over p L/(E t).
const STIFFENED: f64 = 0.01;
/// Its least where p L/(E t) is this or more.
const STIFF_UNDER: [f64; 2] = [1e-3, 8e-3];
/// Largest ratio of two pressures.
const RATIO: f64 = 4.0;
/// Into how many parts moves of held nodes are cut, one attempt after the other.
const PARTS: [u32; 3] = [1, 4, 16];
/// Steps of relaxation where Newton's method is lost.
const ROUGH_STEPS: u64 = 20_000;

/// What counts as near enough on the way.
const PASSING: Settling = Settling { residual: 1e-3, step: 1e-3, iterations: 80 };

/// Finds the state of rest under this load: from these places (m), with what movers hold brought to
/// the end of its motion. Where the places are a state of rest under another overpressure, `from`
/// (Pa) says so, and the way starts there.
///
/// # Errors
/// [`StaticFailure`] of the last attempt.
///
/// # Panics
/// Never: there is at least one attempt.
pub fn settle(
    loaded: &Loaded<'_>,
    places: &Field,
    from: Option<f64>,
    settling: &Settling,
    watch: TunnellingMonitor<'_>,
) -> Result<Rest, StaticFailure> {
    let stages = stages(loaded, places, from);
    let moves = !loaded.supports.movers.is_empty();
    let attempts = if moves { &PARTS[..] } else { &PARTS[..1] };
    let mut last = None;
    for parts in attempts {
        let mut way = Way { loaded, settling, watch: &mut *watch, iterations: 0 };
        match way.go(places, &stages, *parts) {
            Ok(rest) => return Ok(rest),
            Err(failure) if failure.kind == StaticFailureKind::Stopped => return Err(failure),
            Err(failure) => last = Some(failure),
        }
    }
    Err(last.expect("at least one attempt"))
}

/// One load on the way.
#[derive(Debug, Clone, Copy)]
struct Stage {
    /// Overpressure, Pa.
    overpressure: f64,
    /// Compression fraction.
    compression: f64,
}

/// What to pass through, the load asked for last.
fn stages(loaded: &Loaded<'_>, places: &Field, from: Option<f64>) -> Vec<Stage> {
    let unit = tensile_stiffness(loaded.model) / extent(places);
    let (pressure, own) = (loaded.overpressure, loaded.model.material.compression);
    let last = Stage { overpressure: pressure, compression: own };
    if pressure == 0.0 {
        return vec![last];
    }
    let on_the_way = |overpressure: f64| {
        let stretch = overpressure.abs() / unit;
        let [least, from] = STIFF_UNDER;
        let least = if stretch >= from { least } else { 0.0 };
        let compression = own.max(least).max(STIFFENED * stretch);
        Stage { overpressure, compression }
    };
    let stretch = if fullness(loaded.model, places) > FULL { FULL_STRETCH } else { FIRST_STRETCH };
    let first = from.map_or(stretch * unit, f64::abs);
    let fall = (first / pressure.abs()).max(1.0);
    let count = (libm::log(fall) / libm::log(RATIO)).ceil();
    let mut all = Vec::new();
    // Where the film rests already there is nothing to look for.
    let mut k = if from.is_some() { 1.0 } else { 0.0 };
    while k < count {
        all.push(on_the_way(pressure * libm::pow(fall, (count - k) / count)));
        k += 1.0;
    }
    all.extend([on_the_way(pressure), last]);
    all
}

/// V/A^(3/2), A the film's area free of stress.
fn fullness(model: &FilmModel, places: &Field) -> f64 {
    let area: f64 =
        (0..model.elements()).map(|own| model.volume[own] / thickness(model, own)).sum();
    volume(model, places) / (area * area.sqrt())
}

struct Way<'a, 'b> {
    loaded: &'a Loaded<'a>,
    settling: &'a Settling,
    watch: TunnellingMonitor<'b>,
    iterations: u32,
}

impl Way<'_, '_> {
    fn go(&mut self, places: &Field, stages: &[Stage], parts: u32) -> Result<Rest, StaticFailure> {
        let mut places = places.clone();
        for part in 1..=parts {
            move_held(self.loaded.supports, &mut places, f64::from(part) / f64::from(parts));
            if part < parts {
                places = self.pass(places, stages[0])?;
            }
        }
        let (last, before) = stages.split_last().expect("the load asked for");
        for stage in before {
            places = self.pass(places, *stage)?;
        }
        let found = match self.state(places, *last, self.settling) {
            Err(failure) if !lost(&failure) => match relaxed(self.loaded, &failure.places) {
                Some(places) => self.state(places, *last, self.settling),
                None => Err(failure),
            },
            found => found,
        };
        let iterations = self.iterations;
        match found {
            Ok(rest) => Ok(Rest { iterations, ..rest }),
            Err(failure) => Err(StaticFailure { iterations, ..failure }),
        }
    }

    /// Places near rest under a load on the way: as near as some steps bring them.
    fn pass(&mut self, places: Field, stage: Stage) -> Result<Field, StaticFailure> {
        match self.state(places, stage, &PASSING) {
            Ok(rest) => Ok(rest.places),
            Err(failure) if lost(&failure) => Err(failure),
            Err(failure) => Ok(*failure.places),
        }
    }

    /// A state of rest under one load, with its steps counted.
    fn state(
        &mut self,
        places: Field,
        stage: Stage,
        settling: &Settling,
    ) -> Result<Rest, StaticFailure> {
        let mut model = self.loaded.model.clone();
        model.material.compression = stage.compression;
        let loaded = Loaded { model: &model, overpressure: stage.overpressure, ..*self.loaded };
        let found = equilibrium(&loaded, places, settling, &mut *self.watch);
        self.iterations += match &found {
            Ok(rest) => rest.iterations,
            Err(failure) => failure.iterations,
        };
        found
    }
}

/// Whether nothing can be made of what is left.
fn lost(failure: &StaticFailure) -> bool {
    matches!(failure.kind, StaticFailureKind::Stopped | StaticFailureKind::NotFinite)
}

/// Brings what movers hold to this share of the way from where it is at its start to its end.
fn move_held(supports: &Supports, places: &mut Field, share: f64) {
    for mover in &supports.movers {
        let start = mover.motion.from;
        let time = start + (mover.motion.to - start) * share;
        for (node, place) in mover.positions(time) {
            let node = node as usize;
            let own = places.get(node);
            places.set(node, own + mover.held * (place - own));
        }
    }
}

/// Places after a damped motion from these; `None` where that runs away.
fn relaxed(loaded: &Loaded<'_>, places: &Field) -> Option<Field> {
    let mut supports = loaded.supports.clone();
    // What moves has got to where it is meant to be.
    supports.movers.clear();
    let setting = Parameters {
        supports,
        gravity: loaded.gravity,
        path: loaded.path,
        cfl: Relaxation::default().cfl,
        ..Parameters::free(PressureLoad::Overpressure(loaded.overpressure), loaded.model.nodes())
    };
    let still = Field::zeros(loaded.model.nodes());
    let mut film =
        Explicit::new(loaded.model.clone(), setting, places.clone(), still, GasState::default());
    let rough = Relaxation { step_limit: ROUGH_STEPS, ..Relaxation::default() };
    // However far it got, it is a start; what ran away is none.
    let _ = rough.relax_at(&mut film, loaded.overpressure);
    let sound = film.state.places.iter().all(|place: Vector3<f64>| place.norm().is_finite());
    sound.then_some(film.state.places)
}
