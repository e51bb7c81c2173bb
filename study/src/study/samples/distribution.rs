//! Distributions of an input, by their quantiles.
//!
//! ```text
//! uniform [a, b]            x = a + p (b − a)                log_uniform [a, b]   x = a (b/a)^p
//! normal [μ, σ]             x = μ + σ Φ⁻¹(p)                 log_normal [m, σ]    x = m e^(σ Φ⁻¹(p)),  m the median
//! triangular [a, c, b]      F(c) = (c − a)/(b − a);  x = a + √(p (b − a)(c − a)) below,  b − √((1 − p)(b − a)(b − c)) above
//! from, to                  p → F(from) + p (F(to) − F(from))
//! values, weights           the first value whose weights up to it reach p of their sum
//! ```

use crate::input::value::Value;
use crate::surrogate::normal;

/// A distribution of numbers in SI, or a choice among values.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Distribution {
    /// Between two numbers.
    Uniform([f64; 2]),
    /// Its logarithm between those of two positive numbers.
    LogUniform([f64; 2]),
    /// Mean and standard deviation.
    Normal([f64; 2]),
    /// Median, and standard deviation of the natural logarithm.
    LogNormal([f64; 2]),
    /// Least, most likely and largest value.
    Triangular([f64; 3]),
    /// Another one between two numbers.
    Truncated(Box<Distribution>, [f64; 2]),
    /// Values, each with its weight.
    Choice(Vec<(Value, f64)>),
}

impl Distribution {
    /// The value below which a part `p` of the distribution is, 0 < p < 1.
    pub fn quantile(&self, p: f64) -> Value {
        match self {
            Self::Choice(values) => {
                let all: f64 = values.iter().map(|(_, weight)| weight).sum();
                let mut reached = 0.0;
                let chosen = values.iter().find(|(_, weight)| {
                    reached += weight;
                    p * all <= reached
                });
                chosen.unwrap_or(&values[values.len() - 1]).0.clone()
            }
            _ => Value::Number(self.number(p)),
        }
    }

    fn number(&self, p: f64) -> f64 {
        match self {
            Self::Uniform([low, high]) => low + p * (high - low),
            Self::LogUniform([low, high]) => low * libm::exp(p * libm::log(high / low)),
            Self::Normal([mean, deviation]) => mean + deviation * normal::quantile(p),
            Self::LogNormal([median, deviation]) => {
                median * libm::exp(deviation * normal::quantile(p))
            }
            Self::Triangular([low, peak, high]) => {
                if p * (high - low) < peak - low {
                    low + libm::sqrt(p * (high - low) * (peak - low))
                } else {
                    high - libm::sqrt((1.0 - p) * (high - low) * (high - peak))
                }
            }
            Self::Truncated(of, [from, to]) => {
                let [low, high] = [of.part_below(*from), of.part_below(*to)];
                of.number(low + p * (high - low)).clamp(*from, *to)
            }
            Self::Choice(_) => unreachable!("a choice has no numbers"),
        }
    }

    /// The part of the distribution below a number.
    pub fn part_below(&self, x: f64) -> f64 {
        let part = match self {
            Self::Uniform([low, high]) => (x - low) / (high - low),
            Self::LogUniform([low, high]) if x > 0.0 => libm::log(x / low) / libm::log(high / low),
            Self::Normal([mean, deviation]) => normal::part_below((x - mean) / deviation),
            Self::LogNormal([median, deviation]) if x > 0.0 => {
                normal::part_below(libm::log(x / median) / deviation)
            }
            Self::LogUniform(_) | Self::LogNormal(_) => 0.0,
            Self::Triangular([low, _, _]) if x <= *low => 0.0,
            Self::Triangular([_, _, high]) if x >= *high => 1.0,
            Self::Triangular([low, peak, high]) if x < *peak => {
                let above = x - low;
                above * above / ((high - low) * (peak - low))
            }
            Self::Triangular([low, peak, high]) => {
                let below = high - x;
                1.0 - below * below / ((high - low) * (high - peak))
            }
            Self::Truncated(of, [from, to]) => {
                let [low, high] = [of.part_below(*from), of.part_below(*to)];
                (of.part_below(x) - low) / (high - low)
            }
            Self::Choice(_) => unreachable!("a choice has no numbers"),
        };
        part.clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_and_parts_are_inverse() {
        let normal = Distribution::Normal([3.0, 0.5]);
        for of in [
            Distribution::Uniform([-1.0, 2.0]),
            Distribution::LogUniform([0.01, 10.0]),
            normal.clone(),
            Distribution::LogNormal([2.0, 0.3]),
            Distribution::Triangular([0.0, 0.7, 1.0]),
            Distribution::Triangular([0.0, 0.0, 1.0]),
            Distribution::Truncated(Box::new(normal), [2.9, 4.0]),
        ] {
            let mut before = f64::NEG_INFINITY;
            for k in 1..100 {
                let p = f64::from(k) / 100.0;
                let x = of.number(p);
                assert!(x > before, "{of:?} rises");
                before = x;
                assert!((of.part_below(x) - p).abs() < 1e-12, "{of:?} {p} {x}");
            }
        }
        let choice = Distribution::Choice(vec![(Value::Integer(5), 1.0), (Value::Integer(6), 3.0)]);
        let count = (0..400)
            .filter(|k| choice.quantile((f64::from(*k) + 0.5) / 400.0) == Value::Integer(5));
        assert_eq!(count.count(), 100);
    }
}
