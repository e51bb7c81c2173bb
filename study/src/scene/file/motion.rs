//! `move`: a prescribed motion of a support or a plate.

use billow_solver::scene::motion::{Motion, Profile, Rotation};

use crate::input::json::Json;
use crate::input::keys::{MOVE_KEYS, PROFILES, ROTATION_KEYS};
use crate::input::object::Object;
use crate::input::settings::Settings;
use crate::input::source::{Source, shown};
use crate::platform::error::InputError;

/// Reads a prescribed motion; it ends with the run where it gives no end.
pub(super) fn read(
    json: &Json,
    path: &str,
    settings: &Settings,
    source: &Source,
) -> Result<Motion, InputError> {
    let object = Object::new(json, path, "a move", MOVE_KEYS, &["rotation"], source)?;
    let from = object.needed("from")?;
    let to = object.number("to")?.or(settings.number("solver.end_time"));
    let to = to.ok_or_else(|| object.missing("to"))?;
    if to <= from {
        let problem = "the move ends before it begins";
        return Err(object.error("to", problem, format!("above its `from`, {} s", shown(from))));
    }
    let rotation = object
        .given("rotation")
        .map(|json| read_rotation(json, &format!("{path}.rotation"), source))
        .transpose()?;
    let translation = object.vector("translation")?;
    if rotation.is_none() && translation.is_none() {
        let problem = "missing: a move needs a translation, a rotation or both";
        return Err(object.error("translation", problem, "[0, 0, \"10 mm\"]"));
    }
    let word = object.text("profile")?;
    let profile = PROFILES.iter().find(|profile| word.as_deref() == Some(profile.name));
    Ok(Motion {
        from,
        to,
        profile: profile.map_or(Profile::Smooth, |profile| profile.value),
        translation: translation.unwrap_or_default(),
        rotation,
    })
}

fn read_rotation(json: &Json, path: &str, source: &Source) -> Result<Rotation, InputError> {
    let object = Object::new(json, path, "a rotation", ROTATION_KEYS, &[], source)?;
    let centre = object.vector("centre")?.unwrap_or_default();
    Ok(Rotation { axis: object.direction("axis")?, centre, angle: object.needed("angle")? })
}
