//! Tables: plan order, types, back to the bit, nothing foreign accepted.

#![expect(clippy::disallowed_methods, reason = "looks at the disk with its own eyes")]

use std::path::Path;

use super::*;
use crate::run::fixture;

fn built() -> Table {
    let mut points = fixture::generation(5).points;
    points[1].job.parameters[1].1 = Value::Integer(3);
    points[3].job.parameters.push(("height".to_owned(), Value::Text("tall".to_owned())));
    let mut records = BTreeMap::new();
    for number in [4, 0] {
        let job = &points[number].job;
        let cells = Cells::of(job, &fixture::ran(u32::try_from(number).unwrap())).unwrap();
        let record = Record { job: job.id.clone(), cells, file_hash: None };
        records.insert(job.id.clone(), record);
    }
    Table::build(&points, &records, &|name| if name == "N" { "1".into() } else { "kg/s".into() })
}

fn cells<'a>(table: &'a Table, name: &str) -> &'a [Value] {
    &table.column(name).unwrap().cells
}

#[test]
fn every_planned_point_is_a_row_in_plan_order() {
    let table = built();
    let text = |text: &str| Value::Text(text.to_owned());
    let status: Vec<Value> =
        ["done", "pending", "infeasible", "pending", "done"].map(text).to_vec();
    assert_eq!(cells(&table, "status"), status);
    assert_eq!(cells(&table, "reason")[2], text("alpha1 would exceed pi/2 - pi/N"));
    assert_eq!(cells(&table, "verdict")[4], text("deployed"));
    let volume = fixture::deployment(4, 7).measures.final_volume.unwrap();
    assert_eq!(cells(&table, "final_volume")[4], Value::Number(volume));
    let names: Vec<&str> = table.parameters().map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["N", "mass_flow_rate", "height"]);
}

#[test]
fn parameters_are_typed_and_win_a_name() {
    let table = built();
    assert_eq!(table.column("N").unwrap().kind, Kind::Integer);
    assert_eq!(table.column("mass_flow_rate").unwrap().kind, Kind::Number);
    assert_eq!(cells(&table, "mass_flow_rate")[1], Value::Number(3.0));
    assert_eq!(cells(&table, "height")[3], Value::Text("tall".to_owned()));
    assert_eq!(table.column("height_resolved").unwrap().unit, "m");
}

#[test]
fn a_table_comes_back_to_the_bit_and_is_the_same_bytes_twice() {
    let mut table = built();
    table.columns[2].cells[0] = Value::Number(-0.0);
    table.columns[2].cells[2] = Value::Number(f64::INFINITY);
    for table in [table, Table::build(&[], &BTreeMap::new(), &|_| String::new())] {
        let bytes = parquet::encode(&table).unwrap();
        assert_eq!(bytes, parquet::encode(&table).unwrap());
        let back = parquet::decode(Path::new("t"), &bytes).unwrap();
        assert_eq!(back, table);
        let signs = |table: &Table| format!("{:?}", table.columns.get(2));
        assert_eq!(signs(&back), signs(&table));
    }
    let threads = std::fs::read_dir("/proc/self/task").unwrap().filter(|thread| {
        let name = thread.as_ref().unwrap().path().join("comm");
        std::fs::read_to_string(name).unwrap_or_default().starts_with("polars")
    });
    assert_eq!(threads.count(), 0, "polars started a pool");
}

#[test]
fn foreign_newer_and_damaged_tables_are_refused() {
    let bytes = parquet::encode(&built()).unwrap();
    let refused = |bytes: &[u8]| parquet::decode(Path::new("t"), bytes).unwrap_err().to_string();
    assert!(refused(b"").contains("no Parquet file"));
    assert!(refused(&bytes[..bytes.len() - 3]).contains("t: no Parquet file"));
    let swap = |from: &str, to: &str| {
        let at = bytes.windows(from.len()).rposition(|window| window == from.as_bytes()).unwrap();
        [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat()
    };
    let newer = refused(&swap("\"version\":1", "\"version\":9"));
    assert!(newer.contains("table of version 9, this program reads up to 1"), "{newer}");
    let other = refused(&swap("\"billow-table\"", "\"somebody-else\""[..14].trim_end()));
    assert!(other.contains("billow table"), "{other}");
}
