//! Pairs against plain counting, whatever the table.

use proptest::prelude::*;

use super::*;

fn column(name: &str, kind: Kind, cells: Vec<Value>) -> Column {
    Column { name: name.to_owned(), kind, unit: String::new(), meaning: String::new(), cells }
}

/// A table of parameters `a`, `b` and a measure.
fn table(rows: &[(i64, f64, &str, Option<f64>)]) -> Table {
    let text = |text: &str| Value::Text(text.to_owned());
    Table {
        columns: vec![
            column("job", Kind::Text, rows.iter().map(|_| text("x")).collect()),
            column("a", Kind::Integer, rows.iter().map(|row| Value::Integer(row.0)).collect()),
            column("b", Kind::Number, rows.iter().map(|row| Value::Number(row.1)).collect()),
            column("status", Kind::Text, rows.iter().map(|row| text(row.2)).collect()),
            column(
                "peak_vz",
                Kind::Number,
                rows.iter().map(|row| row.3.map_or(Value::Null, Value::Number)).collect(),
            ),
        ],
    }
}

fn all(table: &Table) -> Vec<usize> {
    (0..table.rows()).collect()
}

fn betters(table: &Table, base: i64, tie: f64) -> Vec<Better> {
    let sets = Sets::new(table, &all(table), "a", &[]);
    let (pairs, _) = pairs(table, &sets, "a", &Value::Integer(base));
    let measure = table.column("peak_vz").unwrap();
    pairs.iter().map(|pair| compared(table, *pair, measure, tie).better).collect()
}

#[test]
fn every_outcome_is_told_and_none_is_dropped() {
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
        betters(&table, 1, TIE),
        [
            Better::Other,
            Better::Tie,
            Better::OnlyBase,
            Better::OnlyBase,
            Better::Pending,
            Better::OnlyOther,
            Better::Neither,
        ],
        "a failed job's figures are none"
    );
    assert_eq!(betters(&table, 1, 0.6)[0], Better::Tie);
    let sets = Sets::new(&table, &all(&table), "a", &[]);
    assert_eq!(pairs(&table, &sets, "a", &Value::Integer(1)).1, [9], "no partner");
    let (pairs, _) = pairs(&table, &sets, "a", &Value::Number(1.0));
    assert_eq!(pairs.len(), 7, "1 is 1.0");
    let tallies = tallies(&table, &pairs, "a", &[table.column("peak_vz").unwrap()], TIE);
    assert_eq!(tallies.len(), 5);
    assert_eq!((tallies[0].pairs(), tallies[0].count(Better::Other)), (2, 1));
    assert_eq!(tallies[0].ratio.unwrap().median.to_bits(), 0.5_f64.to_bits());
    assert_eq!((tallies[4].pairs(), tallies[4].count(Better::Pending)), (0, 1));
}

#[test]
fn more_is_better_of_some_and_nothing_is_said_of_others() {
    assert_eq!(judge("height_ratio", 0.9, 1.0, TIE), Better::Other);
    assert_eq!(judge("t_90_z_rim", 0.9, 1.0, TIE), Better::Base);
    assert_eq!(judge("final_pressure", 0.9, 1.0, TIE), Better::Differ);
    assert_eq!(judge("overshoot", 0.0, -0.0, TIE), Better::Tie);
}

#[test]
fn what_follows_from_the_compared_parameter_changes_with_it() {
    // b is 0 with a = 1 and 5 with a = 2: never equal, yet one pair.
    let followed = table(&[(1, 0.0, "done", Some(1.0)), (2, 5.0, "done", Some(2.0))]);
    let sets = Sets::new(&followed, &[0, 1], "a", &["b".to_owned()]);
    assert_eq!((sets.carried, sets.sets.len()), (vec!["b".to_owned()], 1));
    // On an axis of its own it is matched.
    assert_eq!(Sets::new(&followed, &[0, 1], "a", &[]).sets.len(), 2);
    // Zipped, but not decided by it: matched too.
    let free = table(&[
        (1, 0.0, "done", Some(1.0)),
        (1, 5.0, "done", Some(1.0)),
        (2, 5.0, "done", Some(2.0)),
    ]);
    assert!(Sets::new(&free, &[0, 1, 2], "a", &["b".to_owned()]).carried.is_empty());
}

/// Rows of a grid of which some are left out, with any outcome.
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
    fn every_row_stands_in_its_place_once(rows in any_rows(), base in 0..4_i64) {
        let table = table(&rows);
        let sets = Sets::new(&table, &all(&table), "a", &[]);
        let mut sorted: Vec<usize> = sets.sets.concat();
        sorted.sort_unstable();
        prop_assert_eq!(sorted, all(&table), "every row is in one set");
        let (pairs, alone) = pairs(&table, &sets, "a", &Value::Integer(base));
        for row in all(&table) {
            let as_other = pairs.iter().filter(|pair| pair.other == row).count();
            let as_base = pairs.iter().any(|pair| pair.base == row);
            let left = alone.contains(&row);
            let (is_base, b) = (rows[row].0 == base, rows[row].1);
            prop_assert_eq!(usize::from(left) + as_other + usize::from(as_base), 1);
            // Against the words: paired wherever a partner with equal b is there.
            let partner = rows.iter().any(|other| other.1.to_bits() == b.to_bits()
                && (other.0 == base) != is_base);
            prop_assert_eq!(partner, !left);
            prop_assert!(!is_base || as_other == 0);
        }
        for pair in &pairs {
            prop_assert_eq!(rows[pair.base].1.to_bits(), rows[pair.other].1.to_bits());
        }
    }

    #[test]
    fn turned_round_it_says_the_opposite(rows in any_rows(), one in 0..4_i64, two in 0..4_i64) {
        prop_assume!(one != two);
        let table = table(&rows);
        let only: Vec<usize> =
            all(&table).into_iter().filter(|row| [one, two].contains(&rows[*row].0)).collect();
        let sets = Sets::new(&table, &only, "a", &[]);
        let measure = table.column("peak_vz").unwrap();
        let (there, alone) = pairs(&table, &sets, "a", &Value::Integer(one));
        let (back, left) = pairs(&table, &sets, "a", &Value::Integer(two));
        prop_assert_eq!(alone, left);
        prop_assert_eq!(there.len(), back.len());
        for (there, back) in there.iter().zip(&back) {
            prop_assert_eq!((there.base, there.other), (back.other, back.base));
            let (there, back) =
                (compared(&table, *there, measure, 0.1), compared(&table, *back, measure, 0.1));
            prop_assert_eq!(there.better.turned(), back.better);
            prop_assert_eq!(there.difference(), back.difference().map(|own| -own));
        }
    }

    /// The tally against counting by hand.
    #[test]
    fn a_tally_counts_every_pair(rows in any_rows()) {
        let table = table(&rows);
        let sets = Sets::new(&table, &all(&table), "a", &[]);
        let (pairs, _) = pairs(&table, &sets, "a", &Value::Integer(0));
        let tallies = tallies(&table, &pairs, "a", &[table.column("peak_vz").unwrap()], TIE);
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
