//! What a study file means: defaults filled, units converted, axes expanded to points, every point
//! resolved to the scene it runs.
//!
//! ```text
//! text → Json → (--set) → Base + Grid → points: parameters, Scene, feasible or why not
//! ```
//! Everything that can be wrong with a study is found here, before anything runs.

mod base;
mod expand;
mod grid;
mod overrides;
pub mod plan;
mod resolve;
mod strategy;

use std::path::Path;

use crate::input::keys::{Kind, STUDY};
use crate::input::study_file::{self, Json};
use crate::input::value::{Value, json_value};
use crate::job::Parameters;
use crate::job::point::{Infeasible, Solved};
use crate::platform::error::InputError;
use billow_solver::scene::Scene;

use crate::input::source::Source;
use base::Base;
use grid::Grid;
pub(crate) use overrides::apply as apply_overrides;

/// What a study may not exceed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Most points of a grid, before its filter.
    pub points: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { points: 250_000 }
    }
}

/// A validated study.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Name: of the results folder.
    pub name: String,
    /// The question it answers, in words.
    pub question: String,
    base: Base,
    grid: Grid,
    points: Vec<StudyPoint>,
}

/// One point of the grid, in plan order.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StudyPoint {
    /// The varied parameters.
    pub parameters: Parameters,
    /// What it runs.
    pub scene: Scene,
    /// Why it runs not.
    pub infeasible: Option<Infeasible>,
    /// What the fold solves; `None` where it is infeasible.
    pub solved: Option<Solved>,
}

impl Study {
    /// Reads a study file, with `--set key=value` overrides applied to it.
    ///
    /// # Errors
    /// [`crate::platform::error::Error::Disk`] when the file cannot be read, [`crate::platform::error::Error::Input`] when it is no sound study.
    pub fn load(path: &Path, sets: &[String]) -> crate::platform::error::Result<Self> {
        let bytes = study_file::read(path, "study file", "studies/first.json")?;
        let file = path.display().to_string();
        let text = study_file::text_of(&bytes, &file)?;
        let stem =
            path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(Self::from_text(text, &file, &stem, sets, Limits::default())?)
    }

    /// Reads a study from its text. `file` is what errors call it, `stem` its name when it gives
    /// none, `sets` the `--set key=value` overrides.
    ///
    /// # Errors
    /// The first thing found wrong, with its key, its value and what is allowed.
    pub fn from_text(
        text: &str,
        file: &str,
        stem: &str,
        sets: &[String],
        limits: Limits,
    ) -> Result<Self, InputError> {
        let tree = study_file::parse(text, file)?;
        Self::from_tree(tree, file, stem, sets, limits)
    }

    /// The same, from the tree of the text.
    ///
    /// # Errors
    /// As [`Study::from_text`].
    pub fn from_tree(
        mut tree: Json,
        file: &str,
        stem: &str,
        sets: &[String],
        limits: Limits,
    ) -> Result<Self, InputError> {
        let mut source = Source::new(file);
        if !matches!(tree, Json::Object(_)) {
            let problem = format!("is {}, not an object", tree.kind());
            return Err(source.error("", "", problem, "one JSON object: {\"design\": …}"));
        }
        if tree.get("format") == Some(&Json::Text("billow-scene".to_owned())) {
            let error = source.error("format", "\"billow-scene\"", "is a scene, not a study", "");
            return Err(InputError { hint: format!("billow solve {file}"), ..error });
        }
        overrides::apply(&mut tree, sets, &STUDY, &mut source)?;
        let base = Base::read(&tree, &source)?;
        let grid = Grid::read(tree.get("grid"), &base, &source, limits)?;
        overrides::refuse_varied(&grid, &source)?;
        let points = expand::points(&base, &grid, &source, limits)?;
        let name = study_name(&base, stem, &source)?;
        let question = base.settings.text("question").to_owned();
        Ok(Self { name, question, base, grid, points })
    }

    /// Names of the varied parameters, in the order of [`crate::job::Job::parameters`].
    pub fn parameter_names(&self) -> Vec<String> {
        self.grid.columns.iter().map(|column| column.name.clone()).collect()
    }

    /// Dotted paths of the varied parameters, in the same order.
    pub fn parameter_paths(&self) -> impl Iterator<Item = &'static str> {
        self.grid.columns.iter().map(|column| column.target.key().path)
    }

    /// Varied parameters that stand on the same axis as this one, and so change with it.
    pub fn zipped_with(&self, parameter: &str) -> Vec<String> {
        let named = |column: &&usize| self.grid.columns[**column].name == parameter;
        let axis = self.grid.axes.iter().find(|axis| axis.columns.iter().any(|at| named(&at)));
        let columns = axis.map(|axis| axis.columns.as_slice()).unwrap_or_default();
        let others = columns.iter().filter(|column| !named(column));
        others.map(|column| self.grid.columns[*column].name.clone()).collect()
    }

    /// Reads a value of a varied parameter as a user writes it on a command line: a number (SI), a
    /// quantity with its unit, a word. `None` for what is no parameter, or no value of it.
    pub fn parameter_value(&self, parameter: &str, text: &str) -> Option<Value> {
        let column = self.grid.columns.iter().find(|column| column.name == parameter)?;
        let key = column.target.key();
        let text = text.trim();
        let number = || {
            let whole = text.parse::<i64>().ok().map(Json::Integer);
            whole.or_else(|| {
                text.parse::<f64>().ok().filter(|number| number.is_finite()).map(Json::Number)
            })
        };
        let flag = || text.parse::<bool>().ok().map(Json::Bool);
        let written = [number(), flag(), Some(Json::Text(text.to_owned()))];
        written.iter().flatten().find_map(|json| key.read(json).ok())
    }

    /// SI unit of a varied parameter: "1" for a pure number, empty for a word.
    pub fn unit(&self, parameter: &str) -> &'static str {
        let column = self.grid.columns.iter().find(|column| column.name == parameter);
        match column.map(|column| column.target.key().kind) {
            Some(Kind::Quantity(quantity)) => quantity.dimension.si(),
            Some(Kind::Integer(..)) => "1",
            Some(Kind::Choice(_) | Kind::Text | Kind::Flag | Kind::Vector(_)) | None => "",
        }
    }

    /// The resolved study: units converted, defaults spelled out, axes as lists. A study file
    /// itself: read back, it plans the same jobs in the same order, their parameters in the same.
    pub fn resolved(&self) -> Json {
        let mut json = self.base.to_json();
        json["name"] = self.name.as_str().into();
        let mut json = Json::from(json);
        if !self.grid.is_empty() {
            json.set("grid", self.grid.resolved());
        }
        json
    }

    /// What never flows: inflow windows, or parts of them, after every run has ended, in words.
    pub(crate) fn late_windows(&self) -> Vec<String> {
        let ends = self.points.iter().map(|point| point.scene.solver.end_time);
        let end = ends.fold(0.0, f64::max);
        let late = |time: Option<f64>| time.filter(|time| *time >= end);
        let of = |(name, strategy): (&String, &strategy::Strategy)| -> Vec<String> {
            let said = |(at, [from, to]): (usize, [Option<f64>; 2])| {
                let window = format!("strategies.{name}.inflow[{at}]");
                if let Some(from) = late(from) {
                    return Some(format!(
                        "{window} begins at {from} s, when the run has ended ({end} s): it lets \
                         nothing in"
                    ));
                }
                let to = late(to).filter(|to| *to > end)?;
                Some(format!(
                    "{window} goes on to {to} s, the run to {end} s: the rest never flows"
                ))
            };
            strategy.windows().into_iter().enumerate().filter_map(said).collect()
        };
        self.base.strategies.iter().flat_map(of).collect()
    }

    pub(crate) fn points(&self) -> &[StudyPoint] {
        &self.points
    }
}

impl Grid {
    /// Each axis a group of `zip`: a list keeps the order of the axes wherever an object would not.
    fn resolved(&self) -> Json {
        let name = |column: usize| self.columns[column].name.clone();
        let json = |value: &Value| Json::from(json_value(value));
        let mut grid = Vec::new();
        let groups = self.axes.iter().map(|axis| {
            let columns = axis.columns.iter().enumerate().map(|(at, column)| {
                let values = axis.rows.iter().map(|row| json(&row[at])).collect();
                (name(*column), Json::List(values))
            });
            Json::Object(columns.collect())
        });
        if !self.axes.is_empty() {
            grid.push(("zip".to_owned(), Json::List(groups.collect())));
        }
        let points = self.points.iter().map(|point| {
            let members = point.iter().map(|(column, value)| (name(*column), json(value)));
            Json::Object(members.collect())
        });
        if !self.points.is_empty() {
            grid.push(("points".to_owned(), Json::List(points.collect())));
        }
        if let Some(filter) = &self.filter {
            grid.push(("filter".to_owned(), Json::Text(filter.text().to_owned())));
        }
        Json::Object(grid)
    }
}

/// The study's name: given, or that of its file; always one that a folder can have.
fn study_name(base: &Base, stem: &str, source: &Source) -> Result<String, InputError> {
    let given = base.settings.maybe_text("name");
    let name = given.unwrap_or(stem);
    let sound = !name.is_empty()
        && name.len() <= 100
        && !name.starts_with(['.', '-'])
        && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.'));
    if sound {
        return Ok(name.to_owned());
    }
    let mut error = source.error(
        "name",
        &Json::Text(name.to_owned()).brief(),
        "cannot name a results folder",
        "up to 100 letters, digits, - _ and dots, not starting with a dot or -",
    );
    if given.is_none() {
        "the file's name is the study's name; give the study a `name`".clone_into(&mut error.hint);
    }
    Err(error)
}
