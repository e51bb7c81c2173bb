//! What a history says, in single numbers, and the verdict.
//!
//! `V_ref` and `H_ref` are those at the **final overpressure** (last p less ambient) everywhere, in
//! the verdict and in the thresholds of times alike. Series are linear between samples.

use crate::output::history::History;
use crate::scene::timeline::Timeline;

mod hold;
mod reference;
mod ringing;
mod verdict;

use hold::first_hold;
pub use reference::{REFERENCE_PRESSURES, Reference};
use verdict::LastTenth;

/// How long a height or volume must hold to have been reached, s.
const REACHED_HOLD: f64 = 0.005;
/// How long both deployed thresholds must hold, s.
const DEPLOYED_HOLD: f64 = 0.02;
/// How long the kinetic energy must stay low, s.
const SETTLED_HOLD: f64 = 0.05;
/// Share of its peak below which the kinetic energy has settled.
const SETTLED_SHARE: f64 = 1e-4;

/// The answer of a finished run: did it deploy?
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Full: V and `z_rim` at or above their thresholds over the last tenth of the run.
    Deployed,
    /// Neither deployed nor stalled.
    Partial,
    /// Mean V of the last tenth below its threshold.
    Stalled,
}

/// Measures of one run. `None` where the thing measured never happened.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Measures {
    /// Verdict; `None` unless the run is done.
    pub verdict: Option<Verdict>,
    /// Whether a change of the ratios by less than `close_margin` would change the verdict.
    pub close: bool,
    /// Mean V over the last tenth over `V_ref` at the final pressure.
    pub volume_ratio: Option<f64>,
    /// Smallest `z_rim` over the last tenth over `H_ref` at the final pressure.
    pub height_ratio: Option<f64>,
    /// Static volume at the final pressure, m³.
    pub reference_volume: Option<f64>,
    /// Static `z_rim` at the final pressure, m.
    pub reference_height: Option<f64>,
    /// First time at half of `H_ref` that holds 5 ms, s.
    pub t_50_z_rim: Option<f64>,
    /// The same at nine tenths, s.
    pub t_90_z_rim: Option<f64>,
    /// First time at half of `V_ref` that holds 5 ms, s.
    pub t_50_volume: Option<f64>,
    /// The same at nine tenths, s.
    pub t_90_volume: Option<f64>,
    /// First time from which both deployed thresholds hold 20 ms, s.
    pub t_deployed: Option<f64>,
    /// Largest vz, m/s.
    pub peak_vz: Option<f64>,
    /// Its time, s.
    pub t_peak_vz: Option<f64>,
    /// Largest kinetic energy, J.
    pub peak_kinetic_energy: Option<f64>,
    /// Largest `z_rim` over `H_ref`, less 1.
    pub overshoot: Option<f64>,
    /// Root mean square of vz over 0.2 s after `t_deployed`, m/s.
    pub ringing_rms: Option<f64>,
    /// Its largest spectral line, Hz.
    pub ringing_frequency: Option<f64>,
    /// First time after the peak of the kinetic energy from which it stays below 1e-4 of that peak
    /// for 50 ms, s.
    pub t_settled: Option<f64>,
    /// Last `z_rim`, m.
    pub final_z_rim: Option<f64>,
    /// Last V, m³.
    pub final_volume: Option<f64>,
    /// Last p, Pa.
    pub final_pressure: Option<f64>,
    /// Last T, K.
    pub final_temperature: Option<f64>,
    /// Largest principal second Piola-Kirchhoff film stress, Pa.
    pub film_stress: Option<f64>,
    /// Largest lid force, N.
    pub peak_lid_force: Option<f64>,
}

impl Verdict {
    /// Name, as in the table's `verdict` column.
    pub fn name(self) -> &'static str {
        match self {
            Self::Deployed => "deployed",
            Self::Partial => "partial",
            Self::Stalled => "stalled",
        }
    }
}

/// Measures a history against its reference; without one, what needs none. `film_stress` (Pa) is the
/// model's own, taken at every step; ratios and verdict exist only for a run that is `done`.
pub fn measure(
    history: &History,
    reference: Option<&Reference>,
    course: &Timeline,
    film_stress: f64,
    done: bool,
) -> Measures {
    let column = |name: &str| history.column(name);
    let (time, vz, kinetic) = (column("time"), column("vz"), column("kinetic_energy"));
    let last = |name: &str| column(name).last().copied();
    let Some(final_pressure) = last("pressure") else { return Measures::default() };
    let peak_vz = peak(vz);
    let peak_kinetic = peak(kinetic);
    let overpressure = final_pressure - course.ambient_pressure;
    let judged =
        reference.map(|reference| judge(history, reference.at(overpressure), course, done));
    Measures {
        peak_vz: peak_vz.map(|(_, value)| value),
        t_peak_vz: peak_vz.map(|(index, _)| time[index]),
        peak_kinetic_energy: peak_kinetic.map(|(_, value)| value),
        t_settled: peak_kinetic.and_then(|(index, value)| settled(time, kinetic, index, value)),
        final_z_rim: last("z_rim"),
        final_volume: last("volume"),
        final_pressure: Some(final_pressure),
        final_temperature: last("temperature"),
        film_stress: Some(film_stress),
        peak_lid_force: peak(column("lid_force")).map(|(_, value)| value),
        ..judged.unwrap_or_default()
    }
}

/// What a history says against `V_ref` and `H_ref`.
fn judge(history: &History, (v_ref, h_ref): (f64, f64), course: &Timeline, done: bool) -> Measures {
    let column = |name: &str| history.column(name);
    let (time, volume, z_rim) = (column("time"), column("volume"), column("z_rim"));
    let reached =
        |values: &[f64], threshold: f64| first_hold(time, values, threshold, REACHED_HOLD);
    let t_deployed = deployed_since(time, volume, z_rim, course, (v_ref, h_ref));
    let ringing = t_deployed.and_then(|start| ringing::ringing(time, column("vz"), start));
    let judged = done.then(|| LastTenth::new(time, volume, z_rim, (v_ref, h_ref)));
    let verdict = judged.map(|tenth| tenth.judge(&course.thresholds));
    Measures {
        verdict: verdict.map(|(verdict, _)| verdict),
        close: verdict.is_some_and(|(_, close)| close),
        volume_ratio: judged.map(|tenth| tenth.mean_volume),
        height_ratio: judged.map(|tenth| tenth.least_height),
        reference_volume: Some(v_ref),
        reference_height: Some(h_ref),
        t_50_z_rim: reached(z_rim, 0.5 * h_ref),
        t_90_z_rim: reached(z_rim, 0.9 * h_ref),
        t_50_volume: reached(volume, 0.5 * v_ref),
        t_90_volume: reached(volume, 0.9 * v_ref),
        t_deployed,
        overshoot: peak(z_rim).map(|(_, value)| value / h_ref - 1.0),
        ringing_rms: ringing.map(|(rms, _)| rms),
        ringing_frequency: ringing.and_then(|(_, line)| line),
        ..Measures::default()
    }
}

/// Index and value of the first largest value.
fn peak(values: &[f64]) -> Option<(usize, f64)> {
    values
        .iter()
        .copied()
        .enumerate()
        .reduce(|best, next| if next.1 > best.1 { next } else { best })
}

/// First time from which both deployed thresholds hold.
fn deployed_since(
    time: &[f64],
    volume: &[f64],
    z_rim: &[f64],
    course: &Timeline,
    (v_ref, h_ref): (f64, f64),
) -> Option<f64> {
    let v = v_ref * course.thresholds.deployed_volume;
    let h = h_ref * course.thresholds.deployed_height;
    let worse: Vec<f64> =
        volume.iter().zip(z_rim).map(|(volume, z_rim)| (volume / v).min(z_rim / h)).collect();
    first_hold(time, &worse, 1.0, DEPLOYED_HOLD)
}

/// First time after the peak from which the kinetic energy stays low; `None` where nothing moved.
fn settled(time: &[f64], kinetic: &[f64], peak: usize, largest: f64) -> Option<f64> {
    if largest <= 0.0 {
        return None;
    }
    let below: Vec<f64> = kinetic[peak..].iter().map(|energy| -energy).collect();
    first_hold(&time[peak..], &below, -SETTLED_SHARE * largest, SETTLED_HOLD)
}

#[cfg(test)]
mod tests;
