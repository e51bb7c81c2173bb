//! The answer of a study, as far as its table can give one: how many deploy, which job is fastest,
//! which hits hardest, what the results are worth, and what each parameter does, all else equal.

use crate::analysis::compare::{self, Sets};
use crate::analysis::statistics::Spread;
use crate::input::value::Value;
use crate::job::point::Point;
use crate::job::row::{self, Counts};
use crate::store::stored::Stored;
use crate::store::table::{Column, Table};

/// Measures of which medians are given: how fast, how hard.
pub const MEDIANS: [&str; 2] = ["t_90_z_rim", "peak_vz"];
/// A parameter with more values is a curve, for a chart.
const MOST_VALUES: usize = 6;

/// What a study's table says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Answer {
    /// The question, in the words of the study file.
    pub question: String,
    /// How the rows ended.
    pub counts: Counts,
    /// The done job with the least `t_90_z_rim`.
    pub fastest: Option<Extreme>,
    /// The one with the largest `peak_vz`.
    pub hardest: Option<Extreme>,
    /// The one with the largest `peak_kinetic_energy`.
    pub most_energy: Option<Extreme>,
    /// What the done jobs are worth.
    pub trust: Option<Trust>,
    /// Largest film stress of a done job over Young's modulus: what the linear law of the film is asked to
    /// bear.
    pub stretch: f64,
    /// What each parameter of two to six values does.
    pub effects: Vec<Effect>,
}

/// The job that is first in a measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Extreme {
    /// Its id.
    pub job: String,
    /// Its parameters.
    pub parameters: Vec<(String, Value)>,
    /// The measure, SI.
    pub value: f64,
    /// How many other jobs have the same, but for rounding.
    pub others: usize,
}

/// The audit over all done jobs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trust {
    /// How many are done.
    pub jobs: usize,
    /// Largest energy ledger residual.
    pub ledger_residual: f64,
    /// Largest gas balance residual.
    pub gas_residual: f64,
    /// Film through film, all jobs; `None` where no model counted.
    pub passages: Option<i64>,
    /// Intersections at the worst frame of each job, summed; `None` where no model looked.
    pub intersections: Option<i64>,
    /// Jobs that counted passages.
    pub counted: usize,
}

/// Medians by the values of one parameter, each over the same sets of jobs equal in all else.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// The parameter.
    pub parameter: String,
    /// Its SI unit; "1" for a pure number, empty for a word.
    pub unit: String,
    /// Parameters that change with it.
    pub carried: Vec<String>,
    /// Sets in which every value has a done job.
    pub sets: usize,
    /// Values, and the median of each of [`MEDIANS`].
    pub values: Vec<(Value, [Option<f64>; MEDIANS.len()])>,
}

impl Answer {
    /// Reads the answer off a results folder.
    pub fn of(stored: &Stored<'_>) -> Self {
        let table = stored.table();
        let mut answer = Self::of_jobs(&table);
        answer.question.clone_from(&stored.study.question);
        answer.stretch = stretch(stored);
        answer.effects = effects(&stored.table_of_all_points(), &|parameter| {
            stored.study.zipped_with(parameter)
        });
        answer
    }

    /// All but the question, the stretch and the effects.
    fn of_jobs(table: &Table) -> Self {
        let mut answer = Self::default();
        let rows: Vec<usize> = (0..table.rows()).collect();
        for row in &rows {
            let verdict = match cell(table, "verdict", *row) {
                Some(Value::Text(verdict)) => verdict.as_str(),
                _ => "",
            };
            let close = cell(table, "close", *row) == Some(&Value::Bool(true));
            answer.counts.add(compare::status(table, *row), verdict, close);
        }
        answer.fastest = extreme(table, "t_90_z_rim", |one, best| one < best);
        answer.hardest = extreme(table, "peak_vz", |one, best| one > best);
        answer.most_energy = extreme(table, "peak_kinetic_energy", |one, best| one > best);
        answer.trust = trust(table, &rows);
        answer
    }
}

fn cell<'a>(table: &'a Table, name: &str, row: usize) -> Option<&'a Value> {
    table.column(name).map(|column| &column.cells[row])
}

/// The first of the done jobs no other is better than.
fn extreme(table: &Table, measure: &str, better: fn(f64, f64) -> bool) -> Option<Extreme> {
    let column = table.column(measure)?;
    let mut best: Option<(usize, f64)> = None;
    for row in 0..table.rows() {
        let Some(value) = compare::measured(table, column, row) else { continue };
        if best.is_none_or(|(_, best)| better(value, best)) {
            best = Some((row, value));
        }
    }
    let (row, value) = best?;
    let same = |other: f64| (other - value).abs() <= compare::TIE * value.abs();
    let measured = (0..table.rows()).filter_map(|row| compare::measured(table, column, row));
    let others = measured.filter(|other| same(*other)).count().saturating_sub(1);
    let parameters = table.parameters();
    Some(Extreme {
        job: cell(table, "job", row)?.to_string(),
        parameters: parameters.map(|own| (own.name.clone(), own.cells[row].clone())).collect(),
        value,
        others,
    })
}

/// Largest film stress over Young's modulus of the done jobs.
fn stretch(stored: &Stored<'_>) -> f64 {
    let of = |point: &Point| {
        let cells = stored.cells(point);
        let modulus = point.job.scene.film.youngs_modulus;
        match cells.get("film_stress") {
            Value::Number(stress) if cells.status() == row::DONE => stress / modulus,
            _ => 0.0,
        }
    };
    stored.points.iter().map(of).fold(0.0, f64::max)
}

fn trust(table: &Table, rows: &[usize]) -> Option<Trust> {
    let done: Vec<usize> =
        rows.iter().copied().filter(|row| compare::status(table, *row) == row::DONE).collect();
    let largest = |name: &str| {
        let column = table.column(name);
        let values = column.into_iter().flat_map(|column| {
            done.iter().filter_map(|row| compare::measured(table, column, *row))
        });
        Spread::of(values).map_or(0.0, |spread| spread.largest)
    };
    let counts = |name: &str| -> Vec<i64> {
        let whole = |row: &usize| match cell(table, name, *row) {
            Some(Value::Integer(count)) => Some(*count),
            _ => None,
        };
        done.iter().filter_map(whole).collect()
    };
    let total = |counts: &[i64]| (!counts.is_empty()).then(|| counts.iter().sum());
    let passages = counts("passages");
    (!done.is_empty()).then(|| Trust {
        jobs: done.len(),
        ledger_residual: largest("ledger_residual"),
        gas_residual: largest("gas_residual"),
        passages: total(&passages),
        intersections: total(&counts("intersections")),
        counted: passages.len(),
    })
}

/// Medians by the values of each parameter that has two to six.
fn effects(table: &Table, zipped: &dyn Fn(&str) -> Vec<String>) -> Vec<Effect> {
    let rows: Vec<usize> = (0..table.rows()).collect();
    let parameters = table.parameters().filter_map(|column| {
        let values = compare::values(column, &rows);
        let few = (2..=MOST_VALUES).contains(&values.len());
        few.then(|| effect(table, column, &values, &zipped(&column.name)))
    });
    parameters.filter(|effect| effect.sets > 0).collect()
}

fn effect(table: &Table, parameter: &Column, values: &[Value], zipped: &[String]) -> Effect {
    let done: Vec<usize> =
        (0..table.rows()).filter(|row| compare::status(table, *row) == row::DONE).collect();
    let mut sets = Sets::new(table, &done, &parameter.name, zipped);
    sets.sets.retain(|set| set.len() == values.len());
    let median = |value: &Value, measure: &str| {
        let measure = table.column(measure)?;
        let own =
            sets.sets.iter().flatten().filter(|row| {
                compare::canonical(&parameter.cells[**row]) == compare::canonical(value)
            });
        let numbers = own.filter_map(|row| compare::measured(table, measure, *row));
        Spread::of(numbers).map(|spread| spread.median)
    };
    Effect {
        values: values
            .iter()
            .map(|value| (value.clone(), MEDIANS.map(|measure| median(value, measure))))
            .collect(),
        parameter: parameter.name.clone(),
        unit: parameter.unit.clone(),
        sets: sets.sets.len(),
        carried: sets.carried,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::row::Kind;

    fn column(name: &str, kind: Kind, cells: Vec<Value>) -> Column {
        Column { name: name.to_owned(), kind, unit: String::new(), meaning: String::new(), cells }
    }

    /// Two flows, two residual masses, one combination infeasible, one job failed.
    fn table() -> Table {
        let text =
            |texts: &[&str]| texts.iter().map(|own| Value::Text((*own).to_owned())).collect();
        let numbers = |own: &[f64]| own.iter().map(|own| Value::Number(*own)).collect();
        let done = ["done", "done", "done", "done", "infeasible", "done", "unstable", "done"];
        let verdict = ["deployed", "deployed", "stalled", "deployed"].map(str::to_owned);
        let mut verdict: Vec<Value> = verdict.into_iter().map(Value::Text).collect();
        verdict.extend([Value::Null, Value::Text("partial".to_owned()), Value::Null]);
        verdict.push(Value::Text("deployed".to_owned()));
        Table {
            columns: vec![
                column("job", Kind::Text, text(&["a", "b", "c", "d", "e", "f", "g", "h"])),
                column("flow", Kind::Number, numbers(&[1., 2., 1., 2., 1., 2., 1., 2.])),
                column("mass", Kind::Number, numbers(&[0., 0., 1., 1., 2., 2., 3., 3.])),
                column("status", Kind::Text, text(&done)),
                column("verdict", Kind::Text, verdict),
                column(
                    "close",
                    Kind::Bool,
                    (0..8)
                        .map(
                            |row| {
                                if row == 4 || row == 6 {
                                    Value::Null
                                } else {
                                    Value::Bool(row == 2)
                                }
                            },
                        )
                        .collect(),
                ),
                column("t_90_z_rim", Kind::Number, numbers(&[4., 2., 6., 3., 0., 9., 0.1, 9.])),
                column("peak_vz", Kind::Number, numbers(&[10., 20., 30., 40., 0., 5., 99., 5.])),
                column(
                    "ledger_residual",
                    Kind::Number,
                    numbers(&[1e-9, 3e-9, 2e-9, 0., 0., 0., 0.5, 0.]),
                ),
                column("passages", Kind::Integer, vec![Value::Null; 8]),
            ],
        }
    }

    #[test]
    fn only_done_jobs_are_fastest_hardest_or_trusted() {
        let answer = Answer::of_jobs(&table());
        let counts = &answer.counts;
        assert_eq!((counts.jobs(), counts.failed(), counts.of("infeasible")), (7, 1, 1));
        let verdicts = (counts.verdict["deployed"], counts.verdict["stalled"], counts.close);
        assert_eq!(verdicts, (4, 1, 1));
        let fastest = answer.fastest.unwrap();
        assert_eq!((fastest.job.as_str(), fastest.value), ("b", 2.0));
        assert_eq!(fastest.parameters[0], ("flow".to_owned(), Value::Number(2.0)));
        assert_eq!(answer.hardest.unwrap().job, "d");
        let trust = answer.trust.unwrap();
        assert_eq!((trust.jobs, trust.ledger_residual, trust.passages), (6, 3e-9, None));
    }

    #[test]
    fn medians_are_over_sets_in_which_every_value_is_done() {
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
}
