//! The study without its grid: every key read or defaulted, strategies, supports.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde_json::{Map, json};

use super::source::Source;
use super::strategy::{Strategy, read_strategy};
use super::supports;
use crate::error::InputError;
use crate::keys::{self, KEYS, Key, SECTIONS};
use crate::study_file::Json;
use crate::value::{Value, json_value};
use billow_solver::scene::Support;

/// Everything a point starts from.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Base {
    pub settings: Settings,
    pub strategies: BTreeMap<String, Strategy>,
    pub supports: Vec<Support>,
}

/// The value of every key of [`KEYS`], in its order; `Null` where absent.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Settings {
    values: Vec<Value>,
}

impl Settings {
    /// The value of a key. Paths are literals of this crate, so an unknown one is a mistake in code.
    pub fn get(&self, path: &str) -> &Value {
        match keys::index(path) {
            Some(at) => &self.values[at],
            None => unreachable!("no key {path}"),
        }
    }

    pub fn at(&self, at: usize) -> &Value {
        &self.values[at]
    }

    pub fn number(&self, path: &str) -> Option<f64> {
        match self.get(path) {
            Value::Number(number) => Some(*number),
            _ => None,
        }
    }

    pub fn integer(&self, path: &str) -> Option<i64> {
        match self.get(path) {
            Value::Integer(number) => Some(*number),
            _ => None,
        }
    }

    pub fn maybe_text(&self, path: &str) -> Option<&str> {
        match self.get(path) {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    pub fn text(&self, path: &str) -> &str {
        self.maybe_text(path).unwrap_or_default()
    }

    /// Sets a key. Of keys that exclude each other the one set stays.
    pub fn set(&mut self, at: usize, value: Value) {
        self.values[at] = value;
        let excluded: &[&str] = match KEYS[at].path {
            "solver.stepping.adaptive" => &["solver.stepping.fixed"],
            "solver.stepping.fixed" => &["solver.stepping.adaptive"],
            "gas.species" => &["gas.species.gas_constant", "gas.species.cp"],
            _ => &[],
        };
        for other in excluded.iter().filter_map(|path| keys::index(path)) {
            self.values[other] = Value::Null;
        }
    }
}

/// The keys that hold more than one value, beside [`SECTIONS`].
const STRUCTURED: [&str; 3] = ["supports", "strategies", "grid"];

impl Base {
    pub fn read(tree: &Json, source: &Source) -> Result<Self, InputError> {
        let settings = Settings { values: KEYS.iter().map(Key::default_value).collect() };
        let mut base = Self { settings, strategies: BTreeMap::new(), supports: Vec::new() };
        check_version(tree, source)?;
        base.section("", tree, source)?;
        base.check_pairs(tree, source)?;
        base.supports = supports::read(tree.get("supports"), source)?;
        base.strategies.insert("direct".to_owned(), Strategy::direct());
        if let Some(json) = tree.get("strategies") {
            for (name, value) in object(json, "strategies", source)? {
                let strategy = read_strategy(name, value, source)?;
                base.strategies.insert(name.clone(), strategy);
            }
        }
        let name = base.settings.text("strategy");
        base.check_strategy(name, "strategy", source)?;
        Ok(base)
    }

    /// Reads the keys below `prefix`.
    fn section(&mut self, prefix: &str, json: &Json, source: &Source) -> Result<(), InputError> {
        for (name, value) in object(json, prefix, source)? {
            let path = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
            let section = SECTIONS.iter().any(|(section, _)| *section == path);
            match keys::index(&path) {
                // A species is a word or a section of its own.
                Some(_) if section && matches!(value, Json::Object(_)) => {
                    self.section(&path, value, source)?;
                }
                Some(at) => {
                    let value = read(&KEYS[at], value, &path, source)?;
                    self.settings.values[at] = value;
                }
                None if section => self.section(&path, value, source)?,
                None if prefix.is_empty() && STRUCTURED.contains(&name.as_str()) => {}
                None => return Err(unknown(prefix, &path, name, value, source)),
            }
        }
        Ok(())
    }

    /// Keys that come in pairs, or exclude each other.
    fn check_pairs(&mut self, tree: &Json, source: &Source) -> Result<(), InputError> {
        let stepping = tree.get("solver").and_then(|solver| solver.get("stepping"));
        if let Some(stepping) = stepping {
            let given = |key: &str| stepping.get(key).is_some();
            if given("adaptive") && given("fixed") {
                return Err(source.error(
                    "solver.stepping",
                    &stepping.brief(),
                    "gives both adaptive and fixed",
                    "one of {\"adaptive\": 1e-6}, {\"fixed\": \"10 us\"}",
                ));
            }
            if let (true, Some(at)) = (given("fixed"), keys::index("solver.stepping.fixed")) {
                let fixed = self.settings.at(at).clone();
                self.settings.set(at, fixed);
            }
        }
        let species = tree.get("gas").and_then(|gas| gas.get("species"));
        if let Some(species @ Json::Object(_)) = species {
            for (key, unit) in [("gas_constant", "J/(kg K)"), ("cp", "J/(kg K)")] {
                if species.get(key).is_none() {
                    return Err(source.error(
                        &format!("gas.species.{key}"),
                        "",
                        "missing: a gas of its own needs gas_constant and cp",
                        format!("a specific heat in {unit}"),
                    ));
                }
            }
            if let Some(at) = keys::index("gas.species") {
                self.settings.values[at] = Value::Null;
            }
        }
        Ok(())
    }

    /// Whether a strategy is known.
    pub fn check_strategy(&self, name: &str, key: &str, source: &Source) -> Result<(), InputError> {
        if self.strategies.contains_key(name) {
            return Ok(());
        }
        let near = keys::nearest(name, self.strategies.keys().map(String::as_str));
        let near = near.map_or_else(String::new, |near| format!("; did you mean {near:?}?"));
        let known: Vec<&str> = self.strategies.keys().map(String::as_str).collect();
        Err(source.error(
            key,
            &Json::Text(name.to_owned()).brief(),
            format!("is no strategy of this study{near}"),
            known.join(", "),
        ))
    }

    /// Settings, strategies and supports, spelled out.
    pub fn to_json(&self) -> serde_json::Value {
        let mut json = json!({});
        for (key, value) in KEYS.iter().zip(&self.settings.values) {
            if *value == Value::Null {
                continue;
            }
            let place = key.path.split('.').fold(&mut json, |place, part| &mut place[part]);
            *place = json_value(value);
        }
        let strategies = self.strategies.iter();
        let strategies = strategies.map(|(name, strategy)| (name.clone(), strategy.to_json()));
        json["strategies"] = strategies.collect::<Map<_, _>>().into();
        let supports = self
            .supports
            .iter()
            .map(|support| json!({"on": supports::place_name(support.on), "fix": support.fix}));
        json["supports"] = supports.collect::<Vec<_>>().into();
        json
    }
}

/// First of all: a newer format may mean anything by its other keys.
fn check_version(tree: &Json, source: &Source) -> Result<(), InputError> {
    match tree.get("version") {
        Some(Json::Integer(version)) if *version > 1 => Err(source.error(
            "version",
            &version.to_string(),
            "is a newer format than this program reads",
            "1; or use a newer billow",
        )),
        _ => Ok(()),
    }
}

/// Reads one value of a key at a place.
pub(super) fn read(key: &Key, json: &Json, at: &str, source: &Source) -> Result<Value, InputError> {
    key.read(json)
        .map_err(|refusal| source.error(at, &json.brief(), refusal.problem, refusal.allowed))
}

/// The members of an object.
pub(super) fn object<'a>(
    json: &'a Json,
    at: &str,
    source: &Source,
) -> Result<&'a [(String, Json)], InputError> {
    match json {
        Json::Object(members) => Ok(members),
        other => Err(source.error(
            at,
            &other.brief(),
            format!("is {}, not an object", other.kind()),
            match children(at) {
                names if names.is_empty() => "an object".to_owned(),
                names => names.join(", "),
            },
        )),
    }
}

/// The items of a list.
pub(super) fn list<'a>(
    json: &'a Json,
    at: &str,
    source: &Source,
    allowed: &str,
) -> Result<&'a [Json], InputError> {
    match json {
        Json::List(items) => Ok(items),
        other => {
            let problem = format!("is {}, not a list", other.kind());
            Err(source.error(at, &other.brief(), problem, allowed))
        }
    }
}

/// Names of the keys and sections right below a path.
pub(super) fn children(prefix: &str) -> Vec<&'static str> {
    let mut names: Vec<&'static str> = Vec::new();
    for path in SECTIONS.iter().map(|(path, _)| *path).chain(KEYS.iter().map(|key| key.path)) {
        let rest = match prefix {
            "" => Some(path),
            _ => path.strip_prefix(prefix).and_then(|rest| rest.strip_prefix('.')),
        };
        let Some(name) = rest.and_then(|rest| rest.split('.').next()) else { continue };
        if !names.contains(&name) {
            names.push(name);
        }
    }
    if prefix.is_empty() {
        names.extend(STRUCTURED);
    }
    names
}

fn unknown(prefix: &str, path: &str, name: &str, value: &Json, source: &Source) -> InputError {
    let known = children(prefix);
    let mut problem = "is no key of a study".to_owned();
    if let Some(near) = keys::nearest(name, known.iter().copied()) {
        let _ = write!(problem, "; did you mean {near}?");
    } else if let Some(elsewhere) = keys::find(name) {
        let _ = write!(problem, "; did you mean {}?", KEYS[elsewhere].path);
    }
    source.error(path, &value.brief(), problem, known.join(", "))
}
