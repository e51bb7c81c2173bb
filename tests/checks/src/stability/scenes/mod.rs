//! The small scenes of the map, and the parameters that a map may vary in each.

use billow_solver::geometry::field::Field;
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::mechanics::supports::Supports;
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
mod vessel;

/// Raised when a scene changes: cells of other versions run again.
pub const VERSION: u32 = 2;

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
    /// Unit, or what a number without unit is.
    pub unit: &'static str,
    /// Meaning.
    pub meaning: &'static str,
}

impl Parameter {
    /// Name and unit, for an axis.
    pub fn label(&self) -> String {
        format!("{} ({})", self.name, self.unit)
    }
}

/// A parameter of real numbers.
const fn real(
    name: &'static str,
    default: f64,
    range: [f64; 2],
    unit: &'static str,
    meaning: &'static str,
) -> Parameter {
    Parameter { name, default, range, whole: false, unit, meaning }
}

/// A parameter of whole numbers.
const fn whole(
    name: &'static str,
    default: f64,
    range: [f64; 2],
    meaning: &'static str,
) -> Parameter {
    Parameter { name, default, range, whole: true, unit: "number", meaning }
}

const STEP: Parameter =
    real("step", 0.45, [0.01, 4.0], "CFL number", "step over the stable step of the element bound");
const DAMPING: Parameter = real("damping", 0.0, [0.0, 10.0], "ratio", "film.numerical_damping");
const THICKNESS: Parameter = real("thickness", 25.4e-6, [1e-7, 1e-1], "m", "film.thickness");
const MODULUS: Parameter = real("modulus", 3.45e9, [1e3, 1e14], "Pa", "film.youngs_modulus");
const CONTACT_STIFFNESS: Parameter = real(
    "contact_stiffness",
    1.0,
    [1e-6, 1e6],
    "ratio",
    "stiffness of contact over the one chosen for the step",
);

const fn compression(default: f64) -> Parameter {
    real("compression", default, [0.0, 1.0], "ratio", "film.compression")
}

/// The modulus of one of two parts of film over that of the other one. Not above 1: the stiff part bounds the step.
const fn soft(meaning: &'static str) -> Parameter {
    real("soft", 1.0, [1e-9, 1.0], "ratio", meaning)
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
        self.find(name).unwrap_or(f64::NAN)
    }

    /// The value of a parameter, if the scene has it.
    fn find(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }

    /// The value of a parameter of whole numbers, within its range.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 8")]
    fn count(&self, name: &str) -> u32 {
        self.get(name) as u32
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
            // A scene without motion has none.
            numerical_damping: self.find("damping").unwrap_or(0.0),
            compression: self.get("compression"),
            thickness: self.get("thickness"),
            youngs_modulus: self.get("modulus"),
            ..Film::PAPER_ELASTIC
        }
    }
}

/// The methods that can run a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Runs {
    /// Every integrator of film.
    Film,
    /// Every integrator of film, and the models without film.
    FilmAndModels,
    /// The search for a static equilibrium.
    Statics,
}

/// Film whose static equilibrium is searched.
pub struct Vessel {
    /// The film.
    pub model: FilmModel,
    /// Its supports.
    pub supports: Supports,
    /// Positions at the start, m.
    pub positions: Field,
    /// Overpressure, Pa.
    pub overpressure: f64,
}

/// A scene that is ready to run.
pub enum Prepared {
    /// Film, its times, and ω of its fastest mode (rad/s) if it is linear.
    Film(Box<FilmRun>, Timeline, Option<f64>),
    /// A capsule for a model without film.
    Model(Box<Scene>),
    /// Film for the static solver.
    Statics(Box<Vessel>),
}

/// A scene of the map.
pub struct StabilityScene {
    /// Name.
    pub name: &'static str,
    /// What it is, one line.
    pub meaning: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// What can run it.
    pub runs: Runs,
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
        let can = |method: &Method| match method {
            Method::Film(_) => self.runs != Runs::Statics,
            Method::Piston | Method::Storeys => self.runs == Runs::FilmAndModels,
            Method::Statics => self.runs == Runs::Statics,
        };
        Method::all().into_iter().filter(can).collect()
    }
}

/// Every scene.
pub const SCENES: [&StabilityScene; 6] =
    [&sheet::SCENE, &bag::SCENE, &films::SCENE, &capsule::SCENE, &vessel::BAG, &vessel::CAPSULE];

/// The scene of a name.
pub fn find(name: &str) -> Option<&'static StabilityScene> {
    SCENES.into_iter().find(|scene| scene.name == name)
}
