//! `--set key=value`: overrides written into the tree of the file before it is read.

use super::grid::{Grid, Target};
use crate::input::keys::{self, KEYS, Table};
use crate::input::source::Source;
use crate::input::study_file::{self, Json};
use crate::platform::error::InputError;

/// Applies the overrides, in order, and notes their flags in `source`.
pub(crate) fn apply(
    tree: &mut Json,
    sets: &[String],
    table: &Table,
    source: &mut Source,
) -> Result<(), InputError> {
    for set in sets {
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
        let name = name.trim();
        let value =
            study_file::parse(value, &flag).unwrap_or_else(|_| Json::Text(value.trim().to_owned()));
        if let Some(axis) =
            name.strip_prefix("grid.").filter(|_| table.structured.contains(&"grid"))
        {
            set_axis(tree, axis, value);
            source.sets.push((name.to_owned(), flag));
            continue;
        }
        let path = table.find(name).map_or(name, |at| table.keys[at].path);
        let mut place = &mut *tree;
        for part in path.split('.') {
            place = step(place, part).ok_or_else(|| refuse("names no place in the file"))?;
        }
        *place = value;
        source.sets.push((path.to_owned(), flag));
    }
    Ok(())
}

/// Sets an axis, in place of one on the same key.
fn set_axis(tree: &mut Json, axis: &str, value: Json) {
    let Some(Json::Object(members)) = step(tree, "grid") else { return };
    let same = |name: &str| {
        name == axis || keys::find(axis).is_some_and(|at| keys::find(name) == Some(at))
    };
    match members.iter_mut().find(|(name, _)| same(name)) {
        Some(member) => *member = (axis.to_owned(), value),
        None => members.push((axis.to_owned(), value)),
    }
}

/// The place of one part of a path, made where it is not there yet; `None` beyond a list's end or
/// for a part that names nothing.
fn step<'a>(place: &'a mut Json, part: &str) -> Option<&'a mut Json> {
    let (name, index) = match part.split_once('[') {
        Some((name, index)) => (name, Some(index.strip_suffix(']')?.parse::<usize>().ok()?)),
        None => (part, None),
    };
    if name.is_empty() {
        return None;
    }
    if !matches!(place, Json::Object(_)) {
        *place = Json::Object(Vec::new());
    }
    let Json::Object(members) = place else { return None };
    let at = members.iter().position(|(key, _)| key == name).unwrap_or_else(|| {
        members.push((name.to_owned(), Json::Object(Vec::new())));
        members.len() - 1
    });
    let place = &mut members[at].1;
    match (index, place) {
        (None, place) => Some(place),
        (Some(index), Json::List(items)) => items.get_mut(index),
        (Some(_), _) => None,
    }
}

/// Refuses an override of a key that the grid varies: it would change nothing.
pub(super) fn refuse_varied(grid: &Grid, source: &Source) -> Result<(), InputError> {
    for (path, _) in &source.sets {
        let varied = grid.columns.iter().enumerate().find(|(at, column)| {
            let on_axis = grid.axes.iter().any(|axis| axis.columns.contains(at));
            on_axis && matches!(column.target, Target::Key(key) if KEYS[key].path == path)
        });
        if let Some((_, column)) = varied {
            let name = &column.name;
            return Err(source.error(
                path,
                "",
                "the grid varies this key, so the override would change nothing",
                format!("--set 'grid.{name}=[…]'"),
            ));
        }
    }
    Ok(())
}
