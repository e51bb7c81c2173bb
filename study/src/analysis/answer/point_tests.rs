//! The answer of points with several runs.

use super::pairwise::pairwise;
use super::*;
use crate::job::proportion::Proportion;
use crate::job::result_limit::{Condition, ResultLimit};
use crate::job::row::CellType;
use crate::store::table::Column;

/// A run: strategy, mass, seed, `peak_vz`, `peak_kinetic_energy`, verdict.
type Run = (&'static str, f64, i64, f64, f64, &'static str);

fn table(runs: &[Run]) -> Table {
    let column = |name: &str, cell_type, of: &dyn Fn(&Run) -> Value| {
        Column::plain(name, cell_type, runs.iter().map(of).collect())
    };
    let text = |text: &str| Value::Text(text.to_owned());
    let columns = vec![
        column("job", CellType::Text, &|run| text(&format!("{run:?}"))),
        column("strategy", CellType::Text, &|run| text(run.0)),
        column("mass", CellType::Number, &|run| Value::Number(run.1)),
        column("seed", CellType::Integer, &|run| Value::Integer(run.2)),
        column("status", CellType::Text, &|_| text("done")),
        column("verdict", CellType::Text, &|run| text(run.5)),
        column("peak_vz", CellType::Number, &|run| Value::Number(run.3)),
        column("peak_kinetic_energy", CellType::Number, &|run| Value::Number(run.4)),
    ];
    Table { columns }
}

/// Two strategies, two masses, two seeds. Rapid has half the loads; once a seed of it stalls.
fn runs() -> Vec<Run> {
    let mut runs = Vec::new();
    for mass in [1.0, 2.0] {
        for seed in [1, 2] {
            let loads = mass * 10.0 + 0.01 * if seed == 1 { 1.0 } else { -1.0 };
            let verdict = if mass > 1.0 && seed == 2 { "stalled" } else { "deployed" };
            runs.push(("rapid", mass, seed, loads, loads, verdict));
            runs.push(("late", mass, seed, 2.0 * loads, 2.0 * loads, "deployed"));
        }
    }
    runs
}

fn points(table: &Table) -> Points {
    let rows: Vec<usize> = (0..table.rows()).collect();
    Points::of(table, &rows, &["seed".to_owned()])
}

#[test]
fn seeds_do_not_multiply_pairs_and_only_one_deploys_is_said() {
    let table = table(&runs());
    let found = pairwise(&points(&table), "strategy", &|_| Vec::new());
    let [versus] = found.as_slice() else { panic!("{found:?}") };
    let text = |text: &str| Value::Text(text.to_owned());
    assert_eq!((&versus.value, &versus.than), (&text("rapid"), &text("late")), "the gentler first");
    assert_eq!((versus.pairs, versus.loads), (2, Loads::Gentler));
    assert_eq!((versus.only_value, versus.only_than), (0, 1), "one seed of rapid stalls at mass 2");
    let measures: Vec<_> = versus.measures.iter().map(|m| (m.measure, m.lower, m.pairs)).collect();
    assert_eq!(measures, [(ColumnId::PeakVz, 2, 2), (ColumnId::PeakKineticEnergy, 2, 2)]);
    assert_eq!(versus.measures[0].ratio, Some(0.5));
}

#[test]
fn loads_that_differ_in_their_order_are_mixed_and_equal_ones_are_equal() {
    let loads = |change: fn(&mut Run)| {
        let mut runs = runs();
        runs.iter_mut().for_each(change);
        pairwise(&points(&table(&runs)), "strategy", &|_| Vec::new()).remove(0).loads
    };
    assert_eq!(loads(|run| run.4 = if run.0 == "late" { 1.0 } else { 2.0 }), Loads::Mixed);
    assert_eq!(loads(|run| (run.3, run.4) = (1.0, 1.0)), Loads::Equal);
}

#[test]
fn a_point_counts_as_deployed_or_safe_if_all_its_runs_are() {
    let bound = Condition::Bound { bound: 25.0, above: false, or_equal: false };
    let word = Condition::Is(Value::Text("deployed".to_owned()));
    let limit =
        |measure, condition, text: &str| ResultLimit { measure, condition, text: text.to_owned() };
    let limits =
        [limit(ColumnId::PeakVz, bound, "< 25 m/s"), limit(ColumnId::Verdict, word, "deployed")];
    let table = table(&runs()).judged(&limits);
    let seed = ["seed".to_owned()];
    let counts = PointCounts::of(&points(&table), &seed);
    assert_eq!((counts.points, counts.deployed, counts.mixed, counts.never), (4, 3, 1, 0));
    let depends = Depends::of(&table, &points(&table)).unwrap();
    assert_eq!((depends.points, depends.of), (1, 4));
    assert_eq!(depends.choices, [("seed".to_owned(), 1)]);

    let rows: Vec<usize> = (0..table.rows()).collect();
    let safety = Safety::of(&table, &limits, &rows, &seed, table.column("strategy")).unwrap();
    let expected = SafeCounts { points: 4, safe: 2, mixed: 1, not_judged: 0 };
    assert_eq!((safety.counts, safety.limits[0].as_str()), (expected, "peak_vz < 25 m/s"));
    assert_eq!(safety.missed, [("peak_vz".to_owned(), 1), ("verdict".to_owned(), 1)]);
    // The nearest safe point is late at mass 1; its worst run has 20.02 m/s.
    let nearest = safety.nearest.unwrap();
    assert_eq!(nearest.point.parameters[0].1, Value::Text("late".to_owned()));
    assert!((nearest.point.value - (25.0 - 20.02) / 25.0).abs() < 1e-12);
    let safest = safety.by.unwrap().values[0].safest.clone().unwrap();
    assert!((safest.point.value - (25.0 - 10.01) / 25.0).abs() < 1e-12, "{safest:?}");
}

#[test]
fn a_run_that_cannot_be_trusted_leaves_the_median_to_the_others() {
    let mut table = table(&runs());
    let damped = (0..table.rows()).map(|row| Value::Bool(row == 0)).collect();
    let column = table.column("verdict").unwrap().clone();
    let name = ColumnId::NumericallyDamped.name().to_owned();
    table.columns.push(Column { name, cell_type: CellType::Bool, cells: damped, ..column });
    let points = points(&table);
    let first = &points.condensed;
    assert_eq!(first.spread("peak_vz", 0), Some([9.99; 3]), "the seed that is trusted");
    assert_eq!(
        points.condensed.runs[0].deployed,
        Proportion { met: 2, of: 2 },
        "its verdict counts"
    );
    assert!(points.trusted.iter().all(|trusted| *trusted));
}

#[test]
fn overlapping_ranges_are_equal_in_pairs_and_in_the_best_values() {
    let compared = |late: [f64; 2]| {
        let speeds = [("rapid", [8.0, 10.0]), ("late", late)];
        let runs = speeds.into_iter().flat_map(|(strategy, speeds)| {
            (1_i64..).zip(speeds).map(move |(seed, v)| (strategy, 1.0, seed, v, v, "deployed"))
        });
        let table = table(&runs.collect::<Vec<_>>());
        let pair = pairwise(&points(&table), "strategy", &|_| Vec::new()).remove(0);
        let (rows, measures) = ((0..table.rows()).collect::<Vec<_>>(), [ColumnId::PeakVz]);
        let effects = Effects::of(&table, &rows, &["seed".to_owned()], &measures, &|_| Vec::new());
        (pair.measures[0].ties, effects.effects[0].measures[0].extremes.clone())
    };
    assert_eq!(compared([9.5, 15.0]), (1, Extremes::Equal));
    let judged = Extremes::Judged { best: vec![0], worst: vec![1] };
    assert_eq!(compared([11.0, 15.0]), (0, judged));
}
