//! Rankings of an invented table.

use super::*;
use crate::analysis::fixture::{self, all, limits, with_error};

/// A run: strategy, mass, seed, `peak_vz`, verdict.
type Run = (&'static str, f64, i64, f64, &'static str);

const DEPLOYED: &str = "deployed";

fn table(runs: &[Run]) -> Table {
    let row = |(job, (strategy, mass, seed, speed, end)): (usize, &Run)| {
        let (status, verdict) = match *end {
            "pending" => ("pending", "-"),
            "" => ("done", "-"),
            verdict => ("done", verdict),
        };
        format!("{job} {strategy} {mass:?} {seed} {status} {verdict} {speed:?}")
    };
    let names = "job strategy mass seed status verdict peak_vz";
    fixture::table_of(names, runs.iter().enumerate().map(row))
}

#[test]
fn what_is_limited_is_ranked_by_first_and_once() {
    let table = table(&[("a", 0.0, 1, 10.0, "deployed")]);
    let of = |limits: &[ResultLimit]| default_measures(&table, limits);
    let default = DEFAULT_MEASURES.map(ColumnId::name);
    assert_eq!(of(&[]), default);
    let mut limits = limits(25.0);
    limits[0].measure = ColumnId::PeakSpeed;
    let limited = [limits.clone(), limits].concat();
    assert_eq!(of(&limited)[..2], ["peak_speed", "peak_vz"]);
    assert_eq!(of(&limited).len(), 4);
    let mut neither = limited;
    neither[0].measure = ColumnId::FinalVolume;
    neither[2].measure = ColumnId::FinalVolume;
    assert_eq!(of(&neither), default, "a larger final volume is no better");
}

fn ranked(runs: &[Run], by: &[&str], limits: &[ResultLimit]) -> Ranking {
    ranked_with(runs, by, limits, &["peak_vz"])
}

fn ranked_with(runs: &[Run], by: &[&str], limits: &[ResultLimit], measures: &[&str]) -> Ranking {
    let table = with_error(table(runs), "peak_vz", 0.0).judged(limits);
    Ranking::of(&RankingInput {
        table: &table,
        rows: &all(&table),
        by: &by.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>(),
        replicates: &["seed".to_owned()],
        limits,
        measures,
        zipped: &|_| Vec::new(),
    })
    .unwrap()
}

fn order(ranking: &Ranking) -> Vec<String> {
    let texts = ranking.candidates.iter().map(|candidate| {
        candidate.values.iter().map(Value::to_string).collect::<Vec<_>>().join(" ")
    });
    texts.collect()
}

/// Strategy c is safe in all runs, a in all but one, b in none; two masses, two seeds.
const GRID: [Run; 12] = [
    ("a", 1.0, 1, 8.0, DEPLOYED),
    ("a", 1.0, 2, 8.0, DEPLOYED),
    ("a", 2.0, 1, 10.0, DEPLOYED),
    ("a", 2.0, 2, 25.0, DEPLOYED),
    ("b", 1.0, 1, 5.0, "stalled"),
    ("b", 1.0, 2, 5.0, "stalled"),
    ("b", 2.0, 1, 6.0, "stalled"),
    ("b", 2.0, 2, 6.0, "stalled"),
    ("c", 1.0, 1, 16.0, DEPLOYED),
    ("c", 1.0, 2, 17.0, DEPLOYED),
    ("c", 2.0, 1, 18.0, DEPLOYED),
    ("c", 2.0, 2, 18.0, DEPLOYED),
];

#[test]
fn limits_come_before_measures_and_every_run_of_a_point_must_be_safe() {
    let ranking = ranked(&GRID, &["strategy"], &limits(20.0));
    assert_eq!(order(&ranking), ["c", "a", "b"]);
    assert_eq!((ranking.sets, ranking.basis), (2, Basis::Limits));
    let safe: Vec<_> = ranking.candidates.iter().map(|c| (c.safe, c.points, c.safe_runs)).collect();
    let runs = |met| Proportion { met, of: 4 };
    assert_eq!(safe, [(2, 2, runs(4)), (1, 2, runs(3)), (0, 2, runs(0))]);
    let margins: Vec<_> = ranking.candidates.iter().map(|c| c.margin.clone().unwrap()).collect();
    let (speed, verdict) = ("peak_vz".to_owned(), "verdict".to_owned());
    assert_eq!(margins, [(0.1, speed.clone()), (-0.25, speed), (-1.0, verdict)]);
    // Medians over the points; ranges over all runs.
    let spread = ranking.candidates[1].measures[0].unwrap();
    assert_eq!((spread.median, spread.least, spread.largest), (12.75, 8.0, 25.0));
    // Without limits what does not deploy comes last, then the speed decides.
    let ranking = ranked(&GRID, &["strategy"], &[]);
    assert_eq!(
        (order(&ranking), ranking.basis),
        (vec!["a".to_owned(), "c".into(), "b".into()], Basis::Verdicts)
    );
    let words: Vec<Run> = GRID.iter().map(|run| (run.0, run.1, run.2, run.3, "")).collect();
    let ranking = ranked(&words, &["strategy"], &[]);
    assert_eq!(
        (order(&ranking), ranking.basis),
        (vec!["b".to_owned(), "a".into(), "c".into()], Basis::Measures)
    );
}

#[test]
fn a_measure_orders_what_is_safe_and_margins_where_they_are_asked_for() {
    // Strategy a has the smaller median (13 m/s), b the larger margin to the limit of 20 m/s.
    let runs = [
        ("b", 1.0, 1, 14.0, DEPLOYED),
        ("b", 1.0, 2, 14.0, DEPLOYED),
        ("a", 1.0, 1, 8.0, DEPLOYED),
        ("a", 1.0, 2, 18.0, DEPLOYED),
    ];
    for (measures, expected) in [
        (&["peak_vz"][..], ["a", "b"]),
        (&["peak_vz", "smallest_margin"], ["a", "b"]),
        (&["smallest_margin", "peak_vz"], ["b", "a"]),
        (&["smallest_margin"], ["b", "a"]),
    ] {
        let ranking = ranked_with(&runs, &["strategy"], &limits(20.0), measures);
        assert_eq!(order(&ranking), expected, "{measures:?}");
        let margins = ranking.candidates.iter().map(|one| one.margin.as_ref().unwrap().0);
        assert!((margins.fold(f64::INFINITY, f64::min) - 0.1).abs() < 1e-12);
    }
}

#[test]
fn points_that_not_every_candidate_has_change_nothing() {
    let without = ranked(&GRID, &["strategy"], &limits(20.0));
    // As a search adds them: at masses of which the others have no point.
    let searched = [
        ("a", 1.5, 1, 99.0, "stalled"),
        ("a", 1.5, 2, 99.0, "stalled"),
        ("c", 1.75, 1, 99.0, "stalled"),
        ("c", 1.75, 2, 99.0, "stalled"),
        ("b", 3.0, 1, 1.0, "pending"),
    ];
    let with = ranked(&[&GRID[..], &searched[..]].concat(), &["strategy"], &limits(20.0));
    assert_eq!(with.candidates, without.candidates);
    assert_eq!((with.sets, with.outside, with.not_ended), (2, 2, 1));
    // A strategy with no partner is left out, with the reason.
    let alone = [("d", 9.0, 1, 1.0, DEPLOYED), ("d", 9.0, 2, 1.0, DEPLOYED)];
    let with = ranked(&[&GRID[..], &alone[..]].concat(), &["strategy"], &limits(20.0));
    assert_eq!(with.candidates, without.candidates);
    let (values, reason) = &with.left_out[0];
    assert_eq!(values, &[Value::Text("d".to_owned())]);
    assert_eq!(reason, "it is in 1 of 3 sets of equal conditions");
}

#[test]
fn all_parameters_rank_every_point() {
    let ranking = ranked(&GRID, &["strategy", "mass"], &limits(20.0));
    assert_eq!(order(&ranking), ["a 1", "c 1", "c 2", "a 2", "b 1", "b 2"]);
    assert_eq!((ranking.sets, ranking.matched.len()), (1, 0));
}

#[test]
fn rounding_errors_decide_no_order() {
    // The speeds differ in the last bits: plan order stays in both cases.
    let speed: f64 = 0.1 + 0.2;
    assert_ne!(speed.to_bits(), 0.3_f64.to_bits());
    for speeds in [[speed, 0.3], [0.3, speed]] {
        let runs = [("b", 1.0, 1, speeds[0], DEPLOYED), ("a", 1.0, 1, speeds[1], DEPLOYED)];
        let ranking = ranked(&runs, &["strategy"], &limits(20.0));
        assert_eq!(order(&ranking), ["b", "a"]);
    }
}

#[test]
fn of_two_points_that_are_not_safe_the_one_with_fewer_runs_missed_is_better() {
    let mut runs = Vec::new();
    for seed in 1..=5 {
        let word = |met: bool| if met { DEPLOYED } else { "stalled" };
        // Strategy a never deploys and is the slower one; b deploys in four of five runs.
        runs.push(("a", 1.0, seed, 8.0, word(false)));
        runs.push(("b", 1.0, seed, 10.0, word(seed > 1)));
    }
    for limits in [limits(20.0), Vec::new()] {
        let ranking = ranked(&runs, &["strategy"], &limits);
        assert_eq!(order(&ranking), ["b", "a"]);
        let missed: Vec<_> = ranking.candidates.iter().map(|c| c.missed).collect();
        assert_eq!(missed, [Proportion { met: 1, of: 5 }, Proportion { met: 5, of: 5 }]);
    }
}
