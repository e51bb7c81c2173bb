//! From the settings of a point to its scene.

use billow_solver::geometry::fold::FoldDesign;
use billow_solver::scene::{InflowWindow, IntegratorKind, ModelKind, Scene, Stepping};

use super::base::Base;
use super::ground;
use super::schedule::Schedule;
use super::strategy::{Strategy, Window};
use crate::input::keys::draft::{Draft, SteppingDraft};
use crate::input::keys::{self, KEYS, Key, ResidualGas, named};
use crate::input::settings::{check_sample_interval, species};
use crate::input::source::{Source, shown};
use crate::platform::error::InputError;

/// The fold design of a point.
///
/// # Errors
/// When a required key of the design is missing.
pub(super) fn design(point: &Base, source: &Source) -> Result<FoldDesign, InputError> {
    let of_design = |key: &Key| key.path.starts_with("design.");
    Ok(point.settings.draft(of_design, source)?.scene.design)
}

/// The scene of a point: the draft of its keys, completed by its strategy and its model.
///
/// # Errors
/// When a key is missing, or two keys contradict each other.
pub(super) fn scene(point: &Base, source: &Source) -> Result<Scene, InputError> {
    let draft = point.settings.draft(|_| true, source)?;
    let end_time = draft.scene.solver.end_time;
    check_sample_interval(draft.scene.outputs.sample_interval, end_time, source)?;
    let name = point.strategy_name();
    let Some(strategy) = point.strategies.get(name) else {
        point.check_strategy(name, "strategy", source)?;
        return Err(point.settings.missing(const { named(KEYS, "strategy") }, source));
    };
    check_release(name, strategy, end_time, source)?;
    let windows = Windows { point, name, strategy, draft: &draft, source };
    let windows = windows.resolve()?;
    let burst = (burst_mass(&draft), draft.inflow.burst_rate);
    let mut scene = draft.scene.clone();
    scene.gas.species = species(&draft.species, source)?;
    scene.gas.initial_mass = strategy.preinflation_mass() + stored_mass(&draft, source)?;
    ground::check_gas_inside(&scene.gas, source)?;
    scene.gas.windows = windows;
    scene.supports.clone_from(&point.supports);
    scene.release_time = strategy.release_time();
    scene.solver.stepping = stepping(scene.solver.model, &draft.stepping, point, source)?;
    if !keys::model(scene.solver.model).has_film {
        // Equal physics gives an equal job, whatever is asked for that the model does not have.
        scene.outputs.frames = 0;
        scene.solver.integrator = IntegratorKind::default();
    }
    if scene.seed == 0 {
        // Without an imperfection its amplitude is not physics.
        scene.imperfection_amplitude = None;
    }
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

/// Residual gas inside from the start, kg.
fn stored_mass(draft: &Draft, source: &Source) -> Result<f64, InputError> {
    Ok(match draft.inflow.residual {
        ResidualGas::Burst => 0.0,
        ResidualGas::Stored => draft.inflow.residual_mass,
        ResidualGas::Ambient => ground::mass_at_ambient_pressure(draft, source)?,
    })
}

/// Residual gas let in as a burst, kg.
fn burst_mass(draft: &Draft) -> f64 {
    if draft.inflow.residual == ResidualGas::Burst { draft.inflow.residual_mass } else { 0.0 }
}

/// How a model chooses its step.
fn stepping(
    model: ModelKind,
    draft: &SteppingDraft,
    point: &Base,
    source: &Source,
) -> Result<Stepping, InputError> {
    const FIXED: &Key = named(KEYS, "solver.stepping.fixed");
    const ADAPTIVE: &Key = named(KEYS, "solver.stepping.adaptive");
    match (keys::model(model).has_stable_step, draft.fixed) {
        (true, Some(step)) => Err(source.error(
            FIXED.path,
            &shown(step),
            "the models storeys and film take a fraction of their stable step",
            "solver.cfl in its place; only the model piston takes a fixed step",
        )),
        (true, None) => Ok(Stepping::Stable(draft.cfl)),
        (false, Some(step)) => Ok(Stepping::Fixed(step)),
        (false, None) => match draft.adaptive {
            Some(tolerance) => Ok(Stepping::Adaptive(tolerance)),
            None => Err(point.settings.missing(ADAPTIVE, source)),
        },
    }
}

/// What the inflow windows of a point follow from.
struct Windows<'a> {
    point: &'a Base,
    /// Name of the strategy.
    name: &'a str,
    strategy: &'a Strategy,
    draft: &'a Draft,
    source: &'a Source,
}

impl Windows<'_> {
    /// Inflow windows in order of time. Windows without inflow before the end are left out, and
    /// windows that last beyond the end are cut there, so that equal physics gives an equal job.
    fn resolve(&self) -> Result<Vec<InflowWindow>, InputError> {
        let end_time = self.draft.scene.solver.end_time;
        let mut windows = self.burst();
        for (index, window) in self.strategy.windows().enumerate() {
            windows.push(self.window(index, &window)?);
        }
        for window in &mut windows {
            window.to = window.to.min(end_time);
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
        let mass = burst_mass(self.draft);
        if mass <= 0.0 {
            return Vec::new();
        }
        let release_time = self.strategy.release_time();
        let rate = self.draft.inflow.burst_rate;
        vec![InflowWindow {
            from: release_time,
            to: release_time + mass / rate,
            mass_flow_rate: rate,
            temperature: self.draft.inflow.temperature,
        }]
    }

    /// One window of the strategy, with the study's values where it gives none.
    fn window(&self, index: usize, window: &Window) -> Result<InflowWindow, InputError> {
        let from = window.from.unwrap_or(self.strategy.release_time());
        let rate = window.mass_flow_rate.or(self.draft.inflow.mass_flow_rate);
        let rate = rate.ok_or_else(|| {
            let key = const { named(KEYS, "gas.mass_flow_rate") };
            self.point.settings.missing(key, self.source)
        })?;
        let end_time = self.draft.scene.solver.end_time.max(from);
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
            (None, _) => end_time,
        };
        if to <= from && (to < from || window.to.is_some()) {
            return Err(self.source.error(
                &format!("strategies.{}.inflow[{index}].to", self.name),
                &shown(to),
                "the window ends before it begins",
                format!("above its `from`, {} s", shown(from)),
            ));
        }
        let temperature = window.temperature.unwrap_or(self.draft.inflow.temperature);
        Ok(InflowWindow { from, to, mass_flow_rate: rate, temperature })
    }
}
