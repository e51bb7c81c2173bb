//! Pairs compared with counting, for any table.

use proptest::prelude::*;

use super::*;
use crate::analysis::fixture::{self, all};

/// A table of parameters `a`, `b` and a measure.
pub(super) fn table(rows: &[(i64, f64, &str, Option<f64>)]) -> Table {
    let lines = rows.iter().enumerate().map(|(job, (a, b, status, value))| {
        let value = value.map_or("-".to_owned(), |value| format!("{value:?}"));
        format!("{job} {a} {b:?} {status} {value}")
    });
    let mut table = fixture::table_of("job a b status peak_vz", lines);
    // Also of rows without a value.
    table.columns[4].cell_type = CellType::Number;
    table
}

fn given(table: &Table, tie: f64) -> Measure<'_> {
    Measure::of_runs(table.column("peak_vz").unwrap(), Tolerance::given(tie))
}

fn betters(table: &Table, base: i64, tie: f64) -> Vec<Better> {
    let sets = Sets::new(table, &all(table), "a", &[]);
    let (pairs, _) = pairs(table, &sets, "a", &Value::Integer(base));
    pairs.iter().map(|pair| compared(table, *pair, &given(table, tie)).better).collect()
}

#[test]
fn every_outcome_is_given_and_none_is_ignored() {
    let table = table(&[
        (1, 1.0, "done", Some(2.0)),
        (2, 1.0, "done", Some(1.0)),
        (3, 1.0, "done", Some(2.0 + 1e-12)),
        (4, 1.0, "unstable", Some(0.1)),
        (5, 1.0, "done", None),
        (6, 1.0, "pending", None),
        (1, 2.0, "infeasible", None),
        (2, 2.0, "done", Some(1.0)),
        (3, 2.0, "energy_drift", None),
        (9, 3.0, "done", Some(1.0)),
    ]);
    assert_eq!(
        betters(&table, 1, ROUNDING),
        [
            Better::Other,
            Better::Tie,
            Better::OnlyBase,
            Better::OnlyBase,
            Better::Pending,
            Better::OnlyOther,
            Better::Neither,
        ],
        "a failed job has no measures"
    );
    assert_eq!(betters(&table, 1, 0.6)[0], Better::Tie);
    let sets = Sets::new(&table, &all(&table), "a", &[]);
    assert_eq!(pairs(&table, &sets, "a", &Value::Integer(1)).1, [9], "no partner");
    let (pairs, _) = pairs(&table, &sets, "a", &Value::Number(1.0));
    assert_eq!(pairs.len(), 7, "1 is 1.0");
    let tallies = tallies(&table, &pairs, "a", &[given(&table, ROUNDING)]);
    assert_eq!(tallies.len(), 5);
    assert_eq!((tallies[0].pairs(), tallies[0].count(Better::Other)), (2, 1));
    assert_eq!(tallies[0].ratio.unwrap().median.to_bits(), 0.5_f64.to_bits());
    assert_eq!((tallies[4].pairs(), tallies[4].count(Better::Pending)), (0, 1));
}

#[test]
fn the_better_side_is_that_of_the_column() {
    let judged = |name: &str, tolerance: Tolerance, base: f64, other: f64| {
        let column = Column::plain(name, CellType::Number, Vec::new());
        judge(&Measure::of_runs(&column, tolerance), [base; 3], [other; 3])
    };
    let exact = Tolerance::given(ROUNDING);
    assert_eq!(judged("height_ratio", exact, 0.9, 1.0), Better::Other);
    assert_eq!(judged("t_90_z_rim", exact, 0.9, 1.0), Better::Base);
    assert_eq!(judged("final_pressure", exact, 0.9, 1.0), Better::Higher);
    assert_eq!(judged("overshoot", exact, 0.0, -0.0), Better::Tie);
    let infinite = [f64::INFINITY; 2];
    assert_eq!(judged("t_90_z_rim", exact, infinite[0], infinite[1]), Better::Tie);
}

#[test]
fn a_signed_measure_has_differences_and_no_ratio() {
    let mut table = table(&[(1, 1.0, "done", Some(-0.01)), (2, 1.0, "done", Some(0.03))]);
    table.columns[4].name = "overshoot".to_owned();
    let measure = Measure::of_runs(table.column("overshoot").unwrap(), Tolerance::given(0.0));
    let pair = Pair { base: 0, other: 1 };
    let compared = compared(&table, pair, &measure);
    assert_eq!((compared.ratio(), compared.difference()), (None, Some(0.04)));
    let tally = &tallies(&table, &[pair], "a", &[measure])[0];
    assert!(tally.ratio.is_none() && tally.difference.is_some());
}

#[test]
fn two_pairs_of_the_same_jobs_count_once_and_one_job_is_no_pair() {
    let mut table = table(&[
        (1, 1.0, "done", Some(1.0)),
        (2, 1.0, "done", Some(2.0)),
        (1, 2.0, "done", Some(1.0)),
        (2, 2.0, "done", Some(2.0)),
        (1, 3.0, "done", Some(5.0)),
        (2, 3.0, "done", Some(5.0)),
    ]);
    let jobs = ["x", "y", "x", "y", "z", "z"];
    table.columns[0].cells = jobs.map(|job| Value::Text(job.to_owned())).to_vec().into();
    assert_eq!(betters(&table, 1, 0.0), [Better::Base, Better::Base, Better::SameJob]);
    let sets = Sets::new(&table, &all(&table), "a", &[]);
    let (pairs, _) = pairs(&table, &sets, "a", &Value::Integer(1));
    assert_eq!(pairs_of_jobs(&table, &pairs).len(), 2);
    let tally = &tallies(&table, &pairs, "a", &[given(&table, 0.0)])[0];
    let counts = (tally.pairs(), tally.count(Better::Base), tally.count(Better::SameJob));
    assert_eq!(counts, (1, 1, 1));
}

#[test]
fn a_function_of_the_compared_parameter_is_not_matched() {
    let zipped = |steps: &[(i64, f64)]| {
        let steps = steps.iter().map(|(a, b)| (Value::Integer(*a), Value::Number(*b))).collect();
        [Zipped { name: "b".to_owned(), steps }]
    };
    // b is 0 with a = 1 and 5 with a = 2: never equal, yet one pair.
    let followed = table(&[(1, 0.0, "done", Some(1.0)), (2, 5.0, "done", Some(2.0))]);
    let axis = zipped(&[(1, 0.0), (2, 5.0)]);
    let sets = Sets::new(&followed, &[0, 1], "a", &axis);
    assert_eq!((sets.carried, sets.sets.len()), (vec!["b".to_owned()], 1));
    // On another axis it is matched.
    assert_eq!(Sets::new(&followed, &[0, 1], "a", &[]).sets.len(), 2);
    // Zipped, but not a function of it: matched, too.
    let free = table(&[
        (1, 0.0, "done", Some(1.0)),
        (1, 5.0, "done", Some(1.0)),
        (2, 5.0, "done", Some(2.0)),
    ]);
    let free_axis = zipped(&[(1, 0.0), (1, 5.0), (2, 5.0)]);
    assert!(Sets::new(&free, &[0, 1, 2], "a", &free_axis).carried.is_empty());
    // A single point that leaves the axis does not undo it: only that point is matched.
    let sets = Sets::new(&free, &[0, 1, 2], "a", &axis);
    assert_eq!(sets.sets, [vec![0, 2], vec![1]]);
}

/// Rows of an incomplete grid, with any outcome.
fn any_rows() -> impl Strategy<Value = Vec<(i64, f64, &'static str, Option<f64>)>> {
    let cell = (0..4_u8, prop::option::of(0.5..2.0_f64), any::<bool>());
    prop::collection::vec(cell, 16).prop_map(|cells| {
        let points = (0..4_i64).flat_map(|a| (0..4_u8).map(move |b| (a, f64::from(b))));
        let rows = points.zip(cells).filter(|(_, (_, _, kept))| *kept);
        rows.map(|((a, b), (status, value, _))| {
            (a, b, ["done", "done", "unstable", "pending"][usize::from(status)], value)
        })
        .collect()
    })
}

proptest! {
    #[test]
    fn every_row_is_in_one_set_and_paired_when_it_has_a_partner(rows in any_rows(), base in 0..4_i64) {
        let table = table(&rows);
        let sets = Sets::new(&table, &all(&table), "a", &[]);
        let mut sorted: Vec<usize> = sets.sets.concat();
        sorted.sort_unstable();
        prop_assert_eq!(sorted, all(&table), "every row is in one set");
        let (pairs, alone) = pairs(&table, &sets, "a", &Value::Integer(base));
        for row in all(&table) {
            let as_other = pairs.iter().filter(|pair| pair.other == row).count();
            let as_base = pairs.iter().any(|pair| pair.base == row);
            let is_alone = alone.contains(&row);
            let (is_base, b) = (rows[row].0 == base, rows[row].1);
            prop_assert_eq!(usize::from(is_alone) + as_other + usize::from(as_base), 1);
            // A row is paired exactly when a partner with equal b exists.
            let partner = rows.iter().any(|other| other.1.to_bits() == b.to_bits()
                && (other.0 == base) != is_base);
            prop_assert_eq!(partner, !is_alone);
            prop_assert!(!is_base || as_other == 0);
        }
        for pair in &pairs {
            prop_assert_eq!(rows[pair.base].1.to_bits(), rows[pair.other].1.to_bits());
        }
    }

    #[test]
    fn exchanged_sides_give_the_opposite_result(rows in any_rows(), first in 0..4_i64, second in 0..4_i64) {
        prop_assume!(first != second);
        let table = table(&rows);
        let only: Vec<usize> =
            all(&table).into_iter().filter(|row| [first, second].contains(&rows[*row].0)).collect();
        let sets = Sets::new(&table, &only, "a", &[]);
        let (forward, alone) = pairs(&table, &sets, "a", &Value::Integer(first));
        let (backward, alone_backward) = pairs(&table, &sets, "a", &Value::Integer(second));
        prop_assert_eq!(alone, alone_backward);
        prop_assert_eq!(forward.len(), backward.len());
        for (forward, backward) in forward.iter().zip(&backward) {
            prop_assert_eq!((forward.base, forward.other), (backward.other, backward.base));
            let forward = compared(&table, *forward, &given(&table, 0.1));
            let backward = compared(&table, *backward, &given(&table, 0.1));
            prop_assert_eq!(forward.better.exchanged(), backward.better);
            prop_assert_eq!(forward.difference(), backward.difference().map(|x| -x));
        }
    }

    /// The tally compared with counting.
    #[test]
    fn a_tally_counts_every_pair(rows in any_rows()) {
        let table = table(&rows);
        let sets = Sets::new(&table, &all(&table), "a", &[]);
        let (pairs, _) = pairs(&table, &sets, "a", &Value::Integer(0));
        let tallies = tallies(&table, &pairs, "a", &[given(&table, ROUNDING)]);
        let counted: usize =
            tallies.iter().map(|tally| tally.pairs() + tally.count(Better::Pending)).sum();
        prop_assert_eq!(counted, pairs.len());
        for tally in tallies {
            let Value::Integer(value) = tally.value else { panic!() };
            let value_of = |a: i64, b: f64| {
                rows.iter().find(|row| row.0 == a && row.1.to_bits() == b.to_bits())
                    .and_then(|row| row.3.filter(|_| row.2 == "done"))
            };
            let mut won = 0;
            for b in 0..4 {
                let b = f64::from(b);
                if let (Some(base), Some(other)) = (value_of(0, b), value_of(value, b)) {
                    won += usize::from(other < base * (1.0 - 1e-8));
                }
            }
            prop_assert_eq!(tally.count(Better::Other), won);
        }
    }
}
