//! From the settings of a point to its scene.

use billow_solver::scene::{
    Design, IntegratorKind, ModelKind, Outputs, Scene, Solver, Stepping, Thresholds,
};

use super::ground;
use super::inflow::Inflow;
use crate::input::keys::{self, MODEL_KINDS, RESIDUAL_GAS, ResidualGas};
use crate::input::plausible::Implausible;
use crate::input::sections::check_sample_interval;
use crate::input::settings::Settings;
use crate::input::source::{Source, shown};
use crate::input::value::brief_number;
use crate::platform::error::InputError;

/// The scene of a point: the values of its keys, completed by its strategy and its model.
pub(super) fn scene(
    settings: &Settings,
    design: Design,
    source: &Source,
) -> Result<Scene, InputError> {
    let film = settings.film(source)?;
    let model = settings.word("solver.model", &MODEL_KINDS, source)?;
    let end_time = settings.needed("solver.end_time", source)?;
    let sample_interval = settings.needed("outputs.sample_interval", source)?;
    check_sample_interval(sample_interval, end_time, source)?;
    let name = settings.strategy_name();
    let Some(strategy) = settings.strategies.get(name).copied() else {
        settings.check_strategy(name, "strategy", source)?;
        return Err(settings.missing("strategy", source));
    };
    check_release(name, settings.release_time(strategy), end_time, source)?;
    let windows = Inflow { settings, name, strategy, end_time, source }.windows()?;
    let residual_mass = settings.needed("gas.residual_gas_mass", source)?;
    let stored_mass = match settings.word("gas.residual_gas", &RESIDUAL_GAS, source)? {
        ResidualGas::Burst => 0.0,
        ResidualGas::Stored => residual_mass,
        ResidualGas::Ambient => {
            ground::mass_at_ambient_pressure(&design, settings, residual_mass, source)?
        }
    };
    let initial_mass = settings.preinflation_mass(strategy) + stored_mass;
    let gas = settings.gas(initial_mass, windows, source)?;
    ground::check_gas_inside(&gas, source)?;
    let has_film = keys::model(model).has_film;
    let seed = settings.whole("seed", source)?;
    Ok(Scene {
        design,
        film,
        gas,
        supports: settings.supports.clone(),
        contact: settings.contact(source)?,
        gravity: settings.needed("gravity", source)?,
        release_time: settings.release_time(strategy),
        solver: Solver {
            model,
            end_time,
            // Equal physics gives an equal job, whatever is asked for that the model does not have.
            integrator: if has_film {
                settings.integrator(source)?
            } else {
                IntegratorKind::default()
            },
            stepping: stepping(model, settings, source)?,
            step_limit: settings.whole("solver.step_limit", source)?,
        },
        outputs: Outputs {
            sample_interval,
            frames: if has_film { settings.count("outputs.frames", source)? } else { 0 },
            thresholds: Thresholds {
                deployed_volume: settings.needed("outputs.thresholds.deployed_volume", source)?,
                deployed_height: settings.needed("outputs.thresholds.deployed_height", source)?,
                stalled_volume: settings.needed("outputs.thresholds.stalled_volume", source)?,
                near_threshold_margin: settings
                    .needed("outputs.thresholds.near_threshold_margin", source)?,
            },
        },
        seed,
        // Without an imperfection its amplitude is not physics.
        imperfection_amplitude: settings.number("imperfection_amplitude").filter(|_| seed > 0),
    })
}

/// Fraction of the run that a released capsule needs at least, without a warning. Chosen: the verdict is
/// that of the last tenth.
const MIN_FREE_FRACTION: f64 = 0.1;

/// Refuses a capsule that is released after the end of its run; warns of one that has no time to deploy.
fn check_release(
    name: &str,
    release_time: f64,
    end_time: f64,
    source: &Source,
) -> Result<(), InputError> {
    let key = format!("strategies.{name}.release_time");
    let free = end_time - release_time;
    if free > 0.0 {
        if release_time > 0.0 && free < MIN_FREE_FRACTION * end_time {
            let (free, end_time) = (brief_number(free), shown(end_time));
            let problem = format!("leaves {free} s of a run of {end_time} s for the deployment");
            let next = "release earlier, or raise solver.end_time".to_owned();
            let value = format!("{} s", shown(release_time));
            source.warn_point(&key, &value, Implausible { problem, next });
        }
        return Ok(());
    }
    Err(source.error(
        &key,
        shown(release_time),
        "the run ends before the capsule is released",
        format!("below solver.end_time, {} s", shown(end_time)),
    ))
}

/// How a model chooses its step.
fn stepping(
    model: ModelKind,
    settings: &Settings,
    source: &Source,
) -> Result<Stepping, InputError> {
    const FIXED: &str = "solver.stepping.fixed";
    match (keys::model(model).has_stable_step, settings.number(FIXED)) {
        (true, Some(step)) => Err(source.error(
            FIXED,
            shown(step),
            "the models storeys and film take a fraction of their stable step",
            "solver.cfl in its place; only the model piston takes a fixed step",
        )),
        (true, None) => settings.needed("solver.cfl", source).map(Stepping::Stable),
        (false, Some(step)) => Ok(Stepping::Fixed(step)),
        (false, None) => {
            settings.needed("solver.stepping.adaptive", source).map(Stepping::Adaptive)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::keys::{KEYS, KeyKind};
    use crate::input::syntax::parse;
    use crate::input::value::Value;

    const TEXT: &str = r#"{
        "design": {"fit": "height", "N": 6, "M": 3, "bottom_radius": 0.5, "height": 1, "alpha1_over_phi": 0.8},
        "gas": {"mass_flow_rate": 0.002, "residual_gas_mass": 1e-4, "ambient_pressure": 10,
                "species": {"gas_constant": 300, "cp": 1000}},
        "film": {"bending": true},
        "strategies": {"filled": {"preinflation_mass": 1e-4}, "direct": {"preinflation_mass": 2e-4}},
        "strategy": "filled",
        "solver": {"end_time": 0.3, "model": "film"},
        "imperfection_amplitude": 1e-4, "seed": 1
    }"#;

    fn base(model: &str) -> Settings {
        let text = TEXT.replace("film\"}", &format!("{model}\"}}"));
        Settings::of_study(&parse(&text, "a").unwrap(), &Source::new("a")).unwrap()
    }

    fn scene_of(point: &Settings) -> Scene {
        let source = Source::new("a");
        scene(point, point.design(&source).unwrap(), &source).unwrap()
    }

    #[test]
    fn every_key_arrives_in_the_scene() {
        /// Keys that are no part of a scene, and one that has a single word.
        const OTHERS: [&str; 5] = ["format", "version", "name", "question", "design.caps"];
        for (index, key) in KEYS.iter().enumerate() {
            if OTHERS.contains(&key.path) || key.path.starts_with("job_limits.") {
                continue;
            }
            let stepping = key.path.starts_with("solver.stepping.");
            let mut before = base(if stepping { "piston" } else { "film" });
            if key.path == "creases.rest_angle" {
                let length = KEYS.iter().position(|key| key.path == "creases.length_scale");
                before.set(length.unwrap(), Value::Number(0.02));
            }
            if key.path.starts_with("gas.vent_") && key.path != "gas.vent_area" {
                let area = KEYS.iter().position(|key| key.path == "gas.vent_area");
                before.set(area.unwrap(), Value::Number(1e-4));
            }
            let mut after = before.clone();
            let other = match (key.kind, before.at(index)) {
                (_, Value::Integer(number)) => Value::Integer(number + 1),
                (_, Value::Number(number)) => Value::Number(0.9 * number + 1e-3),
                (KeyKind::Choice(words), given) => {
                    let mut others =
                        words.iter().filter(|word| Value::Text(word.name.to_owned()) != *given);
                    Value::Text(others.next().unwrap().name.to_owned())
                }
                (_, Value::Bool(flag)) => Value::Bool(!flag),
                (_, Value::Text(_)) => Value::Text("direct".to_owned()),
                _ => key.read(&parse(key.example, "a").unwrap()).unwrap(),
            };
            after.set(index, other);
            assert_ne!(scene_of(&before), scene_of(&after), "{}", key.path);
        }
    }
}
