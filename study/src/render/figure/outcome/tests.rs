//! Maps of outcomes of any size are valid figures.

use proptest::prelude::*;

use super::*;
use crate::render::figure::check;

fn map(columns: usize, rows: usize, panels: usize, headings: usize) -> Outcomes {
    let cell = |index: usize| {
        (index % 7 != 5).then(|| Cell {
            outcome: Outcome::ALL[index % Outcome::ALL.len()],
            letter: ["S", "", "Tl"][index % 3].to_owned(),
            below: ["3.4 µs", "", "2e−5"][index % 3].to_owned(),
            failure_expected: index.is_multiple_of(2),
            missed: index.is_multiple_of(3),
        })
    };
    let texts = |number: usize| vec![format!("1.{number}"), "1.0000".to_owned()];
    Outcomes {
        sheet: Sheet { title: "A map".to_owned(), ..Sheet::default() },
        x: ("step (CFL number)".to_owned(), (0..columns).map(|n| format!("{n}.25")).collect()),
        y: ("damping (ratio)".to_owned(), (0..rows).map(|n| format!("{n}e−4")).collect()),
        borders: true,
        headings: ["border", "of 2/ω"][..headings].iter().map(|&s| s.to_owned()).collect(),
        panels: (0..panels)
            .map(|panel| Panel {
                title: format!("method {panel}"),
                cells: (0..columns * rows).map(cell).collect(),
                beside: (0..rows).map(|row| texts(row)[..headings].to_vec()).collect(),
            })
            .collect(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    #[test]
    fn any_map_is_a_valid_figure(
        columns in 1..17_usize, rows in 1..9_usize, panels in 1..7_usize, headings in 0..3_usize,
    ) {
        check::figure(&map(columns, rows, panels, headings).svg());
    }
}

#[test]
fn cells_have_their_texts_where_all_of_them_fit() {
    let texts = check::figure(&map(6, 3, 2, 2).svg());
    for text in ["3.4 µs", "2e−5", "S", "Tl", "border", "1.2", "damping (ratio)"] {
        assert!(texts.iter().any(|other| other == text), "{text}: {texts:?}");
    }
    let texts = check::figure(&map(16, 3, 2, 2).svg());
    assert!(!texts.iter().any(|text| text == "3.4 µs"), "{texts:?}");
}

#[test]
fn the_border_runs_between_done_and_failed_cells_only() {
    let mut one = map(2, 1, 1, 0);
    let mut borders = |outcomes: [Outcome; 2]| {
        for (cell, outcome) in one.panels[0].cells.iter_mut().zip(outcomes) {
            cell.as_mut().unwrap().outcome = outcome;
        }
        one.svg().matches("stroke-width=\"0.9\"").count()
    };
    assert_eq!(borders([Outcome::Done, Outcome::Unstable]), 1);
    assert_eq!(borders([Outcome::EnergyDrift, Outcome::Unstable]), 0);
    assert_eq!(borders([Outcome::Done, Outcome::Done]), 0);
}
