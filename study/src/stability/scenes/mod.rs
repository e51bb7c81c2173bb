//! The small scenes of the map, and the parameters that a map may vary in each.

use billow_solver::models::film::FilmRun;
use billow_solver::scene::timeline::Timeline;
use billow_solver::scene::{Film, Scene};

use super::Method;
use crate::cases::Rig;

mod bag;
mod capsule;
mod film;
mod films;
mod sheet;

/// Raised when a scene changes: cells of other versions run again.
pub const VERSION: u32 = 1;

/// A parameter of a scene.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Name.
    pub name: &'static str,
    /// Value where a map gives none.
    pub default: f64,
    /// Smallest and largest value.
    pub range: [f64; 2],
    /// Whether only whole numbers are values.
    pub whole: bool,
    /// Unit and meaning.
    pub meaning: &'static str,
}

/// A parameter of real numbers.
const fn real(
    name: &'static str,
    default: f64,
    range: [f64; 2],
    meaning: &'static str,
) -> Parameter {
    Parameter { name, default, range, whole: false, meaning }
}

/// A parameter of whole numbers.
const fn whole(
    name: &'static str,
    default: f64,
    range: [f64; 2],
    meaning: &'static str,
) -> Parameter {
    Parameter { name, default, range, whole: true, meaning }
}

const STEP: Parameter =
    real("step", 0.45, [0.01, 4.0], "step over the stable step of the element bound (CFL number)");
const DAMPING: Parameter = real("damping", 0.0, [0.0, 10.0], "film.numerical_damping");
const THICKNESS: Parameter = real("thickness", 25.4e-6, [1e-7, 1e-1], "film.thickness, m");
const MODULUS: Parameter = real("modulus", 3.45e9, [1e3, 1e14], "film.youngs_modulus, Pa");
const CONTACT_STIFFNESS: Parameter = real(
    "contact_stiffness",
    1.0,
    [1e-6, 1e6],
    "stiffness of contact over the one chosen for the step",
);

const fn compression(default: f64) -> Parameter {
    real("compression", default, [0.0, 1.0], "film.compression")
}

/// The values of the parameters of a scene, in the order of its list.
#[derive(Debug, Clone, PartialEq)]
pub struct Values(pub Vec<(&'static str, f64)>);

impl Values {
    /// The defaults of a scene.
    pub fn of(scene: &StabilityScene) -> Self {
        Self(scene.parameters.iter().map(|parameter| (parameter.name, parameter.default)).collect())
    }

    /// The value of a parameter; NaN for one that the scene does not have.
    pub fn get(&self, name: &str) -> f64 {
        self.0.iter().find(|(known, _)| *known == name).map_or(f64::NAN, |(_, value)| *value)
    }

    /// Sets a parameter that the scene has.
    pub fn set(&mut self, name: &str, value: f64) {
        for (known, old) in &mut self.0 {
            if *known == name {
                *old = value;
            }
        }
    }

    /// The elastic film of the values, without loss.
    fn film(&self) -> Film {
        Film {
            numerical_damping: self.get("damping"),
            compression: self.get("compression"),
            thickness: self.get("thickness"),
            youngs_modulus: self.get("modulus"),
            ..Film::PAPER_ELASTIC
        }
    }
}

/// A scene that is ready to run.
pub enum Prepared {
    /// Film, its times, and ω of its fastest mode (rad/s) if it is linear.
    Film(Box<FilmRun>, Timeline, Option<f64>),
    /// A capsule for a model without film.
    Model(Box<Scene>),
}

/// A scene of the map.
pub struct StabilityScene {
    /// Name.
    pub name: &'static str,
    /// What it is, one line.
    pub meaning: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// Whether models without film can run it.
    pub models: bool,
    /// Prepares it.
    pub build: fn(&Rig, Method, &Values) -> Result<Prepared, String>,
}

impl StabilityScene {
    /// The parameter of a name.
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }

    /// The methods that can run it.
    pub fn methods(&self) -> Vec<Method> {
        let film = |method: &Method| matches!(method, Method::Film(_));
        Method::all().into_iter().filter(|method| self.models || film(method)).collect()
    }
}

/// Every scene.
pub const SCENES: [&StabilityScene; 4] =
    [&sheet::SCENE, &bag::SCENE, &films::SCENE, &capsule::SCENE];

/// The scene of a name.
pub fn find(name: &str) -> Option<&'static StabilityScene> {
    SCENES.into_iter().find(|scene| scene.name == name)
}
