//! The run loop, the same for every model: advance, sample, audit, stop.
//!
//! [`run`] goes from start to end in one call. Its [`Observer`] is asked every few steps whether the run goes
//! on, and can ask for a checkpoint ([`crate::output::checkpoint`]). A [`Run`] is the same loop as a value:
//! read from a checkpoint it continues with the same bits.

use serde::{Deserialize, Serialize};

use crate::geometry::field::Field;
use crate::output::audit::{self, Audit};
use crate::output::checkpoint::CheckpointError;
use crate::output::events::Event;
use crate::output::frames::{Frame, Frames};
use crate::output::history::{History, Sample, Track};
use crate::output::measures::{self, Measures, Reference};
use crate::output::outcome::{AuditKind, Deployment, Failure, Stop};
use crate::scene::timeline::{Phase, Timeline};

mod recent;

pub use recent::FILM_SPEED;
use recent::RecentPositions;

/// A model during a run. [`Run`] uses nothing else of a model, so every model has the same inflow windows,
/// samples, ledger, measures and verdict.
pub trait Model {
    /// Advances to exactly the time `target` (s). The phase is constant until then.
    ///
    /// # Errors
    /// [`Failure`] if the run stops early; the state is that of the last accepted step.
    fn advance(&mut self, target: f64, phase: &Phase) -> Result<(), Failure> {
        self.advance_at_most(target, phase, &mut u64::MAX.clone()).map(|_| ())
    }

    /// Advances towards `target` as [`Self::advance`], by at most `steps` steps, and subtracts the steps
    /// taken from `steps`. Returns whether it reached the target. A model that cannot pause always does.
    fn advance_at_most(
        &mut self,
        target: f64,
        phase: &Phase,
        steps: &mut u64,
    ) -> Result<bool, Failure>;

    /// The decisions of the step controller since the last call.
    fn take_events(&mut self) -> Vec<Event> {
        Vec::new()
    }

    /// The sampled quantities now, except the mass let in ([`crate::output::ledger::GasBalance::mass_in`]):
    /// the run loop takes it from the inflow schedule.
    fn sample(&self, phase: &Phase) -> Sample;

    /// The positions of its nodes now, m; `None` for a model without nodes.
    fn positions(&self) -> Option<Field> {
        None
    }

    /// The static equilibria with which a run of this final overpressure (Pa) is compared, for a model that
    /// has them in closed form. A model without is judged after its run
    /// ([`Deployment::judge`]).
    fn reference(&self, _final_overpressure: f64) -> Option<Reference> {
        None
    }

    /// Whether it has a bottom and a top ring, so that its samples have ring heights.
    fn has_rings(&self) -> bool {
        true
    }

    /// Its tracks, without values.
    fn tracks(&self) -> Vec<Track> {
        Vec::new()
    }

    /// Appends the values of its tracks now, in the order of [`Self::tracks`].
    fn follow(&self, _values: &mut Vec<f64>) {}

    /// Its shape now; `None` for a model without a mesh.
    fn frame(&self) -> Option<Frame> {
        None
    }

    /// The surface of its frames: nodes and storey of each element.
    fn surface(&self) -> (Vec<[u32; 3]>, Vec<u32>) {
        (Vec::new(), Vec::new())
    }

    /// Largest principal second Piola-Kirchhoff film stress so far, Pa.
    fn film_stress(&self) -> f64;

    /// Accepted steps so far.
    fn steps(&self) -> u64;

    /// Number of elements of its mesh.
    fn elements(&self) -> usize {
        0
    }

    /// Whether it counts passages and intersections. A model without a mesh or without contact does not.
    fn counts_passages(&self) -> bool {
        false
    }

    /// Passages of film through film counted so far.
    fn passages(&self) -> u64 {
        0
    }

    /// Whether a checkpoint of the state now continues with the same bits, also those of a failure. If not,
    /// a state within the next steps is.
    fn can_store(&self) -> bool {
        true
    }

    /// The checkpoint of a run in the state now, as text, for the scene with this fingerprint; `None` for a
    /// model without checkpoints.
    fn checkpoint(&self, _fingerprint: &str, _run: &Run) -> Option<CheckpointText> {
        None
    }
}

/// A checkpoint as text, or why the state cannot be stored.
pub type CheckpointText = Result<String, CheckpointError>;

/// Runs a model from time 0 to the end of its timeline.
///
/// A run whose ledger residual is above [`audit::MAX_LEDGER_RESIDUAL`] at any sample fails at that sample
/// with [`AuditKind::EnergyLedger`], one whose gas residual is above [`audit::MAX_GAS_RESIDUAL`] with
/// [`AuditKind::GasBalance`]. This is decided at the end, when the divisor of the residual is known;
/// so the history is complete, but there is no verdict.
pub fn run(model: &mut dyn Model, timeline: &Timeline, observer: &mut dyn Observer) -> Deployment {
    Run::default().complete(model, timeline, observer)
}

/// Progress of a run. Together with the model's state it determines the rest of the run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Samples so far.
    samples: Vec<Sample>,
    /// Values of the tracks at each sample.
    tracks: Vec<Vec<f64>>,
    /// Frames so far.
    frames: Vec<Frame>,
    /// Events so far.
    events: Vec<Event>,
    /// Positions of the last 5 ms.
    recent: RecentPositions,
    /// Last breakpoint or sample time reached, s.
    time: f64,
}

impl Run {
    /// Whether it can be a run of this model: every sample has a value of each of its tracks.
    pub fn fits(&self, model: &dyn Model) -> bool {
        let tracks = tracks(model).len();
        self.tracks.len() == self.samples.len()
            && self.tracks.iter().all(|row| row.len() == tracks)
            && self.recent.fits(model.positions().map_or(0, |now| now.len()))
    }

    /// Continues to the end of the timeline, as [`run`] does.
    pub fn complete(
        mut self,
        model: &mut dyn Model,
        timeline: &Timeline,
        observer: &mut dyn Observer,
    ) -> Deployment {
        let stop = loop {
            let steps = observer.steps();
            if let Some(stop) = self.advance(model, timeline, steps, observer) {
                break stop;
            }
            match observer.pause(model.steps()) {
                Answer::Continue => {}
                Answer::End => break Stop::Cancelled,
                Answer::Store => {
                    if let Some(stop) = self.advance_until_storable(model, timeline, observer) {
                        break stop;
                    }
                    let text = |fingerprint: &str| model.checkpoint(fingerprint, &self);
                    let pause = Pause { time: self.time, steps: model.steps(), text: &text };
                    if !observer.store(&pause) {
                        break Stop::Cancelled;
                    }
                }
            }
        };
        self.finish(model, timeline, stop)
    }

    /// Advances until a checkpoint is possible. Returns how the run ended, if it ended before.
    fn advance_until_storable(
        &mut self,
        model: &mut dyn Model,
        timeline: &Timeline,
        observer: &mut dyn Observer,
    ) -> Option<Stop> {
        while !model.can_store() {
            if let Some(stop) = self.advance(model, timeline, 1, observer) {
                return Some(stop);
            }
        }
        None
    }

    /// Advances by at most `steps` steps of the model. Returns how the run ended, or `None` if it pauses. A
    /// pause changes no bit of the run.
    pub fn advance(
        &mut self,
        model: &mut dyn Model,
        timeline: &Timeline,
        mut steps: u64,
        observer: &mut dyn Observer,
    ) -> Option<Stop> {
        let breakpoints = timeline.breakpoints();
        let frames = timeline.frame_samples();
        // The phase of a sample is that of the interval before it, except for the first sample. A pause
        // never lies between the end of that interval and the sample.
        let mut phase = timeline.phase(0.0, next_breakpoint(&breakpoints, 0.0, timeline.end_time));
        loop {
            let target = timeline.sample_time(self.samples.len() as u64);
            while self.time < target {
                let end = next_breakpoint(&breakpoints, self.time, target).min(target);
                phase = timeline.phase(self.time, end);
                let advanced = model.advance_at_most(end, &phase, &mut steps);
                self.events.extend(model.take_events());
                match advanced {
                    Ok(true) => self.time = end,
                    Ok(false) => return None,
                    Err(failure) => return Some(Stop::Failed(failure)),
                }
            }
            if frames.binary_search(&(self.samples.len() as u64)).is_ok() {
                self.frames.extend(model.frame());
            }
            let mut sample = model.sample(&phase);
            sample.gas.mass_in = timeline.schedule.mass_until(target);
            let mut values = Vec::new();
            model.follow(&mut values);
            values.extend(model.positions().map(|now| self.recent.speed(target, now)));
            self.samples.push(sample);
            self.tracks.push(values);
            let height = if model.has_rings() { sample.z_centre } else { sample.height };
            let progress = Progress {
                time: target,
                end_time: timeline.end_time,
                height,
                pressure: sample.pressure,
            };
            if !observer.sample(progress) {
                return Some(Stop::Cancelled);
            }
            if sample.intersections > 0 {
                let place = format!("{} intersections of the mesh", sample.intersections);
                let failure = Failure::new(AuditKind::Intersections, target, place);
                return Some(Stop::Failed(failure));
            }
            if target >= timeline.end_time {
                return Some(Stop::Done);
            }
        }
    }

    /// Samples so far.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// The result of a run that ended with `stop`.
    pub fn finish(self, model: &dyn Model, timeline: &Timeline, mut stop: Stop) -> Deployment {
        let mut history = History::of(&self.samples);
        if !model.has_rings() {
            history = history.without_rings();
        }
        let mut audit = Audit::of(&history, model.counts_passages());
        // A passage ends a run before the next sample can count it.
        audit.passages = audit.passages.map(|counted| counted.max(model.passages()));
        if stop == Stop::Done
            && let Some(failure) = judged(&history)
        {
            stop = Stop::Failed(failure);
        }
        let measures = match stop {
            Stop::Cancelled => Measures::default(),
            Stop::Done | Stop::Failed(_) => {
                let stress = model.film_stress();
                let done = stop == Stop::Done;
                let overpressure = measures::final_overpressure(&history, timeline);
                let reference = overpressure.and_then(|pressure| model.reference(pressure));
                measures::measure(&history, reference.as_ref(), timeline, stress, done)
            }
        };
        let mut tracks = tracks(model);
        for (index, track) in tracks.iter_mut().enumerate() {
            track.values = self.tracks.iter().map(|row| row[index]).collect();
        }
        let (steps, elements) = (model.steps(), model.elements());
        let frames = (!self.frames.is_empty()).then(|| {
            let (triangles, storeys) = model.surface();
            Frames { triangles, storeys, frames: self.frames }
        });
        let events = self.events;
        Deployment { history, tracks, events, frames, measures, audit, stop, steps, elements }
    }
}

/// The tracks of a model without values, and the speed of its nodes.
fn tracks(model: &dyn Model) -> Vec<Track> {
    let (name, unit, meaning) = FILM_SPEED;
    let speed = || Track { name: name.to_owned(), unit, meaning, values: Vec::new() };
    let mut tracks = model.tracks();
    tracks.extend(model.positions().map(|_| speed()));
    tracks
}

/// What the residuals of a whole history show: a gas that does not add up, or a ledger that does not close.
fn judged(history: &History) -> Option<Failure> {
    if let Some(time) = audit::first_above(history, "gas_residual", audit::MAX_GAS_RESIDUAL) {
        let place = format!("gas balance: residual above {:e}", audit::MAX_GAS_RESIDUAL);
        return Some(Failure::new(AuditKind::GasBalance, time, place));
    }
    let time = audit::first_above(history, "ledger_residual", audit::MAX_LEDGER_RESIDUAL)?;
    let place = format!("energy ledger: residual above {}", audit::MAX_LEDGER_RESIDUAL);
    Some(Failure::new(AuditKind::EnergyLedger, time, place))
}

fn next_breakpoint(breakpoints: &[f64], time: f64, end: f64) -> f64 {
    breakpoints.iter().copied().find(|at| *at > time).unwrap_or(end)
}

/// Observes a run. It can end the run but never change it.
pub trait Observer {
    /// Called at every sample. Returning `false` ends the run with [`Stop::Cancelled`].
    fn sample(&mut self, progress: Progress) -> bool;

    /// Called between the parts of the preparation of a run, as mesh and first search for contact. Returning
    /// `false` ends the run with [`Stop::Cancelled`].
    fn prepares(&mut self) -> bool {
        true
    }

    /// Number of steps until the next call of [`Self::pause`]. 0 asks before the next step.
    fn steps(&mut self) -> u64 {
        u64::MAX
    }

    /// Called between two steps, after this number of accepted steps since time 0.
    fn pause(&mut self, _steps: u64) -> Answer {
        Answer::Continue
    }

    /// Receives the state asked for by [`Answer::Store`]. Returning `false` ends the run with
    /// [`Stop::Cancelled`].
    fn store(&mut self, _pause: &Pause<'_>) -> bool {
        true
    }
}

/// What an observer wants at a pause.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// The run goes on.
    Continue,
    /// The run ends with [`Stop::Cancelled`].
    End,
    /// The run gives its state to [`Observer::store`], at once or a few steps later
    /// ([`Model::can_store`]).
    Store,
}

/// A run between two steps.
#[derive(Clone, Copy)]
pub struct Pause<'a> {
    /// Last breakpoint or sample time reached, s.
    pub time: f64,
    /// Accepted steps since time 0.
    pub steps: u64,
    /// [`Model::checkpoint`] of the run, by the fingerprint of its scene.
    pub text: &'a dyn Fn(&str) -> Option<CheckpointText>,
}

/// Where a run is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Simulated time, s.
    pub time: f64,
    /// Simulated time at the end, s.
    pub end_time: f64,
    /// Height of the top centre, m; of the whole film if it has no rings.
    pub height: f64,
    /// Gas pressure, Pa.
    pub pressure: f64,
}

/// An observer that does nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn sample(&mut self, _: Progress) -> bool {
        true
    }
}

#[cfg(test)]
mod tests;
