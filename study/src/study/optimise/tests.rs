//! Functions whose smallest value is known.

use core::f64::consts::PI;

use super::*;

/// A function of points of the unit cube: its measures, and the margins of its limits.
type Function = fn(&[f64]) -> (Vec<f64>, Vec<f64>);

fn optimise(inputs: usize, measures: usize, budget: usize, seed: u32) -> Optimise {
    Optimise {
        minimise: vec![ColumnId::PeakVz; measures],
        columns: (0..inputs).collect(),
        coordinates: vec![Coordinate::Linear([0.0, 1.0]); inputs],
        budget,
        batch: 4,
        seed,
        has_prior: false,
    }
}

/// The search of a function, with all of its budget; `cheap` stands for it before it is known.
fn search(optimise: &Optimise, of: Function, cheap: Option<Function>) -> Vec<Trial> {
    let trial = |of: Function, values: Vec<Value>, generation: u32| {
        let place = optimise.place(&values);
        let (measures, margins) = of(&place);
        let keeps_limits = margins.iter().all(|margin| *margin > 0.0);
        Trial {
            values,
            place,
            generation,
            jobs: Vec::new(),
            measures: measures.into_iter().map(Some).collect(),
            margins: margins.into_iter().map(Some).collect(),
            keeps_limits,
            at_end: Vec::new(),
            ended: true,
        }
    };
    let mut trials: Vec<Trial> =
        optimise.first_values().into_iter().map(|values| trial(of, values, 0)).collect();
    let prior = |trials: &[Trial]| -> Vec<Trial> {
        let Some(cheap) = cheap else { return Vec::new() };
        let spread = sobol(optimise.columns.len(), optimise.seed).take(prior::POINTS);
        let spread = spread.map(|point| optimise.values(&point));
        let tried = trials.iter().map(|known| known.values.clone());
        spread.chain(tried).map(|values| trial(cheap, values, 0)).collect()
    };
    let mut generation = 1;
    while trials.len() < optimise.budget {
        let batch = optimise.batch.min(optimise.budget - trials.len());
        let beside = format!("{}", cheap.map_or(0, |cheap| cheap as usize));
        let prior = || prior(&trials);
        let known = proposed::Known { trials: &trials, beside: &beside, prior: &prior };
        let proposed = proposed::next(optimise, &known, (batch, generation), &|_| true);
        assert!(!proposed.is_empty());
        trials.extend(proposed.into_iter().map(|values| trial(of, values, generation)));
        generation += 1;
    }
    trials
}

/// The smallest value of the first measure among points that keep the limits.
fn smallest(trials: &[Trial]) -> f64 {
    let kept = trials.iter().filter(|trial| trial.keeps_limits);
    kept.filter_map(|trial| trial.measures[0]).fold(f64::INFINITY, f64::min)
}

/// Branin, smallest 0.397887.
fn branin(x: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (x, y) = (15.0 * x[0] - 5.0, 15.0 * x[1]);
    let square = y - 5.1 / (4.0 * PI * PI) * x * x + 5.0 / PI * x - 6.0;
    (vec![square * square + 10.0 * (1.0 - 1.0 / (8.0 * PI)) * libm::cos(x) + 10.0], vec![])
}

/// The sum of two numbers in a region with two limits (R. B. Gramacy et al., 2016), smallest 0.599788.
fn toy(x: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (a, b) = (x[0], x[1]);
    let first = 0.5 * libm::sin(2.0 * PI * (a * a - 2.0 * b)) + a + 2.0 * b - 1.5;
    (vec![a + b], vec![first, 1.5 - a * a - b * b])
}

/// Hartmann's function of three numbers, smallest −3.86278.
fn hartmann(x: &[f64]) -> (Vec<f64>, Vec<f64>) {
    const A: [[f64; 3]; 4] =
        [[3.0, 10.0, 30.0], [0.1, 10.0, 35.0], [3.0, 10.0, 30.0], [0.1, 10.0, 35.0]];
    const P: [[f64; 3]; 4] = [
        [0.3689, 0.1170, 0.2673],
        [0.4699, 0.4387, 0.7470],
        [0.1091, 0.8732, 0.5547],
        [0.0381, 0.5743, 0.8828],
    ];
    let part = |i: usize| {
        let sum: f64 = (0..3).map(|j| A[i][j] * (x[j] - P[i][j]) * (x[j] - P[i][j])).sum();
        [1.0, 1.2, 3.0, 3.2][i] * libm::exp(-sum)
    };
    (vec![-(0..4).map(part).sum::<f64>()], vec![])
}

#[test]
fn the_smallest_value_of_closed_forms_is_found() {
    for (name, of, inputs, smallest_value, near, budget) in [
        ("branin", branin as Function, 2, 0.397_887, 0.05, 40),
        ("toy", toy, 2, 0.599_788, 0.01, 40),
        ("hartmann", hartmann, 3, -3.862_78, 0.05, 40),
    ] {
        let mut worst = 0.0_f64;
        for seed in 1..=5 {
            let trials = search(&optimise(inputs, 1, budget, seed), of, None);
            let away = smallest(&trials) - smallest_value;
            worst = worst.max(away);
        }
        assert!(worst < near, "{name}: {worst}");
    }
}

/// Branin with other constants, a slope and another scale.
fn cheap_branin(x: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let moved = [(0.95 * x[0] + 0.03).min(1.0), (0.95 * x[1] + 0.02).min(1.0)];
    (vec![0.4 * branin(&moved).0[0] + 8.0 * x[0] - 5.0], vec![])
}

/// Falls where Branin rises.
fn misleading(x: &[f64]) -> (Vec<f64>, Vec<f64>) {
    (vec![-branin(x).0[0] + 100.0 * libm::sin(9.0 * x[0])], vec![])
}

#[test]
fn a_cheap_model_saves_points_and_a_misleading_one_costs_few() {
    let after = |budget: usize, cheap: Option<Function>| -> f64 {
        let away = |seed: u32| {
            let mut optimise = optimise(2, 1, budget, seed);
            optimise.has_prior = cheap.is_some();
            smallest(&search(&optimise, branin, cheap)) - 0.397_887
        };
        // The geometric mean of five seeds.
        libm::exp((1..=5).map(|seed| libm::log(away(seed).max(1e-9))).sum::<f64>() / 5.0)
    };
    let (alone, cheap) = (after(16, None), after(16, Some(cheap_branin)));
    assert!(cheap < 0.2 * alone, "{cheap} with the cheap model, {alone} without");
    let (alone, misled) = (after(40, None), after(40, Some(misleading)));
    assert!(misled < 10.0 * alone.max(1e-4), "{misled} with a misleading model, {alone} without");
}
