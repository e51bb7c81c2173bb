//! Distributions of an input, by their quantiles.
//!
//! ```text
//! uniform [a, b]            x = a + p (b − a)                log_uniform [a, b]   x = a (b/a)^p
//! normal [μ, σ]             x = μ + σ Φ⁻¹(p)                 log_normal [m, σ]    x = m e^(σ Φ⁻¹(p)),  m the median
//! triangular [a, c, b]      F(c) = (c − a)/(b − a);  x = a + √(p (b − a)(c − a)) below,  b − √((1 − p)(b − a)(b − c)) above
//! from, to                  p → F(from) + p (F(to) − F(from))
//! values, weights           the first value whose weights up to it reach p of their sum
//! ```
//!
//! Φ⁻¹: P. J. Acklam's rational approximation, then one step of Halley's method with the error function; error below
//! 1e-15 of the value or of one.

use crate::input::value::Value;

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
            Self::Normal([mean, deviation]) => mean + deviation * normal_quantile(p),
            Self::LogNormal([median, deviation]) => {
                median * libm::exp(deviation * normal_quantile(p))
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
            Self::Normal([mean, deviation]) => normal_part_below((x - mean) / deviation),
            Self::LogNormal([median, deviation]) if x > 0.0 => {
                normal_part_below(libm::log(x / median) / deviation)
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

/// Φ, the part of the standard normal distribution below a number.
pub(super) fn normal_part_below(x: f64) -> f64 {
    0.5 * libm::erfc(-x * core::f64::consts::FRAC_1_SQRT_2)
}

/// Φ⁻¹ of a part between 0 and 1.
pub(super) fn normal_quantile(p: f64) -> f64 {
    // From the middle the tail is the mirror of the other one, where 1 − Φ loses no digits.
    if p > 0.5 {
        return -normal_quantile(1.0 - p);
    }
    let x = approximate_quantile(p);
    let excess =
        (normal_part_below(x) - p) * libm::sqrt(core::f64::consts::TAU) * libm::exp(0.5 * x * x);
    x - excess / (1.0 + 0.5 * x * excess)
}

/// Acklam's approximation for p up to one half, with a relative error below 1.15e-9.
fn approximate_quantile(p: f64) -> f64 {
    const A: [f64; 6] = [
        -3.969_683_028_665_376e1,
        2.209_460_984_245_205e2,
        -2.759_285_104_469_687e2,
        1.383_577_518_672_69e2,
        -3.066_479_806_614_716e1,
        2.506_628_277_459_239,
    ];
    const B: [f64; 6] = [
        -5.447_609_879_822_406e1,
        1.615_858_368_580_409e2,
        -1.556_989_798_598_866e2,
        6.680_131_188_771_972e1,
        -1.328_068_155_288_572e1,
        1.0,
    ];
    const C: [f64; 6] = [
        -7.784_894_002_430_293e-3,
        -3.223_964_580_411_365e-1,
        -2.400_758_277_161_838,
        -2.549_732_539_343_734,
        4.374_664_141_464_968,
        2.938_163_982_698_783,
    ];
    const D: [f64; 5] = [
        7.784_695_709_041_462e-3,
        3.224_671_290_700_398e-1,
        2.445_134_137_142_996,
        3.754_408_661_907_416,
        1.0,
    ];
    let polynomial = |of: &[f64], x: f64| of.iter().fold(0.0, |sum, c| sum * x + c);
    if p < 0.024_25 {
        let q = libm::sqrt(-2.0 * libm::log(p));
        return polynomial(&C, q) / polynomial(&D, q);
    }
    let q = p - 0.5;
    let r = q * q;
    q * polynomial(&A, r) / polynomial(&B, r)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_quantiles_are_those_of_the_tables() {
        // Abramowitz and Stegun, table 26.5; and the ends of f64.
        for (p, x) in [
            (0.5, 0.0),
            (0.975, 1.959_963_984_540_054),
            (0.9, 1.281_551_565_544_6),
            (0.999, 3.090_232_306_167_813),
            (1e-9, -5.997_807_015_007_686_6),
        ] {
            assert!((normal_quantile(p) - x).abs() < 1e-13 * (1.0 + x.abs()), "{p}: {x}");
        }
        for k in 1..200 {
            let p = f64::from(k) / 200.0;
            assert!((normal_part_below(normal_quantile(p)) - p).abs() < 1e-15, "{p}");
        }
    }

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
