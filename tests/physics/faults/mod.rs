//! Faults that begin within a run: each is caught by a named audit before the run ends, in every integrator, or is
//! listed with the reason why no audit sees it. The table of `docs/reference/faults.md` says what is expected.

use std::path::Path;

use billow_solver::models::run;

mod checkpoint;
mod injected;
mod scenes;
mod stored;
mod table;

use injected::{Change, injected};
use scenes::SceneOf;
use table::{BAG, CAPSULE, FILLING, Place, ROWS, SHEETS, STRIP};

use crate::prelude::*;

/// The page with the table.
fn page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reference/faults.md");
    std::fs::read_to_string(path).expect("the page of faults")
}

/// Rows of the page: fault, scene, and what catches it in each integrator, in the order of `IntegratorKind::ALL`: the
/// name of an audit, `unseen` with the number of a reason, or `none` where the integrator has no such thing.
fn expected(page: &str) -> Vec<Vec<&str>> {
    let columns = IntegratorKind::ALL.len() + 2;
    let cells = page.lines().map(|line| line.trim_matches('|').split('|').map(str::trim).collect());
    cells.filter(|row: &Vec<&str>| row.len() == columns).skip(2).collect()
}

/// Every fault in each of its scenes, in the order of the page.
fn rows() -> impl Iterator<Item = (&'static str, Change, Place)> {
    let all = ROWS.iter();
    all.flat_map(|(fault, change, places)| places.iter().map(|place| (*fault, *change, *place)))
}

fn deploy(
    start: SceneOf,
    kind: IntegratorKind,
    refinement: u32,
    change: Change,
    time: f64,
) -> Deployment {
    let (run, timeline) = start(kind, refinement);
    let mut run = injected(run, change, time);
    run::run(&mut run, &timeline, &mut Unobserved)
}

/// The audit that ended a run; `None` if it is done.
fn audit(end: &Deployment) -> Option<&'static str> {
    match &end.stop {
        Stop::Done => None,
        Stop::Failed(failure) => Some(failure.audit.name()),
        Stop::Cancelled => panic!("no observer cancels"),
    }
}

fn is_caught(cell: &str) -> bool {
    cell != "none" && !cell.starts_with("unseen")
}

/// Where page and runs disagree. `same`: whether the audit must be that of the page, or any.
fn disagreements(refinement: u32, same: bool) -> Vec<String> {
    let page = page();
    let mut wrong = Vec::new();
    for ((fault, change, (scene, start, time)), row) in rows().zip(expected(&page)) {
        for (kind, cell) in IntegratorKind::ALL.into_iter().zip(&row[2..]) {
            let end = deploy(start, kind, refinement, change, time);
            let agrees = match audit(&end) {
                Some(audit) => is_caught(cell) && (audit == *cell || !same),
                None => !is_caught(cell),
            };
            if !agrees {
                wrong.push(format!("{fault}, {scene}, {kind:?}: {cell}, found {:?}", end.stop));
            }
        }
    }
    wrong
}

/// Runs without a fault that do not reach their end.
fn unfinished(refinement: u32) -> Vec<String> {
    let mut failed = Vec::new();
    for (scene, start, _) in [BAG, FILLING, SHEETS, STRIP, CAPSULE] {
        for kind in IntegratorKind::ALL {
            let end = deploy(start, kind, refinement, Change::Nothing, 0.0);
            if let Some(audit) = audit(&end) {
                failed.push(format!("{scene}, {kind:?}: {audit}"));
            }
        }
    }
    failed
}

#[test]
fn every_fault_is_caught_or_listed_as_unseen() {
    let wrong = disagreements(0, true);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_scene_without_a_fault_is_done() {
    let failed = unfinished(0);
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// On finer meshes, where another audit may be the first.
#[test]
#[ignore = "long: finer meshes"]
fn every_fault_is_caught_on_finer_meshes() {
    let mut wrong = unfinished(1);
    wrong.extend(disagreements(1, false));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The hybrid is implicit where `filling` gets its faults, and explicit elsewhere.
#[test]
fn faults_reach_both_integrators_of_the_hybrid() {
    let (run, timeline) = scenes::filling(IntegratorKind::Hybrid, 0);
    let mut run = injected(run, Change::Nothing, 0.0);
    let end = run::run(&mut run, &timeline, &mut Unobserved);
    let times: Vec<f64> = end.events.iter().map(|event| event.time).collect();
    assert!(times.len() == 1 && times[0] < 0.3, "{times:?}");
    let bag = deploy(scenes::bag, IntegratorKind::Hybrid, 0, Change::Nothing, 0.0);
    assert!(bag.events.is_empty(), "{:?}", bag.events);
}

#[test]
fn the_page_has_every_fault_and_every_reason() {
    let page = page();
    let mut faults: Vec<[&str; 2]> = rows().map(|(fault, _, (scene, ..))| [fault, scene]).collect();
    faults.push(["a byte of a checkpoint flipped", "bag"]);
    let expected = expected(&page);
    assert_eq!(expected.iter().map(|row| [row[0], row[1]]).collect::<Vec<_>>(), faults);
    assert_eq!(expected[faults.len() - 1][2..], ["checksum"; 3]);
    let cells = expected.iter().flatten().filter_map(|cell| cell.strip_prefix("unseen "));
    for number in cells {
        assert!(page.contains(&format!("\n{number}. ")), "reason {number}");
    }
}
