//! A map file: which scenes, along which axes, and what is expected.
//!
//! ```json
//! {"maps": [{"name": "step", "description": "what is asked", "scene": "sheet",
//!            "axes": [["step", [0.5, 1.5]], ["damping", [0, 0.1]]], "values": {"sliver": 1}, "methods": ["explicit"],
//!            "border": {"along": "step", "within": 1e-3}, "theory": 0.01,
//!            "expect": [{"methods": ["explicit"], "where": {"step": [1.1, 2]}, "status": "unstable", "why": "…"}]}]}
//! ```
//!
//! Without `methods`, a map or a rule holds for every method that can run the scene; `film` is every integrator. The
//! first rule that holds for a cell decides; without one the run is expected to be `done`. `theory` is the largest
//! relative difference of the border of `explicit` from 2/ω.

use std::collections::BTreeMap;
use std::path::Path;

use billow_study::input::study_file;
use billow_study::job::Status;
use billow_study::platform::error::{Error, InputError, Result};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::cell::{Cell, Question};
use super::scenes::{Parameter, SCENES, StabilityScene, Values};
use super::{Method, names};

/// Expectation of any failure.
const FAILS: &str = "fails";
/// Expectation that any outcome meets.
const ANY: &str = "any";
/// Every integrator of film, as a method.
const FILM: &str = "film";
/// Most values of an axis. Chosen: a picture shows them.
const MAX_VALUES: usize = 16;

/// One value, or a list.
#[derive(Clone, Deserialize)]
#[serde(untagged)]
enum OneOrMany<T> {
    One(T),
    Many(Vec<T>),
}

impl<T> OneOrMany<T> {
    fn list(&self) -> &[T] {
        match self {
            Self::One(one) => std::slice::from_ref(one),
            Self::Many(list) => list,
        }
    }
}

/// What is expected of some cells.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Rule {
    /// Empty: every method of the map.
    #[serde(default, deserialize_with = "methods")]
    methods: Vec<Method>,
    /// Parameters, and their value or smallest and largest value.
    #[serde(default, rename = "where")]
    place: BTreeMap<String, OneOrMany<f64>>,
    /// Names of statuses, [`FAILS`] or [`ANY`].
    status: OneOrMany<String>,
    /// Why; may be empty.
    #[serde(default)]
    why: String,
}

impl Rule {
    fn is_of(&self, method: Method) -> bool {
        self.methods.is_empty() || self.methods.contains(&method)
    }

    fn holds(&self, question: &Question) -> bool {
        let within = |(name, range): (&String, &OneOrMany<f64>)| match range.list() {
            [from, .., to] => (*from..=*to).contains(&question.values.get(name)),
            value => value.contains(&question.values.get(name)),
        };
        self.is_of(question.method) && self.place.iter().all(within)
    }
}

/// Where the outcome changes is searched along an axis.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Search {
    /// Name of the axis.
    along: String,
    /// Relative width at which a search ends.
    #[serde(default = "border_width")]
    pub(super) within: f64,
}

fn border_width() -> f64 {
    0.02
}
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Map {
    pub(super) name: String,
    /// What is asked; may be empty.
    #[serde(default)]
    pub(super) description: String,
    #[serde(deserialize_with = "scene")]
    pub(super) scene: &'static StabilityScene,
    #[serde(default, deserialize_with = "methods")]
    pub(super) methods: Vec<Method>,
    /// One or two parameters, and their values in ascending order.
    pub(super) axes: Vec<(String, Vec<f64>)>,
    /// The values of other parameters that differ from their default.
    #[serde(default)]
    values: BTreeMap<String, f64>,
    #[serde(rename = "border")]
    pub(super) search: Option<Search>,
    /// Largest relative difference of the border of explicit steps from 2/ω; `None` where no theory is known.
    pub(super) theory: Option<f64>,
    #[serde(default)]
    expect: Vec<Rule>,
}

impl Map {
    /// The parameter of an axis.
    pub(super) fn parameter(&self, axis: usize) -> &'static Parameter {
        self.scene.parameter(&self.axes[axis].0).expect("checked when the file was read")
    }

    /// The values of all parameters at a place.
    pub(super) fn values(&self, at: &[f64]) -> Values {
        let mut values = Values::of(self.scene);
        let axes = self.axes.iter().map(|(name, _)| name).zip(at);
        for (name, value) in self.values.iter().chain(axes) {
            values.set(name, *value);
        }
        values
    }

    /// The question of a cell at these values of the axes.
    pub(super) fn question(&self, method: Method, at: &[f64]) -> Question {
        Question { scene: self.scene, method, values: self.values(at) }
    }

    /// Every place of the map: along the first axis, the lowest value of the second one first.
    pub(super) fn places(&self) -> Vec<Vec<f64>> {
        let first = &self.axes[0].1;
        match self.axes.get(1) {
            None => first.iter().map(|x| vec![*x]).collect(),
            Some((_, second)) => {
                second.iter().flat_map(|y| first.iter().map(|x| vec![*x, *y])).collect()
            }
        }
    }

    /// A place in words: the values along the axes.
    pub(super) fn at(&self, place: &[f64]) -> Vec<String> {
        self.axes.iter().zip(place).map(|((name, _), value)| format!("{name} {value}")).collect()
    }

    /// What is expected of a cell: names of statuses, `fails` or `any`.
    pub(super) fn expected(&self, question: &Question) -> Vec<String> {
        let first = self.expect.iter().find(|rule| rule.holds(question));
        first.map_or_else(|| vec![Status::Done.name().to_owned()], |rule| rule.status.list().into())
    }

    /// The reasons of the failures that are expected, with the methods they are of: each once.
    pub(super) fn reasons(&self) -> Vec<(Vec<Method>, &str)> {
        let mut reasons: Vec<(Vec<Method>, &str)> = Vec::new();
        let of_failure =
            |rule: &&Rule| !rule.why.is_empty() && failure_expected(rule.status.list());
        for rule in self.expect.iter().filter(of_failure) {
            let methods = self.methods.iter().copied().filter(|method| rule.is_of(*method));
            let reason = (methods.collect(), &*rule.why);
            if !reasons.contains(&reason) {
                reasons.push(reason);
            }
        }
        reasons.retain(|(methods, _)| !methods.is_empty());
        reasons
    }

    /// Index of the horizontal axis of pictures: that of the search, else the first one.
    pub(super) fn horizontal(&self) -> usize {
        let along = |search: &Search| self.axes.iter().position(|(name, _)| *name == search.along);
        self.search.as_ref().and_then(along).unwrap_or(0)
    }

    /// The first problem of a map, and what is allowed.
    fn problem(&self) -> Option<(String, String)> {
        let (scene, allowed) = (self.scene, self.scene.methods());
        let used = self.expect.iter().flat_map(|rule| &rule.methods).chain(&self.methods);
        if let Some(method) = used.copied().find(|method| !allowed.contains(method)) {
            return Some((
                format!("{} is no method of the scene {}", method.name(), scene.name),
                names(&allowed),
            ));
        }
        if !(1..=2).contains(&self.axes.len()) {
            return Some((format!("{} axes", self.axes.len()), "one or two".to_owned()));
        }
        for (name, values) in &self.axes {
            let ascending = values.windows(2).all(|pair| pair[0] < pair[1]);
            if !(1..=MAX_VALUES).contains(&values.len()) || !ascending {
                let allowed = format!("1 to {MAX_VALUES} values, each larger than the one before");
                return Some((format!("{name} cannot be an axis"), allowed));
            }
        }
        let axes = self.axes.iter().flat_map(|(name, all)| all.iter().map(move |v| (name, v)));
        let places = self.expect.iter().flat_map(|rule| &rule.place);
        let places = places.flat_map(|(name, all)| all.list().iter().map(move |v| (name, v)));
        for (name, value) in axes.chain(&self.values).chain(places) {
            let Some(parameter) = scene.parameter(name) else {
                let known: Vec<&str> = scene.parameters.iter().map(|known| known.name).collect();
                let problem = format!("{name} is no parameter of the scene {}", scene.name);
                return Some((problem, known.join(", ")));
            };
            if !parameter.allows(*value) {
                return Some((format!("{name} is {value}"), parameter.allowed()));
            }
        }
        let is_axis = |(axis, (name, _)): (usize, &(String, Vec<f64>))| {
            self.search.as_ref().is_none_or(|search| search.along == *name)
                && !self.parameter(axis).whole
        };
        if self.search.is_some() && !self.axes.iter().enumerate().any(is_axis) {
            let allowed = "an axis of the map whose values are real numbers".to_owned();
            return Some(("the border is along no such axis".to_owned(), allowed));
        }
        let failures = Status::all().filter(|status| status.is_failure()).map(Status::name);
        let known: Vec<&str> =
            [FAILS, ANY, Status::Done.name()].into_iter().chain(failures).collect();
        let mut statuses = self.expect.iter().flat_map(|rule| rule.status.list());
        let unknown = statuses.find(|status| !known.contains(&status.as_str()))?;
        Some((format!("{unknown} is no status"), known.join(", ")))
    }
}

/// Whether a failure is expected, and nothing else.
pub(super) fn failure_expected(expected: &[String]) -> bool {
    let well = [Status::Done.name(), ANY];
    !expected.iter().any(|word| well.contains(&word.as_str()))
}

/// Whether a cell is as expected.
pub(super) fn meets(expected: &[String], cell: &Cell) -> bool {
    expected.iter().any(|word| match word.as_str() {
        ANY => true,
        FAILS => cell.fails(),
        status => status == cell.status,
    })
}

fn scene<'de, D: Deserializer<'de>>(
    from: D,
) -> std::result::Result<&'static StabilityScene, D::Error> {
    let name = String::deserialize(from)?;
    let known = || SCENES.map(|scene| scene.name).join(", ");
    let found = SCENES.into_iter().find(|scene| scene.name == name);
    found.ok_or_else(|| D::Error::custom(format!("unknown scene {name}; allowed: {}", known())))
}

fn methods<'de, D: Deserializer<'de>>(from: D) -> std::result::Result<Vec<Method>, D::Error> {
    let mut methods = Vec::new();
    for name in Vec::<String>::deserialize(from)? {
        let is_film = |method: &Method| name == FILM && matches!(method, Method::Film(_));
        let known = methods.len();
        methods.extend(Method::all().filter(|method| method.name() == name || is_film(method)));
        if methods.len() == known {
            let all = names(&Method::all().collect::<Vec<_>>());
            return Err(D::Error::custom(format!("unknown method {name}; allowed: {FILM}, {all}")));
        }
    }
    Ok(methods)
}

/// A file of maps.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MapFile {
    #[serde(default, rename = "description")]
    _description: String,
    maps: Vec<Map>,
}

/// Reads the maps of a file.
pub(super) fn read(path: &Path) -> Result<Vec<Map>> {
    let bytes = study_file::read(path, "map file", "studies/stability.json")?;
    let file = path.display().to_string();
    let refuse = |key: String, problem: String, allowed: String| {
        let [value, hint] = [String::new(), String::new()];
        Error::Input(InputError { file: file.clone(), key, value, problem, allowed, hint })
    };
    let reader = &mut serde_json::Deserializer::from_str(study_file::text_of(&bytes, &file)?);
    let read: MapFile = serde_path_to_error::deserialize(reader).map_err(|error| {
        let allowed = "docs/guide/validate.md lists the keys".to_owned();
        refuse(error.path().to_string(), error.inner().to_string(), allowed)
    })?;
    let mut maps = read.maps;
    for (index, map) in maps.iter_mut().enumerate() {
        if map.methods.is_empty() {
            map.methods = map.scene.methods();
        }
        if let Some((problem, allowed)) = map.problem() {
            return Err(refuse(format!("maps[{index}] ({})", map.name), problem, allowed));
        }
    }
    Ok(maps)
}
