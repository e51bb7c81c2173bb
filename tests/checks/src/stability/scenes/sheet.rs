//! A free flat sheet that moves a little in its plane: linear, so that its largest stable step is known.
//!
//! ```text
//! Δt = 2/ω_max (√(1+ζ²) − ζ)      ω_max of the assembled stiffness, by power iteration
//! ```

use billow_solver::geometry::shapes::{moved, pseudo_random, sheet};
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::scene::film_scene::FilmScene;
use billow_solver::scene::paper::free_film;
use nalgebra::Vector3;

use super::film::{Parts, prepared, stable_step};
use super::{
    DAMPING, MODULUS, Prepared, Runs, STEP, StabilityScene, THICKNESS, Values, compression, real,
    soft,
};
use crate::cases::{Rig, step_limit};
use crate::stability::Method;

/// Width of the sheet, m, and its height where elements are well shaped.
const SIZE: [f64; 2] = [0.2, 0.15];
/// Speed of the motion, m/s. Chosen: strains of 1e-6, far above rounding and far below what is not linear.
const SPEED: f64 = 1e-3;
/// Steps of a run at its step. Chosen: a step 0.1 % too long multiplies the motion by 1e100.
const STEPS: f64 = 3000.0;

/// The sheet.
pub const SCENE: StabilityScene = StabilityScene {
    name: "sheet",
    meaning: "a free uneven sheet of 24 elements in small motion, 3000 steps",
    parameters: &[
        STEP,
        DAMPING,
        compression(1.0),
        THICKNESS,
        MODULUS,
        real(
            "sliver",
            1.0,
            [1e-6, 1.0],
            "ratio",
            "height of the elements over that of well-shaped ones",
        ),
        real(
            "slack",
            0.0,
            [0.0, 0.9],
            "ratio",
            "share by which the sheet starts shortened in both directions",
        ),
        soft("modulus of the left half of the sheet over that of the right half"),
    ],
    runs: Runs::Film,
    build,
};

fn build(rig: &Rig, method: Method, values: &Values) -> Result<Prepared, String> {
    let Method::Film(kind) = method else { return Err("film only".to_owned()) };
    let film = values.film();
    let flat = sheet(4, 3, SIZE[0], SIZE[1] * values.get("sliver"));
    let soft = values.get("soft");
    let left = |triangle: &[u32; 3]| {
        let x = triangle.map(|node| flat.positions[node as usize].x);
        x.iter().sum::<f64>() < 1.5 * SIZE[0]
    };
    let factors: Vec<f64> =
        flat.triangles.iter().map(|triangle| if left(triangle) { soft } else { 1.0 }).collect();
    let model = FilmModel::of_shell(&film, &flat)
        .map_err(|error| error.to_string())?
        .with_stiffness(&factors);
    let (compression, slack) = (film.compression, values.get("slack"));
    let linear = compression.to_bits() == 1.0_f64.to_bits() && slack.to_bits() == 0;
    let omega = linear.then(|| step_limit::assembled(&flat, &film, &model));
    let shell = moved(flat, |x| x * (1.0 - slack));
    let kick = |kick: &Vector3<f64>| Vector3::new(kick.x, kick.y, 0.0) * SPEED;
    let velocities = pseudo_random(shell.positions.len(), 4).iter().map(kick).collect();
    let mut scene = FilmScene { velocities, ..free_film(shell, film) };
    scene.solver.end_time = STEPS * values.get("step") * stable_step(rig, &scene)?;
    let (run, timeline) = prepared(rig, scene, kind, values, Parts { factors, rings: None })?;
    Ok(Prepared::Film(Box::new(run), timeline, omega))
}
