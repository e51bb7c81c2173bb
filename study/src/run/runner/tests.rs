//! Runs with a scripted executor: nothing is lost, nothing runs twice, the order changes no bit.

#![expect(clippy::disallowed_methods, reason = "tests read and write files directly")]

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::SystemTime;

use billow_solver::platform::seal;

use super::*;
use crate::input::value::Value;
use crate::job::executor::Outcome;
use crate::platform::error::Error;
use crate::platform::files::failing::FailingFiles;
use crate::platform::files::{Disk, Files};
use crate::run::event::Silent;
use crate::run::fixture::{self, Scripted, folder, ran, table};
use crate::store::history_file;

struct EventLog(Vec<Event>);

impl Reporter for EventLog {
    fn event(&mut self, event: &Event) {
        self.0.push(event.clone());
    }
}

impl EventLog {
    fn notes(&self) -> Vec<&str> {
        let mut notes = Vec::new();
        for event in &self.0 {
            if let Event::Note(text) = event {
                notes.push(text.as_str());
            }
        }
        notes
    }
}

fn generation_zero(jobs: u32) -> impl Fn(&[FinishedRow]) -> Option<Generation> {
    move |finished| finished.is_empty().then(|| fixture::generation(jobs))
}

/// Runs a plan of `jobs` points, the third infeasible.
fn run_on(
    files: &dyn Files,
    root: &Path,
    jobs: u32,
    threads: usize,
    executor: &dyn Executor,
    reporter: &mut dyn Reporter,
) -> Result<Summary> {
    let planner = generation_zero(jobs);
    let study = fixture::run(Results::new(files, root), &planner, executor);
    run(&Run { threads: NonZero::new(threads), ..study }, reporter).map(|ended| ended.summary)
}

fn run_quiet(root: &Path, jobs: u32, threads: usize, executor: &dyn Executor) -> Summary {
    run_on(&Disk, root, jobs, threads, executor, &mut Silent).unwrap()
}

/// Every file under a folder: bytes and time of last change.
fn files_under(root: &Path) -> BTreeMap<PathBuf, (Vec<u8>, SystemTime)> {
    let mut found = BTreeMap::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let changed = path.metadata().unwrap().modified().unwrap();
                found.insert(
                    path.strip_prefix(root).unwrap().to_owned(),
                    (fs::read(&path).unwrap(), changed),
                );
            }
        }
    }
    found
}

fn histories(root: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let all = files_under(&root.join("jobs"));
    all.into_iter().map(|(path, (bytes, _))| (path, bytes)).collect()
}

fn executed<S>(executor: &Scripted<S>) -> usize {
    executor.executed.load(Ordering::SeqCst)
}

#[test]
fn the_bytes_do_not_depend_on_threads() {
    let folder = folder();
    let mut stored = Vec::new();
    for threads in [1, 2, 3] {
        let root = folder.path().join(threads.to_string());
        let summary = run_quiet(&root, 20, threads, &Scripted::new(ran));
        assert_eq!(summary.ran, 19);
        assert_eq!(
            summary.counts.status,
            [("done".to_owned(), 19), ("infeasible".to_owned(), 1)].into()
        );
        assert_eq!(summary.counts.verdict, [("deployed".to_owned(), 19)].into());
        stored.push((histories(&root), fs::read(root.join("summary.parquet")).unwrap()));
    }
    assert_eq!(stored[0].0.len(), 19);
    assert!(stored.iter().all(|files| *files == stored[0]));
}

#[test]
fn a_second_run_computes_nothing_and_changes_no_file() {
    let folder = folder();
    let executor = Scripted::new(ran);
    run_quiet(folder.path(), 6, 2, &executor);
    let before = files_under(folder.path());
    let again = Scripted::new(ran);
    let mut log = EventLog(Vec::new());
    let summary = run_on(&Disk, folder.path(), 6, 2, &again, &mut log).unwrap();
    assert_eq!((executed(&again), summary.ran), (0, 0));
    assert_eq!(summary.counts.status["done"], 5);
    assert_eq!(files_under(folder.path()), before);
    assert!(log.0.contains(&Event::GenerationStarted { number: 0, jobs: 5, finished: 5 }));
}

#[test]
fn a_run_that_is_stopped_before_its_plan_leaves_the_table_as_it_is() {
    let folder = folder();
    let planner = generation_zero(5);
    let executor = Scripted::new(ran);
    let stopped = |root: &Path| {
        let study = fixture::run(Results::new(&Disk, root), &planner, &executor);
        study.stop.request(15);
        run(&study, &mut Silent).unwrap();
    };
    let table = |root: &Path| fs::read(root.join("summary.parquet")).ok();
    let (new, old) = (folder.path().join("new"), folder.path().join("old"));
    stopped(&new);
    assert_eq!(table(&new), None);
    run_quiet(&old, 5, 1, &executor);
    let before = table(&old);
    stopped(&old);
    assert!(before.is_some() && table(&old) == before);
}

#[test]
fn a_larger_study_runs_only_its_new_jobs_and_a_smaller_one_runs_nothing() {
    let folder = folder();
    run_quiet(folder.path(), 4, 1, &Scripted::new(ran));
    let executor = Scripted::new(ran);
    run_quiet(folder.path(), 9, 1, &executor);
    assert_eq!(executed(&executor), 5);
    assert_eq!(table(folder.path(), 9).rows(), 9);
    let executor = Scripted::new(ran);
    run_quiet(folder.path(), 4, 1, &executor);
    assert_eq!(executed(&executor), 0);
    assert_eq!(table(folder.path(), 4).rows(), 4);
}

#[test]
fn a_panic_and_a_refused_scene_are_rows_with_a_reason() {
    let script = |number| match number {
        1 => panic!("bad luck with {number}"),
        3 => Outcome::Refused(billow_solver::scene::error::SceneError::Invalid {
            key: "film.thickness".to_owned(),
            problem: "too thick".to_owned(),
        }),
        number => ran(number),
    };
    let folder = folder();
    let summary = run_quiet(folder.path(), 6, 2, &Scripted::new(script));
    assert_eq!(summary.counts.failed(), 2);
    let table = table(folder.path(), 6);
    let cell = |name: &str, row: usize| table.column(name).unwrap().cells[row].to_string();
    let status: Vec<String> = (0..6).map(|row| cell("status", row)).collect();
    assert_eq!(status, ["done", "panicked", "infeasible", "invalid", "done", "done"]);
    assert!(cell("reason", 1).starts_with("bad luck with 1 ("), "{}", cell("reason", 1));
    assert_eq!(cell("reason", 3), "film.thickness: too thick");

    let again = Scripted::new(script);
    let summary = run_quiet(folder.path(), 6, 2, &again);
    assert_eq!(
        (executed(&again), summary.counts.failed()),
        (0, 2),
        "a failed job is not run again"
    );
}

#[test]
fn a_failed_write_loses_no_stored_job_and_the_next_run_completes() {
    let folder = folder();
    let undisturbed = folder.path().join("whole");
    run_quiet(&undisturbed, 4, 1, &Scripted::new(ran));
    for kind in [io::ErrorKind::StorageFull, io::ErrorKind::ReadOnlyFilesystem] {
        for nth in 1.. {
            let root = folder.path().join(format!("{kind:?}-{nth}"));
            let failing = FailingFiles::new(nth, kind);
            let ended = run_on(&failing, &root, 4, 1, &Scripted::new(ran), &mut Silent);
            if ended.is_ok() {
                assert!(nth > 20, "only {nth} changing operations");
                break;
            }
            let Err(Error::Disk { path, problem }) = &ended else { panic!("{ended:?}") };
            assert!(path.starts_with(&root) && problem.contains("next:"), "{ended:?}");

            let results = Results::new(&Disk, &root);
            let stored = results.journal().unwrap().records;
            for record in stored.values() {
                assert_eq!(results.damage(record).unwrap(), None, "a record without its file");
            }
            let executor = Scripted::new(ran);
            run_quiet(&root, 4, 1, &executor);
            assert_eq!(executed(&executor), 3 - stored.len(), "{kind:?} at operation {nth}");
            assert_eq!(histories(&root), histories(&undisturbed), "{kind:?} at operation {nth}");
            assert_eq!(
                fs::read(root.join("summary.parquet")).unwrap(),
                fs::read(undisturbed.join("summary.parquet")).unwrap()
            );
            let leftover = files_under(&root);
            assert!(leftover.keys().all(|path| path.extension().is_none_or(|end| end != "tmp")));
        }
    }
}

#[test]
fn a_missing_or_damaged_history_runs_again_with_a_note() {
    let folder = folder();
    run_quiet(folder.path(), 5, 1, &Scripted::new(ran));
    let before = histories(folder.path());
    let results = Results::new(&Disk, folder.path());
    let path = |number| results.job_path(&fixture::job(number).id);
    fs::remove_file(path(0)).unwrap();
    let bytes = fs::read(path(3)).unwrap();
    fs::write(path(3), &bytes[..bytes.len() / 2]).unwrap();
    let mut flipped = fs::read(path(4)).unwrap();
    *flipped.last_mut().unwrap() ^= 1;
    fs::write(path(4), flipped).unwrap();

    let executor = Scripted::new(ran);
    let mut log = EventLog(Vec::new());
    run_on(&Disk, folder.path(), 5, 1, &executor, &mut log).unwrap();
    assert_eq!(executed(&executor), 3);
    let notes = log.notes();
    assert_eq!(notes.len(), 3);
    assert!(notes[0].contains("missing; its job runs again"), "{notes:?}");
    assert!(notes[2].contains("not the file that was written"), "{notes:?}");
    assert_eq!(histories(folder.path()), before);
}

#[test]
fn a_torn_journal_line_loses_only_its_job() {
    let folder = folder();
    run_quiet(folder.path(), 5, 1, &Scripted::new(ran));
    let before = table(folder.path(), 5);
    let path = folder.path().join("journal").join("000001.jsonl");
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() - 9]).unwrap();
    let executor = Scripted::new(ran);
    let mut log = EventLog(Vec::new());
    run_on(&Disk, folder.path(), 5, 1, &executor, &mut log).unwrap();
    assert_eq!(executed(&executor), 1);
    assert!(log.notes()[0].contains("line 6: torn"), "{:?}", log.notes());
    assert_eq!(table(folder.path(), 5), before);
}

#[test]
fn a_resumed_study_plans_its_generations_again() {
    let folder = folder();
    // Two generations: the second is planned from the rows of the first.
    let planner = |finished: &[FinishedRow]| -> Option<Generation> {
        let mut all = fixture::points(6);
        let second = all.split_off(3);
        match finished.len() {
            0 => Some(Generation { number: 0, points: Arc::new(all) }),
            3 => Some(Generation { number: 1, points: Arc::new(second) }),
            _ => None,
        }
    };
    for expected in [5, 0] {
        let executor = Scripted::new(ran);
        let study = fixture::run(Results::new(&Disk, folder.path()), &planner, &executor);
        run(&study, &mut Silent).unwrap();
        assert_eq!(executed(&executor), expected);
        assert_eq!(table(folder.path(), 6).rows(), 6);
    }
}

#[test]
fn another_study_a_newer_one_and_a_second_command_are_refused() {
    let folder = folder();
    run_quiet(folder.path(), 3, 1, &Scripted::new(ran));
    let refused = || {
        let executor = Scripted::new(ran);
        let ended = run_on(&Disk, folder.path(), 3, 1, &executor, &mut Silent);
        ended.unwrap_err().to_string()
    };
    let path = folder.path().join("study.json");
    let valid = fs::read_to_string(&path).unwrap();
    let object = seal::open(&valid).unwrap();
    let other = |old: &str, new: &str| fs::write(&path, seal::seal(&object.replace(old, new)));
    other("\"test\"", "\"other\"").unwrap();
    assert!(refused().contains("holds results of the study \"other\", not of \"test\""));
    other("\"version\": 1", "\"version\": 2").unwrap();
    assert!(refused().contains("version 2, this program reads version 1"));
    fs::write(&path, valid).unwrap();
    let lock = Results::new(&Disk, folder.path()).lock().unwrap();
    assert!(refused().contains("another billow command is running this study"));
    drop(lock);
    run_quiet(folder.path(), 3, 1, &Scripted::new(ran));
}

#[test]
fn a_damaged_study_json_is_written_again_and_kept() {
    let folder = folder();
    run_quiet(folder.path(), 3, 1, &Scripted::new(ran));
    let path = folder.path().join("study.json");
    let valid = fs::read_to_string(&path).unwrap();
    let results = Results::new(&Disk, folder.path());
    let edited = valid.replace("\"test\"", "\"other\"");
    for (number, damaged) in [&edited, "{}", "", &valid[..20]].into_iter().enumerate() {
        fs::write(&path, damaged).unwrap();
        let message = results.owner().unwrap_err().to_string();
        assert!(message.contains("damaged") && message.contains("doctor --repair"), "{message}");
        run_quiet(folder.path(), 3, 1, &Scripted::new(ran));
        assert_eq!(fs::read_to_string(&path).unwrap(), valid);
        let kept = folder.path().join(format!("damaged/study.json.{number}"));
        assert_eq!(fs::read_to_string(kept).unwrap(), *damaged);
    }
    // A file of another program in a folder without records is not touched.
    let other = tempfile::tempdir().unwrap();
    fs::write(other.path().join("study.json"), "{}").unwrap();
    let executor = Scripted::new(ran);
    let ended = run_on(&Disk, other.path(), 3, 1, &executor, &mut Silent);
    assert!(ended.unwrap_err().to_string().contains("not a study.json of billow"));
}

#[test]
fn a_thousand_tiny_jobs_cost_less_than_a_millisecond_each_besides_writing() {
    // User time of this thread in ticks, of which Linux has 100 a second (proc_pid_stat(5)).
    let cpu = || {
        let line = fs::read_to_string("/proc/thread-self/stat").unwrap();
        let after = line.rsplit(')').next().unwrap();
        after.split_whitespace().nth(11).unwrap().parse::<f64>().unwrap() / 100.0
    };
    let folder = folder();
    let start = cpu();
    let summary = run_quiet(folder.path(), 1000, 1, &Scripted::new(ran));
    let all = (cpu() - start) / 999.0;
    assert_eq!(summary.ran, 999);
    let start = cpu();
    for number in 0..999 {
        let deployment = fixture::deployment(number, 7);
        history_file::encode(&fixture::job(number), &deployment, "").unwrap();
    }
    let writing = (cpu() - start) / 999.0;
    println!("storing thread: {:.2} ms a job, {:.2} ms of it HDF5", 1e3 * all, 1e3 * writing);
    assert!(all - writing < 1e-3, "{all} s a job, {writing} s of it HDF5");
    assert_eq!(table(folder.path(), 1000).column("steps").unwrap().cells[999], Value::Integer(100));
}
