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
    }
}

/// The search of a function, with all of its budget.
fn search(optimise: &Optimise, of: Function) -> Vec<Trial> {
    let trial = |values: Vec<Value>, generation: u32| {
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
        optimise.first_values().into_iter().map(|values| trial(values, 0)).collect();
    let mut generation = 1;
    while trials.len() < optimise.budget {
        let batch = optimise.batch.min(optimise.budget - trials.len());
        let proposed = acquisition::proposed(optimise, &trials, (batch, generation), &|_| true);
        assert!(!proposed.is_empty());
        trials.extend(proposed.into_iter().map(|values| trial(values, generation)));
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
            let trials = search(&optimise(inputs, 1, budget, seed), of);
            let away = smallest(&trials) - smallest_value;
            worst = worst.max(away);
        }
        assert!(worst < near, "{name}: {worst}");
    }
}
