//! Static states a deployment is judged against.

/// Overpressures at which every model gives its static state, Pa.
pub const REFERENCE_PRESSURES: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];

/// `V_ref(p)` and `H_ref(p)`: static states of one design, film and supports, linear in log p
/// between the pressures given, constant outside them.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Overpressure, Pa, volume, m³, and mean height of the top ring, m; pressure rising.
    states: Vec<[f64; 3]>,
}

impl Reference {
    /// A table of static states: overpressure (Pa, positive, rising), volume (m³), height (m).
    ///
    /// # Panics
    /// Without a state, or with pressures that do not rise: a model that gives such is a mistake in
    /// code.
    pub fn new(states: Vec<[f64; 3]>) -> Self {
        let rising = states.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        assert!(rising && states.first().is_some_and(|first| first[0] > 0.0), "{states:?}");
        Self { states }
    }

    /// The table: overpressure (Pa), volume (m³), height (m), pressure rising.
    pub fn states(&self) -> &[[f64; 3]] {
        &self.states
    }

    /// Volume (m³) and height (m) at an overpressure (Pa). Below the lowest pressure, none and
    /// suction included, they are those of the lowest.
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
        let share = libm::log(overpressure / p0) / libm::log(p1 / p0);
        (v0 + share * (v1 - v0), h0 + share * (h1 - h0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_in_log_p_and_clamped() {
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
    fn falling_pressures_are_refused() {
        let _ = Reference::new(vec![[10.0, 1.0, 1.0], [1.0, 1.0, 1.0]]);
    }
}
