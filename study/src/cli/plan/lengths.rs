//! Contact distance and amplitude of the imperfection of a plan's film jobs. They follow from the design
//! where the study does not give them.

use std::collections::BTreeMap;

use billow_solver::models::film::capsule::{contact_distance, imperfection_amplitude};
use billow_solver::scene::{Design, ModelKind, Scene};

use crate::input::value::{range_text, short_number};
use crate::job::canonical_json;
use crate::job::point::Point;

/// Most designs whose lengths are computed.
const MAX_DESIGNS: usize = 100;

/// The lengths in use, as text: one value each, or their range over the jobs; `None` without film jobs.
pub(super) fn in_use(points: &[&Point]) -> Option<String> {
    let film = |point: &&&Point| {
        point.infeasible.is_none() && point.job.scene.solver.model == ModelKind::Film
    };
    // The lengths depend on these parts of the scene only, and on the seed by whether it is 0.
    let mut known: BTreeMap<String, [Option<f64>; 2]> = BTreeMap::new();
    for scene in points.iter().filter(film).map(|point| &point.job.scene) {
        let mut design = scene.design.clone();
        if let Ok(design) = design.folded_mut() {
            design.subdivisions = 1;
        }
        let given = (scene.contact.distance, scene.imperfection_amplitude, scene.seed > 0);
        let key = canonical_json(&(&design, given));
        if known.contains_key(&key) {
            continue;
        }
        if known.len() == MAX_DESIGNS {
            return Some(format!(
                "contact distance: not listed for more than {MAX_DESIGNS} designs"
            ));
        }
        known.insert(key, lengths(scene)?);
    }
    let named = ["contact distance", "imperfection amplitude"].iter().enumerate();
    let texts: Vec<String> = named
        .filter_map(|(index, name)| {
            let values = known.values().filter_map(|lengths| Some(1e3 * lengths[index]?));
            range_text(values, short_number).map(|range| format!("{name} {range} mm"))
        })
        .collect();
    (!texts.is_empty()).then(|| texts.join(", "))
}

/// Contact distance and amplitude of the imperfection of a scene, m.
fn lengths(scene: &Scene) -> Option<[Option<f64>; 2]> {
    let (seed, given) = (scene.seed, scene.imperfection_amplitude);
    Some(match &scene.design {
        Design::Capsule(design) => [
            Some(contact_distance(scene.contact.distance, design).ok()?),
            imperfection_amplitude(design, seed, given).ok()?,
        ],
        Design::Mesh(design) => {
            let film = &design.film;
            let distance = scene.contact.distance.unwrap_or(film.contact_distance);
            [Some(distance), (seed > 0).then(|| given.unwrap_or(film.imperfection_amplitude))]
        }
    })
}
