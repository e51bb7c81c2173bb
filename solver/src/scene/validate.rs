//! Range checks of a scene, before any model runs it.

use super::{HeatTransfer, MAX_SAMPLES, Scene, Stepping, Support};
use crate::scene::error::SceneError;

/// Maximum number of frames, all kept in memory. Chosen: keeps them in memory for large meshes.
const MAX_FRAMES: u32 = 10_000;
/// Range of the relative tolerance a step. Chosen: above rounding, and small enough to converge.
const TOLERANCE_RANGE: core::ops::RangeInclusive<f64> = 1e-14..=0.1;

impl Scene {
    /// Checks every key except those of the design: [`crate::geometry::fold::FoldPattern::new`] checks
    /// those.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] with the dotted key of the first value out of range.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.validate_film()?;
        self.validate_gas()?;
        for (index, support) in self.supports.iter().enumerate() {
            validate_support(index, support)?;
        }
        self.validate_contact()?;
        let any = |value: f64| value.is_finite();
        number("gravity", self.gravity, any, "a finite number, m/s²")?;
        not_negative("release_time", self.release_time, "s")?;
        if let Some(amplitude) = self.imperfection_amplitude {
            positive("imperfection_amplitude", amplitude, "m")?;
        }
        self.validate_solver()?;
        self.validate_outputs()
    }

    fn validate_film(&self) -> Result<(), SceneError> {
        let film = &self.film;
        positive("film.youngs_modulus", film.youngs_modulus, "Pa")?;
        let poisson = |ratio: f64| ratio > -1.0 && ratio <= 0.5;
        number("film.poisson_ratio", film.poisson_ratio, poisson, "above -1, at most 0.5")?;
        positive("film.density", film.density, "kg/m³")?;
        positive("film.thickness", film.thickness, "m")?;
        let fraction = |value: f64| (0.0..=1.0).contains(&value);
        number("film.compression", film.compression, fraction, "from 0 to 1")?;
        if let Some(creases) = film.creases {
            positive("creases.length_scale", creases.length_scale, "m")?;
        }
        if let Some(moment) = film.yield_moment {
            positive("film.yield_moment", moment, "N m/m")?;
        }
        not_negative("film.numerical_damping", film.numerical_damping, "a damping ratio")?;
        not_negative("film.loss_factor", film.loss_factor, "a loss factor")?;
        positive("film.loss_frequency", film.loss_frequency, "Hz")?;
        positive("film.temperature", film.temperature, "K")
    }

    fn validate_gas(&self) -> Result<(), SceneError> {
        let gas = &self.gas;
        positive("gas.species.gas_constant", gas.species.gas_constant, "J/(kg K)")?;
        let gas_constant = gas.species.gas_constant;
        let above = |cp: f64| cp > gas_constant && cp.is_finite();
        number("gas.species.cp", gas.species.cp, above, "above gas_constant: cv = cp - R > 0")?;
        for temperature in gas.species.vibrations {
            not_negative("gas.species.vibrations", temperature, "K")?;
        }
        not_negative("gas.initial_mass", gas.initial_mass, "kg")?;
        for (index, window) in gas.windows.iter().enumerate() {
            let key = |name: &str| format!("gas.windows[{index}].{name}");
            not_negative(&key("from"), window.from, "s")?;
            let later = |to: f64| to > window.from && to.is_finite();
            number(&key("to"), window.to, later, "later than `from`")?;
            not_negative(&key("rate"), window.mass_flow_rate, "kg/s")?;
            positive(&key("temperature"), window.temperature, "K")?;
        }
        not_negative("gas.ambient_pressure", gas.ambient_pressure, "Pa")?;
        if let HeatTransfer::Coefficient(coefficient) = gas.heat_transfer {
            not_negative("gas.heat_transfer.coefficient", coefficient, "W/(m² K)")?;
        }
        not_negative("gas.leak_area", gas.leak_area, "m²")?;
        if let Some(vent) = gas.vent {
            not_negative("gas.vent_area", vent.area, "m²")?;
            not_negative("gas.vent_opens_at", vent.opens_at, "Pa")?;
            let later = |to: f64| to > vent.from;
            number("gas.vent_to", vent.to, later, "later than gas.vent_from")?;
            let above = |full: f64| full == 0.0 && vent.opens_at == 0.0 || full > vent.opens_at;
            number("gas.vent_full_at", vent.full_at, above, "above gas.vent_opens_at")?;
        }
        let coefficient = |value: f64| value > 0.0 && value <= 1.0;
        let key = "gas.discharge_coefficient";
        number(key, gas.discharge_coefficient, coefficient, "above 0, at most 1")
    }

    fn validate_contact(&self) -> Result<(), SceneError> {
        if let Some(distance) = self.contact.distance {
            positive("contact.distance", distance, "m")?;
        }
        not_negative("contact.friction", self.contact.friction, "a coefficient")?;
        not_negative("contact.adhesion", self.contact.adhesion, "Pa")
    }

    fn validate_solver(&self) -> Result<(), SceneError> {
        let solver = &self.solver;
        positive("solver.end_time", solver.end_time, "s")?;
        if solver.step_limit == 0 {
            return Err(SceneError::invalid("solver.step_limit", "0 is not allowed; at least 1"));
        }
        match solver.stepping {
            Stepping::Adaptive(tolerance) => {
                let allowed = |value: f64| TOLERANCE_RANGE.contains(&value);
                number("solver.stepping.adaptive", tolerance, allowed, "from 1e-14 to 0.1")
            }
            Stepping::Fixed(step) => positive("solver.stepping.fixed", step, "s"),
            Stepping::Stable(fraction) => {
                let allowed = |value: f64| value > 0.0 && value <= 1.0;
                number("solver.cfl", fraction, allowed, "above 0, at most 1")
            }
        }
    }

    fn validate_outputs(&self) -> Result<(), SceneError> {
        let key = "outputs.sample_interval";
        let interval = self.outputs.sample_interval;
        positive(key, interval, "s")?;
        let few = |interval: f64| self.solver.end_time / interval <= MAX_SAMPLES;
        number(key, interval, few, "at least 1e-6 of solver.end_time")?;
        if self.outputs.frames > MAX_FRAMES {
            let problem = format!("{} is not allowed; at most {MAX_FRAMES}", self.outputs.frames);
            return Err(SceneError::invalid("outputs.frames", problem));
        }
        let thresholds = &self.outputs.thresholds;
        positive("outputs.thresholds.deployed_volume", thresholds.deployed_volume, "a ratio")?;
        positive("outputs.thresholds.deployed_height", thresholds.deployed_height, "a ratio")?;
        positive("outputs.thresholds.stalled_volume", thresholds.stalled_volume, "a ratio")?;
        not_negative("outputs.thresholds.close_margin", thresholds.near_threshold_margin, "a ratio")
    }
}

fn validate_support(index: usize, support: &Support) -> Result<(), SceneError> {
    let allowed = ["x", "y", "z", "xy", "xz", "yz", "xyz"];
    if allowed.contains(&support.fix.as_str()) {
        return Ok(());
    }
    let problem = format!(
        "{:?} is not a list of displacement components; allowed: letters of \"xyz\" in that order",
        support.fix
    );
    Err(SceneError::invalid(format!("supports[{index}].fix"), problem))
}

fn positive(key: &str, value: f64, unit: &str) -> Result<(), SceneError> {
    let valid = |value: f64| value > 0.0 && value.is_finite();
    number(key, value, valid, &format!("a number above 0 ({unit})"))
}

fn not_negative(key: &str, value: f64, unit: &str) -> Result<(), SceneError> {
    let valid = |value: f64| value >= 0.0 && value.is_finite();
    number(key, value, valid, &format!("a number of at least 0 ({unit})"))
}

fn number(
    key: &str,
    value: f64,
    valid: impl Fn(f64) -> bool,
    allowed: &str,
) -> Result<(), SceneError> {
    let refused = || SceneError::invalid(key, format_args!("{value} is not allowed; {allowed}"));
    valid(value).then_some(()).ok_or_else(refused)
}
