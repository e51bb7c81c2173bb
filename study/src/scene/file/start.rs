//! `start`: velocities.

use nalgebra::Vector3;

use super::shape::Shape;
use crate::input::json::Json;
use crate::input::keys::{SPIN_KEYS, START_KEYS};
use crate::input::object::Object;
use crate::input::source::Source;
use crate::platform::error::InputError;

/// Reads `start`: the velocity of each node, m/s; empty for a start at rest.
///
/// ```text
/// v = velocity + ω × (x − centre)
/// ```
pub(super) fn velocities(
    json: Option<&Json>,
    shape: &Shape,
    source: &Source,
) -> Result<Vec<Vector3<f64>>, InputError> {
    let Some(json) = json else { return Ok(Vec::new()) };
    let object = Object::new(json, "start", "a start", START_KEYS, &["spin"], source)?;
    let uniform = object.vector("velocity")?.unwrap_or_default();
    let mut velocities = vec![uniform; shape.shell.positions.len()];
    if let Some(json) = object.given("spin") {
        add_spin(&mut velocities, json, shape, source)?;
    }
    Ok(velocities)
}

/// Adds a rigid rotation.
fn add_spin(
    velocities: &mut [Vector3<f64>],
    json: &Json,
    shape: &Shape,
    source: &Source,
) -> Result<(), InputError> {
    let spin = Object::new(json, "start.spin", "a spin", SPIN_KEYS, &[], source)?;
    let centre = spin.vector("centre")?.unwrap_or_default() - shape.numbering.origin;
    let rate = spin.needed("rate")?;
    let angular_velocity = spin.direction("axis")? * rate;
    for (velocity, position) in velocities.iter_mut().zip(&shape.shell.positions) {
        *velocity += angular_velocity.cross(&(position - centre));
    }
    Ok(())
}
