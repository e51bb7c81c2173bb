use billow_solver::platform::random::{hash, unit};

use super::parts::pratt;
use super::quantile::ranks;
use super::*;
use crate::analysis::fixture;

/// Samples of y = 3 a + b + noise, with a limit.
fn table(samples: u64) -> Table {
    let number = |seed: u64, index: u64| unit(hash(seed, index));
    let row = |i: u64| {
        let (a, b) = (number(1, i), number(2, i));
        let y = 10.0 + 3.0 * a + b + 0.1 * number(3, i);
        let safe = if y < 13.0 { "safe" } else { "unsafe" };
        format!("j{i} {a} {b} done {y} {safe}")
    };
    fixture::table_of("job a b status peak_vz safety", (1..=samples).map(row))
}

fn names(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

#[test]
fn parts_are_those_of_the_variance_of_a_sum() {
    let (table, inputs) = (table(400), names(&["a", "b"]));
    let found = Tolerance::all(&table, &fixture::limits(13.0), &inputs, (&inputs, true));
    let [point] = found.as_slice() else { panic!("{found:?}") };
    let spread = point.measures.iter().find(|one| one.measure == "peak_vz").unwrap();
    // Var = 9/12 + 1/12 + 0.01/12.
    let part = |name: &str| spread.inputs.parts.iter().find(|part| part.name == name).unwrap();
    for (name, exact) in [("a", 0.899), ("b", 0.0999)] {
        let Part { part, between, .. } = part(name).clone();
        let [low, high] = between.unwrap();
        assert!((part - exact).abs() < 0.04, "{name}: {part}");
        assert!(low < part && part < high && high - low < 0.2, "{name}: {low} {high}");
    }
    let budget: f64 = spread.budget.iter().map(|part| part.part).sum();
    assert!((budget - 1.0).abs() < 1e-12);
    assert!((spread.deviation - libm::sqrt(10.01 / 12.0)).abs() < 0.05);
    assert_eq!(point.safe.of, 400);
    let exact = point.safe.met as f64 / 400.0;
    assert!(point.safe_between[0] < exact && exact < point.safe_between[1]);
}

#[test]
fn ranks_of_quantiles_are_those_of_the_binomial_distribution() {
    // Conover, "Practical nonparametric statistics": the median of 20 is between x₆ and x₁₅.
    assert_eq!(ranks(20, 0.5), [Some(6), Some(15)]);
    // Of many samples, where 0.05ⁿ is below the smallest f64: the mirror, and the normal distribution.
    for n in [256, 5000] {
        let ([low, high], [other, _]) = (ranks(n, 0.95), ranks(n, 0.05));
        assert_eq!(other, high.map(|rank| n + 1 - rank), "{n}");
        let half = Z * libm::sqrt(n as f64 * 0.95 * 0.05);
        let exact = 0.95 * n as f64 - half;
        assert!((low.unwrap() as f64 - exact).abs() < 2.5, "{n}: {low:?} to {high:?}");
    }
    // 0.95¹⁰ > 2.5 %: ten samples say nothing of what is below the quantile of 5 %.
    assert_eq!(ranks(10, 0.05)[0], None);
    let sorted: Vec<f64> = (1..=100).map(f64::from).collect();
    let median = Quantile::of(&sorted, 0.5, 100);
    assert!((median.value - 50.0).abs() < 1e-12);
    assert_eq!(median.between, [Some(40.0), Some(61.0)]);
}

#[test]
fn noise_explains_little() {
    let explained = |trial: u64| -> f64 {
        let draw = |seed: u64| -> Vec<f64> {
            (1..=64).map(|i| unit(hash(100 * trial + seed, i))).collect()
        };
        let inputs: Vec<Vec<f64>> = (1..=8).map(draw).collect();
        pratt(&inputs, &draw(9), &(0..64).collect::<Vec<_>>()).unwrap().iter().sum()
    };
    let mean = (0..60).map(explained).sum::<f64>() / 60.0;
    assert!(mean < 0.06, "{mean}");
}

#[test]
fn runs_without_a_result_widen_the_interval_and_replicates_do_not_narrow_it() {
    let row = |i: u32| {
        let (sample, seed) = (i / 2, i % 2);
        let outcome = if sample < 8 { "done 10.0 safe" } else { "unstable - -" };
        format!("j{i} {sample}.5 {seed} {outcome}")
    };
    let table = fixture::table_of("job a seed status peak_vz safety", (0..20).map(row));
    let limits = fixture::limits(30.0);
    let found = Tolerance::all(&table, &limits, &names(&["a", "seed"]), (&names(&["a"]), true));
    let [point] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!((point.runs, point.samples, point.without_result), (20, 10, 4));
    assert_eq!(point.safe, Proportion { met: 16, of: 20 });
    let ten = Proportion { met: 8, of: 10 };
    assert!((point.safe_between[0] - ten.wilson()[0]).abs() < 1e-12);
    assert!((point.safe_between[1] - 1.0).abs() < 1e-12);
}

#[test]
fn few_samples_tell_no_parts() {
    let (table, inputs) = (table(9), names(&["a", "b"]));
    let found = Tolerance::all(&table, &[], &inputs, (&inputs, true));
    let spread = &found[0].measures.last().unwrap();
    assert_eq!((spread.inputs.parts.len(), spread.budget[0].name.as_str()), (0, "samples"));
    assert!(spread.without[2].contains("9 samples, 10 needed"), "{:?}", spread.without);
}
