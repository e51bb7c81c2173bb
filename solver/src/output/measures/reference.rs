//! The static reference: static equilibria with which the verdict compares a deployment.

/// Overpressures at which every model gives its static equilibrium, Pa.
pub const REFERENCE_PRESSURES: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];

/// `V_ref(p)` and `H_ref(p)`: static equilibria of one design, film and supports; linear in log p between the
/// tabulated pressures, constant outside them.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Overpressure, Pa, volume, m³, and mean height of the top ring, m; ascending pressure.
    states: Vec<[f64; 3]>,
}

impl Reference {
    /// A table of static equilibria: overpressure (Pa, positive, ascending), volume (m³), height (m).
    ///
    /// # Panics
    /// Without a state, or if the pressures do not ascend: an error in the code of a model.
    pub fn new(states: Vec<[f64; 3]>) -> Self {
        let ascending = states.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        assert!(ascending && states.first().is_some_and(|first| first[0] > 0.0), "{states:?}");
        Self { states }
    }

    /// The table: overpressure (Pa), volume (m³), height (m), ascending pressure.
    pub fn states(&self) -> &[[f64; 3]] {
        &self.states
    }

    /// Volume (m³) and height (m) at an overpressure (Pa). Below the lowest tabulated pressure, also at 0
    /// and below, they are those of the lowest.
    pub fn at(&self, overpressure: f64) -> (f64, f64) {
        let above = self.states.iter().position(|state| state[0] >= overpressure);
        let (low, high) = match above {
            Some(0) => (0, 0),
            Some(index) => (index - 1, index),
            None => (self.states.len() - 1, self.states.len() - 1),
        };
        let ([p0, v0, h0], [p1, v1, h1]) = (self.states[low], self.states[high]);
        if low == high {
            return (v0, h0);
        }
        let fraction = libm::log(overpressure / p0) / libm::log(p1 / p0);
        (v0 + fraction * (v1 - v0), h0 + fraction * (h1 - h0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reference_is_linear_in_log_p_and_clamped() {
        let table = Reference::new(vec![[1.0, 1.0, 10.0], [10.0, 2.0, 20.0], [100.0, 4.0, 25.0]]);
        assert_eq!(table.at(0.0), (1.0, 10.0));
        assert_eq!(table.at(-5.0), (1.0, 10.0));
        assert_eq!(table.at(1.0), (1.0, 10.0));
        assert_eq!(table.at(10.0), (2.0, 20.0));
        assert_eq!(table.at(1e6), (4.0, 25.0));
        let (volume, height) = table.at(1000.0_f64.sqrt());
        assert!((volume - 3.0).abs() < 1e-14 && (height - 22.5).abs() < 1e-14);
    }

    #[test]
    #[should_panic(expected = "10.0")]
    fn descending_pressures_are_refused() {
        let _ = Reference::new(vec![[10.0, 1.0, 1.0], [1.0, 1.0, 1.0]]);
    }
}
