//! A map file: which scenes, along which axes, and what is expected. docs/guide/validate.md has its keys and an example.

use std::collections::BTreeMap;
use std::path::Path;

use billow_study::input::study_file;
use billow_study::job::Status;
use billow_study::platform::error::{Error, InputError, Result};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::scenes::{Parameter, SCENES, StabilityScene, Values};
use super::{Method, names};

/// Most values of an axis. Chosen: a picture shows them.
const MAX_VALUES: usize = 16;

/// What a cell may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Expected {
    Any,
    /// Any failure.
    Fails,
    Is(Status),
}

impl Expected {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Any => "any",
            Self::Fails => "fails",
            Self::Is(status) => status.name(),
        }
    }

    pub(super) fn is_met_by(self, status: Status) -> bool {
        match self {
            Self::Any => true,
            Self::Fails => status.is_failure(),
            Self::Is(expected) => status == expected,
        }
    }
}

/// What is expected of some cells.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Rule {
    /// Empty: every method of the map.
    #[serde(default, deserialize_with = "methods")]
    methods: Vec<Method>,
    #[serde(default, rename = "where")]
    place: BTreeMap<String, [f64; 2]>,
    #[serde(deserialize_with = "expected")]
    status: Vec<Expected>,
    /// Why; may be empty.
    #[serde(default)]
    why: String,
}

#[derive(Deserialize)]
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
    /// Relative width at which the search of a border along the first axis ends; `None` without a search.
    pub(super) border: Option<f64>,
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
        let axes = self.axes.iter().map(|(name, _)| name).zip(at);
        Values::of(self.scene, self.values.iter().chain(axes))
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

    /// What is expected of a cell.
    pub(super) fn expected(&self, method: Method, at: &[f64]) -> Vec<Expected> {
        let values = self.values(at);
        let within =
            |(name, [from, to]): (&String, &[f64; 2])| (*from..=*to).contains(&values.get(name));
        let holds = |rule: &&Rule| {
            (rule.methods.is_empty() || rule.methods.contains(&method))
                && rule.place.iter().all(within)
        };
        let first = self.expect.iter().find(holds);
        first.map_or_else(|| vec![Expected::Is(Status::Done)], |rule| rule.status.clone())
    }

    /// The reasons of the rules: each once.
    pub(super) fn reasons(&self) -> Vec<&str> {
        let mut reasons = Vec::new();
        for rule in self.expect.iter().filter(|rule| !rule.why.is_empty()) {
            if !reasons.contains(&&*rule.why) {
                reasons.push(&*rule.why);
            }
        }
        reasons
    }

    /// The first problem of a map, and what is allowed.
    fn problem(&self) -> Option<(String, String)> {
        let (scene, allowed) = (self.scene, self.scene.methods());
        let used = self.expect.iter().flat_map(|rule| &rule.methods).chain(&self.methods);
        if let Some(method) = used.copied().find(|method| !allowed.contains(method)) {
            let problem = format!("{} is no method of the scene {}", method.name(), scene.name);
            return Some((problem, names(&allowed)));
        }
        let is_axis = |(_, values): &(String, Vec<f64>)| {
            let ascending = values.windows(2).all(|pair| pair[0] < pair[1]);
            (1..=MAX_VALUES).contains(&values.len()) && ascending
        };
        if !(1..=2).contains(&self.axes.len()) || !self.axes.iter().all(is_axis) {
            let allowed =
                format!("one or two, of 1 to {MAX_VALUES} values, each larger than the one before");
            return Some(("these cannot be axes".to_owned(), allowed));
        }
        let axes = self.axes.iter().map(|(name, _)| name);
        let places = self.expect.iter().flat_map(|rule| rule.place.keys());
        let mut named = axes.chain(self.values.keys()).chain(places);
        let unknown = named.find(|name| scene.parameter(name).is_none())?;
        let known: Vec<&str> = scene.parameters.iter().map(|known| known.name).collect();
        let problem = format!("{unknown} is no parameter of the scene {}", scene.name);
        Some((problem, known.join(", ")))
    }
}

type Read<T, E> = std::result::Result<T, E>;

fn scene<'de, D: Deserializer<'de>>(from: D) -> Read<&'static StabilityScene, D::Error> {
    let name = String::deserialize(from)?;
    let known = || SCENES.map(|scene| scene.name).join(", ");
    let found = SCENES.into_iter().find(|scene| scene.name == name);
    found.ok_or_else(|| D::Error::custom(format!("unknown scene {name}; allowed: {}", known())))
}

fn methods<'de, D: Deserializer<'de>>(from: D) -> Read<Vec<Method>, D::Error> {
    let mut methods = Vec::new();
    for name in Vec::<String>::deserialize(from)? {
        let is_film = |method: &Method| name == "film" && method.is_film();
        let known = methods.len();
        methods.extend(Method::all().filter(|method| method.name() == name || is_film(method)));
        if methods.len() == known {
            let all = names(&Method::all().collect::<Vec<_>>());
            return Err(D::Error::custom(format!("unknown method {name}; allowed: film, {all}")));
        }
    }
    Ok(methods)
}

fn expected<'de, D: Deserializer<'de>>(from: D) -> Read<Vec<Expected>, D::Error> {
    let ends = Status::all().filter(|status| status.is_failure()).chain([Status::Done]);
    let all: Vec<Expected> =
        [Expected::Fails, Expected::Any].into_iter().chain(ends.map(Expected::Is)).collect();
    let of_name = |name: String| {
        all.iter().copied().find(|expected| expected.name() == name).ok_or_else(|| {
            let allowed: Vec<&str> = all.iter().map(|expected| expected.name()).collect();
            let allowed = allowed.join(", ");
            D::Error::custom(format!("unknown status {name}; allowed: {allowed}"))
        })
    };
    Vec::<String>::deserialize(from)?.into_iter().map(of_name).collect()
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
