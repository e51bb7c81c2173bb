//! Warnings about times that do not fit a run: windows, bursts and holds beyond its end, samples and frames
//! that are too few or too many.

use billow_solver::scene::Scene;

use crate::input::keys::{KEYS, Key, named};
use crate::input::plausible::{Implausible, MIN_SAMPLES};
use crate::input::settings::Settings;
use crate::input::source::{Source, shown};
use crate::input::strategy::Strategy;
use crate::input::value::{Value, brief_number};

/// Fraction of the run that a released capsule needs at least, without a warning. Chosen: the verdict is
/// that of the last tenth.
const MIN_FREE_FRACTION: f64 = 0.1;

/// Relative rounding error of a number of samples.
const ROUNDING: f64 = 1e-9;

/// What a warning compares: one point of a study.
pub(super) struct Schedule<'a> {
    pub point: &'a Settings,
    pub scene: &'a Scene,
    /// Residual gas let in as a burst, kg, and its rate, kg/s.
    pub burst: (f64, f64),
    pub source: &'a Source,
}

impl Schedule<'_> {
    /// Keeps the warnings about this point in its source.
    pub fn check(&self) {
        let name = self.point.strategy_name();
        if let Some(strategy) = self.point.strategies.get(name) {
            self.check_windows(name, strategy);
            self.check_hold(name, strategy);
            self.check_burst(strategy);
        }
        self.check_samples();
    }

    fn end_time(&self) -> f64 {
        self.scene.solver.end_time
    }

    fn warn(&self, key: &str, value: &str, problem: String, next: &str) {
        let implausible = Implausible { problem, next: next.to_owned() };
        self.source.warn_point(key, value, implausible);
    }

    /// Windows that start or end after the run.
    fn check_windows(&self, name: &str, strategy: &Strategy) {
        let end = self.end_time();
        for (index, window) in strategy.windows().enumerate() {
            let path = format!("strategies.{name}.inflow[{index}]");
            let from = window.from.unwrap_or(strategy.release_time());
            if from >= end {
                let problem = format!(
                    "starts at {}, after solver.end_time ({}): it is ignored",
                    seconds(from),
                    seconds(end)
                );
                let next = "start it earlier, or raise solver.end_time";
                self.warn(&format!("{path}.from"), &seconds(from), problem, next);
                continue;
            }
            let rate = window
                .mass_flow_rate
                .or(self.point.number("gas.mass_flow_rate"))
                .filter(|rate| *rate > 0.0);
            let of_mass = window.mass.zip(rate).map(|(mass, rate)| from + mass / rate);
            if let Some(to) = window.to.or(of_mass).filter(|to| *to > end) {
                let problem = format!(
                    "ends at {}: its part after solver.end_time ({}), {} % of its gas, is ignored",
                    seconds(to),
                    seconds(end),
                    brief_number(100.0 * (to - end) / (to - from))
                );
                let next = "end it earlier, or raise solver.end_time";
                if window.to.is_some() {
                    self.warn(&format!("{path}.to"), &seconds(to), problem, next);
                } else {
                    let mass = format!("{} kg", shown(window.mass.unwrap_or_default()));
                    let next = "let in less gas, raise its rate, or raise solver.end_time";
                    self.warn(&format!("{path}.mass"), &mass, problem, next);
                }
            }
        }
    }

    /// A release so late that the capsule has no time to deploy.
    fn check_hold(&self, name: &str, strategy: &Strategy) {
        let (release, end) = (strategy.release_time(), self.end_time());
        let free = end - release;
        if release > 0.0 && free < MIN_FREE_FRACTION * end {
            let problem = format!(
                "leaves {} s of a run of {} for the deployment",
                brief_number(free),
                seconds(end)
            );
            let next = "release earlier, or raise solver.end_time";
            self.warn(&format!("strategies.{name}.release_time"), &seconds(release), problem, next);
        }
    }

    /// A burst of residual gas that lasts beyond the run.
    fn check_burst(&self, strategy: &Strategy) {
        let ((mass, rate), end) = (self.burst, self.end_time());
        let time = end - strategy.release_time();
        if mass > 0.0 && mass / rate > time {
            let problem = format!(
                "enters at gas.burst_rate ({} kg/s) for {} s, beyond solver.end_time ({}): only {} % \
                 enter",
                brief_number(rate),
                brief_number(mass / rate),
                seconds(end),
                brief_number(100.0 * rate * time / mass)
            );
            let next = "check the unit of the mass; raise gas.burst_rate or solver.end_time, or take \
                        gas.residual_gas \"stored\"";
            self.warn("gas.residual_gas_mass", &format!("{} kg", shown(mass)), problem, next);
        }
    }

    /// Fewer samples than a history needs, fewer samples than shapes.
    fn check_samples(&self) {
        let outputs = &self.scene.outputs;
        let (interval, end) = (outputs.sample_interval, self.end_time());
        let samples = (end / interval * (1.0 + ROUNDING)).floor() + 1.0;
        if end < MIN_SAMPLES * interval {
            let problem = format!(
                "samples a run of {} only {}, too few for times and peaks",
                seconds(end),
                times(samples)
            );
            let next = "check its unit; the default is \"1 ms\"";
            self.warn("outputs.sample_interval", &seconds(interval), problem, next);
        } else if f64::from(outputs.frames) > samples && !is_default_frames(outputs.frames) {
            let problem =
                format!("is more than the {samples} samples of the run: each shape is a sample");
            let next = "keep fewer shapes, or lower outputs.sample_interval";
            self.warn("outputs.frames", &outputs.frames.to_string(), problem, next);
        }
    }
}

/// A number of times as text.
fn times(number: f64) -> String {
    format!("{number} time{}", if number > 1.0 { "s" } else { "" })
}

/// A time as text.
fn seconds(time: f64) -> String {
    format!("{} s", shown(time))
}
/// Whether a study has this number of shapes without asking for it.
fn is_default_frames(frames: u32) -> bool {
    const FRAMES: &Key = named(KEYS, "outputs.frames");
    FRAMES.default_value() == Value::Integer(i64::from(frames))
}
