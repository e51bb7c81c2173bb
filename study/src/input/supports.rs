//! Supports of a study: where the capsule is held, in one order whatever the order of the file.

use billow_solver::scene::{Support, SupportLocation};

use crate::input::json::Json;
use crate::input::keys::{CAPSULE_SUPPORT_KEYS, SUPPORT_PLACES, named};
use crate::input::settings::{list, read as read_key};
use crate::input::source::Source;
use crate::input::value::Value;
use crate::platform::error::InputError;

/// Name of a place that a support acts on.
pub(crate) fn place_name(place: SupportLocation) -> &'static str {
    SUPPORT_PLACES.iter().find(|known| known.value == place).map_or("", |known| known.name)
}

/// Whether a text names displacement components: letters of xyz, each path most once.
pub(crate) fn are_components(text: &str) -> bool {
    !text.is_empty()
        && text.chars().all(|c| matches!(c, 'x' | 'y' | 'z'))
        && "xyz".chars().all(|c| text.matches(c).count() <= 1)
}

/// What a support must look like, for errors.
const ALLOWED: &str = "a list of {\"on\": \"bottom_ring\", \"fix\": \"xyz\"}";

/// Supports in the order of [`SUPPORT_PLACES`], one for each place, components in the order x y z:
/// equal supports give equal jobs.
pub(crate) fn read(json: Option<&Json>, source: &Source) -> Result<Vec<Support>, InputError> {
    let Some(json) = json else {
        return Ok(vec![Support { on: SupportLocation::BottomRing, fix: "xyz".to_owned() }]);
    };
    let mut fixed = [""; 4].map(str::to_owned);
    for (index, item) in list(json, "supports", source, ALLOWED)?.iter().enumerate() {
        let (place, components) = support(item, &format!("supports[{index}]"), source)?;
        fixed[place].push_str(&components);
    }
    let support = |(place, axes): (SupportLocation, String)| {
        let fix: String = "xyz".chars().filter(|c| axes.contains(*c)).collect();
        (!fix.is_empty()).then_some(Support { on: place, fix })
    };
    let places = SUPPORT_PLACES.iter().map(|place| place.value);
    Ok(places.zip(fixed).filter_map(support).collect())
}

/// Position in [`SUPPORT_PLACES`] of a support's place, and its components.
fn support(item: &Json, path: &str, source: &Source) -> Result<(usize, String), InputError> {
    let (mut on, mut fix) = (None, None);
    let Json::Object(members) = item else {
        let problem = format!("is {}, not an object", item.kind());
        return Err(source.error(path, &item.brief(), problem, ALLOWED));
    };
    for (name, value) in members {
        let key = format!("{path}.{name}");
        match name.as_str() {
            "on" => {
                let place = named_place(value, &key, source)?;
                on = SUPPORT_PLACES.iter().position(|known| known.name == place);
            }
            "fix" => {
                let text = text(read_key(
                    const { named(CAPSULE_SUPPORT_KEYS, "fix") },
                    value,
                    &key,
                    source,
                )?);
                if !are_components(&text) {
                    let problem = "does not name displacement components";
                    let allowed = "letters of \"xyz\", each once";
                    return Err(source.error(&key, &value.brief(), problem, allowed));
                }
                fix = Some(text);
            }
            _ => {
                let problem = "is not a key of a support";
                return Err(source.error(&key, &value.brief(), problem, "on, fix"));
            }
        }
    }
    match (on, fix) {
        (Some(on), Some(fix)) => Ok((on, fix)),
        (None, _) => Err(source.error(path, &item.brief(), "has no `on`", ALLOWED)),
        (_, None) => Err(source.error(path, &item.brief(), "has no `fix`", ALLOWED)),
    }
}

fn named_place(value: &Json, path: &str, source: &Source) -> Result<String, InputError> {
    read_key(const { named(CAPSULE_SUPPORT_KEYS, "on") }, value, path, source).map(text)
}

fn text(value: Value) -> String {
    match value {
        Value::Text(text) => text,
        _ => String::new(),
    }
}
