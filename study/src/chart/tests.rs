use std::collections::BTreeMap;

use billow_solver::output::outcome::FailureKind;

use super::standard::Kind;
use super::*;
use crate::job::point::{Infeasible, Point};
use crate::job::row::{Cells, ColumnId};
use crate::job::{Job, JobId, Status};
use crate::render::figure::check;
use crate::run::fixture;
use crate::store::history_file::{self, StoredHistory};
use crate::store::table::Table;

/// A point of a made-up study: parameters, and what its row says.
fn point(number: u32, parameters: &[(&str, Value)]) -> Point {
    let mut job: Job = fixture::job(number);
    job.parameters =
        parameters.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
    Point { job, infeasible: None, solved: None, merged: Vec::new() }
}

/// A table of N × mass flow × strategy; the row of every point is as `say` has it.
fn study(say: impl Fn(usize, &mut Cells), infeasible: &[usize]) -> Table {
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
    for at in infeasible {
        points[*at].infeasible =
            Some(Infeasible { reason: "too low".to_owned(), nearest: Vec::new() });
    }
    let mut records = BTreeMap::new();
    for (at, point) in points.iter().enumerate() {
        let mut cells = Cells::new(Status::Done);
        cells.set(ColumnId::Verdict, "deployed");
        cells.set(ColumnId::PeakVz, 20.0 + at as f64);
        cells.set(ColumnId::ContentHash, "made up");
        say(at, &mut cells);
        let record =
            crate::store::journal::Record { job: point.job.id.clone(), file_hash: None, cells };
        records.insert(point.job.id.clone(), record);
    }
    let unit = |name: &str| match name {
        "mass_flow_rate" => "kg/s".to_owned(),
        "residual_gas_mass" => "kg".to_owned(),
        _ => "1".to_owned(),
    };
    Table::build(&points, &records, &unit)
}

fn source(table: &Table) -> Source<'_> {
    Source { study: "made_up", table, rows: (0..table.rows()).collect(), choice: String::new() }
}

fn mixed() -> Table {
    study(
        |at, cells| match at {
            1 => cells.set(ColumnId::Verdict, "partial"),
            2 => cells.set(ColumnId::Verdict, "stalled"),
            3 => {
                *cells = Cells::new(Status::Failed(FailureKind::StepLimit));
                cells.set(ColumnId::PeakVz, 300.0);
                cells.set(ColumnId::ContentHash, "made up");
            }
            4 => *cells = Cells::new(Status::Pending),
            5 => cells.set(ColumnId::PeakVz, Value::Null),
            _ => {}
        },
        &[6, 7],
    )
}

fn says(texts: &[String], text: &str) -> bool {
    texts.iter().any(|shown| shown == text)
}

#[test]
fn every_point_of_a_measure_is_shown_with_its_outcome() {
    let table = mixed();
    let texts =
        check::figure(&over::svg(&source(&table), "peak_vz", "mass_flow_rate", &[]).unwrap());
    for text in [
        "mass_flow_rate (g/s)",
        "peak_vz (m/s)",
        "N, strategy",
        "5, direct",
        "6, rapid",
        "deployed (5)",
        "partial (1)",
        "stalled (1)",
        "failed: step_limit (1)",
        "infeasible (2)",
        "pending (1)",
        "done, measure never happened (1)",
        "residual_gas_mass goes with strategy.",
    ] {
        assert!(says(&texts, text), "{text}: {texts:?}");
    }
    assert!(!says(&texts, "300") && !says(&texts, "200"), "a failed job's peak is none: {texts:?}");
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
    assert!(says(&texts, "strategy direct") && says(&texts, "strategy rapid"), "{texts:?}");
    assert!(says(&texts, "One panel for each of strategy: nothing is averaged."), "{texts:?}");
}

#[test]
fn a_measure_over_names_stands_over_them() {
    let table = mixed();
    let texts = check::figure(&over::svg(&source(&table), "peak_vz", "strategy", &[]).unwrap());
    assert!(
        says(&texts, "direct") && says(&texts, "rapid") && says(&texts, "5, 1 g/s"),
        "{texts:?}"
    );
}

#[test]
fn a_map_says_each_value_and_each_outcome() {
    let table = mixed();
    let svg = map::svg(&source(&table), "peak_vz", ["mass_flow_rate", "N"]).unwrap();
    let texts = check::figure(&svg);
    for text in [
        "strategy direct",
        "peak_vz (m/s)",
        "mass_flow_rate (g/s)",
        "20.0",
        "31.0",
        "∅",
        "S",
        "P",
        "failed: step_limit (1)",
        "infeasible (2)",
        "partial (1)",
    ] {
        assert!(says(&texts, text), "{text}: {texts:?}");
    }
    assert!(!says(&texts, "300"), "a failed job's measure is no value: {texts:?}");
    let fixed = Source { rows: vec![0, 2, 8], ..source(&table) };
    let texts = check::figure(&map::svg(&fixed, "peak_vz", ["mass_flow_rate", "N"]).unwrap());
    assert!(says(&texts, "no such point in the study"), "{texts:?}");
}

/// Histories made up for the jobs asked for.
#[expect(clippy::unnecessary_wraps, reason = "the shape charts read through")]
fn read(id: &JobId) -> Result<StoredHistory> {
    let deployment = fixture::deployment(u32::from(id.as_str().as_bytes()[0]), 900);
    Ok(StoredHistory {
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
fn histories_are_labelled_by_what_differs() {
    let table = mixed();
    let columns = ["z_rim", "pressure", "smallest_gap"].map(str::to_owned);
    let svg = history::svg(&source(&table), &columns, [None, None], &read).unwrap();
    let texts = check::figure(&svg);
    for text in [
        "N, mass_flow_rate, strategy",
        "5, 1 g/s, direct",
        "5, 1 g/s, rapid (partial)",
        "5, 2 g/s, rapid (step_limit)",
        "time (ms)",
        "z_rim (m)",
        "pressure (Pa)",
        "smallest_gap (mm)",
        "mean height of the top ring",
        "end of a run that failed",
    ] {
        assert!(says(&texts, text), "{text}: {texts:?}");
    }
    let missing = "residual_gas_mass goes with strategy.";
    assert!(says(&texts, missing), "{texts:?}");
    assert!(says(&texts, "Without a history: 1 pending, 2 infeasible."), "{texts:?}");

    let cut = history::svg(&source(&table), &columns[..1], [Some(0.1), Some(0.2)], &read).unwrap();
    let texts = check::figure(&cut);
    assert!(says(&texts, "100") && says(&texts, "200") && !says(&texts, "300"), "{texts:?}");
}

#[test]
fn nothing_to_draw_is_said_in_words() {
    let none = study(|_, cells| *cells = Cells::new(Status::Pending), &[]);
    let say =
        |svg: String| check::figure(&svg).iter().any(|text| text.starts_with("nothing to draw"));
    assert!(say(over::svg(&source(&none), "peak_vz", "N", &[]).unwrap()));
    assert!(say(history::svg(&source(&none), &["z_rim".to_owned()], [None; 2], &read).unwrap()));
    let texts = check::figure(&map::svg(&source(&none), "peak_vz", ["N", "strategy"]).unwrap());
    assert!(says(&texts, "No job here has a value of peak_vz."), "{texts:?}");
}

#[test]
fn what_cannot_be_drawn_is_refused_with_what_would_do() {
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
            "no time is between",
        ),
    ] {
        let error = result.unwrap_err();
        assert!(
            matches!(error, Error::Input(_)) && error.to_string().contains(expected),
            "{error}"
        );
    }
    let many = Source { rows: (0..12).cycle().take(60).collect(), ..source.clone() };
    let error = history::svg(&many, &columns("vz"), [None; 2], &read).unwrap_err().to_string();
    assert!(error.contains("20 jobs at most"), "{error}");
}

#[test]
fn a_study_gets_the_charts_that_fit_it() {
    let table = mixed();
    let (kinds, notes) = standard::kinds(&source(&table));
    let names: Vec<String> = kinds.iter().map(Kind::file_name).collect();
    assert_eq!(
        names,
        [
            "history-z_rim",
            "history-vz",
            "history-pressure",
            "peak_vz-over-mass_flow_rate",
            "peak_vz-map-mass_flow_rate-N"
        ]
    );
    assert!(notes.is_empty(), "{notes:?}");
    let dotted = Kind::Over("a".to_owned(), "film/../x".to_owned(), Vec::new());
    assert_eq!(dotted.file_name(), "a-over-film_.._x");
}
