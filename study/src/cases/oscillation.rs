//! Reading an oscillation: by where it crosses nought, and by where it turns.

use billow_solver::integrators::explicit::Explicit;
use billow_solver::scene::timeline::Phase;

use super::rig::advance;

/// Looks a period may take at most: a run that does not oscillate ends.
const PATIENCE: usize = 200_000;

/// Frequency, Hz, of a signal of film in motion: from its first crossing of nought to the last of
/// `crossings`, half a period each. Between two looks `interval` (s) apart a crossing is found by a
/// straight line; a sine is straight there up to the third order of the interval.
///
/// # Errors
/// What stopped the film, or that it does not oscillate.
pub fn frequency(
    film: &mut Explicit,
    interval: f64,
    crossings: usize,
    signal: impl Fn(&Explicit) -> f64,
) -> Result<f64, String> {
    let (mut found, mut before) = (Vec::with_capacity(crossings), signal(film));
    for _ in 0..PATIENCE {
        let time = film.state.time;
        advance(film, time + interval, &Phase::default())?;
        let now = signal(film);
        if before * now < 0.0 {
            found.push(time + interval * before / (before - now));
            if found.len() == crossings {
                let halves = (crossings - 1) as f64;
                return Ok(0.5 * halves / (found[crossings - 1] - found[0]));
            }
        }
        before = now;
    }
    Err(format!("no oscillation: {} crossings by {} s", found.len(), film.state.time))
}

/// A place where a signal turns.
#[derive(Debug, Clone, Copy)]
pub struct Turn {
    /// When, s.
    pub time: f64,
    /// Its value there.
    pub value: f64,
}

/// The first turning points of a signal, by parabolas through three looks `interval` (s) apart.
///
/// # Errors
/// As [`frequency`].
pub fn turns(
    film: &mut Explicit,
    interval: f64,
    count: usize,
    signal: impl Fn(&Explicit) -> f64,
) -> Result<Vec<Turn>, String> {
    let mut last = [signal(film); 3];
    let mut found = Vec::with_capacity(count);
    for look in 1..PATIENCE {
        let time = film.state.time;
        advance(film, time + interval, &Phase::default())?;
        last = [last[1], last[2], signal(film)];
        let (rise, fall) = (last[1] - last[0], last[2] - last[1]);
        if look > 2 && rise * fall < 0.0 {
            let shift = 0.5 * (rise + fall) / (rise - fall);
            let value = last[1] + 0.25 * (rise + fall) * shift;
            found.push(Turn { time: time + shift * interval, value });
            if found.len() == count {
                return Ok(found);
            }
        }
    }
    Err(format!("no oscillation: {} turns by {} s", found.len(), film.state.time))
}
