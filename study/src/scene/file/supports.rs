//! `supports`: what holds the film, or moves it.

use std::collections::BTreeSet;

use billow_solver::mechanics::supports::PrescribedNodes;
use billow_solver::scene::film_support::{FilmSupport, Hold, PlaneBody};
use billow_solver::scene::motion::{Motion, Profile, Rotation};
use nalgebra::Vector3;

use super::object::Object;
use super::shape::Shape;
use crate::input::keys::{BODY_KEYS, MOVE_KEYS, ROTATION_KEYS, SUPPORT_KEYS};
use crate::input::settings::{Settings, list};
use crate::input::source::Source;
use crate::input::study_file::Json;
use crate::platform::error::InputError;

/// How long an erected capsule's bottom ring takes to where it is held, s.
const SEATING_TIME: f64 = 0.01;

/// The way of an erected capsule's bottom ring, where it is held, to the stowed N-gon: a design's
/// bottom ring is held there whatever its shape. None where it moves otherwise.
pub(super) fn seating(supports: &[FilmSupport], shape: &Shape) -> Vec<PrescribedNodes> {
    let Some(seats) = &shape.seats else { return Vec::new() };
    let bottom = |support: &&FilmSupport| {
        let mut places = shape.places.iter().filter(|(name, _)| name.starts_with("bottom_"));
        support.motion.is_none() && places.any(|(_, nodes)| *nodes == support.nodes)
    };
    let place = |node: &u32| shape.shell.positions[*node as usize];
    let mover = |support: &FilmSupport| PrescribedNodes {
        nodes: support.nodes.clone(),
        start: support.nodes.iter().map(place).collect(),
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
            .map(|node| seats[*node as usize] - place(node))
            .collect(),
    };
    supports.iter().filter(bottom).map(mover).collect()
}

/// Reads `supports`; a capsule stands on its bottom ring where none are given.
pub(super) fn read(
    tree: &Json,
    settings: &Settings,
    shape: &Shape,
    source: &Source,
) -> Result<Vec<FilmSupport>, InputError> {
    let Some(json) = tree.get("supports") else {
        let ring = shape.places.iter().find(|(name, _)| *name == "bottom_ring");
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
    for (at, json) in list(json, "supports", source, allowed)?.iter().enumerate() {
        let place = format!("supports[{at}]");
        let more = ["nodes", "body", "move"];
        let object = Object::new(json, &place, "a support", SUPPORT_KEYS, &more, source)?;
        let mut support = support(&object, settings, shape, source)?;
        let taken = |name: &str| supports.iter().any(|other| other.name == name);
        if taken(&support.name) {
            if object.given("name").is_some() {
                let problem = "is the name of another support";
                return Err(object.error("name", problem, "a name of its own"));
            }
            let numbered = (2..).map(|n| format!("{}_{n}", support.name));
            support.name = numbered.into_iter().find(|name| !taken(name)).unwrap_or_default();
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
    let on = object.text("on")?.ok_or_else(|| object.missing("on"))?;
    let on = match (on.as_str(), object.text("which")?) {
        ("ring" | "cap", None) => return Err(object.missing("which")),
        ("ring" | "cap", Some(which)) => format!("{which}_{on}"),
        _ => on,
    };
    only_its_own_keys(object, &on)?;
    let plane = if on == "plane" { Some(plane(object, shape)?) } else { None };
    let nodes = nodes(object, &on, plane, shape)?;
    let fix = object.given("fix").is_some();
    let motion = object
        .given("move")
        .map(|json| motion(json, &format!("{}.move", object.at), settings, source))
        .transpose()?;
    let hold = match (plane, object.given("body")) {
        (Some((normal, ..)), Some(json)) => {
            if fix || motion.is_some() {
                let problem = "a plane that moves as a free body holds its normal component alone";
                return Err(object.error("body", problem, "body without fix and without move"));
            }
            let place = format!("{}.body", object.at);
            let body = Object::new(json, &place, "a body", BODY_KEYS, &[], source)?;
            let (velocity, force) = (body.needed("velocity")?, body.needed("force")?);
            Hold::Body(PlaneBody { normal, mass: body.needed("mass")?, velocity, force })
        }
        (Some((normal, ..)), None) if !fix => Hold::Plane(normal),
        _ => Hold::Components(components(object)?),
    };
    let name = object.text("name")?.unwrap_or(on);
    Ok(FilmSupport { name, nodes, hold, motion })
}

/// Refuses keys that say nothing about what the support is on.
fn only_its_own_keys(object: &Object<'_>, on: &str) -> Result<(), InputError> {
    let kinds = [
        ("box", &["min", "max"][..]),
        ("nodes", &["nodes"]),
        ("plane", &["point", "normal", "tolerance", "body"]),
    ];
    for (kind, keys) in kinds.iter().filter(|(kind, _)| *kind != on) {
        if let Some(key) = keys.iter().find(|key| object.given(key).is_some()) {
            let problem = format!("belongs to a support on {kind}, this one is on {on}");
            return Err(object.error(key, problem, format!("\"on\": \"{kind}\"")));
        }
    }
    Ok(())
}

/// Unit normal, a point and the tolerance of a plane.
fn plane(
    object: &Object<'_>,
    shape: &Shape,
) -> Result<(Vector3<f64>, Vector3<f64>, f64), InputError> {
    let point = object.vector("point")?.ok_or_else(|| object.missing("point"))?;
    let tolerance = match object.number("tolerance")? {
        Some(tolerance) => tolerance,
        None => 1e-6 * shape.size(),
    };
    Ok((object.direction("normal")?, point, tolerance))
}

/// Nodes of the film, which alone can be held: the tips of fans are not among them.
fn film_nodes(shape: &Shape) -> BTreeSet<u32> {
    shape.numbering.node.iter().flatten().copied().collect()
}

fn nodes(
    object: &Object<'_>,
    on: &str,
    plane: Option<(Vector3<f64>, Vector3<f64>, f64)>,
    shape: &Shape,
) -> Result<Vec<u32>, InputError> {
    let places = &shape.shell.positions;
    let all = film_nodes(shape);
    let within = |inside: &dyn Fn(Vector3<f64>) -> bool| -> Vec<u32> {
        all.iter().copied().filter(|node| inside(places[*node as usize])).collect()
    };
    let (nodes, what) = match on {
        "box" => {
            let (min, max) = (object.parts("min")?, object.parts("max")?);
            let inside = |x: Vector3<f64>| {
                (0..3).all(|k| {
                    min[k].is_none_or(|min| x[k] >= min) && max[k].is_none_or(|max| x[k] <= max)
                })
            };
            (within(&inside), "the box".to_owned())
        }
        "nodes" => (numbered(object, shape)?, "the list".to_owned()),
        "plane" => {
            let Some((normal, point, tolerance)) = plane else { unreachable!("on a plane") };
            let inside = |x: Vector3<f64>| normal.dot(&(x - point)).abs() <= tolerance;
            (within(&inside), format!("{tolerance} m of the plane"))
        }
        "boundary" => (boundary(shape), "the free edges".to_owned()),
        "all" => (all.iter().copied().collect(), "the film".to_owned()),
        place => {
            let known = shape.places.iter().find(|(name, _)| *name == place);
            let Some((_, nodes)) = known else {
                let allowed =
                    "box, nodes, plane, boundary, all; rings and caps are those of a design";
                return Err(object.error("on", "a mesh has no rings and caps", allowed));
            };
            (nodes.clone(), String::new())
        }
    };
    if nodes.is_empty() {
        let (low, high) = extents(shape);
        let problem = format!("selects nothing: no node lies in {what}");
        let allowed = format!(
            "a selection of at least one node; the film starts between {low:?} and {high:?} m"
        );
        return Err(object.error("on", problem, allowed));
    }
    Ok(nodes)
}

fn extents(shape: &Shape) -> ([f64; 3], [f64; 3]) {
    let places = &shape.shell.positions;
    let first = places.first().copied().unwrap_or_default();
    let (low, high) = places.iter().fold((first, first), |(a, b), x| (a.inf(x), b.sup(x)));
    (low.into(), high.into())
}

/// Nodes of the vertices listed.
fn numbered(object: &Object<'_>, shape: &Shape) -> Result<Vec<u32>, InputError> {
    let allowed = "a list of vertices by number, 0 for the first of the file";
    let Some(json) = object.given("nodes") else { return Err(object.missing("nodes")) };
    let Json::List(items) = json else {
        return Err(object.error("nodes", format!("is {}", json.kind()), allowed));
    };
    let mut nodes = BTreeSet::new();
    for item in items {
        nodes.insert(
            vertex(item, shape).map_err(|problem| object.error("nodes", problem, allowed))?,
        );
    }
    Ok(nodes.into_iter().collect())
}

/// The node of a vertex by its number, 0 for the first of the file.
pub(super) fn vertex(json: &Json, shape: &Shape) -> Result<u32, String> {
    let number = match json {
        Json::Integer(number) => Some(*number),
        Json::Number(number) => crate::input::keys::whole(*number),
        _ => None,
    };
    let Some(number) = number else { return Err(format!("{} is no whole number", json.brief())) };
    let vertices = &shape.numbering.node;
    match usize::try_from(number).ok().and_then(|number| vertices.get(number)) {
        Some(Some(node)) => Ok(*node),
        Some(None) => Err(format!("vertex {number} (from 0) belongs to no face")),
        None => Err(format!("vertex {number} of {}: 0 to {}", vertices.len(), vertices.len() - 1)),
    }
}

/// Nodes on edges that have film on one side alone.
fn boundary(shape: &Shape) -> Vec<u32> {
    let triangles = &shape.shell.triangles;
    let runs: BTreeSet<[u32; 2]> =
        triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    let free = runs.iter().filter(|[a, b]| !runs.contains(&[*b, *a]));
    let nodes: BTreeSet<u32> = free.flatten().copied().collect();
    nodes.into_iter().collect()
}

/// Components named by letters of "xyz", in any order.
fn components(object: &Object<'_>) -> Result<[bool; 3], InputError> {
    let fix = object.text("fix")?.ok_or_else(|| object.missing("fix"))?;
    let sound = !fix.is_empty()
        && fix.chars().all(|c| matches!(c, 'x' | 'y' | 'z'))
        && "xyz".chars().all(|c| fix.matches(c).count() <= 1);
    if sound {
        return Ok(['x', 'y', 'z'].map(|axis| fix.contains(axis)));
    }
    let problem = "names no displacement components";
    Err(object.error("fix", problem, "letters of \"xyz\", each once"))
}

pub(super) fn motion(
    json: &Json,
    at: &str,
    settings: &Settings,
    source: &Source,
) -> Result<Motion, InputError> {
    let object = Object::new(json, at, "a move", MOVE_KEYS, &["rotation"], source)?;
    let from = object.needed("from")?;
    let to = object.number("to")?.or_else(|| settings.number("solver.end_time"));
    let to = to.ok_or_else(|| object.missing("to"))?;
    if to <= from {
        let problem = "the move ends before it begins";
        return Err(object.error("to", problem, format!("above its `from`, {from} s")));
    }
    let turn = object
        .given("rotation")
        .map(|json| {
            let at = format!("{at}.rotation");
            let turn = Object::new(json, &at, "a rotation", ROTATION_KEYS, &[], source)?;
            let centre = turn.vector("centre")?.unwrap_or_default();
            Ok(Rotation { axis: turn.direction("axis")?, centre, angle: turn.needed("angle")? })
        })
        .transpose()?;
    let translation = object.vector("translation")?;
    if turn.is_none() && translation.is_none() {
        let problem = "missing: a move needs a translation, a rotation or both";
        return Err(object.error("translation", problem, "[0, 0, \"10 mm\"]"));
    }
    let smooth = object.text("profile")?.is_none_or(|word| word == "smooth");
    Ok(Motion {
        from,
        to,
        profile: if smooth { Profile::Smooth } else { Profile::Linear },
        translation: translation.unwrap_or_default(),
        rotation: turn,
    })
}
