//! Frequency and extrema of an oscillation, and when a series reaches a level.

use super::prelude::*;

/// Most samples of a signal. Chosen: ends a run that does not oscillate.
const MAX_SAMPLES: usize = 200_000;

/// Frequency, Hz, of a signal of moving film, from a number of zero crossings, half a period apart.
/// The signal is sampled at an interval (s). A crossing is interpolated linearly between two samples:
/// for a sine the error is of third order in the interval.
pub fn frequency(
    film: &mut FilmSimulation,
    interval: f64,
    crossings: usize,
    signal: impl Fn(&FilmView<'_>) -> f64,
) -> Result<f64> {
    let (mut found, mut before) = (Vec::with_capacity(crossings), signal(&film.view()));
    for _ in 0..MAX_SAMPLES {
        let time = film.view().state.time;
        advance(film, time + interval, &Phase::default())?;
        let now = signal(&film.view());
        if before * now < 0.0 {
            found.push(time + interval * before / (before - now));
            if found.len() == crossings {
                let halves = (crossings - 1) as f64;
                return Ok(0.5 * halves / (found[crossings - 1] - found[0]));
            }
        }
        before = now;
    }
    Err(format!(
        "no oscillation: {} zero crossings until {} s",
        found.len(),
        film.view().state.time
    )
    .into())
}

/// The second quantity when the first one reaches a level, linear between samples; NaN if it does not.
pub fn when(samples: &[(f64, f64)], level: f64) -> f64 {
    let pair = samples.windows(2).find(|pair| (pair[0].0 - level) * (pair[1].0 - level) <= 0.0);
    pair.map_or(f64::NAN, |pair| {
        let fraction = (level - pair[0].0) / (pair[1].0 - pair[0].0);
        pair[0].1 + fraction * (pair[1].1 - pair[0].1)
    })
}

/// An extremum of a signal.
pub struct Extremum {
    /// Time, s.
    pub time: f64,
    /// Value of the signal.
    pub value: f64,
}

/// The first extrema of a signal, from parabolas through three samples at an interval (s).
pub fn extrema(
    film: &mut FilmSimulation,
    interval: f64,
    count: usize,
    signal: impl Fn(&FilmView<'_>) -> f64,
) -> Result<Vec<Extremum>> {
    let mut last = [signal(&film.view()); 3];
    let mut found = Vec::with_capacity(count);
    for sample in 1..MAX_SAMPLES {
        let time = film.view().state.time;
        advance(film, time + interval, &Phase::default())?;
        last = [last[1], last[2], signal(&film.view())];
        let (rise, fall) = (last[1] - last[0], last[2] - last[1]);
        if sample > 2 && rise * fall < 0.0 {
            let shift = 0.5 * (rise + fall) / (rise - fall);
            let value = last[1] + 0.25 * (rise + fall) * shift;
            found.push(Extremum { time: time + shift * interval, value });
            if found.len() == count {
                return Ok(found);
            }
        }
    }
    Err(format!("no oscillation: {} extrema until {} s", found.len(), film.view().state.time)
        .into())
}
