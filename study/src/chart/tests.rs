//! Texts of charts of an invented study, read from their SVG.

use std::collections::BTreeMap;

use billow_solver::output::outcome::FailureKind;

use super::kinds::ChartKind;
use super::*;
use crate::accuracy::AssumedRanges;
use crate::job::point::{Infeasible, Point, Searched};
use crate::job::row::{Cells, ColumnId};
use crate::job::{Job, JobId, Status};
use crate::render::figure::check;
use crate::run::fixture;
use crate::store::history_file::{self, StoredHistory};
use crate::store::table::Table;

mod question;
mod searches;

/// A point of an invented study.
fn point(number: u32, parameters: &[(&str, Value)]) -> Point {
    let mut job: Job = fixture::job(number);
    job.parameters =
        parameters.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
    Point { job, infeasible: None, solved: None, searched: Searched::No, merged: Vec::new() }
}

/// A table of N × mass flow × strategy; `edit` sets the cells of each point.
fn study(edit: impl Fn(usize, &mut Cells), infeasible: &[usize]) -> Table {
    let mut points = Vec::new();
    for panels in [5, 6] {
        for flow in [0.001, 0.002, 0.005] {
            for strategy in ["direct", "rapid"] {
                let mass = if strategy == "direct" { 0.0 } else { 5e-5 };
                points.push(point(
                    u32::try_from(points.len()).unwrap(),
                    &[
                        ("N", Value::Integer(panels)),
                        ("mass_flow_rate", Value::Number(flow)),
                        ("strategy", Value::Text(strategy.to_owned())),
                        ("residual_gas_mass", Value::Number(mass)),
                    ],
                ));
            }
        }
    }
    for index in infeasible {
        points[*index].infeasible =
            Some(Infeasible { reason: "too low".to_owned(), nearest: Vec::new() });
    }
    with_records(&points, edit)
}

/// The table of these points, all done and deployed; `edit` sets the cells of each point.
fn with_records(points: &[Point], edit: impl Fn(usize, &mut Cells)) -> Table {
    let mut records = BTreeMap::new();
    for (index, point) in points.iter().enumerate() {
        let mut cells = Cells::new(Status::Done);
        cells.set(ColumnId::Verdict, "deployed");
        cells.set(ColumnId::PeakVz, 20.0 + index as f64);
        cells.set(ColumnId::ContentHash, "invented");
        edit(index, &mut cells);
        let record = crate::store::journal::Record {
            job: point.job.id.clone(),
            file_hash: None,
            file_stamp: None,
            cells,
        };
        records.insert(point.job.id.clone(), record);
    }
    let unit = |name: &str| match name {
        "mass_flow_rate" => "kg/s".to_owned(),
        "residual_gas_mass" => "kg".to_owned(),
        _ => "1".to_owned(),
    };
    Table::build(points, &records, &unit, &AssumedRanges::default())
}

fn source(table: &Table) -> Source<'_> {
    Source {
        study: "made_up",
        table,
        rows: (0..table.rows()).collect(),
        choice: String::new(),
        title: String::new(),
        limits: &[],
        runs: None,
        search: None,
        answer: None,
    }
}

fn mixed() -> Table {
    study(
        |index, cells| match index {
            1 => cells.set(ColumnId::Verdict, "partial"),
            2 => cells.set(ColumnId::Verdict, "stalled"),
            3 => {
                *cells = Cells::new(Status::Failed(FailureKind::StepLimit));
                cells.set(ColumnId::PeakVz, 300.0);
                cells.set(ColumnId::ContentHash, "invented");
            }
            4 => *cells = Cells::new(Status::Pending),
            5 => cells.set(ColumnId::PeakVz, Value::Null),
            _ => {}
        },
        &[6, 7],
    )
}

fn contains(texts: &[String], text: &str) -> bool {
    texts.iter().any(|shown| shown == text)
}

/// Fails unless each of these texts is in a picture.
fn shows(texts: &[String], wanted: &[&str]) {
    for text in wanted {
        assert!(contains(texts, text), "{text}: {texts:?}");
    }
}

#[test]
fn every_point_of_a_measure_is_shown_with_its_outcome() {
    let table = mixed();
    let texts =
        check::figure(&over::svg(&source(&table), "peak_vz", "mass_flow_rate", &[]).unwrap());
    shows(
        &texts,
        &[
            "Mass flow rate (g/s)",
            "Peak upward ring velocity over mass flow rate",
            "Peak upward ring velocity peak_vz (m/s)",
            "Colour and marker: inflation strategy",
            "Line: number of panels N",
            "direct",
            "rapid",
            "deployed (5)",
            "partial (1)",
            "stalled (1)",
            "failed: step_limit (1)",
            "infeasible (2)",
            "pending (1)",
            "done, event did not occur (1)",
            "Residual gas mass changes with inflation strategy.",
        ],
    );
    assert!(
        !contains(&texts, "300") && !contains(&texts, "200"),
        "a failed job has no peak: {texts:?}"
    );
    for letter in ["∅", "S", "P", "–"] {
        assert!(
            texts.iter().filter(|text| *text == letter).count() >= 2,
            "{letter} and its legend"
        );
    }
}

#[test]
fn lines_by_one_parameter_leave_the_others_to_panels() {
    let table = mixed();
    let by = ["N".to_owned()];
    let svg = over::svg(&source(&table), "peak_vz", "mass_flow_rate", &by).unwrap();
    let texts = check::figure(&svg);
    for title in ["Inflation strategy direct", "Inflation strategy rapid"] {
        assert!(contains(&texts, title), "{texts:?}");
    }
}

#[test]
fn a_measure_over_names_has_one_position_per_name() {
    let table = mixed();
    let texts = check::figure(&over::svg(&source(&table), "peak_vz", "strategy", &[]).unwrap());
    // Without lines nothing is distinguished by dashes.
    let shown = ["direct", "rapid", "Number of panels N", "5", "Mass flow rate 1 g/s"];
    assert!(shown.iter().all(|text| contains(&texts, text)), "{texts:?}");
    let by = ["N", "mass_flow_rate"].map(str::to_owned);
    let texts = check::figure(&over::svg(&source(&table), "peak_vz", "strategy", &by).unwrap());
    let shown = ["5", "6", "Mass flow rate 1 g/s", "Mass flow rate 5 g/s"];
    assert!(shown.iter().all(|text| contains(&texts, text)), "{texts:?}");
}

#[test]
fn a_map_shows_each_value_and_each_outcome() {
    let table = mixed();
    let svg = map::svg(&source(&table), "peak_vz", ["mass_flow_rate", "N"]).unwrap();
    let texts = check::figure(&svg);
    shows(
        &texts,
        &[
            "Inflation strategy direct",
            "Peak upward ring velocity over mass flow rate and number of panels",
            "Mass flow rate (g/s)",
            "20.0",
            "31.0",
            "∅",
            "S",
            "P",
            "failed: step_limit (1)",
            "infeasible (2)",
            "partial (1)",
        ],
    );
    assert!(!contains(&texts, "300"), "a failed job has no value: {texts:?}");
    let fixed = Source { rows: vec![0, 2, 8], ..source(&table) };
    let texts = check::figure(&map::svg(&fixed, "peak_vz", ["mass_flow_rate", "N"]).unwrap());
    assert!(contains(&texts, "no such point in the study"), "{texts:?}");
}

/// Invented histories.
#[expect(clippy::unnecessary_wraps, reason = "the signature that charts call")]
fn read(id: &JobId) -> Result<StoredHistory> {
    let deployment = fixture::deployment(u32::from(id.as_str().as_bytes()[0]), 900);
    Ok(StoredHistory {
        events: Vec::new(),
        job: id.clone(),
        scene: String::new(),
        status: Status::Done,
        content_hash: history_file::content_hash(&deployment),
        history: deployment.history,
        tracks: BTreeMap::from([("smallest_gap".to_owned(), vec![1e-3; 900])]),
        labels: BTreeMap::from([(
            "smallest_gap".to_owned(),
            ("m".to_owned(), "smallest distance".to_owned()),
        )]),
    })
}

#[test]
fn histories_are_labelled_by_the_varying_parameters() {
    let table = mixed();
    let columns = ["z_rim", "pressure", "smallest_gap"].map(str::to_owned);
    let svg = history::svg(&source(&table), &columns, [None, None], &read).unwrap();
    let texts = check::figure(&svg);
    shows(
        &texts,
        &[
            "Colour and marker: number of panels N",
            "Line: mass flow rate",
            "Inflation strategy rapid",
            "Time t (ms)",
            "Mean height of the top ring, gas pressure, smallest distance over time",
            "Mean height of the top ring z_rim",
            "Gas pressure (Pa)",
            "partial (1)",
            "stalled (1)",
            "failed: step_limit (1)",
            "3 of 12 points have no history: 2 infeasible, 1 pending.",
        ],
    );
    let missing = "Residual gas mass changes with inflation strategy.";
    assert!(contains(&texts, missing), "{texts:?}");

    let cut = history::svg(&source(&table), &columns[..1], [Some(0.1), Some(0.2)], &read).unwrap();
    let texts = check::figure(&cut);
    assert!(
        contains(&texts, "100") && contains(&texts, "180") && !contains(&texts, "300"),
        "{texts:?}"
    );
}

#[test]
fn points_that_are_one_job_are_one_history() {
    let mut points: Vec<Point> = Vec::new();
    for (number, (panels, flow)) in
        [(5, 0.001), (5, 0.002), (6, 0.001), (6, 0.002)].iter().enumerate()
    {
        let parameters = [("N", Value::Integer(*panels)), ("mass_flow_rate", Value::Number(*flow))];
        points.push(point(u32::try_from(number).unwrap(), &parameters));
    }
    points[3].job.id = points[2].job.id.clone();
    let table = with_records(&points, |_, _| {});
    let source = source(&table);
    let over = check::figure(&over::svg(&source, "peak_vz", "mass_flow_rate", &[]).unwrap());
    assert!(contains(&over, "deployed (4)"), "{over:?}");
    let lines = history::svg(&source, &["z_rim".to_owned()], [None; 2], &read).unwrap();
    assert_eq!(lines.matches("<polyline").count(), 3 + 4, "one line per job, and the legend");
}

#[test]
fn a_chart_has_the_units_of_the_study() {
    let mut table = mixed();
    for (name, unit, si) in [("mass_flow_rate", "kg/h", "kg/s"), ("peak_vz", "km/h", "m/s")] {
        let column = table.columns.iter_mut().find(|column| column.name == name).unwrap();
        column.shown = crate::input::units::DisplayUnit::new(unit, si).unwrap();
    }
    let texts =
        check::figure(&over::svg(&source(&table), "peak_vz", "mass_flow_rate", &[]).unwrap());
    shows(&texts, &["Mass flow rate (kg/h)", "3.6", "Peak upward ring velocity peak_vz (km/h)"]);
}

#[test]
fn a_title_can_be_given_and_fixed_parameters_are_named() {
    let table = mixed();
    let rows = (0..table.rows()).filter(|row| row % 2 == 0).collect();
    let titled = Source { title: "My figure".to_owned(), rows, ..source(&table) };
    let texts = check::figure(&over::svg(&titled, "peak_vz", "mass_flow_rate", &[]).unwrap());
    shows(&texts, &["My figure", "Every point: inflation strategy direct, residual gas mass 0 kg"]);
}

#[test]
fn an_empty_chart_says_why() {
    let none = study(|_, cells| *cells = Cells::new(Status::Pending), &[]);
    let says_so =
        |svg: String| check::figure(&svg).iter().any(|text| text.starts_with("nothing to draw"));
    assert!(says_so(over::svg(&source(&none), "peak_vz", "N", &[]).unwrap()));
    assert!(says_so(
        history::svg(&source(&none), &["z_rim".to_owned()], [None; 2], &read).unwrap()
    ));
    let texts = check::figure(&map::svg(&source(&none), "peak_vz", ["N", "strategy"]).unwrap());
    assert!(contains(&texts, "No job here has a value of peak_vz."), "{texts:?}");
}

#[test]
fn an_impossible_chart_is_an_error_that_says_what_is_allowed() {
    let table = mixed();
    let source = source(&table);
    let columns = |name: &str| vec![name.to_owned()];
    for (result, expected) in [
        (over::svg(&source, "peak_v", "N", &[]), "did you mean peak_vz?"),
        (over::svg(&source, "verdict", "N", &[]), "not a column of numbers"),
        (over::svg(&source, "peak_vz", "mass_flow", &[]), "mass_flow_rate"),
        (over::svg(&source, "peak_vz", "N", &columns("M")), "--by = M"),
        (map::svg(&source, "peak_vz", ["N", "N"]), "one parameter on both axes"),
        (history::svg(&source, &columns("z_rims"), [None; 2], &read), "did you mean z_rim?"),
        (
            history::svg(&source, &columns("vz"), [Some(0.2), Some(0.1)], &read),
            "the time range is empty",
        ),
    ] {
        let error = result.unwrap_err();
        assert!(
            matches!(error, Error::Input(_)) && error.to_string().contains(expected),
            "{error}"
        );
    }
    let points: Vec<Point> =
        (0..60).map(|n| point(n, &[("N", Value::Integer(n.into()))])).collect();
    let table = with_records(&points, |_, _| {});
    let many = Source { rows: (0..60).collect(), table: &table, ..source };
    let error = history::svg(&many, &columns("vz"), [None; 2], &read).unwrap_err().to_string();
    assert!(error.contains("48 jobs at most"), "{error}");
}

#[test]
fn points_that_vary_one_factor_at_a_time_are_a_tornado() {
    let point_of = |(number, (panels, flow, strategy)): (usize, &(i64, f64, &str))| {
        let parameters = [
            ("N", Value::Integer(*panels)),
            ("mass_flow_rate", Value::Number(*flow)),
            ("strategy", Value::Text((*strategy).to_owned())),
        ];
        point(u32::try_from(number).unwrap(), &parameters)
    };
    let values = [
        (6, 0.005, "direct"),
        (6, 0.002, "direct"),
        (6, 0.008, "direct"),
        (5, 0.005, "direct"),
        (6, 0.005, "rapid"),
        (5, 0.002, "direct"),
    ];
    let points: Vec<Point> = values.iter().enumerate().map(point_of).collect();
    let table = with_records(&points, |index, cells| match index {
        4 => *cells = Cells::new(Status::Failed(FailureKind::StepLimit)),
        _ => cells.set(ColumnId::PeakVz, [20.0, 15.0, 22.0, 21.0, 0.0, 9.0][index]),
    });
    let one_factor = Source { rows: (0..5).collect(), ..source(&table) };
    let svg = tornado::svg(&one_factor, "peak_vz").unwrap();
    let texts = check::figure(&svg);
    shows(
        &texts,
        &[
            "Peak upward ring velocity, one factor at a time",
            "Base: N 6, mass flow rate 5 g/s, inflation strategy direct",
            "Peak upward ring velocity peak_vz (m/s)",
            "2 g/s −25 %",
            "8 g/s +10 %",
            "5 +5 %",
            "rapid S",
            "failed: step_limit (1)",
        ],
    );
    // From the bottom to the top.
    let names = ["Inflation strategy", "Number of panels N", "Mass flow rate", "Base"];
    let places = names.map(|name| texts.iter().position(|text| text == name).unwrap());
    assert!(places.is_sorted(), "{texts:?}");
    let (charts, _) = kinds::standard(&one_factor);
    let drawn: Vec<String> = charts.iter().map(|(kind, _)| kind.file_name()).collect();
    assert_eq!(drawn[..2], ["peak_vz-tornado", "history-z_rim"]);
    let error = tornado::svg(&source(&table), "peak_vz").unwrap_err().to_string();
    assert!(error.contains("points that vary one factor at a time"), "{error}");
}

#[test]
fn the_standard_charts_fit_the_study() {
    let table = mixed();
    let source = source(&table);
    let (charts, notes) = kinds::standard(&source);
    let names: Vec<String> = charts.iter().map(|(kind, _)| kind.file_name()).collect();
    assert_eq!(
        names,
        [
            "peak_vz-over-mass_flow_rate",
            "peak_vz-map-mass_flow_rate-N",
            "history-z_rim",
            "history-vz",
            "history-pressure",
        ]
    );
    assert!(notes.is_empty(), "{notes:?}");
    let dotted = ChartKind::Over("a".to_owned(), "film/../x".to_owned(), Vec::new());
    assert_eq!(dotted.file_name(), "a-over-film_.._x");
}
