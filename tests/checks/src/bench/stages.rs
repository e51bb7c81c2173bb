//! Wall time of a step, stage by stage, from a state.
//!
//! The same steps are repeated from one state, alternately with a clock in every stage and without.
//! The time of a stage is its minimum over the repeats, the whole is the minimum without clocks: other
//! processes can only add time.

use std::time::{Duration, Instant};

use billow_solver::integrators::FilmSimulation;
use billow_solver::models::film::FilmRun;
use billow_solver::models::run::Model;
use billow_solver::platform::stopwatch::{Stage, Stopwatch, Untimed};
use billow_solver::scene::timeline::Timeline;

use billow_study::platform::error::{Error, Result};

use super::capsule::Capsule;
use super::{REPEATS, Row, cost};
use crate::cases::rig::stopped;

/// Steps that are timed: whole blocks of 50 steps of the tunnelling monitor, fewer on a large mesh.
const STEPS: [u64; 2] = [500, 200];
/// Elements above which a mesh is large. Chosen.
const LARGE: usize = 20_000;

/// Times the stages from a state of this name; the costs are ns per element and step.
pub(super) fn measure(capsule: &Capsule, name: &str, run: &FilmRun) -> Result<Row> {
    let elements = run.elements();
    let steps = STEPS[usize::from(elements > LARGE)];
    let mut least = [f64::INFINITY; Stage::ALL.len()];
    let (mut whole, mut step) = (f64::INFINITY, f64::NAN);
    for _ in 0..REPEATS {
        let (mut film, start) = (run.film.clone(), Instant::now());
        take_steps(&mut film, &capsule.timeline, steps, &mut Untimed)?;
        whole = whole.min(cost(start.elapsed().as_secs_f64(), steps, elements));
        step = (film.view().state.time - run.view().state.time) / steps as f64;
        let (mut film, mut clock) = (run.film.clone(), Clock::default());
        take_steps(&mut film, &capsule.timeline, steps, &mut clock)?;
        clock.stop();
        for (least, total) in least.iter_mut().zip(clock.totals) {
            *least = least.min(cost(total.as_secs_f64(), steps, elements));
        }
    }
    // One sample and one frame per sample interval, divided by the steps between.
    let output = output(capsule, run) * step / capsule.timeline.sample_interval;
    let output = 1e9 * output / elements as f64;
    let (whole, rate) = (whole + output, 1.0 / step);
    let mut row: Row = vec![
        ("subdivisions", capsule.subdivisions.into()),
        ("state", name.into()),
        ("time", run.view().state.time.into()),
        ("elements", elements.into()),
    ];
    row.extend(Stage::ALL.iter().zip(least).map(|(stage, cost)| (stage.name(), cost.into())));
    row.extend([
        ("output", output.into()),
        ("whole", whole.into()),
        ("steps_per_second", rate.into()),
        ("wall_per_second", (1e-9 * whole * elements as f64 * rate).into()),
    ]);
    Ok(row)
}

/// The stopwatch of the bench: total wall time of each stage of a step.
#[derive(Default)]
struct Clock {
    totals: [Duration; Stage::ALL.len()],
    running: Option<(Stage, Instant)>,
}

impl Clock {
    /// Ends the running stage; none follows.
    fn stop(&mut self) {
        if let Some((stage, since)) = self.running.take() {
            self.totals[stage as usize] += since.elapsed();
        }
    }
}

impl Stopwatch for Clock {
    fn begins(&mut self, stage: Stage) {
        self.stop();
        self.running = Some((stage, Instant::now()));
    }
}

/// Takes a number of steps along a timeline, with the same interval ends as a run.
fn take_steps(
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
        let arrived = film
            .advance_timed(to, &phase, &mut steps, stopwatch)
            .map_err(|failure| Error::JobsFailed(stopped(&failure)))?;
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
fn output(capsule: &Capsule, run: &FilmRun) -> f64 {
    let time = run.view().state.time;
    let phase = capsule.timeline.phase(time, time + capsule.timeline.sample_interval);
    let mut tracked = Vec::new();
    let times = (0..REPEATS).map(|_| {
        let start = Instant::now();
        let sample = run.sample(&phase);
        tracked.clear();
        run.follow(&mut tracked);
        let frame = run.frame();
        let seconds = start.elapsed().as_secs_f64();
        std::hint::black_box((sample, &tracked, frame));
        seconds
    });
    times.fold(f64::INFINITY, f64::min)
}
