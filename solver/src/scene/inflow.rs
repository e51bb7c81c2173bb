//! The inflow schedule: windows of constant rate and temperature that add where they overlap.

use super::InflowWindow;

/// Gas let in at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inflow {
    /// ṁ, kg/s.
    pub mass: f64,
    /// Σ ṁ `T_in`, kg K/s: times cp, the enthalpy let in.
    pub mass_temperature: f64,
}

/// All inflow windows of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    windows: Vec<InflowWindow>,
    edges: Vec<f64>,
}

impl Schedule {
    /// A schedule of these windows.
    pub fn new(windows: &[InflowWindow]) -> Self {
        let mut edges: Vec<f64> = windows.iter().flat_map(|w| [w.from, w.to]).collect();
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        Self { windows: windows.to_vec(), edges }
    }

    /// Times at which the inflow changes, rising, s.
    pub fn edges(&self) -> &[f64] {
        &self.edges
    }

    /// The inflow between two times (s) that have no edge between them.
    pub fn between(&self, from: f64, to: f64) -> Inflow {
        let middle = 0.5 * (from + to);
        let open = self.windows.iter().filter(|w| w.from <= middle && middle < w.to);
        open.fold(Inflow::default(), |sum, window| Inflow {
            mass: sum.mass + window.rate,
            mass_temperature: sum.mass_temperature + window.rate * window.temperature,
        })
    }

    /// Mass let in from time 0 to `time` (s), kg: the closed form integration is checked against.
    pub fn mass_until(&self, time: f64) -> f64 {
        let let_in = |w: &InflowWindow| w.rate * (time.min(w.to) - w.from.max(0.0)).max(0.0);
        self.windows.iter().map(let_in).sum()
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;

    fn window(from: f64, to: f64, rate: f64, temperature: f64) -> InflowWindow {
        InflowWindow { from, to, rate, temperature }
    }

    #[test]
    fn overlapping_windows_add() {
        let schedule = Schedule::new(&[window(0.0, 2.0, 1.0, 300.0), window(1.0, 3.0, 2.0, 200.0)]);
        assert_eq!(schedule.edges(), [0.0, 1.0, 2.0, 3.0]);
        let both = schedule.between(1.0, 2.0);
        assert_eq!((both.mass, both.mass_temperature), (3.0, 700.0));
        assert_eq!(schedule.between(3.0, 4.0), Inflow::default());
        assert_eq!(schedule.mass_until(1.5), 1.5 + 1.0);
        assert_eq!(schedule.mass_until(9.0), 2.0 + 4.0);
    }

    #[test]
    fn no_windows_no_gas() {
        let schedule = Schedule::new(&[]);
        assert!(schedule.edges().is_empty());
        assert_eq!(schedule.between(0.0, 1.0), Inflow::default());
        assert_eq!(schedule.mass_until(1.0), 0.0);
    }
}
