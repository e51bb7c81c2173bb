//! The study without its grid: every key read or defaulted, strategies, supports.

use std::collections::BTreeMap;

use serde_json::{Map, json};

use super::source::Source;
use crate::cli::print::json_value;
use crate::error::InputError;
use crate::keys::{self, KEYS, Key, SECTIONS, STRATEGY_KEYS, WINDOW_KEYS};
use crate::study_file::Json;
use crate::value::Value;
use billow_solver::scene::{Support, SupportPlace};

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

/// A named inflation schedule.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Strategy {
    /// Values of [`STRATEGY_KEYS`].
    pub values: Vec<Value>,
    /// Inflow windows: values of [`WINDOW_KEYS`].
    pub inflow: Vec<Vec<Value>>,
}

impl Strategy {
    /// Released at once, inflow from release to the end.
    fn direct() -> Self {
        Self {
            values: STRATEGY_KEYS.iter().map(Key::default_value).collect(),
            inflow: vec![WINDOW_KEYS.iter().map(Key::default_value).collect()],
        }
    }
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
        base.check_version(tree, source)?;
        base.section("", tree, source)?;
        base.check_pairs(tree, source)?;
        base.supports = supports(tree.get("supports"), source)?;
        base.strategies.insert("direct".to_owned(), Strategy::direct());
        if let Some(json) = tree.get("strategies") {
            for (name, value) in object(json, "strategies", source)? {
                let strategy = strategy(name, value, source)?;
                base.strategies.insert(name.clone(), strategy);
            }
        }
        let name = base.settings.text("strategy");
        base.check_strategy(name, "strategy", source)?;
        Ok(base)
    }

    /// First of all: a newer format may mean anything by its other keys.
    fn check_version(&self, tree: &Json, source: &Source) -> Result<(), InputError> {
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
        let members = |keys: &[Key], values: &[Value]| {
            let given = keys.iter().zip(values).filter(|(_, value)| **value != Value::Null);
            given
                .map(|(key, value)| (key.path.to_owned(), json_value(value)))
                .collect::<Map<_, _>>()
        };
        let strategies = self.strategies.iter().map(|(name, strategy)| {
            let mut json = members(STRATEGY_KEYS, &strategy.values);
            let inflow: Vec<serde_json::Value> =
                strategy.inflow.iter().map(|window| members(WINDOW_KEYS, window).into()).collect();
            json.insert("inflow".to_owned(), inflow.into());
            (name.clone(), json.into())
        });
        json["strategies"] = strategies.collect::<Map<_, _>>().into();
        let supports = self
            .supports
            .iter()
            .map(|support| json!({"on": place_name(support.on), "fix": support.fix}));
        json["supports"] = supports.collect::<Vec<_>>().into();
        json
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
            children(at).join(", "),
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
        problem.push_str(&format!("; did you mean {near}?"));
    } else if let Some(elsewhere) = keys::find(name) {
        problem.push_str(&format!("; did you mean {}?", KEYS[elsewhere].path));
    }
    source.error(path, &value.brief(), problem, known.join(", "))
}

/// Names of the places a support acts on.
pub(crate) const PLACES: [(&str, SupportPlace); 4] = [
    ("bottom_ring", SupportPlace::BottomRing),
    ("top_ring", SupportPlace::TopRing),
    ("bottom_cap", SupportPlace::BottomCap),
    ("top_cap", SupportPlace::TopCap),
];

fn place_name(place: SupportPlace) -> &'static str {
    PLACES.iter().find(|(_, known)| *known == place).map_or("", |(name, _)| name)
}

/// Supports in the order of [`PLACES`], one a place, components in the order x y z: the same
/// supports are the same job.
fn supports(json: Option<&Json>, source: &Source) -> Result<Vec<Support>, InputError> {
    let Some(json) = json else {
        return Ok(vec![Support { on: SupportPlace::BottomRing, fix: "xyz".to_owned() }]);
    };
    let allowed = "a list of {\"on\": \"bottom_ring\", \"fix\": \"xyz\"}";
    let mut fixed = [""; 4].map(str::to_owned);
    for (at, item) in list(json, "supports", source, allowed)?.iter().enumerate() {
        let key = format!("supports[{at}]");
        let (mut on, mut fix) = (None, None);
        let Json::Object(members) = item else {
            let problem = format!("is {}, not an object", item.kind());
            return Err(source.error(&key, &item.brief(), problem, allowed));
        };
        for (name, value) in members {
            let key = format!("{key}.{name}");
            match (name.as_str(), value) {
                ("on", Json::Text(word)) => {
                    on = PLACES.iter().position(|(known, _)| known == word);
                    if on.is_none() {
                        let known = PLACES.map(|(known, _)| known).join(", ");
                        let problem = "is no place of a capsule";
                        return Err(source.error(&key, &value.brief(), problem, known));
                    }
                }
                ("fix", Json::Text(axes)) => {
                    let sound = !axes.is_empty()
                        && axes.chars().all(|c| matches!(c, 'x' | 'y' | 'z'))
                        && "xyz".chars().all(|c| axes.matches(c).count() <= 1);
                    if !sound {
                        let problem = "names no displacement components";
                        let allowed = "letters of \"xyz\", each once";
                        return Err(source.error(&key, &value.brief(), problem, allowed));
                    }
                    fix = Some(axes);
                }
                ("on" | "fix", other) => {
                    let problem = format!("is {}, not a text", other.kind());
                    return Err(source.error(&key, &other.brief(), problem, allowed));
                }
                _ => {
                    let problem = "is no key of a support";
                    return Err(source.error(&key, &value.brief(), problem, "on, fix"));
                }
            }
        }
        match (on, fix) {
            (Some(on), Some(fix)) => fixed[on].push_str(fix),
            (None, _) => return Err(source.error(&key, &item.brief(), "has no `on`", allowed)),
            (_, None) => return Err(source.error(&key, &item.brief(), "has no `fix`", allowed)),
        }
    }
    let support = |(&(_, on), axes): (&(&str, SupportPlace), String)| {
        let fix: String = "xyz".chars().filter(|c| axes.contains(*c)).collect();
        (!fix.is_empty()).then_some(Support { on, fix })
    };
    Ok(PLACES.iter().zip(fixed).filter_map(support).collect())
}

/// Names a strategy may have: they stand in paths and expressions.
pub(super) fn is_name(name: &str) -> bool {
    let mut chars = name.chars();
    chars.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_')
        && chars.all(|c| c.is_ascii_alphanumeric() || c == '_')
        && name.len() <= 64
}

fn strategy(name: &str, json: &Json, source: &Source) -> Result<Strategy, InputError> {
    let at = format!("strategies.{name}");
    if !is_name(name) {
        let allowed = "a letter, then letters, digits and _";
        return Err(source.error(&at, "", "is no name for a strategy", allowed));
    }
    let allowed = "release_time, preinflation_mass, inflow";
    let Json::Object(members) = json else {
        let problem = format!("is {}, not an object", json.kind());
        return Err(source.error(&at, &json.brief(), problem, allowed));
    };
    let mut strategy = Strategy::direct();
    for (name, value) in members {
        let at = format!("{at}.{name}");
        if name == "inflow" {
            let allowed = "a list of {\"from\": \"5 s\", \"to\": \"12 s\", \"rate\": \"1 g/s\"}";
            strategy.inflow = list(value, &at, source, allowed)?
                .iter()
                .enumerate()
                .map(|(number, value)| window(value, &format!("{at}[{number}]"), source))
                .collect::<Result<_, _>>()?;
        } else if let Some(key) = STRATEGY_KEYS.iter().position(|key| key.path == name) {
            strategy.values[key] = read(&STRATEGY_KEYS[key], value, &at, source)?;
        } else {
            let problem = near("a strategy", name, allowed);
            return Err(source.error(&at, &value.brief(), problem, allowed));
        }
    }
    Ok(strategy)
}

fn window(json: &Json, at: &str, source: &Source) -> Result<Vec<Value>, InputError> {
    let allowed = "from, to, rate, temperature";
    let Json::Object(members) = json else {
        let problem = format!("is {}, not an object", json.kind());
        return Err(source.error(at, &json.brief(), problem, allowed));
    };
    let mut values: Vec<Value> = WINDOW_KEYS.iter().map(Key::default_value).collect();
    for (name, value) in members {
        let at = format!("{at}.{name}");
        match WINDOW_KEYS.iter().position(|key| key.path == name) {
            Some(key) => values[key] = read(&WINDOW_KEYS[key], value, &at, source)?,
            None => {
                let problem = near("an inflow window", name, allowed);
                return Err(source.error(&at, &value.brief(), problem, allowed));
            }
        }
    }
    Ok(values)
}

fn near(what: &str, name: &str, allowed: &str) -> String {
    match keys::nearest(name, allowed.split(", ")) {
        Some(near) => format!("is no key of {what}; did you mean {near}?"),
        None => format!("is no key of {what}"),
    }
}
