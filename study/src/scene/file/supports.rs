//! `supports`: what holds the film, or moves it.

use billow_solver::mechanics::supports::PrescribedNodes;
use billow_solver::scene::film_support::{FilmSupport, Hold, PlaneBody};
use billow_solver::scene::motion::{Motion, Profile};
use nalgebra::Vector3;

use super::motion;
use super::selection::{self, Plane};
use super::shape::Shape;
use crate::input::json::Json;
use crate::input::keys::{BODY_KEYS, SUPPORT_KEYS};
use crate::input::object::{Object, list};
use crate::input::settings::Settings;
use crate::input::source::Source;
use crate::platform::error::InputError;

/// Time in which the bottom ring of an erected capsule moves to its stowed position, s (chosen: short
/// against a deployment, long against the stable step).
const SEATING_TIME: f64 = 0.01;

/// The motion of an erected capsule's bottom ring to its stowed N-gon, where the ring is held: a
/// design's bottom ring is held there whatever its shape at the start. Empty where a support moves it.
pub(super) fn seating(supports: &[FilmSupport], shape: &Shape) -> Vec<PrescribedNodes> {
    let Some(stowed) = &shape.stowed else { return Vec::new() };
    let bottom = |support: &&FilmSupport| {
        let mut regions = shape.regions.iter().filter(|(name, _)| name.starts_with("bottom_"));
        support.motion.is_none() && regions.any(|(_, nodes)| *nodes == support.nodes)
    };
    let position = |node: &u32| shape.shell.positions[*node as usize];
    let mover = |support: &FilmSupport| PrescribedNodes {
        nodes: support.nodes.clone(),
        start: support.nodes.iter().map(position).collect(),
        held: support.hold.projector(),
        motion: Motion {
            from: 0.0,
            to: SEATING_TIME,
            profile: Profile::Smooth,
            translation: Vector3::zeros(),
            rotation: None,
        },
        displacements: support
            .nodes
            .iter()
            .map(|node| stowed[*node as usize] - position(node))
            .collect(),
    };
    supports.iter().filter(bottom).map(mover).collect()
}

/// Reads `supports`; without it, a capsule stands on its bottom ring.
pub(super) fn read(
    tree: &Json,
    settings: &Settings,
    shape: &Shape,
    source: &Source,
) -> Result<Vec<FilmSupport>, InputError> {
    let Some(json) = tree.get("supports") else {
        let ring = shape.regions.iter().find(|(name, _)| *name == "bottom_ring");
        let held = |(name, nodes): &(&str, Vec<u32>)| FilmSupport {
            name: (*name).to_owned(),
            nodes: nodes.clone(),
            hold: Hold::Components([true; 3]),
            motion: None,
        };
        return Ok(ring.map(held).into_iter().collect());
    };
    let allowed = "a list of {\"on\": \"box\", \"max\": [null, null, 0], \"fix\": \"xyz\"}";
    let mut supports: Vec<FilmSupport> = Vec::new();
    for (index, json) in list(json, "supports", source, allowed)?.iter().enumerate() {
        let path = format!("supports[{index}]");
        let more = ["nodes", "body", "move"];
        let object = Object::new(json, &path, "a support", SUPPORT_KEYS, &more, source)?;
        let mut support = support(&object, settings, shape, source)?;
        let exists = |name: &str| supports.iter().any(|known| known.name == name);
        if exists(&support.name) {
            if object.given("name").is_some() {
                let problem = "is the name of another support";
                return Err(object.error("name", problem, "a name that no other support has"));
            }
            let numbered = (2..).map(|n| format!("{}_{n}", support.name));
            support.name = numbered.into_iter().find(|name| !exists(name)).unwrap_or_default();
        }
        supports.push(support);
    }
    Ok(supports)
}

fn support(
    object: &Object<'_>,
    settings: &Settings,
    shape: &Shape,
    source: &Source,
) -> Result<FilmSupport, InputError> {
    let on = object.needed_text("on")?;
    refuse_keys_of_others(object, &on)?;
    let plane = if on == "plane" { Some(Plane::read(object, shape)?) } else { None };
    let nodes = selection::nodes(object, &on, plane, shape)?;
    let mut motion = object
        .given("move")
        .map(|json| motion::read(json, &format!("{}.move", object.path), settings, source))
        .transpose()?;
    if let Some(rotation) = motion.as_mut().and_then(|motion| motion.rotation.as_mut()) {
        rotation.centre -= shape.numbering.origin;
    }
    let hold = hold(object, plane, motion.is_some(), source)?;
    let name = object.text("name")?.unwrap_or(on);
    Ok(FilmSupport { name, nodes, hold, motion })
}

/// What a support holds: components, the normal of a plane, or a plane that moves as a free body.
fn hold(
    object: &Object<'_>,
    plane: Option<Plane>,
    moves: bool,
    source: &Source,
) -> Result<Hold, InputError> {
    let fix = object.given("fix").is_some();
    match (plane, object.given("body")) {
        (Some(Plane { normal, .. }), Some(json)) => {
            if fix || moves {
                let problem = "a plane that moves as a free body holds its normal component alone";
                return Err(object.error("body", problem, "body without fix and without move"));
            }
            let path = format!("{}.body", object.path);
            let body = Object::new(json, &path, "a body", BODY_KEYS, &[], source)?;
            Ok(Hold::Body(PlaneBody {
                normal,
                mass: body.needed("mass")?,
                velocity: body.needed("velocity")?,
                force: body.needed("force")?,
            }))
        }
        (Some(Plane { normal, .. }), None) if !fix => Ok(Hold::Plane(normal)),
        _ => object.displacements("fix").map(Hold::Components),
    }
}

/// Refuses keys that have no meaning for what the support is on.
fn refuse_keys_of_others(object: &Object<'_>, on: &str) -> Result<(), InputError> {
    let keys_of = [
        ("box", &["min", "max"][..]),
        ("nodes", &["nodes"]),
        ("loop", &["loop"]),
        ("plane", &["point", "normal", "tolerance", "body"]),
    ];
    for (other, keys) in keys_of.iter().filter(|(other, _)| *other != on) {
        if let Some(key) = keys.iter().find(|key| object.given(key).is_some()) {
            let problem = format!("belongs to a support on {other}, this one is on {on}");
            return Err(object.error(key, problem, format!("\"on\": \"{other}\"")));
        }
    }
    Ok(())
}
