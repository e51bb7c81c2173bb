//! The rows that a ranking reads.

use super::*;
use crate::analysis::fixture;

/// Strategies a and b with two seeds each. One run of a is not safe.
fn table() -> Table {
    fixture::table(
        "job strategy seed status safety
         1   a        1    done   safe
         2   a        2    done   unsafe
         3   b        1    done   safe
         4   b        2    done   safe",
    )
}

#[test]
fn a_condition_on_results_chooses_points_and_not_the_better_runs_of_them() {
    let (table, seed) = (table(), ["seed".to_owned()]);
    let strategy = ["strategy".to_owned()];
    let chosen = |condition, by: &[String]| rows(&table, Some(condition), by, &seed).unwrap();
    assert_eq!(chosen("safety == 'safe'", &strategy), [2, 3], "not the safe run of a");
    assert_eq!(chosen("safety == 'safe'", &[]), [2, 3]);
    assert_eq!(chosen("seed == 1", &strategy), [0, 2], "a condition on a replicate chooses runs");
    assert_eq!(chosen("safety == 'safe'", &seed), [0, 2, 3], "the seeds themselves are ranked");
    assert_eq!(rows(&table, None, &strategy, &seed).unwrap(), [0, 1, 2, 3]);
    let refused = rows(&table, Some("seed == 3"), &strategy, &seed).unwrap_err().to_string();
    assert!(refused.contains("no row fulfils this condition"), "{refused}");
}
