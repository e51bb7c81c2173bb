//! The JSON Schemas (2020-12) of the study file and the scene file, built from their tables of keys.
//!
//! It says what one value may be; what values may stand together (a fit and what it needs, a key
//! given or varied) the program itself checks.

mod scene;

use std::fmt::Write as _;

use serde_json::{Map, Value as Json, json};

use crate::input::keys::{
    self, Default, KEYS, Key, Kind, Quantity, STRATEGY_KEYS, STUDY, Table, WINDOW_KEYS,
};
use crate::input::units::Dimension;
use crate::input::value::{Value, json_value};

pub use scene::scene_schema;

/// A number as a text begins with it.
const NUMBER: &str = r"^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?\s*";

/// A unit of several symbols or powers: which ones is the program's to check.
const COMPOUND: &str = r"[^\s0-9][^\s]*[/^*·0-9 ].*";

/// A number with a unit of the dimension after it, as JSON Schema can say it.
fn quantity_pattern(dimension: Dimension) -> String {
    let symbols = crate::input::units::symbols(dimension).join("|");
    let mut alone = if symbols.is_empty() { String::new() } else { format!("{symbols}|") };
    if dimension.units().iter().any(|unit| unit.starts_with("1/")) {
        alone.push_str(r"1\s*/.+|");
    }
    format!(r"{NUMBER}({alone}{COMPOUND})\s*$")
}

/// A number with any unit after it.
fn any_pattern() -> String {
    format!(r"{NUMBER}[^\s0-9].*$")
}

/// Names a strategy may have.
const NAME: &str = "^[A-Za-z_][A-Za-z0-9_]{0,63}$";

/// The schema of a study file.
pub fn study_schema() -> Json {
    let mut properties = Map::new();
    for key in KEYS.iter().filter(|key| !key.path.contains('.')) {
        properties.insert(key.path.to_owned(), property(key));
    }
    for (section, _) in STUDY.sections.iter().filter(|(path, _)| !path.contains('.')) {
        properties.insert((*section).to_owned(), object(&STUDY, section));
    }
    properties.insert("supports".to_owned(), supports());
    properties.insert("strategies".to_owned(), strategies());
    properties.insert("grid".to_owned(), grid());
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "billow study",
        "description": "A question put to inflatable capsules: one design, film, gas and solver, and \
                        a grid of what varies. A number is SI; a text carries its unit.",
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
    })
}

/// One section, with the sections within it.
fn object(table: &Table, section: &str) -> Json {
    let mut properties = Map::new();
    let below = |path: &'static str| {
        path.strip_prefix(section)
            .and_then(|rest| rest.strip_prefix('.'))
            .filter(|rest| !rest.contains('.'))
    };
    for key in &table.keys {
        if let Some(name) = below(key.path) {
            properties.insert(name.to_owned(), property(key));
        }
    }
    for (path, _) in table.sections {
        if let Some(name) = below(path) {
            let inner = object(table, path);
            // A section that is a key as well (gas.species) is a word or an object.
            let whole = match properties.remove(name) {
                Some(Json::Object(mut word)) => {
                    let mut choice = Map::new();
                    choice.insert("title".to_owned(), json!(title(path)));
                    for note in ["description", "default", "examples"] {
                        word.remove("title");
                        if let Some(value) = word.remove(note) {
                            choice.insert(note.to_owned(), value);
                        }
                    }
                    choice.insert("oneOf".to_owned(), json!([word, inner]));
                    choice.into()
                }
                _ => inner,
            };
            properties.insert(name.to_owned(), whole);
        }
    }
    let doc = table.sections.iter().find(|(path, _)| *path == section).map_or("", |(_, doc)| doc);
    let mut schema = json!({
        "title": title(section),
        "description": doc,
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
    });
    if section == "solver.stepping" {
        schema["maxProperties"] = json!(1);
    }
    if section == "gas.species" {
        schema["required"] = json!(["gas_constant", "cp"]);
    }
    schema
}

fn title(path: &str) -> String {
    path.rsplit('.').next().unwrap_or(path).replace('_', " ")
}

/// A key with its title, description, default and example.
fn property(key: &Key) -> Json {
    let mut schema = Map::new();
    schema.insert("title".to_owned(), json!(title(key.path)));
    let mut description = key.doc.to_owned();
    match key.default {
        Default::Absent(meaning) => {
            let _ = write!(description, " Default: {meaning}.");
        }
        Default::Required if keys::find(key.path).is_some() => {
            description.push_str(" Required; in a study, here or under grid.");
        }
        Default::Required => description.push_str(" Required."),
        _ => {}
    }
    if let Kind::Quantity(quantity) = key.kind
        && quantity.dimension != Dimension::Number
    {
        let units = quantity.dimension.units();
        let _ =
            write!(description, " A number in {}, or with a unit: {}.", units[0], units.join(", "));
    }
    schema.insert("description".to_owned(), json!(description));
    let default = key.default_value();
    if default != Value::Null {
        schema.insert("default".to_owned(), json_value(&default));
    }
    if let Ok(example) = serde_json::from_str::<Json>(key.example) {
        schema.insert("examples".to_owned(), json!([example]));
    }
    if let Json::Object(kind) = kind(key) {
        schema.extend(kind);
    }
    schema.into()
}

/// What a key may hold.
fn kind(key: &Key) -> Json {
    match key.kind {
        Kind::Quantity(quantity) => json!({"oneOf": forms(quantity)}),
        Kind::Integer(min, max) => json!({"type": "integer", "minimum": min, "maximum": max}),
        Kind::Choice(words) => json!({"enum": words}),
        Kind::Text => json!({"type": "string"}),
        Kind::Flag => json!({"type": "boolean"}),
        Kind::Vector(quantity) => {
            let mut part = forms(quantity);
            if matches!(key.path, "min" | "max") {
                part.push(json!({"type": "null"}));
            }
            json!({"type": "array", "items": {"oneOf": part}, "minItems": 3, "maxItems": 3})
        }
    }
}

/// A quantity as a number, as a text with a unit, as a word.
fn forms(quantity: Quantity) -> Vec<Json> {
    let least = if quantity.above { "exclusiveMinimum" } else { "minimum" };
    let mut number = json!({"type": "number", "maximum": quantity.max});
    number[least] = json!(quantity.min);
    let mut forms =
        vec![number, json!({"type": "string", "pattern": quantity_pattern(quantity.dimension)})];
    let words: Vec<&str> = quantity.words.iter().map(|(word, _)| *word).collect();
    if !words.is_empty() {
        forms.push(json!({"enum": words}));
    }
    forms
}

fn supports() -> Json {
    let places: Vec<&str> = crate::input::supports::PLACES.iter().map(|(name, _)| *name).collect();
    json!({
        "title": "supports",
        "description": "What holds the capsule.",
        "default": [{"on": "bottom_ring", "fix": "xyz"}],
        "type": "array",
        "items": {
            "type": "object",
            "properties": {
                "on": {"title": "on", "description": "Where it acts.", "enum": places},
                "fix": {
                    "title": "fix",
                    "description": "Displacement components it holds: letters of xyz, each once.",
                    "type": "string",
                    "pattern": "^(?!.*(.).*\\1)[xyz]{1,3}$",
                },
            },
            "required": ["on", "fix"],
            "additionalProperties": false,
        },
    })
}

fn members(keys: &[Key]) -> Map<String, Json> {
    keys.iter().map(|key| (key.path.to_owned(), property(key))).collect()
}

fn strategies() -> Json {
    let mut properties = members(STRATEGY_KEYS);
    let inflow = json!({
        "title": "inflow",
        "description": "Inflow windows; overlapping ones add up.",
        "default": [{}],
        "type": "array",
        "items": {
            "type": "object",
            "properties": members(WINDOW_KEYS),
            "additionalProperties": false,
        },
    });
    properties.insert("inflow".to_owned(), inflow);
    json!({
        "title": "strategies",
        "description": "Inflation strategies: named schedules. `direct` is there by itself: released \
                        at once, inflow from release to the end.",
        "type": "object",
        "patternProperties": {NAME: {
            "type": "object",
            "properties": properties,
            "additionalProperties": false,
        }},
        "additionalProperties": false,
    })
}

/// An axis: a list of values or, of numbers, a range.
fn axis(key: &Key) -> Json {
    let list = json!({"type": "array", "minItems": 1, "items": kind(key)});
    match key.kind {
        Kind::Choice(_) | Kind::Text => list,
        _ => {
            let step = json!({"oneOf": [
                {"type": "number", "exclusiveMinimum": 0},
                {"type": "string", "pattern": any_pattern()},
            ]});
            let range = json!({
                "type": "object",
                "properties": {
                    "from": kind(key),
                    "to": kind(key),
                    "steps": {
                        "description": "How many values, both ends counted.",
                        "type": "integer",
                        "minimum": 2,
                    },
                    "step": step,
                    "spacing": {"enum": ["linear", "log"], "default": "linear"},
                },
                "required": ["from", "to"],
                "oneOf": [{"required": ["steps"]}, {"required": ["step"]}],
                "additionalProperties": false,
            });
            json!({"oneOf": [list, range]})
        }
    }
}

fn grid() -> Json {
    // A key by its short name and by its path; strategies by pattern.
    let named = |schema: &dyn Fn(&Key) -> Json| {
        let mut properties = Map::new();
        for (at, key) in KEYS.iter().enumerate().filter(|(_, key)| key.varies()) {
            for name in [keys::short_name(at), key.path] {
                properties.insert(name.to_owned(), schema(key));
            }
        }
        let mut patterns = Map::new();
        let patterned =
            STRATEGY_KEYS.iter().map(|key| (r"^strategies\.[A-Za-z_][A-Za-z0-9_]*\.", key)).chain(
                WINDOW_KEYS
                    .iter()
                    .map(|key| (r"^strategies\.[A-Za-z_][A-Za-z0-9_]*\.inflow\[[0-9]+\]\.", key)),
            );
        for (before, key) in patterned {
            patterns.insert(format!("{before}{}$", key.path), schema(key));
        }
        (properties, patterns)
    };
    let (mut axes, axis_patterns) = named(&axis);
    let (values, value_patterns) = named(&kind);
    let group = json!({
        "type": "object",
        "properties": axes,
        "patternProperties": axis_patterns,
        "minProperties": 1,
        "additionalProperties": false,
    });
    let single = json!({
        "type": "object",
        "properties": values,
        "patternProperties": value_patterns,
        "additionalProperties": false,
    });
    axes.insert(
        "zip".to_owned(),
        json!({
            "description": "Groups of keys that vary together: lists of equal length.",
            "type": "array",
            "items": group,
        }),
    );
    axes.insert(
        "points".to_owned(),
        json!({
            "description": "Single points, after the product.",
            "type": "array",
            "items": single,
        }),
    );
    axes.insert(
        "filter".to_owned(),
        json!({
            "description": "Condition a point must meet, as in \"feasible and M >= 3\".",
            "type": "string",
        }),
    );
    json!({
        "title": "grid",
        "description": "What varies: every combination of the axes, the first varying slowest.",
        "type": "object",
        "properties": axes,
        "patternProperties": axis_patterns,
        "additionalProperties": false,
    })
}
