//! Wall time of a step, stage by stage, from a state.
//!
//! The same steps are repeated from one state, alternately with a clock in every stage and without.
//! The time of a stage is its minimum over the repeats, the whole is the minimum without clocks: other
//! processes can only add time.

use std::time::Instant;

use billow_solver::integrators::FilmSimulation;
use billow_solver::models::run::Model;
use billow_solver::platform::stopwatch::{Stage, Stopwatch, Untimed};
use billow_solver::scene::timeline::Timeline;

use super::capsule::{Capsule, State};
use super::clock::Clock;
use super::{Effort, Line, interrupted, machine};
use billow_study::input::value::Value;
use billow_study::platform::error::{Error, Result};
use billow_study::platform::stop::Stop;

/// Steps in a block of the tunnelling monitor; a whole number of blocks is timed.
const BLOCK: u64 = 50;

/// Costs from one state, ns per element and step.
#[derive(Debug, Clone, PartialEq)]
pub struct StageRow {
    /// Elements along each edge of the pattern, n.
    pub subdivisions: u32,
    /// Name of the state.
    pub state: &'static str,
    /// Its time, s.
    pub time: f64,
    /// Number of elements.
    pub elements: usize,
    /// Length of a step, s.
    pub step: f64,
    /// Each stage, in the order of [`Stage::ALL`], ns.
    pub stages: [f64; Stage::ALL.len()],
    /// One sample and one frame per sample interval, divided by the steps between, ns.
    pub output: f64,
    /// A step without clocks, and the output, ns.
    pub whole: f64,
    /// Fraction of the wall time of those steps in which this thread ran on a core.
    pub core_share: Option<f64>,
}

impl StageRow {
    /// As a row of the report.
    pub fn line(&self) -> Line {
        let rate = 1.0 / self.step;
        let mut line = vec![
            ("subdivisions", Value::Integer(self.subdivisions.into())),
            ("state", Value::Text(self.state.to_owned())),
            ("time", Value::Number(self.time)),
            ("elements", Value::Integer(i64::try_from(self.elements).unwrap_or(i64::MAX))),
        ];
        let stages = Stage::ALL.into_iter().zip(self.stages);
        line.extend(stages.map(|(stage, cost)| (stage.name(), Value::Number(cost))));
        line.push(("output", Value::Number(self.output)));
        line.push(("whole", Value::Number(self.whole)));
        line.push(("steps_per_second", Value::Number(rate)));
        let wall = 1e-9 * self.whole * self.elements as f64 * rate;
        line.push(("wall_per_second", Value::Number(wall)));
        line.push(("core_share", self.core_share.map_or(Value::Null, Value::Number)));
        line
    }
}

/// Times the stages from a state.
///
/// # Errors
/// A failure of the run; a signal.
pub fn measure(capsule: &Capsule, state: &State, effort: Effort, stop: &Stop) -> Result<StageRow> {
    let elements = state.run.elements();
    let (steps, repeats) = (steps(effort, elements), effort.repeats());
    let share = 1e9 / (steps as f64 * elements as f64);
    let mut least = [f64::INFINITY; Stage::ALL.len()];
    let (mut whole, mut core_share, mut step) = (f64::INFINITY, None, f64::NAN);
    for _ in 0..repeats {
        let mut film = state.run.film.clone();
        let (start, core) = (Instant::now(), machine::core_seconds());
        take_steps(&mut film, &capsule.timeline, steps, &mut Untimed)?;
        let wall = start.elapsed().as_secs_f64();
        if share * wall < whole {
            whole = share * wall;
            let on_core = machine::core_seconds().zip(core).map(|(now, then)| now - then);
            core_share = machine::core_share(on_core, wall);
        }
        step = (film.view().state.time - state.run.view().state.time) / steps as f64;
        interrupted(stop)?;

        let (mut film, mut clock) = (state.run.film.clone(), Clock::default());
        take_steps(&mut film, &capsule.timeline, steps, &mut clock)?;
        clock.stop();
        for (least, stage) in least.iter_mut().zip(Stage::ALL) {
            *least = least.min(share * clock.seconds(stage));
        }
        interrupted(stop)?;
    }
    let output = output(capsule, state, repeats) * step / capsule.timeline.sample_interval;
    let output = 1e9 * output / elements as f64;
    Ok(StageRow {
        subdivisions: capsule.subdivisions,
        state: state.name,
        time: state.time,
        elements,
        step,
        stages: least,
        output,
        whole: whole + output,
        core_share,
    })
}

/// Number of steps to time: whole blocks of the monitor, fewer for a large mesh.
fn steps(effort: Effort, elements: usize) -> u64 {
    let blocks = match effort {
        Effort::Quick => 2,
        Effort::Usual | Effort::Full if elements > 20_000 => 4,
        Effort::Usual | Effort::Full => 10,
    };
    blocks * BLOCK
}

/// Takes a number of steps along a timeline, with the same interval ends as a run.
///
/// # Errors
/// A failure of the run.
pub fn take_steps(
    film: &mut FilmSimulation,
    timeline: &Timeline,
    mut steps: u64,
    stopwatch: &mut dyn Stopwatch,
) -> Result<()> {
    let breakpoints = timeline.breakpoints();
    let mut time = film.view().state.time;
    loop {
        let to = next_stop(timeline, &breakpoints, time);
        let phase = timeline.phase(time, to);
        let arrived = film.advance_timed(to, &phase, &mut steps, stopwatch).map_err(|failure| {
            Error::JobsFailed(format!(
                "{} at {} s: {}",
                failure.kind.name(),
                failure.time,
                failure.place
            ))
        })?;
        if !arrived {
            return Ok(());
        }
        time = to;
    }
}

/// The first breakpoint or sample after a time, s.
fn next_stop(timeline: &Timeline, breakpoints: &[f64], time: f64) -> f64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
    let passed = libm::floor(time / timeline.sample_interval + 1e-6) as u64;
    let sample = timeline.sample_time(passed + 1);
    let next = breakpoints.iter().copied().find(|breakpoint| *breakpoint > time);
    next.map_or(sample, |breakpoint| breakpoint.min(sample))
}

/// Shortest time of a sample and a frame, s.
fn output(capsule: &Capsule, state: &State, repeats: usize) -> f64 {
    let time = state.run.view().state.time;
    let phase = capsule.timeline.phase(time, time + capsule.timeline.sample_interval);
    let mut tracked = Vec::new();
    let times = (0..repeats.max(3)).map(|_| {
        let start = Instant::now();
        let sample = state.run.sample(&phase);
        tracked.clear();
        state.run.follow(&mut tracked);
        let frame = state.run.frame();
        let seconds = start.elapsed().as_secs_f64();
        std::hint::black_box((sample, &tracked, frame));
        seconds
    });
    times.fold(f64::INFINITY, f64::min)
}
