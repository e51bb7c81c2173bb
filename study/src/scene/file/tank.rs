//! Inflow from a tank: an inflow window with `tank_pressure` and `orifice_area`.

use billow_solver::scene::tank::Tank;
use billow_solver::scene::{InflowWindow, Species};

use crate::input::source::{Source, shown};
use crate::platform::error::InputError;

/// What a window gives of its tank, SI.
pub(crate) struct Given {
    pub mass: Option<f64>,
    pub tank_pressure: Option<f64>,
    pub orifice_area: Option<f64>,
    pub mass_flow_rate: Option<f64>,
    /// Temperature in the tank when it opens.
    pub temperature: f64,
    pub from: f64,
    /// When the orifice closes.
    pub to: Option<f64>,
}

impl Given {
    /// Whether the window is that of a tank.
    pub fn is_tank(&self) -> bool {
        self.tank_pressure.is_some() || self.orifice_area.is_some()
    }

    /// The inflow of the tank against this pressure (Pa); `path` is the place of the window.
    pub fn windows(
        &self,
        path: &str,
        species: &Species,
        outside: f64,
        source: &Source,
    ) -> Result<Vec<InflowWindow>, InputError> {
        if let Some(rate) = self.mass_flow_rate {
            let problem = "is given beside a tank, whose flow follows from its pressure";
            let allowed = "tank_pressure and orifice_area, or a mass_flow_rate";
            let key = format!("{path}.mass_flow_rate");
            return Err(source.error(&key, shown(rate), problem, allowed));
        }
        let missing = |key: &str| {
            let problem = "missing: a tank has mass, tank_pressure and orifice_area";
            source.error(&format!("{path}.{key}"), "", problem, "all three")
        };
        let tank = Tank {
            mass: self.mass.ok_or_else(|| missing("mass"))?,
            pressure: self.tank_pressure.ok_or_else(|| missing("tank_pressure"))?,
            temperature: self.temperature,
            orifice_area: self.orifice_area.ok_or_else(|| missing("orifice_area"))?,
        };
        let mut windows = tank.windows(species, self.from, outside);
        if windows.is_empty() {
            let problem = "is not above gas.ambient_pressure, so no gas flows";
            let allowed = format!("above {} Pa", shown(outside));
            let key = format!("{path}.tank_pressure");
            return Err(source.error(&key, shown(tank.pressure), problem, allowed));
        }
        if let Some(to) = self.to {
            windows.retain(|window| window.from < to);
            if let Some(last) = windows.last_mut() {
                last.to = last.to.min(to);
            }
        }
        Ok(windows)
    }
}
