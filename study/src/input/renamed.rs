//! Keys that have a new name. The old name is read for one version, with a note.

use crate::input::expression;
use crate::input::source::Source;
use crate::input::study_file::Json;
use crate::platform::error::InputError;

/// Old path and new path of every renamed key: `*` stands for any name, `[]` for any item. Only the
/// last part differs.
pub const RENAMED_KEYS: &[(&str, &str)] = &[
    ("film.viscosity", "film.numerical_damping"),
    ("outputs.thresholds.close_margin", "outputs.thresholds.near_threshold_margin"),
    ("strategies.*.inflow[].rate", "strategies.*.inflow[].mass_flow_rate"),
    ("gas.windows[].rate", "gas.windows[].mass_flow_rate"),
];

/// Gives the keys of a file their new names. Returns one note for each key of the table that the file
/// gives by its old name.
///
/// # Errors
/// When an object gives a key by both names.
pub(crate) fn update(tree: &mut Json, source: &Source) -> Result<Vec<String>, InputError> {
    let mut notes = Vec::new();
    for (old, new) in RENAMED_KEYS {
        let mut found = Vec::new();
        rename(tree, old, leaf(new), &mut found).map_err(|path| {
            source.error(
                &format!("{path}{}", leaf(old)),
                "",
                format!("is the old name of {}, which is given as well", leaf(new)),
                format!("{} alone", leaf(new)),
            )
        })?;
        if let Some(grid) = tree.get_mut("grid") {
            rename_axes(grid, &mut found);
        }
        if let Some(first) = found.first() {
            let others = match found.len() {
                1 => String::new(),
                number => format!(" (and {} more)", number - 1),
            };
            notes.push(format!(
                "{first}{others} is now called {}; the next version refuses the old name",
                leaf(new)
            ));
        }
    }
    notes.dedup();
    Ok(notes)
}

/// A copy of a file's tree with the old name of every key: the identity of a scene does not depend on
/// which name it uses.
pub(crate) fn with_old_names(tree: &Json) -> Json {
    let mut tree = tree.clone();
    for (old, new) in RENAMED_KEYS {
        // Both names at once are refused before.
        let _ = rename(&mut tree, new, leaf(old), &mut Vec::new());
    }
    tree
}

/// The new name of a key, given as a path or by its last part; `None` where the name is not old.
pub(crate) fn current(name: &str) -> Option<String> {
    RENAMED_KEYS.iter().find_map(|(old, new)| {
        let fixed = !old.contains(['*', '[']);
        if fixed && name == leaf(old) {
            return Some(leaf(new).to_owned());
        }
        let (parent, last) = name.rsplit_once('.')?;
        (last == leaf(old) && matches_pattern(old, name)).then(|| format!("{parent}.{}", leaf(new)))
    })
}

/// The last part of a path.
fn leaf(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

/// Whether a path, as in `strategies.late.inflow[0].rate`, fits a pattern of the table.
fn matches_pattern(pattern: &str, path: &str) -> bool {
    let (patterns, parts) = (pattern.split('.'), path.split('.'));
    patterns.clone().count() == parts.clone().count()
        && patterns.zip(parts).all(|(pattern, part)| match pattern.strip_suffix("[]") {
            Some(name) => part.strip_prefix(name).is_some_and(|rest| rest.starts_with('[')),
            None => pattern == "*" || pattern == part,
        })
}

/// Renames the last part of every path of the tree that fits the pattern, and lists those paths.
///
/// # Errors
/// The path, with a dot after it, of an object that has both names.
fn rename(
    tree: &mut Json,
    pattern: &str,
    new: &str,
    found: &mut Vec<String>,
) -> Result<(), String> {
    let parts: Vec<&str> = pattern.split('.').collect();
    descend(tree, &parts, "", new, found)
}

fn descend(
    json: &mut Json,
    parts: &[&str],
    path: &str,
    new: &str,
    found: &mut Vec<String>,
) -> Result<(), String> {
    let (Json::Object(members), [part, rest @ ..]) = (json, parts) else { return Ok(()) };
    if rest.is_empty() {
        let has_new = members.iter().any(|(name, _)| name == new);
        if let Some((name, _)) = members.iter_mut().find(|(name, _)| name == part) {
            if has_new {
                return Err(path.to_owned());
            }
            found.push(format!("{path}{name}"));
            new.clone_into(name);
        }
        return Ok(());
    }
    let (name, is_list) = match part.strip_suffix("[]") {
        Some(name) => (name, true),
        None => (*part, false),
    };
    for (member, value) in members.iter_mut().filter(|(member, _)| name == "*" || member == name) {
        match (value, is_list) {
            (Json::List(items), true) => {
                for (index, item) in items.iter_mut().enumerate() {
                    descend(item, rest, &format!("{path}{member}[{index}]."), new, found)?;
                }
            }
            (value, _) => descend(value, rest, &format!("{path}{member}."), new, found)?,
        }
    }
    Ok(())
}

/// Renames the axes of a grid, of its groups and of its points, and the names in its filter.
fn rename_axes(grid: &mut Json, found: &mut Vec<String>) {
    let Json::Object(members) = grid else { return };
    for (name, value) in members {
        match (name.as_str(), value) {
            ("zip" | "points", Json::List(items)) => {
                for (index, item) in items.iter_mut().enumerate() {
                    let Json::Object(members) = item else { continue };
                    for (axis, _) in members {
                        rename_axis(axis, &format!("grid.{name}[{index}]."), found);
                    }
                }
            }
            ("filter", Json::Text(text)) => rename_in_filter(text, found),
            _ => rename_axis(name, "grid.", found),
        }
    }
}

fn rename_axis(name: &mut String, path: &str, found: &mut Vec<String>) {
    if let Some(new) = current(name) {
        found.push(format!("{path}{name}"));
        *name = new;
    }
}

fn rename_in_filter(text: &mut String, found: &mut Vec<String>) {
    // From the end, so that the ranges before stay valid.
    for (name, (start, end)) in expression::names(text).into_iter().rev() {
        if let Some(new) = current(&name) {
            found.push(format!("grid.filter: {name}"));
            text.replace_range(start..end, &new);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_part_of_a_path_is_renamed() {
        for (old, new) in RENAMED_KEYS {
            assert_eq!(old.rsplit_once('.').unwrap().0, new.rsplit_once('.').unwrap().0);
        }
    }

    #[test]
    fn old_names_are_found_by_path_and_by_last_part() {
        for (old, new) in [
            ("close_margin", Some("near_threshold_margin")),
            ("outputs.thresholds.close_margin", Some("outputs.thresholds.near_threshold_margin")),
            ("strategies.late.inflow[0].rate", Some("strategies.late.inflow[0].mass_flow_rate")),
            ("strategies.late.rate", None),
            ("rate", None),
            ("near_threshold_margin", None),
        ] {
            assert_eq!(current(old).as_deref(), new, "{old}");
        }
    }
}
