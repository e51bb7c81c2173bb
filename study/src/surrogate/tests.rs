//! Functions whose indices are known: Ishigami, Sobol' g, Morris.

use core::f64::consts::PI;

use super::*;

/// Points of the Sobol' sequence.
fn points(number: u32, inputs: u32) -> Vec<Vec<f64>> {
    let point = |k| (0..inputs).map(|j| f64::from(sobol_burley::sample(k, j, 1))).collect();
    (0..number).map(point).collect()
}

/// A function at these points, with chance of this size.
fn surrogate(points: &[Vec<f64>], of: &dyn Fn(&[f64]) -> f64, chance: f64) -> Surrogate {
    let value = |(k, x): (usize, &Vec<f64>)| of(x) + chance * normal(99, k as u64);
    let values: Vec<f64> = points.iter().enumerate().map(value).collect();
    Surrogate::fit(points, &values, &vec![false; points[0].len()]).unwrap()
}

/// Even values of each input.
fn values(inputs: usize) -> Vec<Vec<f64>> {
    vec![(0..64).map(|k| (f64::from(k) + 0.5) / 64.0).collect(); inputs]
}

/// Indices near the exact ones, which are within their intervals.
fn check(name: &str, found: &Indices, exact: &[[f64; 2]], near: f64) {
    for (input, (index, exact)) in found.inputs.iter().zip(exact).enumerate() {
        for ((value, [low, high]), exact) in [index.first, index.total].into_iter().zip(exact) {
            let text = format!(
                "{name}, input {input}: {value:.4} ({low:.4} to {high:.4}), exact {exact:.4}"
            );
            assert!((value - exact).abs() < near, "{text}");
            assert!(low <= *exact && *exact <= high, "{text}");
            assert!(high - low < 0.3, "{text}");
        }
    }
}

fn ishigami(x: &[f64]) -> f64 {
    let x: Vec<f64> = x.iter().map(|u| PI * (2.0 * u - 1.0)).collect();
    let (a, b) = (libm::sin(x[0]), libm::sin(x[1]));
    a + 7.0 * b * b + 0.1 * libm::pow(x[2], 4.0) * a
}

const ISHIGAMI: [[f64; 2]; 3] = [[0.3139, 0.5576], [0.4424, 0.4424], [0.0, 0.2437]];

/// Sobol' g with a = 0, 1, 4.5, 9, 99: `D_i = 1/(3 (1 + a_i)²), V = Π (1 + D_i) − 1`.
fn g(x: &[f64]) -> f64 {
    let factor = |(x, a): (&f64, &f64)| ((4.0 * x - 2.0).abs() + a) / (1.0 + a);
    x.iter().zip(&G).map(factor).product()
}

const G: [f64; 5] = [0.0, 1.0, 4.5, 9.0, 99.0];

fn indices_of_g() -> Vec<[f64; 2]> {
    let part = |a: &f64| 1.0 / (3.0 * (1.0 + a) * (1.0 + a));
    let all: f64 = G.iter().map(|a| 1.0 + part(a)).product();
    G.iter().map(|a| [part(a), part(a) * all / (1.0 + part(a))].map(|v| v / (all - 1.0))).collect()
}

/// Of M. D. Morris et al. (2006): `α Σ x_i + β Σ_{i<j} x_i x_j` over the first 4 of 6 inputs.
fn morris(x: &[f64]) -> f64 {
    let [alpha, beta] = morris_factors();
    let sum: f64 = x[..4].iter().sum();
    let squares: f64 = x[..4].iter().map(|x| x * x).sum();
    alpha * sum + beta * 0.5 * (sum * sum - squares)
}

fn morris_factors() -> [f64; 2] {
    [libm::sqrt(12.0) - 6.0 * libm::sqrt(0.1 * 3.0), 12.0 * libm::sqrt(0.1 * 3.0)]
}

fn indices_of_morris() -> Vec<[f64; 2]> {
    let [alpha, beta] = morris_factors();
    let alone = (alpha + 1.5 * beta) * (alpha + 1.5 * beta) / 12.0;
    let pair = beta * beta / 144.0;
    let all = 4.0 * alone + 6.0 * pair;
    let of = |input| if input < 4 { [alone / all, (alone + 3.0 * pair) / all] } else { [0.0; 2] };
    (0..6).map(of).collect()
}

#[test]
fn indices_are_those_of_closed_forms() {
    for (name, of, inputs, exact, number, near) in [
        ("ishigami", &ishigami as &dyn Fn(&[f64]) -> f64, 3, ISHIGAMI.to_vec(), 128, 0.05),
        ("g", &g, 5, indices_of_g(), 256, 0.05),
        ("morris", &morris, 6, indices_of_morris(), 64, 0.02),
    ] {
        let surrogate = surrogate(&points(number, inputs), of, 0.0);
        assert!(surrogate.foresees() > 0.9, "{name}");
        let found = surrogate.indices(&values(inputs as usize)).unwrap();
        check(name, &found, &exact, near);
        assert!(found.chance < 0.01, "{name} {}", found.chance);
    }
}

#[test]
fn chance_and_what_inputs_make_are_separated() {
    // Var(3 a + b) = 10/12, chance 0.25.
    let of = |x: &[f64]| 3.0 * x[0] + x[1];
    let surrogate = surrogate(&points(128, 3), &of, 0.5);
    let found = surrogate.indices(&values(3)).unwrap();
    let all = 10.0 / 12.0 + 0.25;
    assert!((found.chance - 0.25 / all).abs() < 0.06, "{}", found.chance);
    assert!((found.inputs[0].first.0 - 0.75 / all).abs() < 0.06, "{:?}", found.inputs[0]);
    let seen = surrogate.foresees();
    assert!((seen - 10.0 / 12.0 / all).abs() < 0.1, "what is left out has chance too: {seen}");
    assert!((surrogate.chance() - 0.5).abs() < 0.1);
    // Of chance alone it sees nothing.
    let values: Vec<f64> = (0..64).map(|k| normal(5, k)).collect();
    let blind = Surrogate::fit(&points(64, 3), &values, &[false; 3]).unwrap();
    assert!(blind.foresees() < 0.2, "{}", blind.foresees());
}

#[test]
fn words_have_no_order_and_points_left_out_are_those_of_a_fit_without_them() {
    let words = [true, false];
    let all: Vec<Vec<f64>> =
        points(30, 1).iter().enumerate().map(|(k, x)| vec![(k % 3) as f64, x[0]]).collect();
    let of = |x: &Vec<f64>| 3.0 * libm::cos(2.0 * x[0]) + libm::sin(3.0 * x[1]);
    let values: Vec<f64> = all.iter().map(of).collect();
    let surrogate = Surrogate::fit(&all, &values, &words).unwrap();
    for (point, value) in all.iter().zip(&values) {
        assert!((surrogate.at(point).0 - value).abs() < 1e-3);
    }
    for word in 0..3 {
        let point = vec![f64::from(word), 0.37];
        let (mean, deviation) = surrogate.at(&point);
        assert!((mean - of(&point)).abs() < 0.05, "{word}: {mean} +- {deviation}");
    }
    // The same scales without one point.
    let mut squares = 0.0;
    for left in 0..all.len() {
        let others = |k: &usize| *k != left;
        let kept: Vec<usize> = (0..all.len()).filter(others).collect();
        let points = kept.iter().map(|k| all[*k].clone()).collect();
        let known = kept.iter().map(|k| values[*k]).collect();
        let scales = surrogate.scales.clone();
        let fit = Surrogate::with(points, known, words.to_vec(), scales).unwrap();
        let error = fit.at(&all[left]).0 - values[left];
        squares += error * error / all.len() as f64;
    }
    let mean = values.iter().sum::<f64>() / 30.0;
    let all: f64 = values.iter().map(|y| (y - mean) * (y - mean) * 30.0 / (29.0 * 29.0)).sum();
    let found = surrogate.foresees();
    assert!(
        (1.0 - found - squares / all).abs() < 1e-6 * (1.0 - found),
        "{found} {}",
        squares / all
    );
    // Taken as known, a point is known.
    let believing = surrogate.believing(&[1.0, 2.0]).unwrap();
    assert!(believing.at(&[1.0, 2.0]).1 < 0.1 * surrogate.at(&[1.0, 2.0]).1);
}

#[test]
fn a_grid_of_many_points_keeps_all_values_of_its_axes() {
    // 20 × 16 × 3 in the order of a table: every third has one value of the last axis.
    let grid: Vec<Vec<f64>> = (0..960_u32)
        .map(|k| vec![f64::from(k / 48) / 20.0, f64::from(k / 3 % 16) / 16.0, f64::from(k % 3)])
        .collect();
    let values: Vec<f64> = grid.iter().map(|x| x[0] + 5.0 * (x[2] - 1.0).abs()).collect();
    let surrogate = Surrogate::fit(&grid, &values, &[false, false, true]).unwrap();
    let of_input = |j: usize| grid.iter().map(|point| point[j]).collect();
    let found = surrogate.indices(&[of_input(0), of_input(1), of_input(2)]).unwrap();
    assert!(found.inputs[2].first.0 > 0.95, "{:?}", found.inputs);
}
