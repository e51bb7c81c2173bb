//! The scenes of a study's table.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use billow_solver::integrators::entry;
use billow_solver::scene::IntegratorKind;

use super::{Configuration, Course, Ending, Outcome, Quantity, Run, SceneRuns};
use crate::accuracy::{PROMISED, Promised};
use crate::analysis::values::canonical;
use crate::input::keys::numerical::{self, INTEGRATOR, MESH, MODEL, SEED};
use crate::input::keys::{MODELS, ignored_by_integrator};
use crate::input::value::Value;
use crate::job::Status;
use crate::job::row::ColumnId;
use crate::store::table::{Column, Table};

/// The columns of the history that are compared over time, and their units.
pub const COURSES: [(&str, &str, &str); 2] =
    [("z_rim", "m", "height of the top ring over time"), ("volume", "m3", "volume over time")];

/// What the history of a job says.
#[derive(Debug, Clone)]
pub struct Histories {
    /// The courses of [`COURSES`].
    pub courses: [Option<Arc<Course>>; 2],
    /// Simulated time, s.
    pub simulated: f64,
    /// Whether an implicit integrator took over within the run.
    pub implicit: bool,
}

/// The columns of a table by their part.
struct Parts<'a> {
    /// Parameters of the physics, which give the scene.
    physical: Vec<&'a Column>,
    /// Numerical parameters, which give the configuration.
    numerical: Vec<&'a Column>,
    /// Parameters that repeat a run.
    repeating: Vec<&'a Column>,
}

impl<'a> Parts<'a> {
    fn of(table: &'a Table, replicates: &[String]) -> Self {
        let mut parts = Self { physical: Vec::new(), numerical: Vec::new(), repeating: Vec::new() };
        for column in table.parameters() {
            let path = numerical::path(&column.name);
            if replicates.contains(&column.name) || path == Some(SEED) {
                parts.repeating.push(column);
            } else if numerical::is_of_method(&column.name) {
                parts.numerical.push(column);
            } else {
                parts.physical.push(column);
            }
        }
        parts
    }

    /// Numerical parameters that differ only between scenes become part of them. Models and meshes stay.
    fn give_to_scenes(&mut self, groups: &[(Vec<String>, Vec<usize>)]) {
        let constant = |column: &Column, rows: &[usize]| {
            rows.iter()
                .all(|row| canonical(&column.cells[*row]) == canonical(&column.cells[rows[0]]))
        };
        let of_scenes = |column: &&Column| {
            let kept = [Some(MODEL), Some(MESH)].contains(&numerical::path(&column.name));
            let all: Vec<usize> = groups.iter().flat_map(|(_, rows)| rows.clone()).collect();
            let within = groups.iter().all(|(_, rows)| constant(column, rows));
            !kept && within && !constant(column, &all)
        };
        let (given, kept): (Vec<&Column>, Vec<&Column>) =
            self.numerical.iter().copied().partition(of_scenes);
        self.physical.extend(given);
        self.numerical = kept;
    }

    /// The word of a row for a numerical key; `None` where the key is no parameter.
    fn word(&self, path: &str, row: usize) -> Option<&str> {
        let column = self.numerical.iter().find(|one| numerical::path(&one.name) == Some(path))?;
        match &column.cells[row] {
            Value::Text(word) => Some(word),
            _ => None,
        }
    }

    /// Keys that change no result of the model of a row, or of its integrator.
    fn ignored(&self, row: usize) -> Vec<&'static str> {
        let name = self.word(MODEL, row);
        let model = MODELS.iter().find(|model| name == Some(model.name));
        let of_model = model.map_or(&[][..], |model| model.ignores);
        if of_model.contains(&INTEGRATOR) {
            return of_model.to_vec();
        }
        let of_integrator = self.word(INTEGRATOR, row).map_or(&[][..], ignored_by_integrator);
        [of_model, of_integrator].concat()
    }

    /// Names and values of some parameters; null for those that the model or the integrator ignores.
    fn values(&self, columns: &[&Column], row: usize) -> Configuration {
        let ignored = self.ignored(row);
        let value = |column: &&Column| {
            let path = numerical::path(&column.name).unwrap_or("");
            let value = if ignored.contains(&path) { &Value::Null } else { &column.cells[row] };
            (column.name.clone(), value.clone())
        };
        columns.iter().map(value).collect()
    }
}

/// The scenes of a table, in the order of their first rows; a single one has the name of the study. `histories` reads
/// what the history of a job says.
pub fn scenes(
    study: &str,
    table: &Table,
    replicates: &[String],
    histories: &dyn Fn(&str) -> Option<Histories>,
) -> Vec<SceneRuns> {
    let mut parts = Parts::of(table, replicates);
    let mut groups: Vec<(Vec<String>, Vec<usize>)> = Vec::new();
    for row in 0..table.rows() {
        let key: Vec<String> =
            parts.physical.iter().map(|column| canonical(&column.cells[row])).collect();
        match groups.iter_mut().find(|(known, _)| *known == key) {
            Some((_, rows)) => rows.push(row),
            None => groups.push((key, vec![row])),
        }
    }
    parts.give_to_scenes(&groups);
    let firsts: Vec<usize> = groups.iter().map(|(_, rows)| rows[0]).collect();
    let naming = naming(&parts.physical, &firsts);
    let scene = |rows: &[usize]| {
        let (runs, without_result) = runs(table, &parts, rows, histories);
        let (name, meaning) = texts(study, &parts.physical, naming, rows[0]);
        let quantities = quantities();
        SceneRuns { name, meaning, quantities, per_simulated_second: true, runs, without_result }
    };
    groups.iter().map(|(_, rows)| scene(rows)).collect()
}

/// The quantities of every scene of a study.
fn quantities() -> Vec<Quantity> {
    let measures = PROMISED.iter().map(|promised| {
        let column = promised.measure.column();
        (column.name, column.unit, column.meaning, false)
    });
    let courses = COURSES.iter().map(|(name, unit, meaning)| (*name, *unit, *meaning, true));
    let quantity = |(name, unit, meaning, is_course): (&str, &str, &str, bool)| Quantity {
        name: name.to_owned(),
        unit: unit.to_owned(),
        meaning: meaning.to_owned(),
        exact: None,
        is_course,
    };
    measures.chain(courses).map(quantity).collect()
}

/// How the run of a row ended; `None` for one that has not.
fn ending(table: &Table, row: usize) -> Option<Ending> {
    match table.status(row)? {
        Status::Done => {
            let mark = table.audit_mark(row);
            Some(mark.map_or(Ending::Trusted, |column| Ending::Marked(column.name())))
        }
        status => status.is_failure().then_some(Ending::Failed(status)),
    }
}

/// The runs of a scene, each once, and the number of rows that have not ended.
fn runs(
    table: &Table,
    parts: &Parts<'_>,
    rows: &[usize],
    histories: &dyn Fn(&str) -> Option<Histories>,
) -> (Vec<Run>, usize) {
    let (mut found, mut without) = (Vec::new(), 0);
    let mut known: BTreeSet<Vec<String>> = BTreeSet::new();
    for row in rows.iter().copied() {
        let configuration = parts.values(&parts.numerical, row);
        let repeated = parts.values(&parts.repeating, row);
        // A model that ignores the seed has one run.
        let key = configuration.iter().chain(&repeated).map(|(_, value)| canonical(value));
        if !known.insert(key.collect()) {
            continue;
        }
        let Some(ending) = ending(table, row) else {
            without += 1;
            continue;
        };
        let number = |id: ColumnId| table.value(id, row).and_then(Value::any_number);
        let job = match table.column("job").map(|column| &column.cells[row]) {
            Some(Value::Text(id)) => id.as_str(),
            _ => "",
        };
        let history = histories(job);
        let simulated = history.as_ref().map(|history| history.simulated);
        let implicit = parts.word(INTEGRATOR, row) == Some(entry(IntegratorKind::Implicit).name)
            || history.as_ref().is_some_and(|history| history.implicit);
        let seconds = number(ColumnId::WallSeconds)
            .zip(simulated.filter(|time| *time > 0.0))
            .map(|(wall, simulated)| wall / simulated);
        let measures =
            PROMISED.iter().map(|promised| number(promised.measure).map(Outcome::Number));
        // Of courses no mesh error is known.
        let mesh_error = |promised: &Promised| {
            let [below, above] = promised.error_columns.map(|name| number_in(table, name, row));
            let error = below?.max(above?);
            number(promised.measure)
                .filter(|value| *value != 0.0)
                .map(|value| (error / value).abs())
        };
        let mesh_errors = PROMISED.iter().map(mesh_error).collect();
        let courses = history.map_or([None, None], |history| history.courses);
        let courses = courses.into_iter().map(|course| course.map(Outcome::Course));
        let mut results: Vec<Option<Outcome>> = measures.chain(courses).collect();
        if ending.is_failure() {
            // What was measured until then is no result of the scene.
            results.fill(None);
        }
        found.push(Run {
            configuration,
            ending,
            elements: number(ColumnId::Elements).unwrap_or(0.0),
            steps: number(ColumnId::Steps).unwrap_or(0.0),
            implicit,
            seconds,
            results,
            mesh_errors,
        });
    }
    (found, without)
}

/// A number of a table, by its column.
fn number_in(table: &Table, column: &str, row: usize) -> Option<f64> {
    table.column(column)?.cells[row].any_number()
}

/// The parameter of words that alone names each scene.
fn naming(physical: &[&Column], firsts: &[usize]) -> Option<usize> {
    let names = |column: &&&Column| {
        let texts: BTreeMap<String, usize> = firsts
            .iter()
            .filter(|row| matches!(column.cells[**row], Value::Text(_)))
            .map(|row| (canonical(&column.cells[*row]), *row))
            .collect();
        texts.len() == firsts.len()
    };
    physical.iter().position(|column| names(&column))
}

/// Name and meaning of the scene of a row.
fn texts(study: &str, physical: &[&Column], naming: Option<usize>, row: usize) -> (String, String) {
    let text = |column: &Column| {
        format!("{} {}", column.name, column.shown.quantity(&column.cells[row]).trim())
    };
    let all = |without: Option<usize>| {
        let kept = physical.iter().enumerate().filter(|(index, _)| Some(*index) != without);
        kept.map(|(_, column)| text(column)).collect::<Vec<_>>().join(", ")
    };
    match naming {
        Some(index) => (physical[index].cells[row].to_string(), all(naming)),
        None if physical.is_empty() => (study.to_owned(), String::new()),
        None => (all(None), String::new()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::fixture;

    #[test]
    fn every_numerical_parameter_of_a_table_gives_configurations() {
        let table = fixture::table(
            "job strategy model  subdivisions contact.distance seed status   peak_vz elements steps wall_seconds
             1   a        film   4            1                1    done     20.0    768      1000  1.0
             2   a        film   4            1                2    done     21.0    768      1000  1.0
             3   a        piston 4            1                1    done     30.0    0        1000  1.0
             4   a        piston 8            2                2    done     30.0    0        1000  1.0
             5   b        film   4            1                1    done     18.0    768      1000  1.0
             6   b        film   4            2                1    unstable 0.0     768      1000  1.0",
        );
        let history =
            |_: &str| Some(Histories { courses: [None, None], simulated: 0.5, implicit: false });
        let scenes = scenes("study", &table, &["seed".to_owned()], &history);
        let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
        assert_eq!(names, ["a", "b"]);
        let [a, b] = scenes.as_slice() else { panic!() };
        assert_eq!(a.runs.len(), 3, "the piston ignores mesh, contact and seed: one run");
        let of_piston = &a.runs[2].configuration;
        assert_eq!(of_piston[0], ("model".to_owned(), Value::Text("piston".to_owned())));
        assert_eq!(of_piston[1..].iter().filter(|(_, value)| *value == Value::Null).count(), 2);
        assert_eq!(a.runs[0].configuration, a.runs[1].configuration, "seeds are runs");
        assert_eq!(a.runs[0].configuration[2], ("contact.distance".to_owned(), Value::Integer(1)));
        assert_eq!(a.runs[0].seconds, Some(2.0), "for a simulated second");
        let endings: Vec<&str> = b.runs.iter().map(|run| run.ending.name()).collect();
        assert_eq!((endings, b.without_result), (vec!["done", "unstable"], 0));
        assert!(b.runs[1].results.iter().all(Option::is_none), "a failed run has no result");
        let peak = PROMISED.iter().position(|one| one.measure == ColumnId::PeakVz).unwrap();
        assert_eq!(a.runs[1].results[peak], Some(Outcome::Number(21.0)));
        assert_eq!(a.runs[1].results.len(), PROMISED.len() + COURSES.len());
    }

    #[test]
    fn a_numerical_parameter_that_differs_only_between_scenes_is_part_of_them() {
        let table = fixture::table(
            "job strategy model outputs.sample_interval film.numerical_damping integrator status elements steps
             1   a        film  1                       0                      explicit   done   768      1000
             2   a        film  1                       1                      hybrid     done   768      1000
             3   b        film  5                       0                      implicit   done   768      1000
             4   b        film  5                       1                      implicit   done   768      1000",
        );
        let scenes = scenes("study", &table, &[], &|_: &str| None);
        assert_eq!(scenes[1].meaning, "outputs.sample_interval 5");
        let names = |run: &Run| -> Vec<String> {
            run.configuration.iter().map(|(name, _)| name.clone()).collect()
        };
        assert_eq!(names(&scenes[0].runs[0]), ["model", "film.numerical_damping", "integrator"]);
        // The implicit integrator ignores numerical damping: two equal runs are one.
        assert_eq!((scenes[0].runs.len(), scenes[1].runs.len()), (2, 1));
        assert_eq!(scenes[1].runs[0].configuration[1].1, Value::Null);
    }
}
