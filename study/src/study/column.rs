//! What a grid varies: a key of the study, of a strategy or of an inflow window.

use crate::input::json::Json;
use crate::input::keys::{self, KEYS, Key};
use crate::input::settings::Settings;
use crate::input::source::Source;
use crate::platform::error::InputError;
use crate::platform::nearest::or_nearest;

/// A varied key.
#[derive(Debug, Clone)]
pub(super) struct Column {
    /// The shortest name of the key.
    pub name: String,
    pub key: &'static Key,
    /// Position of its value in the settings.
    pub index: usize,
}

impl PartialEq for Column {
    fn eq(&self, other: &Self) -> bool {
        self.index == other.index
    }
}

/// Finds what the name of an axis stands for. `path` is the place of the axis in the file.
pub(super) fn find(
    name: &str,
    path: &str,
    value: &Json,
    settings: &Settings,
    source: &Source,
) -> Result<Column, InputError> {
    let index = settings.find(name).filter(|index| settings.key(*index).varies());
    if let Some(index) = index {
        return Ok(Column { name: settings.name(index), key: settings.key(index), index });
    }
    if let Some(rest) = name.strip_prefix("strategies.") {
        settings.check_strategy(rest.split('.').next().unwrap_or(""), path, source)?;
        let allowed =
            "strategies.<name>.release_time, .preinflation_mass, .inflow[0].mass_flow_rate, …";
        let problem = "is not a key of that strategy";
        return Err(source.error(path, value, problem, allowed));
    }
    if ["mesh", "design.mesh", "unit", "design.unit"].contains(&name) {
        let problem = "is read once for all points";
        return Err(source.error(
            path,
            value,
            problem,
            "a study for each mesh; subdivisions can vary",
        ));
    }
    let same_leaf: Vec<&str> =
        KEYS.iter().filter(|key| key.leaf() == name).map(|key| key.path).collect();
    if same_leaf.len() > 1 {
        let problem = "is the name of several keys";
        return Err(source.error(path, value, problem, same_leaf.join(", ")));
    }
    let varied = KEYS.iter().enumerate().filter(|(_, key)| key.varies());
    let known = varied.flat_map(|(index, key)| [keys::short_name(index), key.path]);
    let near = or_nearest(name, known.chain(["zip", "points", "filter"]));
    let problem = format!("is not a key that a study can vary{near}");
    Err(source.error(path, value, problem, "keys of the study, as N or film.thickness"))
}
