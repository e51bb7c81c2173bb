//! The answer of points with several runs.

use super::*;
use crate::analysis::fixture::{self, all, limits, with_error};
use crate::job::proportion::Proportion;

/// A run: strategy, mass, seed, `peak_vz`, `peak_kinetic_energy`, verdict.
type Run = (&'static str, f64, i64, f64, f64, &'static str);

fn table(runs: &[Run]) -> Table {
    let names =
        "job strategy mass seed status verdict peak_vz peak_kinetic_energy numerically_damped";
    let row = |(job, (strategy, mass, seed, speed, energy, verdict)): (usize, &Run)| {
        format!("{job} {strategy} {mass:?} {seed} done {verdict} {speed:?} {energy:?} false")
    };
    fixture::table_of(names, runs.iter().enumerate().map(row))
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

fn points(table: &Table) -> Condensed {
    Condensed::of(table, &all(table), &["seed".to_owned()])
}

#[test]
fn seeds_do_not_multiply_pairs_and_a_value_is_the_best_where_all_its_runs_deploy() {
    let compared = |runs: &[Run]| {
        let table = table(runs);
        let seed = ["seed".to_owned()];
        comparison(&table, &all(&table), "strategy", (&[], &seed), &|_| Vec::new()).unwrap()
    };
    let mut runs = runs();
    let ranking = compared(&runs);
    let order: Vec<String> = ranking.candidates.iter().map(|c| c.values[0].to_string()).collect();
    assert_eq!(order, ["late", "rapid"], "one seed of rapid stalls at mass 2");
    assert_eq!(
        ranking.candidates.iter().map(|c| (c.deployed, c.points)).collect::<Vec<_>>(),
        [(2, 2), (1, 2)]
    );
    let tally = ranking.measures[0].against_best[1].as_ref().unwrap();
    assert_eq!((ranking.measures[0].best, tally.pairs()), (Some(0), 2));
    assert_eq!((tally.count(compare::Better::Other), tally.ratio.unwrap().median), (2, 0.5));
    for run in &mut runs {
        run.5 = "deployed";
    }
    assert_eq!(compared(&runs).measures[0].best, Some(0));
    assert_eq!(compared(&runs).candidates[0].values[0].to_string(), "rapid", "the gentler one");
    for run in &mut runs {
        run.3 = 1.0;
    }
    assert_eq!(compared(&runs).measures[0].equal, [true, true]);
}

#[test]
fn a_point_counts_as_deployed_or_safe_if_all_its_runs_are() {
    let limits = limits(25.0);
    let table = with_error(table(&runs()), "peak_vz", 0.0).judged(&limits);
    let seed = ["seed".to_owned()];
    let counts = PointCounts::of(&points(&table), &seed);
    assert_eq!((counts.points, counts.deployed, counts.mixed, counts.never), (4, 3, 1, 0));
    let depends = VerdictSensitivity::of(&table, &points(&table)).unwrap();
    assert_eq!((depends.points, depends.of), (1, 4));
    assert_eq!(depends.choices, [("seed".to_owned(), 1)]);

    let safety = Safety::of(&table, &limits, &all(&table), &seed).unwrap();
    let expected = SafeCounts { points: 4, safe: 2, uncertain: 1, not_judged: 0 };
    assert_eq!((safety.counts, safety.limits[0].as_str()), (expected, "peak_vz < 25 m/s"));
    assert_eq!(safety.missed, [("peak_vz".to_owned(), 1), ("verdict".to_owned(), 1)]);
    // The nearest safe point is late at mass 1; its worst run has 20.02 m/s.
    let nearest = safety.nearest.unwrap();
    assert_eq!(nearest.run.parameters[0].1, Value::Text("late".to_owned()));
    assert!((nearest.run.value - (25.0 - 20.02) / 25.0).abs() < 1e-12);
    let farthest = safety.farthest.unwrap();
    assert_eq!(farthest.run.parameters[0].1, Value::Text("rapid".to_owned()));
    assert!((farthest.run.value - (25.0 - 10.01) / 25.0).abs() < 1e-12);
}

#[test]
fn one_safe_point_alone_is_the_nearest_and_not_the_farthest() {
    let limits = limits(15.0);
    let table = with_error(table(&runs()), "peak_vz", 0.0).judged(&limits);
    let safety = Safety::of(&table, &limits, &all(&table), &["seed".to_owned()]).unwrap();
    assert_eq!(safety.counts.safe, 1);
    assert!(safety.nearest.is_some() && safety.farthest.is_none());
}

#[test]
fn a_run_that_cannot_be_trusted_leaves_the_median_to_the_others() {
    let mut table = table(&runs());
    table.columns[8].cells[0] = Value::Bool(true);
    let points = points(&table);
    assert_eq!(points.spread("peak_vz", 0), Some([9.99; 3]), "the seed that is trusted");
    assert_eq!(points.runs[0].deployed, Proportion { met: 2, of: 2 }, "its verdict counts");
    assert!(points.runs.iter().all(|runs| runs.has_trusted));
}

#[test]
fn overlapping_ranges_are_equal_in_pairs_and_in_the_best_values() {
    let compared = |late: [f64; 2]| {
        let speeds = [("rapid", [8.0, 10.0]), ("late", late)];
        let runs = speeds.into_iter().flat_map(|(strategy, speeds)| {
            (1_i64..).zip(speeds).map(move |(seed, v)| (strategy, 1.0, seed, v, v, "deployed"))
        });
        let table = table(&runs.collect::<Vec<_>>());
        let seed = ["seed".to_owned()];
        let ranking =
            comparison(&table, &all(&table), "strategy", (&[], &seed), &|_| Vec::new()).unwrap();
        let tally = ranking.measures[0].against_best[1].clone().unwrap();
        (tally.count(compare::Better::Tie), ranking.measures[0].equal[1])
    };
    assert_eq!(compared([9.5, 15.0]), (1, true));
    assert_eq!(compared([11.0, 15.0]), (0, false));
}

#[test]
fn a_mixed_point_is_named_and_what_is_limited_comes_first() {
    let table = table(&runs());
    let mixed = MixedPoint::all(&points(&table));
    let [point] = &mixed[..] else { panic!("{mixed:?}") };
    let values: Vec<String> =
        point.parameters.iter().map(|(_, value, _)| value.to_string()).collect();
    assert_eq!(values, ["rapid", "2"]);
    assert_eq!((point.deployed.met, point.deployed.of, point.safe.of), (1, 2, 0));
    let seed = ["seed".to_owned()];
    let first = |measure| {
        let limits = limits(25.0).into_iter().map(|limit| ResultLimit { measure, ..limit });
        let limits: Vec<ResultLimit> = limits.take(1).collect();
        let ranking =
            comparison(&table, &all(&table), "strategy", (&limits, &seed), &|_| Vec::new());
        ranking.unwrap().measures[0].column.name.clone()
    };
    for measure in [ColumnId::PeakVz, ColumnId::PeakKineticEnergy] {
        assert_eq!(first(measure), measure.name());
    }
}
