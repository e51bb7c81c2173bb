//! The schema of a study file.

use serde_json::{Map, Value as Json, json};

use super::parts::{COMPONENTS, Definitions, annotated, any_quantity_pattern};
use crate::input::keys::{
    self, CAPSULE_SUPPORT_KEYS, GRID_MEANINGS, KEYS, Key, KeyKind, STRATEGY_KEYS, STUDY,
    WINDOW_KEYS,
};

/// Names a strategy may have.
const NAME: &str = "^[A-Za-z_][A-Za-z0-9_]{0,63}$";

/// Paths of the keys of a strategy, before the key itself.
const STRATEGY_PATH: &str = r"^strategies\.[A-Za-z_][A-Za-z0-9_]*\.";

/// Paths of the keys of an inflow window, before the key itself.
const WINDOW_PATH: &str = r"^strategies\.[A-Za-z_][A-Za-z0-9_]*\.inflow\[[0-9]+\]\.";

/// The schema of a study file.
pub fn study_schema() -> Json {
    let mut definitions = Definitions::default();
    let property = |definitions: &mut Definitions, key: &Key| {
        if key.varies() {
            let kind = value(definitions, key);
            annotated(key, kind)
        } else {
            definitions.property(key)
        }
    };
    let mut properties = Map::new();
    for key in KEYS.iter().filter(|key| !key.path.contains('.')) {
        properties.insert(key.path.to_owned(), property(&mut definitions, key));
    }
    for (section, _) in STUDY.sections.iter().filter(|(path, _)| !path.contains('.')) {
        let mut schema = definitions.section(&STUDY, section, &property);
        if *section == "solver" {
            schema["properties"]["meshes"] = meshes();
        }
        properties.insert((*section).to_owned(), schema);
    }
    properties.insert("supports".to_owned(), supports(&mut definitions));
    properties.insert("strategies".to_owned(), strategies(&mut definitions));
    properties.insert("grid".to_owned(), grid(&mut definitions));
    properties.insert("replicates".to_owned(), replicates(&mut definitions));
    properties.insert("limits".to_owned(), limits());
    properties.insert("accuracy".to_owned(), accuracy());
    properties.insert(
        "units".to_owned(),
        json!({
            "title": "units",
            "description": STUDY.meaning("units"),
            "type": "object",
            "additionalProperties": {"type": "string", "minLength": 1},
        }),
    );
    properties.insert(
        "checksum".to_owned(),
        json!({
            "title": "checksum",
            "description": "That of study.json in a results folder; ignored in a study file.",
            "type": "string",
        }),
    );
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "billow study",
        "description": "A question about inflatable capsules: one design, film, gas and solver, and \
                        a grid of what varies. A number is SI; a text carries its unit.",
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
        "$defs": definitions.into_json(),
    })
}

/// What a key of the study may hold, as a definition: its section, axes and points refer to it.
fn value(definitions: &mut Definitions, key: &Key) -> Json {
    definitions.refer(&format!("value.{}", key.path), |definitions| definitions.kind(key))
}

fn accuracy() -> Json {
    let number = json!({"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1});
    let text = json!({"type": "string", "pattern": r"^\s*[0-9.]+(e-?[0-9]+)?\s*%?\s*$"});
    json!({
        "title": "accuracy",
        "description": STUDY.meaning("accuracy"),
        "oneOf": [number, text, {
            "type": "object",
            "properties": {"meshes": {
                "type": "array", "items": {"type": "integer", "minimum": 1}, "minItems": 1, "maxItems": 3,
            }},
            // Any other member is a measure.
            "additionalProperties": {"oneOf": [number, text]},
            "minProperties": 1,
        }],
    })
}

fn meshes() -> Json {
    json!({
        "title": "meshes",
        "description": STUDY.meaning("solver.meshes"),
        "type": "array",
        "items": {"type": "integer", "minimum": 1},
        "minItems": 2,
        "maxItems": 3,
        "uniqueItems": true,
    })
}

fn supports(definitions: &mut Definitions) -> Json {
    let mut properties = definitions.members(CAPSULE_SUPPORT_KEYS);
    properties["fix"]["pattern"] = json!(COMPONENTS);
    json!({
        "title": "supports",
        "description": STUDY.meaning("supports"),
        "default": [{"on": "bottom_ring", "fix": "xyz"}],
        "type": "array",
        "items": {
            "type": "object",
            "properties": properties,
            "required": ["on", "fix"],
            "additionalProperties": false,
        },
    })
}

fn strategies(definitions: &mut Definitions) -> Json {
    let mut properties = definitions.members(STRATEGY_KEYS);
    let inflow = json!({
        "title": "inflow",
        "description": meaning("strategies.<name>.inflow"),
        "default": [{}],
        "type": "array",
        "items": {
            "type": "object",
            "properties": definitions.members(WINDOW_KEYS),
            "additionalProperties": false,
        },
    });
    properties.insert("inflow".to_owned(), inflow);
    json!({
        "title": "strategies",
        "description": STUDY.meaning("strategies"),
        "type": "object",
        "patternProperties": {NAME: {
            "type": "object",
            "properties": properties,
            "additionalProperties": false,
        }},
        "additionalProperties": false,
    })
}

/// The meaning of a key of the grid.
fn meaning(path: &str) -> &'static str {
    GRID_MEANINGS.iter().find(|(known, _)| *known == path).map_or("", |(_, meaning)| meaning)
}

/// An axis: a list of values or, for numbers, a range.
fn axis(definitions: &mut Definitions, name: &str, key: &Key, kind: &Json) -> Json {
    definitions.refer(&format!("axis.{name}"), |definitions| {
        let mut list = definitions.refer("list", |_| json!({"type": "array", "minItems": 1}));
        list["items"] = kind.clone();
        match key.kind {
            KeyKind::Choice(_) | KeyKind::Text => list,
            _ => {
                let mut range = definitions.refer("range", |_| range());
                range["patternProperties"] = json!({"^(from|to)$": kind});
                let search = definitions.refer("search", |_| search());
                json!({"oneOf": [list, range, search]})
            }
        }
    })
}

/// A range of any key; each axis adds what its ends may be.
fn range() -> Json {
    json!({
        "type": "object",
        "properties": {
            "from": true,
            "to": true,
            "steps": {
                "description": "Number of values, both ends counted.",
                "type": "integer",
                "minimum": 2,
            },
            "step": {"oneOf": [
                {"type": "number", "exclusiveMinimum": 0},
                {"type": "string", "pattern": any_quantity_pattern()},
            ]},
            "spacing": {"enum": ["linear", "log"], "default": "linear"},
        },
        "required": ["from", "to"],
        "oneOf": [{"required": ["steps"]}, {"required": ["step"]}],
        "additionalProperties": false,
    })
}

/// A search along any key.
fn search() -> Json {
    json!({
        "description": meaning("grid.<key>.bisect"),
        "type": "object",
        "properties": {
            "bisect": {"type": "array", "minItems": 2, "maxItems": 2},
            "on": {
                "description": "What changes: verdict, safe, or a measure with a limit.",
                "type": "string",
            },
            "tolerance": {"oneOf": [
                {"type": "number", "exclusiveMinimum": 0},
                {"type": "string", "pattern": any_quantity_pattern()},
            ]},
            "spacing": {"enum": ["linear", "log"], "default": "linear"},
        },
        "required": ["bisect", "on"],
        "additionalProperties": false,
    })
}

fn replicates(definitions: &mut Definitions) -> Json {
    let axes = definitions.refer("axes", |definitions| {
        named(&mut |name, key| {
            let kind = json!({"$ref": format!("#/$defs/value.{name}")});
            axis(definitions, name, key, &kind)
        })
    });
    json!({
        "title": "replicates",
        "description": STUDY.meaning("replicates"),
        "type": "object",
        "anyOf": [axes, {"properties": {"seed": {"type": "integer", "minimum": 1}}}],
    })
}

/// The limits of results: a condition for each measure.
fn limits() -> Json {
    json!({
        "title": "limits",
        "description": STUDY.meaning("limits"),
        "type": "object",
        "additionalProperties": {"oneOf": [
            {"type": "boolean"},
            {"enum": ["deployed", "partial", "stalled"]},
            {"type": "string", "pattern": "^ *[<>]=? *[-+]?[0-9.]"},
        ]},
    })
}

/// The schema of every key a grid can name: by short name and path, and by pattern in strategies.
fn named(schema: &mut dyn FnMut(&str, &Key) -> Json) -> Json {
    let mut properties = Map::new();
    for (index, key) in KEYS.iter().enumerate().filter(|(_, key)| key.varies()) {
        let schema = schema(key.path, key);
        for name in [keys::short_name(index), key.path] {
            properties.insert(name.to_owned(), schema.clone());
        }
    }
    let strategy = STRATEGY_KEYS.iter().map(|key| (STRATEGY_PATH, "strategy", key));
    let window = WINDOW_KEYS.iter().map(|key| (WINDOW_PATH, "window", key));
    let mut patterns = Map::new();
    for (path, object, key) in strategy.chain(window) {
        let name = format!("{object}.{}", key.path);
        patterns.insert(format!("{path}{}$", key.path), schema(&name, key));
    }
    json!({"properties": properties, "patternProperties": patterns})
}

fn grid(definitions: &mut Definitions) -> Json {
    let values = definitions.refer("values", |definitions| {
        named(&mut |name, key| {
            definitions.refer(&format!("value.{name}"), |definitions| definitions.kind(key))
        })
    });
    let axes = definitions.refer("axes", |definitions| {
        named(&mut |name, key| {
            let kind = json!({"$ref": format!("#/$defs/value.{name}")});
            axis(definitions, name, key, &kind)
        })
    });
    let mut group = axes.clone();
    group["type"] = json!("object");
    group["minProperties"] = json!(1);
    group["unevaluatedProperties"] = json!(false);
    let mut point = values;
    point["type"] = json!("object");
    point["unevaluatedProperties"] = json!(false);
    let mut grid = axes;
    grid["title"] = json!("grid");
    grid["description"] = json!(STUDY.meaning("grid"));
    grid["type"] = json!("object");
    grid["properties"] = json!({
        "zip": {"description": meaning("grid.zip"), "type": "array", "items": group},
        "points": {"description": meaning("grid.points"), "type": "array", "items": point},
        "filter": {"description": meaning("grid.filter"), "type": "string"},
    });
    grid["unevaluatedProperties"] = json!(false);
    grid
}
