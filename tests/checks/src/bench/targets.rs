//! Speed goals of the project, and whether they are met. An unmeasured target is not met.

use billow_solver::platform::simd::InstructionSet;
use billow_study::input::value::Value;

use super::{EARLY, Row, Tables, cell, number};

/// Simulated time of a whole case of quiet filling, s.
const WHOLE_QUIET_CASE: f64 = 12.0;

/// The bound of a target.
#[derive(Clone, Copy)]
enum Bound {
    AtMost(f64),
    AtLeast(f64),
}
use Bound::{AtLeast, AtMost};

/// What was measured, and on which instruction set.
struct Measured<'a> {
    tables: &'a Tables,
    set: InstructionSet,
}

/// A target: its name, its bound, how it is measured, what it is in words.
type Target = (&'static str, Bound, fn(&Measured<'_>) -> Option<f64>, &'static str);

/// Every target.
#[rustfmt::skip]
const TARGETS: [Target; 12] = [
    ("step_without_contact_n16", AtMost(8.0), |of| of.kernel("step", of.set),
        "ns per element and step without contact, n 16"),
    ("speedup_over_reference_n16", AtLeast(2.5), |of| of.over_reference(),
        "step of the scalar reference over the step without contact, n 16"),
    ("step_to_100_ms_n8", AtMost(30.0), |of| of.cost(8, 0.1),
        "ns per element and step to 0.1 s with contact, n 8"),
    ("step_to_100_ms_n16", AtMost(30.0), |of| of.cost(16, 0.1),
        "ns per element and step to 0.1 s with contact, n 16"),
    ("step_to_1500_ms_n8", AtMost(20.0), |of| of.cost(8, 1.5),
        "ns per element and step to 1.5 s with contact, n 8"),
    ("seconds_to_1500_ms_n8", AtMost(20.0), |of| of.case(8, 1.5, "wall_seconds"),
        "wall time to 1.5 s on one core, n 8, s"),
    ("seconds_to_300_ms_n16", AtMost(50.0), |of| of.case(16, 0.3, "wall_seconds"),
        "wall time to 0.3 s on one core, n 16, s"),
    ("hybrid_delayed_n8", AtLeast(2.0), |of| of.hybrid("delayed", 8),
        "wall time of explicit over that of hybrid, delayed filling, 12 s, n 8 (aim 4)"),
    ("hybrid_preinflate_n8", AtLeast(2.0), |of| of.hybrid("preinflate", 8),
        "wall time of explicit over that of hybrid, preinflated filling, 12 s, n 8 (aim 4)"),
    ("hybrid_delayed_n16", AtLeast(2.0), |of| of.hybrid("delayed", 16),
        "wall time of explicit over that of hybrid, delayed filling, 12 s, n 16 (aim 4)"),
    ("hybrid_preinflate_n16", AtLeast(2.0), |of| of.hybrid("preinflate", 16),
        "wall time of explicit over that of hybrid, preinflated filling, 12 s, n 16 (aim 4)"),
    ("mesh_scaling", AtMost(1.5), |of| of.mesh_scaling(),
        "largest over smallest cost per element and step to 5 ms, n 5 to n 32"),
];

/// A row for each target.
pub(super) fn rows(tables: &Tables, set: InstructionSet) -> Vec<Row> {
    let measured = Measured { tables, set };
    let row = |(name, bound, measure, meaning): &Target| {
        let value = measure(&measured);
        let (required, bound, met) = match *bound {
            AtMost(bound) => ("at most", bound, value.map(|value| value <= bound)),
            AtLeast(bound) => ("at least", bound, value.map(|value| value >= bound)),
        };
        vec![
            ("target", (*name).into()),
            ("required", required.into()),
            ("bound", bound.into()),
            ("measured", value.into()),
            ("met", met.into()),
            ("meaning", (*meaning).into()),
        ]
    };
    TARGETS.iter().map(row).collect()
}

impl Measured<'_> {
    /// The column of the first row of a part in which these columns have these values.
    fn find(&self, part: &str, column: &str, of: &[(&str, Value)]) -> Option<f64> {
        let rows = &self.tables.iter().find(|(name, _)| *name == part)?.1;
        let is_it = |row: &&Row| of.iter().all(|(name, value)| cell(row, name) == Some(value));
        number(cell(rows.iter().find(is_it)?, column)?)
    }

    fn kernel(&self, kernel: &str, set: InstructionSet) -> Option<f64> {
        let of = [("subdivisions", 16_u32.into()), ("kernel", kernel.into())];
        let of = of.into_iter().chain([("instruction_set", set.name().into())]);
        self.find("kernels", "ns_per_element_step", &of.collect::<Vec<_>>())
    }

    fn over_reference(&self) -> Option<f64> {
        let reference = self.kernel("reference", InstructionSet::Scalar)?;
        Some(reference / self.kernel("step", self.set)?)
    }

    fn case(&self, subdivisions: u32, end_time: f64, column: &str) -> Option<f64> {
        let of = [("subdivisions", subdivisions.into()), ("end_time", end_time.into())];
        self.find("cases", column, &of)
    }

    fn cost(&self, subdivisions: u32, end_time: f64) -> Option<f64> {
        self.case(subdivisions, end_time, "ns_per_element_step")
    }

    /// Wall time of explicit over that of hybrid in a whole case of quiet filling.
    fn hybrid(&self, strategy: &str, subdivisions: u32) -> Option<f64> {
        let of = [
            ("subdivisions", subdivisions.into()),
            ("strategy", strategy.into()),
            ("integrator", "hybrid".into()),
            ("end_time", WHOLE_QUIET_CASE.into()),
        ];
        self.find("hybrid", "speedup", &of)
    }

    /// Largest over smallest cost to the same simulated time, if n 5 and n 32 were measured. The same
    /// number of steps is no basis: a coarse mesh gets farther with them and has more contacts.
    fn mesh_scaling(&self) -> Option<f64> {
        let (first, last) = (self.cost(5, EARLY)?, self.cost(32, EARLY)?);
        let between = (6..32).filter_map(|n| self.cost(n, EARLY));
        let costs: Vec<f64> = between.chain([first, last]).collect();
        let largest = costs.iter().copied().fold(first, f64::max);
        Some(largest / costs.iter().copied().fold(first, f64::min))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tables(kernels: &[(&'static str, f64)], cases: &[(u32, f64)], hybrid: f64) -> Tables {
        let kernel = |(kernel, cost): &(&'static str, f64)| -> Row {
            vec![
                ("subdivisions", 16_u32.into()),
                ("kernel", (*kernel).into()),
                ("instruction_set", "scalar".into()),
                ("ns_per_element_step", (*cost).into()),
            ]
        };
        let case = |(n, cost): &(u32, f64)| -> Row {
            vec![
                ("subdivisions", (*n).into()),
                ("end_time", EARLY.into()),
                ("ns_per_element_step", (*cost).into()),
            ]
        };
        let quiet = |end_time: f64| -> Row {
            vec![
                ("subdivisions", 8_u32.into()),
                ("strategy", "delayed".into()),
                ("integrator", "hybrid".into()),
                ("end_time", end_time.into()),
                ("speedup", 1.5.into()),
            ]
        };
        vec![
            ("kernels", kernels.iter().map(kernel).collect()),
            ("cases", cases.iter().map(case).collect()),
            ("hybrid", vec![quiet(hybrid)]),
        ]
    }

    /// What was measured of a target, and whether it is met.
    fn found(tables: &Tables, name: &str) -> [Value; 2] {
        let rows = rows(tables, InstructionSet::Scalar);
        let row = rows.iter().find(|row| cell(row, "target") == Some(&name.into())).unwrap();
        ["measured", "met"].map(|column| cell(row, column).unwrap().clone())
    }

    #[test]
    fn minima_and_maxima_bound_from_their_side_and_what_is_missing_is_not_met() {
        let kernels = [("step", 8.0), ("reference", 16.0)];
        let all = tables(&kernels, &[(5, 50.0), (8, 40.0), (32, 30.0)], 12.0);
        let expected = [
            ("step_without_contact_n16", Some(8.0), Some(true)),
            ("speedup_over_reference_n16", Some(2.0), Some(false)),
            ("mesh_scaling", Some(50.0 / 30.0), Some(false)),
            ("hybrid_delayed_n8", Some(1.5), Some(false)),
            ("hybrid_preinflate_n8", None, None),
            ("step_to_100_ms_n8", None, None),
        ];
        for (name, measured, met) in expected {
            assert_eq!(found(&all, name), [measured.into(), met.into()], "{name}");
        }
        let few = tables(&kernels[..1], &[(8, 40.0), (32, 39.0)], 0.5);
        for name in ["speedup_over_reference_n16", "mesh_scaling", "hybrid_delayed_n8"] {
            assert_eq!(found(&few, name), [Value::Null, Value::Null], "{name}");
        }
    }
}
