//! Film under a fixed overpressure, for the static solver: a bag from any flatness, and the paper's erected capsule.

use billow_solver::geometry::field::Field;
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::models::film::erected;
use billow_solver::system::{FilmSystem, PressureLoad};

use super::film::flattened_bag;
use super::{
    MODULUS, Parameter, Prepared, StabilityScene, THICKNESS, Values, compression, parameter,
};
use crate::cases::prelude::*;
use crate::stability::Method;

const OVERPRESSURE: Parameter =
    parameter("overpressure", 100.0, "Pa", "overpressure on the inside");

/// The bag.
pub(super) const BAG: StabilityScene = StabilityScene {
    name: "bag_statics",
    meaning: "static equilibrium of a free bag (icosphere of 0.2 m) under an overpressure",
    parameters: &[
        compression(0.0),
        THICKNESS,
        MODULUS,
        parameter("level", 1.0, "number", "refinements of the icosahedron"),
        parameter("flatness", 1.0, "ratio", "height at the start over that of the sphere"),
        OVERPRESSURE,
    ],
    runs: |method| method == Method::Statics,
    prepare: bag,
};

/// The capsule.
pub(super) const CAPSULE: StabilityScene = StabilityScene {
    name: "capsule_statics",
    meaning: "static equilibrium of the paper's capsule on its bottom ring, from its erected shape",
    parameters: &[
        THICKNESS,
        MODULUS,
        parameter("subdivisions", 2.0, "number", "design.subdivisions"),
        OVERPRESSURE,
    ],
    runs: |method| method == Method::Statics,
    prepare: capsule,
};

fn bag(_: &Rig, _: Method, values: &Values) -> Result<Prepared> {
    let shell = flattened_bag(values);
    let model = FilmModel::of_shell(&values.film(), &shell)?;
    let load = PressureLoad::Overpressure(values.get("overpressure"));
    let positions = Field::of(&shell.positions);
    Ok(Prepared::Statics(Box::new(FilmSystem::free(model, load)), positions))
}

fn capsule(rig: &Rig, _: Method, values: &Values) -> Result<Prepared> {
    let mut scene = paper::empty_capsule(values.count("subdivisions"), 1.0);
    scene.film.thickness = values.get("thickness");
    scene.film.youngs_modulus = values.get("modulus");
    let capsule = erected(rig.instruction_set, &scene)?;
    let load = PressureLoad::Overpressure(values.get("overpressure"));
    let film = FilmSystem { supports: capsule.supports, ..FilmSystem::free(capsule.model, load) };
    Ok(Prepared::Statics(Box::new(film), capsule.positions))
}
