//! Plots of any size are valid figures.

use proptest::prelude::*;

use super::line::thinned;
use super::*;
use crate::render::figure::legend::{Legend, Sample};
use crate::render::figure::style::{Fill, Series};
use crate::render::figure::{check, columns};
use crate::render::page::Position;
use crate::render::png;

fn axis(low: f64, high: f64) -> Axis {
    Axis {
        label: "time (ms)".to_owned(),
        spread: Spread::Linear,
        range: [low, high],
        ticks: Vec::new(),
        names: false,
    }
}

fn plots(x: Axis, ys: &[f64], panels: usize, across: usize, series: usize) -> Plots {
    let [low, high] = x.range;
    let points: Vec<[f64; 2]> = ys
        .iter()
        .enumerate()
        .map(|(index, y)| [low + (high - low) * index as f64 / ys.len() as f64, *y])
        .collect();
    let extreme = |start: f64, pick: fn(f64, f64) -> f64| ys.iter().copied().fold(start, pick);
    let (bottom, top) =
        ticks::padded(extreme(f64::INFINITY, f64::min), extreme(f64::NEG_INFINITY, f64::max));
    let line = |series: usize| Line {
        thin: series == 1,
        pieces: vec![points.clone()],
        marks: vec![(points[0], Fill::Open)],
        sparse_markers: true,
        crosses: if series == 0 { vec![points[points.len() - 1]] } else { Vec::new() },
        bands: vec![points.iter().map(|[x, y]| [*x, *y, 1.01 * y.abs() + 1.0]).collect()],
        columns: vec![[points[0][0], bottom, points[0][1]]],
        bars: vec![[points[0][0], bottom, top]],
        faint: vec![(points[0], Fill::Half)],
        texts: points.iter().map(|point| (*point, "3/5".to_owned())).collect(),
        arrows: vec![(points[0], Direction::Down)],
        shift: series as f64,
        ..Line::new(Series::nth(series))
    };
    let rule = |value: f64, closed| Rule { value, text: "limit 25 m/s".to_owned(), closed };
    let lane = (0..series).map(|series| mark_of(high, series)).collect();
    Plots {
        sheet: Sheet {
            title: "Height of the top ring while the capsule fills, of all the jobs there are"
                .to_owned(),
            subtitle: vec!["study".to_owned()],
            legends: vec![Legend {
                heading: "N".to_owned(),
                entries: (0..series)
                    .map(|n| (Sample::Line(Series::nth(n)), format!("N {n}")))
                    .collect(),
            }],
            notes: vec!["a note".to_owned()],
        },
        x,
        panels: (0..panels)
            .map(|panel| Panel {
                title: format!("panel {panel}"),
                label: "z_rim (m)".to_owned(),
                range: [bottom, top],
                lines: (0..series).map(line).collect(),
                lane: if panel == 0 { Vec::clone(&lane) } else { Vec::new() },
                rules: vec![
                    rule(ys[0], Some(Direction::Up)),
                    rule(top, None),
                    rule(bottom - 1e6, Some(Direction::Down)),
                ],
                ..Panel::default()
            })
            .collect(),
        across,
    }
}

fn mark_of(x: f64, series: usize) -> Mark {
    Mark { x, series: Series::nth(series), letter: "S".to_owned() }
}

fn same(a: [f64; 2], b: [f64; 2]) -> bool {
    a.map(f64::to_bits) == b.map(f64::to_bits)
}

#[test]
fn numbers_of_adjacent_panels_do_not_overlap() {
    let range = axis(957.507, 957.507 + 5112.118);
    check::figure(&plots(range, &[0.0], 2, 2, 1).svg());
}

#[test]
fn markers_on_each_other_are_drawn_once() {
    let mut plots = plots(axis(0.0, 1.0), &[1.0], 1, 1, 1);
    let line = &mut plots.panels[0].lines[0];
    let marks = (0..20_000).map(|k| ([f64::from(k) / 20_000.0, 1.0], Fill::Filled));
    line.marks = marks.collect();
    let drawn = |plots: &Plots| plots.svg().matches("<circle").count();
    let many = drawn(&plots);
    assert!((200..1_000).contains(&many), "{many}");
    // One of another look among them is not hidden.
    plots.panels[0].lines[0].marks[10_000].1 = Fill::Open;
    assert!(drawn(&plots) > many);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    #[test]
    fn any_plot_is_a_valid_figure(
        low in -1e3..1e3_f64, span in 1e-3..1e4_f64,
        ys in prop::collection::vec(-1e5..1e5_f64, 1..60),
        panels in 1..7_usize, stacked in any::<bool>(), series in 1..9_usize,
    ) {
        let across = if stacked { 1 } else { columns(panels) };
        check::figure(&plots(axis(low, low + span), &ys, panels, across, series).svg());
    }

    #[test]
    fn letters_of_a_lane_do_not_overlap(
        positions in prop::collection::btree_set(0..8_u8, 1..8), marks in 1..9_usize, width in 35.0..140.0_f64,
    ) {
        let x = Scale::new(Spread::Linear, [-0.4, 7.4], [10.0, 10.0 + width]);
        let mark = |x: &u8, series| mark_of(f64::from(*x), series);
        let marks: Vec<Mark> =
            positions.iter().flat_map(|x| (0..marks).map(move |series| mark(x, series))).collect();
        let (positions, rows) = lane::positions(&marks, &x, width);
        for (index, position) in positions.iter().enumerate() {
            prop_assert!(position[0] >= 11.49 && position[0] <= 8.51 + width && position[1] < rows as f64);
            let clear = |other: &[f64; 2]| {
                (other[0] - position[0]).abs() >= 3.0 - 1e-9 || (other[1] - position[1]).abs() > 0.5
            };
            prop_assert!(positions[..index].iter().all(clear), "{:?}", positions);
        }
    }

    #[test]
    fn a_thinned_line_keeps_its_ends_and_extremes(ys in prop::collection::vec(-9.0..9.0_f64, 2..900)) {
        let positions: Vec<Position> =
            ys.iter().enumerate().map(|(index, y)| [0.003 * index as f64, *y]).collect();
        let kept = thinned(&positions);
        prop_assert!(kept.len() <= 4 * (1 + positions.len() * 3 / 100 + 1));
        prop_assert!(same(kept[0], positions[0]));
        prop_assert!(same(kept[kept.len() - 1], positions[positions.len() - 1]));
        let extremes = |positions: &[Position]| {
            positions.iter().fold([9.0, -9.0], |[low, high]: [f64; 2], p| [low.min(p[1]), high.max(p[1])])
        };
        prop_assert!(same(extremes(&kept), extremes(&positions)));
        prop_assert!(kept.windows(2).all(|pair| pair[0][0] <= pair[1][0]));
    }
}

#[test]
fn quantities_units_legend_and_message_are_on_the_page() {
    let mut figure = plots(axis(0.0, 500.0), &[0.0, 0.5, 1.0], 1, 1, 3);
    figure.panels[0].message = "nothing to draw: no job is done".to_owned();
    let texts = check::figure(&figure.svg());
    for text in
        ["time (ms)", "z_rim (m)", "N 2", "no value", "S", "nothing to draw: no job is done"]
    {
        assert!(texts.iter().any(|other| other == text), "{text}: {texts:?}");
    }
    let drawn = png::encode(&figure.svg(), 3.0).unwrap();
    let pixels = resvg::tiny_skia::Pixmap::decode_png(&drawn).unwrap();
    assert_eq!(pixels.width(), 480);
    let ink = pixels.pixels().iter().filter(|pixel| pixel.green() < 200).count();
    assert!(ink > 2000, "{ink} pixels of ink");
}

#[test]
fn long_names_stand_alternately_on_two_lines() {
    let mut x = axis(-0.5, 4.5);
    x.names = true;
    let names =
        ["preinflate with a burst", "residual gas alone", "rapid", "delayed by five seconds", "d"];
    x.ticks =
        names.iter().enumerate().map(|(index, name)| (index as f64, (*name).to_owned())).collect();
    let texts = check::figure(&plots(x, &[1.0, 2.0], 1, 1, 2).svg());
    assert!(texts.iter().any(|text| text == "preinflate with a burst"), "{texts:?}");
}
