//! A column of gas between two square plates of film, for the cases of gas in a vessel and under a
//! piston.

use billow_solver::geometry::shell::Shell;
use billow_solver::scene::film_support::{FilmSupport, Hold, PlaneBody};
use nalgebra::Vector3;

use super::rig::held;
use super::shapes::gas_column;

/// Nodes of the lower plate.
const LOWER: [u32; 4] = [0, 1, 2, 3];
/// Nodes of the upper plate.
const UPPER: [u32; 4] = [4, 5, 6, 7];

/// A column of gas: two plates of film, the walls between them closing faces.
#[derive(Debug, Clone)]
pub struct Column {
    /// Plates and walls.
    pub shell: Shell,
}

/// A column of this area (m²) and height (m), standing on z = 0.
pub fn column(area: f64, height: f64) -> Column {
    Column { shell: gas_column(area, height) }
}

/// Supports of a rigid vessel: both plates of a column are held.
pub fn rigid_vessel() -> Vec<FilmSupport> {
    vec![held([LOWER, UPPER].concat(), "xyz")]
}

impl Column {
    /// Supports of a piston: the lower plate is held, the upper one is a rigid plane. Its mass (kg)
    /// includes the film of this area density (kg/m²). It moves along z, from this speed (m/s) on,
    /// under a constant force (N).
    pub fn piston(&self, mass: f64, area_density: f64, speed: f64, force: f64) -> Vec<FilmSupport> {
        let film = 0.5 * self.shell.reference_area() * area_density;
        let body = PlaneBody { normal: Vector3::z(), mass: mass - film, velocity: speed, force };
        vec![
            held(LOWER.to_vec(), "xyz"),
            held(UPPER.to_vec(), "xy"),
            FilmSupport {
                name: "piston".to_owned(),
                nodes: UPPER.to_vec(),
                hold: Hold::Body(body),
                motion: None,
            },
        ]
    }
}
