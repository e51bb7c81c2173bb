//! Charts of studies with replicates, limits or a search.

use super::*;
use crate::analysis::fixture::{self, with_error};
use crate::analysis::replicates::Condensed;
use crate::chart::kinds::ChartKind;
use crate::chart::runs::Replicated;
use crate::job::result_limit::{Condition, ResultLimit};
use crate::study::Meshes;

fn limits() -> Vec<ResultLimit> {
    fixture::limits(25.0)
}

/// Strategy × mass flow × four seeds. The speed grows with the flow and the seed; one run of the last direct
/// point is partial, one of the first rapid point failed.
fn table() -> Table {
    let mut points = Vec::new();
    for strategy in ["direct", "rapid"] {
        for flow in [0.001, 0.002, 0.005] {
            for seed in 1..=4 {
                let parameters = [
                    ("strategy", Value::Text(strategy.to_owned())),
                    ("mass_flow_rate", Value::Number(flow)),
                    ("seed", Value::Integer(seed)),
                ];
                points.push(point(u32::try_from(points.len()).unwrap(), &parameters));
            }
        }
    }
    let edit = |index: usize, cells: &mut Cells| {
        let (group, seed) = (index / 4, index % 4);
        cells.set(ColumnId::PeakVz, 10.0 + 5.0 * group as f64 + seed as f64);
        if index == 11 {
            cells.set(ColumnId::Verdict, "partial");
        }
        if index == 12 {
            *cells = Cells::new(Status::Failed(FailureKind::StepLimit));
        }
    };
    with_error(with_records(&points, edit), "peak_vz", 0.0).judged(&limits())
}

/// Calls `draw` with the condensed source of a table.
fn condensed<T>(table: &Table, limits: &[ResultLimit], draw: impl Fn(&Source<'_>) -> T) -> T {
    let names = ["seed".to_owned()];
    let rows: Vec<usize> = (0..table.rows()).collect();
    let condensed = Condensed::of(table, &rows, &names);
    draw(&Source {
        rows: (0..condensed.table.rows()).collect(),
        limits,
        runs: Some(Replicated {
            condensed: &condensed,
            single: table,
            names: &names,
            meshes: &Meshes::default(),
        }),
        ..source(&condensed.table)
    })
}

#[test]
fn the_runs_of_a_point_are_a_median_with_a_band_and_a_marker() {
    let (table, limits) = (table(), limits());
    let svg = condensed(&table, &limits, |source| {
        over::svg(source, "peak_vz", "mass_flow_rate", &[]).unwrap()
    });
    let texts = check::figure(&svg);
    shows(
        &texts,
        &[
            "study made_up: 6 points of 4 runs each (seed)",
            "Inflation strategy",
            "median, and range from least to largest",
            "all runs deployed (5)",
            "k/n: k of n runs deployed (1)",
            "3/4",
            "limit 25 m/s",
            "misses the limit (peak_vz < 25 m/s)",
            "Of 24 runs 1 failed or are infeasible: medians, ranges and k/n are those of the others.",
        ],
    );
    assert!(!texts.iter().any(|text| text.starts_with("Seed")), "seeds are no panels: {texts:?}");
    let bands = svg.matches("fill-opacity=\"0.2\"").count();
    assert_eq!(bands, 3, "one band per strategy, and the legend");
    // The third point of `direct` has the speeds 20 to 23: its median is drawn.
    let svg = condensed(&table, &limits, |source| {
        map::svg(source, "peak_vz", ["mass_flow_rate", "strategy"]).unwrap()
    });
    let texts = check::figure(&svg);
    shows(&texts, &["21.5", "3/4", "27.0", "misses the limit (peak_vz < 25 m/s)"]);
    let over_names =
        condensed(&table, &limits, |source| over::svg(source, "peak_vz", "strategy", &[]).unwrap());
    check::figure(&over_names);
    assert_eq!(over_names.matches("fill-opacity=\"0.2\"").count(), 0, "error bars over names");
    // Chosen one by one, the seeds are a parameter as any other.
    let single = check::figure(&over::svg(&source(&table), "peak_vz", "seed", &[]).unwrap());
    assert!(contains(&single, "Seed"), "{single:?}");
}

#[test]
fn a_margin_has_its_zero_line_and_a_far_limit_a_note() {
    let (table, limits) = (table(), limits());
    let draw = |measure: &str, limits: &[ResultLimit]| {
        let svg = condensed(&table, limits, |source| {
            over::svg(source, measure, "mass_flow_rate", &[]).unwrap()
        });
        check::figure(&svg)
    };
    let margin = draw("smallest_margin", &limits);
    shows(
        &margin,
        &[
            "Smallest margin of the limits over mass flow rate",
            "limit",
            "missed by its value; above 0: every limit is met, uncertainty not counted",
            "The margin of verdict is 1 if the limit is met, −1 if not.",
        ],
    );
    let mut far = limits.clone();
    far[0].condition = Condition::Bound { bound: 2500.0, above: false, or_equal: false };
    let far = draw("peak_vz", &far);
    assert!(contains(&far, "The limit 2500 m/s lies far above the vertical axis."), "{far:?}");
}

#[test]
fn a_map_of_outcomes_counts_safe_runs_and_names_missed_limits() {
    let (table, limits) = (table(), limits());
    let axes = ["mass_flow_rate", "strategy"];
    let texts = check::figure(&condensed(&table, &limits, |source| {
        map::svg(source, "safe", axes).unwrap()
    }));
    shows(
        &texts,
        &[
            "Proportion of safe runs over mass flow rate and inflation strategy",
            "4/4",
            "3/4",
            "0/3*",
            "0/4",
            "misses peak_vz < 25 m/s (3)",
            "not deployed (1)",
            "k/n: k of n runs are safe; safe: every limit is met for certain.",
        ],
    );
    let texts =
        check::figure(&condensed(&table, &[], |source| map::svg(source, "verdict", axes).unwrap()));
    shows(&texts, &["4/4", "3/4", "3/3*", "k/n: k of n runs are deployed; deployed: the verdict."]);
    let single = with_error(mixed(), "peak_vz", 0.0).judged(&limits);
    let single = Source { limits: &limits, ..source(&single) };
    let texts = check::figure(&map::svg(&single, "safe", ["mass_flow_rate", "N"]).unwrap());
    shows(&texts, &["safe", "unsafe", "∅", "S", "P"]);
    // With an error that is larger than every margin no run is safe for certain: it counts one half.
    let colours = |error: f64| {
        let table = with_error(mixed(), "peak_vz", error).judged(&limits);
        let source = Source { limits: &limits, ..source(&table) };
        let judged = map::Judged::Safe;
        let counted = |row: &usize| Some(judged.proportion(&source, *row)).filter(|all| all.of > 0);
        let rows = source.rows.iter();
        let colour = |row: &usize| Some(judged.value(&source, *row, counted(row)?));
        rows.filter_map(colour).collect::<Vec<f64>>()
    };
    let has = |colours: &[f64], value: f64| colours.iter().any(|one| (one - value).abs() < 1e-9);
    let (certain, uncertain) = (colours(0.0), colours(100.0));
    assert!(has(&certain, 1.0) && has(&certain, 0.0) && !has(&certain, 0.5), "{certain:?}");
    assert!(has(&uncertain, 0.5) && !has(&uncertain, 1.0), "{uncertain:?}");
    let table = mixed();
    let error = map::svg(&source(&table), "safe", ["mass_flow_rate", "N"]).unwrap_err();
    assert!(error.to_string().contains("the study has no limits"), "{error}");
}

#[test]
fn a_run_at_a_bound_that_is_not_allowed_is_marked_as_one_beyond_it() {
    let points: Vec<Point> = (0..4)
        .map(|index| {
            let parameters = [
                ("N", Value::Integer(5 + i64::from(index / 2))),
                ("mass_flow_rate", Value::Number(0.001 * f64::from(1 + index % 2))),
            ];
            point(index, &parameters)
        })
        .collect();
    let draw = |or_equal: bool, measure: &str| {
        let mut limits = limits();
        limits[0].condition = Condition::Bound { bound: 25.0, above: false, or_equal };
        let speed = |index: usize| if index == 2 { 25.0 } else { 20.0 };
        let table = with_records(&points, |index, cells| {
            cells.set(ColumnId::PeakVz, speed(index));
        });
        let table = with_error(table, "peak_vz", 0.0).judged(&limits);
        let source = Source { limits: &limits, ..source(&table) };
        check::figure(&map::svg(&source, measure, ["mass_flow_rate", "N"]).unwrap())
    };
    for (measure, text) in [
        ("safe", "misses peak_vz < 25 m/s (1)"),
        ("peak_vz", "misses the limit (peak_vz < 25 m/s)"),
        (
            "margin_peak_vz",
            "missed by its value; above 0: peak_vz < 25 m/s, uncertainty not counted",
        ),
        (
            "smallest_margin",
            "missed by its value; above 0: every limit is met, uncertainty not counted",
        ),
    ] {
        assert!(contains(&draw(false, measure), text), "{measure}: {:?}", draw(false, measure));
        let allowed = draw(true, measure);
        let marked = |shown: &String| shown.starts_with(text.split(':').next().unwrap());
        let counted = measure == "safe";
        assert!(counted || !allowed.iter().any(marked), "{measure}: {allowed:?}");
    }
    assert!(contains(&draw(true, "safe"), "misses peak_vz < 25 m/s (0)"));
}

#[test]
fn the_history_of_a_point_is_the_median_of_its_runs() {
    let table = table();
    let columns = ["z_rim".to_owned()];
    let svg =
        condensed(&table, &[], |source| history::svg(source, &columns, [None; 2], &read).unwrap());
    let texts = check::figure(&svg);
    let lines = svg.matches("<polyline").count();
    // Each point has one line and two edges of its band; so has the legend, with five more lines.
    assert_eq!((lines, svg.matches("fill-opacity=\"0.2\"").count()), (26, 7));
    let heading =
        "Outcome, at the end of a line (number of points); no mark: all runs deployed (5)";
    shows(&texts, &["some runs deployed (1)", heading, "median, and range from least to largest"]);
}

#[test]
fn runs_without_a_range_have_no_legend() {
    let mut table = table();
    let speed = table.columns.iter_mut().find(|column| column.name == "peak_vz").unwrap();
    for row in 0..24 {
        speed.cells[row] = Value::Number(20.0);
    }
    let texts = check::figure(&condensed(&table, &[], |source| {
        over::svg(source, "peak_vz", "mass_flow_rate", &[]).unwrap()
    }));
    assert!(!contains(&texts, "median, and range from least to largest"), "{texts:?}");
}

#[test]
fn histories_have_lines_of_limits_of_both_signs() {
    let bound = Condition::Bound { bound: 3.5, above: false, or_equal: false };
    let limit = ResultLimit {
        measure: ColumnId::PeakSpeed,
        condition: bound,
        text: "< 3.5 m/s".to_owned(),
    };
    let table = table();
    let of = |columns: &str| {
        let (limits, columns) = ([limit.clone()], [columns.to_owned()]);
        let svg = condensed(&table, &limits, |source| {
            history::svg(source, &columns, [None; 2], &read).unwrap()
        });
        let texts = check::figure(&svg);
        texts.iter().filter(|text| *text == "peak_speed < 3.5 m/s").count()
    };
    // Two lines in at least one panel, and the legend.
    assert!(of("vz") >= 3);
    assert_eq!(of("pressure"), 0);
}

#[test]
fn the_standard_charts_answer_the_question_of_the_study() {
    let (table, limits) = (table(), limits());
    let (names, notes) = condensed(&table, &limits, |source| {
        let (charts, notes) = kinds::standard(source);
        (charts.iter().map(|(kind, _)| kind.file_name()).collect::<Vec<_>>(), notes)
    });
    assert_eq!(
        names,
        [
            "safe-map-mass_flow_rate-strategy",
            "smallest_margin-over-mass_flow_rate",
            "peak_vz-over-mass_flow_rate",
            "history-z_rim",
            "history-vz",
            "history-pressure",
        ]
    );
    assert!(notes.is_empty(), "{notes:?}");
    // More points: histories at the middle of the other parameters, one per strategy.
    let many = study(|_, _| {}, &[]);
    let asked = Source { limits: &limits, ..source(&many) };
    let (charts, notes) = kinds::standard(&asked);
    let Some((_, fewer)) = charts.last() else { panic!("no histories") };
    assert_eq!((fewer.rows.len(), fewer.choice.as_str()), (2, "at N 6, mass flow rate 2 g/s"));
    assert!(notes.iter().any(|note| note.starts_with("histories of 2 of 12 points")), "{notes:?}");
    let over = ChartKind::Over("peak_vz".to_owned(), "N".to_owned(), Vec::new());
    assert_eq!(over.reduced(&asked).unwrap().rows.len(), 4, "N and strategy remain");
}
