//! Faults that begin within a run: each is caught by a named audit before the run ends, in every integrator, or is
//! listed with the reason why no audit sees it. `docs/reference/faults.md` has the same table.

use std::path::Path;

use billow_solver::models::run::{self, Unobserved};
use billow_solver::output::outcome::{Deployment, Stop};
use billow_solver::scene::IntegratorKind;

mod checkpoint;
mod injected;
mod scenes;
mod stored;
mod table;

use injected::{Change, injected};
use scenes::SceneOf;
use table::{REASONS, ROWS, Row};

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

/// Where rows and runs disagree. `same`: whether the audit must be that of the row, or any.
fn disagreements(refinement: u32, same: bool) -> Vec<String> {
    let mut wrong = Vec::new();
    for Row { fault, scene, start, change, time, caught } in ROWS {
        for (kind, cell) in IntegratorKind::ALL.into_iter().zip(caught) {
            let end = deploy(*start, kind, refinement, *change, *time);
            let found = audit(&end);
            let agrees = match found {
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
    for Row { scene, start, .. } in ROWS {
        for kind in IntegratorKind::ALL {
            let end = deploy(*start, kind, refinement, Change::Nothing, 0.0);
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
#[ignore = "minutes"]
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
fn the_guide_has_this_table() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reference/faults.md");
    let page = std::fs::read_to_string(path).expect("the guide");
    let mut expected: Vec<String> = ROWS
        .iter()
        .map(|row| format!("| {} | {} | {} |", row.fault, row.scene, row.caught.join(" | ")))
        .collect();
    expected.push(format!("| {} |", checkpoint::ROW.join(" | ")));
    let columns = IntegratorKind::ALL.len() + 4;
    let rows = page.lines().filter(|line| line.split('|').count() == columns);
    let found: Vec<&str> = rows.skip(2).collect();
    assert_eq!(found, expected);
    for (number, reason) in (1..).zip(REASONS) {
        let text: String = page.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains(&format!("{number}. {reason}")), "reason {number}");
        let cell = format!("unseen {number}");
        assert!(ROWS.iter().any(|row| row.caught.contains(&cell.as_str())), "{cell}");
    }
}
