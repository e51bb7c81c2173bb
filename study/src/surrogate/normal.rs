//! The standard normal distribution.
//!
//! Φ⁻¹: P. J. Acklam's rational approximation, then one step of Halley's method with the error function; error below
//! 1e-15 of the value or of one.

/// Φ, the part of the standard normal distribution below a number.
pub fn part_below(x: f64) -> f64 {
    0.5 * libm::erfc(-x * core::f64::consts::FRAC_1_SQRT_2)
}

/// Φ⁻¹ of a part between 0 and 1.
pub fn quantile(p: f64) -> f64 {
    // From the middle the tail is the mirror of the other one, where 1 − Φ loses no digits.
    if p > 0.5 {
        return -quantile(1.0 - p);
    }
    let x = approximate_quantile(p);
    let excess = (part_below(x) - p) * libm::sqrt(core::f64::consts::TAU) * libm::exp(0.5 * x * x);
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
            assert!((quantile(p) - x).abs() < 1e-13 * (1.0 + x.abs()), "{p}: {x}");
        }
        for k in 1..200 {
            let p = f64::from(k) / 200.0;
            assert!((part_below(quantile(p)) - p).abs() < 1e-15, "{p}");
        }
    }
}
