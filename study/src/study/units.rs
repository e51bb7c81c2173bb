//! The units in which a study's quantities are shown: those of the section `units`, and those that the
//! file writes for a key, first under `grid`, then in its section; for a measure those of its limit.

use super::column;
use super::{JOB_LIMITS, LIMITS, OPTIMISE, REPLICATES, SAMPLES, UNITS};
use crate::input::json::Json;
use crate::input::keys::{self, KEYS, KeyKind, STUDY};
use crate::input::object::object;
use crate::input::settings::Settings;
use crate::input::source::Source;
use crate::input::units::{DisplayUnit, DisplayUnits, written_unit};
use crate::job::row::COLUMNS;
use crate::platform::error::InputError;
use crate::platform::nearest::or_nearest;

/// Members of a range and of a search that hold values of the key.
const VALUE_MEMBERS: [&str; 4] = ["from", "to", "step", "bisect"];
/// Sections in which no key of the study has its value.
const WITHOUT_VALUES: [&str; 7] =
    ["grid", UNITS, JOB_LIMITS, LIMITS, OPTIMISE, REPLICATES, SAMPLES];
/// What the section `units` must look like, for errors.
const ALLOWED: &str =
    "a unit of this quantity, as in {\"mass_flow_rate\": \"g/s\", \"t_90_z_rim\": \"ms\"}";

/// Reads the units of a study whose keys and grid are valid.
pub(super) fn read(
    tree: &Json,
    settings: &Settings,
    source: &Source,
) -> Result<DisplayUnits, InputError> {
    let mut units = DisplayUnits::si();
    if let Some(section) = tree.get("units") {
        for (name, value) in object(section, &STUDY, "units", source)? {
            let path = format!("units.{name}");
            let Json::Text(symbol) = value else {
                let problem = format!("is {}, not a unit", value.kind());
                return Err(source.error(&path, value, problem, ALLOWED));
            };
            let (name, si) = quantity(name, &path, value, settings, source)?;
            DisplayUnit::new(symbol, si)
                .map_err(|problem| source.error(&path, value, problem, ALLOWED))?;
            units.set(&name, symbol);
        }
    }
    let axes = [tree.get("grid"), tree.get(REPLICATES)];
    let mut varied: Vec<(&str, &Json)> = axes.into_iter().flat_map(varied).collect();
    // A distribution is an object with a list of values.
    if let Some(Json::Object(samples)) = tree.get(SAMPLES).and_then(|samples| samples.get("of")) {
        for (name, distribution) in samples {
            if let Json::Object(parts) = distribution {
                varied.extend(parts.first().map(|(_, values)| (name.as_str(), values)));
            }
        }
    }
    varied.extend(self::varied(tree.get(OPTIMISE).and_then(|optimise| optimise.get("over"))));
    for (name, value) in varied {
        if let Some(index) = settings.find(name) {
            suggest(&mut units, &settings.name(index), value);
        }
    }
    if let Some(Json::Object(limits)) = tree.get(LIMITS) {
        for (name, value) in limits {
            if let Json::Text(text) = value {
                let bound = text.trim_start_matches(['<', '>', '=', ' ']);
                suggest(&mut units, name, &Json::Text(bound.to_owned()));
            }
        }
    }
    written_in_section("", tree, &mut units);
    Ok(units)
}

/// The name under which the unit of a key or column is kept, and its SI unit.
fn quantity(
    name: &str,
    path: &str,
    value: &Json,
    settings: &Settings,
    source: &Source,
) -> Result<(String, &'static str), InputError> {
    if let Ok(column) = column::find(name, path, value, settings, source) {
        return Ok((column.name, column.key.unit()));
    }
    if let Some(column) = COLUMNS.iter().find(|column| column.name == name) {
        return Ok((name.to_owned(), column.unit));
    }
    let known = KEYS.iter().enumerate().filter(|(_, key)| key.varies());
    let known = known.map(|(index, _)| keys::short_name(index));
    let near = or_nearest(name, known.chain(COLUMNS.iter().map(|column| column.name)));
    let problem = format!("is neither a key of the study nor a column of its table{near}");
    Err(source.error(path, value, problem, "keys, as mass_flow_rate; columns, as peak_vz"))
}

/// Every name that a grid varies, and what it gives: lists, ranges, values.
fn varied(grid: Option<&Json>) -> Vec<(&str, &Json)> {
    let Some(Json::Object(members)) = grid else { return Vec::new() };
    let mut found = Vec::new();
    for (name, value) in members {
        match (name.as_str(), value) {
            ("zip" | "points", Json::List(items)) => {
                found.extend(items.iter().flat_map(|item| varied(Some(item))));
            }
            (name, value) => found.push((name, value)),
        }
    }
    found
}

/// The units of the keys of an object and of the objects in it; `path` is its place in the file.
fn written_in_section(path: &str, json: &Json, units: &mut DisplayUnits) {
    match json {
        Json::Object(members) => {
            for (name, value) in members {
                if path.is_empty() && WITHOUT_VALUES.contains(&name.as_str()) {
                    continue;
                }
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                written_in_section(&path, value, units);
            }
        }
        Json::List(items) => {
            for (index, item) in items.iter().enumerate() {
                written_in_section(&format!("{path}[{index}]"), item, units);
            }
        }
        value => {
            let name = match keys::index(path) {
                Some(index) if !matches!(KEYS[index].kind, KeyKind::Quantity(_)) => return,
                Some(index) => keys::short_name(index),
                None => path,
            };
            suggest(units, name, value);
        }
    }
}

/// Shows a quantity in the first unit that a value, a list of values or a range is written in.
fn suggest(units: &mut DisplayUnits, name: &str, value: &Json) {
    match value {
        Json::Text(text) => {
            if let Some(unit) = written_unit(text) {
                units.suggest(name, unit);
            }
        }
        Json::List(items) => items.iter().for_each(|item| suggest(units, name, item)),
        Json::Object(members) => {
            // The tolerance of a search may be a percentage.
            let values = members.iter().filter(|(name, _)| VALUE_MEMBERS.contains(&name.as_str()));
            values.for_each(|(_, item)| suggest(units, name, item));
        }
        _ => {}
    }
}
