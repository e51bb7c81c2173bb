//! Supports of a study: where the capsule is held, in one order whatever the order of the file.

use billow_solver::scene::{Support, SupportLocation};

use crate::input::json::Json;
use crate::input::keys::{CAPSULE_SUPPORT_KEYS, Named, SUPPORT_PLACES};
use crate::input::object::{Object, list};
use crate::input::source::Source;
use crate::platform::error::InputError;

/// Supports in the order of [`SUPPORT_PLACES`], one for each place, components in the order x y z:
/// equal supports give equal jobs.
pub(crate) fn read(json: Option<&Json>, source: &Source) -> Result<Vec<Support>, InputError> {
    let Some(json) = json else {
        return Ok(vec![Support { on: SupportLocation::BottomRing, fix: "xyz".to_owned() }]);
    };
    let allowed = "a list of {\"on\": \"bottom_ring\", \"fix\": \"xyz\"}";
    let mut fixed = [[false; 3]; SUPPORT_PLACES.len()];
    for (index, item) in list(json, "supports", source, allowed)?.iter().enumerate() {
        let path = format!("supports[{index}]");
        let object = Object::new(item, &path, "a support", CAPSULE_SUPPORT_KEYS, &[], source)?;
        let on = object.needed_text("on")?;
        let held = object.displacements("fix")?;
        let place = SUPPORT_PLACES.iter().position(|place| place.name == on).unwrap_or_default();
        for (fixed, held) in fixed[place].iter_mut().zip(held) {
            *fixed |= held;
        }
    }
    let support = |(place, held): (&Named<SupportLocation>, [bool; 3])| {
        let fix: String =
            "xyz".chars().zip(held).filter(|(_, held)| *held).map(|(c, _)| c).collect();
        (!fix.is_empty()).then_some(Support { on: place.value, fix })
    };
    Ok(SUPPORT_PLACES.iter().zip(fixed).filter_map(support).collect())
}
