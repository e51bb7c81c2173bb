//! `contact`: film against film and against plates.

use billow_solver::geometry::field::Field;
use billow_solver::models::film::capsule;
use billow_solver::scene::error::SceneError;
use billow_solver::scene::film_scene::{FilmContact, FilmScene};
use billow_solver::scene::plate::Plate;

use super::object::Object;
use super::supports::motion;
use crate::input::keys::PLATE_KEYS;
use crate::input::settings::{Settings, list, number};
use crate::input::source::Source;
use crate::input::study_file::Json;
use crate::platform::error::InputError;

/// Reads `contact`; `None` where it is off.
pub(super) fn read(
    tree: &Json,
    settings: &Settings,
    source: &Source,
) -> Result<Option<FilmContact>, InputError> {
    let statics = settings.flag("solver.static");
    let given = tree.get("contact").filter(|json| **json != Json::Null);
    let plates = plates(given.and_then(|json| json.get("plates")), settings, source)?;
    let enabled = settings.maybe_flag("contact.enabled");
    if statics && (enabled == Some(true) || !plates.is_empty()) {
        let key = if plates.is_empty() { "contact.enabled" } else { "contact.plates" };
        let problem = "a state of rest is looked for without contact";
        let allowed = "neither where solver.static is true; what lies through film is counted then";
        return Err(source.error(key, "", problem, allowed));
    }
    if statics || enabled == Some(false) {
        return Ok(None);
    }
    Ok(Some(FilmContact {
        distance: settings.number("contact.distance"),
        friction: number(settings, "contact.friction", source)?,
        adhesion: number(settings, "contact.adhesion", source)?,
        adhesion_range: settings.number("contact.adhesion_range"),
        plates,
        ..FilmContact::default()
    }))
}

/// Least gap of film and a plate at the start, m.
const LEAST_GAP: f64 = 1e-9;

/// Refuses plates that film lies behind or on at the start.
pub(super) fn check_plates(film: &FilmScene, source: &Source) -> Result<(), InputError> {
    let plates = film.contact.iter().flat_map(|contact| &contact.plates);
    for (at, plate) in plates.enumerate() {
        let places = Field::of(&film.shell.positions);
        let gap = plate.smallest_gap(&places, 0.0);
        if gap < LEAST_GAP {
            let [x, y, z] = [plate.point.x, plate.point.y, plate.point.z];
            let mut error = source.error(
                &format!("contact.plates[{at}]"),
                &format!("\"{}\" through ({x}, {y}, {z})", plate.name),
                if gap > -LEAST_GAP {
                    "film lies on it at the start".to_owned()
                } else {
                    format!("film lies up to {:.6} m behind it", -gap)
                },
                "a plate all film lies in front of, where its normal points to, with a gap, however small",
            );
            "move its point back (a micrometre will do), or turn its normal round"
                .clone_into(&mut error.hint);
            return Err(error);
        }
    }
    Ok(())
}

/// Share of the mean edge length below which film lies on film, and has no side.
const TOUCHING: f64 = 1e-7;

/// Whether the film lies on itself at the start, so that contact could not tell its sides.
///
/// # Errors
/// What of the film is none.
pub(super) fn lies_on_itself(film: &FilmScene) -> Result<bool, SceneError> {
    let (_, setting, _) = capsule::constants(film)?;
    let Some(law) = &setting.contact else { return Ok(false) };
    let mut touches = false;
    let places = Field::of(&film.shell.positions);
    law.pairs_within(&places, TOUCHING * law.edge_length, |_, _| touches = true);
    Ok(touches)
}

fn plates(
    json: Option<&Json>,
    settings: &Settings,
    source: &Source,
) -> Result<Vec<Plate>, InputError> {
    let allowed = "a list of {\"point\": [0, 0, 0], \"normal\": [0, 0, 1]}";
    let Some(json) = json.filter(|json| **json != Json::Null) else { return Ok(Vec::new()) };
    let mut plates: Vec<Plate> = Vec::new();
    for (at, json) in list(json, "contact.plates", source, allowed)?.iter().enumerate() {
        let place = format!("contact.plates[{at}]");
        let object = Object::new(json, &place, "a plate", PLATE_KEYS, &["move"], source)?;
        let own = format!("{place}.move");
        let motion =
            object.given("move").map(|json| motion(json, &own, settings, source)).transpose()?;
        if motion.is_some_and(|motion| motion.rotation.is_some()) {
            return Err(object.error("move", "a plate does not turn", "a translation alone"));
        }
        let name = match object.text("name")? {
            Some(name) => name,
            None if at == 0 => "plate".to_owned(),
            None => format!("plate_{}", at + 1),
        };
        if ["lid", "base"].contains(&name.as_str()) || plates.iter().any(|p| p.name == name) {
            let problem = "is the name of another plate";
            return Err(object.error("name", problem, "a name of its own; not lid or base"));
        }
        plates.push(Plate {
            name,
            point: object.vector("point")?.ok_or_else(|| object.missing("point"))?,
            normal: object.direction("normal")?,
            motion,
            removal_time: object.number("until")?.unwrap_or(f64::INFINITY),
        });
    }
    Ok(plates)
}
