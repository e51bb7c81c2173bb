//! Parts of a study, runs that share a folder, and what cannot be merged.

#![expect(clippy::disallowed_methods, reason = "tests read and write files directly")]

use std::fs;
use std::path::Path;

use super::*;
use crate::job;
use crate::job::limits::JobLimits;
use crate::platform::files::Disk;
use crate::run::event::Silent;
use crate::run::fixture::{Scripted, ran};
use crate::run::runner::{self, CHECKPOINT_INTERVAL, Run, Shared, Summary};
use crate::run::selection::{Part, Selection};
use crate::store::claims::LEASE;
use crate::study::finished::FinishedRow;
use crate::study::plan;
use crate::study::{PlanSize, Study};

/// A study of eight piston jobs.
fn study() -> Study {
    let text = r#"{
        "question": "Does a part of a run give the table of the whole?",
        "design": {"fit": "cone", "N": 6, "M": 3, "bottom_radius": 0.5, "top_radius": 0.365, "height": 1},
        "gas": {"mass_flow_rate": 0.005},
        "solver": {"model": "piston", "end_time": 0.01},
        "grid": {"mass_flow_rate": [0.001, 0.002, 0.003, 0.004], "N": [5, 6]}
    }"#;
    Study::from_text(text, "s.json", "s", &[], PlanSize::default()).unwrap()
}

/// Runs a part of it with invented results.
fn run_part(study: &Study, root: &Path, selection: Selection, shared: Option<Shared>) -> Summary {
    let executor = Scripted::new(ran);
    let run = Run {
        name: &study.name,
        study: &study.resolved(),
        planner: &|finished: &[FinishedRow]| plan::next_jobs(study, finished),
        result_limits: &[],
        label: &job::label,
        table: &|points, records| Table::of_study(study, points, records),
        executor: &executor,
        results: Results::new(&Disk, root),
        threads: std::num::NonZero::new(2),
        limits: JobLimits::default(),
        checkpoint_interval: CHECKPOINT_INTERVAL,
        stop: Stop::new(),
        rerun: None,
        selection,
        shared,
    };
    runner::run(&run, &mut Silent).unwrap()
}

fn part(text: &str) -> Selection {
    Selection::Part(Part::parse(text).unwrap())
}

/// The table of a folder, without what a clock measures.
fn table(root: &Path) -> Vec<(String, Vec<String>)> {
    let table = Results::new(&Disk, root).read_table().unwrap();
    let columns = table.columns.iter().filter(|column| !column.name.contains("seconds"));
    let cells =
        |cells: &[crate::input::value::Value]| cells.iter().map(ToString::to_string).collect();
    columns.map(|column| (column.name.clone(), cells(&column.cells))).collect()
}

#[test]
fn parts_in_folders_of_their_own_give_the_table_of_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let study = study();
    run_part(&study, &path("whole"), Selection::All, None);
    let mut ran = 0;
    for number in 1..=3 {
        let summary =
            run_part(&study, &path(&number.to_string()), part(&format!("{number}/3")), None);
        assert_eq!(summary.ran + summary.not_selected, 8);
        ran += summary.ran;
    }
    assert_eq!(ran, 8);
    let sources: Vec<_> = ["1", "2", "3"].map(path).into();
    let sources: Vec<Results<'_>> = sources.iter().map(|path| Results::new(&Disk, path)).collect();
    let resolved = study.resolved();
    let target = path("all");
    let target = Results::new(&Disk, &target);
    let merged = merge(&sources, &target, (&study.name, &resolved), &Stop::new()).unwrap();
    assert_eq!(merged, Merged { copied: 8, ..Merged::default() });
    assert_eq!(table(&path("all")), table(&path("whole")));
    // A second time there is nothing to copy, and a run finds nothing to do.
    let again = merge(&sources, &target, (&study.name, &resolved), &Stop::new()).unwrap();
    assert_eq!(again, Merged { same: 8, ..Merged::default() });
    assert_eq!(run_part(&study, &path("all"), Selection::All, None).ran, 0);
}

#[test]
fn other_studies_other_bits_and_damaged_histories_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let study = study();
    let resolved = study.resolved();
    run_part(&study, &path("one"), Selection::All, None);
    run_part(&study, &path("two"), part("1/2"), None);
    let sources = [path("one")];
    let sources: Vec<Results<'_>> = sources.iter().map(|path| Results::new(&Disk, path)).collect();
    let (new, two) = (path("new"), path("two"));
    let refused = merge(&sources, &Results::new(&Disk, &new), ("other", &resolved), &Stop::new());
    assert!(refused.unwrap_err().to_string().contains("not results of the study \"other\""));
    assert!(!new.exists());

    let target = Results::new(&Disk, &two);
    let journal = target.journal().unwrap();
    let changed = journal.records.keys().next().unwrap().clone();
    let mut record = journal.records[&changed].clone();
    record.cells.set(ColumnId::ContentHash, "0");
    Writer::new(&Disk, target.journal_path()).append(&[record]).unwrap();
    let damaged = sources[0].journal().unwrap();
    let damaged = damaged.records.keys().find(|id| !journal.records.contains_key(*id)).unwrap();
    fs::write(sources[0].job_path(damaged), "x").unwrap();
    let merged = merge(&sources, &target, (&study.name, &resolved), &Stop::new()).unwrap();
    assert_eq!((merged.copied, merged.same), (3, 3));
    assert_eq!(
        (merged.different, merged.damaged),
        (vec![changed], vec![sources[0].job_path(damaged)])
    );
}

#[test]
fn runs_that_share_a_folder_run_each_job_once_and_give_the_table_of_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let study = study();
    run_part(&study, &path("whole"), Selection::All, None);
    let root = path("shared");
    let ran: usize = std::thread::scope(|scope| {
        let run = |number: usize| {
            let shared = Shared { owner: format!("run{number}"), lease: LEASE };
            run_part(&study, &root, Selection::All, Some(shared)).ran
        };
        let runs: Vec<_> = (0..4).map(|number| scope.spawn(move || run(number))).collect();
        runs.into_iter().map(|run| run.join().unwrap()).sum()
    });
    assert_eq!(ran, 8);
    let results = Results::new(&Disk, &root);
    assert!(!results.table_path().exists() && results.live_runs().unwrap().is_empty());
    assert!(results.journal().unwrap().faults.is_empty());
    finish(&results).unwrap();
    assert_eq!(table(&root), table(&path("whole")));
    assert_eq!(fs::read_dir(results.claims_path()).unwrap().count(), 0);
}

#[test]
fn a_run_takes_over_the_jobs_of_a_dead_one_and_leaves_those_of_a_live_one() {
    let folder = tempfile::tempdir().unwrap();
    let study = study();
    let results = Results::new(&Disk, folder.path());
    let plan = plan::next_jobs(&study, &[]).unwrap();
    let id = |number: usize| plan.points[number].job.id.clone();
    let lease = std::time::Duration::from_secs(2);
    let claims = |owner| crate::store::claims::Claims::new(&results, owner, lease).unwrap();
    let (mut dead, mut live) = (claims("dead"), claims("live"));
    dead.take(&id(0)).unwrap();
    live.take(&id(1)).unwrap();
    std::mem::forget(dead);
    let over = std::sync::atomic::AtomicBool::new(false);
    let summary = std::thread::scope(|scope| {
        let (over, live) = (&over, &mut live);
        scope.spawn(move || {
            while !over.load(std::sync::atomic::Ordering::SeqCst) {
                live.renew().unwrap();
                std::thread::sleep(std::time::Duration::from_millis(100));
            }
        });
        let shared = Shared { owner: "this".to_owned(), lease };
        let summary = run_part(&study, folder.path(), Selection::All, Some(shared));
        over.store(true, std::sync::atomic::Ordering::SeqCst);
        summary
    });
    assert_eq!((summary.ran, summary.counts.of(crate::job::Status::Pending)), (7, 1));
    let journal = results.journal().unwrap();
    assert!(journal.records.contains_key(&id(0)) && !journal.records.contains_key(&id(1)));
    assert!(finish(&results).unwrap_err().to_string().contains("live"));
    finish_if_last(&results).unwrap();
    assert!(!results.table_path().exists(), "another run is alive");
}
