//! Student's distribution, for deviations that are known from few values.

/// Nine of ten values are smaller, in magnitude; for 1, 2, … degrees of freedom.
const NINE_OF_TEN: [f64; 30] = [
    6.314, 2.920, 2.353, 2.132, 2.015, 1.943, 1.895, 1.860, 1.833, 1.812, 1.796, 1.782, 1.771,
    1.761, 1.753, 1.746, 1.740, 1.734, 1.729, 1.725, 1.721, 1.717, 1.714, 1.711, 1.708, 1.706,
    1.703, 1.701, 1.699, 1.697,
];

/// How many standard deviations hold nine of ten values, where the standard deviation has this number of degrees of
/// freedom; of 0 as of 1, above 30 as of 30.
pub fn nine_of_ten(degrees_of_freedom: usize) -> f64 {
    NINE_OF_TEN[degrees_of_freedom.clamp(1, NINE_OF_TEN.len()) - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fewer_values_give_more_deviations() {
        assert!(NINE_OF_TEN.is_sorted_by(|few, many| few > many));
        assert_eq!(nine_of_ten(0).to_bits(), nine_of_ten(1).to_bits());
        assert_eq!(nine_of_ten(18).to_bits(), 1.734_f64.to_bits());
        assert!(nine_of_ten(1000) > 1.645, "that of the normal distribution");
    }
}
