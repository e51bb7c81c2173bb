//! Reads a map file: the first value that is not allowed, with its place, key, value, and what is allowed.

use std::path::Path;

use super::Method;
use super::file::{ANY, Axis, Choice, FAILS, Map, Rule, Search, Theory};
use super::scenes::{self, Parameter, SCENES, StabilityScene, Values};
use billow_study::input::study_file::{self, Json, with_place};
use billow_study::job::Status;
use billow_study::platform::error::{InputError, Result};
use billow_study::platform::nearest::did_you_mean;

/// Most values of an axis. Chosen: a picture shows them.
const MAX_VALUES: usize = 16;
/// Every integrator of film, as a method.
const FILM: &str = "film";

/// Reads a map file.
///
/// # Errors
/// A file that cannot be read, or the first value that is not allowed: its place, key, value, and what is allowed.
pub fn read(path: &Path) -> Result<(Vec<u8>, Vec<Map>)> {
    let bytes = study_file::read(path, "map file", "studies/stability.json")?;
    let file = path.display().to_string();
    let text = study_file::text_of(&bytes, &file)?;
    let json = study_file::parse(text, &file)?;
    let maps = maps(&json).map_err(|mut error| {
        error.file.clone_from(&file);
        with_place(error, text, &file)
    })?;
    Ok((bytes, maps))
}

type Checked<T> = std::result::Result<T, InputError>;

/// The error of a value; the file is added later.
fn refuse(
    key: &str,
    value: &Json,
    problem: &str,
    allowed: &str,
    hint: Option<String>,
) -> InputError {
    let file = String::new();
    let [key, problem, allowed] = [key, problem, allowed].map(str::to_owned);
    InputError { file, key, value: value.brief(), problem, allowed, hint: hint.unwrap_or_default() }
}

/// The members of an object with these keys only.
fn members<'a>(json: &'a Json, key: &str, known: &[&str]) -> Checked<&'a [(String, Json)]> {
    let Json::Object(members) = json else {
        return Err(refuse(key, json, &format!("is {}", json.kind()), "an object", None));
    };
    for (name, value) in members {
        if !known.contains(&name.as_str()) {
            let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
            let near = did_you_mean(name, known.iter().copied());
            return Err(refuse(&key, value, "unknown key", &known.join(", "), near));
        }
    }
    Ok(members)
}

fn list<'a>(json: &'a Json, key: &str) -> Checked<&'a [Json]> {
    match json {
        Json::List(items) if !items.is_empty() => Ok(items),
        _ => Err(refuse(key, json, "is no list with a value", "a list", None)),
    }
}

fn text<'a>(json: &'a Json, key: &str) -> Checked<&'a str> {
    match json {
        Json::Text(text) if !text.is_empty() => Ok(text),
        _ => Err(refuse(key, json, "is no text", "a text", None)),
    }
}

/// The text of a member; empty without it.
fn optional_text(json: &Json, key: &str, name: &str) -> Checked<String> {
    json.get(name)
        .map_or(Ok(String::new()), |json| text(json, &format!("{key}.{name}")).map(str::to_owned))
}

/// A number in a range, in a unit that errors name.
fn number(json: &Json, key: &str, range: [f64; 2], unit: &str) -> Checked<f64> {
    let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
    let allowed = format!("a number from {} to {}{unit}", range[0], range[1]);
    let value = match json {
        Json::Integer(value) => *value as f64,
        Json::Number(value) => *value,
        other => {
            let problem = format!("is {}, not a number", other.kind());
            return Err(refuse(key, json, &problem, &allowed, None));
        }
    };
    if (range[0]..=range[1]).contains(&value) {
        return Ok(value);
    }
    Err(refuse(key, json, "out of range", &allowed, None))
}

/// The member of an object that must be there.
fn needed<'a>(json: &'a Json, key: &str, name: &str) -> Checked<&'a Json> {
    json.get(name).ok_or_else(|| {
        refuse(
            &format!("{key}.{name}"),
            &Json::Null,
            "is missing",
            "every map needs name, scene and axes",
            None,
        )
    })
}

/// A value of a parameter.
fn value(parameter: &Parameter, json: &Json, key: &str) -> Checked<f64> {
    let value = number(json, key, parameter.range, parameter.unit)?;
    if parameter.whole && value.fract().abs() > 0.0 {
        return Err(refuse(key, json, "is no whole number", "a whole number", None));
    }
    Ok(value)
}

/// The parameter of a scene.
fn parameter(
    scene: &'static StabilityScene,
    name: &str,
    key: &str,
    json: &Json,
) -> Checked<&'static Parameter> {
    scene.parameter(name).ok_or_else(|| {
        let names: Vec<&str> = scene.parameters.iter().map(|parameter| parameter.name).collect();
        let problem = format!("no parameter of the scene {}", scene.name);
        refuse(key, json, &problem, &names.join(", "), did_you_mean(name, names.iter().copied()))
    })
}

/// The methods that an object names; those of the scene without any.
fn methods(json: &Json, key: &str, scene: &StabilityScene) -> Checked<Vec<Method>> {
    let Some(given) = json.get("methods") else { return Ok(scene.methods()) };
    let key = format!("{key}.methods");
    let names = scene.methods().into_iter().map(Method::name);
    let known: Vec<&str> = [FILM].into_iter().chain(names).collect();
    let mut found = Vec::new();
    for (index, json) in list(given, &key)?.iter().enumerate() {
        let key = format!("{key}[{index}]");
        let name = text(json, &key)?;
        let named = |method: &Method| match method {
            Method::Film(_) => name == FILM || method.name() == name,
            Method::Piston | Method::Storeys | Method::Statics => method.name() == name,
        };
        let methods: Vec<Method> = scene.methods().into_iter().filter(named).collect();
        if methods.is_empty() {
            let near = did_you_mean(name, known.iter().copied());
            let problem = format!("no method of the scene {}", scene.name);
            return Err(refuse(&key, json, &problem, &known.join(", "), near));
        }
        found.extend(methods);
    }
    Ok(found)
}

fn maps(json: &Json) -> Checked<Vec<Map>> {
    let empty = Json::Null;
    if json.get("maps").is_none() {
        let hint = "if this is a study: billow run FILE".to_owned();
        return Err(refuse("maps", &empty, "is missing", "description, maps", Some(hint)));
    }
    members(json, "", &["description", "maps"])?;
    let given = list(json.get("maps").unwrap_or(&empty), "maps")?;
    let mut maps: Vec<Map> = Vec::new();
    for (index, json) in given.iter().enumerate() {
        let key = format!("maps[{index}]");
        let map = map(json, &key)?;
        if maps.iter().any(|known| known.name == map.name) {
            let name = json.get("name").unwrap_or(&empty);
            return Err(refuse(
                &format!("{key}.name"),
                name,
                "is the name of two maps",
                "one name a map",
                None,
            ));
        }
        maps.push(map);
    }
    Ok(maps)
}

fn map(json: &Json, key: &str) -> Checked<Map> {
    let known = [
        "name",
        "description",
        "scene",
        "methods",
        "axes",
        "values",
        "border",
        "theory",
        "strip",
        "expect",
    ];
    members(json, key, &known)?;
    let name_key = format!("{key}.name");
    let name_json = needed(json, key, "name")?;
    let name = text(name_json, &name_key)?.to_owned();
    if !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
        let allowed = "letters, digits and _ : pictures have this name";
        return Err(refuse(&name_key, name_json, "is no plain name", allowed, None));
    }
    let (scene_key, scene_json) = (format!("{key}.scene"), needed(json, key, "scene")?);
    let scene_name = text(scene_json, &scene_key)?;
    let scene = scenes::find(scene_name).ok_or_else(|| {
        let names = SCENES.map(|scene| scene.name);
        let near = did_you_mean(scene_name, names.into_iter());
        refuse(&scene_key, scene_json, "unknown scene", &names.join(", "), near)
    })?;
    let methods_of_map = methods(json, key, scene)?;
    let axes = axes(needed(json, key, "axes")?, &format!("{key}.axes"), scene)?;
    let mut values = Values::of(scene);
    if let Some(given) = json.get("values") {
        let names: Vec<&str> = scene.parameters.iter().map(|parameter| parameter.name).collect();
        for (name, json) in members(given, &format!("{key}.values"), &names)? {
            let key = format!("{key}.values.{name}");
            if axes.iter().any(|axis| axis.parameter.name == name) {
                return Err(refuse(
                    &key,
                    json,
                    "is an axis too",
                    "parameters that are no axis",
                    None,
                ));
            }
            values.set(name, value(parameter(scene, name, &key, json)?, json, &key)?);
        }
    }
    let search = json.get("border").map(|json| search(json, &format!("{key}.border"), &axes));
    let theory = json.get("theory").map(|json| {
        let key = format!("{key}.theory");
        if !scene.has_theory() {
            let allowed = "only in maps of the scene sheet: its film is linear";
            return Err(refuse(&key, json, "no theory is known", allowed, None));
        }
        members(json, &key, &["methods", "within"])?;
        let within =
            number(needed(json, &key, "within")?, &format!("{key}.within"), [0.0, 1.0], "")?;
        Ok(Theory { methods: methods(json, &key, scene)?, within })
    });
    let strip = json.get("strip").map(|json| {
        let key = format!("{key}.strip");
        members(json, &key, &["methods", "where"])?;
        choice(json, &key, scene)
    });
    let rules = match json.get("expect") {
        Some(given) => {
            let key = format!("{key}.expect");
            let one = |(index, json)| rule(json, &format!("{key}[{index}]"), scene);
            list(given, &key)?.iter().enumerate().map(one).collect::<Checked<Vec<Rule>>>()?
        }
        None => Vec::new(),
    };
    Ok(Map {
        name,
        description: optional_text(json, key, "description")?,
        scene,
        methods: methods_of_map,
        values,
        axes,
        search: search.transpose()?,
        theory: theory.transpose()?,
        strip: strip.transpose()?,
        rules,
    })
}

fn axes(json: &Json, key: &str, scene: &'static StabilityScene) -> Checked<Vec<Axis>> {
    let Json::Object(given) = json else {
        return Err(refuse(
            key,
            json,
            "is no object",
            "one or two parameters with their values",
            None,
        ));
    };
    if !(1..=2).contains(&given.len()) {
        return Err(refuse(key, json, "a map has one or two axes", "one or two parameters", None));
    }
    let mut axes = Vec::new();
    for (name, json) in given {
        let key = format!("{key}.{name}");
        let parameter = parameter(scene, name, &key, json)?;
        let one =
            |(index, json): (usize, &Json)| value(parameter, json, &format!("{key}[{index}]"));
        let values =
            list(json, &key)?.iter().enumerate().map(one).collect::<Checked<Vec<f64>>>()?;
        if values.len() > MAX_VALUES || values.windows(2).any(|pair| pair[0] >= pair[1]) {
            let allowed = format!("at most {MAX_VALUES} values, each larger than the one before");
            return Err(refuse(&key, json, "cannot be an axis", &allowed, None));
        }
        axes.push(Axis { parameter, values });
    }
    Ok(axes)
}

fn search(json: &Json, key: &str, axes: &[Axis]) -> Checked<Search> {
    members(json, key, &["along", "within"])?;
    let (place, along) = (format!("{key}.along"), needed(json, key, "along")?);
    let name = text(along, &place)?;
    let found = axes.iter().position(|axis| axis.parameter.name == name && !axis.parameter.whole);
    let axis = found.ok_or_else(|| {
        let allowed = "an axis of the map whose values are real numbers";
        refuse(&place, along, "no such axis", allowed, None)
    })?;
    let within = match json.get("within") {
        Some(json) => number(json, &format!("{key}.within"), [1e-6, 1.0], "")?,
        None => 0.02,
    };
    Ok(Search { axis, within })
}

/// The cells that `methods` and `where` name.
fn choice(json: &Json, key: &str, scene: &'static StabilityScene) -> Checked<Choice> {
    let mut place = Vec::new();
    if let Some(Json::Object(given)) = json.get("where") {
        for (name, json) in given {
            let key = format!("{key}.where.{name}");
            let parameter = parameter(scene, name, &key, json)?;
            let end = |json| number(json, &key, parameter.range, parameter.unit);
            let range = match json {
                Json::List(ends) if ends.len() == 2 => [end(&ends[0])?, end(&ends[1])?],
                one => [end(one)?; 2],
            };
            place.push((parameter.name, range));
        }
    }
    Ok(Choice { methods: methods(json, key, scene)?, place })
}

fn rule(json: &Json, key: &str, scene: &'static StabilityScene) -> Checked<Rule> {
    members(json, key, &["methods", "where", "status", "why"])?;
    let (status_key, status) = (format!("{key}.status"), needed(json, key, "status")?);
    let given: Vec<&Json> = match status {
        Json::List(items) => items.iter().collect(),
        one => vec![one],
    };
    let word = |json: &Json| {
        let word = text(json, &status_key)?;
        if Status::from_name(word).is_some() || [FAILS, ANY].contains(&word) {
            return Ok(word.to_owned());
        }
        let names: Vec<&str> = [FAILS, ANY, Status::Done.name()]
            .into_iter()
            .chain(Status::all().filter(|status| status.is_failure()).map(Status::name))
            .collect();
        let near = did_you_mean(word, names.iter().copied());
        Err(refuse(&status_key, json, "unknown status", &names.join(", "), near))
    };
    let statuses = given.into_iter().map(word).collect::<Checked<Vec<String>>>()?;
    let why = optional_text(json, key, "why")?;
    Ok(Rule { of: choice(json, key, scene)?, statuses, why })
}
