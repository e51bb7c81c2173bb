//! The course of a run, whatever model computes it: step, sample, audit, stop; and what it gives
//! back.
//!
//! [`run`] goes from start to end in one call. A [`Run`] is the same loop held in the hand: it can be
//! paused after any step, stored ([`crate::output::checkpoint`]), and goes on to the same bits.

use serde::{Deserialize, Serialize};

use crate::output::audit::{self, Audit};
use crate::output::frames::{Frame, Frames};
use crate::output::history::{History, Sample, Track};
use crate::output::measures::{self, Measures, Reference};
use crate::output::outcome::{Deployment, Failure, FailureKind, Stop};
use crate::scene::timeline::{Phase, Timeline};

/// A model in the middle of a run. [`Run`] asks it for nothing else, so every rung of the ladder
/// has the same windows, samples, ledger, measures and verdict.
pub trait Model {
    /// Advances to the time `target` (s) exactly, during which the phase does not change.
    ///
    /// # Errors
    /// [`Failure`] when the run stops short; the state is that of the last accepted step.
    fn advance(&mut self, target: f64, phase: &Phase) -> Result<(), Failure>;

    /// Advances towards `target` as [`Self::advance`], by at most `steps` steps, which it counts
    /// down; whether it got there. A model that cannot be paused goes on to the target.
    ///
    /// # Errors
    /// As [`Self::advance`].
    fn advance_at_most(
        &mut self,
        target: f64,
        phase: &Phase,
        _steps: &mut u64,
    ) -> Result<bool, Failure> {
        self.advance(target, phase).map(|()| true)
    }

    /// Itself now. The mass let in ([`crate::output::ledger::GasBalance::mass_in`]) is left to the loop,
    /// which takes it from the schedule.
    fn sample(&self, phase: &Phase) -> Sample;

    /// Static states of its design; a film that is no capsule has none, and so no verdict.
    fn reference(&self) -> Option<Reference>;

    /// Whether it has a bottom and a top ring, and so their heights in its samples.
    fn has_rings(&self) -> bool {
        true
    }

    /// Names of what it follows beside its samples.
    fn tracks(&self) -> Vec<Track> {
        Vec::new()
    }

    /// Values of what it follows now, in the order of [`Self::tracks`].
    fn follow(&self, _values: &mut Vec<f64>) {}

    /// Its shape now; none for a model without one.
    fn frame(&self) -> Option<Frame> {
        None
    }

    /// What its frames are shapes of: nodes and storey of each element.
    fn surface(&self) -> (Vec<[u32; 3]>, Vec<u32>) {
        (Vec::new(), Vec::new())
    }

    /// Largest principal second Piola-Kirchhoff film stress so far, Pa.
    fn film_stress(&self) -> f64;

    /// Accepted steps so far.
    fn steps(&self) -> u64;

    /// Elements of its mesh.
    fn elements(&self) -> usize;

    /// Whether it counts film passing through film, and intersections. A model without film has
    /// none to count, one without contact cannot.
    fn counts_passages(&self) -> bool;

    /// Film through film counted so far.
    fn passages(&self) -> u64 {
        0
    }
}

/// Runs a model through a course, from time 0.
///
/// A run whose energy ledger leaves [`audit::RESIDUAL_BOUND`] at any sample has
/// [failed](FailureKind::Drifted) at that sample, whatever it computed afterwards: the divisor of
/// the residual is known only at the end. Its history is kept whole for whoever looks for the
/// cause; it has no verdict.
pub fn run(model: &mut dyn Model, course: &Timeline, observer: &mut dyn Observer) -> Deployment {
    let mut run = Run::default();
    loop {
        if let Some(stop) = run.advance(model, course, u64::MAX, observer) {
            return run.finish(model, course, stop);
        }
    }
}

/// How far a run is: with the model's own state it says all that follows.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Samples so far.
    samples: Vec<Sample>,
    /// What the model follows, at each of them.
    tracks: Vec<Vec<f64>>,
    /// Shapes kept so far.
    frames: Vec<Frame>,
    /// The last break or sample landed on, s.
    time: f64,
}

impl Run {
    /// Goes on by about `steps` steps of the model; how the run ended, or `None` where it pauses.
    /// Pausing changes no bit of what follows.
    pub fn advance(
        &mut self,
        model: &mut dyn Model,
        course: &Timeline,
        mut steps: u64,
        observer: &mut dyn Observer,
    ) -> Option<Stop> {
        let breaks = course.breakpoints();
        let frames = course.frame_samples();
        // A pause never lies between a landing and its sample, so but for the first sample the phase
        // is that of the way just gone.
        let mut phase = course.phase(0.0, next_break(&breaks, 0.0, course.end_time));
        loop {
            let target = course.sample_time(self.samples.len() as u64);
            while self.time < target {
                let to = next_break(&breaks, self.time, target).min(target);
                phase = course.phase(self.time, to);
                match model.advance_at_most(to, &phase, &mut steps) {
                    Ok(true) => self.time = to,
                    Ok(false) => return None,
                    Err(failure) => return Some(Stop::Failed(failure)),
                }
            }
            if frames.binary_search(&(self.samples.len() as u64)).is_ok() {
                self.frames.extend(model.frame());
            }
            let mut sample = model.sample(&phase);
            sample.gas.mass_in = course.schedule.mass_until(target);
            let mut followed = Vec::new();
            model.follow(&mut followed);
            self.samples.push(sample);
            self.tracks.push(followed);
            let height = if model.has_rings() { sample.z_centre } else { sample.z_max };
            let progress = Progress {
                time: target,
                end_time: course.end_time,
                z_centre: height,
                pressure: sample.pressure,
            };
            if !observer.sample(progress) {
                return Some(Stop::Cancelled);
            }
            if sample.intersections > 0 {
                let place = format!("{} intersections of the mesh", sample.intersections);
                let kind = FailureKind::Interpenetrated;
                return Some(Stop::Failed(Failure { kind, time: target, place }));
            }
            if target >= course.end_time {
                return Some(Stop::Done);
            }
        }
    }

    /// Samples so far.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// What a run that ended so leaves.
    pub fn finish(self, model: &dyn Model, course: &Timeline, mut stop: Stop) -> Deployment {
        let mut history = History::of(&self.samples);
        if !model.has_rings() {
            history = history.without_rings();
        }
        let mut audit = Audit::of(&history, model.counts_passages());
        // A passage ends a run before the next sample could tell of it.
        audit.passages = audit.passages.map(|counted| counted.max(model.passages()));
        if stop == Stop::Done
            && let Some(time) = audit::first_drift(&history)
        {
            let place = format!("energy ledger, residual above {}", audit::RESIDUAL_BOUND);
            stop = Stop::Failed(Failure { kind: FailureKind::EnergyDrift, time, place });
        }
        let measures = match stop {
            Stop::Cancelled => Measures::default(),
            Stop::Done | Stop::Failed(_) => {
                let stress = model.film_stress();
                let done = stop == Stop::Done;
                measures::measure(&history, model.reference().as_ref(), course, stress, done)
            }
        };
        let mut tracks = model.tracks();
        for (at, track) in tracks.iter_mut().enumerate() {
            track.values = self.tracks.iter().map(|row| row[at]).collect();
        }
        let (steps, elements) = (model.steps(), model.elements());
        let frames = (!self.frames.is_empty()).then(|| {
            let (triangles, storeys) = model.surface();
            Frames { triangles, storeys, frames: self.frames }
        });
        Deployment { history, tracks, frames, measures, audit, stop, steps, elements }
    }
}

fn next_break(breaks: &[f64], time: f64, end: f64) -> f64 {
    breaks.iter().copied().find(|at| *at > time).unwrap_or(end)
}

/// Watches a run. It can see and stop it; it can never change it.
pub trait Observer {
    /// Called at every sample. Returning `false` ends the run with [`Stop::Cancelled`].
    fn sample(&mut self, progress: Progress) -> bool;
}

/// Where a run stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Simulated time, s.
    pub time: f64,
    /// Simulated time at the end, s.
    pub end_time: f64,
    /// Height of the top centre, or of the highest node where there is none, m.
    pub z_centre: f64,
    /// Gas pressure, Pa.
    pub pressure: f64,
}

/// Sees nothing, stops nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn sample(&mut self, _: Progress) -> bool {
        true
    }
}

#[cfg(test)]
mod tests;
