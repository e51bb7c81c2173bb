//! `outputs`: nodes and elements recorded, by the user's names.

use billow_solver::output::history::Track;
use billow_solver::scene::film_scene::FilmOutputs;
use nalgebra::Vector3;

use super::selection::{triangle, vertex};
use super::shape::Shape;
use crate::input::json::Json;
use crate::input::keys::{NEAR, OUTPUT_KEYS};
use crate::input::object::Object;
use crate::input::source::Source;
use crate::platform::error::InputError;

/// Names of what is recorded, in the order of [`FilmOutputs`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recorded {
    /// Names of the nodes.
    pub nodes: Vec<String>,
    /// Names of the elements.
    pub elements: Vec<String>,
}

impl Recorded {
    /// Gives the series of a run these names.
    pub fn name(&self, tracks: &mut [Track]) {
        let nodes = self.nodes.iter();
        let nodes =
            nodes.flat_map(|name| ["x", "y", "z"].map(|axis| format!("node_{name}_{axis}")));
        let elements = self.elements.iter();
        let elements =
            elements.flat_map(|name| ["N1", "N2"].map(|force| format!("element_{name}_{force}")));
        for (track, name) in tracks.iter_mut().zip(nodes.chain(elements)) {
            track.name = name;
        }
    }
}

/// Distance of a recorded position from the film above which a note says so, as a fraction of the
/// film's size (chosen: a position in another unit is farther).
const MAX_DISTANCE: f64 = 0.2;

/// Reads `outputs`.
pub(super) fn read(
    json: Option<&Json>,
    shape: &Shape,
    notes: &mut Vec<String>,
    source: &Source,
) -> Result<(FilmOutputs, Recorded), InputError> {
    let empty = Json::Object(Vec::new());
    let json = json.unwrap_or(&empty);
    let more = ["nodes", "elements"];
    let object = Object::new(json, "outputs", "outputs", OUTPUT_KEYS, &more, source)?;
    let mut nodes: Vec<(String, u32)> =
        shape.centres.iter().map(|(name, node)| ((*name).to_owned(), *node)).collect();
    let mut elements = Vec::new();
    let node = Recording { key: "nodes", allowed: NODES, number: vertex, nearest: nearest_node };
    node.read(&object, shape, &mut nodes, notes)?;
    let (number, nearest) = (triangle, nearest_element);
    let element = Recording { key: "elements", allowed: ELEMENTS, number, nearest };
    element.read(&object, shape, &mut elements, notes)?;
    let (names, nodes) = nodes.into_iter().unzip();
    let (element_names, elements) = elements.into_iter().unzip();
    let sample_interval = object.needed("sample_interval")?;
    let frames = object.count("frames")?;
    Ok((
        FilmOutputs { sample_interval, nodes, elements, frames },
        Recorded { nodes: names, elements: element_names },
    ))
}

const NODES: &str = "vertices by number, 0 for the first of the file, or positions [x, y, z] (the node \
                     nearest to it), each alone or named: [12, {\"apex\": 40}, {\"rim\": [0.5, 0, 0]}]";
const ELEMENTS: &str = "triangles by number, 0 for the first of the file, or positions [x, y, z] (the \
                        element nearest to it), each alone or named: [12, {\"middle\": [0, 0, 0]}]";

/// A key that selects nodes or elements.
struct Recording {
    key: &'static str,
    allowed: &'static str,
    /// The node or element of a number of the file.
    number: fn(&Json, &Shape) -> Result<u32, String>,
    /// The distance of the one nearest to a position, m, and its number.
    nearest: fn(&Shape, Vector3<f64>) -> (f64, u32),
}

impl Recording {
    /// Adds what a list, or an object of names, selects.
    fn read(
        &self,
        object: &Object<'_>,
        shape: &Shape,
        found: &mut Vec<(String, u32)>,
        notes: &mut Vec<String>,
    ) -> Result<(), InputError> {
        let refuse = |problem: String| object.error(self.key, problem, self.allowed);
        let members = |json: &Json| match json {
            Json::Object(members) => Ok(members.clone()),
            Json::List(_) => Err(refuse(format!("the position {json} has no name"))),
            number => Ok(vec![(number.to_string(), number.clone())]),
        };
        let named = match object.given(self.key) {
            None => return Ok(()),
            Some(Json::List(items)) => {
                items.iter().map(members).collect::<Result<Vec<_>, _>>()?.concat()
            }
            Some(json @ Json::Object(_)) => members(json)?,
            Some(other) => return Err(refuse(format!("is {}", other.kind()))),
        };
        for (name, json) in named {
            let index = self.pick(&json, shape, notes).map_err(refuse)?;
            let valid = !name.is_empty()
                && name.len() <= 64
                && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.'));
            if !valid {
                let allowed = "letters, digits, _, - and dots, up to 64";
                return Err(refuse(format!("{name:?} is not a name: {allowed}")));
            }
            match found.iter().find(|(other, _)| *other == name) {
                // The same number twice is recorded once.
                Some((_, other)) if *other == index => {}
                Some(_) => return Err(refuse(format!("{name:?} is the name of two"))),
                None => found.push((name, index)),
            }
        }
        Ok(())
    }

    /// The node or element of a number, or the one nearest to a position.
    fn pick(&self, json: &Json, shape: &Shape, notes: &mut Vec<String>) -> Result<u32, String> {
        if !matches!(json, Json::List(_)) {
            return (self.number)(json, shape);
        }
        let position = NEAR.read_vector(json).map_err(|refusal| refusal.problem)?;
        let (distance, index) =
            (self.nearest)(shape, Vector3::from(position) - shape.numbering.origin);
        if distance > MAX_DISTANCE * shape.size() {
            notes.push(format!(
                "outputs.{}: the one nearest to {position:?} m is {distance:.4} m away",
                self.key
            ));
        }
        Ok(index)
    }
}

/// The distance of the node nearest to a position, m, and the node.
fn nearest_node(shape: &Shape, position: Vector3<f64>) -> (f64, u32) {
    let mut best = (f64::INFINITY, 0);
    for node in shape.numbering.node.iter().flatten() {
        let distance = (shape.shell.positions[*node as usize] - position).norm();
        if distance < best.0 {
            best = (distance, *node);
        }
    }
    best
}

/// The distance of the element whose centroid is nearest to a position, m, and the element.
fn nearest_element(shape: &Shape, position: Vector3<f64>) -> (f64, u32) {
    let mut best = (f64::INFINITY, 0);
    for (element, triangle) in (0..).zip(&shape.shell.triangles) {
        let corners = triangle.map(|node| shape.shell.positions[node as usize]);
        let distance = (corners.iter().sum::<Vector3<f64>>() / 3.0 - position).norm();
        if distance < best.0 {
            best = (distance, element);
        }
    }
    best
}
