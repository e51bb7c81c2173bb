//! The capsule of the bench: the paper's capsule from `scenes/capsule.json`, for up to 1.5 s.
//!
//! It runs from the stowed shape as in `billow solve`. While it runs, the bench keeps states, from which stages are timed,
//! and the cost so far.

use std::path::Path;
use std::time::Instant;

use billow_solver::models;
use billow_solver::models::film::FilmRun;
use billow_solver::models::run::{Model, Observer, Run};
use billow_solver::output::outcome::Stop;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::timeline::Timeline;
use billow_study::platform::error::{Error, Result};
use billow_study::platform::files::{Disk, Files};
use billow_study::platform::memory;
use billow_study::scene::file::SceneFile;

use super::{Row, cost};
use crate::cases::rig::stopped;

/// The shipped scene.
const SCENE: &str = include_str!("../../../../scenes/capsule.json");
/// End time of the scene: later than every timed run, so that inflow lasts through the run of 1.5 s.
const END_TIME: &str = "solver.end_time=\"1.6 s\"";

/// The capsule of one mesh.
pub(super) struct Capsule {
    /// Elements along each edge of the pattern, n.
    pub(super) subdivisions: u32,
    scene: SceneFile,
    pub(super) timeline: Timeline,
}

impl Capsule {
    /// The capsule on this mesh with these overrides of its scene.
    pub(super) fn new(
        subdivisions: u32,
        given: &[String],
        instruction_set: InstructionSet,
    ) -> Result<Self> {
        let mut sets = vec![END_TIME.to_owned(), format!("design.subdivisions={subdivisions}")];
        sets.extend_from_slice(given);
        let scene =
            SceneFile::from_text(SCENE, Path::new("scenes/capsule.json"), &sets, instruction_set)?;
        let timeline = Timeline::of_film(&scene.film);
        Ok(Self { subdivisions, scene, timeline })
    }
}

/// A running capsule, with the cost so far.
pub(super) struct Progress<'a> {
    capsule: &'a Capsule,
    pub(super) film: FilmRun,
    run: Run,
    /// Wall time so far, s.
    pub(super) wall: f64,
    on_core: Option<f64>,
}

/// Ends a run at a sample.
struct Until(f64);

impl Observer for Until {
    fn sample(&mut self, progress: models::run::Progress) -> bool {
        progress.time < self.0
    }
}

impl<'a> Progress<'a> {
    /// At time 0.
    pub(super) fn of(capsule: &'a Capsule) -> Result<Self> {
        let failed = |error| Error::JobsFailed(format!("n {}: {error}", capsule.subdivisions));
        let scene = &capsule.scene;
        let film = FilmRun::of(&scene.film, scene.rings.clone()).map_err(failed)?;
        Ok(Self { capsule, film, run: Run::default(), wall: 0.0, on_core: Some(0.0) })
    }

    /// Runs to a time of a sample, s.
    pub(super) fn run_to(&mut self, time: f64) -> Result<()> {
        // Samples are multiples of the interval; half an interval less avoids rounding errors.
        let timeline = &self.capsule.timeline;
        let until = &mut Until(time - 0.5 * timeline.sample_interval);
        let (start, core) = (Instant::now(), core_seconds());
        let end = self.run.advance(&mut self.film, timeline, u64::MAX, until);
        self.wall += start.elapsed().as_secs_f64();
        let more = core_seconds().zip(core).map(|(now, then)| now - then);
        self.on_core = self.on_core.zip(more).map(|(before, more)| before + more);
        match end {
            Some(Stop::Failed(failure)) => Err(Error::JobsFailed(stopped(&failure))),
            _ => Ok(()),
        }
    }

    /// The cost from the start to this time, s. The audit is part of it: a fast run must also be a sound one.
    pub(super) fn row(&self, time: f64) -> Row {
        let timeline = &self.capsule.timeline;
        let audit = self.run.clone().finish(&self.film, timeline, Stop::Cancelled).audit;
        let (elements, steps) = (self.film.elements(), self.film.steps());
        vec![
            ("subdivisions", self.capsule.subdivisions.into()),
            ("end_time", time.into()),
            ("elements", elements.into()),
            ("steps", steps.into()),
            ("wall_seconds", self.wall.into()),
            ("core_seconds", self.on_core.into()),
            ("wall_per_second", (self.wall / time).into()),
            ("ns_per_element_step", cost(self.wall, steps, elements).into()),
            ("ledger_residual", audit.ledger_residual.into()),
            ("passages", audit.passages.into()),
            ("peak_memory", memory::peak_resident().into()),
        ]
    }
}

/// Time this thread has run on a core so far, s, without other processes.
fn core_seconds() -> Option<f64> {
    let bytes = Disk.read(Path::new("/proc/thread-self/schedstat")).ok()?;
    let text = String::from_utf8_lossy(&bytes);
    let nanoseconds: u64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds as f64)
}
