//! The schema of a scene file.

use serde_json::{Map, Value as Json, json};

use super::{forms, members, object, property};
use crate::input::keys::{
    BODY_KEYS, Default, FLAT, GRAVITY, Key, Kind, MESH_KEYS, MOVE_KEYS, NEAR, OUTPUT_KEYS,
    PLATE_KEYS, ROTATION_KEYS, SCENE, SCENE_WINDOW_KEYS, SPIN_KEYS, START_KEYS, SUPPORT_KEYS,
};

/// The schema of a scene file.
pub fn scene_schema() -> Json {
    let mut properties = Map::new();
    for key in SCENE.keys.iter().filter(|key| !key.path.contains('.')) {
        properties.insert(key.path.to_owned(), property(key));
    }
    for (section, _) in SCENE.sections.iter().filter(|(path, _)| !path.contains('.')) {
        properties.insert((*section).to_owned(), object(&SCENE, section));
    }
    let window = table("inflow window", "One inflow window.", SCENE_WINDOW_KEYS, []);
    properties["gas"]["properties"]["windows"] = json!({
        "title": "windows",
        "description": "Inflow windows; overlapping ones add up. Default: none.",
        "type": "array",
        "items": window,
    });
    properties["contact"]["properties"]["plates"] = plates();
    properties.insert("mesh".to_owned(), mesh());
    properties.insert("supports".to_owned(), supports());
    properties.insert("start".to_owned(), start());
    properties.insert("gravity".to_owned(), gravity());
    properties.insert("outputs".to_owned(), outputs());
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "billow scene",
        "description": "One capsule or any mesh for `billow solve`. A number is SI; a text carries its \
                        unit. Vertices and triangles are counted from 0 in file order.",
        "type": "object",
        "properties": properties,
        "oneOf": [{"required": ["design"]}, {"required": ["mesh"]}],
        "additionalProperties": false,
    })
}

/// An object of the keys of a table and others.
fn table<const N: usize>(
    title: &str,
    description: &str,
    keys: &'static [Key],
    more: [(&str, Json); N],
) -> Json {
    let mut properties = members(keys);
    properties.extend(more.map(|(name, schema)| (name.to_owned(), schema)));
    let required: Vec<&str> = keys
        .iter()
        .filter(|key| matches!(key.default, Default::Required))
        .map(|k| k.path)
        .collect();
    json!({
        "title": title,
        "description": description,
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

fn mesh() -> Json {
    let Kind::Quantity(length) = FLAT else { unreachable!("a length") };
    let corner = json!({
        "type": "array",
        "items": {"oneOf": forms(length)},
        "minItems": 2,
        "maxItems": 3,
    });
    let reference = json!({
        "title": "reference",
        "description": "Where the film is free of stress: an OBJ file with the faces of positions in the \
                        same order (of the film, or all; its vertices are its own, so pieces may be cut \
                        apart), or flat coordinates of the corners of each face, [[x, y], [x, y], [x, \
                        y]]. Default: where it starts.",
        "oneOf": [
            {"type": "string"},
            {"type": "array", "items": {"type": "array", "items": corner, "minItems": 3}},
        ],
    });
    let closure = json!({
        "title": "closure",
        "description": "Faces that close the volume without being film: names of groups or objects of \
                        positions, or an OBJ file of faces over its vertices. Default: none; with gas an \
                        open film is closed by a fan over each free edge loop.",
        "oneOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}],
    });
    let doc = "Film of any shape, from OBJ files: this, or design.";
    table("mesh", doc, MESH_KEYS, [("reference", reference), ("closure", closure)])
}

fn supports() -> Json {
    let doc = "A rigid plane of this mass that moves along its normal as a free body.";
    let body = table("body", doc, BODY_KEYS, []);
    let motion = motion();
    let nodes = json!({
        "title": "nodes",
        "description": "Vertices by number, 0 for the first of the file.",
        "type": "array",
        "items": {"type": "integer", "minimum": 0},
        "minItems": 1,
    });
    let more = [("nodes", nodes), ("body", body), ("move", motion)];
    let mut support = table("support", "One support.", SUPPORT_KEYS, more);
    support["properties"]["fix"]["pattern"] = json!("^(?!.*(.).*\\1)[xyz]{1,3}$");
    json!({
        "title": "supports",
        "description": "What holds the film, or moves it. Default: a design stands on its bottom ring, \
                        held in xyz; a mesh is free.",
        "type": "array",
        "items": support,
    })
}

fn motion() -> Json {
    let rotation = table("rotation", "A rotation about an axis.", ROTATION_KEYS, []);
    let doc = "A prescribed motion of what is held.";
    table("move", doc, MOVE_KEYS, [("rotation", rotation)])
}

fn plates() -> Json {
    let motion = table("move", "A prescribed motion of the plate.", MOVE_KEYS, []);
    json!({
        "title": "plates",
        "description": "Rigid plates the film lies against, on the side their normal points to. \
                        Default: none.",
        "type": "array",
        "items": table("plate", "A rigid plate.", PLATE_KEYS, [("move", motion)]),
    })
}

fn start() -> Json {
    let spin = table("spin", "A rigid rotation, added to the velocity.", SPIN_KEYS, []);
    table("start", "Velocities at the start; at rest without it.", START_KEYS, [("spin", spin)])
}

fn gravity() -> Json {
    let [along, vector] = GRAVITY.each_ref().map(property);
    json!({
        "title": "gravity",
        "description": along["description"],
        "default": 0.0,
        "examples": along["examples"],
        "oneOf": [
            {"type": vector["type"], "items": vector["items"], "minItems": 3, "maxItems": 3},
            {"oneOf": along["oneOf"]},
        ],
    })
}

fn outputs() -> Json {
    let followed = |title: &str, what: &str| {
        let number = json!({"type": "integer", "minimum": 0});
        let place = property(&NEAR);
        let place = json!({"type": "array", "items": place["items"], "minItems": 3, "maxItems": 3});
        let named = json!({
            "type": "object",
            "patternProperties": {"^[A-Za-z0-9_.-]{1,64}$": {"oneOf": [number, place]}},
            "additionalProperties": false,
        });
        json!({
            "title": title,
            "description": format!(
                "{what} followed in history and summary: by number, 0 for the first of the file, or \
                 the one nearest to a place; named by an object."
            ),
            "oneOf": [named, {"type": "array", "items": {"oneOf": [number, named]}}],
        })
    };
    let more = [
        ("nodes", followed("nodes", "Vertices")),
        ("elements", followed("elements", "Triangles (faces cut into fans)")),
    ];
    table("outputs", "What is followed.", OUTPUT_KEYS, more)
}
