//! What a history says, in single numbers, and the verdict.

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
    /// Whether a threshold of the verdict was met or missed by less than `close_margin`.
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
    /// First time from which the kinetic energy stays below 1e-4 of its peak for 50 ms, s.
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
