//! Jobs and deployments for tests: valid scenes, invented series.

use std::collections::BTreeMap;
use std::num::NonZero;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use billow_solver::mechanics::material::Regime;
use billow_solver::models::run::Progress;
use billow_solver::output::audit::Audit;
use billow_solver::output::frames::{Frame, Frames};
use billow_solver::output::history::{COLUMNS, History};
use billow_solver::output::measures::{Measures, Verdict};
use billow_solver::output::outcome::{Deployment, Stop as End};
use billow_solver::scene::{Scene, paper};

use crate::accuracy::AssumedRanges;
use crate::input::json::Json;
use crate::input::value::Value;
use crate::job::control::{Order, Task};
use crate::job::executor::{Executor, Outcome};
use crate::job::limits::JobLimits;
use crate::job::point::{Infeasible, Point, Searched};
use crate::job::{self, Job, JobId};
use crate::platform::files::Disk;
use crate::platform::stop::Stop;
use crate::run::runner::{CHECKPOINT_INTERVAL, Run};
use crate::run::selection::Selection;
use crate::store::results::Results;
use crate::store::table::Table;
use crate::study::finished::{FinishedRow, Judging};
use crate::study::plan::Generation;

/// A job whose seed is `number`.
pub fn job(number: u32) -> Job {
    let id = JobId::from_digits(&crate::platform::hash::bytes_hash(&number.to_le_bytes())[..32]);
    Job {
        id: id.unwrap(),
        parameters: vec![
            ("N".to_owned(), Value::Integer(6)),
            ("mass_flow_rate".to_owned(), Value::Number(0.001 * f64::from(number))),
        ]
        .into(),
        scene: scene(number).into(),
    }
}

fn scene(number: u32) -> Scene {
    Scene { seed: u64::from(number), ..paper::empty_capsule(4, 1.0) }
}

/// A deployment with `samples` samples. Its series depend on `number` alone.
pub fn deployment(number: u32, samples: usize) -> Deployment {
    let mut history = History::new();
    for sample in 0..samples {
        let mut values = [0.0; COLUMNS.len()];
        for (column, value) in values.iter_mut().enumerate() {
            *value =
                2.0 + libm::sin(f64::from(number) + 0.1 * column as f64 + 0.01 * sample as f64);
        }
        values[0] = 0.001 * sample as f64;
        for (column, value) in COLUMNS.iter().zip(&mut values) {
            // What a capsule has not is read back as 0.
            *value = if history.has(column.name) { *value } else { 0.0 };
        }
        history.push(&values);
    }
    let last = |name: &str| history.column(name).last().copied();
    let measures = Measures {
        verdict: Some(Verdict::Deployed),
        final_z_rim: last("z_rim"),
        final_volume: last("volume"),
        final_pressure: last("pressure"),
        final_temperature: last("temperature"),
        t_50_z_rim: Some(0.1 + 0.2),
        ..Measures::default()
    };
    Deployment {
        history,
        tracks: Vec::new(),
        events: Vec::new(),
        frames: None,
        measures,
        audit: Audit { ledger_residual: 1e-12, ..Audit::default() },
        stop: End::Done,
        steps: 100,
        elements: 0,
    }
}

/// Frames of a film of four nodes and two elements. Their positions depend on `number`.
pub fn frames(number: u32, count: u32) -> Frames {
    #[expect(clippy::cast_possible_truncation, reason = "invented values")]
    let position = |frame: u32, node: u32| {
        let angle = f64::from(7 * number + 3 * frame + node);
        [libm::sin(angle), libm::sin(2.0 * angle), -0.0].map(|x| x as f32)
    };
    let all = [Regime::Slack, Regime::Wrinkled, Regime::Taut];
    let frame = |frame: u32| Frame {
        time: 0.1 * f64::from(frame),
        positions: (0..4).map(|node| position(frame, node)).collect(),
        regimes: (0..2).map(|element| all[((frame + element) % 3) as usize]).collect(),
        velocities: (0..4).map(|node| position(frame, node + 1)).collect(),
        stresses: vec![[2e6, 1e6], [0.0, 0.0]],
        gaps: vec![1e-3; 4],
    };
    Frames {
        triangles: vec![[0, 1, 2], [1, 3, 2]],
        storeys: vec![0, 1],
        frames: (0..count).map(frame).collect(),
    }
}

/// A plan of these [`points`].
pub fn generation(jobs: u32) -> Generation {
    Generation { number: 0, points: Arc::new(points(jobs)) }
}

/// Points of `jobs` jobs, of which the third is infeasible.
pub fn points(jobs: u32) -> Vec<Point> {
    (0..jobs)
        .map(|number| Point {
            job: job(number),
            infeasible: (number == 2).then(|| Infeasible {
                reason: "alpha1 would exceed pi/2 - pi/N".to_owned(),
                nearest: Vec::new(),
            }),
            solved: None,
            searched: Searched::No,
            merged: Vec::new(),
        })
        .collect()
}

/// The table of a run of such a plan. The folder holds it as a file.
pub fn table(root: &Path, jobs: u32) -> Table {
    let results = Results::new(&Disk, root);
    let records = results.journal().unwrap().records;
    let table =
        Table::build(&points(jobs), &records, &|_| String::new(), &AssumedRanges::default());
    assert_eq!(results.holds_table(table.clone()).unwrap(), Some(true));
    table
}

/// A folder in memory where the machine has one: the tests check the order of operations.
pub fn folder() -> tempfile::TempDir {
    let memory = Path::new("/dev/shm");
    if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() }.unwrap()
}

/// A run of every job of a plan, on one thread and without limits.
pub fn run<'a>(
    results: Results<'a>,
    planner: &'a dyn Fn(&[FinishedRow]) -> Option<Generation>,
    executor: &'a dyn Executor,
) -> Run<'a> {
    static STUDY: Json = Json::Object(Vec::new());
    static ASSUMED: AssumedRanges = AssumedRanges([[0.003, 0.03], [0.1, 1.0]]);
    Run {
        name: "test",
        study: &STUDY,
        planner,
        judging: Judging { limits: &[], assumed: &ASSUMED, minimised: &[] },
        label: &job::label,
        table: &|points, records| {
            Table::build(points, records, &|_| String::new(), &AssumedRanges::default())
        },
        executor,
        results,
        threads: NonZero::new(1),
        limits: JobLimits::default(),
        checkpoint_interval: CHECKPOINT_INTERVAL,
        stop: Stop::new(),
        rerun: None,
        selection: Selection::All,
        known: BTreeMap::new(),
    }
}

/// An executor without a solver: `script` gives the outcome of a job.
pub struct Scripted<S> {
    /// Outcome of the job with that seed. It may panic.
    pub script: S,
    /// Number of jobs executed so far.
    pub executed: AtomicUsize,
}

impl<S: Fn(u32) -> Outcome + Sync> Scripted<S> {
    /// An executor.
    pub fn new(script: S) -> Self {
        Self { script, executed: AtomicUsize::new(0) }
    }
}

/// The outcome of a job that ran, with seven samples.
pub fn ran(number: u32) -> Outcome {
    Outcome::Ran { deployment: Box::new(deployment(number, 7)), seconds: 0.5, steps: 100 }
}

impl<S: Fn(u32) -> Outcome + Sync> Executor for Scripted<S> {
    fn execute(&self, task: &Task<'_>) -> Outcome {
        self.executed.fetch_add(1, Ordering::SeqCst);
        let progress = Progress { time: 0.5, end_time: 1.0, height: 0.3, pressure: 50.0 };
        task.control.progress(progress);
        if task.control.order() == Order::End {
            return Outcome::Cancelled;
        }
        (self.script)(u32::try_from(task.job.scene.seed).unwrap())
    }
}
