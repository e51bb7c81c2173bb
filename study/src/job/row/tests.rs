//! Rows: every column has one entry, and every value has the type of its column.

use std::collections::BTreeSet;

use super::*;
use crate::run::fixture;

#[test]
fn every_column_has_one_name_and_stands_at_its_index() {
    let names: BTreeSet<&str> = COLUMNS.iter().map(|column| column.name).collect();
    assert_eq!(names.len(), COLUMNS.len());
    for (index, column) in COLUMNS.iter().enumerate() {
        assert_eq!(column.id.index(), index);
        assert_eq!(ColumnId::from_name(column.name), Some(column.id));
        assert!(!column.meaning.is_empty(), "{}", column.name);
    }
}

#[test]
fn every_value_has_the_type_of_its_column() {
    let job = fixture::job(1);
    let cells = Cells::of(&job, &fixture::ran(1), Some("hash")).unwrap();
    for (column, value) in cells.iter() {
        let fits = match value {
            Value::Null => true,
            Value::Bool(_) => column.cell_type == CellType::Bool,
            Value::Integer(_) => column.cell_type == CellType::Integer,
            Value::Number(_) => column.cell_type == CellType::Number,
            Value::Text(_) => column.cell_type == CellType::Text,
        };
        assert!(fits, "{} holds {value:?}", column.name);
    }
    assert_eq!(cells.text(ColumnId::ContentHash), "hash");
    assert_eq!(cells.text(ColumnId::Verdict), "deployed");
    assert_eq!(cells.number(ColumnId::WallSeconds), Some(0.5));
}

#[test]
fn a_cancelled_job_has_no_row_and_a_panicked_one_has_no_pattern() {
    let job = fixture::job(1);
    assert_eq!(Cells::of(&job, &Outcome::Cancelled, None), None);
    let panicked = Cells::of(&job, &Outcome::Panicked("overflow".to_owned()), None).unwrap();
    assert_eq!(panicked.status(), Status::Panicked);
    assert_eq!(panicked.text(ColumnId::Reason), "overflow");
    assert_eq!(panicked.number(ColumnId::Phi), None);
}
