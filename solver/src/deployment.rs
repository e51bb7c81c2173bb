//! The course of a run, whatever model computes it: step, sample, audit, stop; and what it gives
//! back.

use crate::audit::{self, Audit};
use crate::course::{Course, Phase};
use crate::history::{History, Sample};
use crate::measures::{self, Measures, Reference};

/// A model in the middle of a run. [`run`] asks it for nothing else, so every rung of the ladder
/// has the same windows, samples, ledger, measures and verdict.
pub trait Model {
    /// Advances to the time `target` (s) exactly, during which the phase does not change.
    ///
    /// # Errors
    /// [`Failure`] when the run stops short; the state is that of the last accepted step.
    fn advance(&mut self, target: f64, phase: &Phase) -> Result<(), Failure>;

    /// Itself now. The mass let in ([`crate::ledger::GasBooks::mass_in`]) is left to the loop,
    /// which takes it from the schedule.
    fn sample(&self, phase: &Phase) -> Sample;

    /// Static states of its design.
    fn reference(&self) -> Reference;

    /// Largest principal second Piola-Kirchhoff film stress so far, Pa.
    fn film_stress(&self) -> f64;

    /// Accepted steps so far.
    fn steps(&self) -> u64;

    /// Elements of its mesh.
    fn elements(&self) -> usize;

    /// Whether it counts film passing through film, and intersections. A model without film has
    /// none to count, one without contact cannot.
    fn counts_passages(&self) -> bool;
}

/// Runs a model through a course, from time 0.
///
/// A run whose energy ledger leaves [`audit::RESIDUAL_BOUND`] at any sample has
/// [failed](FailureKind::Drifted) at that sample, whatever it computed afterwards: the divisor of
/// the residual is known only at the end. Its history is kept whole for whoever looks for the
/// cause; it has no verdict.
pub fn run(model: &mut dyn Model, course: &Course, observer: &mut dyn Observer) -> Deployment {
    let breaks = course.breaks();
    let mut samples = Vec::new();
    let mut stop = Stop::Done;
    let mut time = 0.0;
    let mut phase = course.phase(0.0, next_break(&breaks, 0.0, course.end_time));
    for index in 0.. {
        let target = course.sample_time(index);
        if let Err(failure) = advance(model, course, &breaks, &mut time, target, &mut phase) {
            stop = Stop::Failed(failure);
            break;
        }
        let mut sample = model.sample(&phase);
        sample.gas.mass_in = course.schedule.mass_until(target);
        samples.push(sample);
        let progress = Progress {
            time: target,
            end_time: course.end_time,
            z_centre: sample.z_centre,
            pressure: sample.pressure,
        };
        if !observer.sample(progress) {
            stop = Stop::Cancelled;
            break;
        }
        if target >= course.end_time {
            break;
        }
    }
    finish(model, course, &samples, stop)
}

fn next_break(breaks: &[f64], time: f64, end: f64) -> f64 {
    breaks.iter().copied().find(|at| *at > time).unwrap_or(end)
}

/// Advances from break to break up to `target`; leaves the phase the model was last in.
fn advance(
    model: &mut dyn Model,
    course: &Course,
    breaks: &[f64],
    time: &mut f64,
    target: f64,
    phase: &mut Phase,
) -> Result<(), Failure> {
    while *time < target {
        let to = next_break(breaks, *time, target).min(target);
        *phase = course.phase(*time, to);
        model.advance(to, phase)?;
        *time = to;
    }
    Ok(())
}

fn finish(model: &dyn Model, course: &Course, samples: &[Sample], mut stop: Stop) -> Deployment {
    let history = History::of(samples);
    let audit = Audit::of(&history, model.counts_passages());
    if stop == Stop::Done
        && let Some(time) = audit::first_drift(&history)
    {
        let place = format!("energy ledger, residual above {}", audit::RESIDUAL_BOUND);
        stop = Stop::Failed(Failure { kind: FailureKind::Drifted, time, place });
    }
    let measures = match stop {
        Stop::Cancelled => Measures::default(),
        Stop::Done | Stop::Failed(_) => {
            let stress = model.film_stress();
            let done = stop == Stop::Done;
            measures::measure(&history, &model.reference(), course, stress, done)
        }
    };
    Deployment { history, measures, audit, stop, steps: model.steps(), elements: model.elements() }
}

/// The result of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Deployment {
    /// Time series, up to the end or to the moment the run stopped.
    pub history: History,
    /// What the history says, in single numbers.
    pub measures: Measures,
    /// What the history is worth.
    pub audit: Audit,
    /// How the run ended.
    pub stop: Stop,
    /// Accepted steps.
    pub steps: u64,
    /// Elements of the mesh (0 for a model without one).
    pub elements: usize,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Stop {
    /// Reached its end time.
    Done,
    /// The observer asked for an end; nothing of it is a result.
    Cancelled,
    /// Stopped short: a typed outcome, stored as such.
    Failed(Failure),
}

/// Why, when and where a run stopped short.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// Kind.
    pub kind: FailureKind,
    /// Simulated time, s.
    pub time: f64,
    /// Where: an element, a node, or the part of the model, in words.
    pub place: String,
}

/// The kinds of failure a run can end in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FailureKind {
    /// State no longer finite, or growing without bound.
    Unstable,
    /// The energy ledger left its bound.
    Drifted,
    /// The enclosed volume fell to zero or below.
    InvertedVolume,
    /// More steps than allowed, or a step too small to advance time.
    StepLimit,
    /// Film went through film.
    Interpenetrated,
}

impl FailureKind {
    /// Every kind, in the order of the documentation.
    pub const ALL: [Self; 5] = [
        Self::Unstable,
        Self::Drifted,
        Self::InvertedVolume,
        Self::StepLimit,
        Self::Interpenetrated,
    ];

    /// Name, as in the table's `status` column.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unstable => "unstable",
            Self::Drifted => "drifted",
            Self::InvertedVolume => "inverted_volume",
            Self::StepLimit => "step_limit",
            Self::Interpenetrated => "interpenetrated",
        }
    }
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
    /// Height of the top centre, m.
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
