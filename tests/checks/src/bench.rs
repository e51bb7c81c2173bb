//! Speed of billow on this machine: `billow-checks bench`.
//!
//! ```text
//! time per zone cycle = wall time / (steps × elements)        ns
//! ```
//!
//! The film is the paper's capsule from `scenes/capsule.json`. It runs from the stowed shape as in `billow solve`. From
//! three states of the motion the same steps are repeated, alternately with a clock in every stage and without. The time
//! of a stage is its minimum over the repeats, the whole is the minimum without clocks: other load only adds time. A
//! second table has the same as multiples of the floor of the membrane pass (`floor`).

use std::io::Write;
use std::path::Path;
use std::time::{Duration, Instant};

use billow_solver::models::film::FilmRun;
use billow_solver::models::run::{Model, Observer, Progress, Run};
use billow_solver::output::outcome::Stop;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::platform::stopwatch::{Stage, Stopwatch, Untimed};
use billow_solver::scene::timeline::Timeline;
use billow_study::cli::instruction_set;
use billow_study::input::value::Value;
use billow_study::platform::error::{Error, Result};
use billow_study::platform::files::{Disk, Files};
use billow_study::platform::{memory, provenance};
use billow_study::print::{Format, output_error, print_rows};
use billow_study::scene::file::SceneFile;

use crate::cases::rig::stopped;
use crate::output::Options;

mod floor;

/// The shipped scene.
const SCENE: &str = include_str!("../../../scenes/capsule.json");
/// End time of the scene: later than every timed run, so that inflow lasts through the run of 1.5 s.
const END_TIME: &str = "solver.end_time=\"1.6 s\"";
/// Time of the state `rising`, s.
const RISING: f64 = 0.03;
/// Number of times that the steps of a state are repeated.
const REPEATS: u32 = 3;
/// Steps that are timed: whole blocks of 128 steps of the tunnelling monitor, fewer on a large mesh.
const STEPS: [u64; 2] = [512, 256];
/// Elements above which a mesh is large. Chosen.
const LARGE: usize = 20_000;
/// Time that these steps cannot take, s.
const MAX_TIME: f64 = 100.0;

/// A row: names and values.
type Row = Vec<(&'static str, Value)>;

/// Arguments of `billow-checks bench`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Mesh subdivisions n, comma-separated.
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "5,8,16",
        value_parser = clap::value_parser!(u32).range(1..=64))]
    subdivisions: Vec<u32>,
    /// Simulated time of the runs, s [default: 0.3 up to n 8, 0.1 above].
    #[arg(long, value_name = "SECONDS")]
    end_time: Option<f64>,
    /// Override a key of scenes/capsule.json, as in --set solver.integrator=hybrid; can be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    options: Options,
}

/// Runs `billow-checks bench`. A signal ends it without figures.
pub fn run(args: &Args, out: &mut dyn Write) -> Result<()> {
    let set = instruction_set::selected()?;
    let (mut stages, mut multiples, mut runs) = (Vec::new(), Vec::new(), Vec::new());
    let arithmetic = floor::arithmetic(set);
    for n in args.subdivisions.iter().copied() {
        let end = args.end_time.unwrap_or(if n <= 8 { 0.3 } else { 0.1 });
        args.options.note(&format!("n {n}, {end} s"));
        let mut capsule = Capsule::new(n, &args.set, set)?;
        let streaming = floor::streaming(capsule.film.elements());
        for (state, time) in [("stowed", 0.0), ("rising", RISING), ("end", end)] {
            if time <= end {
                capsule.run_to(time)?;
                let costs = capsule.stages()?;
                let at =
                    [("subdivisions", n.into()), ("state", state.into()), ("time", time.into())];
                let row = |factor: f64| -> Row {
                    let costs = costs.iter().map(|(name, cost)| (*name, (factor * cost).into()));
                    at.iter().cloned().chain(costs).collect()
                };
                stages.push(row(1.0));
                let mut multiple = row(1.0 / arithmetic.unwrap_or(0.0).max(streaming));
                multiple
                    .extend([("arithmetic", arithmetic.into()), ("streaming", streaming.into())]);
                multiples.push(multiple);
            }
        }
        runs.push(capsule.row());
    }
    for rows in [stages, multiples, runs] {
        print(&rows, args.options.format(), out)?;
    }
    Ok(())
}

/// Prints the rows of a part.
fn print(rows: &[Row], format: Format, out: &mut dyn Write) -> Result<()> {
    let columns: Vec<&str> = rows.iter().take(1).flatten().map(|(name, _)| *name).collect();
    let cells = |row: &Row| row.iter().map(|(_, value)| value.clone()).collect();
    print_rows(&columns, &rows.iter().map(cells).collect::<Vec<_>>(), format, out)?;
    writeln!(out).map_err(output_error)
}

/// The running capsule of a mesh, with the cost so far.
struct Capsule {
    /// Elements along each edge of the pattern, n.
    subdivisions: u32,
    timeline: Timeline,
    film: FilmRun,
    run: Run,
    /// Wall time so far, s.
    wall: f64,
    /// The part of it that this thread ran on a core, s.
    on_core: Option<f64>,
}

/// Ends a run at a sample.
struct Until(f64);

impl Observer for Until {
    fn sample(&mut self, progress: Progress) -> bool {
        progress.time < self.0
    }
}

impl Capsule {
    /// The capsule on this mesh with these overrides of its scene, at time 0.
    fn new(subdivisions: u32, given: &[String], set: InstructionSet) -> Result<Self> {
        let mut sets = vec![END_TIME.to_owned(), format!("design.subdivisions={subdivisions}")];
        sets.extend_from_slice(given);
        let scene = SceneFile::from_text(SCENE, Path::new("scenes/capsule.json"), &sets, set)?;
        let timeline = Timeline::of_film(&scene.film);
        let film = FilmRun::of(&scene.film, scene.rings)
            .map_err(|error| Error::JobsFailed(format!("n {subdivisions}: {error}")))?;
        Ok(Self {
            subdivisions,
            timeline,
            film,
            run: Run::default(),
            wall: 0.0,
            on_core: Some(0.0),
        })
    }

    /// Runs to a time of a sample, s.
    fn run_to(&mut self, time: f64) -> Result<()> {
        if time <= 0.0 {
            return Ok(());
        }
        // Samples are multiples of the interval; half an interval less avoids rounding errors.
        let until = &mut Until(time - 0.5 * self.timeline.sample_interval);
        let (start, core) = (Instant::now(), core_seconds());
        let end = self.run.advance(&mut self.film, &self.timeline, u64::MAX, until);
        self.wall += start.elapsed().as_secs_f64();
        let more = core_seconds().zip(core).map(|(now, then)| now - then);
        self.on_core = self.on_core.zip(more).map(|(before, more)| before + more);
        match end {
            Some(Stop::Failed(failure)) => Err(Error::JobsFailed(stopped(&failure))),
            _ => Ok(()),
        }
    }

    /// Time per zone cycle of a number of steps that took this wall time (s), ns.
    fn cost(&self, seconds: f64, steps: u64) -> f64 {
        1e9 * seconds / (steps as f64 * self.film.elements() as f64)
    }

    /// The cost so far. The audit is part of it: a fast run must also be a sound one.
    fn row(&self) -> Row {
        let audit = self.run.clone().finish(&self.film, &self.timeline, Stop::Cancelled).audit;
        let (steps, time) = (self.film.steps(), self.film.view().state.time);
        vec![
            ("subdivisions", self.subdivisions.into()),
            ("time", time.into()),
            ("elements", self.film.elements().into()),
            ("steps", steps.into()),
            ("wall_seconds", self.wall.into()),
            ("core_seconds", self.on_core.into()),
            ("wall_per_second", (self.wall / time).into()),
            ("time_per_zone_cycle", self.cost(self.wall, steps).into()),
            ("ledger_residual", audit.ledger_residual.into()),
            ("passages", audit.passages.into()),
            ("peak_memory", memory::peak_resident().into()),
            ("instruction_set", self.film.film.view().system.instruction_set.name().into()),
            ("commit", provenance::COMMIT.into()),
        ]
    }

    /// The cost of each stage of a step from the present state, and of a whole step, ns an element.
    fn stages(&self) -> Result<Vec<(&'static str, f64)>> {
        let steps = STEPS[usize::from(self.film.elements() > LARGE)];
        let mut least = [f64::INFINITY; Stage::ALL.len()];
        let mut whole = f64::INFINITY;
        for _ in 0..REPEATS {
            let start = Instant::now();
            self.take_steps(steps, &mut Untimed)?;
            whole = whole.min(self.cost(start.elapsed().as_secs_f64(), steps));
            let mut clock = Clock::default();
            self.take_steps(steps, &mut clock)?;
            clock.stop();
            for (least, total) in least.iter_mut().zip(clock.totals) {
                *least = least.min(self.cost(total.as_secs_f64(), steps));
            }
        }
        let stages = Stage::ALL.iter().map(|stage| (stage.name(), least[*stage as usize]));
        Ok(stages.chain([("whole", whole)]).collect())
    }

    /// Takes a number of steps with a copy of the film.
    fn take_steps(&self, mut steps: u64, stopwatch: &mut dyn Stopwatch) -> Result<()> {
        let mut film = self.film.film.clone();
        let now = film.view().state.time;
        let phase = self.timeline.phase(now, now + self.timeline.sample_interval);
        film.advance_timed(now + MAX_TIME, &phase, &mut steps, stopwatch)
            .map_err(|failure| Error::JobsFailed(stopped(&failure)))?;
        Ok(())
    }
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

/// Time this thread has run on a core so far, s, without other processes.
fn core_seconds() -> Option<f64> {
    let bytes = Disk.read(Path::new("/proc/thread-self/schedstat")).ok()?;
    let text = String::from_utf8_lossy(&bytes);
    let nanoseconds: u64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds as f64)
}
