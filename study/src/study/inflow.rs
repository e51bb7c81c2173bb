//! The gas that enters at a point: the windows of its strategy and the burst of residual gas, with
//! warnings about what does not fit the run.

use billow_solver::scene::InflowWindow;

use crate::input::keys::{RESIDUAL_GAS, ResidualGas, WINDOW_KEYS, position};
use crate::input::plausible::Implausible;
use crate::input::sections::check_window;
use crate::input::settings::{Settings, Strategy};
use crate::input::source::{Source, shown};
use crate::input::value::brief_number;
use crate::platform::error::InputError;
use crate::scene::file::{flow_table, tank};

/// Positions of the values of a window.
const FROM: usize = position(WINDOW_KEYS, "from");
const TO: usize = position(WINDOW_KEYS, "to");
const MASS: usize = position(WINDOW_KEYS, "mass");
const RATE: usize = position(WINDOW_KEYS, "mass_flow_rate");
const END_RATE: usize = position(WINDOW_KEYS, "end_mass_flow_rate");
const TEMPERATURE: usize = position(WINDOW_KEYS, "temperature");
const TANK_PRESSURE: usize = position(WINDOW_KEYS, "tank_pressure");
const ORIFICE_AREA: usize = position(WINDOW_KEYS, "orifice_area");

/// What the inflow of a point follows from.
pub(super) struct Inflow<'a> {
    pub settings: &'a Settings,
    /// Name of the strategy.
    pub name: &'a str,
    pub strategy: Strategy,
    /// End of the run, s.
    pub end_time: f64,
    pub source: &'a Source,
}

impl Inflow<'_> {
    /// The burst of residual gas, if there is one, then the inflow windows of the strategy.
    pub fn windows(&self) -> Result<Vec<InflowWindow>, InputError> {
        let temperature = self.settings.needed("gas.inflow_temperature", self.source)?;
        let mut windows: Vec<InflowWindow> = self.burst(temperature)?.into_iter().collect();
        // A window follows the one before where it does not say when it starts.
        let mut start = self.settings.release_time(self.strategy);
        for index in 0..self.strategy.windows {
            let parts = self.window(index, start, temperature)?;
            start = parts.last().map_or(start, |last| last.to);
            windows.extend(parts);
        }
        Ok(windows)
    }

    /// The burst of residual gas from release on.
    fn burst(&self, temperature: f64) -> Result<Option<InflowWindow>, InputError> {
        let Self { settings, source, end_time, .. } = self;
        let residual = settings.word("gas.residual_gas", &RESIDUAL_GAS, source)?;
        let mass = settings.needed("gas.residual_gas_mass", source)?;
        let rate = settings.needed("gas.burst_rate", source)?;
        if residual != ResidualGas::Burst || mass <= 0.0 {
            return Ok(None);
        }
        let from = self.settings.release_time(self.strategy);
        let to = from + mass / rate;
        if to > *end_time {
            let problem = format!(
                "enters at gas.burst_rate ({} kg/s) for {} s, beyond solver.end_time ({} s): only {} % enter",
                brief_number(rate),
                brief_number(mass / rate),
                shown(*end_time),
                brief_number(100.0 * rate * (end_time - from) / mass)
            );
            let next =
                "check the unit of the mass; raise gas.burst_rate or solver.end_time, or take \
                        gas.residual_gas \"stored\""
                    .to_owned();
            let value = format!("{} kg", shown(mass));
            source.warn_point("gas.residual_gas_mass", &value, Implausible { problem, next });
        }
        Ok(Some(InflowWindow { from, to, mass_flow_rate: rate, temperature }))
    }

    /// One window of the strategy, with the study's values where it gives none; of a tank those of its blow-down.
    fn window(
        &self,
        index: usize,
        start: f64,
        temperature: f64,
    ) -> Result<Vec<InflowWindow>, InputError> {
        let Self { source, end_time, .. } = *self;
        let path = format!("strategies.{}.inflow[{index}]", self.name);
        let value = |key| self.settings.of_window(self.strategy, index, key);
        let [given_to, mass] = [TO, MASS].map(value);
        let from = value(FROM).unwrap_or(start);
        let temperature = value(TEMPERATURE).unwrap_or(temperature);
        let tank = tank::Given {
            mass,
            tank_pressure: value(TANK_PRESSURE),
            orifice_area: value(ORIFICE_AREA),
            mass_flow_rate: value(RATE),
            temperature,
            from,
            to: given_to,
        };
        if let Some(table) = self.settings.tables.get(&(self.name.to_owned(), index)) {
            let at = |window: &InflowWindow| InflowWindow {
                from: from + window.from,
                to: from + window.to,
                temperature,
                ..*window
            };
            return Ok(table.iter().map(at).collect());
        }
        if let Some(rate) = value(END_RATE).filter(|_| tank.is_tank()) {
            let key = format!("{path}.end_mass_flow_rate");
            let problem = "is given beside a tank, whose flow follows from its pressure";
            return Err(source.error(&key, shown(rate), problem, "a tank, or a ramp"));
        }
        if tank.is_tank() {
            let outside = self.settings.needed("gas.ambient_pressure", source)?;
            return tank.windows(&path, &self.settings.species(source)?, outside, source);
        }
        let first = match value(RATE) {
            Some(rate) => rate,
            None => self.settings.needed("gas.mass_flow_rate", source)?,
        };
        let last = value(END_RATE).unwrap_or(first);
        let rate = 0.5 * (first + last);
        let to = match (given_to, mass) {
            (Some(_), Some(mass)) => {
                return Err(source.error(
                    &format!("{path}.mass"),
                    shown(mass),
                    "the window gives both its end and its mass",
                    "`to` or `mass`",
                ));
            }
            (Some(to), None) => to,
            (None, Some(mass)) if mass > 0.0 && rate <= 0.0 => {
                let problem = "the window lets in a mass at no rate, so it never lets in any";
                let allowed = "a mass_flow_rate above 0, or no mass";
                return Err(source.error(&format!("{path}.mass"), shown(mass), problem, allowed));
            }
            (None, Some(mass)) if rate > 0.0 => from + mass / rate,
            (None, _) => end_time.max(from),
        };
        let end = match mass {
            Some(mass) => Some(("mass", format!("{} kg, until {} s,", shown(mass), shown(to)))),
            None => given_to.map(|to| ("to", format!("{} s", shown(to)))),
        };
        check_window(&path, [from, to], end, end_time, source)?;
        if value(END_RATE).is_none() {
            return Ok(vec![InflowWindow { from, to, mass_flow_rate: rate, temperature }]);
        }
        let ramp = flow_table::windows_of(&[[0.0, first], [to - from, last]], [from, temperature]);
        Ok(ramp)
    }
}
