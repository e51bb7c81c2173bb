//! Ties: the spread of the method, of seeds, of replicates, of margins.

use super::tests::table;
use super::*;
use crate::analysis::fixture::all;

#[test]
fn a_default_tie_is_the_larger_of_the_spreads_of_seed_and_method() {
    let mut table = table(&[
        (1, 1.0, "done", Some(10.0)),
        (2, 1.0, "done", Some(10.3)),
        (1, 2.0, "done", Some(10.0)),
        (2, 2.0, "done", Some(11.0)),
        (3, 2.0, "pending", None),
    ]);
    let of =
        |table: &Table| Tolerance::of(table, &all(table), table.column("peak_vz").unwrap(), &[]);
    let limit = |tolerance: Tolerance| (tolerance.limit, tolerance.source);
    assert_eq!(limit(of(&table)), (0.05, ToleranceSource::Method), "README: seeds differ by 5 %");
    table.columns[1].name = "seed".to_owned();
    assert_eq!(
        limit(of(&table)),
        (1.0 / 11.0, ToleranceSource::Seeds),
        "the largest over the sets"
    );
    table.columns[4].cells[3] = Value::Number(10.1);
    assert_eq!(limit(of(&table)), (0.05, ToleranceSource::Method));

    // No spread is known: lower, not better.
    table.columns[4].name = "ringing_rms".to_owned();
    table.columns[1].name = "a".to_owned();
    let column = table.column("ringing_rms").unwrap();
    let measure = Measure::of_runs(column, Tolerance::of(&table, &all(&table), column, &[]));
    assert_eq!(compared(&table, Pair { base: 0, other: 1 }, &measure).better, Better::Higher);
    assert_eq!(compared(&table, Pair { base: 1, other: 0 }, &measure).better, Better::Lower);
}

#[test]
fn replicates_give_a_tie_as_seeds_do() {
    let table = table(&[
        (1, 1.0, "done", Some(10.0)),
        (1, 2.0, "done", Some(10.3)),
        (2, 1.0, "done", Some(10.0)),
        (2, 2.0, "done", Some(12.0)),
    ]);
    let column = table.column("peak_vz").unwrap();
    let over = |replicates: &[&str]| {
        let names: Vec<String> = replicates.iter().map(|name| (*name).to_owned()).collect();
        Tolerance::over(&table, &all(&table), column, &names, &[])
    };
    assert_eq!(over(&[]), Tolerance::of(&table, &all(&table), column, &[]));
    let limit = |replicates: &[&str]| (over(replicates).limit, over(replicates).source);
    assert_eq!(limit(&["b"]), (2.0 / 12.0, ToleranceSource::Seeds));
    assert_eq!(limit(&["a", "b"]), (2.0 / 12.0, ToleranceSource::Seeds), "one set");
    assert_eq!(limit(&["absent"]), (0.05, ToleranceSource::Method));
}

#[test]
fn a_larger_margin_is_better_beyond_the_spread_of_its_measure() {
    let mut table = table(&[(1, 1.0, "done", Some(-0.02)), (2, 1.0, "done", Some(0.2))]);
    let of = ["peak_vz", "verdict"].map(|name| Value::Text(name.to_owned())).to_vec();
    table.columns.push(Column::plain("smallest_margin_of", CellType::Text, of));
    for (name, limit) in
        [("margin_peak_vz", 0.05), ("smallest_margin", 0.05), ("margin_verdict", ROUNDING)]
    {
        name.clone_into(&mut table.columns[4].name);
        let column = table.column(name).unwrap();
        let tolerance = Tolerance::of(&table, &all(&table), column, &[]);
        assert!(tolerance.absolute && tolerance.judges(), "{name}");
        assert_eq!(tolerance.limit.to_bits(), limit.to_bits(), "{name}");
        let compared =
            compared(&table, Pair { base: 0, other: 1 }, &Measure::of_runs(column, tolerance));
        assert_eq!((compared.better, compared.ratio()), (Better::Other, None), "{name}");
    }
    // The spread of ringing_rms is not known, so neither is that of its margin.
    "margin_ringing_rms".clone_into(&mut table.columns[4].name);
    let column = table.column("margin_ringing_rms").unwrap();
    assert!(!Tolerance::of(&table, &all(&table), column, &[]).judges());
}

#[test]
fn points_of_several_runs_are_equal_where_their_ranges_overlap_and_no_others() {
    // a: the points; b: the runs of each. The third point is chaotic, and overlaps the first two.
    let values = [[9.25, 9.3, 9.35], [29.4, 29.5, 29.7], [5.0, 20.0, 40.0]];
    let rows = (1_i64..).zip(values).flat_map(|(a, values)| {
        (1_u8..).zip(values).map(move |(b, value)| (a, f64::from(b), "done", Some(value)))
    });
    let mut table = table(&rows.collect::<Vec<_>>());
    for name in ["peak_vz", "ringing_rms"] {
        name.clone_into(&mut table.columns[4].name);
        let points = Condensed::of(&table, &all(&table), &["b".to_owned()]);
        let column = points.table.column(name).unwrap();
        let measure = Measure::of_points(&points, &[0, 1, 2], column, &[]);
        assert!(measure.tolerance.judges(), "{name}: the spread of the runs is known");
        let better = |base, other| compared(&points.table, Pair { base, other }, &measure).better;
        assert_eq!(better(0, 1), Better::Base, "{name}: a chaotic point makes no others equal");
        assert_eq!([better(0, 2), better(1, 2)], [Better::Tie; 2], "{name}");
        // Single runs: the widest point decides for all.
        let over = Tolerance::over(&table, &all(&table), &table.columns[4], &["b".to_owned()], &[]);
        assert!(over.is_tie(9.3, 29.5) && !measure.tolerance.is_tie(9.3, 29.5));
    }
}

#[test]
fn a_difference_below_the_mesh_error_of_either_value_is_a_tie() {
    let mut table = table(&[
        (1, 1.0, "done", Some(10.0)),
        (2, 1.0, "done", Some(10.4)),
        (3, 1.0, "done", Some(10.4)),
        (4, 1.0, "done", Some(10.4)),
    ]);
    // The side that faces away from the other value does not count.
    for (name, errors) in
        [("peak_vz_error_below", [0.05, 0.3, 0.5]), ("peak_vz_error_above", [0.1, 0.2, 0.2])]
    {
        let errors = errors.map(Value::Number).into_iter().chain([Value::Null]).collect();
        table.columns.push(Column::plain(name, CellType::Number, errors));
    }
    let measure = table.column("peak_vz").unwrap();
    let tolerance = Tolerance::of(&table, &all(&table), measure, &[]);
    assert_eq!(tolerance.source, ToleranceSource::MeshError);
    assert!((tolerance.limit - 0.3 / 10.4).abs() < 1e-12, "the median");
    let measure = Measure::of_runs(measure, tolerance).with_errors(&table);
    let better = |other| compared(&table, Pair { base: 0, other }, &measure).better;
    assert_eq!(better(1), Better::Base, "0.4 is above 0.1 and 0.3");
    assert_eq!(better(2), Better::Tie, "the larger error of the pair counts");
    assert_eq!(better(3), Better::Base, "without an error of one value the median counts");
}
