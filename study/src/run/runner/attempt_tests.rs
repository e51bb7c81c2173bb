//! Attempts, checkpoints and quarantine with scripted executors.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::*;
use crate::job::control::{Order, Task};
use crate::job::executor::Outcome;
use crate::job::{Job, Status};
use crate::platform::files::Disk;
use crate::run::fixture::{self, folder, ran};
use crate::store::attempts::Attempts;
use crate::store::stored::other_physics;

const JOBS: u32 = 5;

/// Number of a job of the fixture.
fn number(job: &Job) -> u32 {
    u32::try_from(job.scene.seed).unwrap()
}

/// An executor that is a function of the task. It notes the order of the jobs, and how many run at once.
struct Tasks<F> {
    run: F,
    order: Mutex<Vec<u32>>,
    running: AtomicUsize,
    /// For each job in `order`: jobs that ran when it started, with itself.
    beside: Mutex<Vec<usize>>,
}

impl<F: Fn(&Task<'_>) -> Outcome + Sync> Tasks<F> {
    fn new(run: F) -> Self {
        let (order, beside) = (Mutex::default(), Mutex::default());
        Self { run, order, running: AtomicUsize::new(0), beside }
    }
}

impl<F: Fn(&Task<'_>) -> Outcome + Sync> Executor for Tasks<F> {
    fn execute(&self, task: &Task<'_>) -> Outcome {
        let running = self.running.fetch_add(1, Ordering::SeqCst) + 1;
        self.order.lock().unwrap().push(number(task.job));
        self.beside.lock().unwrap().push(running);
        let outcome = (self.run)(task);
        self.running.fetch_sub(1, Ordering::SeqCst);
        outcome
    }
}

struct Notes(Vec<String>);

impl Reporter for Notes {
    fn event(&mut self, event: &Event) {
        if let Event::Note(text) = event {
            self.0.push(text.clone());
        }
    }
}

/// Runs five points, the third infeasible, on two threads.
fn run_with(
    root: &Path,
    executor: &dyn Executor,
    stop: &Stop,
    interval: Duration,
) -> (Summary, Vec<String>) {
    let planner = |finished: &[FinishedRow]| finished.is_empty().then(|| fixture::generation(JOBS));
    let study = Run {
        threads: NonZero::new(2),
        checkpoint_interval: interval,
        stop: stop.clone(),
        ..fixture::run(Results::new(&Disk, root), &planner, executor)
    };
    let mut notes = Notes(Vec::new());
    let summary = run(&study, &mut notes).unwrap().summary;
    (summary, notes.0)
}

fn run_all(root: &Path, executor: &dyn Executor) -> (Summary, Vec<String>) {
    run_with(root, executor, &Stop::new(), CHECKPOINT_INTERVAL)
}

/// A process dies while these jobs run.
fn die(root: &Path, numbers: &[u32]) {
    let results = Results::new(&Disk, root);
    let ids: Vec<JobId> = numbers.iter().map(|number| fixture::job(*number).id).collect();
    results.files().create_folder(root).unwrap();
    let mut attempts = Attempts::new(&results);
    attempts.start(&ids.iter().collect::<Vec<_>>()).unwrap();
    std::mem::forget(attempts);
}

fn done(task: &Task<'_>) -> Outcome {
    ran(number(task.job))
}

#[test]
fn a_suspect_runs_last_and_alone_and_is_then_no_suspect() {
    let folder = folder();
    die(folder.path(), &[0, 1]);
    let slow = |task: &Task<'_>| {
        std::thread::sleep(Duration::from_millis(20));
        done(task)
    };
    let executor = Tasks::new(slow);
    let (summary, notes) = run_all(folder.path(), &executor);
    assert_eq!(summary.counts.of(Status::Done), 4);
    assert!(
        notes[0].contains("died while these jobs ran") && notes[0].contains("N=6"),
        "{notes:?}"
    );
    let order = executor.order.into_inner().unwrap();
    assert_eq!(order[2..], [0, 1], "suspects last: {order:?}");
    assert_eq!(executor.beside.into_inner().unwrap()[2..], [1, 1], "each alone");
    let journal = Results::new(&Disk, folder.path()).journal().unwrap();
    assert!(journal.deaths.is_empty());
    assert!(other_physics(&[], &journal.records).is_empty());
}

#[test]
fn two_deaths_alone_at_last_put_a_job_in_quarantine_until_it_is_asked_for() {
    let folder = folder();
    die(folder.path(), &[0, 3]);
    // The second process runs nothing but its attempt at job 3.
    let stopped = Stop::new();
    stopped.request(15);
    let nothing = Tasks::new(done);
    run_with(folder.path(), &nothing, &stopped, CHECKPOINT_INTERVAL);
    assert!(nothing.order.lock().unwrap().is_empty());
    die(folder.path(), &[3]);

    let executor = Tasks::new(done);
    let (summary, notes) = run_all(folder.path(), &executor);
    let order = executor.order.into_inner().unwrap();
    assert!(!order.contains(&3) && order.last() == Some(&0), "{order:?}");
    assert_eq!(summary.counts.of(Status::Crashed), 1);
    assert_eq!((summary.counts.of(Status::Done), summary.ran), (3, 3));
    let note = &notes[0];
    assert!(note.contains("two attempts") && note.contains("--again crashed"), "{note}");
    let table = fixture::table(folder.path(), JOBS);
    let cell = |name: &str| table.column(name).unwrap().cells[3].to_string();
    assert_eq!(cell("status"), "crashed");
    assert!(
        cell("reason").contains("next: billow run STUDY --again crashed"),
        "{}",
        cell("reason")
    );

    // Another run leaves it alone.
    assert_eq!(run_all(folder.path(), &Tasks::new(done)).0.ran, 0);
}

#[test]
fn two_deaths_beside_other_jobs_are_no_quarantine_nor_is_one_before_a_checkpoint() {
    let folder = folder();
    let stopped = Stop::new();
    stopped.request(15);
    for _ in 0..2 {
        die(folder.path(), &[0, 3]);
        run_with(folder.path(), &Tasks::new(done), &stopped, CHECKPOINT_INTERVAL);
    }
    let results = Results::new(&Disk, folder.path());
    let mut writer = crate::store::journal::Writer::new(&Disk, results.journal_path());
    writer.progress(&[fixture::job(3).id]).unwrap();
    die(folder.path(), &[3]);
    let executor = Tasks::new(done);
    let (summary, _) = run_all(folder.path(), &executor);
    assert_eq!(summary.counts.of(Status::Done), 4);
    assert_eq!(executor.order.into_inner().unwrap()[2..], [0, 3]);
}

#[test]
fn the_checkpoint_of_a_finished_job_is_removed() {
    let folder = folder();
    let results = Results::new(&Disk, folder.path());
    run_all(folder.path(), &Tasks::new(done));
    // The process died before it removed the file.
    results.write_checkpoint(&fixture::job(3).id, "old").unwrap();
    run_all(folder.path(), &Tasks::new(done));
    assert!(results.checkpoints().unwrap().is_empty());
}

#[test]
fn a_checkpoint_is_due_after_its_interval_and_costs_a_hundredth_at_most() {
    let folder = folder();
    let executor = Tasks::new(|task: &Task<'_>| {
        if number(task.job) == 0 {
            assert_eq!(task.control.order(), Order::Store);
            std::thread::sleep(Duration::from_millis(20));
            task.control.store("state", 0.1);
            // It took 20 ms, so the next one is due after 2 s.
            std::thread::sleep(Duration::from_millis(100));
            assert_eq!(task.control.order(), Order::Continue);
        }
        done(task)
    });
    let (summary, _) = run_with(folder.path(), &executor, &Stop::new(), Duration::ZERO);
    assert_eq!(summary.counts.of(Status::Done), 4);
}
