//! Tables: plan order, types, bits.

#![expect(clippy::disallowed_methods, reason = "tests read and write files directly")]

use super::*;
use crate::accuracy::AssumedRanges;
use crate::run::fixture;

fn built() -> Table {
    let mut points = fixture::points(5);
    Arc::make_mut(&mut points[1].job.parameters)[1].1 = Value::Integer(3);
    let tall = ("height".to_owned(), Value::Text("tall".to_owned()));
    let parameters = &mut points[3].job.parameters;
    *parameters = parameters.iter().cloned().chain([tall]).collect();
    let mut records = BTreeMap::new();
    for number in [4, 0] {
        let job = &points[number].job;
        let cells = Cells::of(job, &fixture::ran(u32::try_from(number).unwrap()), None).unwrap();
        let record = Record { job: job.id.clone(), cells, file_hash: None, file_stamp: None };
        records.insert(job.id.clone(), record);
    }
    Table::build(
        &points,
        &records,
        &|name| if name == "N" { "1".into() } else { "kg/s".into() },
        &AssumedRanges::default(),
    )
}

fn cells<'a>(table: &'a Table, name: &str) -> &'a ColumnCells {
    &table.column(name).unwrap().cells
}

#[test]
fn every_planned_point_is_a_row_in_plan_order() {
    let table = built();
    let text = |text: &str| Value::Text(text.to_owned());
    let status: Vec<Value> =
        ["done", "pending", "infeasible", "pending", "done"].map(text).to_vec();
    assert_eq!(*cells(&table, "status"), status);
    assert_eq!(cells(&table, "reason")[2], text("alpha1 would exceed pi/2 - pi/N"));
    assert_eq!(cells(&table, "verdict")[4], text("deployed"));
    let volume = fixture::deployment(4, 7).measures.final_volume.unwrap();
    assert_eq!(cells(&table, "final_volume")[4], Value::Number(volume));
    let names: Vec<&str> = table.parameters().map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["N", "mass_flow_rate", "height"]);
}

#[test]
fn points_of_one_job_are_rows_that_name_each_other() {
    let mut points = fixture::points(2);
    let with = |number: i64| {
        let mut parameters = points[0].job.parameters.clone();
        Arc::make_mut(&mut parameters)[0].1 = Value::Integer(number);
        parameters
    };
    // Given twice, N = 7 is one row; the cell of a job of many points stays short.
    points[0].merged = [7, 7, 8, 9, 10, 11, 12, 13, 14, 15].map(with).to_vec();
    let table =
        Table::build(&points, &BTreeMap::new(), &|_| String::new(), &AssumedRanges::default());
    assert_eq!(table.rows(), 11);
    let jobs = cells(&table, "job");
    assert!(jobs[0] == jobs[9] && jobs[9] != jobs[10]);
    let others = cells(&table, "same_job_as");
    let expected = "N=6; N=7; N=8; N=9; N=10; N=11; N=12; N=13; and 1 more";
    assert_eq!(others[9], Value::Text(expected.to_owned()));
    assert_eq!(others[10], Value::Null);
    assert_eq!(table.one_row_per_job(&[3, 4, 9, 10]), [3, 10]);
}

#[test]
fn parameters_are_typed_and_keep_their_name() {
    let table = built();
    assert_eq!(table.column("N").unwrap().cell_type, CellType::Integer);
    assert_eq!(table.column("mass_flow_rate").unwrap().cell_type, CellType::Number);
    assert_eq!(cells(&table, "mass_flow_rate")[1], Value::Number(3.0));
    assert_eq!(cells(&table, "height")[3], Value::Text("tall".to_owned()));
    assert_eq!(table.column("height_resolved").unwrap().unit, "m");
}

#[test]
fn a_table_written_twice_has_the_same_bytes_and_every_cell_counts() {
    let table = built();
    let bytes = |table: &Table| parquet::encode(table.clone()).unwrap();
    let mut changed = table.clone();
    assert!(bytes(&table).starts_with(b"PAR1") && bytes(&table) == bytes(&changed));
    for cell in [Value::Number(-0.0), Value::Number(0.0), Value::Number(f64::NAN), Value::Null] {
        let before = bytes(&changed);
        changed.columns[2].cells[2] = cell;
        assert_ne!(bytes(&changed), before);
    }
    bytes(&Table::build(&[], &BTreeMap::new(), &|_| String::new(), &AssumedRanges::default()));
    let threads = std::fs::read_dir("/proc/self/task").unwrap().filter(|thread| {
        let name = thread.as_ref().unwrap().path().join("comm");
        std::fs::read_to_string(name).unwrap_or_default().starts_with("polars")
    });
    assert_eq!(threads.count(), 0, "polars started threads");
}

#[test]
fn a_cell_that_is_kept_once_is_written_in_every_row() {
    let text = |text: &str| Value::Text(text.to_owned());
    for (cell_type, cell) in [
        (CellType::Bool, Value::Bool(true)),
        (CellType::Integer, Value::Integer(-7)),
        (CellType::Number, Value::Number(-0.0)),
        (CellType::Text, text("")),
        (CellType::Text, text("of the floor")),
        (CellType::Text, Value::Null),
        (CellType::Number, Value::Null),
    ] {
        for rows in [0, 1, 5, 40_000] {
            let bytes = |cells: ColumnCells| {
                let columns = vec![Column { cells, ..Column::plain("a", cell_type, Vec::new()) }];
                parquet::encode(Table { columns }).unwrap()
            };
            let each = ColumnCells::Each(Arc::new(vec![cell.clone(); rows]));
            let once = ColumnCells::Same(cell.clone(), rows);
            assert!(bytes(once) == bytes(each), "{cell_type:?} {cell:?} {rows}");
        }
    }
}

#[test]
fn cells_of_measures_are_those_of_the_records_until_one_is_set() {
    let table = built();
    let mut volumes = cells(&table, "final_volume").clone();
    let ColumnCells::Of(rows, ColumnId::FinalVolume) = &volumes else { panic!("{volumes:?}") };
    let ColumnCells::Of(others, _) = cells(&table, "status") else { panic!("not shared") };
    assert!(Arc::ptr_eq(rows, others));
    let before: Vec<Value> = volumes.iter().cloned().collect();
    volumes[1] = Value::Number(0.5);
    assert_eq!((&volumes[0], &volumes[1]), (&before[0], &Value::Number(0.5)));
    assert_eq!(*cells(&table, "final_volume"), before);
}

#[test]
fn cells_that_are_the_same_in_every_row_are_kept_once() {
    let cells = |values: &[f64]| -> ColumnCells {
        values.iter().map(|value| Value::Number(*value)).collect()
    };
    assert!(matches!(cells(&[2.0; 3]), ColumnCells::Same(Value::Number(2.0), 3)));
    // Zero and negative zero have different bits.
    assert!(matches!(cells(&[0.0, -0.0]), ColumnCells::Each(_)));
    assert_eq!(cells(&[]).len(), 0);
    let mut changed = cells(&[2.0; 3]);
    changed[1] = Value::Null;
    assert_eq!(changed, [Value::Number(2.0), Value::Null, Value::Number(2.0)]);
}
