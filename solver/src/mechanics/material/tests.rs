use super::*;

fn material(compression: f64) -> Material {
    Material::new(&Film { compression, numerical_damping: 0.0, ..Film::PAPER })
}

/// The strain with these principal values, the first at `angle` (rad) to x.
fn rotated(e1: f64, e2: f64, angle: f64) -> PlaneTensor {
    let (sin, cos) = libm::sincos(angle);
    PlaneTensor {
        xx: e1 * cos * cos + e2 * sin * sin,
        yy: e1 * sin * sin + e2 * cos * cos,
        xy: (e1 - e2) * sin * cos,
    }
}

const STRAINS: [(f64, f64, Regime); 6] = [
    (2e-3, 1e-3, Regime::Taut),
    (2e-3, -5e-4, Regime::Taut),
    (2e-3, -1e-3, Regime::Wrinkled),
    (1e-3, -5e-2, Regime::Wrinkled),
    (-1e-4, -2e-3, Regime::Slack),
    (-2e-3, -2e-3, Regime::Slack),
];

#[test]
fn stress_is_the_derivative_of_energy_in_every_regime() {
    for c in [0.0, 1e-3, 0.3, 1.0] {
        let material = material(c);
        for (e1, e2, regime) in STRAINS {
            for angle in [0.0, 0.4, 2.0] {
                let strain = rotated(e1, e2, angle);
                assert_eq!(material.regime(strain), regime);
                let stress = material.stress(strain).tensor;
                let h = 1e-7;
                let slope = |dxx: f64, dyy: f64, dxy: f64| {
                    let energy = |s: f64| {
                        material.energy_density(PlaneTensor {
                            xx: strain.xx + s * dxx,
                            yy: strain.yy + s * dyy,
                            xy: strain.xy + s * dxy,
                        })
                    };
                    (energy(h) - energy(-h)) / (2.0 * h)
                };
                let scale = 1e-6 * material.youngs_modulus * 2e-3;
                assert!((stress.xx - slope(1.0, 0.0, 0.0)).abs() < scale, "{strain:?} {c}");
                assert!((stress.yy - slope(0.0, 1.0, 0.0)).abs() < scale, "{strain:?} {c}");
                // xy and yx change together.
                assert!((2.0 * stress.xy - slope(0.0, 0.0, 1.0)).abs() < scale, "{strain:?}");
            }
        }
    }
}

#[test]
fn stress_is_continuous_between_regimes() {
    let material = material(0.0);
    let assert_equal = |a: PlaneTensor, b: PlaneTensor| {
        let [a, b] = [a, b].map(|e| material.stress(e).tensor);
        let gap = (a.xx - b.xx).abs() + (a.yy - b.yy).abs() + (a.xy - b.xy).abs();
        assert!(gap < 1e-9 * material.youngs_modulus, "{a:?} {b:?}");
    };
    let small = 1e-11;
    assert_equal(rotated(1e-3, -0.3e-3 + small, 0.7), rotated(1e-3, -0.3e-3 - small, 0.7));
    assert_equal(rotated(small, -1e-3, 0.7), rotated(-small, -1e-3, 0.7));
    assert_equal(rotated(small, small, 0.7), rotated(-small, -small, 0.7));
}

#[test]
fn stress_is_linear_at_full_compression() {
    let material = material(1.0);
    for (e1, e2, _) in STRAINS {
        let strain = rotated(e1, e2, 1.0);
        let stress = material.stress(strain);
        let (k, nu) = (material.plane_modulus, material.poisson_ratio);
        let scale = material.youngs_modulus * 1e-15;
        assert!((stress.tensor.xx - (strain.xx + strain.yy * nu) * k).abs() < scale);
        assert!((stress.tensor.xy - strain.xy * (k * (1.0 - nu))).abs() < scale);
        assert!((stress.largest - stress.tensor.principal().0).abs() < 100.0 * scale);
    }
}

#[test]
fn slack_and_unstrained_film_are_free_of_stress() {
    let material = material(0.0);
    for strain in [PlaneTensor::default(), rotated(-1e-3, -1e-3, 0.0)] {
        assert_eq!(material.stress(strain).tensor, PlaneTensor::default());
        assert_eq!(material.stress(strain).largest, 0.0);
        assert_eq!(material.energy_density(strain), 0.0);
    }
}

#[test]
fn largest_stress_is_the_principal_value_of_the_tensor() {
    for c in [0.0, 0.2] {
        let material = material(c);
        for (e1, e2, _) in STRAINS {
            let stress = material.stress(rotated(e1, e2, 0.3));
            let (s1, _) = stress.tensor.principal();
            assert!((stress.largest - s1).abs() < 1e-9 * material.youngs_modulus);
        }
    }
}
