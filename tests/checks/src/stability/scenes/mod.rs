//! The small scenes of the map, and the parameters that a map may vary in each.

use std::collections::BTreeMap;

use billow_solver::geometry::field::Field;
use billow_solver::system::FilmSystem;

use super::Method;
use crate::cases::prelude::*;

mod capsule;
mod film;
mod vessel;

/// A parameter of a scene.
pub(super) struct Parameter {
    pub(super) name: &'static str,
    /// Value where a map gives none.
    default: f64,
    /// Unit, or what a number without unit is.
    unit: &'static str,
    pub(super) meaning: &'static str,
}

impl Parameter {
    /// Name and unit, for an axis.
    pub(super) fn label(&self) -> String {
        format!("{} ({})", self.name, self.unit)
    }
}

const fn parameter(
    name: &'static str,
    default: f64,
    unit: &'static str,
    meaning: &'static str,
) -> Parameter {
    Parameter { name, default, unit, meaning }
}

const STEP: Parameter =
    parameter("step", 0.45, "CFL number", "step over the stable step of the element bound");
const DAMPING: Parameter = parameter("damping", 0.0, "ratio", "film.numerical_damping");
const THICKNESS: Parameter = parameter("thickness", 25.4e-6, "m", "film.thickness");
const MODULUS: Parameter = parameter("modulus", 3.45e9, "Pa", "film.youngs_modulus");
const CONTACT_STIFFNESS: Parameter = parameter(
    "contact_stiffness",
    1.0,
    "ratio",
    "stiffness of contact over the one chosen for the step",
);

const fn compression(default: f64) -> Parameter {
    parameter("compression", default, "ratio", "film.compression")
}

/// The values of the parameters of a scene.
pub(super) struct Values(pub(super) BTreeMap<&'static str, f64>);

impl Values {
    /// Some values of a scene, and its defaults for the others.
    pub(super) fn of<'a>(
        scene: &StabilityScene,
        given: impl Iterator<Item = (&'a String, &'a f64)>,
    ) -> Self {
        let defaults = scene.parameters.iter().map(|parameter| (parameter.name, parameter.default));
        let mut values: BTreeMap<&str, f64> = defaults.collect();
        for (name, value) in given {
            if let Some(parameter) = scene.parameter(name) {
                values.insert(parameter.name, *value);
            }
        }
        Self(values)
    }

    /// The value of a parameter that the scene has.
    pub(super) fn get(&self, name: &str) -> f64 {
        self.0[name]
    }

    /// The value of a parameter of whole numbers.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 8")]
    fn count(&self, name: &str) -> u32 {
        self.get(name) as u32
    }

    /// The elastic film of the values, without loss.
    fn film(&self) -> Film {
        let value = |name: &str, default: f64| self.0.get(name).copied().unwrap_or(default);
        let film = Film::PAPER_ELASTIC;
        Film {
            // A scene without motion has none.
            numerical_damping: value("damping", 0.0),
            compression: value("compression", film.compression),
            thickness: self.get("thickness"),
            youngs_modulus: self.get("modulus"),
            ..film
        }
    }
}

/// A scene that is ready to run.
pub(super) enum Prepared {
    /// Film, its times, and ω of its fastest mode (rad/s) if it is linear.
    Film(Box<FilmRun>, Timeline, Option<f64>),
    /// A capsule for a model without film.
    Model(Box<Scene>),
    /// Film under an overpressure, and its positions at the start, m, for the static solver.
    Statics(Box<FilmSystem>, Field),
}

/// A scene of the map.
pub(super) struct StabilityScene {
    pub(super) name: &'static str,
    /// What it is, one line.
    pub(super) meaning: &'static str,
    pub(super) parameters: &'static [Parameter],
    /// Whether a method can run it.
    runs: fn(Method) -> bool,
    /// The scene with a method that can run it, and values.
    pub(super) prepare: fn(&Rig, Method, &Values) -> Result<Prepared>,
}

impl StabilityScene {
    /// The parameter of a name.
    pub(super) fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }

    /// The methods that can run it.
    pub(super) fn methods(&self) -> Vec<Method> {
        Method::all().filter(|method| (self.runs)(*method)).collect()
    }
}

/// Every scene.
pub(super) const SCENES: [&StabilityScene; 6] =
    [&film::SHEET, &film::BAG, &film::FILMS, &capsule::SCENE, &vessel::BAG, &vessel::CAPSULE];
