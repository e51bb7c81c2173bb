//! The keys of one kind of file, found by path or by short name.

use std::collections::HashMap;
use std::sync::LazyLock;

use super::key::Key;
use super::scene::{SCENE_KEYS, SCENE_SECTIONS, SCENE_STRUCTURED};
use super::study::{KEYS, SECTIONS, STRUCTURED};

/// The keys of one kind of file that hold one value.
#[derive(Debug)]
pub struct Table {
    /// Name of the kind of file, with its article.
    pub what: &'static str,
    /// The keys, in the order of the documentation.
    pub keys: Vec<&'static Key>,
    /// Its objects and their meanings.
    pub sections: &'static [(&'static str, &'static str)],
    /// Paths of the keys that hold more than one value, beside the sections, and their meanings.
    pub structured: &'static [(&'static str, &'static str)],
    index: HashMap<&'static str, usize>,
    /// Last parts of a path that only one key has.
    leaves: HashMap<&'static str, usize>,
}

impl Table {
    fn new(
        what: &'static str,
        keys: Vec<&'static Key>,
        sections: &'static [(&'static str, &'static str)],
        structured: &'static [(&'static str, &'static str)],
    ) -> Self {
        let index = keys.iter().enumerate().map(|(index, key)| (key.path, index)).collect();
        let mut leaves: HashMap<&'static str, Vec<usize>> = HashMap::new();
        for (index, key) in keys.iter().enumerate() {
            leaves.entry(key.leaf()).or_default().push(index);
        }
        let unique = leaves.into_iter().filter(|(_, indices)| indices.len() == 1);
        let leaves = unique.map(|(leaf, indices)| (leaf, indices[0])).collect();
        Self { what, keys, sections, structured, index, leaves }
    }

    /// Position of a dotted path.
    pub fn index(&self, path: &str) -> Option<usize> {
        self.index.get(path).copied()
    }

    /// Position of a dotted path, or of a last part that only one key has.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.index(name).or_else(|| self.leaves.get(name).copied())
    }

    /// The shortest name by which [`Self::find`] finds the key.
    pub fn short_name(&self, index: usize) -> &'static str {
        let key = self.keys[index];
        if self.leaves.get(key.leaf()) == Some(&index) { key.leaf() } else { key.path }
    }

    /// Whether a path is that of an object.
    pub fn is_section(&self, path: &str) -> bool {
        self.sections.iter().any(|(section, _)| *section == path)
    }

    /// Meaning of a section or of a key that holds more than one value; empty for any other path.
    pub fn meaning(&self, path: &str) -> &'static str {
        let known = self.sections.iter().chain(self.structured);
        known.filter(|(name, _)| *name == path).map(|(_, meaning)| *meaning).next().unwrap_or("")
    }

    /// Names of the keys and sections directly below a path.
    pub fn children(&self, prefix: &str) -> Vec<&'static str> {
        let mut names: Vec<&'static str> = Vec::new();
        let sections = self.sections.iter().map(|(path, _)| *path);
        let keys = self.keys.iter().map(|key| key.path);
        let structured = self.structured.iter().map(|(path, _)| *path);
        for path in sections.chain(keys).chain(structured) {
            let rest = match prefix {
                "" => Some(path),
                _ => path.strip_prefix(prefix).and_then(|rest| rest.strip_prefix('.')),
            };
            let Some(name) = rest.and_then(|rest| rest.split('.').next()) else { continue };
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }
}

/// The keys of a study file, those of [`KEYS`] in their order.
pub static STUDY: LazyLock<Table> =
    LazyLock::new(|| Table::new("a study", KEYS.iter().collect(), SECTIONS, STRUCTURED));

/// The keys of a scene file: those it shares with a study and its own, section by section.
pub static SCENE: LazyLock<Table> = LazyLock::new(|| {
    let all = || KEYS.iter().filter(|key| !key.study_only).chain(SCENE_KEYS);
    let below = |section: &'static str| {
        all().filter(move |key| {
            key.path.rsplit_once('.').map_or("", |(parent, _)| parent) == section
        })
    };
    let sections = std::iter::once("").chain(SCENE_SECTIONS.iter().map(|(path, _)| *path));
    let keys = sections.flat_map(below).collect();
    Table::new("a scene", keys, SCENE_SECTIONS, SCENE_STRUCTURED)
});

/// Position in [`KEYS`] of a dotted path.
pub fn index(path: &str) -> Option<usize> {
    STUDY.index(path)
}

/// Position in [`KEYS`] of a dotted path, or of a last part that only one key has.
pub fn find(name: &str) -> Option<usize> {
    STUDY.find(name)
}

/// The short name of a key that is named by its dotted path or its last part; another name as it is.
pub fn shortened(name: &str) -> &str {
    find(name).map_or(name, |index| short_name(index))
}

/// The shortest name by which [`find`] finds the key.
pub fn short_name(index: usize) -> &'static str {
    STUDY.short_name(index)
}
