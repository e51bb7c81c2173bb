//! The parts of both schemas: keys, sections, and the definitions they share.

use std::fmt::Write as _;

use serde_json::{Map, Value as Json, json};

use crate::input::keys::{Default, Key, KeyKind, Quantity, Table};
use crate::input::units::{self, Dimension};
use crate::input::value::{Value, json_value};

/// A number at the start of a text.
const NUMBER: &str = r"^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?\s*";

/// A unit of several symbols or powers; the program checks which ones it reads.
const COMPOUND: &str = r"[^\s0-9][^\s]*[/^*·0-9 ].*";

/// Displacement components: letters of xyz, each at most once.
pub(super) const COMPONENTS: &str = "^(?!.*(.).*\\1)[xyz]{1,3}$";

/// The definitions of a schema, by name: each part that several keys use, once.
#[derive(Default)]
pub(super) struct Definitions(Map<String, Json>);

impl Definitions {
    /// A reference to a definition, which is added where it is not there yet.
    pub fn refer(&mut self, name: &str, schema: impl FnOnce(&mut Self) -> Json) -> Json {
        if !self.0.contains_key(name) {
            let schema = schema(self);
            self.0.insert(name.to_owned(), schema);
        }
        json!({"$ref": format!("#/$defs/{name}")})
    }

    /// All of them, for `$defs`.
    pub fn into_json(self) -> Json {
        self.0.into()
    }

    /// What a key may hold.
    pub fn kind(&mut self, key: &Key) -> Json {
        match key.kind {
            KeyKind::Quantity(quantity) => json!({"oneOf": self.forms(quantity)}),
            KeyKind::Integer(min, max) => {
                json!({"type": "integer", "minimum": min, "maximum": max})
            }
            KeyKind::Choice(words) => {
                json!({"enum": words.iter().map(|word| word.name).collect::<Vec<_>>()})
            }
            KeyKind::Text => json!({"type": "string"}),
            KeyKind::Flag => json!({"type": "boolean"}),
            KeyKind::Vector(quantity) => {
                let mut component = self.forms(quantity);
                if matches!(key.path, "min" | "max") {
                    component.push(json!({"type": "null"}));
                }
                let items = json!({"oneOf": component});
                json!({"type": "array", "items": items, "minItems": 3, "maxItems": 3})
            }
        }
    }

    /// A quantity as a number, as a text with a unit, as a word.
    pub fn forms(&mut self, quantity: Quantity) -> Vec<Json> {
        let min = if quantity.above { "exclusiveMinimum" } else { "minimum" };
        let mut number = json!({"type": "number", "maximum": quantity.max});
        number[min] = json!(quantity.min);
        let name = quantity.dimension.name();
        let name = name.split_once(' ').map_or(name, |(_, name)| name).replace(' ', "_");
        let text = self.refer(
            &name,
            |_| json!({"type": "string", "pattern": quantity_pattern(quantity.dimension)}),
        );
        let mut forms = vec![number, text];
        let words: Vec<&str> = quantity.words.iter().map(|(word, _)| *word).collect();
        if !words.is_empty() {
            forms.push(json!({"enum": words}));
        }
        forms
    }

    /// A key with its title, description, default and example.
    pub fn property(&mut self, key: &Key) -> Json {
        let kind = self.kind(key);
        annotated(key, kind)
    }

    /// The keys of an object.
    pub fn members(&mut self, keys: &[Key]) -> Map<String, Json> {
        keys.iter().map(|key| (key.path.to_owned(), self.property(key))).collect()
    }

    /// One section of a table, with the sections within it. `property` is the schema of a key.
    pub fn section(
        &mut self,
        table: &Table,
        section: &str,
        property: &dyn Fn(&mut Self, &Key) -> Json,
    ) -> Json {
        let mut properties = Map::new();
        let below = |path: &'static str| {
            path.strip_prefix(section)
                .and_then(|rest| rest.strip_prefix('.'))
                .filter(|rest| !rest.contains('.'))
        };
        for key in &table.keys {
            if let Some(name) = below(key.path) {
                properties.insert(name.to_owned(), property(self, key));
            }
        }
        for (path, _) in table.sections {
            if let Some(name) = below(path) {
                let inner = self.section(table, path, property);
                // A section that is a key as well (gas.species) is a word or an object.
                let schema = match properties.remove(name) {
                    Some(word) => word_or_object(path, word, inner),
                    None => inner,
                };
                properties.insert(name.to_owned(), schema);
            }
        }
        let mut schema = json!({
            "title": title(section),
            "description": table.meaning(section),
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
}

/// A key that is a word or an object, with the annotations of the word.
fn word_or_object(path: &str, word: Json, object: Json) -> Json {
    let Json::Object(mut word) = word else { return object };
    let mut choice = Map::new();
    word.remove("title");
    choice.insert("title".to_owned(), json!(title(path)));
    for annotation in ["description", "default", "examples"] {
        if let Some(value) = word.remove(annotation) {
            choice.insert(annotation.to_owned(), value);
        }
    }
    choice.insert("oneOf".to_owned(), json!([word, object]));
    choice.into()
}

/// A value with the title, description, default and example of its key.
pub(super) fn annotated(key: &Key, kind: Json) -> Json {
    let mut schema = Map::new();
    schema.insert("title".to_owned(), json!(title(key.path)));
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
        if let Some(plausible) = quantity.plausible_range() {
            let _ = write!(description, " Plausible: {plausible}.");
        }
    }
    schema.insert("description".to_owned(), json!(description));
    let default = key.default_value();
    if default != Value::Null {
        schema.insert("default".to_owned(), json_value(&default));
    }
    if let Ok(example) = serde_json::from_str::<Json>(key.example) {
        schema.insert("examples".to_owned(), json!([example]));
    }
    if let Json::Object(kind) = kind {
        schema.extend(kind);
    }
    schema.into()
}

/// The last part of a path, in words.
pub(super) fn title(path: &str) -> String {
    path.rsplit('.').next().unwrap_or(path).replace('_', " ")
}

/// A number with a unit of the dimension, as far as a pattern can say it.
fn quantity_pattern(dimension: Dimension) -> String {
    let symbols = units::symbols(dimension).join("|");
    let mut alone = if symbols.is_empty() { String::new() } else { format!("{symbols}|") };
    if dimension.units().iter().any(|unit| unit.starts_with("1/")) {
        alone.push_str(r"1\s*/.+|");
    }
    format!(r"{NUMBER}({alone}{COMPOUND})\s*$")
}

/// A number with any unit.
pub(super) fn any_quantity_pattern() -> String {
    format!(r"{NUMBER}[^\s0-9].*$")
}
