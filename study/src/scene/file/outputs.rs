//! `outputs`: what is followed, by the names the user gives it; and `start`: velocities.

use std::cell::RefCell;

use billow_solver::geometry::mesh_io::obj_reader;
use billow_solver::output::history::Track;
use billow_solver::scene::MAX_SAMPLES;
use billow_solver::scene::film_scene::FilmOutputs;
use nalgebra::Vector3;

use super::Reader;
use super::object::Object;
use super::shape::Shape;
use super::supports::vertex;
use crate::input::keys::{self, NEAR, OUTPUT_KEYS, SPIN_KEYS, START_KEYS};
use crate::input::source::{Source, shown};
use crate::input::study_file::Json;
use crate::platform::error::{InputError, Result};

/// What is followed, by name, in the order of [`FilmOutputs`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Followed {
    /// Names of the nodes.
    pub nodes: Vec<String>,
    /// Names of the elements.
    pub elements: Vec<String>,
}

impl Followed {
    /// Gives the series of a run these names.
    pub fn name(&self, tracks: &mut [Track]) {
        let nodes = self.nodes.iter();
        let nodes =
            nodes.flat_map(|name| ["x", "y", "z"].map(|axis| format!("node_{name}_{axis}")));
        let elements = self.elements.iter();
        let elements =
            elements.flat_map(|name| ["N1", "N2"].map(|own| format!("element_{name}_{own}")));
        for (track, name) in tracks.iter_mut().zip(nodes.chain(elements)) {
            track.name = name;
        }
    }
}

/// Share of the film's size beyond which a followed place is told to be off the film.
const FAR: f64 = 0.2;

/// Refuses a run of more samples than anybody reads.
pub(super) fn check_interval(
    interval: f64,
    end_time: f64,
    source: &Source,
) -> std::result::Result<(), InputError> {
    if end_time / interval <= MAX_SAMPLES {
        return Ok(());
    }
    Err(source.error(
        "outputs.sample_interval",
        &shown(interval),
        format!("samples a run of {end_time} s more than {MAX_SAMPLES:.0} times"),
        format!("at least {} s for this end_time", shown(end_time / MAX_SAMPLES)),
    ))
}

/// Reads `outputs`.
pub(super) fn read(
    json: Option<&Json>,
    shape: &Shape,
    notes: &mut Vec<String>,
    source: &Source,
) -> std::result::Result<(FilmOutputs, Followed), InputError> {
    let empty = Json::Object(Vec::new());
    let json = json.unwrap_or(&empty);
    let more = ["nodes", "elements"];
    let object = Object::new(json, "outputs", "outputs", OUTPUT_KEYS, &more, source)?;
    let mut named: Vec<(String, u32)> =
        shape.centres.iter().map(|(name, node)| ((*name).to_owned(), *node)).collect();
    let far = RefCell::new(notes);
    let node = |json: &Json| match place(json)? {
        Some(place) => {
            let (away, node) = nearest_node(shape, place);
            if away > FAR * shape.size() {
                let place = <[f64; 3]>::from(place);
                let note =
                    format!("outputs.nodes: the node nearest to {place:?} m is {away:.4} m off");
                far.borrow_mut().push(note);
            }
            Ok(node)
        }
        None => vertex(json, shape),
    };
    collect(&object, "nodes", NODES, &mut named, &node)?;
    let mut elements = Vec::new();
    let element = |json: &Json| match place(json)? {
        Some(place) => {
            let (away, element) = nearest_element(shape, place);
            if away > FAR * shape.size() {
                let place = <[f64; 3]>::from(place);
                far.borrow_mut().push(format!(
                    "outputs.elements: the element nearest to {place:?} m is {away:.4} m off"
                ));
            }
            Ok(element)
        }
        None => numbered_element(json, shape),
    };
    collect(&object, "elements", ELEMENTS, &mut elements, &element)?;
    let (names, nodes) = named.into_iter().unzip();
    let (element_names, elements) = elements.into_iter().unzip();
    let sample_interval = object.needed("sample_interval")?;
    Ok((
        FilmOutputs { sample_interval, nodes, elements, frames: object.count("frames")? },
        Followed { nodes: names, elements: element_names },
    ))
}

const NODES: &str = "vertices by number, 0 for the first of the file, or places [x, y, z] (the node \
                     nearest to it), each alone or named: [12, {\"apex\": 40}, {\"rim\": [0.5, 0, 0]}]";
const ELEMENTS: &str = "triangles by number, 0 for the first of the file, or places [x, y, z] (the \
                        element nearest to it), each alone or named: [12, {\"middle\": [0, 0, 0]}]";

/// What a list (or an object of names) picks.
fn collect(
    object: &Object<'_>,
    key: &str,
    allowed: &str,
    found: &mut Vec<(String, u32)>,
    pick: &dyn Fn(&Json) -> std::result::Result<u32, String>,
) -> std::result::Result<(), InputError> {
    let refuse = |problem: String| object.error(key, problem, allowed);
    let mut add = |name: String, json: &Json| {
        let index = pick(json).map_err(&refuse)?;
        let sound = !name.is_empty()
            && name.len() <= 64
            && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.'));
        if !sound {
            return Err(refuse(format!("{name:?} is no name: letters, digits, _, - and dots")));
        }
        match found.iter().find(|(other, _)| *other == name) {
            // The same number twice is one thing to follow.
            Some((_, other)) if *other == index => {}
            Some(_) => return Err(refuse(format!("{name:?} is named twice"))),
            None => found.push((name, index)),
        }
        Ok(())
    };
    match object.given(key) {
        None => {}
        Some(Json::Object(members)) => {
            for (name, json) in members {
                add(name.clone(), json)?;
            }
        }
        Some(Json::List(items)) => {
            for item in items {
                match item {
                    Json::Object(members) => {
                        for (name, json) in members {
                            add(name.clone(), json)?;
                        }
                    }
                    Json::List(_) => {
                        let problem = format!("the place {} has no name", item.brief());
                        return Err(refuse(problem));
                    }
                    number => add(number.brief(), number)?,
                }
            }
        }
        Some(other) => return Err(refuse(format!("is {}", other.kind()))),
    }
    Ok(())
}

/// The place a list of three names.
fn place(json: &Json) -> std::result::Result<Option<Vector3<f64>>, String> {
    if !matches!(json, Json::List(_)) {
        return Ok(None);
    }
    let read = NEAR.read_vector(json).map_err(|refusal| refusal.problem)?;
    Ok(Some(read.into()))
}

/// The node nearest to a place, and how far it is, m.
fn nearest_node(shape: &Shape, place: Vector3<f64>) -> (f64, u32) {
    let mut best = (f64::INFINITY, 0);
    for node in shape.numbering.node.iter().flatten() {
        let distance = (shape.shell.positions[*node as usize] - place).norm();
        if distance < best.0 {
            best = (distance, *node);
        }
    }
    best
}

/// The element whose middle is nearest to a place, and how far it is, m.
fn nearest_element(shape: &Shape, place: Vector3<f64>) -> (f64, u32) {
    let mut best = (f64::INFINITY, 0);
    for (element, triangle) in (0..).zip(&shape.shell.triangles) {
        let corners = triangle.map(|node| shape.shell.positions[node as usize]);
        let distance = (corners.iter().sum::<Vector3<f64>>() / 3.0 - place).norm();
        if distance < best.0 {
            best = (distance, element);
        }
    }
    best
}

fn numbered_element(json: &Json, shape: &Shape) -> std::result::Result<u32, String> {
    let number = match json {
        Json::Integer(number) => Some(*number),
        Json::Number(number) => keys::whole(*number),
        _ => None,
    };
    let Some(number) = number else { return Err(format!("{} is no whole number", json.brief())) };
    let elements = &shape.numbering.element;
    match usize::try_from(number).ok().and_then(|number| elements.get(number)) {
        Some(Some(element)) => Ok(*element),
        Some(None) => Err(format!("triangle {number} (from 0) closes the volume and is no film")),
        None => {
            Err(format!("triangle {number} of {}: 0 to {}", elements.len(), elements.len() - 1))
        }
    }
}

/// Reads `start`: the velocity of each node, m/s; none for a start at rest.
pub(super) fn velocities(
    json: Option<&Json>,
    shape: &Shape,
    reader: &mut Reader,
) -> Result<Vec<Vector3<f64>>> {
    let Some(json) = json else { return Ok(Vec::new()) };
    let source = reader.source.clone();
    let object = Object::new(json, "start", "a start", START_KEYS, &["spin"], &source)?;
    let even = object.vector("velocity")?.unwrap_or_default();
    let mut velocities = vec![even; shape.shell.positions.len()];
    if let Some(json) = object.given("spin") {
        let spin = Object::new(json, "start.spin", "a spin", SPIN_KEYS, &[], &source)?;
        let centre = spin.vector("centre")?.unwrap_or_default();
        let turn = spin.direction("axis")? * spin.needed("rate")?;
        for (velocity, place) in velocities.iter_mut().zip(&shape.shell.positions) {
            *velocity += turn.cross(&(place - centre));
        }
    }
    if let Some(name) = object.text("velocities")? {
        let text = reader.text("start.velocities", &name)?;
        let read = obj_reader::read(&text, 0).map_err(|error| {
            let problem = format!("line {}: {}", error.line, error.problem);
            object.error("velocities", problem, error.allowed)
        })?;
        let vertices = shape.numbering.node.len();
        if read.vertices.len() != vertices {
            let problem = format!("has {} vertices; the mesh has {vertices}", read.vertices.len());
            return Err(object.error("velocities", problem, "one v line a vertex").into());
        }
        let mut given = vec![None; velocities.len()];
        for (node, own) in shape.numbering.node.iter().zip(&read.vertices) {
            if let Some(node) = node {
                given[*node as usize].get_or_insert(*own);
            }
        }
        for (velocity, own) in velocities.iter_mut().zip(&given) {
            *velocity += own.unwrap_or_default();
        }
    }
    Ok(velocities)
}
