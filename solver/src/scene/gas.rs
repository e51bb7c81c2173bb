//! The gas of the control volume, and what enters and leaves it.

use serde::{Deserialize, Serialize};

/// The gas of the control volume, its inflow, its leak, and its heat exchange.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasSupply {
    /// The gas.
    pub species: Species,
    /// Mass inside at time 0, kg, at film temperature (residual gas `stored`).
    pub initial_mass: f64,
    /// Inflow windows; overlapping windows add up.
    pub windows: Vec<InflowWindow>,
    /// Pressure outside, Pa.
    pub ambient_pressure: f64,
    /// Heat exchange with the film.
    pub heat_transfer: HeatTransfer,
    /// Area of the leak orifice, m².
    pub leak_area: f64,
    /// Discharge coefficient of the leak orifice.
    pub discharge_coefficient: f64,
}

/// An ideal gas.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Species {
    /// Specific gas constant R, J/(kg K).
    pub gas_constant: f64,
    /// Specific heat at constant pressure cp, J/(kg K); cv = cp − R.
    pub cp: f64,
}

/// Inflow at a constant mass flow rate while `from ≤ t < to`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InflowWindow {
    /// Start, s.
    pub from: f64,
    /// End, s.
    pub to: f64,
    /// Mass flow rate ṁ, kg/s. The stored name is part of job ids.
    #[serde(rename = "rate")]
    pub mass_flow_rate: f64,
    /// Inflow temperature `T_in`, K.
    pub temperature: f64,
}

/// Heat exchange between gas and film over the area of the film.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum HeatTransfer {
    /// Heat transfer coefficient h, W/(m² K); 0 is adiabatic.
    Coefficient(f64),
    /// The gas has film temperature at all times.
    Isothermal,
}
