//! What the mesh error of a run may depend on, and whether the table of mesh errors covers a scene.
//!
//! ```text
//! t_g: m(t_g) R T t_g² = m_film H²       gas time: by then gas has lifted the film, if it were one mass
//! m(t): gas inside t after the release, of an empty capsule after its first gas;  gas: m_g = m(t_g)
//! wave time = r √(ρ/E);  m_film = ρ t π ((r + r₁) s + r² + r₁²),  s = √(H² + (r − r₁)²)
//! burst = ∫ max(ṁ − ṁ_last, 0) dt from the release;  ṁ_last: the last mass flow rate above 0
//! ```
//! All features are pure numbers: capsules of any size with equal ones move alike, and have equal mesh errors.
//! A scene is covered if its features lie within those of the runs that the table was made from, and all else in
//! it is as in these runs.

use std::f64::consts::PI;

use billow_solver::geometry::fold::Fit;
use billow_solver::integrators::dormand_prince::DEFAULT_TOLERANCE;
use billow_solver::scene::inflow::Schedule;
use billow_solver::scene::{ModelKind, Outputs, Scene, Stepping, Thresholds};
use serde::{Deserialize, Serialize};

use crate::input::value::short_number;

/// Fraction of the stable step of the runs of the table: the default.
pub const STEP: f64 = 0.45;

/// The step of a scene as a fraction of the stable one. The runs of the piston have its default error tolerance
/// in its place; it, and a smaller one, counts as [`STEP`].
pub fn step(scene: &Scene) -> Stepping {
    match scene.solver.stepping {
        Stepping::Adaptive(tolerance) if tolerance <= DEFAULT_TOLERANCE => Stepping::Stable(STEP),
        stepping => stepping,
    }
}

/// Number of features of a scene.
pub const FEATURES: usize = 12;

/// Names of the features, in the order of [`Features::values`]; pure numbers.
pub const FEATURE_NAMES: [&str; FEATURES] = [
    "N",
    "M",
    "top_radius over bottom_radius",
    "height over bottom_radius",
    "stowed_height over bottom_radius",
    "mass of film over gas",
    "gas time over wave time",
    "gas at the release over gas",
    "burst over gas",
    "time to inflow over gas time",
    "duration of inflow over gas time",
    "inflow_temperature over film.temperature",
];

/// An inflow that begins, or lasts, longer than these many gas times is like one of this length. Chosen: film is nearly
/// at rest by then.
const LONG: f64 = 3.0;

/// Largest relative difference of equal features: rounding.
const ROUNDING: f64 = 1e-9;

/// Whether two features are equal up to rounding.
pub fn are_equal(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING * a.abs().max(b.abs())
}

/// What the mesh error of a run may depend on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Features {
    /// The numbers, in the order of [`FEATURE_NAMES`].
    pub values: [f64; FEATURES],
}

impl Features {
    /// The features of a scene. `top_radius` and `height` (m) are those of its solved pattern. `None` of film from a mesh.
    pub fn of(scene: &Scene, top_radius: f64, height: f64) -> Option<Self> {
        let (design, film, gas) = (scene.design.folded().ok()?, &scene.film, &scene.gas);
        let radius = design.bottom_radius;
        let slant = libm::hypot(height, radius - top_radius);
        let area = PI * ((radius + top_radius) * slant + radius * radius + top_radius * top_radius);
        let film_mass = film.area_density() * area;
        let schedule = Schedule::new(&gas.windows);
        let times = schedule.change_times();
        let intervals = || times.windows(2).map(|pair| [pair[0], pair[1]]);
        let rate = |[from, to]: [f64; 2]| schedule.between(from, to).mass_flow_rate;
        let flows = |interval: &[f64; 2]| rate(*interval) > 0.0;
        let release = scene.release_time;
        let inside = |time: f64| gas.initial_mass + schedule.mass_until(time);
        let first = intervals().filter(flows).find(|[_, to]| *to > release);
        let inflow = first.map_or(release, |[from, _]| from.max(release));
        // An empty capsule waits for its gas.
        let start = if inside(release) > 0.0 { release } else { inflow };
        let temperature = gas.windows.last().map_or(film.temperature, |window| window.temperature);
        let square = film_mass * height * height / (gas.species.gas_constant * temperature);
        let gas_time = time_of(square, |time| inside(start + time));
        let gas_mass = square / (gas_time * gas_time);
        let last = intervals().map(rate).rfind(|rate| *rate > 0.0).unwrap_or(0.0);
        let burst = intervals().map(|[from, to]| {
            let length = (to - from.max(release)).max(0.0);
            (rate([from, to]) - last).max(0.0) * length
        });
        let burst: f64 = burst.sum();
        let stop = intervals().filter(flows).map(|[_, to]| to).fold(inflow, f64::max);
        // Windows are cut at the end of the run.
        let stop = if stop >= scene.solver.end_time { f64::INFINITY } else { stop };
        let duration = if first.is_some() { stop - inflow } else { 0.0 };
        let long = |time: f64| (time / gas_time).min(LONG);
        Some(Self {
            values: [
                f64::from(design.panels),
                f64::from(design.storeys),
                top_radius / radius,
                height / radius,
                design.stowed_height / radius,
                film_mass / gas_mass,
                gas_time / (radius * (film.density / film.youngs_modulus).sqrt()),
                inside(release) / gas_mass,
                burst / gas_mass,
                long(inflow - start),
                long(duration),
                temperature / film.temperature,
            ],
        })
    }
}

/// The time t with m(t) t² = `square` (kg s²); without gas a long one, s. m: mass inside, kg, which never falls.
fn time_of(square: f64, mass: impl Fn(f64) -> f64) -> f64 {
    let [mut least, mut most] = [-40.0, 20.0];
    for _ in 0..64 {
        let middle = 0.5 * (least + most);
        let time = libm::exp(middle);
        if mass(time) * time * time < square {
            least = middle;
        } else {
            most = middle;
        }
    }
    libm::exp(most)
}

/// The scenes that the table covers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// Smallest and largest value of each feature.
    pub ranges: Vec<FeatureRange>,
    /// A scene of the runs; all that is no feature must be as in it.
    pub scene: Scene,
}

/// The range of one feature over the runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FeatureRange {
    /// Name of the feature, from [`FEATURE_NAMES`].
    pub name: String,
    /// Smallest value.
    pub least: f64,
    /// Largest value.
    pub largest: f64,
}

impl Coverage {
    /// The coverage of these runs; `None` without any.
    pub fn of<'a>(runs: impl IntoIterator<Item = (&'a Scene, Features)>) -> Option<Self> {
        let mut runs = runs.into_iter();
        let (scene, first) = runs.next()?;
        let mut ranges = first.values.map(|value| [value; 2]);
        for (_, features) in runs {
            for (range, value) in ranges.iter_mut().zip(features.values) {
                *range = [range[0].min(value), range[1].max(value)];
            }
        }
        let named = FEATURE_NAMES.iter().zip(ranges).map(|(name, [least, largest])| FeatureRange {
            name: (*name).to_owned(),
            least,
            largest,
        });
        Some(Self { ranges: named.collect(), scene: scene.clone() })
    }

    /// Why a scene is not covered; `None` if it is.
    pub fn gap(&self, scene: &Scene, features: &Features) -> Option<String> {
        let [given, runs] = [scene, &self.scene].map(without_features);
        if given != runs {
            let [given, runs] =
                [&given, &runs].map(|scene| serde_json::to_value(scene).unwrap_or_default());
            if let Some(difference) = different_key(&given, &runs) {
                return Some(difference);
            }
        }
        for (range, value) in self.ranges.iter().zip(features.values) {
            let width = ROUNDING * range.largest.abs();
            if value < range.least - width || value > range.largest + width {
                let [value, least, largest] = [value, range.least, range.largest].map(short_number);
                let (name, runs) = (&range.name, format!("{least} to {largest}"));
                return Some(format!("{name} {value}: the runs of the table have {runs}"));
            }
        }
        None
    }
}

/// A scene without its features and without what changes no error.
fn without_features(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let Ok(design) = scene.design.folded_mut() else { return scene };
    design.fit = Fit::Cone;
    design.panels = 0;
    design.storeys = 0;
    design.bottom_radius = 1.0;
    design.stowed_height = 1.0;
    design.subdivisions = 0;
    for length in [
        &mut design.top_radius,
        &mut design.height,
        &mut design.half_angle,
        &mut design.alpha1_over_phi,
    ] {
        *length = None;
    }
    let film = &mut scene.film;
    (film.youngs_modulus, film.density, film.thickness) = (1.0, 1.0, 1.0);
    film.temperature = 1.0;
    scene.gas.windows.clear();
    scene.gas.initial_mass = 0.0;
    scene.release_time = 0.0;
    scene.seed = 1;
    scene.solver.end_time = 1.0;
    scene.solver.step_limit = 1;
    scene.solver.stepping = step(&scene);
    scene.outputs = Outputs { sample_interval: 1.0, frames: 0, thresholds: Thresholds::default() };
    scene.solver.model = ModelKind::Film;
    scene
}

/// The first key in which two scenes differ, as text; `None` if they do not.
fn different_key(scene: &serde_json::Value, runs: &serde_json::Value) -> Option<String> {
    use serde_json::Value::Object;
    match (scene, runs) {
        (Object(a), Object(b)) => {
            let mut keys: Vec<&String> = a.keys().chain(b.keys()).collect();
            keys.sort();
            keys.dedup();
            keys.into_iter().find_map(|key| {
                let [a, b] =
                    [a, b].map(|object| object.get(key).unwrap_or(&serde_json::Value::Null));
                let difference = different_key(a, b)?;
                if key == "species" {
                    return Some("species: the runs of the table have nitrogen".to_owned());
                }
                // A study has the key solver.cfl, and solver.stepping only for a step of the piston.
                if key == "stepping" && difference.starts_with("cfl") {
                    return Some(difference);
                }
                let joint = if difference.starts_with(' ') { "" } else { "." };
                // Stored names are part of job ids.
                let key = match key.as_str() {
                    "viscosity" => "numerical_damping",
                    "stable" => "cfl",
                    "stowed_height" => "stowed_height over bottom_radius",
                    key => key,
                };
                Some(format!("{key}{joint}{difference}"))
            })
        }
        _ if same(scene, runs) => None,
        _ => {
            let text = |value: &serde_json::Value| match value.as_f64() {
                Some(number) => short_number(number),
                _ if value.is_null() => "none".to_owned(),
                _ => value.to_string(),
            };
            let [given, known] = [scene, runs].map(text);
            // Numbers that differ by less than six digits show are shown with all of them.
            let [given, known] = if given == known {
                [scene, runs].map(ToString::to_string)
            } else {
                [given, known]
            };
            Some(format!(" {given}: the runs of the table have {known}"))
        }
    }
}

fn same(a: &serde_json::Value, b: &serde_json::Value) -> bool {
    match (a.as_f64(), b.as_f64()) {
        (Some(a), Some(b)) => are_equal(a, b),
        _ => a == b,
    }
}
