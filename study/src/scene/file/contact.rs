//! `contact`: contact of film with film and with plates.

use std::collections::{BTreeMap, BTreeSet};

use billow_solver::collision::contact::{ContactModel, PairKind};
use billow_solver::collision::monitor::intersections::intersections;
use billow_solver::geometry::field::Field;
use billow_solver::geometry::topology::Topology;
use billow_solver::models::film::capsule;
use billow_solver::scene::error::SceneError;
use billow_solver::scene::film_scene::{FilmContact, FilmScene};
use billow_solver::scene::plate::Plate;

use super::shape::Numbering;
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
    let resolved = capsule::resolved_contact(contact, &settings.fold_design(source)?)
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

/// Pairs of elements of film that starts in film.
struct StartPairs {
    /// All of them, in order.
    all: Vec<[u32; 2]>,
    /// Those of which an edge passes through the other element.
    crossing: Vec<[u32; 2]>,
}

impl StartPairs {
    /// Those of a film whose contact has this model.
    fn of(model: &ContactModel, positions: &Field) -> Self {
        let topology = &model.mesh.topology;
        let mut at_node = vec![Vec::new(); topology.nodes()];
        for (element, nodes) in (0_u32..).zip(&topology.triangles) {
            for node in nodes {
                at_node[*node as usize].push(element);
            }
        }
        let at_edge = elements_at_edges(topology);
        let crossing = crossing(topology, &at_edge, positions);
        let mut all = crossing.clone();
        model.pairs_within(positions, TOUCHING_DISTANCE * model.edge_length, |pair, _| {
            let (first, second) = (pair.first as usize, pair.second as usize);
            match pair.kind {
                PairKind::NodeElement => add(&mut all, &at_node[first], &[pair.second]),
                PairKind::EdgeEdge => add(&mut all, &at_edge[first], &at_edge[second]),
            }
        });
        Self { all: all.into_iter().collect(), crossing: crossing.into_iter().collect() }
    }
}

/// Elements at each edge.
fn elements_at_edges(topology: &Topology) -> Vec<Vec<u32>> {
    let mut at_edge = vec![Vec::new(); topology.edges.len()];
    for (element, edges) in (0_u32..).zip(&topology.element_edges) {
        for edge in edges {
            at_edge[*edge as usize].push(element);
        }
    }
    at_edge
}

/// Adds every pair of two lists of elements, the lower number first.
fn add(pairs: &mut BTreeSet<[u32; 2]>, some: &[u32], others: &[u32]) {
    let both = some.iter().flat_map(|a| others.iter().map(move |b| [*a.min(b), *a.max(b)]));
    pairs.extend(both.filter(|[a, b]| a != b));
}

/// Pairs of elements of which an edge of one passes through the other.
fn crossing(topology: &Topology, at_edge: &[Vec<u32>], positions: &Field) -> BTreeSet<[u32; 2]> {
    let mut pairs = BTreeSet::new();
    for (edge, element) in intersections(topology, positions) {
        add(&mut pairs, &at_edge[edge as usize], &[element]);
    }
    pairs
}

/// What film that starts in film may do: touch film, or pass through it.
#[derive(Clone, Copy)]
pub(super) struct Start {
    pub may_touch: bool,
    pub may_cross: bool,
    /// What is allowed instead, for errors.
    pub allowed: &'static str,
}

impl Start {
    /// That of a scene: what `contact.ignore_start` says, and touch where it asks for no contact.
    pub fn of_scene(tree: &Json, settings: &Settings) -> Self {
        let given = tree.get("contact").filter(|json| **json != Json::Null);
        let ignore = settings.flag("contact.ignore_start") == Some(true);
        Self {
            may_touch: ignore || given.is_none(),
            may_cross: ignore,
            allowed: "a gap between layers, however small; contact.ignore_start true for no contact of these pairs; or \
                      contact.enabled false",
        }
    }
}

/// Film that starts in film: it has no side there. Its pairs of faces lose their contact where they may, else they are
/// refused. Returns the contact distance (m) of film without such pairs.
pub(super) fn settle_start(
    film: &mut FilmScene,
    start: Start,
    numbering: &Numbering,
    notes: &mut Vec<String>,
    source: &Source,
) -> Result<Option<f64>, InputError> {
    let refused = |error: SceneError| super::scene_error(error, source);
    let (system, ..) = capsule::constants(film).map_err(refused)?;
    let Some(model) = &system.contact else { return Ok(None) };
    let found = StartPairs::of(model, &Field::of(&film.shell.positions));
    if found.all.is_empty() {
        return Ok(Some(model.distance));
    }
    let (does, shown) = match found.crossing.as_slice() {
        [] => ("touches", &found.all),
        _ => ("passes through", &found.crossing),
    };
    let problem = format!("film {does} film at the start{}", places(shown, numbering));
    let may = if found.crossing.is_empty() { start.may_touch } else { start.may_cross };
    if !may {
        return Err(source.error("contact", "", problem, start.allowed));
    }
    notes.push(format!("{problem}: these pairs have no contact, all others have"));
    if let Some(contact) = &mut film.contact {
        contact.ignored = found.all;
    }
    Ok(None)
}

/// Notes that film passes through film where it starts, for a static equilibrium, which has no contact.
pub(super) fn crossing_film(film: &FilmScene, numbering: &Numbering) -> Option<String> {
    let shell = &film.shell;
    let topology = Topology::new(shell.positions.len(), &shell.triangles);
    let positions = Field::of(&shell.positions);
    let pairs = crossing(&topology, &elements_at_edges(&topology), &positions);
    let pairs: Vec<[u32; 2]> = pairs.into_iter().collect();
    let places = (!pairs.is_empty()).then(|| places(&pairs, numbering))?;
    Some(format!("film passes through film at the start{places}: statics has no contact"))
}

/// Some pairs of elements as pairs of faces: their number and the places of the first.
fn places(pairs: &[[u32; 2]], numbering: &Numbering) -> String {
    // The triangles of one face have one place.
    let face_of = numbering.faces_of_elements();
    let mut faces: BTreeMap<[usize; 2], [u32; 2]> = BTreeMap::new();
    for pair in pairs {
        faces.entry(pair.map(|element| face_of[element as usize])).or_insert(*pair);
    }
    let number = match faces.len() {
        1 => "in a pair of faces".to_owned(),
        number => format!("in {number} pairs of faces"),
    };
    let shown = faces.values().take(MAX_SHOWN).map(|pair| {
        let [a, b] = pair.map(|element| numbering.place(element as usize));
        format!("{a} and {b}")
    });
    let more = if faces.len() > MAX_SHOWN { "; …" } else { "" };
    format!(", {number}: {}{more}", shown.collect::<Vec<_>>().join("; "))
}

/// Most pairs of faces that a message names.
const MAX_SHOWN: usize = 2;

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
