//! Peaks of motion and force, as means over τ = [`MEAN_TIME`]: a shake that is over sooner hardly counts.
//!
//! ```text
//! speed          largest |z(t + τ) − z(t)|/τ
//! acceleration   largest |z(t + τ) − 2 z(t) + z(t − τ)|/τ²
//! base force     largest |I(t + τ) − I(t)|/τ       I(t) = Σ m v_z − g Σ m t:  what holds the film gave it this impulse
//! ```
//!
//! z (of the top ring) and I are linear between samples; t is the time of a sample. The pressure on closed film has no
//! resultant, so I needs no force.

/// τ, s. Chosen: a sixth of the time in which 5 g/s raise the paper's capsule to half of its height. Then seed, step,
/// damping and contact distance change its peak speed by at most 2 %.
pub const MEAN_TIME: f64 = 0.005;

/// The value of a series at a time; `None` outside it.
fn at(time: &[f64], z: &[f64], t: f64) -> Option<f64> {
    let next = time.partition_point(|sample| *sample < t);
    let before = *time.get(next.checked_sub(1)?)?;
    let share = (t - before) / (time.get(next)? - before);
    Some(z[next - 1] + share * (z[next] - z[next - 1]))
}

/// The largest magnitude of a value at each sample; `None` where there is none.
fn largest(time: &[f64], z: &[f64], value: impl Fn(f64, f64) -> Option<f64>) -> Option<f64> {
    time.iter().zip(z).filter_map(|(t, z)| value(*t, *z)).map(f64::abs).reduce(f64::max)
}

/// The largest rate of a series, over τ; `None` where it is too short.
pub(super) fn rate(time: &[f64], z: &[f64]) -> Option<f64> {
    largest(time, z, |t, from| Some((at(time, z, t + MEAN_TIME)? - from) / MEAN_TIME))
}

/// The largest change of that rate from τ to the next, over τ; `None` where it is too short.
pub(super) fn change_of_rate(time: &[f64], z: &[f64]) -> Option<f64> {
    largest(time, z, |t, now| {
        let [before, after] = [at(time, z, t - MEAN_TIME)?, at(time, z, t + MEAN_TIME)?];
        Some((after - 2.0 * now + before) / (MEAN_TIME * MEAN_TIME))
    })
}
