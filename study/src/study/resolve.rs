//! From the settings of a point to its scene.

use billow_solver::geometry::fold::FoldDesign;
use billow_solver::scene::{
    InflowWindow, IntegratorKind, ModelKind, Outputs, Scene, Solver, Stepping, Thresholds,
};

use super::ground;
use super::schedule::Schedule;
use crate::input::keys::{self, MODEL_KINDS, RESIDUAL_GAS, ResidualGas};
use crate::input::settings::{Settings, check_sample_interval};
use crate::input::source::{Source, shown};
use crate::input::strategy::{Strategy, Window};
use crate::platform::error::InputError;

/// The scene of a point: the values of its keys, completed by its strategy and its model.
///
/// # Errors
/// When a key is missing, or two keys contradict each other.
pub(super) fn scene(
    point: &Settings,
    design: FoldDesign,
    source: &Source,
) -> Result<Scene, InputError> {
    let settings = point;
    let film = settings.film(source)?;
    let model = settings.word("solver.model", &MODEL_KINDS, source)?;
    let end_time = settings.needed("solver.end_time", source)?;
    let sample_interval = settings.needed("outputs.sample_interval", source)?;
    check_sample_interval(sample_interval, end_time, source)?;
    let name = point.strategy_name();
    let Some(strategy) = point.strategies.get(name) else {
        point.check_strategy(name, "strategy", source)?;
        return Err(settings.missing("strategy", source));
    };
    check_release(name, strategy, end_time, source)?;
    let inflow = Inflow::of(point, source)?;
    let windows = Windows { point, name, strategy, inflow: &inflow, end_time, source };
    let stored_mass = match inflow.residual {
        ResidualGas::Burst => 0.0,
        ResidualGas::Stored => inflow.residual_mass,
        ResidualGas::Ambient => {
            ground::mass_at_ambient_pressure(&design, settings, inflow.residual_mass, source)?
        }
    };
    let initial_mass = strategy.preinflation_mass() + stored_mass;
    let gas = settings.gas(initial_mass, windows.resolve()?, source)?;
    ground::check_gas_inside(&gas, source)?;
    let has_film = keys::model(model).has_film;
    let seed = settings.whole("seed", source)?;
    let scene = Scene {
        design,
        film,
        gas,
        supports: point.supports.clone(),
        contact: settings.contact(source)?,
        gravity: settings.needed("gravity", source)?,
        release_time: strategy.release_time(),
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
    };
    let burst = (inflow.burst_mass(), inflow.burst_rate);
    Schedule { point, scene: &scene, burst, source }.check();
    Ok(scene)
}

/// Refuses a capsule that is released after the end of its run.
fn check_release(
    name: &str,
    strategy: &Strategy,
    end_time: f64,
    source: &Source,
) -> Result<(), InputError> {
    let release_time = strategy.release_time();
    if release_time < end_time {
        return Ok(());
    }
    Err(source.error(
        &format!("strategies.{name}.release_time"),
        &shown(release_time),
        "the run ends before the capsule is released",
        format!("below solver.end_time, {} s", shown(end_time)),
    ))
}

/// Residual gas, and what a study lets in where a window does not say otherwise.
struct Inflow {
    /// Temperature of a window that gives none, K.
    temperature: f64,
    /// Residual gas, kg.
    residual_mass: f64,
    /// How residual gas enters.
    residual: ResidualGas,
    /// Mass flow rate of a burst, kg/s.
    burst_rate: f64,
}

impl Inflow {
    fn of(point: &Settings, source: &Source) -> Result<Self, InputError> {
        let settings = point;
        Ok(Self {
            temperature: settings.needed("gas.inflow_temperature", source)?,
            residual_mass: settings.needed("gas.residual_gas_mass", source)?,
            residual: settings.word("gas.residual_gas", &RESIDUAL_GAS, source)?,
            burst_rate: settings.needed("gas.burst_rate", source)?,
        })
    }

    /// Residual gas let in as a burst, kg.
    fn burst_mass(&self) -> f64 {
        if self.residual == ResidualGas::Burst { self.residual_mass } else { 0.0 }
    }
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
            &shown(step),
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

/// What the inflow windows of a point follow from.
struct Windows<'a> {
    point: &'a Settings,
    /// Name of the strategy.
    name: &'a str,
    strategy: &'a Strategy,
    inflow: &'a Inflow,
    /// End of the run, s.
    end_time: f64,
    source: &'a Source,
}

impl Windows<'_> {
    /// Inflow windows in order of time. Windows without inflow before the end are left out, and
    /// windows that last beyond the end are cut there, so that equal physics gives an equal job.
    fn resolve(&self) -> Result<Vec<InflowWindow>, InputError> {
        let mut windows = self.burst();
        for (index, window) in self.strategy.windows().enumerate() {
            windows.push(self.window(index, &window)?);
        }
        for window in &mut windows {
            window.to = window.to.min(self.end_time);
        }
        windows.retain(|window| window.mass_flow_rate > 0.0 && window.from < window.to);
        windows.sort_by(|a, b| {
            a.from
                .total_cmp(&b.from)
                .then(a.to.total_cmp(&b.to))
                .then(a.mass_flow_rate.total_cmp(&b.mass_flow_rate))
                .then(a.temperature.total_cmp(&b.temperature))
        });
        Ok(windows)
    }

    /// The burst of residual gas from release on.
    fn burst(&self) -> Vec<InflowWindow> {
        let mass = self.inflow.burst_mass();
        if mass <= 0.0 {
            return Vec::new();
        }
        let release_time = self.strategy.release_time();
        let rate = self.inflow.burst_rate;
        vec![InflowWindow {
            from: release_time,
            to: release_time + mass / rate,
            mass_flow_rate: rate,
            temperature: self.inflow.temperature,
        }]
    }

    /// One window of the strategy, with the study's values where it gives none.
    fn window(&self, index: usize, window: &Window) -> Result<InflowWindow, InputError> {
        let from = window.from.unwrap_or(self.strategy.release_time());
        let rate = match window.mass_flow_rate {
            Some(rate) => rate,
            None => self.point.needed("gas.mass_flow_rate", self.source)?,
        };
        let to = match (window.to, window.mass) {
            (Some(_), Some(mass)) => {
                return Err(self.source.error(
                    &format!("strategies.{}.inflow[{index}].mass", self.name),
                    &shown(mass),
                    "the window gives both its end and its mass",
                    "`to` or `mass`",
                ));
            }
            (Some(to), None) => to,
            (None, Some(mass)) if rate > 0.0 => from + mass / rate,
            (None, _) => self.end_time.max(from),
        };
        if to <= from && (to < from || window.to.is_some()) {
            return Err(self.source.error(
                &format!("strategies.{}.inflow[{index}].to", self.name),
                &shown(to),
                "the window ends before it begins",
                format!("above its `from`, {} s", shown(from)),
            ));
        }
        let temperature = window.temperature.unwrap_or(self.inflow.temperature);
        Ok(InflowWindow { from, to, mass_flow_rate: rate, temperature })
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
        "strategies": {"filled": {"preinflation_mass": 1e-4}, "direct": {"preinflation_mass": 1e-4}},
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
            let before = base(if stepping { "piston" } else { "film" });
            let mut after = before.clone();
            let other = match (key.kind, before.at(index)) {
                (_, Value::Integer(number)) => Value::Integer(number + 1),
                (_, Value::Number(number)) => Value::Number(0.9 * number + 1e-3),
                (KeyKind::Choice(words), given) => {
                    let mut others =
                        words.iter().filter(|word| Value::Text(word.name.to_owned()) != *given);
                    Value::Text(others.next().unwrap().name.to_owned())
                }
                (_, Value::Text(_)) => Value::Text("direct".to_owned()),
                _ => key.read(&parse(key.example, "a").unwrap()).unwrap(),
            };
            if key.path == "strategy" {
                after.strategies.insert("direct".to_owned(), Strategy::direct());
                after.set(
                    KEYS.iter().position(|key| key.path == "gas.ambient_pressure").unwrap(),
                    Value::Number(0.0),
                );
            }
            after.set(index, other);
            assert_ne!(scene_of(&before), scene_of(&after), "{}", key.path);
        }
    }
}
