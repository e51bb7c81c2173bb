//! From the settings of a point to its scene.

use billow_solver::fold::{Caps, Chirality, Fit, FoldDesign, FoldError, FoldPattern};
use billow_solver::scene::{
    Contact, Film, GasSupply, HeatTransfer, InflowWindow, ModelKind, Outputs, Scene, Solver,
    Species, Stepping, Thresholds,
};

use super::base::{Base, Settings};
use super::source::{Source, shown};
use super::strategy::Strategy;
use crate::error::InputError;
use crate::keys::{self, KEYS, Key, STRATEGY_KEYS, WINDOW_KEYS};
use crate::point::Infeasible;
use crate::value::Value;

/// A design's pattern, or why it has none.
#[derive(Debug)]
pub(super) enum Fold {
    Solved(Box<FoldPattern>),
    Infeasible(Infeasible),
    /// The request contradicts itself.
    Invalid {
        key: &'static str,
        problem: String,
    },
}

/// Solves a design.
pub(super) fn fold(design: &FoldDesign) -> Fold {
    match FoldPattern::new(design) {
        Ok(pattern) => Fold::Solved(Box::new(pattern)),
        Err(FoldError::Infeasible { reason, nearest }) => {
            Fold::Infeasible(Infeasible { reason, nearest })
        }
        Err(FoldError::Invalid { key, problem }) => Fold::Invalid { key, problem },
    }
}

/// The bits of a design, to find one solved before.
pub(super) type DesignKey = [u64; 12];

/// The key of a design.
pub(super) fn design_key(design: &FoldDesign) -> DesignKey {
    // No key allows the value NaN, so its bits are free to mean absent.
    let bits = |value: Option<f64>| value.unwrap_or(f64::NAN).to_bits();
    [
        design.fit as u64,
        design.panels.into(),
        design.storeys.into(),
        design.bottom_radius.to_bits(),
        bits(design.top_radius),
        bits(design.height),
        bits(design.half_angle),
        bits(design.alpha1_over_phi),
        design.chirality as u64,
        design.stowed_height.to_bits(),
        design.subdivisions.into(),
        design.caps as u64,
    ]
}

fn missing(path: &str, source: &Source) -> InputError {
    let key = keys::index(path).map(|at| &KEYS[at]);
    let leaf = key.map_or(path, |key| key.leaf());
    let allowed = key.map_or_else(String::new, Key::allowed);
    let mut error = source.error(path, "", "missing", allowed);
    error.hint = format!("give it here, or vary {leaf} under grid");
    error
}

fn number(settings: &Settings, path: &str, source: &Source) -> Result<f64, InputError> {
    settings.number(path).ok_or_else(|| missing(path, source))
}

fn whole(settings: &Settings, path: &str, source: &Source) -> Result<u32, InputError> {
    let number = settings.integer(path).and_then(|number| u32::try_from(number).ok());
    number.ok_or_else(|| missing(path, source))
}

/// The fold design of a point.
pub(super) fn design(settings: &Settings, source: &Source) -> Result<FoldDesign, InputError> {
    Ok(FoldDesign {
        fit: match settings.text("design.fit") {
            "angles" => Fit::Angles,
            "height" => Fit::Height,
            _ => Fit::Cone,
        },
        panels: whole(settings, "design.N", source)?,
        storeys: whole(settings, "design.M", source)?,
        bottom_radius: number(settings, "design.bottom_radius", source)?,
        top_radius: settings.number("design.top_radius"),
        height: settings.number("design.height"),
        half_angle: settings.number("design.half_angle"),
        alpha1_over_phi: settings.number("design.alpha1_over_phi"),
        chirality: match settings.text("design.chirality") {
            "alternate" => Chirality::Alternate,
            _ => Chirality::Same,
        },
        stowed_height: number(settings, "design.stowed_height", source)?,
        subdivisions: whole(settings, "design.subdivisions", source)?,
        caps: Caps::Polygon,
    })
}

/// Most samples of one run: more would be a slip of the unit.
const MOST_SAMPLES: f64 = 1e6;

/// The scene of a point.
pub(super) fn scene(
    point: &Base,
    design: FoldDesign,
    source: &Source,
) -> Result<Scene, InputError> {
    let settings = &point.settings;
    let get = |path: &str| number(settings, path, source);
    let end_time = get("solver.end_time")?;
    let sample_interval = get("outputs.sample_interval")?;
    if end_time / sample_interval > MOST_SAMPLES {
        return Err(source.error(
            "outputs.sample_interval",
            &shown(sample_interval),
            format!("samples a run of {end_time} s more than {MOST_SAMPLES:.0} times"),
            format!("at least {} s for this end_time", shown(end_time / MOST_SAMPLES)),
        ));
    }
    let name = settings.text("strategy");
    let Some(strategy) = point.strategies.get(name) else {
        point.check_strategy(name, "strategy", source)?;
        return Err(missing("strategy", source));
    };
    let release_time = strategy_number(strategy, "release_time");
    if release_time >= end_time {
        return Err(source.error(
            &format!("strategies.{name}.release_time"),
            &shown(release_time),
            "the run ends before the capsule is released",
            format!("below solver.end_time, {end_time} s"),
        ));
    }
    let residual = get("gas.residual_gas_mass")?;
    let stored = settings.text("gas.residual_gas") == "stored";
    let windows = windows(point, name, strategy, if stored { 0.0 } else { residual }, source)?;
    Ok(Scene {
        design,
        film: Film {
            youngs_modulus: get("film.youngs_modulus")?,
            poisson_ratio: get("film.poisson_ratio")?,
            density: get("film.density")?,
            thickness: get("film.thickness")?,
            compression: get("film.compression")?,
            viscosity: get("film.viscosity")?,
            temperature: get("film.temperature")?,
        },
        gas: GasSupply {
            species: species(settings, source)?,
            initial_mass: strategy_number(strategy, "preinflation_mass")
                + if stored { residual } else { 0.0 },
            windows,
            ambient_pressure: get("gas.ambient_pressure")?,
            heat_transfer: match settings.get("gas.heat_transfer") {
                Value::Number(coefficient) => HeatTransfer::Coefficient(*coefficient),
                Value::Text(word) if word == "isothermal" => HeatTransfer::Isothermal,
                _ => HeatTransfer::Coefficient(0.0),
            },
            leak_area: get("gas.leak_area")?,
            discharge_coefficient: get("gas.discharge_coefficient")?,
        },
        supports: point.supports.clone(),
        contact: Contact {
            distance: settings.number("contact.distance"),
            friction: get("contact.friction")?,
            adhesion: get("contact.adhesion")?,
        },
        gravity: get("gravity")?,
        release_time,
        solver: Solver {
            model: ModelKind::Piston,
            end_time,
            stepping: match settings.number("solver.stepping.fixed") {
                Some(step) => Stepping::Fixed(step),
                None => Stepping::Adaptive(get("solver.stepping.adaptive")?),
            },
            step_limit: unsigned(settings, "solver.step_limit", source)?,
        },
        outputs: Outputs {
            sample_interval,
            thresholds: Thresholds {
                deployed_volume: get("outputs.thresholds.deployed_volume")?,
                deployed_height: get("outputs.thresholds.deployed_height")?,
                stalled_volume: get("outputs.thresholds.stalled_volume")?,
                close_margin: get("outputs.thresholds.close_margin")?,
            },
        },
        seed: unsigned(settings, "seed", source)?,
    })
}

fn unsigned(settings: &Settings, path: &str, source: &Source) -> Result<u64, InputError> {
    let number = settings.integer(path).and_then(|number| u64::try_from(number).ok());
    number.ok_or_else(|| missing(path, source))
}

/// The value of a strategy's own key; those all have defaults.
fn strategy_number(strategy: &Strategy, name: &str) -> f64 {
    match STRATEGY_KEYS.iter().position(|key| key.path == name).map(|at| &strategy.values[at]) {
        Some(Value::Number(number)) => *number,
        _ => 0.0,
    }
}

/// Inflow windows in order of time. What lets nothing in before the end is left out, and what runs
/// on beyond the end is cut there, so that equal physics is the same job.
fn windows(
    point: &Base,
    name: &str,
    strategy: &Strategy,
    burst_mass: f64,
    source: &Source,
) -> Result<Vec<InflowWindow>, InputError> {
    let settings = &point.settings;
    let end_time = number(settings, "solver.end_time", source)?;
    let release_time = strategy_number(strategy, "release_time");
    let inflow_temperature = number(settings, "gas.inflow_temperature", source)?;
    let mut windows = Vec::new();
    if burst_mass > 0.0 {
        let rate = number(settings, "gas.burst_rate", source)?;
        windows.push(InflowWindow {
            from: release_time,
            to: release_time + burst_mass / rate,
            rate,
            temperature: inflow_temperature,
        });
    }
    for (index, values) in strategy.inflow.iter().enumerate() {
        let get = |name: &str| {
            let at = WINDOW_KEYS.iter().position(|key| key.path == name)?;
            match &values[at] {
                Value::Number(number) => Some(*number),
                _ => None,
            }
        };
        let from = get("from").unwrap_or(release_time);
        let to = get("to").unwrap_or(end_time.max(from));
        if to <= from && (to < from || get("to").is_some()) {
            return Err(source.error(
                &format!("strategies.{name}.inflow[{index}].to"),
                &shown(to),
                "the window ends before it begins",
                format!("above its `from`, {from} s"),
            ));
        }
        let rate = match get("rate") {
            Some(rate) => rate,
            None => number(settings, "gas.mass_flow_rate", source)?,
        };
        windows.push(InflowWindow {
            from,
            to,
            rate,
            temperature: get("temperature").unwrap_or(inflow_temperature),
        });
    }
    for window in &mut windows {
        window.to = window.to.min(end_time);
    }
    windows.retain(|window| window.rate > 0.0 && window.from < window.to);
    windows.sort_by(|a, b| {
        a.from
            .total_cmp(&b.from)
            .then(a.to.total_cmp(&b.to))
            .then(a.rate.total_cmp(&b.rate))
            .then(a.temperature.total_cmp(&b.temperature))
    });
    Ok(windows)
}

/// The named species: ideal gases, R = 8.314462618 J/(mol K) over the molar mass (CODATA 2018), cp
/// at 300 K and low pressure (NIST-JANAF; air: dry air). Nitrogen is that of the reference cases.
const SPECIES: [(&str, f64, f64); 6] = [
    ("nitrogen", 296.803_052, 1_038.810_68),
    ("air", 287.055, 1_005.0),
    ("helium", 2_077.264, 5_193.16),
    ("argon", 208.132, 520.33),
    ("carbon_dioxide", 188.924, 846.0),
    ("hydrogen", 4_124.48, 14_310.0),
];

/// The named species, or the gas of its own; a constant given beside a name takes its place.
fn species(settings: &Settings, source: &Source) -> Result<Species, InputError> {
    let name = settings.maybe_text("gas.species");
    let named = SPECIES.iter().find(|(known, ..)| name == Some(*known));
    let pick = |path: &str, named: Option<f64>| {
        settings.number(path).or(named).ok_or_else(|| missing(path, source))
    };
    let gas_constant = pick("gas.species.gas_constant", named.map(|species| species.1))?;
    let cp = pick("gas.species.cp", named.map(|species| species.2))?;
    if cp <= gas_constant {
        return Err(source.error(
            "gas.species.cp",
            &shown(cp),
            "leaves no heat capacity at constant volume",
            format!("above the gas constant, {gas_constant} J/(kg K)"),
        ));
    }
    Ok(Species { gas_constant, cp })
}
