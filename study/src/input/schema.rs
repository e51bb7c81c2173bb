//! The JSON Schemas (2020-12) of the study file and the scene file, built from the tables of keys.
//!
//! A schema says what each key may hold. The program itself checks which values are allowed together
//! (a fit and what it needs, a key given or varied), the unit of a quantity, and the values of an axis.

use std::fmt::Write as _;

use serde_json::{Map, Value as Json, json};

use crate::input::keys::listing::{FileKind, Parts};
use crate::input::keys::{
    self, Default, FORMULAS, GRAVITY, KEYS, Key, KeyKind, NEAR, OPTIMISE_KEYS, Quantity,
    RANGE_KEYS, SEARCH_KEYS,
};
use crate::input::units::Dimension;
use crate::input::value::{Value, json_value};

/// Names a strategy may have.
const NAME: &str = "^[A-Za-z_][A-Za-z0-9_]{0,63}$";
/// Names of what a scene records.
const RECORDED: &str = "^[A-Za-z0-9_.-]{1,64}$";
/// Displacement components: letters of xyz, each at most once.
const COMPONENTS: &str = "^(?!.*(.).*\\1)[xyz]{1,3}$";

/// The schema of a study file.
pub fn study_schema() -> Json {
    let mut schema = schema(
        FileKind::Study,
        "billow study",
        "A question about inflatable capsules: one design, film, gas and solver, and a grid of what varies. A number is SI; a text carries its unit.",
    );
    schema["properties"]["checksum"] = json!({
        "description": "That of study.json in a results folder; ignored in a study file.",
        "type": "string",
    });
    schema["$defs"] = json!({"axis": axis()});
    schema
}

/// The schema of a scene file.
pub fn scene_schema() -> Json {
    let mut schema = schema(
        FileKind::Scene,
        "billow scene",
        "One capsule or any mesh for `billow solve`. A number is SI; a text carries its unit. Vertices and triangles are counted from 0 in file order.",
    );
    schema["oneOf"] = json!([{"required": ["design"]}, {"required": ["mesh"]}]);
    schema
}

fn schema(file: FileKind, title: &str, description: &str) -> Json {
    let Parts { table, objects, meanings } = file.parts();
    let mut root = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
        "description": description,
        "type": "object",
        "additionalProperties": false,
    });
    for (path, _) in table.sections {
        extend(place(&mut root, path), json!({"type": "object", "additionalProperties": false}));
    }
    for key in &table.keys {
        extend(place(&mut root, key.path), property(key));
    }
    for (parent, keys) in objects {
        let object = if parent.is_empty() { &mut root } else { place(&mut root, parent) };
        for key in *keys {
            object["properties"][key.path] = property(key);
        }
        if parent.is_empty() {
            continue;
        }
        let required = keys.iter().filter(|key| matches!(key.default, Default::Required));
        let required: Vec<&str> = required.map(|key| key.path).collect();
        let object_schema = json!({
            "type": "object", "additionalProperties": false, "required": required,
        });
        extend(object, object_schema);
    }
    for (path, meaning) in table.sections.iter().chain(table.structured).chain(meanings) {
        if !path.starts_with("grid.") {
            let schema = place(&mut root, path);
            extend(schema, json!({"description": meaning}));
            extend(schema, form(path));
        }
    }
    // A gas is a name, or an object of its constants.
    let species = place(&mut root, "gas.species");
    let mut object = species.clone();
    object["required"] = json!(["gas_constant", "cp"]);
    let names = object.as_object_mut().and_then(|object| object.remove("enum"));
    *species = json!({
        "description": object["description"],
        "oneOf": [{"enum": names, "default": object["default"]}, object],
    });
    root
}

/// The schema at a path: `[]` stands for the items of a list, `<name>` for any name.
fn place<'a>(root: &'a mut Json, path: &str) -> &'a mut Json {
    path.split('.').fold(root, |schema, part| match part.strip_suffix("[]") {
        _ if part == "<name>" => &mut schema["patternProperties"][NAME],
        Some(list) => {
            let list = &mut schema["properties"][list];
            list["type"] = json!("array");
            &mut list["items"]
        }
        None => &mut schema["properties"][part],
    })
}

fn extend(schema: &mut Json, more: Json) {
    match (schema, more) {
        (Json::Object(schema), Json::Object(more)) => schema.extend(more),
        (schema @ Json::Null, more) => *schema = more,
        _ => {}
    }
}

/// What a key with more than one value may hold, beside the keys of its object. A keyword of one type, as
/// `minimum`, concerns no value of another type.
fn form(path: &str) -> Json {
    match path {
        "solver.meshes" => json!({
            "type": "array", "items": {"type": "integer", "minimum": 1}, "minItems": 1,
            "maxItems": 3, "uniqueItems": true,
        }),
        "solver.stepping" => json!({"maxProperties": 1}),
        "strategies" => json!({"type": "object", "additionalProperties": false}),
        "units" => json!({"type": "object", "additionalProperties": {"type": "string"}}),
        "assumed" => json!({
            "type": "object",
            "additionalProperties": {
                "type": "array", "items": {"type": ["number", "string"]}, "minItems": 2, "maxItems": 2,
            },
        }),
        "limits" => json!({
            "type": "object",
            "additionalProperties": {
                "type": ["boolean", "string"],
                "pattern": "^(deployed|partial|stalled| *[<>]=? *[-+]?[0-9.].*)$",
            },
        }),
        "grid" => {
            let mut grid = axes();
            let point = json!({"type": "object", "minProperties": 1});
            grid["properties"]["points"] = json!({"type": "array", "items": point});
            grid["properties"]["zip"] = json!({"type": "array", "items": axes()});
            grid["properties"]["filter"] = json!({"type": "string"});
            grid
        }
        "samples" => samples(),
        "optimise" => optimise(),
        "replicates" => {
            let mut replicates = axes();
            let count = json!({"type": "integer", "minimum": 1});
            replicates["properties"]["seed"] = json!({"oneOf": [count, {"$ref": "#/$defs/axis"}]});
            replicates
        }
        "gravity" => {
            let [mut along, vector] = GRAVITY.each_ref().map(property);
            extend(&mut along, vector);
            along["type"] = json!(["number", "string", "array"]);
            along
        }
        "mesh.reference" => json!({"type": "string"}),
        "mesh.closure" => json!({"type": ["string", "array"], "items": {"type": "string"}}),
        "supports[].nodes" => {
            json!({"type": "array", "items": {"type": "integer", "minimum": 0}, "minItems": 1})
        }
        "outputs.nodes" | "outputs.elements" => {
            let mut pick = property(&NEAR);
            pick["type"] = json!(["integer", "array"]);
            let mut named = json!({
                "type": ["object", "array"], "patternProperties": {RECORDED: pick},
                "additionalProperties": false,
            });
            named["items"] = named.clone();
            named["items"]["type"] = json!(["object", "integer"]);
            named
        }
        "outputs" | "mesh" | "start" | "supports[].move" => json!({"type": "object"}),
        _ => json!({}),
    }
}

/// Distributions of keys.
fn samples() -> Json {
    let number = json!({"type": ["number", "string"]});
    let numbers = json!({"type": "array", "items": number, "minItems": 2, "maxItems": 3});
    let kinds = ["uniform", "log_uniform", "normal", "log_normal", "triangular"];
    let mut distribution = json!({"type": "object", "properties": {
        "from": number, "to": number, "values": {"type": "array", "minItems": 2}, "assumed": {"const": true},
        "weights": {"type": "array", "items": {"type": "number", "exclusiveMinimum": 0}},
    }, "additionalProperties": false});
    for kind in kinds {
        distribution["properties"][kind] = numbers.clone();
    }
    json!({
        "type": "object", "required": ["number", "of"], "additionalProperties": false,
        "properties": {
            "number": {"type": "integer", "minimum": 2},
            "method": {"enum": ["sobol", "latin_hypercube"]},
            "seed": {"type": "integer", "minimum": 0},
            "of": {"type": "object", "minProperties": 1, "additionalProperties": distribution},
            "correlations": {"type": "array", "items": {"type": "array", "minItems": 3, "maxItems": 3}},
        },
    })
}

/// Measures, ranges of keys, a budget.
fn optimise() -> Json {
    let known = OPTIMISE_KEYS.iter().map(|key| (key.path.to_owned(), property(key)));
    let mut properties: Map<_, _> = known.collect();
    let measure = json!({"type": "string"});
    let two = json!({"type": "array", "items": measure, "minItems": 1, "maxItems": 2});
    properties.insert("minimise".to_owned(), json!({"oneOf": [measure, two]}));
    properties.insert("over".to_owned(), of_keys(&json!({"type": "array", "minItems": 2})));
    json!({
        "type": "object", "required": ["minimise", "over", "budget"], "additionalProperties": false,
        "properties": properties,
    })
}

/// Axes by the names of their keys.
fn axes() -> Json {
    of_keys(&json!({"$ref": "#/$defs/axis"}))
}

/// An object of the keys that a study can vary.
fn of_keys(axis: &Json) -> Json {
    let varied = KEYS.iter().enumerate().filter(|(_, key)| key.varies());
    let names = varied.flat_map(|(index, key)| [keys::short_name(index), key.path]);
    let properties: Map<_, _> = names.map(|name| (name.to_owned(), axis.clone())).collect();
    json!({
        "type": "object",
        "properties": properties,
        "patternProperties": {r"^strategies\.[A-Za-z_][A-Za-z0-9_]*\.": axis},
        "additionalProperties": false,
    })
}

/// A list of values, a range or a search.
fn axis() -> Json {
    let object = |keys: &[Key], more: &[&str], required: &[&str]| {
        let known = keys.iter().map(|key| (key.path.to_owned(), property(key)));
        let properties: Map<_, _> =
            more.iter().map(|name| ((*name).to_owned(), json!(true))).chain(known).collect();
        json!({
            "type": "object", "properties": properties, "required": required,
            "additionalProperties": false,
        })
    };
    let mut range = object(RANGE_KEYS, &["from", "to", "step"], &["from", "to"]);
    range["oneOf"] = json!([{"required": ["steps"]}, {"required": ["step"]}]);
    let search = object(SEARCH_KEYS, &["bisect"], &["bisect", "on"]);
    json!({"oneOf": [{"type": "array", "minItems": 1}, range, search]})
}

/// A key with its description, default and example.
fn property(key: &Key) -> Json {
    let mut description = key.meaning();
    match key.default {
        Default::Absent(meaning) => {
            let _ = write!(description, " Default: {meaning}.");
        }
        Default::Required => description.push_str(" Required; in a study, here or under grid."),
        _ => {}
    }
    if let KeyKind::Quantity(quantity) = key.kind
        && quantity.dimension != Dimension::Number
    {
        let units = quantity.dimension.units();
        let _ =
            write!(description, " A number in {}, or with a unit: {}.", units[0], units.join(", "));
    }
    let mut schema = json!({"description": description});
    let default = key.default_value();
    if default != Value::Null {
        schema["default"] = json_value(&default);
    }
    if let Ok(example) = serde_json::from_str::<Json>(key.example) {
        schema["examples"] = json!([example]);
    }
    extend(&mut schema, kind(key));
    schema
}

/// What a key may hold.
fn kind(key: &Key) -> Json {
    match key.kind {
        KeyKind::Quantity(quantity) => quantity_form(quantity),
        KeyKind::Integer(min, max) => json!({"type": "integer", "minimum": min, "maximum": max}),
        KeyKind::Choice(words) => {
            let names = || words.iter().map(|word| word.name);
            let formulas = FORMULAS.iter().filter(|(_, name)| names().any(|known| known == *name));
            json!({"enum": names().chain(formulas.map(|(formula, _)| *formula)).collect::<Vec<_>>()})
        }
        KeyKind::Text if key.path == "fix" => json!({"type": "string", "pattern": COMPONENTS}),
        KeyKind::Text => json!({"type": "string"}),
        KeyKind::Flag => json!({"type": "boolean"}),
        KeyKind::Vector(quantity) => {
            let mut component = quantity_form(quantity);
            if matches!(key.path, "min" | "max") {
                component["type"] = json!(["number", "string", "null"]);
            }
            json!({"type": "array", "items": component, "minItems": 3, "maxItems": 3})
        }
    }
}

/// A quantity as a number, or as a text: with a unit, or a word.
fn quantity_form(quantity: Quantity) -> Json {
    let min = if quantity.above { "exclusiveMinimum" } else { "minimum" };
    json!({"type": ["number", "string"], min: quantity.min, "maximum": quantity.max})
}
