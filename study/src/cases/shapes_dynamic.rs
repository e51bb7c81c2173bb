//! Shapes of film the cases move.

use billow_solver::film_scene::{FilmSupport, Hold, PlaneBody};
use billow_solver::shell::Shell;
use nalgebra::Vector3;

use super::rig::held;

/// A column of gas between two square plates of film, the walls no film.
#[derive(Debug, Clone)]
pub struct Column {
    /// Plates and walls.
    pub shell: Shell,
    /// Nodes of the lower plate.
    pub lower: Vec<u32>,
    /// Nodes of the upper plate.
    pub upper: Vec<u32>,
}

/// A column of this area (m²) and height (m), standing on z = 0.
pub fn column(area: f64, height: f64) -> Column {
    let half = 0.5 * area.sqrt();
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
    let plate = |z: f64| corners.map(|(x, y)| Vector3::new(x, y, z));
    let positions = [plate(0.0), plate(height)].concat();
    let mut shell = Shell::relaxed(positions, vec![[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]]);
    for side in 0..4_u32 {
        let next = (side + 1) % 4;
        shell.closure.extend([[side, next, next + 4], [side, next + 4, side + 4]]);
    }
    Column { shell, lower: (0..4).collect(), upper: (4..8).collect() }
}

impl Column {
    /// Both plates held: a rigid vessel.
    pub fn rigid(&self) -> Vec<FilmSupport> {
        vec![held([self.lower.clone(), self.upper.clone()].concat(), "xyz")]
    }

    /// The lower plate held, the upper one a rigid plane of this mass in all (kg, the film of this
    /// area density, kg/m², included) that moves along z at this speed (m/s) under a constant force
    /// (N).
    pub fn piston(&self, mass: f64, film: f64, speed: f64, force: f64) -> Vec<FilmSupport> {
        let plate = 0.5 * self.shell.reference_area() * film;
        let body = PlaneBody { normal: Vector3::z(), mass: mass - plate, velocity: speed, force };
        vec![
            held(self.lower.clone(), "xyz"),
            held(self.upper.clone(), "xy"),
            FilmSupport {
                name: "piston".to_owned(),
                nodes: self.upper.clone(),
                hold: Hold::Body(body),
                motion: None,
            },
        ]
    }
}
