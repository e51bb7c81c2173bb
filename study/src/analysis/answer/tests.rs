//! The answer of an invented table.

use super::*;
use crate::job::row::CellType;
use crate::store::table::Column;

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
            column(
                "t_90_z_rim_since_release",
                CellType::Number,
                numbers(&[4., 2., 6., 3., 0., 9., 0.1, 9.]),
            ),
            column(
                "peak_kinetic_energy",
                CellType::Number,
                numbers(&[10., 20., 30., 40., 0., 5., 99., 5.]),
            ),
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
    let answer = Answer::of_jobs(&table(), &[]);
    let counts = &answer.counts;
    assert_eq!((counts.jobs(), counts.failed(), counts.of(Status::Infeasible)), (7, 1, 1));
    let verdicts = (counts.verdict["deployed"], counts.verdict["stalled"], counts.near_threshold);
    assert_eq!(verdicts, (4, 1, 1));
    let fastest = answer.fastest.unwrap();
    // Job b is faster, but the numerics damped it.
    assert_eq!((fastest.job.as_str(), fastest.value), ("d", 3.0));
    let (name, value, _) = &fastest.parameters[0];
    assert_eq!((name.as_str(), value), ("flow", &Value::Number(2.0)));
    assert_eq!(answer.most_energy.unwrap().job, "d");
    let trust = answer.trust.unwrap();
    assert_eq!((trust.jobs, trust.ledger_residual, trust.passages), (6, 3e-9, None));
    assert_eq!(trust.numerically_damped, 1, "failed jobs do not count");
    assert_eq!(trust.not_trusted, 1);
}

#[test]
fn the_hardest_job_can_be_trusted_where_any_can() {
    let mut table = table();
    let energy = table.columns.iter().position(|column| column.name == "peak_kinetic_energy");
    table.columns[energy.unwrap()].cells[1] = Value::Number(400.0);
    let most = Answer::of_jobs(&table, &[]).most_energy.unwrap();
    assert_eq!((most.job.as_str(), most.trusted), ("d", true), "job b is damped");

    let damped = table.columns.iter_mut().find(|column| column.name == "numerically_damped");
    damped.unwrap().cells.fill(Value::Bool(true));
    let answer = Answer::of_jobs(&table, &[]);
    let most = answer.most_energy.unwrap();
    assert_eq!((most.job.as_str(), most.trusted), ("b", false), "no job can be trusted");
    assert_eq!(answer.trust.unwrap().not_trusted, 6);
}

fn effects(table: &Table) -> Effects {
    let rows: Vec<usize> = (0..table.rows()).collect();
    Effects::of(table, &rows, &[], &HEADLINE, &|_| Vec::new())
}

fn effect<'a>(effects: &'a Effects, parameter: &str) -> &'a Effect {
    effects.effects.iter().find(|effect| effect.parameter == parameter).unwrap()
}

/// Jobs `a`, `b`, … of parameters `strategy`, `mass`: done, deployed, with these measures.
fn study(rows: &[(&str, f64, f64, f64)]) -> Table {
    let text = |text: &str| Value::Text(text.to_owned());
    let ids = (0..rows.len()).map(|row| text(&row.to_string())).collect();
    let numbers = |of: fn(&(&str, f64, f64, f64)) -> f64| {
        rows.iter().map(|row| Value::Number(of(row))).collect()
    };
    let all = |cell: Value| vec![cell; rows.len()];
    Table {
        columns: vec![
            column("job", CellType::Text, ids),
            column("strategy", CellType::Text, rows.iter().map(|row| text(row.0)).collect()),
            column("mass", CellType::Number, numbers(|row| row.1)),
            column("status", CellType::Text, all(text("done"))),
            column("verdict", CellType::Text, all(text("deployed"))),
            column(HEADLINE[0].name(), CellType::Number, numbers(|row| row.2)),
            column(HEADLINE[1].name(), CellType::Number, numbers(|row| row.3)),
            column("passages", CellType::Integer, all(Value::Integer(0))),
        ],
    }
}

#[test]
fn medians_are_taken_over_sets_in_which_every_value_is_done() {
    let mut table = table();
    let damped = table.columns.iter_mut().find(|c| c.name == "numerically_damped").unwrap();
    damped.cells.fill(Value::Bool(false));
    let effects = effects(&table);
    let flow = effect(&effects, "flow");
    assert_eq!(flow.measures[0].sets, 2, "mass 2 and 3 have no done job at flow 1");
    let medians: Vec<_> = flow.measures.iter().map(|measure| measure.medians.clone()).collect();
    assert_eq!(medians, [[Some(5.0), Some(2.5)], [Some(20.0), Some(30.0)]]);
    let mass = effect(&effects, "mass");
    assert_eq!((mass.measures[0].sets, mass.values.len()), (1, 4), "only flow 2 has all four");
}

#[test]
fn one_point_outside_the_grid_removes_no_parameter() {
    let grid = [
        ("delayed", 1.0, 5.0, 10.0),
        ("delayed", 2.0, 4.0, 12.0),
        ("rapid", 1.0, 3.0, 20.0),
        ("rapid", 2.0, 2.0, 22.0),
    ];
    let without = effects(&study(&grid));
    let with = effects(&study(&[&grid[..], &[("direct", 0.0, 1.0, 30.0)]].concat()));
    for parameter in ["strategy", "mass"] {
        let (without, with) = (effect(&without, parameter), effect(&with, parameter));
        for (without, with) in without.measures.iter().zip(&with.measures) {
            assert_eq!((with.sets, &with.medians[..2]), (2, &without.medians[..]));
            assert_eq!((with.medians.len(), with.medians[2]), (3, None));
            assert_eq!(with.extremes, without.extremes);
        }
        let (value, measure, reason) = &with.left_out[0];
        let outside = if parameter == "mass" { "0" } else { "direct" };
        let value = value.as_ref().unwrap().to_string();
        assert_eq!((value.as_str(), *measure), (outside, HEADLINE[0]));
        assert_eq!(*reason, format!("no job differs from it in {parameter} alone"));
    }
    // A parameter of which no two points differ alone is named.
    let apart = effects(&study(&[("delayed", 1.0, 5.0, 10.0), ("rapid", 2.0, 4.0, 12.0)]));
    assert!(apart.effects.is_empty());
    let reasons: Vec<&str> = apart.not_compared.iter().map(|(_, why)| why.as_str()).collect();
    assert_eq!(
        reasons,
        ["no two points differ in strategy alone", "no two points differ in mass alone"]
    );
}

#[test]
fn values_with_few_partners_leave_the_many_sets_of_the_others() {
    let mut rows: Vec<(&str, f64, f64, f64)> = Vec::new();
    for mass in 1..=9 {
        for strategy in ["delayed", "rapid", "residual"] {
            rows.push((strategy, f64::from(mass), 1.0, 1.0));
        }
    }
    rows.push(("direct", 4.0, 1.0, 1.0));
    let effects = effects(&study(&rows));
    let strategy = effect(&effects, "strategy");
    assert_eq!(strategy.measures[0].sets, 9);
    assert_eq!(strategy.left_out[0].2, "it is in 1 of 9 sets");
}

#[test]
fn a_best_value_deploys_and_is_trusted_in_every_job() {
    let mut table = study(&[
        ("delayed", 1.0, 5.0, 10.0),
        ("delayed", 2.0, 4.0, 12.0),
        ("rapid", 1.0, 3.0, 20.0),
        ("rapid", 2.0, 2.0, 22.0),
        ("residual", 1.0, 6.0, 5.0),
        ("residual", 2.0, 6.0, 6.0),
    ]);
    let strategy_of = |table: &Table| effect(&effects(table), "strategy").clone();
    let judged = |best: &[usize], worst: &[usize]| Extremes::Judged {
        best: best.to_vec(),
        worst: worst.to_vec(),
    };
    let all = strategy_of(&table);
    assert_eq!(all.deployed, [(2, 2); 3]);
    assert_eq!(all.measures[0].extremes, judged(&[1], &[2]));
    assert_eq!(all.measures[1].extremes, judged(&[2], &[1]));

    // One stalled job: its strategy is not the best by its low speed.
    let verdict = table.columns.iter().position(|column| column.name == "verdict").unwrap();
    table.columns[verdict].cells[4] = Value::Text("stalled".to_owned());
    let stalled = strategy_of(&table);
    assert_eq!(stalled.deployed[2], (1, 2));
    assert_eq!(stalled.measures[1].extremes, judged(&[0], &[1]));

    // Film passed through film: the job is no evidence, its set has one value less.
    let passages = table.columns.iter().position(|column| column.name == "passages").unwrap();
    table.columns[passages].cells[3] = Value::Integer(2);
    let untrusted = strategy_of(&table);
    assert_eq!((untrusted.measures[0].sets, untrusted.deployed[1]), (1, (1, 2)));
    assert_eq!(untrusted.measures[0].extremes, judged(&[0], &[2]), "rapid is not the best");

    // The others are equal, within 3 %: all of them are worst.
    let many = study(&[
        ("delayed", 1.0, 5.0, 10.0),
        ("rapid", 1.0, 9.0, 20.0),
        ("residual", 1.0, 9.1, 20.1),
    ]);
    let many = strategy_of(&many);
    assert_eq!(many.measures[0].extremes, judged(&[0], &[2, 1]));

    // One strategy never rises to 90 %: the measure is named, the other one is compared.
    let mut never = study(&[("delayed", 1.0, 5.0, 10.0), ("rapid", 1.0, 5.0, 20.0)]);
    let time = never.columns.iter().position(|column| column.name == HEADLINE[0].name()).unwrap();
    never.columns[time].cells[1] = Value::Null;
    let never = strategy_of(&never);
    assert_eq!(never.measures.len(), 1);
    assert_eq!((&never.left_out[0].0, never.left_out[0].1), (&None, HEADLINE[0]));

    // No model and no mesh is the best one: it is the same capsule.
    let mut models = study(&[("film", 1.0, 5.0, 10.0), ("piston", 1.0, 3.0, 20.0)]);
    let strategy = models.columns.iter().position(|column| column.name == "strategy").unwrap();
    models.columns[strategy].name = "model".to_owned();
    let range = Extremes::Range { lowest: vec![1], highest: vec![0] };
    assert_eq!(effect(&effects(&models), "model").measures[0].extremes, range);

    // Within the spread of the measure there is no best.
    let equal = study(&[("delayed", 1.0, 5.0, 10.0), ("rapid", 1.0, 5.1, 10.1)]);
    let equal = strategy_of(&equal);
    assert!(equal.measures.iter().all(|measure| measure.extremes == Extremes::Equal));
}

#[test]
fn a_set_of_jobs_counts_once_and_a_set_of_one_job_not_at_all() {
    let mut table = study(&[
        ("delayed", 1.0, 5.0, 10.0),
        ("rapid", 1.0, 3.0, 20.0),
        ("delayed", 2.0, 5.0, 10.0),
        ("rapid", 2.0, 3.0, 20.0),
    ]);
    let jobs = ["x", "y", "x", "y"];
    table.columns[0].cells = jobs.map(|job| Value::Text(job.to_owned())).to_vec();
    let effects = effects(&table);
    assert_eq!(effect(&effects, "strategy").measures[0].sets, 1);
    assert_eq!(effect(&effects, "strategy").deployed, [(1, 1); 2]);
    let (parameter, reason) = &effects.not_compared[0];
    assert_eq!(parameter, "mass");
    assert!(reason.starts_with("points that differ in mass alone are one job"), "{reason}");
}

/// Points within the mesh error of the best one count once, whatever the number of their runs, and it does not count.
#[test]
fn points_within_the_mesh_error_of_the_best_one_are_counted_without_replicates() {
    let numbers = |values: &[f64]| values.iter().copied().map(Value::Number).collect();
    let text = |texts: [&str; 6]| texts.map(|text| Value::Text(text.to_owned())).to_vec();
    let integers = |values: [i64; 6]| values.map(Value::Integer).to_vec();
    let table = Table {
        columns: vec![
            column("job", CellType::Text, text(["a", "b", "c", "d", "e", "f"])),
            column("N", CellType::Integer, integers([5, 5, 6, 6, 8, 8])),
            column("seed", CellType::Integer, integers([1, 2, 1, 2, 1, 2])),
            column("status", CellType::Text, text(["done"; 6])),
            column("verdict", CellType::Text, text(["deployed"; 6])),
            column(
                "peak_kinetic_energy",
                CellType::Number,
                numbers(&[9.0, 8.9, 8.8, 8.5, 8.0, 8.2]),
            ),
            column("peak_kinetic_energy_error", CellType::Number, numbers(&[0.5; 6])),
        ],
    };
    let most = |replicates: &[String]| Answer::of_jobs(&table, replicates).most_energy.unwrap();
    let energy = most(&["seed".to_owned()]);
    assert_eq!((energy.job.as_str(), energy.others, energy.within_error), ("a", 0, 1));
    assert_eq!(most(&[]).within_error, 3, "without replicates every run is a point");
}
