//! Parts of a study, and what cannot be merged.

#![expect(clippy::disallowed_methods, reason = "tests read and write files directly")]

use std::fs;
use std::path::Path;

use super::*;
use crate::platform::files::Disk;
use crate::run::event::Silent;
use crate::run::fixture::{self, Scripted, ran};
use crate::run::runner::{self, Run, Summary};
use crate::run::selection::{Part, Selection};
use crate::study::finished::FinishedRow;
use crate::study::plan;
use crate::study::{MAX_POINTS, Study};

/// A study of eight piston jobs.
fn study() -> Study {
    let text = r#"{
        "question": "Does a part of a run give the table of the whole?",
        "design": {"fit": "cone", "N": 6, "M": 3, "bottom_radius": 0.5, "top_radius": 0.365, "height": 1},
        "gas": {"mass_flow_rate": 0.005},
        "solver": {"model": "piston", "end_time": 0.01},
        "grid": {"mass_flow_rate": [0.001, 0.002, 0.003, 0.004], "N": [5, 6]}
    }"#;
    Study::from_text(text, "s.json", "s", &[], MAX_POINTS).unwrap()
}

/// Runs a part of it with invented results.
fn run_part(study: &Study, root: &Path, selection: Selection) -> Summary {
    let executor = Scripted::new(ran);
    let planner = |finished: &[FinishedRow]| plan::next_jobs(study, finished);
    let results = Results::new(&Disk, root);
    let run = Run {
        name: &study.name,
        study: study.file(),
        table: &|points, records| Table::of_study(study, points, records),
        selection,
        known: results.known().unwrap(),
        ..fixture::run(results, &planner, &executor)
    };
    runner::run(&run, &mut Silent).unwrap().summary
}

fn part(text: &str) -> Selection {
    Selection::Part(Part::parse(text).unwrap())
}

#[test]
fn other_studies_other_bits_and_damaged_histories_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let study = study();
    let file = study.file();
    run_part(&study, &path("one"), Selection::All);
    run_part(&study, &path("two"), part("1/2"));
    let sources = [path("one")];
    let sources: Vec<Results<'_>> = sources.iter().map(|path| Results::new(&Disk, path)).collect();
    let (new, two) = (path("new"), path("two"));
    let refused = merge(&sources, &Results::new(&Disk, &new), ("other", file), &Stop::new());
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
    let merged = merge(&sources, &target, (&study.name, file), &Stop::new()).unwrap();
    assert_eq!((merged.copied, merged.same), (3, 3));
    assert_eq!(
        (merged.different, merged.damaged),
        (vec![changed], vec![sources[0].job_path(damaged)])
    );
}
