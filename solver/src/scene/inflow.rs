//! The inflow schedule: windows of constant mass flow rate and temperature; overlapping windows add up.

use super::{GasSupply, InflowWindow, Species, Vent};

/// Total inflow of all open windows, and whether gas can leave by the vent.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inflow {
    /// Mass flow rate Σ ṁ, kg/s.
    pub mass_flow_rate: f64,
    /// Σ ṁ `T_in`, kg K/s; times cp, the enthalpy flow in W without that of vibrations.
    pub temperature_flow: f64,
    /// Enthalpy flow of the vibrations of the molecules, W.
    pub vibration_flow: f64,
    /// Whether the vent can be open.
    pub vent_open: bool,
}

/// The inflow windows of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    windows: Vec<InflowWindow>,
    species: Species,
    vent: Option<Vent>,
    change_times: Vec<f64>,
}

impl Schedule {
    /// The schedule of these windows of nitrogen.
    pub fn new(windows: &[InflowWindow]) -> Self {
        let mut change_times: Vec<f64> = windows.iter().flat_map(|w| [w.from, w.to]).collect();
        change_times.sort_by(f64::total_cmp);
        change_times.dedup();
        Self { windows: windows.to_vec(), species: Species::NITROGEN, vent: None, change_times }
    }

    /// The schedule of a supply: its windows, and the times of its vent.
    pub fn of(supply: &GasSupply) -> Self {
        let (species, vent) = (supply.species, supply.vent);
        let mut schedule = Self { species, vent, ..Self::new(&supply.windows) };
        schedule.change_times.extend(supply.vent.iter().flat_map(|vent| [vent.from, vent.to]));
        schedule.change_times.sort_by(f64::total_cmp);
        schedule.change_times.dedup();
        schedule
    }

    /// Times at which a window or the vent opens or closes, in ascending order, s.
    pub fn change_times(&self) -> &[f64] {
        &self.change_times
    }

    /// The inflow between two times (s) without a change time between them.
    pub fn between(&self, from: f64, to: f64) -> Inflow {
        let middle = 0.5 * (from + to);
        let open = self.windows.iter().filter(|w| w.from <= middle && middle < w.to);
        let vent_open = self.vent.is_some_and(|vent| vent.from <= middle && middle < vent.to);
        open.fold(Inflow { vent_open, ..Inflow::default() }, |sum, window| Inflow {
            mass_flow_rate: sum.mass_flow_rate + window.mass_flow_rate,
            temperature_flow: sum.temperature_flow + window.mass_flow_rate * window.temperature,
            vibration_flow: sum.vibration_flow
                + window.mass_flow_rate * self.species.vibration_energy(window.temperature),
            vent_open,
        })
    }

    /// Inflow mass from time 0 to `time` (s), kg, in closed form. Tests compare the integration with it.
    pub fn mass_until(&self, time: f64) -> f64 {
        let inflow =
            |w: &InflowWindow| w.mass_flow_rate * (time.min(w.to) - w.from.max(0.0)).max(0.0);
        self.windows.iter().map(inflow).sum()
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;

    fn window(from: f64, to: f64, mass_flow_rate: f64, temperature: f64) -> InflowWindow {
        InflowWindow { from, to, mass_flow_rate, temperature }
    }

    #[test]
    fn overlapping_windows_add_up_and_none_let_nothing_in() {
        let schedule = Schedule::new(&[window(0.0, 2.0, 1.0, 300.0), window(1.0, 3.0, 2.0, 200.0)]);
        assert_eq!(schedule.change_times(), [0.0, 1.0, 2.0, 3.0]);
        let both = schedule.between(1.0, 2.0);
        assert_eq!((both.mass_flow_rate, both.temperature_flow), (3.0, 700.0));
        assert_eq!(schedule.between(3.0, 4.0), Inflow::default());
        assert_eq!(schedule.mass_until(1.5), 1.5 + 1.0);
        assert_eq!(schedule.mass_until(9.0), 2.0 + 4.0);
        let empty = Schedule::new(&[]);
        assert!(empty.change_times().is_empty());
        assert_eq!((empty.between(0.0, 1.0), empty.mass_until(1.0)), (Inflow::default(), 0.0));
    }
}
