//! The same job gives the same bits, whatever other jobs run.

use crate::support::{TestFolder, histories, small_grid, without_costs};

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let one = TestFolder::new(&small_grid());
    one.stdout(&["run", "grid.json", "-q", "--threads", "1"]);
    let two = TestFolder::new(&small_grid());
    two.stdout(&["run", "grid.json", "-q", "--threads", "2"]);
    let (rows, others) = (one.rows("results/grid"), two.rows("results/grid"));
    assert_eq!(without_costs(rows.clone()), without_costs(others));
    let (files, others) = (histories(&one.results()), histories(&two.results()));
    assert_eq!(files.len(), 16);
    assert_eq!(files, others);

    let hashes = |rows: &[serde_json::Value]| -> std::collections::BTreeSet<String> {
        rows.iter().filter_map(|row| Some(row["content_hash"].as_str()?.to_owned())).collect()
    };
    assert_eq!(hashes(&rows).len(), 16, "different jobs, different histories");
}

#[test]
fn a_job_has_the_same_history_in_every_study() {
    let whole = TestFolder::finished(&small_grid());
    let mut study = small_grid();
    study["grid"]["N"] = serde_json::json!([6]);
    study["grid"]["M"] = serde_json::json!([3, 2]);
    let part = TestFolder::finished(&study);
    let all = histories(&whole.results());
    let some = histories(&part.results());
    assert_eq!(some.len(), 8);
    for (name, bytes) in some {
        assert_eq!(all.get(&name), Some(&bytes), "{}", name.display());
    }
}
