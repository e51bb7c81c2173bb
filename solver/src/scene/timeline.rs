//! Times and external conditions of a run: the part of a scene that every model shares.

use crate::scene::film_scene::{Filling, FilmScene};
use crate::scene::inflow::{Inflow, Schedule};
use crate::scene::{Scene, Thresholds};

/// External conditions, constant between two breakpoints of a timeline.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Phase {
    /// Whether the packing lid limits the capsule to its stowed height.
    pub packed: bool,
    /// Inflow.
    pub inflow: Inflow,
    /// Time until which the phase holds, s, for steps that go beyond a sample; 0 where it is not known.
    pub end: f64,
}

/// Shortest last interval over the sample interval: a sample closer to the end time becomes the last.
/// Chosen: far above rounding of k times the interval.
const MIN_LAST_INTERVAL: f64 = 1e-6;

/// Times, inflow, and sampling of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Timeline {
    /// Simulated time, s.
    pub end_time: f64,
    /// Time between samples, s.
    pub sample_interval: f64,
    /// Time at which the lid releases the capsule, s.
    pub release_time: f64,
    /// Inflow schedule.
    pub schedule: Schedule,
    /// Pressure outside, Pa.
    pub ambient_pressure: f64,
    /// Number of frames to keep.
    pub frames: u32,
    /// Thresholds of the verdict.
    pub thresholds: Thresholds,
}

impl Timeline {
    /// The timeline of a capsule's scene.
    pub fn new(scene: &Scene) -> Self {
        Self {
            end_time: scene.solver.end_time,
            sample_interval: scene.outputs.sample_interval,
            release_time: scene.release_time,
            schedule: Schedule::of(&scene.gas),
            ambient_pressure: scene.gas.ambient_pressure,
            frames: scene.outputs.frames,
            thresholds: scene.outputs.thresholds,
        }
    }

    /// The timeline of a film's scene. It has no verdict; the thresholds are the defaults.
    pub fn of_film(scene: &FilmScene) -> Self {
        let (schedule, ambient_pressure) = match &scene.filling {
            Filling::Pressure(_) => (Schedule::new(&[]), 0.0),
            Filling::Gas { supply, .. } => (Schedule::of(supply), supply.ambient_pressure),
        };
        Self {
            end_time: scene.solver.end_time,
            sample_interval: scene.outputs.sample_interval,
            release_time: scene.release_time,
            schedule,
            ambient_pressure,
            frames: scene.outputs.frames,
            thresholds: Thresholds::default(),
        }
    }

    /// Times at which the phase changes, in ascending order, s.
    pub fn breakpoints(&self) -> Vec<f64> {
        let mut breakpoints = self.schedule.change_times().to_vec();
        breakpoints.push(self.release_time);
        breakpoints.sort_by(f64::total_cmp);
        breakpoints.dedup();
        breakpoints
    }

    /// The phase between two times (s) without a breakpoint between them.
    pub fn phase(&self, from: f64, to: f64) -> Phase {
        let packed = 0.5 * (from + to) < self.release_time;
        let breakpoints = self.breakpoints();
        let later = breakpoints.iter().copied().find(|time| *time >= to);
        let end = later.map_or(self.end_time, |time| time.min(self.end_time));
        Phase { packed, inflow: self.schedule.between(from, to), end }
    }

    /// Time of sample `index`, s; the last sample is at the end time.
    pub fn sample_time(&self, index: u64) -> f64 {
        let time = index as f64 * self.sample_interval;
        if time > self.end_time - MIN_LAST_INTERVAL * self.sample_interval {
            self.end_time
        } else {
            time
        }
    }
}
