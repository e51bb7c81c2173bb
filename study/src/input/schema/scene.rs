//! The schema of a scene file.

use serde_json::{Map, Value as Json, json};

use super::parts::{COMPONENTS, Definitions, title};
use crate::input::keys::{
    BODY_KEYS, Default, FLAT, GRAVITY, Key, KeyKind, MESH_KEYS, MOVE_KEYS, NEAR, OUTPUT_KEYS,
    PLATE_KEYS, ROTATION_KEYS, SCENE, SCENE_WINDOW_KEYS, SPIN_KEYS, START_KEYS, SUPPORT_KEYS,
    object_meaning,
};

/// The schema of a scene file.
pub fn scene_schema() -> Json {
    let mut definitions = Definitions::default();
    let property = |definitions: &mut Definitions, key: &Key| definitions.property(key);
    let mut properties = Map::new();
    for key in SCENE.keys.iter().filter(|key| !key.path.contains('.')) {
        properties.insert(key.path.to_owned(), definitions.property(key));
    }
    for (section, _) in SCENE.sections.iter().filter(|(path, _)| !path.contains('.')) {
        let schema = definitions.section(&SCENE, section, &property);
        properties.insert((*section).to_owned(), schema);
    }
    let window = definitions.table("inflow window", "One inflow window.", SCENE_WINDOW_KEYS, []);
    properties["gas"]["properties"]["windows"] = list("gas.windows", &window);
    let plate = plate(&mut definitions);
    properties["contact"]["properties"]["plates"] = list("contact.plates", &plate);
    properties.insert("mesh".to_owned(), mesh(&mut definitions));
    let support = support(&mut definitions);
    properties.insert("supports".to_owned(), list("supports", &support));
    properties.insert("start".to_owned(), start(&mut definitions));
    properties.insert("gravity".to_owned(), gravity(&mut definitions));
    properties.insert("outputs".to_owned(), outputs(&mut definitions));
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "billow scene",
        "description": "One capsule or any mesh for `billow solve`. A number is SI; a text carries its \
                        unit. Vertices and triangles are counted from 0 in file order.",
        "type": "object",
        "properties": properties,
        "oneOf": [{"required": ["design"]}, {"required": ["mesh"]}],
        "additionalProperties": false,
        "$defs": definitions.into_json(),
    })
}

impl Definitions {
    /// An object of the keys of a table, and of other keys.
    fn table<const N: usize>(
        &mut self,
        title: &str,
        description: &str,
        keys: &'static [Key],
        more: [(&str, Json); N],
    ) -> Json {
        let mut properties = self.members(keys);
        properties.extend(more.map(|(name, schema)| (name.to_owned(), schema)));
        let required = keys.iter().filter(|key| matches!(key.default, Default::Required));
        let required: Vec<&str> = required.map(|key| key.path).collect();
        json!({
            "title": title,
            "description": description,
            "type": "object",
            "properties": properties,
            "required": required,
            "additionalProperties": false,
        })
    }
}

/// A list of such items.
fn list(path: &str, items: &Json) -> Json {
    json!({
        "title": title(path),
        "description": SCENE.meaning(path),
        "type": "array",
        "items": items,
    })
}

fn mesh(definitions: &mut Definitions) -> Json {
    let KeyKind::Quantity(length) = FLAT else { unreachable!("a length") };
    let corner = json!({
        "type": "array",
        "items": {"oneOf": definitions.forms(length)},
        "minItems": 2,
        "maxItems": 3,
    });
    let reference = json!({
        "title": "reference",
        "description": object_meaning("mesh.reference"),
        "oneOf": [
            {"type": "string"},
            {"type": "array", "items": {"type": "array", "items": corner, "minItems": 3}},
        ],
    });
    let closure = json!({
        "title": "closure",
        "description": object_meaning("mesh.closure"),
        "oneOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}],
    });
    let more = [("reference", reference), ("closure", closure)];
    definitions.table("mesh", SCENE.meaning("mesh"), MESH_KEYS, more)
}

fn support(definitions: &mut Definitions) -> Json {
    let body = definitions.table("body", object_meaning("supports[].body"), BODY_KEYS, []);
    let rotation = object_meaning("supports[].move.rotation");
    let rotation = definitions.table("rotation", rotation, ROTATION_KEYS, []);
    let motion = object_meaning("supports[].move");
    let motion = definitions.table("move", motion, MOVE_KEYS, [("rotation", rotation)]);
    let nodes = json!({
        "title": "nodes",
        "description": object_meaning("supports[].nodes"),
        "type": "array",
        "items": {"type": "integer", "minimum": 0},
        "minItems": 1,
    });
    let more = [("nodes", nodes), ("body", body), ("move", motion)];
    let mut support = definitions.table("support", "One support.", SUPPORT_KEYS, more);
    support["properties"]["fix"]["pattern"] = json!(COMPONENTS);
    support
}

fn plate(definitions: &mut Definitions) -> Json {
    let motion = object_meaning("contact.plates[].move");
    let motion = definitions.table("move", motion, MOVE_KEYS, []);
    definitions.table("plate", "A rigid plate.", PLATE_KEYS, [("move", motion)])
}

fn start(definitions: &mut Definitions) -> Json {
    let spin = definitions.table("spin", object_meaning("start.spin"), SPIN_KEYS, []);
    definitions.table("start", SCENE.meaning("start"), START_KEYS, [("spin", spin)])
}

fn gravity(definitions: &mut Definitions) -> Json {
    let [along, vector] = GRAVITY.each_ref().map(|key| definitions.property(key));
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

fn outputs(definitions: &mut Definitions) -> Json {
    let position = definitions.kind(&NEAR);
    let number = json!({"type": "integer", "minimum": 0});
    let named = json!({
        "type": "object",
        "patternProperties": {"^[A-Za-z0-9_.-]{1,64}$": {"oneOf": [number, position]}},
        "additionalProperties": false,
    });
    let recorded = |title: &str, description: &str| {
        json!({
            "title": title,
            "description": description,
            "oneOf": [named, {"type": "array", "items": {"oneOf": [number, named]}}],
        })
    };
    let more = [
        ("nodes", recorded("nodes", object_meaning("outputs.nodes"))),
        ("elements", recorded("elements", object_meaning("outputs.elements"))),
    ];
    definitions.table("outputs", SCENE.meaning("outputs"), OUTPUT_KEYS, more)
}
