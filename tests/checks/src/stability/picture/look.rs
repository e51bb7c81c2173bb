//! The look of a status in a map: ground, the colour of what is drawn on it, and sign. Grounds are those of Okabe and
//! Ito, which colour-blind readers can distinguish; signs distinguish statuses in black and white.

use billow_study::render::figure::map::{Cell, Ground};
use billow_study::render::figure::style::Sign;

/// Names of statuses, ground, whether it is dark, sign. The last one is that of any other status.
const LOOKS: [(&str, &str, bool, Sign); 11] = [
    ("done", "#f3f3f3", false, Sign::Dot),
    ("unstable", "#d55e00", false, Sign::Cross),
    ("overstretched", "#009e73", false, Sign::Marker(1)),
    ("energy_drift", "#e69f00", false, Sign::Marker(2)),
    ("inverted_volume", "#cc79a7", false, Sign::Marker(4)),
    ("step_limit", "#56b4e9", false, Sign::Marker(6)),
    ("interpenetrated", "#0072b2", true, Sign::Marker(3)),
    ("inconsistent", "#8c510a", true, Sign::Marker(0)),
    ("no_equilibrium", "#f0e442", false, Sign::Marker(5)),
    ("invalid", "#b0b0b0", false, Sign::Bar),
    ("", "#000000", true, Sign::Cross),
];

/// The place of a status in the order of statuses.
pub(super) fn place(status: &str) -> usize {
    LOOKS.iter().position(|(name, ..)| *name == status).unwrap_or(LOOKS.len() - 1)
}

/// A cell of a status, without texts.
pub(super) fn cell(status: &str) -> Cell {
    let (_, ground, dark, sign) = LOOKS[place(status)];
    let ground = Ground::Colour(ground, if dark { "#ffffff" } else { "#000000" });
    Cell { ground, sign: Some(sign), ..Cell::default() }
}

#[cfg(test)]
mod tests {
    use billow_solver::output::outcome::FailureKind;

    use super::*;
    use billow_study::job::Status;

    #[test]
    fn every_status_of_a_run_has_a_look_of_its_own() {
        let failures = FailureKind::ALL.iter().map(|kind| kind.name());
        let others = [Status::Done, Status::NoEquilibrium, Status::Invalid];
        let places: Vec<usize> = failures.chain(others.map(Status::name)).map(place).collect();
        let distinct: std::collections::BTreeSet<&usize> = places.iter().collect();
        assert!(distinct.len() == places.len() && !places.contains(&(LOOKS.len() - 1)));
    }
}
