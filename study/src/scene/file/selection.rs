//! The nodes that a support of a scene acts on.

use std::collections::BTreeSet;

use nalgebra::Vector3;

use super::shape::Shape;
use crate::input::json::Json;
use crate::input::object::Object;
use crate::platform::error::InputError;

/// A plane that selects the nodes near it.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    /// Unit normal.
    pub normal: Vector3<f64>,
    /// A point on it, m.
    pub point: Vector3<f64>,
    /// Distance from it within which a node belongs to it, m.
    pub tolerance: f64,
}

/// Default tolerance of a plane, as a fraction of the film's size (chosen: far above rounding, far
/// below any element).
const PLANE_TOLERANCE: f64 = 1e-6;

impl Plane {
    /// Reads the plane of a support.
    pub fn read(object: &Object<'_>, shape: &Shape) -> Result<Self, InputError> {
        let point = object.needed_vector("point")? - shape.numbering.origin;
        let tolerance = match object.number("tolerance")? {
            Some(tolerance) => tolerance,
            None => PLANE_TOLERANCE * shape.size(),
        };
        let normal = object.direction("normal")?;
        Ok(Self { normal, point, tolerance })
    }

    fn has(&self, position: Vector3<f64>) -> bool {
        self.normal.dot(&(position - self.point)).abs() <= self.tolerance
    }
}

/// The nodes of a support, in ascending order. `on` is the word it is on; `plane` is its plane where it is on
/// one.
pub(super) fn nodes(
    object: &Object<'_>,
    on: &str,
    plane: Option<Plane>,
    shape: &Shape,
) -> Result<Vec<u32>, InputError> {
    let positions = &shape.shell.positions;
    let all = film_nodes(shape);
    let within = |inside: &dyn Fn(Vector3<f64>) -> bool| -> Vec<u32> {
        all.clone().filter(|node| inside(positions[*node as usize])).collect()
    };
    let (nodes, region) = match (on, plane) {
        ("box", _) => {
            let min = object.components("min")?;
            let max = object.components("max")?;
            let origin = shape.numbering.origin;
            let inside = |x: Vector3<f64>| {
                (0..3).all(|k| {
                    let of_run = |bound: f64| bound - origin[k];
                    min[k].is_none_or(|min| x[k] >= of_run(min))
                        && max[k].is_none_or(|max| x[k] <= of_run(max))
                })
            };
            (within(&inside), "the box".to_owned())
        }
        ("nodes", _) => (listed(object, shape)?, "the list".to_owned()),
        (_, Some(plane)) => {
            (within(&|x| plane.has(x)), format!("{} m of the plane", plane.tolerance))
        }
        ("boundary", _) => (boundary(shape), "the free edges".to_owned()),
        ("loop", _) => (of_loop(object, shape)?, "the loop".to_owned()),
        ("all", _) => (all.clone().collect(), "the film".to_owned()),
        (region, None) => {
            let known = shape.regions.iter().find(|(name, _)| *name == region);
            let Some((_, nodes)) = known else {
                let allowed =
                    "box, nodes, plane, boundary, loop, all; only a design has rings and caps";
                return Err(object.error("on", "a mesh has no rings and caps", allowed));
            };
            (nodes.clone(), String::new())
        }
    };
    if nodes.is_empty() {
        let in_file = |x: Vector3<f64>| <[f64; 3]>::from(x + shape.numbering.origin);
        let [low, high] = shape.extents().map(in_file);
        let problem = format!("selects nothing: no node lies in {region}");
        let allowed = format!(
            "a selection of at least one node; the film starts between {low:?} and {high:?} m"
        );
        return Err(object.error("on", problem, allowed));
    }
    Ok(nodes)
}

/// Nodes of the film, before fans close it.
fn film_nodes(shape: &Shape) -> std::ops::Range<u32> {
    0..u32::try_from(shape.shell.positions.len()).unwrap_or(u32::MAX)
}

/// Nodes of the vertices in a list.
fn listed(object: &Object<'_>, shape: &Shape) -> Result<Vec<u32>, InputError> {
    let allowed = "a list of vertices by number, 0 for the first of the file";
    let Some(json) = object.given("nodes") else {
        return Err(object.error("nodes", "missing", allowed));
    };
    let Json::List(items) = json else {
        return Err(object.error("nodes", format!("is {}, not a list", json.kind()), allowed));
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
    let number = number(json)?;
    let vertices = &shape.numbering.node;
    match usize::try_from(number).ok().and_then(|number| vertices.get(number)) {
        Some(Some(node)) => Ok(*node),
        Some(None) => Err(format!("vertex {number} (from 0) belongs to no face")),
        None => Err(format!("vertex {number} of {}: 0 to {}", vertices.len(), vertices.len() - 1)),
    }
}

/// The element of a triangle by its number, 0 for the first of the file.
pub(super) fn triangle(json: &Json, shape: &Shape) -> Result<u32, String> {
    let number = number(json)?;
    let elements = &shape.numbering.element;
    match usize::try_from(number).ok().and_then(|number| elements.get(number)) {
        Some(Some(element)) => Ok(*element),
        Some(None) => Err(format!("triangle {number} (from 0) closes the volume and is not film")),
        None => {
            Err(format!("triangle {number} of {}: 0 to {}", elements.len(), elements.len() - 1))
        }
    }
}

fn number(json: &Json) -> Result<i64, String> {
    json.whole().ok_or_else(|| format!("{json} is not a whole number"))
}

/// Nodes on edges with film on one side only.
fn boundary(shape: &Shape) -> Vec<u32> {
    sorted(shape.shell.rims().into_iter().flatten())
}

/// Nodes of one loop of free edges.
fn of_loop(object: &Object<'_>, shape: &Shape) -> Result<Vec<u32>, InputError> {
    let loops = shape.shell.rims();
    let number = object.count("loop")? as usize;
    let Some(nodes) = number.checked_sub(1).and_then(|index| loops.get(index)) else {
        let problem = format!("the film has {} loops of free edges", loops.len());
        let at = |nodes: &Vec<u32>| {
            let position = shape.shell.positions[nodes[0] as usize] + shape.numbering.origin;
            format!("{} edges at {:?} m", nodes.len(), <[f64; 3]>::from(position))
        };
        let listed: Vec<String> =
            (1..).zip(&loops).map(|(number, nodes)| format!("{number} ({})", at(nodes))).collect();
        let allowed =
            if listed.is_empty() { "another selection".to_owned() } else { listed.join(", ") };
        return Err(object.error("loop", problem, allowed));
    };
    Ok(sorted(nodes.iter().copied()))
}

/// Nodes in ascending order, each once.
fn sorted(nodes: impl Iterator<Item = u32>) -> Vec<u32> {
    nodes.collect::<BTreeSet<u32>>().into_iter().collect()
}
