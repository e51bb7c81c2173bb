//! Maps of any size are valid figures.

use proptest::prelude::*;

use super::*;
use crate::render::figure::check;
use crate::render::png;

fn maps(columns: usize, rows: usize, panels: usize, values: &[f64]) -> Maps {
    let finite = || values.iter().copied();
    let (low, high) =
        (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    let cell = |index: usize| match index % 5 {
        3 => Cell::Letter("S".to_owned()),
        4 if index.is_multiple_of(2) => Cell::Absent,
        2 => Cell::Value {
            value: values[index % values.len()],
            outcome: Fill::Half,
            shared: false,
            text: if index.is_multiple_of(4) { "3/5*".to_owned() } else { String::new() },
            below: "3/5".to_owned(),
            missed: index.is_multiple_of(3),
        },
        _ => Cell::of(
            values[index % values.len()],
            [Fill::Open, Fill::Crossed][index % 2],
            index % 7 == 1,
        ),
    };
    Maps {
        sheet: Sheet { title: "A map".to_owned(), ..Sheet::default() },
        x: ("mass_flow_rate (g/s)".to_owned(), (0..columns).map(|n| format!("{n}.5")).collect()),
        y: ("N".to_owned(), (0..rows).map(|n| n.to_string()).collect()),
        label: "peak_vz (m/s)".to_owned(),
        range: Some([low, high]),
        panels: (0..panels)
            .map(|panel| Panel {
                title: format!("M {panel}"),
                cells: (0..columns * rows).map(cell).collect(),
            })
            .collect(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    #[test]
    fn any_map_is_a_valid_figure(
        columns in 1..10_usize, rows in 1..9_usize, panels in 1..7_usize,
        values in prop::collection::vec(-1e4..1e4_f64, 1..40),
    ) {
        check::figure(&maps(columns, rows, panels, &values).svg());
    }
}

#[test]
fn every_cell_shows_its_number_and_the_bar_its_unit() {
    let values = [12.0, 31.25, 0.5, 0.25, 1234.0];
    let svg = maps(5, 1, 1, &values).svg();
    let texts = check::figure(&svg);
    for text in
        ["12.0", "= 31.2", "3/5", "0.500", "S", "peak_vz (m/s)", "mass_flow_rate (g/s)", "N"]
    {
        assert!(texts.iter().any(|other| other == text), "{text}: {texts:?}");
    }
    assert!(png::encode(&svg, 2.0).unwrap().len() > 1000);
}

#[test]
fn one_value_for_all_cells_gives_finite_colours() {
    check::figure(&maps(3, 2, 1, &[5.0]).svg());
    let mut none = maps(3, 2, 1, &[5.0]);
    none.range = None;
    none.panels[0].cells = vec![Cell::Letter("I".to_owned()); 6];
    check::figure(&none.svg());
}
