//! `--set key=value`: overrides, written into the tree of the file before it is read.

use crate::input::keys::{self, Table};
use crate::input::renamed;
use crate::input::source::Source;
use crate::input::study_file::{self, Json};
use crate::platform::error::InputError;

/// Gives the keys of a file their new names, then applies the overrides in order, and records their
/// flags in `source`. Returns the notes about old names.
pub(crate) fn apply(
    tree: &mut Json,
    sets: &[String],
    table: &Table,
    source: &mut Source,
) -> Result<Vec<String>, InputError> {
    let mut notes = renamed::update(tree, source)?;
    for set in sets {
        notes.extend(apply_one(tree, set, table, source)?);
    }
    // An override may give a whole object, with old names in it.
    notes.extend(renamed::update(tree, source)?);
    Ok(notes)
}

/// Applies one override.
fn apply_one(
    tree: &mut Json,
    set: &str,
    table: &Table,
    source: &mut Source,
) -> Result<Option<String>, InputError> {
    let flag = format!("--set {set}");
    let refuse = |problem: &str| InputError {
        file: flag.clone(),
        key: String::new(),
        value: String::new(),
        problem: problem.to_owned(),
        allowed: "--set key=value, as in --set film.thickness='30 um' or, in a study, --set \
                  'grid.N=[5, 6]'"
            .to_owned(),
        hint: String::new(),
    };
    let Some((name, value)) = set.split_once('=') else {
        return Err(refuse("has no `=`"));
    };
    let value =
        study_file::parse(value, &flag).unwrap_or_else(|_| Json::Text(value.trim().to_owned()));
    let name = name.trim();
    let has_grid = table.structured.iter().any(|(path, _)| *path == "grid");
    let axis = name.strip_prefix("grid.").filter(|_| has_grid);
    let new = renamed::current(axis.unwrap_or(name));
    let note =
        new.as_ref().map(|new| format!("{flag}: {} is now called {new}", axis.unwrap_or(name)));
    let name = new.as_deref().unwrap_or(axis.unwrap_or(name));
    if axis.is_some() {
        set_axis(tree, name, value);
        source.sets.push((format!("grid.{name}"), flag));
        return Ok(note);
    }
    let path = table.find(name).map_or(name, |index| table.keys[index].path);
    let mut target = &mut *tree;
    for part in path.split('.') {
        target = member(target, part).ok_or_else(|| refuse("names no place in the file"))?;
    }
    *target = value;
    source.sets.push((path.to_owned(), flag));
    Ok(note)
}

/// Sets an axis; it replaces an axis of the same key.
fn set_axis(tree: &mut Json, axis: &str, value: Json) {
    let Some(Json::Object(members)) = member(tree, "grid") else { return };
    let same = |name: &str| {
        name == axis || keys::find(axis).is_some_and(|index| keys::find(name) == Some(index))
    };
    match members.iter_mut().find(|(name, _)| same(name)) {
        Some(member) => *member = (axis.to_owned(), value),
        None => members.push((axis.to_owned(), value)),
    }
}

/// The member of an object that one part of a path names; a new empty object where there is none.
/// `None` beyond the end of a list, or for a part that names nothing.
fn member<'a>(object: &'a mut Json, part: &str) -> Option<&'a mut Json> {
    let (name, index) = match part.split_once('[') {
        Some((name, index)) => (name, Some(index.strip_suffix(']')?.parse::<usize>().ok()?)),
        None => (part, None),
    };
    if name.is_empty() {
        return None;
    }
    if !matches!(object, Json::Object(_)) {
        *object = Json::Object(Vec::new());
    }
    let Json::Object(members) = object else { return None };
    let position = members.iter().position(|(key, _)| key == name).unwrap_or_else(|| {
        members.push((name.to_owned(), Json::Object(Vec::new())));
        members.len() - 1
    });
    match (index, &mut members[position].1) {
        (None, value) => Some(value),
        (Some(index), Json::List(items)) => items.get_mut(index),
        (Some(_), _) => None,
    }
}
