//! Jobs per hour: a study of 64 film jobs, run as by `billow run`, with histories, journal and table on
//! disk. Static states of its two designs are computed once.

use std::num::NonZero;
use std::time::Instant;

use billow_solver::platform::simd::InstructionSet;

use super::{Effort, INTERRUPTED, Line};
use crate::input::value::Value;
use crate::job::Status;
use crate::job::executor::Solver;
use crate::job::limits::JobLimits;
use crate::job::references::References;
use crate::platform::error::{Error, Result};
use crate::platform::files::scratch::Scratch;
use crate::platform::files::{Disk, disk_error};
use crate::platform::stop::Stop;
use crate::run::event::Silent;
use crate::run::runner::{self, CHECKPOINT_INTERVAL, Run};
use crate::store::results::Results;
use crate::store::table::Table;
use crate::study::plan;
use crate::study::{PlanSize, Study};

/// The study.
const STUDY: &str = include_str!("study.json");
/// Overrides that make it short, for `--quick`.
const QUICK: [&str; 2] = ["design.subdivisions=2", "solver.end_time=\"12 ms\""];
/// Numbers of threads to run it on.
pub const THREADS: [u32; 2] = [1, 2];

/// Cost of the study.
#[derive(Debug, Clone, PartialEq)]
pub struct JobsRow {
    /// Number of threads; each runs one job at a time.
    pub threads: u32,
    /// Number of jobs run.
    pub jobs: usize,
    /// Number of jobs with status `done`.
    pub done: usize,
    /// Elements along each edge of the pattern, n.
    pub subdivisions: u32,
    /// Simulated time of a job, s.
    pub end_time: f64,
    /// Wall time, s.
    pub wall_seconds: f64,
}

impl JobsRow {
    /// Jobs per hour.
    pub fn per_hour(&self) -> f64 {
        3600.0 * self.jobs as f64 / self.wall_seconds
    }

    /// As a row of the report.
    pub fn line(&self) -> Line {
        let count = |count: usize| Value::Integer(i64::try_from(count).unwrap_or(i64::MAX));
        vec![
            ("threads", Value::Integer(self.threads.into())),
            ("jobs", count(self.jobs)),
            ("done", count(self.done)),
            ("subdivisions", Value::Integer(self.subdivisions.into())),
            ("end_time", Value::Number(self.end_time)),
            ("wall_seconds", Value::Number(self.wall_seconds)),
            ("jobs_per_hour", Value::Number(self.per_hour())),
        ]
    }
}

/// Runs the study on a number of threads, in a temporary folder.
///
/// # Errors
/// A disk error; a signal.
pub fn measure(
    threads: u32,
    instruction_set: InstructionSet,
    effort: Effort,
    stop: &Stop,
) -> Result<JobsRow> {
    let sets = QUICK.iter().filter(|_| effort == Effort::Quick).map(ToString::to_string);
    let sets: Vec<String> = sets.collect();
    let study =
        Study::from_text(STUDY, "study/src/bench/study.json", "bench", &sets, PlanSize::default())?;
    let folder =
        Scratch::new("bench").map_err(|error| disk_error(&std::env::temp_dir(), &error))?;
    let start = Instant::now();
    let summary = runner::run(
        &Run {
            name: &study.name,
            study: &study.resolved(),
            planner: &|finished| plan::next_jobs(&study, finished),
            result_limits: study.result_limits(),
            table: &|points, records| Table::of_study(&study, points, records),
            executor: &Solver { instruction_set, references: References::default() },
            results: Results::new(&Disk, &folder.path().join("results")),
            threads: NonZero::new(threads as usize),
            limits: JobLimits::default(),
            checkpoint_interval: CHECKPOINT_INTERVAL,
            stop: stop.clone(),
            rerun: None,
        },
        &mut Silent,
    )?;
    let wall_seconds = start.elapsed().as_secs_f64();
    if let Some(signal) = summary.signal {
        return Err(Error::Interrupted { signal, next: INTERRUPTED.to_owned() });
    }
    let scene = study.points().first().map(|point| &point.scene);
    Ok(JobsRow {
        threads,
        jobs: summary.ran,
        done: summary.counts.of(Status::Done),
        subdivisions: scene.map_or(0, |scene| scene.design.subdivisions),
        end_time: scene.map_or(0.0, |scene| scene.solver.end_time),
        wall_seconds,
    })
}
