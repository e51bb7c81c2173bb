//! Frames: shapes of the film at chosen times of a run, for pictures and animations.
//!
//! ```text
//! t_k = t_release + (t_end − t_release) (k/n)²,  k = 0 … n        and t = 0
//! ```
//!
//! Film moves most right after its release, so frames are dense there and sparse later. Each frame is
//! stored at the sample nearest to its time, so frames change no step and no bit of a run.

use serde::{Deserialize, Serialize};

use crate::mechanics::material::Regime;
use crate::scene::timeline::Timeline;

/// The film at one moment.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// Simulated time, s.
    pub time: f64,
    /// Position of each node, m, in single precision: for pictures only.
    pub positions: Vec<[f32; 3]>,
    /// Regime of each element: taut, wrinkled or slack.
    pub regimes: Vec<Regime>,
    /// Velocity of each node, m/s.
    pub velocities: Vec<[f32; 3]>,
    /// Principal second Piola-Kirchhoff stresses of each element, Pa, the larger first: those of the film law
    /// at the positions.
    pub stresses: Vec<[f32; 2]>,
    /// Distance of each node to other film, m, at most the contact distance. Empty without contact.
    pub gaps: Vec<f32>,
}

/// A value of a frame that is for pictures only: 12 bits of its mantissa, an error of at most 1/8192 of it.
/// Positions are not rounded. Chosen: below one step of a colour scale, and the file is smaller.
#[expect(clippy::cast_possible_truncation, reason = "frames are in single precision")]
pub fn rounded(value: f64) -> f32 {
    const DROPPED_BITS: u32 = 11;
    let bits = (value as f32).to_bits();
    let half = 1 << (DROPPED_BITS - 1);
    f32::from_bits(bits.saturating_add(half) & !((1 << DROPPED_BITS) - 1))
}

/// Frames of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    /// Nodes of each element, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Storey of each element: 0 the bottom cap, 1 to M the storeys from below, M + 1 the top cap. All 0
    /// if the film is not a capsule.
    pub storeys: Vec<u32>,
    /// In order of time.
    pub frames: Vec<Frame>,
}

impl Timeline {
    /// Indices of the samples that are frames, ascending.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "times above 0")]
    pub(crate) fn frame_samples(&self) -> Vec<u64> {
        let sample = |time: f64| libm::round(time / self.sample_interval) as u64;
        let end = libm::ceil(self.end_time / self.sample_interval - 1e-6) as u64;
        let mut samples = match self.frames {
            0 => return Vec::new(),
            1 => return vec![end],
            _ => vec![0],
        };
        let remaining = self.end_time - self.release_time;
        let last = self.frames - 1;
        samples.extend((0..=last).map(|k| {
            let fraction = f64::from(k) / f64::from(last);
            sample(self.release_time + remaining * fraction * fraction).min(end)
        }));
        // The end is always a frame, whatever the rounding.
        samples.push(end);
        samples.sort_unstable();
        samples.dedup();
        samples
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Thresholds;
    use crate::scene::inflow::Schedule;
    use proptest::prelude::*;

    fn timeline(frames: u32, end_time: f64, release_time: f64, sample_interval: f64) -> Timeline {
        Timeline {
            end_time,
            sample_interval,
            release_time,
            schedule: Schedule::new(&[]),
            ambient_pressure: 0.0,
            frames,
            thresholds: Thresholds::default(),
        }
    }

    #[test]
    fn rounded_values_are_near() {
        for value in [0.0, 1.0, -3.7, 1.999_999, 4.2e-9, -8.1e8] {
            let error = (f64::from(rounded(value)) - value).abs();
            assert!(error <= value.abs() / 8192.0, "{value}: {error}");
        }
        assert_eq!(rounded(0.0).to_bits(), 0);
        assert_eq!(rounded(0.3).to_bits() & 0x7ff, 0);
    }

    #[test]
    fn frames_are_dense_after_the_release() {
        let dense = timeline(5, 1.6, 0.0, 0.001).frame_samples();
        assert_eq!(dense, [0, 100, 400, 900, 1600]);
        assert_eq!(timeline(3, 2.0, 1.0, 0.25).frame_samples(), [0, 4, 5, 8]);
        assert_eq!(timeline(1, 1.0, 0.0, 0.3).frame_samples(), [4], "the end is an extra sample");
        assert!(timeline(0, 1.0, 0.0, 0.3).frame_samples().is_empty());
    }

    proptest! {
        #[test]
        fn every_frame_is_a_sample_and_start_and_end_are_frames(
            frames in 2_u32..200, end in 0.001..20.0_f64, part in 0.0..0.99_f64, samples in 1.0..3000.0_f64,
        ) {
            let timeline = timeline(frames, end, part * end, end / samples);
            let chosen = timeline.frame_samples();
            let last = *chosen.last().unwrap();
            prop_assert_eq!(chosen[0], 0);
            prop_assert_eq!(timeline.sample_time(last).to_bits(), end.to_bits());
            prop_assert!(last == 0 || timeline.sample_time(last - 1) < end);
            prop_assert!(chosen.windows(2).all(|pair| pair[0] < pair[1]));
            prop_assert!(chosen.len() <= frames as usize + 2);
        }
    }
}
