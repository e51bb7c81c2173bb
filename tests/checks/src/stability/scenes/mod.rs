//! The small scenes of the map, and the parameters that a map may vary in each.

use billow_solver::geometry::field::Field;
use billow_solver::system::FilmSystem;

use super::Method;
use crate::cases::prelude::*;

mod capsule;
mod film;
mod stiffness;
mod vessel;

/// Raised when a scene changes: cells of other versions run again.
pub(super) const VERSION: u32 = 2;

/// A parameter of a scene.
pub(super) struct Parameter {
    pub(super) name: &'static str,
    /// Value where a map gives none.
    default: f64,
    /// Smallest and largest value.
    range: [f64; 2],
    /// Whether only whole numbers are values.
    pub(super) whole: bool,
    /// Unit, or what a number without unit is.
    unit: &'static str,
    pub(super) meaning: &'static str,
}

impl Parameter {
    /// Name and unit, for an axis.
    pub(super) fn label(&self) -> String {
        format!("{} ({})", self.name, self.unit)
    }

    /// Whether it can have this value.
    pub(super) fn allows(&self, value: f64) -> bool {
        (self.range[0]..=self.range[1]).contains(&value) && !(self.whole && value.fract() != 0.0)
    }

    /// The values that it can have, in words.
    pub(super) fn allowed(&self) -> String {
        let whole = if self.whole { "whole number" } else { "number" };
        format!("a {whole} from {} to {} ({})", self.range[0], self.range[1], self.unit)
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

/// The values of the parameters of a scene, in the order of its list.
pub(super) struct Values(pub(super) Vec<(&'static str, f64)>);

impl Values {
    /// The defaults of a scene.
    pub(super) fn of(scene: &StabilityScene) -> Self {
        Self(scene.parameters.iter().map(|parameter| (parameter.name, parameter.default)).collect())
    }

    /// The value of a parameter; NaN for one that the scene does not have.
    pub(super) fn get(&self, name: &str) -> f64 {
        self.find(name).unwrap_or(f64::NAN)
    }

    fn find(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }

    /// The value of a parameter of whole numbers, within its range.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 8")]
    fn count(&self, name: &str) -> u32 {
        self.get(name) as u32
    }

    /// Sets a parameter that the scene has.
    pub(super) fn set(&mut self, name: &str, value: f64) {
        for (_, old) in self.0.iter_mut().filter(|(known, _)| *known == name) {
            *old = value;
        }
    }

    /// The elastic film of the values, without loss.
    fn film(&self) -> Film {
        Film {
            // A scene without motion has none.
            numerical_damping: self.find("damping").unwrap_or(0.0),
            compression: self.find("compression").unwrap_or(Film::PAPER_ELASTIC.compression),
            thickness: self.get("thickness"),
            youngs_modulus: self.get("modulus"),
            ..Film::PAPER_ELASTIC
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

/// Which methods can run a scene, and what prepares it for them.
enum Build {
    /// Every integrator of film.
    Film(fn(&Rig, IntegratorKind, &Values) -> Result<Prepared>),
    /// Every integrator of film, and the models without film.
    FilmAndModels(fn(&Rig, Method, &Values) -> Result<Prepared>),
    /// The search for a static equilibrium.
    Statics(fn(&Rig, &Values) -> Result<Prepared>),
}

/// A scene of the map.
pub(super) struct StabilityScene {
    pub(super) name: &'static str,
    /// What it is, one line.
    pub(super) meaning: &'static str,
    pub(super) parameters: &'static [Parameter],
    build: Build,
}

impl StabilityScene {
    /// The parameter of a name.
    pub(super) fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }

    /// The methods that can run it.
    pub(super) fn methods(&self) -> Vec<Method> {
        let can = |method: &Method| match self.build {
            Build::Film(_) => matches!(method, Method::Film(_)),
            Build::FilmAndModels(_) => *method != Method::Statics,
            Build::Statics(_) => *method == Method::Statics,
        };
        Method::all().filter(can).collect()
    }

    /// The scene with a method and values.
    pub(super) fn prepare(&self, rig: &Rig, method: Method, values: &Values) -> Result<Prepared> {
        match (&self.build, method) {
            (Build::Film(build), Method::Film(kind)) => build(rig, kind, values),
            (Build::FilmAndModels(build), _) => build(rig, method, values),
            (Build::Statics(build), Method::Statics) => build(rig, values),
            _ => Err(format!("{} cannot run the scene {}", method.name(), self.name).into()),
        }
    }
}

/// Every scene.
pub(super) const SCENES: [&StabilityScene; 6] =
    [&film::SHEET, &film::BAG, &film::FILMS, &capsule::SCENE, &vessel::BAG, &vessel::CAPSULE];
