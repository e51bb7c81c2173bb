//! What is asked of billow's speed, and whether it is met. What was not measured is not met.

use super::capsule::Case;
use super::kernels::{KernelRow, REFERENCE, STEP};
use super::{EARLY, Effort, Line, Report};
use crate::input::value::Value;

/// A target.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Its name.
    pub name: &'static str,
    /// What is measured, in words.
    pub asks: &'static str,
    /// Its bound.
    pub bound: f64,
    /// Whether more than the bound is asked, or at most the bound.
    pub at_least: bool,
    /// What was measured.
    pub measured: Option<f64>,
}

impl Target {
    /// Whether it is met; `None` where nothing was measured.
    pub fn met(&self) -> Option<bool> {
        let holds = |value: f64| {
            if self.at_least { value >= self.bound } else { value <= self.bound }
        };
        self.measured.map(holds)
    }

    /// As a row.
    pub fn line(&self) -> Line {
        let sign = if self.at_least { "at least" } else { "at most" };
        vec![
            ("target", Value::Text(self.name.to_owned())),
            ("asked", Value::Text(sign.to_owned())),
            ("bound", Value::Number(self.bound)),
            ("measured", self.measured.map_or(Value::Null, Value::Number)),
            ("met", self.met().map_or(Value::Null, Value::Bool)),
            ("of", Value::Text(self.asks.to_owned())),
        ]
    }
}

/// A target bounded from above.
fn at_most(name: &'static str, bound: f64, asks: &'static str, measured: Option<f64>) -> Target {
    Target { name, asks, bound, at_least: false, measured }
}

/// One bounded from below.
fn at_least(name: &'static str, bound: f64, asks: &'static str, measured: Option<f64>) -> Target {
    Target { name, asks, bound, at_least: true, measured }
}

/// Every target, with what a report measured of it.
pub fn of(report: &Report) -> Vec<Target> {
    let step = kernel(report, 16, STEP);
    let reference = kernel(report, 16, REFERENCE);
    let over = step.zip(reference).map(|(step, reference)| reference.cost / step.cost);
    let first_tenth = |n| case(report, n, 0.1).map(Case::nanoseconds);
    let whole = case(report, 8, 1.5);
    vec![
        at_most(
            "membrane_update_n16",
            8.0,
            "ns per element and step of membrane, gas and update, n 16",
            step.map(|row| row.cost),
        ),
        at_least(
            "membrane_over_reference_n16",
            2.5,
            "the plain scalar reference over the same",
            over,
        ),
        at_most(
            "whole_first_tenth_n8",
            40.0,
            "ns per element and step over the first 0.1 s, contact on, n 8",
            first_tenth(8),
        ),
        at_most("whole_first_tenth_n16", 40.0, "the same, n 16", first_tenth(16)),
        at_most(
            "whole_case_n8",
            20.0,
            "ns per element and step over the 1.5 s case, n 8",
            whole.map(Case::nanoseconds),
        ),
        at_most(
            "whole_case_n8_seconds",
            20.0,
            "wall seconds of the 1.5 s case on one core, n 8",
            whole.map(|case| case.wall_seconds),
        ),
        at_most(
            "whole_case_n16_03",
            50.0,
            "wall seconds of 0.3 s on one core, n 16",
            case(report, 16, 0.3).map(|case| case.wall_seconds),
        ),
        at_least(
            "jobs",
            1.5,
            "jobs per hour of the 64-job study on two cores, over twice those of one job on one core",
            jobs(report),
        ),
        at_most(
            "linear",
            1.5,
            "largest over smallest cost per element and step from n 5 to n 32, over the first 5 ms",
            linear(report),
        ),
    ]
}

/// A kernel on the instruction set in use; of the reference its only one.
fn kernel<'a>(report: &'a Report, subdivisions: u32, name: &str) -> Option<&'a KernelRow> {
    let own = |row: &&KernelRow| {
        let path = row.path == report.machine.path || name == REFERENCE;
        row.subdivisions == subdivisions && row.kernel == name && path
    };
    report.kernels.iter().find(own)
}

fn case(report: &Report, subdivisions: u32, end_time: f64) -> Option<&Case> {
    let same =
        |case: &&Case| case.subdivisions == subdivisions && (case.end_time - end_time).abs() < 1e-9;
    report.cases.iter().find(same)
}

/// What two threads gain of the two they could, each with a job of its own; a quick bench's jobs are
/// too short to tell.
fn jobs(report: &Report) -> Option<f64> {
    let per_hour = |threads: u32| {
        let row = report.jobs.iter().find(|row| row.threads == threads)?;
        (report.effort != Effort::Quick).then(|| row.per_hour())
    };
    Some(per_hour(2)? / (2.0 * per_hour(1)?))
}

/// Largest over smallest cost on the same way of the film, where both ends were measured. The same
/// number of steps would not do: of a coarse mesh they reach farther, where more is near.
fn linear(report: &Report) -> Option<f64> {
    let costs: Vec<f64> =
        (5..=32).filter_map(|n| case(report, n, EARLY)).map(Case::nanoseconds).collect();
    case(report, 5, EARLY).and(case(report, 32, EARLY))?;
    let largest = costs.iter().copied().fold(0.0, f64::max);
    Some(largest / costs.iter().copied().fold(f64::INFINITY, f64::min))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::jobs::JobsRow;
    use billow_solver::platform::simd::InstructionSet;

    fn early(subdivisions: u32, nanoseconds: f64) -> Case {
        Case {
            subdivisions,
            end_time: EARLY,
            elements: 1000,
            steps: 1000,
            wall_seconds: 1e-3 * nanoseconds,
            core_seconds: None,
            ledger_residual: 0.0,
            passages: Some(0),
            peak_memory: None,
        }
    }

    fn named<'a>(targets: &'a [Target], name: &str) -> &'a Target {
        targets.iter().find(|target| target.name == name).expect("a target of that name")
    }

    #[test]
    fn nothing_measured_is_nothing_met() {
        let report = Report::empty(Effort::Usual, InstructionSet::Scalar);
        assert!(of(&report).iter().all(|target| target.met().is_none()));
        assert!(!report.targets_met());
    }

    #[test]
    fn bounds_hold_from_their_side() {
        let mut report = Report::empty(Effort::Usual, InstructionSet::Avx2);
        let row = |kernel, path, cost| KernelRow { subdivisions: 16, kernel, path, cost };
        report.kernels = vec![
            row(STEP, InstructionSet::Scalar, 30.0),
            row(STEP, InstructionSet::Avx2, 8.0),
            row(REFERENCE, InstructionSet::Scalar, 16.0),
        ];
        report.cases = vec![early(5, 50.0), early(8, 40.0), early(32, 30.0)];
        let targets = of(&report);
        assert_eq!(named(&targets, "membrane_update_n16").met(), Some(true));
        let over = named(&targets, "membrane_over_reference_n16");
        assert_eq!((over.measured, over.met()), (Some(2.0), Some(false)));
        assert_eq!(named(&targets, "linear").met(), Some(false));
        report.cases[0].wall_seconds = 0.04;
        assert_eq!(named(&of(&report), "linear").met(), Some(true));
        report.cases.remove(0);
        assert_eq!(named(&of(&report), "linear").met(), None, "n 5 was not measured");
        assert!(!report.targets_met());
    }

    #[test]
    fn jobs_are_held_against_a_job_a_core() {
        let mut report = Report::empty(Effort::Usual, InstructionSet::Scalar);
        let row = |threads, wall_seconds| JobsRow {
            threads,
            jobs: 64,
            done: 64,
            subdivisions: 4,
            end_time: 0.04,
            wall_seconds,
        };
        report.jobs = vec![row(1, 12.0)];
        assert_eq!(named(&of(&report), "jobs").measured, None, "two threads were not measured");
        report.jobs.push(row(2, 8.0));
        let targets = of(&report);
        assert_eq!(
            (named(&targets, "jobs").measured, named(&targets, "jobs").met()),
            (Some(0.75), Some(false))
        );
        report.effort = Effort::Quick;
        assert_eq!(named(&of(&report), "jobs").measured, None);
    }
}
