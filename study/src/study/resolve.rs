//! From the settings of a point to its scene.

use billow_solver::geometry::fold::{FoldDesign, FoldError, FoldPattern};
use billow_solver::scene::{
    Contact, GasSupply, InflowWindow, MAX_SAMPLES, ModelKind, Outputs, Scene, Solver, Stepping,
    Thresholds,
};

use super::base::Base;
use super::strategy::Strategy;
use crate::input::keys::{STRATEGY_KEYS, WINDOW_KEYS};
use crate::input::settings::{film, gas_laws, missing, number, unsigned, whole};
use crate::input::source::{Source, shown};
use crate::input::value::Value;
use crate::job::point::Infeasible;
use crate::platform::error::InputError;

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
    if end_time / sample_interval > MAX_SAMPLES {
        return Err(source.error(
            "outputs.sample_interval",
            &shown(sample_interval),
            format!("samples a run of {end_time} s more than {MAX_SAMPLES:.0} times"),
            format!("at least {} s for this end_time", shown(end_time / MAX_SAMPLES)),
        ));
    }
    let name = settings.text("strategy");
    let Some(strategy) = point.strategies.get(name) else {
        point.check_strategy(name, "strategy", source)?;
        return Err(missing(settings, "strategy", source));
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
    let model = match settings.text("solver.model") {
        "piston" => ModelKind::Piston,
        _ => ModelKind::Film,
    };
    let residual = get("gas.residual_gas_mass")?;
    let stored = settings.text("gas.residual_gas") == "stored";
    let windows = windows(point, name, strategy, if stored { 0.0 } else { residual }, source)?;
    Ok(Scene {
        design,
        film: film(settings, source)?,
        gas: GasSupply {
            initial_mass: strategy_number(strategy, "preinflation_mass")
                + if stored { residual } else { 0.0 },
            windows,
            ..gas_laws(settings, source)?
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
            model,
            end_time,
            stepping: match (model, settings.number("solver.stepping.fixed")) {
                (ModelKind::Film, Some(step)) => {
                    return Err(source.error(
                        "solver.stepping.fixed",
                        &shown(step),
                        "the model film takes a share of its stable step",
                        "solver.cfl in its place; a fixed step is the piston's",
                    ));
                }
                (ModelKind::Film, None) => Stepping::Stable(get("solver.cfl")?),
                (ModelKind::Piston, Some(step)) => Stepping::Fixed(step),
                (ModelKind::Piston, None) => Stepping::Adaptive(get("solver.stepping.adaptive")?),
            },
            step_limit: unsigned(settings, "solver.step_limit", source)?,
        },
        outputs: Outputs {
            sample_interval,
            // A model without a shape keeps none, whatever is asked: equal physics, equal job.
            frames: match model {
                ModelKind::Film => whole(settings, "outputs.frames", source)?,
                ModelKind::Piston => 0,
            },
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
