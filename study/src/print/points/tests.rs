//! The points of a small table: columns, cells, conditions.

use super::*;
use crate::analysis::fixture;

/// Strategy a: three seeds, one failed. Strategy b: three seeds, all safe.
fn table() -> Table {
    let mut table = fixture::table(
        "job strategy seed status   verdict  peak_vz safety  smallest_margin smallest_margin_of verdict_depends_on same_job_as film.thickness
         1   a        1    done     deployed 20.0    safe  0.2             peak_vz            seed               -           2e-5
         2   a        2    done     stalled  30.0    unsafe -0.2            verdict            seed               -           2e-5
         3   a        3    unstable -        99.0    -     9.0             -                  -                  -           2e-5
         4   b        1    done     deployed 10.0    safe  0.6             peak_vz            -                  -           2e-5
         5   b        2    done     deployed 11.0    safe  0.5612          peak_vz            -                  -           2e-5
         6   b        3    done     deployed 15.0    safe  0.4             peak_vz            -                  -           2e-5",
    );
    table.columns[10].cell_type = crate::job::row::CellType::Text;
    table
}

fn seeds() -> Vec<String> {
    vec!["seed".to_owned()]
}

#[test]
fn a_point_has_one_number_per_column_for_programs() {
    let table = table();
    let points = PointTable::of(&table, &[0, 1, 2, 3, 4, 5], &seeds());
    let cells = |name: &str| points.table.column(name).unwrap().cells.clone();
    let integers = |numbers: [i64; 2]| numbers.map(Value::Integer).to_vec();
    assert_eq!(cells("runs"), integers([3, 3]));
    assert_eq!(cells("runs_failed"), integers([1, 0]));
    for name in ["deployed", "safe"] {
        assert_eq!(cells(name), integers([1, 3]));
        assert_eq!(cells(&format!("{name}_of")), integers([2, 3]));
    }
    let Value::Number(low) = cells("deployed_low")[1] else { panic!() };
    assert!((low - 0.44).abs() < 5e-3, "Wilson: 3 of 3: {low}");
    assert_eq!(cells("peak_vz"), [25.0, 11.0].map(Value::Number));
    assert_eq!(cells("peak_vz_least"), [20.0, 10.0].map(Value::Number));
    assert_eq!(cells("peak_vz_largest"), [30.0, 15.0].map(Value::Number));
    assert_eq!(cells("smallest_margin"), [-0.2, 0.4].map(Value::Number), "the least is safe");
    let medians = points.condensed.table.column("smallest_margin").unwrap();
    assert_eq!(medians.cells, cells("smallest_margin"), "one meaning everywhere");
    assert_eq!(cells("smallest_margin_of")[0], Value::Text("verdict".to_owned()));
    assert_eq!(cells("verdict_depends_on"), [Value::Text("seed".to_owned()), Value::Null]);
    assert_eq!(cells("film.thickness"), [Value::Number(2e-5), Value::Number(2e-5)]);
    let parameters: Vec<&str> = points.table.parameters().map(|column| &*column.name).collect();
    assert_eq!(parameters, ["strategy"]);
    assert!(points.table.column("job").is_none(), "a point has several jobs");
}

#[test]
fn a_cell_for_a_reader_has_the_range_and_the_interval() {
    let table = table();
    let points = PointTable::of(&table, &[0, 1, 2, 3, 4, 5], &seeds());
    let shown = points.for_reader();
    let cell = |name: &str, row: usize| {
        shown_cells(&shown, shown.column(name).unwrap(), &[row])[0].to_string()
    };
    assert_eq!(cell("runs", 0), "2 done, 1 failed");
    assert_eq!(cell("runs", 1), "3");
    assert_eq!(cell("peak_vz", 0), "25 [20 to 30]");
    assert_eq!(cell("deployed", 0), "1 of 2 (9 to 91 %)");
    assert_eq!(cell("safe", 1), "3 of 3 (44 to 100 %)");
    assert_eq!(cell("smallest_margin", 1), "0.4");
    assert_eq!(cell("verdict", 0), "null", "the runs disagree");
}

#[test]
fn a_condition_on_results_chooses_points_and_one_on_a_replicate_runs() {
    let table = table();
    let chosen = |condition: &str| chosen_runs(&table, Some(condition), &seeds()).unwrap();
    assert_eq!(chosen("safety == 'safe' and smallest_margin > 0.1"), [3, 4, 5]);
    assert_eq!(chosen("safety != 'safe'"), [0, 1, 2]);
    assert_eq!(chosen("peak_vz >= 25"), [0, 1, 2], "the median, with all runs");
    assert_eq!(chosen("peak_vz_largest < 16 and deployed == deployed_of"), [3, 4, 5]);
    assert_eq!(chosen("strategy == 'a'"), [0, 1, 2]);
    assert_eq!(chosen("seed <= 2"), [0, 1, 3, 4]);
    assert_eq!(chosen("seed <= 2 and peak_vz > 15"), [0, 1]);
    let single =
        chosen_runs(&table, Some("safety == 'safe' and smallest_margin > 0.1"), &[]).unwrap();
    assert_eq!(single, [0, 3, 4, 5], "single runs");
    assert!(chosen_runs(&table, Some("deployd == 1"), &seeds()).is_err());
}
