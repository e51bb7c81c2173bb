//! The fold of the paper's capsule and of similar designs, to every digit known.

use billow_solver::geometry::fold::{FoldError, Nearest};

use crate::geometry::{crossings, paper_angles, paper_design, paper_height, solved};
use crate::prelude::*;

/// Asserts that a value rounds to the printed one: within half a unit of its last digit.
#[track_caller]
fn prints(value: f64, printed: &str) {
    let decimals = printed.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    assert_eq!(format!("{value:.decimals$}"), printed);
}

/// A design with a nearest feasible value.
fn changed(design: &FoldDesign, near: &Nearest) -> FoldDesign {
    let mut changed = design.clone();
    match near.key {
        "N" => changed.panels = near.value as u32,
        "M" => changed.storeys = near.value as u32,
        "height" => changed.height = Some(near.value),
        "top_radius" => changed.top_radius = Some(near.value),
        "bottom_radius" => changed.bottom_radius = near.value,
        "alpha1_over_phi" => changed.alpha1_over_phi = Some(near.value),
        key => panic!("{key}"),
    }
    changed
}

/// The nearest values of an infeasible design. Each of them alone makes the design feasible.
fn nearest(design: &FoldDesign) -> Vec<Nearest> {
    let Err(FoldError::Infeasible { nearest, .. }) = FoldPattern::new(design) else {
        panic!("a feasible design");
    };
    for near in &nearest {
        solved(&changed(design, near));
    }
    nearest
}

#[test]
fn the_papers_capsule_on_its_cone() {
    let pattern = solved(&paper_design());
    let angles = &pattern.angles;
    prints(pattern.half_angle.tan(), "0.135");
    prints(angles.phi.to_degrees(), "31.5137");
    prints(angles.alpha1.to_degrees(), "28.4863");
    prints(angles.theta2.to_degrees(), "3.97308");
    prints(angles.beta2.to_degrees(), "34.0136");
    prints(angles.alpha2.to_degrees(), "24.5133");
    prints(angles.ring_ratio, "0.900411");
    assert!((angles.ring_ratio - 0.73_f64.cbrt()).abs() < 1e-15);
    let lengths = pattern.lengths(0);
    prints(1e3 * lengths.ab, "523.171");
    prints(1e3 * lengths.de, "471.069");
    prints(1e3 * lengths.ad, "446.068");
    prints(1e3 * lengths.ae, "829.579");
    prints(1e3 * pattern.polygon_radius(0), "523.17");
    prints(pattern.flat_twist().to_degrees(), "53.00");
    prints(pattern.erected_twist().to_degrees(), "29.70");
    prints(1e3 * pattern.opening_radius(0), "273.5");
    prints(1e3 * pattern.opening_radius(2), "221.7");
    // The top turns by about 70° during deployment.
    let turn = 3.0 * (pattern.flat_twist() - pattern.erected_twist()).to_degrees();
    assert!((turn - 70.0).abs() < 0.5, "{turn}");
}

#[test]
fn the_papers_capsule_by_its_angles() {
    let pattern = solved(&paper_angles());
    prints(pattern.angles.phi.to_degrees(), "30.000000000");
    prints(pattern.angles.ring_ratio, "0.893832");
    prints(1e3 * pattern.top_radius, "357.06");
    prints(1e3 * pattern.height, "1058.84");
    let by_half_angle = FoldDesign {
        half_angle: Some(0.135_f64.atan()),
        top_radius: None,
        height: None,
        ..paper_angles()
    };
    let same = solved(&by_half_angle);
    assert!((same.height - pattern.height).abs() < 1e-15);
}

#[test]
fn the_papers_height_and_ratio() {
    let three = solved(&paper_height(3));
    prints(three.half_angle.to_degrees(), "9.547");
    prints(1e3 * three.top_radius, "332");
    let four = solved(&paper_height(4));
    prints(four.half_angle.to_degrees(), "16.094");
    prints(1e3 * four.top_radius, "211");
    let nearest = nearest(&paper_height(2));
    assert_eq!(nearest.iter().find(|n| n.key == "M").expect("a nearest M").value, 3.0);
}

#[test]
fn feasible_phi_on_the_papers_cone() {
    let table = [
        (6, 2, "20.896"),
        (6, 3, "31.514"),
        (6, 4, "37.133"),
        (6, 5, "40.739"),
        (6, 6, "43.288"),
        (6, 8, "46.698"),
        (4, 3, "21.43"),
        (5, 3, "27.62"),
        (8, 3, "36.09"),
        (10, 3, "38.67"),
        (12, 3, "40.31"),
    ];
    for (panels, storeys, phi) in table {
        let pattern = solved(&FoldDesign { panels, storeys, ..paper_design() });
        prints(pattern.angles.phi.to_degrees(), phi);
        let top = pattern.ring_radius(storeys);
        assert!((top / 0.365 - 1.0).abs() < 1e-13, "N {panels} M {storeys}: {top}");
    }
    for panels in 4..=12 {
        let design = FoldDesign { panels, storeys: 1, ..paper_design() };
        let nearest = nearest(&design);
        assert!(nearest.iter().any(|near| near.key == "M" && near.value >= 2.0));
    }
}

#[test]
fn stowed_at_forty_millimetres() {
    let pattern = solved(&paper_design());
    let strain = pattern.stowed_strain(0.04);
    assert!(strain < 2.8e-5, "{strain:e}");
    prints(pattern.stowed_volume(0.04), "0.01512");
    // 0.135954 kg of developed film; the stowed shape, slightly strained, has 0.13596 kg.
    let mass = pattern.film_area() * Film::PAPER.area_density();
    prints(mass, "0.13595");
    for (subdivisions, elements) in [(5, 1200), (8, 3072), (16, 12_288)] {
        let mesh = Mesh::new(&pattern, subdivisions, Shape::Stowed(0.04)).expect("foldable");
        // Rings, panel sides and diagonals of the paper's capsule, N 6 and M 3; caps have no fold lines.
        assert_eq!(u32::try_from(mesh.folds().len()), Ok((4 + 3 + 3) * 6 * subdivisions));
        assert_eq!(mesh.triangles.len(), elements);
        prints(mesh.volume(), "0.01512");
    }
    let mesh = Mesh::new(&pattern, 3, Shape::Stowed(0.001)).expect("foldable");
    assert_eq!(crossings(&mesh), 0);
}

#[test]
fn a_tangled_mesh_has_crossings() {
    // One node of the stowed shape is pushed through its neighbours.
    let pattern = solved(&paper_design());
    let mut mesh = Mesh::new(&pattern, 3, Shape::Stowed(0.04)).expect("foldable");
    let top = mesh.top_centre as usize;
    mesh.positions[top].z = 0.01;
    mesh.positions[top].x = 0.35;
    assert!(crossings(&mesh) > 0);
}

#[test]
fn erected_on_the_cone() {
    let pattern = solved(&paper_design());
    let frustum = pattern.erected_volume();
    let mut last = f64::INFINITY;
    for n in [4, 8, 16] {
        let design =
            FoldDesign { caps: billow_solver::geometry::fold::Caps::Circular, ..paper_design() };
        let round = Mesh::new(&solved(&design), n, Shape::Erected).expect("a mesh");
        let error = 1.0 - round.volume() / frustum;
        assert!(error > 0.0 && error < 0.3 * last, "inscribed, second order: {error}");
        last = error;
    }
    assert!(last < 2e-3, "{last:e}");
    let mesh = Mesh::new(&pattern, 8, Shape::Erected).expect("a mesh");
    let corner = mesh.positions[mesh.top_ring[0] as usize];
    assert!((corner.z - 1.0).abs() < 1e-14 && (corner.xy().norm() - 0.365).abs() < 1e-14);
}

#[test]
fn invalid_designs_name_their_key() {
    let broken: [(&str, FoldDesign); 14] = [
        ("N", FoldDesign { panels: 3, ..paper_design() }),
        ("M", FoldDesign { storeys: 0, ..paper_design() }),
        ("subdivisions", FoldDesign { subdivisions: 0, ..paper_design() }),
        ("bottom_radius", FoldDesign { bottom_radius: -1.0, ..paper_design() }),
        ("bottom_radius", FoldDesign { bottom_radius: f64::NAN, ..paper_design() }),
        ("top_radius", FoldDesign { top_radius: Some(0.0), ..paper_design() }),
        ("top_radius", FoldDesign { top_radius: None, ..paper_design() }),
        ("height", FoldDesign { height: Some(f64::INFINITY), ..paper_design() }),
        ("alpha1_over_phi", FoldDesign { alpha1_over_phi: Some(1.0), ..paper_design() }),
        ("half_angle", FoldDesign { half_angle: Some(0.1), ..paper_design() }),
        ("alpha1_over_phi", FoldDesign { alpha1_over_phi: None, ..paper_angles() }),
        ("top_radius", FoldDesign { half_angle: Some(0.1), ..paper_angles() }),
        ("top_radius", FoldDesign { top_radius: Some(0.3), ..paper_height(3) }),
        ("stowed_height", FoldDesign { stowed_height: 0.0, ..paper_design() }),
    ];
    for (expected, design) in broken {
        match FoldPattern::new(&design) {
            Err(FoldError::Invalid { key, .. }) => assert_eq!(key, expected),
            other => panic!("{expected}: {other:?}"),
        }
    }
}

/// The pattern closes but cannot be stowed at this height. The design is infeasible, and the error
/// gives the nearest lower height.
#[test]
fn a_stowed_height_too_large_has_a_nearest_smaller_one() {
    for (top_radius, stowed_height) in [(0.365, 2.0), (0.365, 0.9), (0.02, 0.3)] {
        let design = FoldDesign {
            storeys: 4,
            stowed_height,
            top_radius: Some(top_radius),
            ..paper_design()
        };
        let Err(FoldError::Infeasible { reason, nearest }) = FoldPattern::new(&design) else {
            panic!("{stowed_height} m is too large a stowed height");
        };
        assert!(reason.starts_with("stowed_height: "), "{reason}");
        assert_eq!(nearest.len(), 1);
        assert_eq!(nearest[0].key, "stowed_height");
        let nearest = nearest[0].value;
        assert!(nearest < stowed_height);
        solved(&FoldDesign { stowed_height: nearest, ..design.clone() });
        let higher = FoldDesign { stowed_height: 1.03 * nearest, ..design };
        assert!(FoldPattern::new(&higher).is_err(), "{nearest} m is not the nearest");
    }
}

/// Designs far from any feasible pattern have nearest values too.
#[test]
fn nearest_values_are_feasible_for_distant_designs() {
    let far = FoldDesign { alpha1_over_phi: Some(1e-3), ..paper_height(3) };
    let short = FoldDesign { top_radius: Some(1e-3), storeys: 1, ..paper_design() };
    for design in [far, short] {
        assert!(!nearest(&design).is_empty());
    }
}
