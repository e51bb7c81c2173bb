//! The answer of an invented table.

use super::*;
use crate::analysis::fixture;
use crate::analysis::ranking::DEFAULT_MEASURES;
use crate::store::table::ColumnCells;

/// Two flows, two residual masses, one combination infeasible, one job failed.
fn table() -> Table {
    fixture::table(
        "job flow mass status     verdict  near_threshold t_90_z_rim_since_release peak_kinetic_energy ledger_residual passages numerically_damped
         a   1.0  0.0  done       deployed false          4.0                      10.0                1e-9            -        false
         b   2.0  0.0  done       deployed false          2.0                      20.0                3e-9            -        true
         c   1.0  1.0  done       stalled  true           6.0                      30.0                2e-9            -        false
         d   2.0  1.0  done       deployed false          3.0                      40.0                0               -        false
         e   1.0  2.0  infeasible -        -              0                        0                   0               -        false
         f   2.0  2.0  done       partial  false          9.0                      5.0                 0               -        false
         g   1.0  3.0  unstable   -        -              0.1                      99.0                0.5             -        true
         h   2.0  3.0  done       deployed false          9.0                      5.0                 0               -        false",
    )
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
    damped.unwrap().cells = ColumnCells::Same(Value::Bool(true), 8);
    let answer = Answer::of_jobs(&table, &[]);
    let most = answer.most_energy.unwrap();
    assert_eq!((most.job.as_str(), most.trusted), ("b", false), "no job can be trusted");
    assert_eq!(answer.trust.unwrap().not_trusted, 6);
}

/// Jobs `a`, `b`, … of parameters `strategy`, `mass`: done, deployed, with these measures.
fn study(rows: &[(&str, f64, f64, f64)]) -> Table {
    let [time, energy] = HEADLINE.map(ColumnId::name);
    let names = format!("job strategy mass status verdict {time} {energy} passages");
    let row = |(row, (strategy, mass, time, energy)): (usize, &(&str, f64, f64, f64))| {
        format!("{row} {strategy} {mass:?} done deployed {time:?} {energy:?} 0")
    };
    fixture::table_of(&names, rows.iter().enumerate().map(row))
}

/// The values of a parameter, ranked as the answer does.
fn compared(table: &Table, by: &str) -> Result<Ranking, String> {
    comparison(table, &fixture::all(table), by, (&[], &[]), &|_| Vec::new())
}

/// Median of each value that is compared, and the best value, of a headline measure.
fn medians(ranking: &Ranking, measure: usize) -> (Vec<(String, f64)>, Option<String>) {
    let measure = DEFAULT_MEASURES
        .iter()
        .filter(|id| HEADLINE.contains(id))
        .position(|id| *id == HEADLINE[measure])
        .unwrap();
    let name = |position: usize| ranking.candidates[position].values[0].to_string();
    let medians = (0..ranking.candidates.len()).filter_map(|position| {
        Some((name(position), ranking.candidates[position].measures[measure]?.median))
    });
    let mut medians: Vec<(String, f64)> = medians.collect();
    medians.sort_by(|a, b| a.0.cmp(&b.0));
    (medians, ranking.measures[measure].best.map(name))
}

#[test]
fn medians_are_taken_over_sets_in_which_every_value_is_trusted_and_done() {
    let mut table = table();
    let damped = table.columns.iter_mut().find(|c| c.name == "numerically_damped").unwrap();
    damped.cells = ColumnCells::Same(Value::Bool(false), 8);
    let flow = compared(&table, "flow").unwrap();
    let (one, two) = ("1".to_owned(), "2".to_owned());
    // Mass 2 has no job at flow 1, and the failed job at mass 3 has no measure.
    assert_eq!(flow.measures[0].sets, 2);
    assert_eq!(medians(&flow, 0).0, [(one.clone(), 5.0), (two.clone(), 2.5)]);
    assert_eq!(medians(&flow, 1).0, [(one, 20.0), (two, 30.0)]);
}

#[test]
fn one_point_outside_the_grid_removes_no_parameter() {
    let grid = [
        ("delayed", 1.0, 5.0, 10.0),
        ("delayed", 2.0, 4.0, 12.0),
        ("rapid", 1.0, 3.0, 20.0),
        ("rapid", 2.0, 2.0, 22.0),
    ];
    let without = study(&grid);
    let with = study(&[&grid[..], &[("direct", 0.0, 1.0, 30.0)]].concat());
    for parameter in ["strategy", "mass"] {
        let [with, without] = [&with, &without].map(|table| compared(table, parameter).unwrap());
        assert_eq!((&with.candidates, with.sets), (&without.candidates, 2));
        let outside = if parameter == "mass" { "0" } else { "direct" };
        let (values, reason) = &with.left_out[0];
        assert_eq!(
            (values[0].to_string().as_str(), reason.as_str()),
            (outside, "it is in 1 of 3 sets of equal conditions")
        );
    }
    // A parameter of which no two points differ alone is named.
    let apart = study(&[("delayed", 1.0, 5.0, 10.0), ("rapid", 2.0, 4.0, 12.0)]);
    let reason = compared(&apart, "strategy").unwrap_err();
    assert!(reason.contains("equal in all other parameters"), "{reason}");
}

#[test]
fn a_best_value_deploys_in_every_point_and_is_not_a_method() {
    let mut table = study(&[
        ("delayed", 1.0, 5.0, 10.0),
        ("delayed", 2.0, 4.0, 12.0),
        ("rapid", 1.0, 3.0, 20.0),
        ("rapid", 2.0, 2.0, 22.0),
        ("residual", 1.0, 6.0, 5.0),
        ("residual", 2.0, 6.0, 6.0),
    ]);
    let best = |table: &Table, measure| medians(&compared(table, "strategy").unwrap(), measure).1;
    assert_eq!([0, 1].map(|measure| best(&table, measure).unwrap()), ["rapid", "residual"]);
    // One stalled job: its strategy is not the best by its low speed.
    let verdict = table.columns.iter().position(|column| column.name == "verdict").unwrap();
    table.columns[verdict].cells[4] = Value::Text("stalled".to_owned());
    assert_eq!(best(&table, 1).unwrap(), "delayed");
    // Film passed through film: the job is no evidence, and its set has no value of rapid.
    let passages = table.columns.iter().position(|column| column.name == "passages").unwrap();
    table.columns[passages].cells[3] = Value::Integer(2);
    assert_eq!(compared(&table, "strategy").unwrap().measures[0].sets, 1);
    // No model and no mesh is the best one: it is the same capsule.
    let mut models = study(&[("film", 1.0, 5.0, 10.0), ("piston", 1.0, 3.0, 20.0)]);
    "model".clone_into(&mut models.columns[1].name);
    assert_eq!(medians(&compared(&models, "model").unwrap(), 0).1, None);
    // Pair by pair against the best; within the spread of the measure values are equal.
    let three = study(&[("a", 1.0, 5.0, 10.0), ("b", 1.0, 5.1, 20.0), ("c", 1.0, 9.0, 10.1)]);
    let three = compared(&three, "strategy").unwrap();
    let time = three.measures.iter().find(|m| m.column.name == HEADLINE[0].name()).unwrap();
    let of =
        |name: &str| three.candidates.iter().position(|c| c.values[0].to_string() == name).unwrap();
    assert_eq!((time.equal[of("b")], time.equal[of("c")]), (true, false));
    let worse = time.against_best[of("c")].as_ref().unwrap();
    assert_eq!((worse.pairs(), worse.count(compare::Better::Base)), (1, 1));
    assert_eq!(worse.ratio.unwrap().median.to_bits(), 1.8_f64.to_bits());
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
    table.columns[0].cells = jobs.map(|job| Value::Text(job.to_owned())).to_vec().into();
    assert_eq!(compared(&table, "strategy").unwrap().measures[0].sets, 1);
    assert_eq!(
        compared(&table, "mass").unwrap_err(),
        "points that differ in mass alone are one job"
    );
}

/// Points within the mesh error of the best one count once, whatever the number of their runs, and it does not count.
#[test]
fn points_within_the_mesh_error_of_the_best_one_are_counted_without_replicates() {
    let table = fixture::table(
        "job N seed status verdict  peak_kinetic_energy peak_kinetic_energy_error_below peak_kinetic_energy_error_above
         a   5 1    done   deployed 9.0                 0.5                             0.1
         b   5 2    done   deployed 8.9                 0.5                             0.1
         c   6 1    done   deployed 8.8                 0.1                             0.5
         d   6 2    done   deployed 8.5                 0.1                             0.5
         e   8 1    done   deployed 8.0                 0.5                             0.1
         f   8 2    done   deployed 8.2                 0.5                             0.1",
    );
    let most = |replicates: &[String]| Answer::of_jobs(&table, replicates).most_energy.unwrap();
    let energy = most(&["seed".to_owned()]);
    assert_eq!((energy.job.as_str(), energy.others, energy.within_mesh_error), ("a", 0, 1));
    assert_eq!(most(&[]).within_mesh_error, 3, "without replicates every run is a point");
}
