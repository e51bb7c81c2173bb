//! `--set key=value`: overrides, written into the tree of the file before it is read.
//!
//! - `film.thickness=…`, or a last part that only one key has, as `thickness=…`, sets that key. In a
//!   study that varies the key, in its grid, samples or search, it replaces that: the study then has this value alone.
//! - `grid.N=[5, 6]` sets the axis of a key; `grid.N=6` is an axis of one value.
//! - `grid.N.to=8` sets one member of an axis that is a range or a search.
//! - `replicates.seed=3` sets the replicates of a key, `samples.of.N=…` its distribution, `optimise.over.N=[5, 8]` its range
//!   in a search.
//! - A list for a key that takes one value is its range where a search varies it, and else an axis in a study: `N=[5, 6]` is
//!   `grid.N=[5, 6]`.

use crate::input::json::Json;
use crate::input::keys::{self, KeyKind, Table};
use crate::input::source::Source;
use crate::input::syntax;
use crate::platform::error::InputError;
use crate::platform::nearest::did_you_mean;
use crate::platform::quote;

/// The section of the axes.
const GRID: &str = "grid";
/// The other sections with a member for each key that they vary.
const REPLICATES: &str = "replicates";
const SAMPLES: &str = "samples.of";
const OPTIMISE: &str = "optimise.over";
/// Members of a grid that are not the axis of a key.
const GRID_WORDS: [&str; 3] = ["zip", "points", "filter"];

/// Applies the overrides in order, and records their flags in `source`. Returns what a reader of the plan
/// must know about them.
pub(crate) fn apply(
    tree: &mut Json,
    sets: &[String],
    table: &Table,
    source: &mut Source,
) -> Result<Vec<String>, InputError> {
    let mut notes = Vec::new();
    for set in sets {
        let path = apply_one(tree, set, table, &mut notes)?;
        source.sets.push((path, flag(set)));
    }
    Ok(notes)
}

/// Applies one override. Returns the path of its key.
fn apply_one(
    tree: &mut Json,
    set: &str,
    table: &Table,
    notes: &mut Vec<String>,
) -> Result<String, InputError> {
    let Some((name, value)) = set.split_once('=') else {
        return Err(refused(set, "has no `=`"));
    };
    let name = name.trim();
    if name.is_empty() {
        return Err(refused(set, "has no key before the `=`"));
    }
    let value = value_of(set, value)?;
    let has_grid = table.structured.iter().any(|(path, _)| *path == GRID);
    if !has_grid && (name == GRID || name.starts_with("grid.")) {
        return Err(refused(set, "a scene has no grid")
            .with_hint("set the key itself, or use a study file with billow plan"));
    }
    for section in [GRID, REPLICATES, SAMPLES, OPTIMISE].into_iter().filter(|_| has_grid) {
        if let Some(axis) = name.strip_prefix(section).and_then(|rest| rest.strip_prefix('.')) {
            return Ok(set_axis(tree, section, axis, value));
        }
    }
    set_key(tree, name, value, table, has_grid, set, notes)
}

fn flag(set: &str) -> String {
    format!("--set {set}")
}

fn refused(set: &str, problem: &str) -> InputError {
    InputError {
        file: flag(set),
        key: String::new(),
        value: String::new(),
        problem: problem.to_owned(),
        allowed: "--set key=value, as in --set film.thickness='30 um' or, in a study, --set \
                  'grid.N=[5, 6]'"
            .to_owned(),
        hint: String::new(),
    }
}

/// The value of an override: JSON; anything that is not JSON is a text, unless it begins as a list, an
/// object or a text in quotes does.
fn value_of(set: &str, value: &str) -> Result<Json, InputError> {
    let value = value.trim();
    match syntax::parse(value, "") {
        Ok(json) => Ok(json),
        Err(mut error) if value.starts_with(['[', '{', '"']) => {
            error.file = flag(set);
            "JSON, or a text without quotes".clone_into(&mut error.allowed);
            Err(error)
        }
        Err(_) => Ok(Json::Text(value.to_owned())),
    }
}

/// Sets a key, or its axis where the value is a list for a key that takes one value. Returns the path.
fn set_key(
    tree: &mut Json,
    name: &str,
    value: Json,
    table: &Table,
    has_grid: bool,
    set: &str,
    notes: &mut Vec<String>,
) -> Result<String, InputError> {
    let key = table.find(name).map(|index| table.keys[index]);
    let one_value = key.is_some_and(|key| key.varies() && !matches!(key.kind, KeyKind::Vector(_)))
        || is_of_strategy(name);
    if has_grid && matches!(value, Json::List(_)) {
        let mut is_in = |section| {
            let members = varied(tree, section);
            members.is_some_and(|all| all.iter().any(|(other, _)| same_key(name, other)))
        };
        if is_in(SAMPLES) {
            let mut error = refused(set, "is a list, and the key is sampled");
            error.hint =
                format!("--set '{SAMPLES}.{name}={{\"uniform\": [low, high]}}', or one value");
            return Err(error);
        }
        let section = if is_in(OPTIMISE) { OPTIMISE } else { GRID };
        if one_value || section == OPTIMISE {
            return Ok(set_axis(tree, section, name, value));
        }
    }
    let path = key.map_or(name, |key| key.path);
    let first = path.split(['.', '[']).next().unwrap_or_default();
    let known = table.children("");
    if !known.contains(&first) {
        let mut error =
            refused(set, &format!("{} is not a key of {}", quote::echo(first), table.what));
        let short = table.keys.iter().map(|key| key.leaf());
        error.hint = did_you_mean(name, short.chain(table.keys.iter().map(|key| key.path)))
            .or_else(|| did_you_mean(first, known.iter().copied()))
            .unwrap_or_else(|| "billow keys lists every key".to_owned());
        error.allowed = known.join(", ");
        return Err(error);
    }
    if has_grid {
        let sections = [GRID, SAMPLES, OPTIMISE].into_iter();
        let removed = sections.filter_map(|section| removed(tree, path, section));
        notes.extend(removed.map(|what| format!("{}: this value replaces {what}", flag(set))));
    }
    let mut target = &mut *tree;
    for part in path.split('.') {
        target = member(target, part).ok_or_else(|| {
            let mut error = refused(set, "names no place in the file");
            "an index counts from 0 and must exist, as in supports[0].fix"
                .clone_into(&mut error.hint);
            error
        })?;
    }
    *target = value;
    Ok(path.to_owned())
}

/// Whether a name is that of a key of a strategy, or of one of its inflow windows, that takes one value.
fn is_of_strategy(name: &str) -> bool {
    let leaf = name.strip_prefix("strategies.").and_then(|rest| rest.rsplit_once('.'));
    let keys = || keys::STRATEGY_KEYS.iter().chain(keys::WINDOW_KEYS);
    leaf.is_some_and(|(_, leaf)| keys().any(|key| key.path == leaf))
}

/// Whether two names stand for one key.
fn same_key(name: &str, other: &str) -> bool {
    name == other || keys::find(other).is_some_and(|index| keys::find(name) == Some(index))
}

/// The members of a section that varies keys, as `samples.of`.
fn varied<'a>(tree: &'a mut Json, section: &str) -> Option<&'a mut Vec<(String, Json)>> {
    let mut target = tree;
    for part in section.split('.') {
        target = target.get_mut(part)?;
    }
    match target {
        Json::Object(members) => Some(members),
        _ => None,
    }
}

/// Removes a key, which has one value now, from a section that varies it, with its correlations, and a section of samples or
/// a search that then varies nothing; returns what was removed. An axis that is zipped with others stays: they have a value
/// for each of its values.
fn removed(tree: &mut Json, path: &str, section: &str) -> Option<String> {
    let members = varied(tree, section)?;
    let before = members.len();
    let is_axis = |key: &str| section != GRID || !GRID_WORDS.contains(&key);
    members.retain(|(key, _)| !is_axis(key) || !same_key(key, path));
    let left = members.len();
    if left == before {
        return None;
    }
    let Some((name, _)) = section.split_once('.') else {
        return Some(format!("the axis of {path} in the grid"));
    };
    if let Some(Json::List(pairs)) = tree.get_mut(name)?.get_mut("correlations") {
        let of_key = |item: &Json| matches!(item, Json::Text(name) if same_key(name, path));
        pairs.retain(|pair| !matches!(pair, Json::List(items) if items.iter().any(of_key)));
    }
    if left == 0
        && let Json::Object(sections) = tree
    {
        sections.retain(|(known, _)| known != name);
    }
    // Inputs are numbered in their order.
    let has_others = section == SAMPLES && left > 0;
    let others = if has_others { "; other inputs may get other samples" } else { "" };
    Some(format!("{path} in {section}{others}"))
}

/// The value of a member of a section. One value of an axis is a list of one.
fn as_axis(section: &str, axis: &str, given: Json) -> Json {
    match given {
        one @ (Json::Integer(_) | Json::Number(_) | Json::Text(_) | Json::Bool(_))
            if section == GRID && !GRID_WORDS.contains(&axis) =>
        {
            Json::List(vec![one])
        }
        other => other,
    }
}

/// Sets an axis; it replaces an axis of the same key. `N.to` is one member of a range or a search.
fn set_axis(tree: &mut Json, section: &str, axis: &str, given: Json) -> String {
    let mut parts = section.split('.');
    let section_of = parts.try_fold(tree, |target, part| member(target, part));
    if let Some(Json::Object(members)) = section_of {
        if let Some((key, part)) = axis.rsplit_once('.')
            && let Some((name, parts @ Json::Object(_))) =
                members.iter_mut().find(|(name, _)| same_key(name, key))
        {
            let path = format!("{section}.{name}.{part}");
            parts.set(part, given);
            return path;
        }
        let value = as_axis(section, axis, given);
        match members.iter_mut().find(|(name, _)| same_key(name, axis)) {
            Some(member) => *member = (axis.to_owned(), value),
            None => members.push((axis.to_owned(), value)),
        }
    }
    format!("{section}.{axis}")
}

/// The member of an object that one part of a path names; a new empty object where there is none.
/// `None` beyond the end of a list, or for a part that names nothing.
pub(crate) fn member<'a>(object: &'a mut Json, part: &str) -> Option<&'a mut Json> {
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
    let value = object.entry(name)?;
    if *value == Json::Null {
        *value = Json::Object(Vec::new());
    }
    match (index, value) {
        (None, value) => Some(value),
        (Some(index), Json::List(items)) => items.get_mut(index),
        (Some(_), _) => None,
    }
}
