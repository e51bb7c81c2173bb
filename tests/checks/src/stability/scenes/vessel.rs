//! Film under a fixed overpressure, for the static solver: a bag from any flatness, and the paper's erected capsule.

use billow_solver::geometry::field::Field;
use billow_solver::geometry::shapes::{icosphere, moved};
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::mechanics::supports::Supports;
use billow_solver::models::film::erected;
use billow_solver::scene::paper;
use nalgebra::Vector3;

use super::{
    MODULUS, Parameter, Prepared, Runs, StabilityScene, THICKNESS, Values, Vessel, compression,
    real, whole,
};
use crate::cases::Rig;
use crate::stability::Method;

/// Radius of the bag, m.
const RADIUS: f64 = 0.2;

const OVERPRESSURE: Parameter =
    real("overpressure", 100.0, [1e-9, 1e9], "Pa", "overpressure on the inside");

/// The bag.
pub const BAG: StabilityScene = StabilityScene {
    name: "bag_statics",
    meaning: "static equilibrium of a free bag (icosphere of 0.2 m) under an overpressure",
    parameters: &[
        compression(0.0),
        THICKNESS,
        MODULUS,
        whole("level", 1.0, [0.0, 3.0], "refinements of the icosahedron"),
        real("flatness", 1.0, [0.0, 1.0], "ratio", "height at the start over that of the sphere"),
        OVERPRESSURE,
    ],
    runs: Runs::Statics,
    build: bag,
};

/// The capsule.
pub const CAPSULE: StabilityScene = StabilityScene {
    name: "capsule_statics",
    meaning: "static equilibrium of the paper's capsule on its bottom ring, from its erected shape",
    parameters: &[
        THICKNESS,
        MODULUS,
        whole("subdivisions", 2.0, [2.0, 8.0], "design.subdivisions"),
        OVERPRESSURE,
    ],
    runs: Runs::Statics,
    build: capsule,
};

fn bag(_: &Rig, _: Method, values: &Values) -> Result<Prepared, String> {
    let level = values.count("level");
    let flatness = values.get("flatness");
    // The reference of the film is the sphere.
    let shell = moved(icosphere(level, RADIUS), |x| Vector3::new(x.x, x.y, x.z * flatness));
    let model = FilmModel::of_shell(&values.film(), &shell).map_err(|error| error.to_string())?;
    let supports = Supports::none(model.nodes());
    let positions = Field::of(&shell.positions);
    let overpressure = values.get("overpressure");
    Ok(Prepared::Statics(Box::new(Vessel { model, supports, positions, overpressure })))
}

fn capsule(rig: &Rig, _: Method, values: &Values) -> Result<Prepared, String> {
    let subdivisions = values.count("subdivisions");
    let mut scene = paper::empty_capsule(subdivisions, 1.0);
    scene.film.thickness = values.get("thickness");
    scene.film.youngs_modulus = values.get("modulus");
    let capsule = erected(rig.instruction_set, &scene).map_err(|error| error.to_string())?;
    let (model, supports, positions) = (capsule.model, capsule.supports, capsule.positions);
    let overpressure = values.get("overpressure");
    Ok(Prepared::Statics(Box::new(Vessel { model, supports, positions, overpressure })))
}
