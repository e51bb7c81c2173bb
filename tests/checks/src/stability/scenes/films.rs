//! Two sheets that collide, every step monitored.

use billow_solver::geometry::shapes::{joined, moved, sheet};
use billow_solver::geometry::shell::Shell;
use billow_solver::scene::film_scene::FilmScene;
use billow_solver::scene::paper::free_film;
use nalgebra::Vector3;

use super::film::{Parts, prepared};
use super::{
    CONTACT_STIFFNESS, DAMPING, MODULUS, Prepared, Runs, STEP, StabilityScene, THICKNESS, Values,
    compression, real, soft,
};
use crate::cases::Rig;
use crate::cases::contact_rig::monitored_contact;
use crate::stability::Method;

/// Contact distance, m.
const DISTANCE: f64 = 2e-3;
/// Simulated time, s.
const END: f64 = 4e-3;

/// The sheets.
pub const SCENE: StabilityScene = StabilityScene {
    name: "films",
    meaning: "two free sheets of 24 elements that collide, 4 ms, every step monitored",
    parameters: &[
        STEP,
        DAMPING,
        compression(0.0),
        THICKNESS,
        MODULUS,
        CONTACT_STIFFNESS,
        real("speed", 5.0, [0.0, 1e4], "m/s", "speed of approach"),
        real(
            "gap",
            2.0,
            [0.0, 100.0],
            "contact distances",
            "gap at the start; the contact distance is 2 mm; 0: facets coincide",
        ),
        soft("modulus of the upper sheet over that of the lower one"),
    ],
    runs: Runs::Film,
    build,
};

fn build(rig: &Rig, method: Method, values: &Values) -> Result<Prepared, String> {
    let Method::Film(kind) = method else { return Err("film only".to_owned()) };
    let low = sheet(4, 3, 0.2, 0.15);
    let (nodes, elements) = (low.positions.len(), low.triangles.len());
    let rise = Vector3::z() * (values.get("gap") * DISTANCE);
    let high = moved(sheet(4, 3, 0.2, 0.15), |x| x + rise);
    let high = Shell::relaxed(high.positions, high.triangles);
    let shell = joined(&[low, high]);
    let half = 0.5 * values.get("speed");
    let velocity = |node: usize| Vector3::z() * if node < nodes { half } else { -half };
    let mut scene = FilmScene {
        velocities: (0..shell.positions.len()).map(velocity).collect(),
        contact: Some(monitored_contact(DISTANCE)),
        ..free_film(shell, values.film())
    };
    scene.solver.end_time = END;
    let soft = values.get("soft");
    let factors = (0..2 * elements).map(|element| if element < elements { 1.0 } else { soft });
    let parts = Parts { factors: factors.collect(), rings: None };
    let (run, timeline) = prepared(rig, scene, kind, values, parts)?;
    Ok(Prepared::Film(Box::new(run), timeline, None))
}
