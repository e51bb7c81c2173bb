//! How long the reference cases take, for an estimate before they run.

use super::Case;

/// Cases that take half a second or more, and their times, s (source: `billow-checks validate --threads 1` on
/// one core of an idle x86-64 machine of 2023 with AVX-512). A core that is slower or shared needs up
/// to three times as long.
const SECONDS: &[(&str, f64)] = &[
    ("stretched_disc", 1.9),
    ("spinning_disc", 1.3),
    ("breathing_sphere_fine", 2.8),
    ("integrators_sphere", 1.5),
    ("integrators_disc", 1.5),
    ("integrators_every_step", 3.0),
    ("integrators_every_step_fine", 20.0),
    ("released_sphere", 1.0),
    ("moving_fold", 1.1),
    ("moving_fold_fine", 5.2),
    ("path_energy", 0.8),
    ("capsule_ledger", 0.5),
    ("static_sphere", 0.9),
    ("cone", 1.7),
    ("clamped_disc", 0.7),
    ("mylar_balloon", 1.8),
    ("square_airbag", 2.7),
    ("beam", 2.3),
    ("annulus_torsion", 1.1),
    ("end_state", 22.0),
    ("end_state_pattern", 220.0),
    ("end_state_polygon_fine", 0.9),
    ("end_state_polygon_finest", 7.0),
    ("stack", 3.0),
    ("tube_between_plates", 12.0),
    ("squeezed_bag", 2.0),
    ("squeezed_bag_stiff", 12.0),
    ("dropped_sheet", 8.5),
    ("friction", 0.9),
    ("adhesion", 0.8),
    ("capsule_every_step", 10.0),
    ("capsule_deployed", 2.6),
    ("capsule_deployed_fine", 10.0),
    ("contact_distance", 8.4),
    ("deployed_equals_inflated", 5.2),
    ("deployed_equals_inflated_fine", 32.0),
];

/// Time of a case that the table does not have, s (chosen: most of them take less).
const OTHER_SECONDS: f64 = 0.2;

/// Estimated time of a case on one core, s.
pub fn seconds(case: &Case) -> f64 {
    let known = SECONDS.iter().find(|(name, _)| *name == case.name);
    known.map_or(OTHER_SECONDS, |(_, seconds)| *seconds)
}

/// Estimated time of cases that start in this order on a number of threads, each with a core, s.
pub fn total_seconds(cases: &[&Case], threads: usize) -> f64 {
    let mut ends = vec![0.0_f64; threads.max(1)];
    for case in cases {
        let first = (0..ends.len()).min_by(|a, b| ends[*a].total_cmp(&ends[*b]));
        if let Some(thread) = first {
            ends[thread] += seconds(case);
        }
    }
    ends.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::CASES;

    #[test]
    fn every_time_is_that_of_a_case() {
        for (name, seconds) in SECONDS {
            assert!(CASES.iter().any(|case| case.name == *name), "{name}");
            assert!(*seconds >= 0.4);
        }
    }

    #[test]
    fn threads_share_the_cases_and_the_longest_case_remains() {
        let cases: Vec<&Case> = CASES.iter().collect();
        let [one, two, many] = [1, 2, 1000].map(|threads| total_seconds(&cases, threads));
        let longest = cases.iter().map(|case| seconds(case)).fold(0.0, f64::max);
        assert!(one > two && two > many && many >= longest);
        assert!((one - cases.iter().map(|case| seconds(case)).sum::<f64>()).abs() < 1e-9);
    }
}
