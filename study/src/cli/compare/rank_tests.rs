//! The rows that a ranking reads.

use super::*;
use crate::input::value::Value;
use crate::job::row::CellType;

/// Strategies a and b with two seeds each. One run of a is not safe.
fn table() -> Table {
    let text = |words: [&str; 4]| words.map(|word| Value::Text(word.to_owned())).to_vec();
    Table {
        columns: vec![
            Column::plain("job", CellType::Text, text(["1", "2", "3", "4"])),
            Column::plain("strategy", CellType::Text, text(["a", "a", "b", "b"])),
            Column::plain("seed", CellType::Integer, [1, 2, 1, 2].map(Value::Integer).to_vec()),
            Column::plain("status", CellType::Text, text(["done"; 4])),
            Column::plain(
                "safe",
                CellType::Bool,
                [true, false, true, true].map(Value::Bool).to_vec(),
            ),
        ],
    }
}

#[test]
fn a_condition_on_results_chooses_points_and_not_the_better_runs_of_them() {
    let (table, seed) = (table(), ["seed".to_owned()]);
    let strategy = ["strategy".to_owned()];
    let chosen = |condition, by: &[String]| rows(&table, Some(condition), by, &seed).unwrap();
    assert_eq!(chosen("safe", &strategy), [2, 3], "not the safe run of a");
    assert_eq!(chosen("safe", &[]), [2, 3]);
    assert_eq!(chosen("seed == 1", &strategy), [0, 2], "a condition on a replicate chooses runs");
    assert_eq!(chosen("safe", &seed), [0, 2, 3], "the seeds themselves are ranked");
    assert_eq!(rows(&table, None, &strategy, &seed).unwrap(), [0, 1, 2, 3]);
    let refused = rows(&table, Some("seed == 3"), &strategy, &seed).unwrap_err().to_string();
    assert!(refused.contains("no row fulfils this condition"), "{refused}");
}
