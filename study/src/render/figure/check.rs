//! Properties of every valid figure, for tests: well-formed, texts inside the page, at least 8 pt, without
//! overlap, and finite numbers.

use resvg::usvg::roxmltree::{Document, Node};

use crate::render::font;

/// A text and its bounding box: left, top, right, bottom, mm.
type PlacedText = (String, [f64; 4]);

fn number(node: Node<'_, '_>, name: &str) -> f64 {
    let text = node.attribute(name).unwrap_or_else(|| panic!("{name} of {node:?}"));
    let value: f64 = text.parse().unwrap_or_else(|_| panic!("{name}=\"{text}\""));
    assert!(value.is_finite(), "{name}=\"{text}\"");
    value
}

fn placed_text(node: Node<'_, '_>) -> PlacedText {
    let text = node.text().unwrap_or("").to_owned();
    let (x, y, size) = (number(node, "x"), number(node, "y"), number(node, "font-size"));
    assert!(size >= 8.0 * 25.4 / 72.0 - 0.01, "{text:?} is {size} mm high");
    let width = font::width(&text, size);
    let start = match node.attribute("text-anchor") {
        Some("middle") => -0.5 * width,
        Some("end") => -width,
        _ => 0.0,
    };
    // Capital letters reach 0.73 of the size above the baseline, lower-case letters about 0.55.
    let (up, down) = (0.73 * size, 0.15 * size);
    let bounds = if node.attribute("transform").is_some() {
        [x - up, y - start - width, x + down, y - start]
    } else {
        [x + start, y - up, x + start + width, y + down]
    };
    (text, bounds)
}

/// The texts of a figure.
///
/// # Panics
/// When the figure is not valid.
pub fn figure(svg: &str) -> Vec<String> {
    for word in ["NaN", "inf"] {
        assert!(!svg.contains(&format!("\"{word}")) && !svg.contains(&format!(",{word}")), "{svg}");
    }
    let parsed = Document::parse(svg).expect("well-formed XML");
    let root = parsed.root_element();
    let page: Vec<f64> =
        root.attribute("viewBox").unwrap().split(' ').map(|n| n.parse().unwrap()).collect();
    assert!(root.attribute("width").unwrap().ends_with("mm"));
    for node in root.descendants().filter(|node| node.has_tag_name("polyline")) {
        for pair in node.attribute("points").unwrap().split(' ') {
            let (x, y) = pair.split_once(',').unwrap();
            assert!([x, y].iter().all(|n| n.parse::<f64>().unwrap().is_finite()), "{pair}");
        }
    }
    let texts: Vec<PlacedText> =
        root.descendants().filter(|node| node.has_tag_name("text")).map(placed_text).collect();
    for (index, (text, [left, top, right, bottom])) in texts.iter().enumerate() {
        assert!(
            *left >= 0.0 && *top >= 0.0 && *right <= page[2] && *bottom <= page[3],
            "{text:?} at {left:.1} {top:.1} {right:.1} {bottom:.1} leaves the page {page:?}"
        );
        for (other, [l, t, r, b]) in &texts[..index] {
            let apart = left >= r || right <= l || top >= b || bottom <= t;
            assert!(apart, "{text:?} overlaps {other:?}");
        }
    }
    texts.into_iter().map(|(text, _)| text).collect()
}
