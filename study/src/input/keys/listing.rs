//! Every key of a file as a list for readers: `billow keys` and docs/reference/keys.md.

use std::fmt::Write as _;

use super::key::{Default, Key, KeyKind};
use super::objects::{
    BODY_KEYS, GRAVITY, MESH_KEYS, MOVE_KEYS, OBJECT_MEANINGS, OUTPUT_KEYS, PLATE_KEYS,
    ROTATION_KEYS, SCENE_WINDOW_KEYS, SPIN_KEYS, START_KEYS, SUPPORT_KEYS,
};
use super::study::GRID_MEANINGS;
use super::study_objects::{STRATEGY_KEYS, WINDOW_KEYS};
use super::table::{SCENE, STUDY, Table};
use crate::input::value::short_number;

/// The two kinds of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// The study file of `billow run`.
    Study,
    /// The scene file of `billow solve`.
    Scene,
}

impl FileKind {
    /// Name, as a listing has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Study => "study",
            Self::Scene => "scene",
        }
    }
}

/// Default of a key that the file must give.
pub const REQUIRED: &str = "required";

/// One key of a file, in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyDescription {
    /// Path: `<name>` stands for any name, `[]` for the items of a list.
    pub path: String,
    /// SI unit: "1" for a pure number, empty for what is not a number.
    pub unit: &'static str,
    /// Default; in brackets what happens without a value; [`REQUIRED`].
    pub default: String,
    /// Range, or allowed values.
    pub allowed: String,
    /// Meaning.
    pub meaning: String,
}

/// The parts of a kind of file.
pub(crate) struct Parts {
    /// The keys that hold one value.
    pub table: &'static Table,
    /// The keys of its objects, by path.
    pub objects: &'static [(&'static str, &'static [Key])],
    /// Paths within its objects that hold more than one value, and their meanings.
    pub meanings: &'static [(&'static str, &'static str)],
}

/// The objects of a study file.
static STUDY_OBJECTS: &[(&str, &[Key])] = &[
    ("supports[]", SUPPORT_KEYS),
    ("supports[].body", BODY_KEYS),
    ("supports[].move", MOVE_KEYS),
    ("supports[].move.rotation", ROTATION_KEYS),
    ("strategies.<name>", STRATEGY_KEYS),
    ("strategies.<name>.inflow[]", WINDOW_KEYS),
];

/// The objects of a scene file.
static SCENE_OBJECTS: &[(&str, &[Key])] = &[
    ("mesh", MESH_KEYS),
    ("gas.windows[]", SCENE_WINDOW_KEYS),
    ("supports[]", SUPPORT_KEYS),
    ("supports[].body", BODY_KEYS),
    ("supports[].move", MOVE_KEYS),
    ("supports[].move.rotation", ROTATION_KEYS),
    ("contact.plates[]", PLATE_KEYS),
    ("contact.plates[].move", MOVE_KEYS),
    ("start", START_KEYS),
    ("start.spin", SPIN_KEYS),
    ("", std::slice::from_ref(&GRAVITY[0])),
    ("outputs", OUTPUT_KEYS),
];

impl FileKind {
    /// Its tables of keys.
    pub(crate) fn parts(self) -> Parts {
        match self {
            Self::Study => Parts { table: &STUDY, objects: STUDY_OBJECTS, meanings: GRID_MEANINGS },
            Self::Scene => {
                Parts { table: &SCENE, objects: SCENE_OBJECTS, meanings: OBJECT_MEANINGS }
            }
        }
    }
}

/// Every key of a kind of file, in the order of the documentation.
pub fn entries(file: FileKind) -> Vec<KeyDescription> {
    let Parts { table, objects, meanings } = file.parts();
    let mut entries: Vec<KeyDescription> = table.keys.iter().map(|key| entry("", key)).collect();
    let structured = table.structured.iter().filter(|(path, _)| *path != "gravity");
    entries.extend(structured.chain(meanings).map(|(path, meaning)| KeyDescription {
        path: (*path).to_owned(),
        unit: "",
        default: String::new(),
        allowed: String::new(),
        meaning: (*meaning).to_owned(),
    }));
    for (parent, keys) in objects {
        entries.extend(keys.iter().map(|key| entry(parent, key)));
    }
    entries
}

fn entry(parent: &str, key: &Key) -> KeyDescription {
    let path =
        if parent.is_empty() { key.path.to_owned() } else { format!("{parent}.{}", key.path) };
    KeyDescription {
        path,
        unit: key.unit(),
        default: default_text(key),
        allowed: allowed_text(key),
        meaning: key.meaning(),
    }
}

fn default_text(key: &Key) -> String {
    match key.default {
        Default::Number(number) => short_number(number),
        Default::Integer(number) => number.to_string(),
        Default::Word(word) => word.to_owned(),
        Default::Absent(meaning) => format!("({meaning})"),
        Default::Required => REQUIRED.to_owned(),
    }
}

fn allowed_text(key: &Key) -> String {
    match key.kind {
        KeyKind::Quantity(quantity) => {
            let words = quantity.words.iter();
            let text = words.fold(quantity.range(), |text, (word, _)| format!("{text}, or {word}"));
            match quantity.plausible_range() {
                Some(plausible) => format!("{text}; plausible: {plausible}"),
                None => text,
            }
        }
        KeyKind::Integer(min, max) if min == max => min.to_string(),
        KeyKind::Integer(min, max) => format!("{min} to {max}"),
        KeyKind::Vector(quantity) => format!("list of three, each {}", quantity.range()),
        KeyKind::Choice(_) | KeyKind::Text | KeyKind::Flag => key.allowed(),
    }
}

/// The reference page of every key, in Markdown.
pub fn reference_page() -> String {
    let mut page = "# Keys\n\n\
        Every key of a study file and of a scene file. A number is SI; a text carries its unit, as \
        in \"40 mm\". A value outside the \
        plausible range is used, with a warning that a unit may be missing. A unit of 1 is a pure number; no unit is a word, a text or an object. A default \
        in brackets says what happens without a value. This page is generated from the tables in \
        `study/src/input/keys`.\n"
        .to_owned();
    for (file, title) in [(FileKind::Study, "Study file"), (FileKind::Scene, "Scene file")] {
        let _ = write!(
            page,
            "\n## {title}\n\n| key | unit | default | allowed | meaning |\n|---|---|---|---|---|\n"
        );
        for entry in entries(file) {
            let cells = [&entry.default, &entry.allowed, &entry.meaning];
            let [default, allowed, meaning] = cells.map(|text| escaped(text));
            let _ = writeln!(
                page,
                "| `{}` | {} | {default} | {allowed} | {meaning} |",
                entry.path, entry.unit
            );
        }
    }
    page
}

/// Text of a cell of a Markdown table.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|").replace('<', "\\<").replace('*', "\\*")
}
