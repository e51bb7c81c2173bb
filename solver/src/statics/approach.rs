//! The way to a static state: pressures falling, held nodes moved in parts, relaxation where Newton's
//! method alone is lost.
//!
//! ```text
//! p_k = p_0 (p/p_0)^(k/n),  k = 0 … n      p_0 = 0.05 E t/L
//! ```
//!
//! Film of extent L that starts slack or flat finds its place soonest under a pressure that
//! stretches it by some percent, and then follows the pressure down. A cold start at a low pressure
//! takes ten times the steps, and may end in a higher minimum.

use nalgebra::Vector3;

use super::newton::{
    Loaded, Rest, Settling, StaticFailure, StaticFailureKind, Watch, equilibrium, extent,
};
use super::relaxation::Relaxation;
use crate::gas::GasState;
use crate::integrate::explicit::{Explicit, Interior, Setting};
use crate::resultants::thickness;
use crate::state::Field;
use crate::supports::Supports;

/// p L/(E t) of the first pressure.
const FIRST_STRETCH: f64 = 0.05;
/// Largest ratio of two pressures.
const RATIO: f64 = 4.0;
/// Into how many parts moves of held nodes are cut, one attempt after the other.
const PARTS: [u32; 3] = [1, 4, 16];
/// Steps of relaxation where Newton's method is lost.
const ROUGH_STEPS: u64 = 20_000;

/// What counts as found on the way.
const PASSING: Settling = Settling { residual: 1e-3, step: 1e-4, iterations: 200 };

/// Finds the state of rest under this load: from these places (m), with what movers hold brought to
/// the end of its motion. Where the places are a state of rest under another overpressure, `from`
/// (Pa) says so, and the way starts there.
///
/// # Errors
/// [`StaticFailure`] of the last attempt.
pub fn settle(
    loaded: &Loaded<'_>,
    places: &Field,
    from: Option<f64>,
    settling: &Settling,
    watch: Watch<'_>,
) -> Result<Rest, StaticFailure> {
    let pressures = pressures(loaded, places, from);
    let moves = !loaded.supports.movers.is_empty();
    let attempts = if moves { &PARTS[..] } else { &PARTS[..1] };
    let mut last = None;
    for parts in attempts {
        let mut way = Way { loaded, settling, watch: &mut *watch, iterations: 0 };
        match way.go(places, &pressures, *parts) {
            Ok(rest) => return Ok(rest),
            Err(failure) if failure.kind == StaticFailureKind::Stopped => return Err(failure),
            Err(failure) => last = Some(failure),
        }
    }
    Err(last.expect("at least one attempt"))
}

/// Pressures to pass through, the one asked for last, Pa.
fn pressures(loaded: &Loaded<'_>, places: &Field, from: Option<f64>) -> Vec<f64> {
    let stiffness = (0..loaded.model.elements())
        .map(|element| thickness(loaded.model, element))
        .fold(0.0, f64::max)
        * loaded.model.material.youngs_modulus;
    let pressure = loaded.overpressure;
    let first = from.map_or(FIRST_STRETCH * stiffness / extent(places), f64::abs);
    let fall = first / pressure.abs();
    if pressure == 0.0 || fall <= 1.0 {
        return vec![pressure];
    }
    let count = (libm::log(fall) / libm::log(RATIO)).ceil();
    let at = |k: f64| pressure * libm::pow(fall, (count - k) / count);
    let mut all: Vec<f64> = Vec::new();
    // Where the film rests already there is nothing to look for.
    let mut k = if from.is_some() { 1.0 } else { 0.0 };
    while k < count {
        all.push(at(k));
        k += 1.0;
    }
    all.push(pressure);
    all
}

struct Way<'a, 'b> {
    loaded: &'a Loaded<'a>,
    settling: &'a Settling,
    watch: Watch<'b>,
    iterations: u32,
}

impl Way<'_, '_> {
    fn go(&mut self, places: &Field, pressures: &[f64], parts: u32) -> Result<Rest, StaticFailure> {
        let mut places = places.clone();
        let supports = self.loaded.supports;
        for part in 1..=parts {
            let share = f64::from(part) / f64::from(parts);
            move_held(supports, &mut places, share);
            if part < parts {
                places = self.state(places, pressures[0], &PASSING)?.places;
            }
        }
        let (last, before) = pressures.split_last().expect("the pressure asked for");
        for pressure in before {
            places = self.state(places, *pressure, &PASSING)?.places;
        }
        let mut rest = self.state(places, *last, self.settling)?;
        rest.iterations = self.iterations;
        Ok(rest)
    }

    /// A state of rest under one pressure (Pa), after a relaxation if it is not found at once.
    fn state(
        &mut self,
        places: Field,
        overpressure: f64,
        settling: &Settling,
    ) -> Result<Rest, StaticFailure> {
        let loaded = Loaded { overpressure, ..*self.loaded };
        let found = equilibrium(&loaded, places, settling, &mut *self.watch);
        let found = match found {
            Err(failure)
                if failure.kind != StaticFailureKind::Stopped
                    && failure.kind != StaticFailureKind::NotFinite =>
            {
                self.iterations += failure.iterations;
                match relaxed(&loaded, &failure.places) {
                    Some(places) => equilibrium(&loaded, places, settling, &mut *self.watch),
                    None => Err(failure),
                }
            }
            found => found,
        };
        self.iterations += match &found {
            Ok(rest) => rest.iterations,
            Err(failure) => failure.iterations,
        };
        found.map_err(|failure| StaticFailure { iterations: self.iterations, ..failure })
    }
}

/// Brings what movers hold to this share of the way from where it is at its start to its end.
fn move_held(supports: &Supports, places: &mut Field, share: f64) {
    for mover in &supports.movers {
        let start = mover.motion.from;
        let time = start + (mover.motion.to - start) * share;
        for (node, place) in mover.places(time) {
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
    let setting = Setting {
        supports,
        gravity: loaded.gravity,
        path: loaded.path,
        cfl: Relaxation::default().cfl,
        ..Setting::free(Interior::Overpressure(loaded.overpressure), loaded.model.nodes())
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
