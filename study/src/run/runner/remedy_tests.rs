//! Runs failed jobs again with remedies: which runs are made, what the rows show, and that nothing is lost.

#![expect(clippy::disallowed_methods, reason = "tests read and write files directly")]

use std::fs;
use std::io;
use std::path::Path;
use std::sync::Mutex;

use billow_solver::output::outcome::{AuditKind, Failure, Stop as End};
use billow_solver::scene::{ModelKind, Scene, Stepping};

use super::*;
use crate::job::control::Task;
use crate::job::executor::Outcome;
use crate::job::limits::Limit;
use crate::job::remedy;
use crate::job::row::ColumnId;
use crate::job::{self, Job, Status};
use crate::platform::files::failing::FailingFiles;
use crate::platform::files::{Disk, Files};
use crate::run::event::Silent;
use crate::run::fixture;
use crate::store::journal::{self, Writer};
use crate::store::remedied;
use crate::store::table::Table;

/// CFL numbers of the planned jobs; the last two are the same scene at half the step of others.
const PLANNED: [f64; 4] = [0.8, 0.1, 0.9, 0.4];

fn folder() -> tempfile::TempDir {
    let memory = Path::new("/dev/shm");
    if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() }.unwrap()
}

/// A film job with this CFL number; its id is that of its scene.
fn job(cfl: f64) -> Job {
    let mut scene = fixture::job(1).scene;
    scene.solver.model = ModelKind::Film;
    scene.solver.stepping = Stepping::Stable(cfl);
    Job { id: JobId::of(&scene), parameters: Vec::new(), scene }
}

fn cfl_of(scene: &Scene) -> f64 {
    let Stepping::Stable(cfl) = scene.solver.stepping else { panic!("film has a CFL number") };
    cfl
}

fn points() -> Vec<Point> {
    let point = |cfl| Point { job: job(cfl), ..fixture::generation(1).points[0].clone() };
    PLANNED.map(point).to_vec()
}

/// A run that ended with this audit.
fn ended(audit: AuditKind) -> Outcome {
    let mut deployment = fixture::deployment(1, 7);
    deployment.stop = End::Failed(Failure::new(audit, 0.25, "here"));
    Outcome::Ran { deployment: Box::new(deployment), seconds: 0.5, steps: 100 }
}

/// A run drifts above this CFL number.
fn drifts_above(limit: f64) -> impl Fn(&Scene) -> Outcome {
    move |scene| {
        if cfl_of(scene) > limit { ended(AuditKind::EnergyLedger) } else { fixture::ran(1) }
    }
}

/// Computes scenes by a script, and keeps which.
struct Scripted<S> {
    script: S,
    executed: Mutex<Vec<f64>>,
}

impl<S: Fn(&Scene) -> Outcome + Sync> Executor for Scripted<S> {
    fn execute(&self, tasks: &[Task<'_>]) -> Vec<Outcome> {
        let run = |task: &Task<'_>| {
            self.executed.lock().unwrap().push(cfl_of(&task.job.scene));
            (self.script)(&task.job.scene)
        };
        tasks.iter().map(run).collect()
    }
}

/// Runs the study, or some of its jobs with remedies. Returns the CFL numbers that ran, ascending.
fn run_on<S: Fn(&Scene) -> Outcome + Sync>(
    files: &dyn Files,
    root: &Path,
    remedy: Option<&[f64]>,
    script: S,
) -> (Result<Summary>, Vec<f64>) {
    let ids: Option<BTreeSet<JobId>> =
        remedy.map(|planned| planned.iter().map(|cfl| job(*cfl).id).collect());
    let executor = Scripted { script, executed: Mutex::new(Vec::new()) };
    let study = Run {
        name: "test",
        study: &serde_json::json!({}).into(),
        planner: &|finished| {
            finished.is_empty().then(|| Generation { number: 0, points: points() })
        },
        result_limits: &[],
        label: &job::label,
        table: &|points, records| Table::build(points, records, &|_| String::new()),
        executor: &executor,
        results: Results::new(files, root),
        threads: NonZero::new(1),
        limits: JobLimits::default(),
        checkpoint_interval: CHECKPOINT_INTERVAL,
        stop: Stop::new(),
        rerun: ids.as_ref().map(|jobs| Rerun { jobs, remedy: true }),
        selection: Selection::All,
        shared: None,
    };
    let ended = run(&study, &mut Silent);
    let mut executed = executor.executed.into_inner().unwrap();
    executed.sort_by(f64::total_cmp);
    (ended, executed)
}

/// The cells of a column, as text.
fn column(root: &Path, id: ColumnId) -> Vec<String> {
    let table = Results::new(&Disk, root).read_table().unwrap();
    (0..table.rows()).map(|row| table.value(id, row).unwrap().to_string()).collect()
}

fn statuses(root: &Path) -> Vec<String> {
    column(root, ColumnId::Status)
}

#[test]
fn remedies_follow_each_other_until_one_has_a_result_and_the_failed_records_stay() {
    let folder = folder();
    let root = folder.path();
    let (_, executed) = run_on(&Disk, root, None, drifts_above(0.25));
    assert_eq!(executed, [0.1, 0.4, 0.8, 0.9]);
    assert_eq!(statuses(root), ["energy_drift", "done", "energy_drift", "energy_drift"]);
    let before = Results::new(&Disk, root).journal().unwrap();

    let (summary, executed) = run_on(&Disk, root, Some(&PLANNED), drifts_above(0.25));
    // 0.8 needs the run of 0.4, which the study has, and 0.2, which 0.4 needs too.
    assert_eq!(executed, [0.2, 0.225, 0.45]);
    let summary = summary.unwrap();
    assert_eq!((summary.remedied, summary.ran, summary.counts.remedied), (3, 3, 3));
    assert_eq!(statuses(root), ["done"; 4]);
    let expected =
        ["solver.cfl 0.8 -> 0.2", "null", "solver.cfl 0.9 -> 0.225", "solver.cfl 0.4 -> 0.2"];
    assert_eq!(column(root, ColumnId::Remedy), expected);
    let failed = [
        "solver.cfl 0.8 -> 0.4: energy_drift",
        "null",
        "solver.cfl 0.9 -> 0.45: energy_drift",
        "null",
    ];
    assert_eq!(column(root, ColumnId::FailedRemedies), failed);
    let journal = Results::new(&Disk, root).journal().unwrap();
    for (id, record) in &before.records {
        assert_eq!(journal.records[id], *record);
    }
    let table = Results::new(&Disk, root).read_table().unwrap();
    let ids = [0.2, 0.1, 0.225, 0.2].map(|cfl| job(cfl).id.to_string());
    let jobs = table.column("job").unwrap().cells.iter();
    assert_eq!(jobs.map(ToString::to_string).collect::<Vec<_>>(), ids);

    // Nothing remains to do, with and without remedies.
    for remedy in [None, Some(&PLANNED[..])] {
        let bytes = fs::read(root.join("summary.parquet")).unwrap();
        let (_, executed) = run_on(&Disk, root, remedy, |_| panic!("no job runs"));
        assert!(executed.is_empty(), "{executed:?}");
        assert_eq!(fs::read(root.join("summary.parquet")).unwrap(), bytes);
    }
}

#[test]
fn where_no_remedy_helps_the_row_stays_failed_and_names_what_was_tried() {
    let folder = folder();
    run_on(&Disk, folder.path(), None, drifts_above(0.05)).0.unwrap();
    let (summary, executed) = run_on(&Disk, folder.path(), Some(&[0.8]), drifts_above(0.05));
    // 0.4 and 0.1 are jobs of the study.
    assert_eq!(executed, [0.2]);
    assert_eq!(summary.unwrap().remedied, 0);
    assert_eq!(statuses(folder.path()), ["energy_drift"; 4]);
    let expected = "solver.cfl 0.8 -> 0.4: energy_drift; solver.cfl 0.8 -> 0.2: energy_drift; \
                    solver.cfl 0.8 -> 0.1: energy_drift";
    assert_eq!(column(folder.path(), ColumnId::FailedRemedies)[0], expected);
    // The bound is kept by a second command.
    let (_, executed) = run_on(&Disk, folder.path(), Some(&[0.8]), drifts_above(0.05));
    assert!(executed.is_empty(), "{executed:?}");
    // A remedy of another kind of failure: film that is too soft has none.
    let soft = |scene: &Scene| {
        ended(if cfl_of(scene) > 0.85 { AuditKind::EnergyLedger } else { AuditKind::Stretch })
    };
    let (_, executed) = run_on(&Disk, folder.path(), Some(&[0.9]), soft);
    assert_eq!(executed, [0.45]);
    let tried = &column(folder.path(), ColumnId::FailedRemedies)[2];
    assert_eq!(tried, "solver.cfl 0.9 -> 0.45: overstretched");
}

#[test]
fn a_stopped_or_limited_remedy_is_resumed_by_the_same_command() {
    let folder = folder();
    let root = folder.path();
    run_on(&Disk, root, None, drifts_above(0.5)).0.unwrap();
    let (table, journal) =
        (fs::read(root.join("summary.parquet")).unwrap(), Results::new(&Disk, root).journal());
    let (_, executed) = run_on(&Disk, root, Some(&[0.9]), |_| Outcome::Cancelled);
    assert_eq!(executed, [0.45]);
    assert_eq!(fs::read(root.join("summary.parquet")).unwrap(), table);
    let now = Results::new(&Disk, root).journal().unwrap();
    assert_eq!((now.records, now.remedies), (journal.unwrap().records, BTreeMap::new()));

    let limited = |_: &Scene| Outcome::Limited(Limit::WallTime(1.0));
    let (summary, executed) = run_on(&Disk, root, Some(&[0.9]), limited);
    assert_eq!((executed, summary.unwrap().remedied), (vec![0.45], 0));
    assert_eq!(statuses(root)[2], "energy_drift");
    let tried = &column(root, ColumnId::FailedRemedies)[2];
    assert_eq!(tried, "solver.cfl 0.9 -> 0.45: timeout");
    let (_, executed) = run_on(&Disk, root, None, limited);
    assert!(executed.is_empty(), "a plain run has nothing to do");

    let (summary, executed) = run_on(&Disk, root, Some(&[0.9]), drifts_above(0.5));
    assert_eq!((executed, summary.unwrap().remedied), (vec![0.45], 1));
    assert_eq!(column(root, ColumnId::Remedy)[2], "solver.cfl 0.9 -> 0.45");
    assert_eq!(column(root, ColumnId::FailedRemedies)[2], "null");
}

#[test]
fn a_failed_write_loses_nothing_and_the_same_command_ends_alike() {
    let folder = folder();
    let whole = folder.path().join("whole");
    for remedy in [None, Some(&PLANNED[..])] {
        run_on(&Disk, &whole, remedy, drifts_above(0.25)).0.unwrap();
    }
    let table = fs::read(whole.join("summary.parquet")).unwrap();
    for nth in 1.. {
        let root = folder.path().join(nth.to_string());
        run_on(&Disk, &root, None, drifts_above(0.25)).0.unwrap();
        let failing = FailingFiles::new(nth, io::ErrorKind::StorageFull);
        let (ended, _) = run_on(&failing, &root, Some(&PLANNED), drifts_above(0.25));
        let journal = Results::new(&Disk, &root).journal().unwrap();
        assert!(PLANNED.iter().all(|cfl| journal.records.contains_key(&job(*cfl).id)), "{nth}");
        if ended.is_ok() {
            assert!(nth > 12, "only {nth} changing operations");
            break;
        }
        run_on(&Disk, &root, None, drifts_above(0.25)).0.unwrap();
        run_on(&Disk, &root, Some(&PLANNED), drifts_above(0.25)).0.unwrap();
        assert_eq!(fs::read(root.join("summary.parquet")).unwrap(), table, "operation {nth}");
    }
}

#[test]
fn a_lost_result_of_a_remedy_runs_again_with_a_plain_run() {
    let folder = folder();
    let root = folder.path();
    run_on(&Disk, root, None, drifts_above(0.5)).0.unwrap();
    run_on(&Disk, root, Some(&[0.9]), drifts_above(0.5)).0.unwrap();
    let table = fs::read(root.join("summary.parquet")).unwrap();
    let (results, by) = (Results::new(&Disk, root), job(0.45).id);
    for lose in [0, 1] {
        if lose == 0 {
            fs::remove_file(results.job_path(&by)).unwrap();
        } else {
            Writer::new(&Disk, results.journal_path())
                .invalidate(std::slice::from_ref(&by))
                .unwrap();
        }
        let (summary, executed) = run_on(&Disk, root, None, drifts_above(0.5));
        let summary = summary.unwrap();
        assert_eq!((executed, summary.same), (vec![0.45], 1));
        assert_eq!(fs::read(root.join("summary.parquet")).unwrap(), table);
    }
}

#[test]
fn a_link_of_another_scene_changes_nothing_and_a_run_without_its_record_is_pending() {
    let planned = points();
    let mut shown = planned.clone();
    let id = |cfl| job(cfl).id;
    let link = |by, cfl| journal::RemedyLink {
        planned: id(0.8),
        by,
        changes: vec![remedy::Change::Cfl(cfl)],
    };
    let apply = |points: &mut [Point], link| {
        let mut links = remedied::Links::new();
        journal::add_link(&mut links, link);
        remedied::apply(points, &links, &|_| None);
    };
    apply(&mut shown, link(id(0.3), 0.4));
    let remedied = shown[0].remedied.clone().unwrap();
    assert_eq!((remedied.shown, remedied.runs.len()), (None, 0));
    assert_eq!(shown[0].job, planned[0].job);

    apply(&mut shown, link(id(0.4), 0.4));
    assert_eq!((&shown[0].job, shown[0].planned_id()), (&job(0.4), &id(0.8)));
    assert_eq!(shown[0].jobs().cloned().collect::<Vec<_>>(), [id(0.8), id(0.4)]);
    assert_eq!(journal::cells_of(&shown[0], &BTreeMap::new()), None, "pending");
    // Other points of the study keep their jobs; a copy of the list gets the same runs.
    assert_eq!(shown[1..], planned[1..]);
    let mut copied = planned;
    remedied::copy(&mut copied, &shown);
    assert_eq!(copied, shown);
}

#[test]
fn a_failed_job_whose_settings_have_no_remedy_is_left_alone() {
    let folder = folder();
    let softened = |_: &Scene| ended(AuditKind::Stretch);
    run_on(&Disk, folder.path(), None, softened).0.unwrap();
    let (summary, executed) = run_on(&Disk, folder.path(), Some(&PLANNED), softened);
    assert!(executed.is_empty(), "{executed:?}");
    let failed = Status::Failed(AuditKind::Stretch.failure_kind());
    assert_eq!(summary.unwrap().counts.of(failed), 4);
}
