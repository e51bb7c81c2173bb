//! Speed goals of the project, and whether a report meets them. An unmeasured target is not met.

use super::capsule::Case;
use super::kernels::{KernelRow, REFERENCE, STEP};
use super::{EARLY, Line, Report};
use billow_study::input::value::Value;

/// Simulated time of a whole case of quiet filling, s.
const WHOLE_QUIET_CASE: f64 = 12.0;

/// A target.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Its name.
    pub name: &'static str,
    /// What is measured, in words.
    pub meaning: &'static str,
    /// Its bound.
    pub bound: f64,
    /// Whether the bound is a minimum; otherwise it is a maximum.
    pub at_least: bool,
    /// Measured value.
    pub measured: Option<f64>,
}

impl Target {
    /// Whether it is met; `None` if it was not measured.
    pub fn met(&self) -> Option<bool> {
        let holds = |value: f64| {
            if self.at_least { value >= self.bound } else { value <= self.bound }
        };
        self.measured.map(holds)
    }

    /// As a row of the report.
    pub fn line(&self) -> Line {
        let sign = if self.at_least { "at least" } else { "at most" };
        vec![
            ("target", Value::Text(self.name.to_owned())),
            ("required", Value::Text(sign.to_owned())),
            ("bound", Value::Number(self.bound)),
            ("measured", self.measured.map_or(Value::Null, Value::Number)),
            ("met", self.met().map_or(Value::Null, Value::Bool)),
            ("meaning", Value::Text(self.meaning.to_owned())),
        ]
    }
}

/// A target with a maximum.
fn at_most(name: &'static str, bound: f64, meaning: &'static str, measured: Option<f64>) -> Target {
    Target { name, meaning, bound, at_least: false, measured }
}

/// A target with a minimum.
fn at_least(
    name: &'static str,
    bound: f64,
    meaning: &'static str,
    measured: Option<f64>,
) -> Target {
    Target { name, meaning, bound, at_least: true, measured }
}

/// Every target with its measurement in a report.
pub fn of(report: &Report) -> Vec<Target> {
    let step = kernel(report, 16, STEP);
    let reference = kernel(report, 16, REFERENCE);
    let over = step.zip(reference).map(|(step, reference)| reference.cost / step.cost);
    let to_100_ms = |n| case(report, n, 0.1).map(Case::nanoseconds);
    let whole = case(report, 8, 1.5);
    vec![
        at_most(
            "step_without_contact_n16",
            8.0,
            "ns per element and step without contact, n 16",
            step.map(|row| row.cost),
        ),
        at_least(
            "speedup_over_reference_n16",
            2.5,
            "time of the plain scalar reference over that of the step without contact, n 16",
            over,
        ),
        at_most(
            "step_to_100_ms_n8",
            30.0,
            "ns per element and step to 0.1 s with contact, n 8",
            to_100_ms(8),
        ),
        at_most(
            "step_to_100_ms_n16",
            30.0,
            "ns per element and step to 0.1 s with contact, n 16",
            to_100_ms(16),
        ),
        at_most(
            "step_to_1500_ms_n8",
            20.0,
            "ns per element and step to 1.5 s with contact, n 8",
            whole.map(Case::nanoseconds),
        ),
        at_most(
            "seconds_to_1500_ms_n8",
            20.0,
            "wall time to 1.5 s on one core, n 8, s",
            whole.map(|case| case.wall_seconds),
        ),
        at_most(
            "seconds_to_300_ms_n16",
            50.0,
            "wall time to 0.3 s on one core, n 16, s",
            case(report, 16, 0.3).map(|case| case.wall_seconds),
        ),
        at_least(
            "hybrid_delayed_n8",
            2.0,
            "wall time of explicit over that of hybrid, delayed filling, 12 s, n 8 (aim 4)",
            speedup(report, "delayed", 8),
        ),
        at_least(
            "hybrid_preinflate_n8",
            2.0,
            "wall time of explicit over that of hybrid, preinflated filling, 12 s, n 8 (aim 4)",
            speedup(report, "preinflate", 8),
        ),
        at_least(
            "hybrid_delayed_n16",
            2.0,
            "wall time of explicit over that of hybrid, delayed filling, 12 s, n 16 (aim 4)",
            speedup(report, "delayed", 16),
        ),
        at_least(
            "hybrid_preinflate_n16",
            2.0,
            "wall time of explicit over that of hybrid, preinflated filling, 12 s, n 16 (aim 4)",
            speedup(report, "preinflate", 16),
        ),
        at_most(
            "mesh_scaling",
            1.5,
            "largest over smallest cost per element and step to 5 ms, n 5 to n 32",
            mesh_scaling(report),
        ),
    ]
}

/// A kernel with the instruction set in use; the reference has only one.
fn kernel<'a>(report: &'a Report, subdivisions: u32, name: &str) -> Option<&'a KernelRow> {
    let matches = |row: &&KernelRow| {
        let in_use = row.instruction_set == report.machine.instruction_set || name == REFERENCE;
        row.subdivisions == subdivisions && row.kernel == name && in_use
    };
    report.kernels.iter().find(matches)
}

fn case(report: &Report, subdivisions: u32, end_time: f64) -> Option<&Case> {
    let same =
        |case: &&Case| case.subdivisions == subdivisions && (case.end_time - end_time).abs() < 1e-9;
    report.cases.iter().find(same)
}

/// Wall time of explicit over that of hybrid in a whole case of quiet filling.
fn speedup(report: &Report, strategy: &str, subdivisions: u32) -> Option<f64> {
    let whole = report.hybrid.iter().filter(|row| row.end_time >= WHOLE_QUIET_CASE);
    whole
        .filter(|row| row.strategy == strategy && row.subdivisions == subdivisions)
        .find_map(|row| row.speedup)
}

/// Largest over smallest cost to the same simulated time, if n 5 and n 32 were measured. The same
/// number of steps is no basis: a coarse mesh gets farther with them and has more contacts.
fn mesh_scaling(report: &Report) -> Option<f64> {
    let costs: Vec<f64> =
        (5..=32).filter_map(|n| case(report, n, EARLY)).map(Case::nanoseconds).collect();
    case(report, 5, EARLY).and(case(report, 32, EARLY))?;
    let largest = costs.iter().copied().fold(0.0, f64::max);
    Some(largest / costs.iter().copied().fold(f64::INFINITY, f64::min))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::Effort;
    use crate::bench::quiet_filling::QuietRow;
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
        targets.iter().find(|target| target.name == name).expect("a target with that name")
    }

    #[test]
    fn an_unmeasured_target_is_not_met() {
        let report = Report::empty(Effort::Usual, InstructionSet::Scalar);
        assert!(of(&report).iter().all(|target| target.met().is_none()));
        assert!(!report.targets_met());
    }

    #[test]
    fn minima_and_maxima_bound_from_their_side() {
        let mut report = Report::empty(Effort::Usual, InstructionSet::Avx2);
        let row = |kernel, instruction_set, cost| KernelRow {
            subdivisions: 16,
            kernel,
            instruction_set,
            cost,
        };
        report.kernels = vec![
            row(STEP, InstructionSet::Scalar, 30.0),
            row(STEP, InstructionSet::Avx2, 8.0),
            row(REFERENCE, InstructionSet::Scalar, 16.0),
        ];
        report.cases = vec![early(5, 50.0), early(8, 40.0), early(32, 30.0)];
        let targets = of(&report);
        assert_eq!(named(&targets, "step_without_contact_n16").met(), Some(true));
        let over = named(&targets, "speedup_over_reference_n16");
        assert_eq!((over.measured, over.met()), (Some(2.0), Some(false)));
        assert_eq!(named(&targets, "mesh_scaling").met(), Some(false));
        report.cases[0].wall_seconds = 0.04;
        assert_eq!(named(&of(&report), "mesh_scaling").met(), Some(true));
        report.cases.remove(0);
        assert_eq!(named(&of(&report), "mesh_scaling").met(), None, "n 5 was not measured");
        assert!(!report.targets_met());
    }

    #[test]
    fn a_speedup_is_that_of_the_whole_case_on_its_mesh() {
        let mut report = Report::empty(Effort::Quick, InstructionSet::Scalar);
        let row = |integrator, end_time, speedup| QuietRow {
            subdivisions: 8,
            strategy: "delayed",
            integrator,
            end_time,
            elements: 3072,
            steps: 100,
            wall_seconds: 1.0,
            core_seconds: None,
            speedup,
            ledger_residual: 0.0,
            passages: Some(0),
            volume: 0.6,
        };
        report.hybrid = vec![row("explicit", 0.5, None), row("hybrid", 0.5, Some(3.0))];
        let measured = |report: &Report, name| named(&of(report), name).measured;
        assert_eq!(measured(&report, "hybrid_delayed_n8"), None, "a short run is no case");
        report.hybrid = vec![row("explicit", 12.0, None), row("hybrid", 12.0, Some(1.5))];
        assert_eq!(measured(&report, "hybrid_delayed_n8"), Some(1.5));
        assert_eq!(named(&of(&report), "hybrid_delayed_n8").met(), Some(false));
        for other in ["hybrid_preinflate_n8", "hybrid_delayed_n16", "hybrid_preinflate_n16"] {
            assert_eq!(measured(&report, other), None, "{other}");
        }
    }
}
