//! Runs finished jobs again: nothing is lost, no other job runs, the bits are compared.

#![expect(clippy::disallowed_methods, reason = "tests read and write files directly")]

use std::fs;
use std::io;
use std::path::Path;
use std::sync::atomic::Ordering;

use super::*;
use crate::job::executor::Outcome;
use crate::job::limits::Limit;
use crate::platform::files::failing::FailingFiles;
use crate::platform::files::{Disk, Files};
use crate::run::event::Silent;
use crate::run::fixture::{self, Scripted, folder, ran};
use crate::store::history_file;
use crate::store::journal::{Record, Writer};

const JOBS: u32 = 5;

/// Runs a plan of five points, the third infeasible; or some of its jobs again.
fn run_on<S: Fn(u32) -> Outcome + Sync>(
    files: &dyn Files,
    root: &Path,
    rerun: Option<&[u32]>,
    script: S,
) -> (Result<Summary>, usize) {
    let ids: Option<BTreeSet<JobId>> =
        rerun.map(|numbers| numbers.iter().map(|number| fixture::job(*number).id).collect());
    let executor = Scripted::new(script);
    let planner = |finished: &[FinishedRow]| finished.is_empty().then(|| fixture::generation(JOBS));
    let study = fixture::run(Results::new(files, root), &planner, &executor);
    let study = Run { rerun: ids.as_ref(), ..study };
    let ended = run(&study, &mut Silent).map(|ended| ended.summary);
    (ended, executor.executed.load(Ordering::SeqCst))
}

fn history(root: &Path, number: u32) -> Vec<u8> {
    fs::read(Results::new(&Disk, root).job_path(&fixture::job(number).id)).unwrap()
}

/// The same job with one more sample: other bits.
fn other_bits(number: u32) -> Outcome {
    Outcome::Ran { deployment: Box::new(fixture::deployment(number, 8)), seconds: 0.5, steps: 100 }
}

#[test]
fn another_status_counts_as_different() {
    let folder = folder();
    run_on(&Disk, folder.path(), None, ran).0.unwrap();
    let (ended, executed) = run_on(&Disk, folder.path(), Some(&[1, 4]), |number| {
        if number == 4 { panic!("bad luck") } else { ran(number) }
    });
    let summary = ended.unwrap();
    assert_eq!((executed, summary.same), (2, 1));
    assert_eq!(summary.different, [fixture::job(4).id]);
}

#[test]
fn an_invalidated_job_that_did_not_end_runs_next_and_is_compared() {
    let folder = folder();
    run_on(&Disk, folder.path(), None, ran).0.unwrap();
    let old = history(folder.path(), 1);
    let results = Results::new(&Disk, folder.path());
    Writer::new(&Disk, results.journal_path()).invalidate(&[fixture::job(1).id]).unwrap();
    assert_eq!(
        history(folder.path(), 1),
        old,
        "the old history stays until the new one replaces it"
    );
    let (ended, executed) = run_on(&Disk, folder.path(), None, ran);
    assert_eq!((executed, ended.unwrap().same), (1, 1));
}

#[test]
fn a_rerun_that_is_stopped_or_reaches_a_limit_keeps_the_results() {
    let folder = folder();
    run_on(&Disk, folder.path(), None, ran).0.unwrap();
    let results = Results::new(&Disk, folder.path());
    let (table, journal) = (fs::read(results.table_path()).unwrap(), results.journal().unwrap());
    for outcome in [Outcome::Cancelled, Outcome::Limited(Limit::WallTime(1.0))] {
        let (ended, executed) = run_on(&Disk, folder.path(), Some(&[1, 3]), |_| outcome.clone());
        let summary = ended.unwrap();
        assert_eq!((executed, summary.counts.status["done"]), (2, 4), "{outcome:?}");
        assert_eq!(results.journal().unwrap().records, journal.records);
        assert_eq!(fs::read(results.table_path()).unwrap(), table);
        let (_, executed) = run_on(&Disk, folder.path(), None, ran);
        assert_eq!(executed, 0, "every job is finished");
    }
}

#[test]
fn a_rerun_does_not_run_other_pending_jobs() {
    let folder = folder();
    run_on(&Disk, folder.path(), Some(&[0]), ran).0.unwrap();
    let (ended, executed) = run_on(&Disk, folder.path(), Some(&[0]), ran);
    let summary = ended.unwrap();
    assert_eq!(
        (executed, summary.counts.status["pending"], summary.counts.status["done"]),
        (1, 3, 1)
    );
}

#[test]
fn a_failed_write_of_a_rerun_loses_nothing() {
    let folder = folder();
    let undisturbed = folder.path().join("whole");
    run_on(&Disk, &undisturbed, None, ran).0.unwrap();
    let table = fs::read(undisturbed.join("summary.parquet")).unwrap();
    for kind in [io::ErrorKind::StorageFull, io::ErrorKind::ReadOnlyFilesystem] {
        for nth in 1.. {
            let root = folder.path().join(format!("{kind:?}-{nth}"));
            run_on(&Disk, &root, None, ran).0.unwrap();
            let failing = FailingFiles::new(nth, kind);
            // Other bits, so that the test sees a lost or partly replaced file.
            let (ended, _) = run_on(&failing, &root, Some(&[0, 3, 4]), other_bits);
            if ended.is_ok() {
                assert!(nth > 12, "only {nth} changing operations");
                break;
            }
            let error = ended.unwrap_err().to_string();
            assert!(error.contains("next:"), "{error}");
            let results = Results::new(&Disk, &root);
            let journal = results.journal().unwrap();
            assert_eq!(
                journal.records.len() + journal.invalidated.len(),
                4,
                "every job is finished or invalidated, at operation {nth}"
            );
            // No record is without its history.
            let damaged = |record: &&Record| results.damage(record).unwrap().is_some();
            assert_eq!(journal.records.values().filter(damaged).count(), 0, "operation {nth}");
            for number in [0, 1, 3, 4] {
                let path = results.job_path(&fixture::job(number).id);
                history_file::read(&path).unwrap();
            }
            run_on(&Disk, &root, None, ran).0.unwrap();
            run_on(&Disk, &root, Some(&[0, 1, 3, 4]), ran).0.unwrap();
            assert_eq!(fs::read(root.join("summary.parquet")).unwrap(), table, "operation {nth}");
            for number in [0, 1, 3, 4] {
                assert_eq!(
                    history(&root, number),
                    history(&undisturbed, number),
                    "operation {nth}"
                );
            }
        }
    }
}
