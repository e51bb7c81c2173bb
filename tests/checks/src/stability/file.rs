//! A map file: which scenes, along which axes, and what is expected.
//!
//! ```json
//! {"maps": [{"name": "step", "description": "what is asked", "scene": "sheet",
//!            "axes": [["step", [0.5, 1.5]], ["damping", [0, 0.1]]], "values": {"sliver": 1}, "methods": ["explicit"],
//!            "border": {"along": "step", "within": 1e-3}, "theory": 0.01,
//!            "strip": {"methods": ["explicit"], "where": {"step": 1.5}},
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
use billow_study::platform::nearest::did_you_mean;
use serde::Deserialize;

use super::Method;
use super::cell::{Cell, Question};
use super::scenes::{self, Parameter, SCENES, StabilityScene, Values};

/// Expectation of any failure.
const FAILS: &str = "fails";
/// Expectation that any outcome meets.
const ANY: &str = "any";
/// Every integrator of film, as a method.
const FILM: &str = "film";
/// Most values of an axis. Chosen: a picture shows them.
const MAX_VALUES: usize = 16;

/// An axis of a map.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Parameter.
    pub parameter: &'static Parameter,
    /// Values, ascending.
    pub values: Vec<f64>,
}

/// Where the outcome changes is searched along an axis.
#[derive(Debug, Clone, Copy)]
pub struct Search {
    /// Index of the axis.
    pub axis: usize,
    /// Relative width at which a search ends.
    pub within: f64,
    /// Largest relative difference of the border of explicit steps from 2/ω; `None` where no theory is known.
    pub theory: Option<f64>,
}

/// Some cells of a map.
#[derive(Debug, Clone)]
pub(super) struct Choice {
    pub(super) methods: Vec<Method>,
    place: Vec<(&'static str, [f64; 2])>,
}

impl Choice {
    /// Whether a cell is one of them.
    pub(super) fn holds(&self, question: &Question) -> bool {
        let within = |(name, [from, to]): &(&str, [f64; 2])| {
            (*from..=*to).contains(&question.values.get(name))
        };
        self.methods.contains(&question.method) && self.place.iter().all(within)
    }
}

/// What is expected of some cells.
#[derive(Debug, Clone)]
struct Rule {
    of: Choice,
    statuses: Vec<String>,
    /// Why; may be empty.
    why: String,
}

/// A map.
#[derive(Clone)]
pub struct Map {
    /// Name.
    pub name: String,
    /// What is asked; may be empty.
    pub description: String,
    /// Scene.
    pub scene: &'static StabilityScene,
    /// Methods.
    pub methods: Vec<Method>,
    /// Values of the parameters that are no axis.
    pub(super) values: Values,
    /// One or two axes.
    pub axes: Vec<Axis>,
    /// The search of borders.
    pub search: Option<Search>,
    /// The cells of which one is shown as a strip.
    pub(super) strip: Option<Choice>,
    rules: Vec<Rule>,
}

impl Map {
    /// The question of a cell at these values of the axes.
    pub fn question(&self, method: Method, at: &[f64]) -> Question {
        let mut values = self.values.clone();
        for (axis, value) in self.axes.iter().zip(at) {
            values.set(axis.parameter.name, *value);
        }
        Question { scene: self.scene, method, values }
    }

    /// Every place of the map: along the first axis, the lowest value of the second one first.
    pub fn places(&self) -> Vec<Vec<f64>> {
        let first = &self.axes[0].values;
        match self.axes.get(1) {
            None => first.iter().map(|x| vec![*x]).collect(),
            Some(second) => {
                second.values.iter().flat_map(|y| first.iter().map(|x| vec![*x, *y])).collect()
            }
        }
    }

    /// A place in words: the values along the axes.
    pub fn at(&self, place: &[f64]) -> Vec<String> {
        let axes = self.axes.iter().zip(place);
        axes.map(|(axis, value)| format!("{} {value}", axis.parameter.name)).collect()
    }

    /// What is expected of a cell: names of statuses, `fails` or `any`.
    pub fn expected(&self, question: &Question) -> Vec<String> {
        let first = self.rules.iter().find(|rule| rule.of.holds(question));
        first.map_or_else(|| vec![Status::Done.name().to_owned()], |rule| rule.statuses.clone())
    }

    /// The reasons of the failures that are expected, with the methods they are of: each once.
    pub fn reasons(&self) -> Vec<(Vec<Method>, &str)> {
        let mut reasons: Vec<(Vec<Method>, &str)> = Vec::new();
        let of_failure = |rule: &&Rule| !rule.why.is_empty() && failure_expected(&rule.statuses);
        for rule in self.rules.iter().filter(of_failure) {
            let of_rule = |method: &Method| rule.of.methods.contains(method);
            let methods: Vec<Method> = self.methods.iter().copied().filter(of_rule).collect();
            let reason = (methods, &*rule.why);
            if !reason.0.is_empty() && !reasons.contains(&reason) {
                reasons.push(reason);
            }
        }
        reasons
    }

    /// Index of the horizontal axis of pictures: that of the search, else the first one.
    pub fn horizontal(&self) -> usize {
        self.search.map_or(0, |search| search.axis)
    }
}

/// Whether a failure is expected, and nothing else.
pub fn failure_expected(expected: &[String]) -> bool {
    let well = [Status::Done.name(), ANY];
    !expected.iter().any(|word| well.contains(&word.as_str()))
}

/// Whether a cell is as expected.
pub fn meets(expected: &[String], cell: &Cell) -> bool {
    expected.iter().any(|word| match word.as_str() {
        ANY => true,
        FAILS => cell.fails(),
        status => status == cell.status,
    })
}

/// One value, or a list.
#[derive(Deserialize)]
#[serde(untagged)]
enum OneOrMany<T> {
    One(T),
    Many(Vec<T>),
}

impl<T> OneOrMany<T> {
    fn into_list(self) -> Vec<T> {
        match self {
            Self::One(one) => vec![one],
            Self::Many(list) => list,
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileText {
    #[serde(default, rename = "description")]
    _description: String,
    maps: Vec<MapText>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MapText {
    name: String,
    #[serde(default)]
    description: String,
    scene: String,
    methods: Option<Vec<String>>,
    axes: Vec<(String, Vec<f64>)>,
    #[serde(default)]
    values: BTreeMap<String, f64>,
    border: Option<BorderText>,
    theory: Option<f64>,
    strip: Option<ChoiceText>,
    #[serde(default)]
    expect: Vec<RuleText>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BorderText {
    along: String,
    #[serde(default = "border_width")]
    within: f64,
}

fn border_width() -> f64 {
    0.02
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ChoiceText {
    methods: Option<Vec<String>>,
    #[serde(default, rename = "where")]
    place: BTreeMap<String, OneOrMany<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RuleText {
    methods: Option<Vec<String>>,
    #[serde(default, rename = "where")]
    place: BTreeMap<String, OneOrMany<f64>>,
    status: OneOrMany<String>,
    #[serde(default)]
    why: String,
}

/// Reads a map file.
///
/// # Errors
/// A file that cannot be read, or the first value that is not allowed: its key, and what is allowed.
pub fn read(path: &Path) -> Result<(Vec<u8>, Vec<Map>)> {
    let bytes = study_file::read(path, "map file", "studies/stability.json")?;
    let file = path.display().to_string();
    let maps = maps(study_file::text_of(&bytes, &file)?);
    Ok((bytes, maps.map_err(|error| Error::Input(InputError { file, ..error }))?))
}

type Checked<T> = std::result::Result<T, InputError>;

/// The error of a value; the file is added later.
fn refuse(key: &str, value: &dyn ToString, problem: &str, allowed: &str) -> InputError {
    let [file, hint] = [String::new(), String::new()];
    let [key, problem, allowed] = [key, problem, allowed].map(str::to_owned);
    InputError { file, key, value: value.to_string(), problem, allowed, hint }
}

/// The entry with this name.
fn named<T>(
    key: &str,
    name: &str,
    what: &str,
    known: &[&str],
    find: impl Fn(&str) -> Option<T>,
) -> Checked<T> {
    find(name).ok_or_else(|| {
        let near = did_you_mean(name, known.iter().copied());
        let error = refuse(key, &name, what, &known.join(", "));
        InputError { hint: near.unwrap_or_default(), ..error }
    })
}

fn maps(text: &str) -> Checked<Vec<Map>> {
    let reader = &mut serde_json::Deserializer::from_str(text);
    let file: FileText = serde_path_to_error::deserialize(reader).map_err(|error| {
        let key = error.path().to_string();
        refuse(&key, &"", &error.inner().to_string(), "docs/guide/validate.md lists the keys")
    })?;
    let mut maps: Vec<Map> = Vec::new();
    for (index, text) in file.maps.into_iter().enumerate() {
        let key = format!("maps[{index}]");
        let map = Reader { key: &key, scene: scene(&key, &text.scene)? }.map(text)?;
        maps.push(map);
    }
    Ok(maps)
}

fn scene(key: &str, name: &str) -> Checked<&'static StabilityScene> {
    let names = SCENES.map(|scene| scene.name);
    named(&format!("{key}.scene"), name, "unknown scene", &names, scenes::find)
}

/// Reads the parts of a map.
struct Reader<'a> {
    /// Place of the map.
    key: &'a str,
    scene: &'static StabilityScene,
}

impl Reader<'_> {
    fn map(&self, text: MapText) -> Checked<Map> {
        let key = self.key;
        let axes = self.axes(text.axes)?;
        let mut values = Values::of(self.scene);
        for (name, value) in text.values {
            let key = format!("{key}.values.{name}");
            let parameter = self.parameter(&key, &name)?;
            values.set(parameter.name, checked(parameter, &key, value)?);
        }
        let search = match text.border {
            None => None,
            Some(BorderText { along, within }) => {
                let key = format!("{key}.border.along");
                let is_axis = |axis: &Axis| axis.parameter.name == along && !axis.parameter.whole;
                let axis = axes.iter().position(is_axis).ok_or_else(|| {
                    let allowed = "an axis of the map whose values are real numbers";
                    refuse(&key, &along, "no such axis", allowed)
                })?;
                Some(Search { axis, within, theory: text.theory })
            }
        };
        let rule = |(index, rule): (usize, RuleText)| {
            let key = format!("expect[{index}]");
            Ok(Rule {
                statuses: self.statuses(&key, &rule.status.into_list())?,
                of: self.choice(&key, rule.methods, rule.place)?,
                why: rule.why,
            })
        };
        let strip = text.strip.map(|strip| self.choice("strip", strip.methods, strip.place));
        Ok(Map {
            methods: self.methods(&format!("{key}.methods"), text.methods)?,
            name: text.name,
            description: text.description,
            scene: self.scene,
            values,
            axes,
            search,
            strip: strip.transpose()?,
            rules: text.expect.into_iter().enumerate().map(rule).collect::<Checked<_>>()?,
        })
    }

    fn axes(&self, given: Vec<(String, Vec<f64>)>) -> Checked<Vec<Axis>> {
        let key = format!("{}.axes", self.key);
        if !(1..=2).contains(&given.len()) {
            let allowed = "one or two parameters with their values";
            return Err(refuse(&key, &given.len(), "too many axes, or none", allowed));
        }
        let axis = |(name, values): (String, Vec<f64>)| {
            let key = format!("{key}.{name}");
            let parameter = self.parameter(&key, &name)?;
            for (index, value) in values.iter().enumerate() {
                checked(parameter, &format!("{key}[{index}]"), *value)?;
            }
            let ascending = values.windows(2).all(|pair| pair[0] < pair[1]);
            if !(1..=MAX_VALUES).contains(&values.len()) || !ascending {
                let allowed = format!("1 to {MAX_VALUES} values, each larger than the one before");
                return Err(refuse(&key, &"", "cannot be an axis", &allowed));
            }
            Ok(Axis { parameter, values })
        };
        given.into_iter().map(axis).collect()
    }

    /// The parameter of a name.
    fn parameter(&self, key: &str, name: &str) -> Checked<&'static Parameter> {
        let names: Vec<&str> = self.scene.parameters.iter().map(|known| known.name).collect();
        let problem = format!("no parameter of the scene {}", self.scene.name);
        named(key, name, &problem, &names, |name| self.scene.parameter(name))
    }

    /// The methods of these names; those of the scene without any.
    fn methods(&self, key: &str, names: Option<Vec<String>>) -> Checked<Vec<Method>> {
        let all = self.scene.methods();
        let Some(names) = names else { return Ok(all) };
        let known: Vec<&str> =
            std::iter::once(FILM).chain(all.iter().map(|method| method.name())).collect();
        let problem = format!("no method of the scene {}", self.scene.name);
        let find = |name: &str| {
            let is_it = |method: &&Method| {
                method.name() == name || name == FILM && matches!(method, Method::Film(_))
            };
            let found: Vec<Method> = all.iter().filter(is_it).copied().collect();
            (!found.is_empty()).then_some(found)
        };
        let mut methods = Vec::new();
        for (index, name) in names.iter().enumerate() {
            methods.extend(named(&format!("{key}[{index}]"), name, &problem, &known, find)?);
        }
        Ok(methods)
    }

    /// The cells that `methods` and `where` name.
    fn choice(
        &self,
        key: &str,
        methods: Option<Vec<String>>,
        given: BTreeMap<String, OneOrMany<f64>>,
    ) -> Checked<Choice> {
        let key = format!("{}.{key}", self.key);
        let mut place = Vec::new();
        for (name, value) in given {
            let key = format!("{key}.where.{name}");
            let parameter = self.parameter(&key, &name)?;
            let range = match value.into_list().as_slice() {
                [one] => [*one; 2],
                [from, to] => [*from, *to],
                _ => return Err(refuse(&key, &"", "is no range", "a value, or [from, to]")),
            };
            place.push((parameter.name, range));
        }
        Ok(Choice { methods: self.methods(&format!("{key}.methods"), methods)?, place })
    }

    fn statuses(&self, key: &str, words: &[String]) -> Checked<Vec<String>> {
        let known: Vec<&str> = [FAILS, ANY, Status::Done.name()]
            .into_iter()
            .chain(Status::all().filter(|status| status.is_failure()).map(Status::name))
            .collect();
        let key = format!("{}.{key}.status", self.key);
        let find = |word: &str| known.contains(&word).then(|| word.to_owned());
        words.iter().map(|word| named(&key, word, "unknown status", &known, find)).collect()
    }
}

/// A value within the range of its parameter.
fn checked(parameter: &Parameter, key: &str, value: f64) -> Checked<f64> {
    let [from, to] = parameter.range;
    if !(from..=to).contains(&value) || parameter.whole && value.fract() != 0.0 {
        let whole = if parameter.whole { "whole number" } else { "number" };
        let allowed = format!("a {whole} from {from} to {to} ({})", parameter.unit);
        return Err(refuse(key, &value, "out of range", &allowed));
    }
    Ok(value)
}
