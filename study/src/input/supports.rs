//! Supports: where the capsule is held, in one order whatever the file's.

use billow_solver::scene::{Support, SupportLocation};

use crate::input::settings::list;
use crate::input::source::Source;
use crate::input::study_file::Json;
use crate::platform::error::InputError;

/// Names of the places a support acts on.
pub(crate) const PLACES: [(&str, SupportLocation); 4] = [
    ("bottom_ring", SupportLocation::BottomRing),
    ("top_ring", SupportLocation::TopRing),
    ("bottom_cap", SupportLocation::BottomCap),
    ("top_cap", SupportLocation::TopCap),
];

pub(crate) fn place_name(place: SupportLocation) -> &'static str {
    PLACES.iter().find(|(_, known)| *known == place).map_or("", |(name, _)| name)
}

/// Supports in the order of [`PLACES`], one a place, components in the order x y z: the same
/// supports are the same job.
pub(crate) fn read(json: Option<&Json>, source: &Source) -> Result<Vec<Support>, InputError> {
    let Some(json) = json else {
        return Ok(vec![Support { on: SupportLocation::BottomRing, fix: "xyz".to_owned() }]);
    };
    let allowed = "a list of {\"on\": \"bottom_ring\", \"fix\": \"xyz\"}";
    let mut fixed = [""; 4].map(str::to_owned);
    for (at, item) in list(json, "supports", source, allowed)?.iter().enumerate() {
        let key = format!("supports[{at}]");
        let (mut on, mut fix) = (None, None);
        let Json::Object(members) = item else {
            let problem = format!("is {}, not an object", item.kind());
            return Err(source.error(&key, &item.brief(), problem, allowed));
        };
        for (name, value) in members {
            let key = format!("{key}.{name}");
            match (name.as_str(), value) {
                ("on", Json::Text(word)) => {
                    on = PLACES.iter().position(|(known, _)| known == word);
                    if on.is_none() {
                        let known = PLACES.map(|(known, _)| known).join(", ");
                        let problem = "is no place of a capsule";
                        return Err(source.error(&key, &value.brief(), problem, known));
                    }
                }
                ("fix", Json::Text(axes)) => {
                    let sound = !axes.is_empty()
                        && axes.chars().all(|c| matches!(c, 'x' | 'y' | 'z'))
                        && "xyz".chars().all(|c| axes.matches(c).count() <= 1);
                    if !sound {
                        let problem = "names no displacement components";
                        let allowed = "letters of \"xyz\", each once";
                        return Err(source.error(&key, &value.brief(), problem, allowed));
                    }
                    fix = Some(axes);
                }
                ("on" | "fix", other) => {
                    let problem = format!("is {}, not a text", other.kind());
                    return Err(source.error(&key, &other.brief(), problem, allowed));
                }
                _ => {
                    let problem = "is no key of a support";
                    return Err(source.error(&key, &value.brief(), problem, "on, fix"));
                }
            }
        }
        match (on, fix) {
            (Some(on), Some(fix)) => fixed[on].push_str(fix),
            (None, _) => return Err(source.error(&key, &item.brief(), "has no `on`", allowed)),
            (_, None) => return Err(source.error(&key, &item.brief(), "has no `fix`", allowed)),
        }
    }
    let support = |(&(_, on), axes): (&(&str, SupportLocation), String)| {
        let fix: String = "xyz".chars().filter(|c| axes.contains(*c)).collect();
        (!fix.is_empty()).then_some(Support { on, fix })
    };
    Ok(PLACES.iter().zip(fixed).filter_map(support).collect())
}
