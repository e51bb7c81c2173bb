//! The answer of an invented table.

use super::*;
use crate::job::row::CellType;

fn column(name: &str, cell_type: CellType, cells: Vec<Value>) -> Column {
    Column {
        name: name.to_owned(),
        cell_type,
        unit: String::new(),
        shown: crate::input::units::DisplayUnit::si(""),
        meaning: String::new(),
        cells,
    }
}

/// Two flows, two residual masses, one combination infeasible, one job failed.
fn table() -> Table {
    let text = |texts: &[&str]| texts.iter().map(|text| Value::Text((*text).to_owned())).collect();
    let numbers = |numbers: &[f64]| numbers.iter().map(|x| Value::Number(*x)).collect();
    let done = ["done", "done", "done", "done", "infeasible", "done", "unstable", "done"];
    let verdict = ["deployed", "deployed", "stalled", "deployed"].map(str::to_owned);
    let mut verdict: Vec<Value> = verdict.into_iter().map(Value::Text).collect();
    verdict.extend([Value::Null, Value::Text("partial".to_owned()), Value::Null]);
    verdict.push(Value::Text("deployed".to_owned()));
    Table {
        columns: vec![
            column("job", CellType::Text, text(&["a", "b", "c", "d", "e", "f", "g", "h"])),
            column("flow", CellType::Number, numbers(&[1., 2., 1., 2., 1., 2., 1., 2.])),
            column("mass", CellType::Number, numbers(&[0., 0., 1., 1., 2., 2., 3., 3.])),
            column("status", CellType::Text, text(&done)),
            column("verdict", CellType::Text, verdict),
            column(
                "near_threshold",
                CellType::Bool,
                (0..8)
                    .map(
                        |row| {
                            if row == 4 || row == 6 { Value::Null } else { Value::Bool(row == 2) }
                        },
                    )
                    .collect(),
            ),
            column("t_90_z_rim", CellType::Number, numbers(&[4., 2., 6., 3., 0., 9., 0.1, 9.])),
            column("peak_vz", CellType::Number, numbers(&[10., 20., 30., 40., 0., 5., 99., 5.])),
            column(
                "ledger_residual",
                CellType::Number,
                numbers(&[1e-9, 3e-9, 2e-9, 0., 0., 0., 0.5, 0.]),
            ),
            column("passages", CellType::Integer, vec![Value::Null; 8]),
            column(
                "numerically_damped",
                CellType::Bool,
                (0..8).map(|row| Value::Bool(row == 1 || row == 6)).collect(),
            ),
        ],
    }
}

#[test]
fn only_done_jobs_enter_extremes_and_audit() {
    let answer = Answer::of_jobs(&table());
    let counts = &answer.counts;
    assert_eq!((counts.jobs(), counts.failed(), counts.of(Status::Infeasible)), (7, 1, 1));
    let verdicts = (counts.verdict["deployed"], counts.verdict["stalled"], counts.near_threshold);
    assert_eq!(verdicts, (4, 1, 1));
    let fastest = answer.fastest.unwrap();
    assert_eq!((fastest.job.as_str(), fastest.value), ("b", 2.0));
    assert_eq!(fastest.parameters[0], ("flow".to_owned(), Value::Number(2.0)));
    assert_eq!(answer.hardest.unwrap().job, "d");
    let trust = answer.trust.unwrap();
    assert_eq!((trust.jobs, trust.ledger_residual, trust.passages), (6, 3e-9, None));
    assert_eq!(trust.numerically_damped, 1, "failed jobs do not count");
}

#[test]
fn medians_are_taken_over_sets_in_which_every_value_is_done() {
    let effects = effects(&table(), &|_| Vec::new());
    let flow = effects.iter().find(|effect| effect.parameter == "flow").unwrap();
    assert_eq!(flow.sets, 2, "mass 2 and 3 have no done job at flow 1");
    assert_eq!(
        flow.values,
        [
            (Value::Number(1.0), [Some(5.0), Some(20.0)]),
            (Value::Number(2.0), [Some(2.5), Some(30.0)])
        ]
    );
    let mass = effects.iter().find(|effect| effect.parameter == "mass").unwrap();
    assert_eq!((mass.sets, mass.values.len()), (1, 4), "only flow 2 has all four");
}
