//! Measures: single numbers computed from a history, and the verdict.
//!
//! Two static equilibria of the design serve as reference ([`Reference`]). Ratios, verdict, overshoot and
//! `t_deployed` use the one at the **final overpressure** of the run. The other times use the **design
//! shape**, which depends on the design alone. Times above one half use smoothed series (module `smoothed`).
//! Film without rings has no measures of its top ring: its verdict and its times are those of its volume.
//! Series are linear between samples.

use crate::output::history::{HEIGHT, History};
use crate::scene::timeline::Timeline;

mod hold;
mod motion;
mod rebound;
mod reference;
mod ringing;
mod smoothed;
mod verdict;

use hold::first_hold;
pub use motion::MEAN_TIME;
pub use rebound::first_rebound;
pub use reference::{
    DESIGN_LOAD, NoReference, Reference, StaticShape, design_overpressure, final_overpressure,
};
use smoothed::Window;
use verdict::LastTenth;

/// Time for which a height or volume must stay above one half to count as reached, s. Chosen.
const MIN_REACHED_TIME: f64 = 0.005;
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
    /// Why a run that is done has no verdict.
    pub no_verdict: Option<NoReference>,
    /// Mean V of the last tenth divided by the static volume at the final overpressure.
    pub volume_ratio: Option<f64>,
    /// Smallest `z_rim` (of film without rings: height) of the last tenth divided by the static height at the final
    /// overpressure.
    pub height_ratio: Option<f64>,
    /// The static shape of the verdict.
    pub reference: Option<StaticShape>,
    /// Mean overpressure of the last tenth, Pa.
    pub final_overpressure: Option<f64>,
    /// Height of the design shape, m.
    pub design_height: Option<f64>,
    /// Volume of the design shape, m³.
    pub design_volume: Option<f64>,
    /// First time from which `z_rim` stays above half the design height for 5 ms, s.
    pub t_50_z_rim: Option<f64>,
    /// First time at which the smoothed `z_rim` reaches nine tenths of the design height, s.
    pub t_90_z_rim: Option<f64>,
    /// First time from which V stays above half the design volume for 5 ms, s.
    pub t_50_volume: Option<f64>,
    /// First time at which the smoothed V reaches nine tenths of the design volume, s.
    pub t_90_volume: Option<f64>,
    /// First time at which the smaller of V and `z_rim`, each over its threshold of `deployed` and then
    /// smoothed, reaches 1, s.
    pub t_deployed: Option<f64>,
    /// Largest mean speed of the top ring over 5 ms, up or down, m/s.
    pub peak_speed: Option<f64>,
    /// Largest mean acceleration of the top ring over twice 5 ms, up or down, m/s².
    pub peak_acceleration: Option<f64>,
    /// Largest mean force along z on the film over 5 ms of all that holds it (supports, lid, floor), up or down, N.
    pub peak_base_force: Option<f64>,
    /// Largest vz, m/s.
    pub peak_vz: Option<f64>,
    /// Largest −vz, m/s.
    pub peak_downward_vz: Option<f64>,
    /// Time of the largest vz, s.
    pub t_peak_vz: Option<f64>,
    /// Largest kinetic energy, J.
    pub peak_kinetic_energy: Option<f64>,
    /// `z_rim` at its first peak, m.
    pub first_peak_z_rim: Option<f64>,
    /// `z_rim` at the first minimum after its first peak, m.
    pub first_minimum_z_rim: Option<f64>,
    /// Largest `z_rim`, m.
    pub largest_z_rim: Option<f64>,
    /// Least `z_rim` after its first peak, m.
    pub lowest_z_rim: Option<f64>,
    /// Largest height of film without rings, from its lowest to its highest node, m.
    pub largest_height: Option<f64>,
    /// Largest `z_rim` (of film without rings: height) divided by the static height at the final overpressure, minus 1.
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
    /// Last height of film without rings, m.
    pub final_height: Option<f64>,
    /// Last V, m³.
    pub final_volume: Option<f64>,
    /// Last p, Pa.
    pub final_pressure: Option<f64>,
    /// Largest p, Pa.
    pub peak_pressure: Option<f64>,
    /// Last T, K.
    pub final_temperature: Option<f64>,
    /// Gas that left through leak and vent by the end, kg; negative where gas entered there.
    pub vented_mass: Option<f64>,
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
    let column = |name: &str| if history.has(name) { history.column(name) } else { &[] };
    let (time, vz, kinetic) = (column("time"), column("vz"), column("kinetic_energy"));
    let last = |name: &str| column(name).last().copied();
    let Some(final_pressure) = last("pressure") else { return Measures::default() };
    let peak_vz = peak(vz);
    let z_rim = column("z_rim");
    let (first_peak, first_minimum) = first_rebound(z_rim);
    let peak_kinetic = peak(kinetic);
    let largest = |values: &[f64]| peak(values).map(|(_, value)| value);
    let judged = reference.map(|reference| judge(history, reference, timeline, done));
    Measures {
        peak_speed: motion::rate(time, z_rim),
        peak_acceleration: motion::change_of_rate(time, z_rim),
        peak_base_force: motion::rate(time, column("support_impulse")),
        peak_vz: peak_vz.map(|(_, value)| value),
        peak_downward_vz: vz.iter().map(|vz| -vz).reduce(f64::max),
        t_peak_vz: peak_vz.map(|(index, _)| time[index]),
        peak_kinetic_energy: peak_kinetic.map(|(_, value)| value),
        first_peak_z_rim: first_peak.map(|index| z_rim[index]),
        first_minimum_z_rim: first_minimum.map(|index| z_rim[index]),
        t_settled: peak_kinetic.and_then(|(index, value)| settled(time, kinetic, index, value)),
        largest_z_rim: largest(z_rim),
        largest_height: largest(column(HEIGHT)),
        final_height: column(HEIGHT).last().copied(),
        lowest_z_rim: first_peak.and_then(|peak| z_rim[peak..].iter().copied().reduce(f64::min)),
        final_z_rim: last("z_rim"),
        final_volume: last("volume"),
        peak_pressure: largest(column("pressure")),
        final_pressure: Some(final_pressure),
        final_overpressure: final_overpressure(history, timeline),
        final_temperature: last("temperature"),
        vented_mass: vented(time, column("gas_mass"), timeline),
        film_stress: Some(film_stress),
        peak_lid_force: largest(column("lid_force")),
        ..judged.unwrap_or_default()
    }
}

/// The measures that need a reference.
fn judge(history: &History, reference: &Reference, timeline: &Timeline, done: bool) -> Measures {
    let times = match reference.design {
        Ok(design) => times(history, design, reference.end.as_ref().ok(), timeline),
        Err(_) => Measures::default(),
    };
    if !done {
        return times;
    }
    let end = match &reference.end {
        Ok(end) => *end,
        Err(missing) => return Measures { no_verdict: Some(missing.clone()), ..times },
    };
    let (volume, height) = (history.column("volume"), height(history));
    let tenth = LastTenth::new(history.column("time"), volume, height, (end.volume, end.height));
    // Film that is no capsule may turn, which changes its height.
    let (verdict, near_threshold) = tenth.judge(&timeline.thresholds, history.has_rings());
    Measures {
        verdict: Some(verdict),
        near_threshold,
        volume_ratio: Some(tenth.mean_volume),
        height_ratio: Some(tenth.min_height),
        reference: Some(end),
        overshoot: peak(height).map(|(_, value)| value / end.height - 1.0),
        ..times
    }
}

/// The height that is compared with a static height, m.
fn height(history: &History) -> &[f64] {
    history.column(if history.has_rings() { "z_rim" } else { HEIGHT })
}

/// Times at which levels of the design shape are reached, and `t_deployed` with what follows it. Of film without rings
/// the volume alone decides.
fn times(
    history: &History,
    design: StaticShape,
    end: Option<&StaticShape>,
    timeline: &Timeline,
) -> Measures {
    let column = |name: &str| history.column(name);
    let (time, volume) = (column("time"), column("volume"));
    let rings = history.has_rings();
    let (course, full) =
        if rings { (column("z_rim"), design.height) } else { (volume, design.volume) };
    let half = 0.5 * full;
    let t_50 = first_hold(time, course, half, MIN_REACHED_TIME);
    let window = t_50.map(|t_50| Window::of(time, course, half, t_50));
    let reached = |values: &[f64], level: f64| window?.first(time, values, level);
    let t_deployed = end.and_then(|end| {
        let v = end.volume * timeline.thresholds.deployed_volume;
        if !rings {
            return reached(volume, v);
        }
        let h = end.height * timeline.thresholds.deployed_height;
        let smaller_ratio = volume.iter().zip(course).map(|(volume, z)| (volume / v).min(z / h));
        reached(&smaller_ratio.collect::<Vec<f64>>(), 1.0)
    });
    let ringing =
        t_deployed.filter(|_| rings).and_then(|start| ringing::ringing(time, column("vz"), start));
    Measures {
        design_height: Some(design.height),
        design_volume: Some(design.volume),
        t_50_z_rim: t_50.filter(|_| rings),
        t_90_z_rim: if rings { reached(course, 0.9 * full) } else { None },
        t_50_volume: first_hold(time, volume, 0.5 * design.volume, MIN_REACHED_TIME),
        t_90_volume: reached(volume, 0.9 * design.volume),
        t_deployed,
        ringing_rms: ringing.map(|(rms, _)| rms),
        ringing_frequency: ringing.and_then(|(_, line)| line),
        ..Measures::default()
    }
}

/// Gas that left by the end, kg: 0 up to rounding where none can.
fn vented(time: &[f64], mass: &[f64], timeline: &Timeline) -> Option<f64> {
    let received = mass.first()? + timeline.schedule.mass_until(*time.last()?);
    let vented = received - mass.last()?;
    Some(if vented.abs() <= MASS_ROUNDING * received { 0.0 } else { vented })
}

/// Rounding of the mass of the gas over what it received, at most.
const MASS_ROUNDING: f64 = 1e-10;

/// Index and value of the largest value; the first of several.
pub fn peak(values: &[f64]) -> Option<(usize, f64)> {
    values
        .iter()
        .copied()
        .enumerate()
        .reduce(|best, next| if next.1 > best.1 { next } else { best })
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
