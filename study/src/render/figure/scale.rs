//! From the values of an axis to millimetres on the page.

/// How values are spread along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Spread {
    /// Linearly.
    #[default]
    Linear,
    /// By their logarithm; every value is positive.
    Logarithmic,
}

/// An axis on the page.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Scale {
    spread: Spread,
    /// Values at the ends of the axis, after [`Spread::of`].
    low: f64,
    high: f64,
    /// Positions of the ends, mm.
    start: f64,
    end: f64,
}

impl Scale {
    /// An axis of values `low < high` between the positions `start` and `end`, mm.
    pub fn new(spread: Spread, [low, high]: [f64; 2], [start, end]: [f64; 2]) -> Self {
        Self { spread, low: spread.of(low), high: spread.of(high), start, end }
    }

    /// Position of a value, mm.
    pub fn position(&self, value: f64) -> f64 {
        let fraction = (self.spread.of(value) - self.low) / (self.high - self.low);
        self.start + fraction * (self.end - self.start)
    }

    /// Position of the low end, mm.
    pub fn start(&self) -> f64 {
        self.start
    }
}

impl Spread {
    fn of(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic => libm::log10(value),
        }
    }

    /// The better spread of these values of a parameter: logarithmic if they are positive, span a decade,
    /// and their ratios vary less than their differences.
    pub fn of_values(values: &[f64]) -> Self {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        let (Some(first), Some(last)) = (sorted.first(), sorted.last()) else {
            return Self::Linear;
        };
        if !(*first > 0.0 && *last >= 10.0 * first && sorted.len() > 2) {
            return Self::Linear;
        }
        let uneven = |spread: Self| {
            let gaps = || sorted.windows(2).map(|pair| spread.of(pair[1]) - spread.of(pair[0]));
            gaps().fold(0.0, f64::max) / gaps().fold(f64::INFINITY, f64::min)
        };
        if uneven(Self::Logarithmic) < uneven(Self::Linear) {
            Self::Logarithmic
        } else {
            Self::Linear
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_end_values_lie_at_the_end_positions() {
        let scale = Scale::new(Spread::Linear, [-1.0, 3.0], [100.0, 20.0]);
        for (value, position) in [(-1.0, 100.0), (1.0, 60.0), (3.0, 20.0)] {
            assert!((scale.position(value) - position).abs() < 1e-12);
        }
        let scale = Scale::new(Spread::Logarithmic, [0.01, 1.0], [0.0, 10.0]);
        assert!((scale.position(0.1) - 5.0).abs() < 1e-12);
    }

    #[test]
    fn decades_get_a_logarithmic_axis() {
        for (values, spread) in [
            (&[1.0, 10.0, 100.0][..], Spread::Logarithmic),
            (&[0.001, 0.002, 0.005, 0.01], Spread::Logarithmic),
            (&[1.0, 2.0, 5.0], Spread::Linear),
            (&[1.0, 100.0], Spread::Linear),
            (&[0.0, 1.0, 10.0, 100.0], Spread::Linear),
            (&[1.0, 4.0, 7.0, 10.0], Spread::Linear),
            (&[], Spread::Linear),
        ] {
            assert_eq!(Spread::of_values(values), spread, "{values:?}");
        }
    }

    proptest! {
        #[test]
        fn positions_keep_the_order_of_values(a in -1e6..1e6, b in -1e6..1e6) {
            let scale = Scale::new(Spread::Linear, [-1e6, 1e6], [0.0, 100.0]);
            prop_assert!(a > b || scale.position(a) <= scale.position(b));
            prop_assert!((0.0..=100.0).contains(&scale.position(a)));
        }
    }
}
