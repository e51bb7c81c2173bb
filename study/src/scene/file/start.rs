//! `start`: velocities.

use nalgebra::Vector3;

use super::reader::Reader;
use super::shape::Shape;
use crate::input::json::Json;
use crate::input::keys::{SPIN_KEYS, START_KEYS};
use crate::input::object::Object;
use crate::input::source::Source;
use crate::platform::error::Result;

/// Reads `start`: the velocity of each node, m/s; empty for a start at rest.
///
/// ```text
/// v = velocity + ω × (x − centre) + velocities of the file
/// ```
pub(super) fn velocities(
    json: Option<&Json>,
    shape: &Shape,
    reader: &mut Reader,
) -> Result<Vec<Vector3<f64>>> {
    let Some(json) = json else { return Ok(Vec::new()) };
    let source = reader.source.clone();
    let object = Object::new(json, "start", "a start", START_KEYS, &["spin"], &source)?;
    let uniform = object.vector("velocity")?.unwrap_or_default();
    let mut velocities = vec![uniform; shape.shell.positions.len()];
    if let Some(json) = object.given("spin") {
        add_spin(&mut velocities, json, shape, &source)?;
    }
    if let Some(name) = object.text("velocities")? {
        add_file(&mut velocities, &name, &object, shape, reader)?;
    }
    Ok(velocities)
}

/// Adds a rigid rotation.
fn add_spin(
    velocities: &mut [Vector3<f64>],
    json: &Json,
    shape: &Shape,
    source: &Source,
) -> Result<()> {
    let spin = Object::new(json, "start.spin", "a spin", SPIN_KEYS, &[], source)?;
    let centre = spin.vector("centre")?.unwrap_or_default();
    let rate = spin.needed("rate")?;
    let angular_velocity = spin.direction("axis")? * rate;
    for (velocity, position) in velocities.iter_mut().zip(&shape.shell.positions) {
        *velocity += angular_velocity.cross(&(position - centre));
    }
    Ok(())
}

/// Adds the velocities of an OBJ file, one vertex for each vertex of the mesh. Where several vertices
/// are one node, the first counts.
fn add_file(
    velocities: &mut [Vector3<f64>],
    name: &str,
    object: &Object<'_>,
    shape: &Shape,
    reader: &mut Reader,
) -> Result<()> {
    let file = reader.surface("start.velocities", name, 0)?;
    let vertices = shape.numbering.node.len();
    if file.vertices.len() != vertices {
        let problem = format!("has {} vertices; the mesh has {vertices}", file.vertices.len());
        let allowed = "one v line for each vertex of the mesh";
        return Err(object.error("velocities", problem, allowed).into());
    }
    let mut given = vec![None; velocities.len()];
    for (node, velocity) in shape.numbering.node.iter().zip(&file.vertices) {
        if let Some(node) = node {
            given[*node as usize].get_or_insert(*velocity);
        }
    }
    for (velocity, added) in velocities.iter_mut().zip(&given) {
        *velocity += added.unwrap_or_default();
    }
    Ok(())
}
