//! What a constant heat capacity of a gas leaves out.

use billow_solver::scene::Species;

/// Specific gas constant of carbon dioxide, J/(kg K). Of the named gases it alone has a cp that changes by more than 5 %
/// from 200 to 400 K: 735, 846, 939 J/(kg K) at 200, 300, 400 K (NIST).
const CARBON_DIOXIDE: f64 = 188.924;

/// A note on a gas whose cp changes with its temperature.
pub fn note(species: &Species) -> Option<String> {
    let is = (species.gas_constant / CARBON_DIOXIDE - 1.0).abs() < 0.01;
    is.then(|| {
        "cp of carbon dioxide is taken constant; it is 735 J/(kg K) at 200 K and 939 at 400 K, so temperatures far from 300 K \
         are wrong by up to a tenth of the difference"
            .to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn carbon_dioxide_alone_is_noted() {
        let of = |gas_constant| note(&Species { gas_constant, cp: 3.0 * gas_constant }).is_some();
        assert_eq!(
            [188.924, 188.9, 296.8, 287.055, 2077.0].map(of),
            [true, true, false, false, false]
        );
    }
}
