//! Measures: single numbers computed from a history, and the verdict.
//!
//! `V_ref` and `H_ref` are always those at the **final overpressure** (last p minus ambient pressure), both
//! in the verdict and in the thresholds of times. Series are linear between samples.

use crate::output::history::History;
use crate::scene::timeline::Timeline;

mod hold;
mod rebound;
mod reference;
mod ringing;
mod verdict;

use hold::first_hold;
pub use rebound::first_rebound;
pub use reference::{REFERENCE_PRESSURES, Reference};
use verdict::LastTenth;

/// Time for which a height or volume must stay above its threshold to count as reached, s. Chosen.
const MIN_REACHED_TIME: f64 = 0.005;
/// Time for which both thresholds of `deployed` must hold for `t_deployed`, s. Chosen.
const MIN_DEPLOYED_TIME: f64 = 0.02;
/// Time for which the kinetic energy must stay low for `t_settled`, s. Chosen.
const MIN_SETTLED_TIME: f64 = 0.05;
/// Upper bound of the kinetic energy of a settled film, as a fraction of its peak. Chosen.
const MAX_SETTLED_FRACTION: f64 = 1e-4;

/// The verdict of a finished run: did the capsule deploy?
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// V and `z_rim` are at or above their thresholds throughout the last tenth of the run.
    Deployed,
    /// Neither deployed nor stalled.
    Partial,
    /// The mean V of the last tenth is below its threshold.
    Stalled,
}

/// Measures of one run. `None`: the event did not happen, or there is no reference.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Measures {
    /// Verdict; `None` unless the run is done and has a reference.
    pub verdict: Option<Verdict>,
    /// Whether a change of the ratios by less than the near-threshold margin would change the verdict.
    pub near_threshold: bool,
    /// Mean V of the last tenth divided by `V_ref`.
    pub volume_ratio: Option<f64>,
    /// Smallest `z_rim` of the last tenth divided by `H_ref`.
    pub height_ratio: Option<f64>,
    /// `V_ref`: static volume at the final overpressure, m³.
    pub reference_volume: Option<f64>,
    /// `H_ref`: static `z_rim` at the final overpressure, m.
    pub reference_height: Option<f64>,
    /// First time from which `z_rim` stays above 0.5 `H_ref` for 5 ms, s.
    pub t_50_z_rim: Option<f64>,
    /// The same for 0.9 `H_ref`, s.
    pub t_90_z_rim: Option<f64>,
    /// First time from which V stays above 0.5 `V_ref` for 5 ms, s.
    pub t_50_volume: Option<f64>,
    /// The same for 0.9 `V_ref`, s.
    pub t_90_volume: Option<f64>,
    /// First time from which both thresholds of `deployed` hold for 20 ms, s.
    pub t_deployed: Option<f64>,
    /// Largest vz, m/s.
    pub peak_vz: Option<f64>,
    /// Time of the largest vz, s.
    pub t_peak_vz: Option<f64>,
    /// Largest kinetic energy, J.
    pub peak_kinetic_energy: Option<f64>,
    /// `z_rim` at its first peak, m.
    pub first_peak_z_rim: Option<f64>,
    /// `z_rim` at the first minimum after its first peak, m.
    pub first_minimum_z_rim: Option<f64>,
    /// Largest `z_rim` divided by `H_ref`, minus 1.
    pub overshoot: Option<f64>,
    /// Root mean square of vz over 0.2 s after `t_deployed`, m/s.
    pub ringing_rms: Option<f64>,
    /// Frequency of the largest spectral line of vz in that window, Hz.
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
    /// Every verdict.
    pub const ALL: [Self; 3] = [Self::Deployed, Self::Partial, Self::Stalled];

    /// The verdict with that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|verdict| verdict.name() == name)
    }

    /// Name, as in the table's `verdict` column.
    pub fn name(self) -> &'static str {
        match self {
            Self::Deployed => "deployed",
            Self::Partial => "partial",
            Self::Stalled => "stalled",
        }
    }
}

/// Computes the measures of a history. Without a reference, those that need one are `None`. `film_stress`
/// (Pa): the model's largest stress over all steps. Ratios and verdict exist only for a run that is `done`.
pub fn measure(
    history: &History,
    reference: Option<&Reference>,
    timeline: &Timeline,
    film_stress: f64,
    done: bool,
) -> Measures {
    let column = |name: &str| history.column(name);
    let (time, vz, kinetic) = (column("time"), column("vz"), column("kinetic_energy"));
    let last = |name: &str| column(name).last().copied();
    let Some(final_pressure) = last("pressure") else { return Measures::default() };
    let peak_vz = peak(vz);
    let z_rim = column("z_rim");
    let (first_peak, first_minimum) = first_rebound(z_rim);
    let peak_kinetic = peak(kinetic);
    let overpressure = final_pressure - timeline.ambient_pressure;
    let judged =
        reference.map(|reference| judge(history, reference.at(overpressure), timeline, done));
    Measures {
        peak_vz: peak_vz.map(|(_, value)| value),
        t_peak_vz: peak_vz.map(|(index, _)| time[index]),
        peak_kinetic_energy: peak_kinetic.map(|(_, value)| value),
        first_peak_z_rim: first_peak.map(|index| z_rim[index]),
        first_minimum_z_rim: first_minimum.map(|index| z_rim[index]),
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

/// The measures that need `V_ref` and `H_ref`.
fn judge(
    history: &History,
    (v_ref, h_ref): (f64, f64),
    timeline: &Timeline,
    done: bool,
) -> Measures {
    let column = |name: &str| history.column(name);
    let (time, volume, z_rim) = (column("time"), column("volume"), column("z_rim"));
    let reached =
        |values: &[f64], threshold: f64| first_hold(time, values, threshold, MIN_REACHED_TIME);
    let t_deployed = deployed_since(time, volume, z_rim, timeline, (v_ref, h_ref));
    let ringing = t_deployed.and_then(|start| ringing::ringing(time, column("vz"), start));
    let judged = done.then(|| LastTenth::new(time, volume, z_rim, (v_ref, h_ref)));
    let verdict = judged.map(|tenth| tenth.judge(&timeline.thresholds));
    Measures {
        verdict: verdict.map(|(verdict, _)| verdict),
        near_threshold: verdict.is_some_and(|(_, near)| near),
        volume_ratio: judged.map(|tenth| tenth.mean_volume),
        height_ratio: judged.map(|tenth| tenth.min_height),
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

/// Index and value of the largest value; the first of several.
fn peak(values: &[f64]) -> Option<(usize, f64)> {
    values
        .iter()
        .copied()
        .enumerate()
        .reduce(|best, next| if next.1 > best.1 { next } else { best })
}

/// First time from which both thresholds of `deployed` hold, s.
fn deployed_since(
    time: &[f64],
    volume: &[f64],
    z_rim: &[f64],
    timeline: &Timeline,
    (v_ref, h_ref): (f64, f64),
) -> Option<f64> {
    let v = v_ref * timeline.thresholds.deployed_volume;
    let h = h_ref * timeline.thresholds.deployed_height;
    let smaller_ratio: Vec<f64> =
        volume.iter().zip(z_rim).map(|(volume, z_rim)| (volume / v).min(z_rim / h)).collect();
    first_hold(time, &smaller_ratio, 1.0, MIN_DEPLOYED_TIME)
}

/// First time after the peak from which the kinetic energy stays low, s; `None` if nothing moved.
fn settled(time: &[f64], kinetic: &[f64], peak: usize, largest: f64) -> Option<f64> {
    if largest <= 0.0 {
        return None;
    }
    let negated: Vec<f64> = kinetic[peak..].iter().map(|energy| -energy).collect();
    first_hold(&time[peak..], &negated, -MAX_SETTLED_FRACTION * largest, MIN_SETTLED_TIME)
}

#[cfg(test)]
mod tests;
