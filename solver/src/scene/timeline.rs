//! What happens when: the part of a scene that is no model's own.

use crate::scene::film_scene::{Filling, FilmScene};
use crate::scene::inflow::{Inflow, Schedule};
use crate::scene::{Scene, Thresholds};

/// What acts from outside, constant between two breaks of a course.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Phase {
    /// Held at its stowed height by the packing lid.
    pub packed: bool,
    /// Gas let in.
    pub inflow: Inflow,
}

/// What happens when, and what is looked at: the part of a scene that is no model's own.
#[derive(Debug, Clone, PartialEq)]
pub struct Timeline {
    /// Simulated time, s.
    pub end_time: f64,
    /// Time between samples, s.
    pub sample_interval: f64,
    /// Until when the lid holds, s.
    pub release_time: f64,
    /// Gas let in.
    pub schedule: Schedule,
    /// Pressure outside, Pa.
    pub ambient_pressure: f64,
    /// Frames to keep.
    pub frames: u32,
    /// Thresholds of the verdict.
    pub thresholds: Thresholds,
}

impl Timeline {
    /// The course of a scene.
    pub fn new(scene: &Scene) -> Self {
        Self {
            end_time: scene.solver.end_time,
            sample_interval: scene.outputs.sample_interval,
            release_time: scene.release_time,
            schedule: Schedule::new(&scene.gas.windows),
            ambient_pressure: scene.gas.ambient_pressure,
            frames: scene.outputs.frames,
            thresholds: scene.outputs.thresholds,
        }
    }

    /// The course of a film's scene; it has no verdict and so the usual thresholds.
    pub fn of_film(scene: &FilmScene) -> Self {
        let (schedule, ambient_pressure) = match &scene.filling {
            Filling::Pressure(_) => (Schedule::new(&[]), 0.0),
            Filling::Gas { supply, .. } => {
                (Schedule::new(&supply.windows), supply.ambient_pressure)
            }
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

    /// Times at which the phase changes, rising, s.
    pub fn breaks(&self) -> Vec<f64> {
        let mut breaks = self.schedule.edges().to_vec();
        breaks.push(self.release_time);
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        breaks
    }

    /// The phase between two times (s) without a break between them.
    pub fn phase(&self, from: f64, to: f64) -> Phase {
        let packed = 0.5 * (from + to) < self.release_time;
        Phase { packed, inflow: self.schedule.between(from, to) }
    }

    /// Time of sample `index`, s; the last is the end.
    pub fn sample_time(&self, index: u64) -> f64 {
        let time = index as f64 * self.sample_interval;
        // A sample this near to the end is the end.
        if time > self.end_time - 1e-6 * self.sample_interval { self.end_time } else { time }
    }
}
