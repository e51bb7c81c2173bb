//! One step of the pair of order 5(4) by Dormand and Prince (J. Comput. Appl. Math. 6, 1980, p. 19;
//! RK5(4)7M). The result has order 5; its last stage is the first stage of the next step.

const A: [[f64; 6]; 6] = [
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];

/// Weights of order 5 minus those of order 4.
const ERROR: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// A trial step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trial<const N: usize> {
    /// Length, s.
    pub(super) length: f64,
    /// y at its end.
    pub(super) state: [f64; N],
    /// Change of y.
    pub(super) increment: [f64; N],
    /// Estimated error of y.
    pub(super) error: [f64; N],
    /// f at its end.
    pub(super) last_rates: [f64; N],
}

impl<const N: usize> Trial<N> {
    pub(super) fn is_finite(&self) -> bool {
        let finite = |values: &[f64; N]| values.iter().all(|value| value.is_finite());
        finite(&self.state) && finite(&self.last_rates)
    }
}

/// A trial step from `state`, with f(state) = `rates`.
pub(super) fn step<const N: usize>(
    f: impl Fn(&[f64; N]) -> [f64; N],
    state: &[f64; N],
    rates: &[f64; N],
    length: f64,
) -> Trial<N> {
    let mut stages = [[0.0; N]; 7];
    stages[0] = *rates;
    let mut increment = [0.0; N];
    let mut end = *state;
    for (row, weights) in A.iter().enumerate() {
        for i in 0..N {
            let mut sum = 0.0;
            for (weight, stage) in weights.iter().zip(&stages).take(row + 1) {
                sum += weight * stage[i];
            }
            increment[i] = length * sum;
            end[i] = state[i] + increment[i];
        }
        stages[row + 1] = f(&end);
    }
    let mut error = [0.0; N];
    for (i, error) in error.iter_mut().enumerate() {
        let mut sum = 0.0;
        for (weight, stage) in ERROR.iter().zip(&stages) {
            sum += weight * stage[i];
        }
        *error = length * sum;
    }
    Trial { length, state: end, increment, error, last_rates: stages[6] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_satisfy_the_first_order_condition() {
        let nodes = [1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];
        for (row, node) in A.iter().zip(nodes) {
            assert!((row.iter().sum::<f64>() - node).abs() < 2e-15);
        }
        assert!(ERROR.iter().sum::<f64>().abs() < 1e-16);
    }

    #[test]
    fn polynomials_of_degree_five_are_exact() {
        // y = t^5; the state contains t.
        let f = |y: &[f64; 2]| [1.0, 5.0 * y[0] * y[0] * y[0] * y[0]];
        let start = [0.3, 0.3 * 0.3 * 0.3 * 0.3 * 0.3];
        let trial = step(f, &start, &f(&start), 0.7);
        assert!((trial.state[1] - 1.0).abs() < 1e-14);
    }
}
