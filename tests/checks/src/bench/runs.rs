//! Whole runs of the capsule: their costs, and the stages of a step from three states.

use billow_study::platform::error::Result;

use super::capsule::{Capsule, Progress};
use super::{EARLY, Effort, LARGEST_RUN, MAX_REPEATED_WALL_TIME, Part, Plan, RISING, Row, stages};

/// End time with `--quick`, s.
const QUICK_END: f64 = 0.05;

/// End time of a mesh's run, s. Chosen: the run takes minutes at most.
fn end_time(effort: Effort, subdivisions: u32) -> f64 {
    match (effort, subdivisions) {
        (Effort::Quick, n) if n > LARGEST_RUN => 0.0,
        (Effort::Quick, _) => QUICK_END,
        (_, n) if n > LARGEST_RUN => EARLY,
        (Effort::Usual, 0..=8) | (Effort::Full, 9..) => 0.3,
        (Effort::Usual, _) => 0.1,
        (Effort::Full, _) => 1.5,
    }
}

/// Runs one mesh: its cost to each end time of a case, and the stages from its states.
///
/// # Errors
/// A failure of the run.
pub(super) fn measure(
    subdivisions: u32,
    plan: &Plan<'_>,
    stages: &mut Vec<Row>,
    cases: &mut Vec<Row>,
) -> Result<()> {
    let capsule = Capsule::new(subdivisions, plan.instruction_set)?;
    let end = end_time(plan.effort, subdivisions);
    if end > 0.0 {
        plan.note(&format!("run, n {subdivisions}, {end} s"));
    }
    let mut progress = Progress::of(&capsule)?;
    let mut states = vec![("stowed", progress.film.clone())];
    // Times, s, and whether the cost to them is a case; the other one is the state `rising`.
    let times: &[(f64, bool)] = match plan.effort {
        Effort::Quick => &[(RISING, false), (QUICK_END, true)],
        _ => &[(EARLY, true), (RISING, false), (0.1, true), (0.3, true), (1.5, true)],
    };
    for (time, is_case) in times.iter().copied().filter(|(time, _)| *time <= end) {
        progress.run_to(time)?;
        if !is_case {
            states.push(("rising", progress.film.clone()));
        } else if plan.has(Part::Cases) {
            cases.push(fastest(&capsule, &progress, time, plan)?);
        }
    }
    if subdivisions <= LARGEST_RUN {
        states.push(("end", progress.film.clone()));
    }
    if plan.has(Part::Stages) {
        for (name, film) in states {
            plan.note(&format!("stages, n {subdivisions}, {name}"));
            stages.push(stages::measure(&capsule, name, &film, plan)?);
        }
    }
    Ok(())
}

/// The cost to a time; a short run, which other processes disturb most, is repeated and the fastest kept.
fn fastest(capsule: &Capsule, run: &Progress<'_>, time: f64, plan: &Plan<'_>) -> Result<Row> {
    let (mut row, mut wall) = (run.case(time), run.wall);
    for _ in 1..plan.repeats() {
        if wall > MAX_REPEATED_WALL_TIME {
            break;
        }
        let mut repeat = Progress::of(capsule)?;
        repeat.run_to(time)?;
        if repeat.wall < wall {
            (row, wall) = (repeat.case(time), repeat.wall);
        }
    }
    Ok(row)
}
