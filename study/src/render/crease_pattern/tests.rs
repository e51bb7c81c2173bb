//! Lengths and layers of a drawn pattern, read from its SVG.

use billow_solver::geometry::fold::{Caps, Chirality, Fit, FoldDesign};

use super::*;

fn paper() -> FoldPattern {
    FoldPattern::new(&FoldDesign {
        fit: Fit::Cone,
        panels: 6,
        storeys: 3,
        bottom_radius: 0.5,
        top_radius: Some(0.365),
        height: Some(1.0),
        half_angle: None,
        alpha1_over_phi: None,
        chirality: Chirality::Same,
        stowed_height: 0.04,
        subdivisions: 1,
        caps: Caps::Polygon,
    })
    .expect("the paper's capsule")
}

/// Lengths of the lines of one layer.
fn layer(svg: &str, id: &str) -> Vec<f64> {
    let (_, rest) = svg.split_once(&format!("<g id=\"{id}\"")).expect(id);
    let (layer, _) = rest.split_once("</g>").expect("a closed layer");
    layer
        .lines()
        .filter(|line| line.starts_with("<line"))
        .map(|line| {
            let attribute = |name: &str| -> f64 {
                let (_, rest) = line.split_once(&format!("{name}=\"")).expect(name);
                rest.split('"').next().expect("a value").parse().expect("a number")
            };
            let [x1, y1, x2, y2] = ["x1", "y1", "x2", "y2"].map(attribute);
            Vector2::new(x2 - x1, y2 - y1).norm()
        })
        .collect()
}

#[test]
fn the_pattern_is_drawn_one_to_one_in_millimetres() {
    let pattern = paper();
    let svg = svg(&pattern, None);
    let valleys = layer(&svg, "valley");
    assert_eq!(valleys.len(), 18);
    for storey in 0..3 {
        let diagonal = 1e3 * pattern.lengths(storey).ae;
        assert_eq!(valleys.iter().filter(|l| (*l - diagonal).abs() < 1e-3).count(), 6);
    }
    assert_eq!(layer(&svg, "cut").len(), 2 * 6 + 2 * 3);
    assert_eq!(layer(&svg, "mountain").len(), 2 * 6 + 3 * 5);
    assert!(!svg.contains("glue_flaps"));
    // The user unit of the page is 1 mm.
    let (_, size) = svg.split_once("width=\"").expect("a width");
    let width = size.split("mm").next().expect("millimetres");
    assert!(svg.contains(&format!("viewBox=\"0 0 {width} ")));
}

#[test]
fn the_seam_and_the_caps_have_glue_flaps() {
    let svg = svg(&paper(), Some(0.015));
    let (_, rest) = svg.split_once("glue_flaps").expect("the layer");
    let (flaps, _) = rest.split_once("</g>").expect("a closed layer");
    assert_eq!(flaps.matches("<polyline").count(), 3 + 2 * 6);
}

#[test]
fn the_drawing_shows_the_lengths() {
    let svg = svg(&paper(), None);
    for length in ["523.17", "446.07", "829.58", "381.91"] {
        assert!(svg.contains(&format!(">{length}</text>")), "{length}");
    }
}
