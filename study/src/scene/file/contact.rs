//! `contact`: contact of film with film and with plates.

use billow_solver::geometry::field::Field;
use billow_solver::models::film::capsule;
use billow_solver::scene::error::SceneError;
use billow_solver::scene::film_scene::{FilmContact, FilmScene};
use billow_solver::scene::plate::Plate;

use super::{is_static, motion};
use crate::input::json::Json;
use crate::input::keys::PLATE_KEYS;
use crate::input::object::{Object, list};
use crate::input::settings::Settings;
use crate::input::source::Source;
use crate::platform::error::InputError;

/// Reads `contact`; `None` where contact is off.
pub(super) fn read(
    tree: &Json,
    settings: &Settings,
    source: &Source,
) -> Result<Option<FilmContact>, InputError> {
    let statics = is_static(settings);
    let given = tree.get("contact").filter(|json| **json != Json::Null);
    let plates = plates(given.and_then(|json| json.get("plates")), settings, source)?;
    let enabled = settings.flag("contact.enabled");
    if statics && (enabled == Some(true) || !plates.is_empty()) {
        let key = if plates.is_empty() { "contact.enabled" } else { "contact.plates" };
        let problem = "static equilibrium is solved without contact";
        let allowed =
            "neither where solver.static is true; intersections of film are counted there";
        return Err(source.error(key, "", problem, allowed));
    }
    if statics || enabled == Some(false) {
        return Ok(None);
    }
    let contact = FilmContact {
        adhesion_range: settings.number("contact.adhesion_range"),
        plates,
        ..FilmContact::of(&settings.contact(source)?)
    };
    if tree.get("design").is_none() {
        return Ok(Some(contact));
    }
    let resolved = capsule::resolved_contact(contact, &settings.design(source)?)
        .map_err(|error| source.error("design", "", error.to_string(), ""))?;
    Ok(Some(resolved))
}

/// Smallest gap between film and a plate at the start, m (chosen: far above rounding).
const MIN_PLATE_GAP: f64 = 1e-9;

/// Refuses plates that touch film, or have film behind them, at the start.
pub(super) fn check_plates(film: &FilmScene, source: &Source) -> Result<(), InputError> {
    let plates = film.contact.iter().flat_map(|contact| &contact.plates);
    for (index, plate) in plates.enumerate() {
        let positions = Field::of(&film.shell.positions);
        let gap = plate.smallest_gap(&positions, 0.0);
        if gap < MIN_PLATE_GAP {
            let [x, y, z] = [plate.point.x, plate.point.y, plate.point.z];
            return Err(source.error(
                &format!("contact.plates[{index}]"),
                format!("\"{}\" through ({x}, {y}, {z})", plate.name),
                if gap > -MIN_PLATE_GAP {
                    "touches film at the start".to_owned()
                } else {
                    format!("has film up to {:.6} m behind it", -gap)
                },
                "a plate with all film on the side its normal points to, with a gap, however small",
            ).with_hint("move its point back (by a micrometre), or reverse its normal"));
        }
    }
    Ok(())
}

/// Largest distance of film that touches film, as a fraction of the mean edge length (chosen: far above
/// rounding). Such film has no side, and contact cannot push it apart.
const TOUCHING_DISTANCE: f64 = 1e-7;

/// Whether the film touches itself at the start: contact cannot distinguish its sides then.
pub(super) fn touches_itself(film: &FilmScene) -> Result<bool, SceneError> {
    let (system, ..) = capsule::constants(film)?;
    let Some(model) = &system.contact else { return Ok(false) };
    let mut touches = false;
    let positions = Field::of(&film.shell.positions);
    model.pairs_within(&positions, TOUCHING_DISTANCE * model.edge_length, |_, _| touches = true);
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
    for (index, json) in list(json, "contact.plates", source, allowed)?.iter().enumerate() {
        let path = format!("contact.plates[{index}]");
        let object = Object::new(json, &path, "a plate", PLATE_KEYS, &["move"], source)?;
        let motion = object
            .given("move")
            .map(|json| motion::read(json, &format!("{path}.move"), settings, source))
            .transpose()?;
        if motion.is_some_and(|motion| motion.rotation.is_some()) {
            return Err(object.error("move", "a plate cannot rotate", "a translation alone"));
        }
        let name = match object.text("name")? {
            Some(name) => name,
            None if index == 0 => "plate".to_owned(),
            None => format!("plate_{}", index + 1),
        };
        if ["lid", "base"].contains(&name.as_str()) || plates.iter().any(|p| p.name == name) {
            let problem = "is the name of another plate";
            return Err(object.error(
                "name",
                problem,
                "a name that no other plate has; not lid or base",
            ));
        }
        plates.push(Plate {
            name,
            point: object.needed_vector("point")?,
            normal: object.direction("normal")?,
            motion,
            removal_time: object.number("until")?.unwrap_or(f64::INFINITY),
        });
    }
    Ok(plates)
}
