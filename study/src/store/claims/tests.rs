//! Claims of runs that are alive, dead, held up and started again.

#![expect(clippy::disallowed_methods, reason = "tests read and write files directly")]

use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use super::*;
use crate::platform::files::Disk;

fn id(number: u32) -> JobId {
    JobId::from_digits(&format!("{number:032x}")).unwrap()
}

fn claims<'a>(results: &Results<'a>, owner: &str) -> Claims<'a> {
    Claims::new(results, owner, LEASE).unwrap()
}

/// Moves the time of a process into the past, as if it had not renewed its claims.
fn grow_old(claims: &Claims<'_>, by: Duration) {
    let file = fs::OpenOptions::new().write(true).open(claims.run_path()).unwrap();
    file.set_modified(SystemTime::now() - by).unwrap();
}

#[test]
fn of_many_runs_one_has_a_job() {
    let folder = tempfile::tempdir().unwrap();
    let results = Results::new(&Disk, folder.path());
    let taken: Vec<AtomicUsize> = (0..50).map(|_| AtomicUsize::new(0)).collect();
    let all: Vec<Claims<'_>> = (0..8).map(|n| claims(&results, &format!("run{n}"))).collect();
    let ended = thread::scope(|scope| {
        let threads = all.into_iter().map(|mut claims| {
            let taken = &taken;
            scope.spawn(move || {
                for (number, taken) in (0..).zip(taken) {
                    if claims.take(&id(number)).unwrap() == Claim::Taken {
                        taken.fetch_add(1, Ordering::SeqCst);
                    }
                }
                claims
            })
        });
        let threads: Vec<_> = threads.collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect::<Vec<_>>()
    });
    assert!(taken.iter().all(|taken| taken.load(Ordering::SeqCst) == 1));
    let live = results.live_runs().unwrap();
    assert_eq!(live.len(), 8);
    assert_eq!(live.iter().map(|run| run.jobs.len()).sum::<usize>(), 50);
    drop(ended);
    assert!(results.live_runs().unwrap().is_empty());
    assert_eq!(fs::read_dir(results.claims_path()).unwrap().count(), 0);
}

#[test]
fn a_claim_is_over_after_its_lease_unless_its_run_renews_it() {
    let folder = tempfile::tempdir().unwrap();
    let results = Results::new(&Disk, folder.path());
    let mut first = claims(&results, "first");
    let mut second = claims(&results, "second");
    assert_eq!(first.take(&id(1)).unwrap(), Claim::Taken);
    assert!(matches!(second.take(&id(1)).unwrap(), Claim::Held(_)));
    grow_old(&first, LEASE + Duration::from_secs(1));
    assert_eq!(second.holder(&id(1)).unwrap(), None);
    first.renew().unwrap();
    assert!(second.holder(&id(1)).unwrap().is_some());
    assert!(matches!(second.take(&id(1)).unwrap(), Claim::Held(_)));
    grow_old(&first, LEASE + Duration::from_secs(1));
    assert_eq!(second.take(&id(1)).unwrap(), Claim::Taken);
    // The first run comes back: it sees whose the job is, and takes another one.
    first.renew().unwrap();
    assert!(matches!(first.take(&id(1)).unwrap(), Claim::Held(_)));
    assert_eq!(first.take(&id(2)).unwrap(), Claim::Taken);
}

#[test]
fn a_task_that_starts_again_has_its_own_claims_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let results = Results::new(&Disk, folder.path());
    let mut killed = claims(&results, "slurm-12-3");
    assert_eq!(killed.take(&id(1)).unwrap(), Claim::Taken);
    std::mem::forget(killed);
    let mut again = claims(&results, "slurm-12-3");
    assert_eq!(again.take(&id(1)).unwrap(), Claim::Taken);
    again.release(&id(1)).unwrap();
    assert_eq!(claims(&results, "other").take(&id(1)).unwrap(), Claim::Taken);
}

#[test]
fn a_command_that_must_be_alone_waits_for_live_runs_and_clears_dead_ones() {
    let folder = tempfile::tempdir().unwrap();
    let results = Results::new(&Disk, folder.path());
    results.refuse_live_runs().unwrap();
    let mut run = claims(&results, "node1-7");
    run.take(&id(1)).unwrap();
    fs::write(run.attempts_path(), "").unwrap();
    let refused = results.refuse_live_runs().unwrap_err().to_string();
    assert!(refused.contains("a run works") && refused.contains("node1-7"), "{refused}");
    assert!(results.take_dead_runs().unwrap().is_empty());
    assert!(results.claims_path().join(id(1).as_str()).exists());

    grow_old(&run, LEASE + Duration::from_secs(1));
    results.refuse_live_runs().unwrap();
    assert_eq!(results.take_dead_runs().unwrap(), [run.attempts_path()]);
    assert!(!results.claims_path().join(id(1).as_str()).exists());
    // It was only held up: it goes on.
    assert_eq!(run.take(&id(2)).unwrap(), Claim::Taken);
    assert_eq!(results.live_runs().unwrap()[0].jobs, [id(2)]);
}

#[test]
fn a_damaged_claim_is_over_after_the_usual_lease() {
    let folder = tempfile::tempdir().unwrap();
    let results = Results::new(&Disk, folder.path());
    let mut run = claims(&results, "run");
    let path = results.claims_path().join(id(1).as_str());
    fs::write(&path, "{\"owner\":").unwrap();
    assert!(matches!(run.take(&id(1)).unwrap(), Claim::Held(_)));
    let file = fs::OpenOptions::new().write(true).open(&path).unwrap();
    file.set_modified(SystemTime::now() - 2 * LEASE).unwrap();
    assert_eq!(run.take(&id(1)).unwrap(), Claim::Taken);
}
