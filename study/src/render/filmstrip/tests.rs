//! Panels, scale and colours of a filmstrip, read from its SVG.

use proptest::prelude::*;
use resvg::usvg::roxmltree::{self, Document};

use super::*;

/// A box of film, `tall` m high on a ground of 0.2 m by 0.1 m, without a bottom.
fn shape(time: f64, tall: f32) -> Frame {
    let ground = [[0.1, 0.05], [-0.1, 0.05], [-0.1, -0.05], [0.1, -0.05]];
    let ring = |z: f32| ground.map(|[x, y]: [f32; 2]| [x, y, z]);
    let positions = [ring(0.0), ring(0.5 * tall), ring(tall)].concat();
    Frame {
        time,
        positions,
        regimes: REGIMES.map(|(regime, ..)| regime).repeat(6),
        velocities: Vec::new(),
        stresses: Vec::new(),
        gaps: Vec::new(),
    }
}

/// The elements of the box, and their storeys: two storeys and a top cap.
fn elements() -> (Vec<[u32; 3]>, Vec<u32>) {
    let mut triangles = Vec::new();
    for ring in [0, 4] {
        for side in 0..4 {
            let [a, b] = [ring + side, ring + (side + 1) % 4];
            triangles.extend([[a, b, a + 4], [b, b + 4, a + 4]]);
        }
    }
    triangles.extend([[8, 9, 10], [8, 10, 11]]);
    (triangles, [[1; 8].as_slice(), &[2; 8], &[3; 2]].concat())
}

/// A filmstrip of the box seen along x, in the colours of its storeys.
fn strip<'a>(film: &'a (Vec<[u32; 3]>, Vec<u32>), frames: &'a [Frame]) -> Filmstrip<'a> {
    Filmstrip {
        title: "grid: job 01234567 (N=5 & M<3)",
        triangles: &film.0,
        storeys: &film.1,
        frames,
        view: View::new(0.0, 0.0),
        colour: Colour::Storey,
        smooth: false,
        values: &[],
        marks: &[],
        notes: &[],
    }
}

#[expect(clippy::cast_possible_truncation, reason = "invented numbers")]
fn drawn(times: &[f64], colour: Colour) -> String {
    let frames: Vec<Frame> =
        times.iter().map(|time| shape(*time, 0.04 + 0.2 * *time as f32)).collect();
    let values: Vec<Vec<String>> =
        times.iter().map(|time| vec![format!("t {time}"), "p 2 kPa".to_owned()]).collect();
    let notes = ["a note".to_owned()];
    Filmstrip { colour, values: &values, notes: &notes, ..strip(&elements(), &frames) }.svg()
}

fn texts(svg: &Document<'_>) -> Vec<String> {
    let texts = svg.descendants().filter(|node| node.has_tag_name("text"));
    texts.map(|node| node.text().unwrap_or_default().to_owned()).collect()
}

/// Absolute corners of the elements of a panel, in drawing order.
fn corners(svg: &Document<'_>, panel: usize) -> Vec<[[f64; 2]; 3]> {
    let id = format!("frame{panel}");
    let group = svg.descendants().find(|node| node.attribute("id") == Some(&id)).unwrap();
    let path = |node: roxmltree::Node<'_, '_>| {
        let numbers: Vec<f64> = node
            .attribute("d")?
            .trim_start_matches('M')
            .trim_end_matches('z')
            .split(['l', ' ', ','])
            .map(|number| number.parse().unwrap())
            .collect();
        let [x, y, dx, dy, ex, ey] = numbers.try_into().unwrap();
        Some([[x, y], [x + dx, y + dy], [x + dx + ex, y + dy + ey]])
    };
    group.children().filter_map(path).collect()
}

#[test]
fn every_frame_has_a_panel_with_its_values() {
    let svg = drawn(&[0.0, 0.0125, 0.5], Colour::Storey);
    let svg = Document::parse(&svg).unwrap();
    let texts = texts(&svg);
    assert_eq!(texts[0], "grid: job 01234567 (N=5 & M<3)");
    assert_eq!(texts[1..7], ["t 0", "p 2 kPa", "t 0.0125", "p 2 kPa", "t 0.5", "p 2 kPa"]);
    assert_eq!(texts[8..], ["storey 1", "storey 2", "caps", "a note"]);
    for panel in 0..3 {
        assert_eq!(corners(&svg, panel).len(), 18, "every element, front and back");
    }
}

#[test]
fn all_panels_have_the_scale_of_the_scale_bar() {
    let svg = drawn(&[0.0, 0.5, 0.8], Colour::Plain);
    let svg = Document::parse(&svg).unwrap();
    let extent = |panel: usize, axis: usize| {
        let all: Vec<f64> = corners(&svg, panel).as_flattened().iter().map(|c| c[axis]).collect();
        let least = all.iter().copied().fold(f64::INFINITY, f64::min);
        all.iter().copied().fold(f64::NEG_INFINITY, f64::max) - least
    };
    // Seen along x, the shapes are 0.1 m wide and have their full height.
    let bar = svg.descendants().find(|node| node.attribute("id") == Some("scale")).unwrap();
    let line = bar.children().find(|node| node.has_tag_name("line")).unwrap();
    let attribute = |name: &str| line.attribute(name).unwrap().parse::<f64>().unwrap();
    let length = attribute("x2") - attribute("x1");
    let label = texts(&svg)[7].clone();
    let length_of_label = label.strip_suffix(" mm").unwrap().parse::<f64>().unwrap() / 1e3;
    assert!(
        [1.0, 2.0, 5.0].iter().any(|d| (libm::log10(length_of_label / d) % 1.0).abs() < 1e-9),
        "{label}"
    );
    let scale = length / length_of_label;
    for (panel, tall) in [(0, 0.04), (1, 0.14), (2, 0.2)] {
        assert!((extent(panel, 0) - 0.1 * scale).abs() < 0.03, "{panel}");
        assert!((extent(panel, 1) - tall * scale).abs() < 0.03, "{panel}");
    }
}

#[test]
fn the_three_states_of_the_film_differ_in_grey() {
    let svg = drawn(&[0.0], Colour::Regime);
    let svg = Document::parse(&svg).unwrap();
    assert_eq!(texts(&svg)[4..7], ["taut", "wrinkled", "slack"]);
    let grey = |colour: &str| -> f64 {
        rgb(colour).into_iter().zip([0.2126, 0.7152, 0.0722]).map(|(c, w)| w * f64::from(c)).sum()
    };
    let tones: Vec<f64> = REGIMES.iter().map(|(.., colour)| grey(colour)).collect();
    // The darkest shade of a state is brighter than the brightest shade of the next one.
    assert!(0.75 * tones[0] > tones[1] && 0.75 * tones[1] > tones[2], "{tones:?}");
    let differ = |pair: &[&str]| (grey(pair[0]) - grey(pair[1])).abs() > 20.0;
    assert!(STOREYS.windows(2).all(differ), "neighbours differ in grey");
}

#[test]
fn smooth_film_has_no_lines_and_a_linear_brightness() {
    let film = elements();
    // All sides of this box are folds, so each element has one brightness.
    let box_shaped = [shape(0.0, 0.1)];
    let strip = Filmstrip { smooth: true, ..strip(&film, &box_shaped) };
    let text = strip.svg();
    let svg = Document::parse(&text).unwrap();
    let paths: Vec<_> = svg.descendants().filter(|node| node.has_tag_name("path")).collect();
    assert_eq!(paths.len(), 18);
    assert!(paths.iter().all(|path| path.attribute("stroke") == path.attribute("fill")));
    assert!(!text.contains("linearGradient"));
    let corners = [[1.0, 1.0], [3.0, 1.0], [1.0, 2.0]];
    let (ends, lights) = gradient(corners, [0.2, 0.6, 0.2]).unwrap();
    assert_eq!((ends, lights), ([[1.0, 1.0], [3.0, 1.0]], [0.2, 0.6]));
    assert_eq!(gradient(corners, [0.2; 3]), None);
}

#[test]
fn a_quantity_has_one_scale_with_its_unit() {
    let quantity = Quantity {
        label: "speed (m/s)".to_owned(),
        values: vec![vec![0.0; 18], vec![5.0; 18], vec![20.0; 18]],
        range: [0.0, 10.0],
    };
    let fractions = [0, 1, 2].map(|frame| quantity.fraction(frame, 3));
    assert!(fractions.iter().zip([0.0, 0.5, 1.0]).all(|(a, b)| (a - b).abs() < 1e-12));
    let svg = drawn(&[0.0, 0.5, 0.8], Colour::Quantity(quantity));
    let svg = Document::parse(&svg).unwrap();
    let texts = texts(&svg);
    for text in ["0", "2", "10", "speed (m/s)", "a note"] {
        assert!(texts.iter().any(|shown| shown == text), "{text}: {texts:?}");
    }
    let bright = |panel: usize| -> f64 {
        let id = format!("frame{panel}");
        let group = svg.descendants().find(|node| node.attribute("id") == Some(&id)).unwrap();
        let fill = group.children().find_map(|node| node.attribute("fill")).unwrap();
        rgb(fill).into_iter().map(f64::from).sum()
    };
    assert!(bright(0) < bright(1) && bright(1) < bright(2));
}

#[test]
fn the_legend_lists_storeys_that_share_a_colour() {
    let film = (elements().0, (1..=18).collect());
    let frames = [shape(0.0, 0.1)];
    let strip = strip(&film, &frames);
    let names: Vec<String> = strip.legend().entries.into_iter().map(|(_, name)| name).collect();
    assert_eq!(names.len(), 8);
    assert_eq!(names[2], "storey 3, 10, 17");
    assert_eq!(names[7], "caps");
    assert_eq!(strip.storey_colour(3), strip.storey_colour(10));
    assert_ne!(strip.storey_colour(3), strip.storey_colour(4));
}

#[test]
fn numbers_are_short_and_correct() {
    for (hundredths, text) in [
        (0.0, "0"),
        (-0.4, "0"),
        (5.0, ".05"),
        (-50.0, "-.5"),
        (1200.0, "12"),
        (-1234.0, "-12.34"),
        (10.0, ".1"),
        (100_000.0, "1000"),
    ] {
        assert_eq!(short(hundredths), text);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn everything_is_on_the_page(
        count in 1_usize..40, tall in 0.001_f32..50.0, azimuth in -4.0..4.0_f64,
        elevation in -1.5..1.5_f64,
    ) {
        let film = elements();
        let frames: Vec<Frame> = (0..count).map(|n| shape(n as f64, tall)).collect();
        let title = "long ".repeat(50);
        let mut lines = vec!["1 ms".to_owned(), "long ".repeat(9), "2 kPa".to_owned()];
        lines.truncate(if count > 24 { 1 } else { 3 });
        let strip = Filmstrip {
            title: &title,
            view: View::new(azimuth, elevation),
            values: &vec![lines; count],
            ..strip(&film, &frames)
        };
        let text = strip.svg();
        let svg = Document::parse(&text).unwrap();
        let page: Vec<f64> = svg.root_element().attribute("viewBox").unwrap().split(' ')
            .map(|number| number.parse().unwrap()).collect();
        let mut right = f64::NEG_INFINITY;
        for panel in 0..count {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for [x, y] in corners(&svg, panel).as_flattened() {
                prop_assert!((0.0..=page[2]).contains(x) && (0.0..=page[3]).contains(y));
                (low, high) = (low.min(*x), high.max(*x));
            }
            // Panels of a row do not overlap.
            prop_assert!(low > right || low < right - 1.0 || panel == 0);
            right = high;
        }
    }
}
