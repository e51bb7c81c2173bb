//! Files for other programs: FOLD and OBJ.

use std::collections::HashMap;

use billow_solver::geometry::fold::Assignment;
use billow_solver::geometry::mesh_io::{fold, obj, obj_reader};

use crate::geometry::{paper_design, solved};
use crate::prelude::*;

#[test]
fn fold_assignments_agree_with_the_stowed_shape() {
    for chirality in [Chirality::Same, Chirality::Alternate] {
        let pattern = solved(&FoldDesign { chirality, ..paper_design() });
        let text = fold::crease_pattern(&pattern, "test");
        let file: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        assert!(file["file_spec"].as_f64().expect("a number") >= 1.1);
        let count = |key: &str| file[key].as_array().expect(key).len();
        let (vertices, edges, faces) =
            (count("vertices_coords"), count("edges_vertices"), count("faces_vertices"));
        assert_eq!((vertices, edges, faces), (28, 4 * 6 + 3 * (7 + 6), 36));
        // A disc: V − E + F = 1.
        assert_eq!(vertices + faces, edges + 1);
        assert_eq!(count("edges_assignment"), edges);
        // Each assignment agrees with the dihedral angle of the folded form, which is nearly flat.
        let folded = &file["file_frames"][0]["edges_foldAngle"];
        let mut seen = HashMap::new();
        for (i, letter) in file["edges_assignment"].as_array().expect("letters").iter().enumerate()
        {
            let letter = letter.as_str().expect("a letter");
            *seen.entry(letter.to_owned()).or_insert(0) += 1;
            match letter {
                "M" => assert!(folded[i].as_f64().expect("an angle") < -120.0, "edge {i}"),
                "V" => assert!(folded[i].as_f64().expect("an angle") > 120.0, "edge {i}"),
                _ => assert!(folded[i].is_null()),
            }
        }
        assert_eq!(seen["V"], 18);
        assert_eq!(seen["M"], 2 * 6 + 3 * 5);
        assert_eq!(seen["B"], 2 * 6 + 2 * 3);
        let mountains =
            pattern.creases().iter().filter(|c| c.assignment == Assignment::Mountain).count();
        assert_eq!(mountains, seen["M"]);
    }
}

#[test]
fn obj_keeps_every_digit_of_the_mesh() {
    let pattern = solved(&paper_design());
    let mesh = Mesh::new(&pattern, 5, Shape::Stowed(0.04)).expect("foldable");
    let text = obj::mesh(&mesh, "stowed");
    let numbers = |prefix: &str| -> Vec<Vec<f64>> {
        text.lines()
            .filter_map(|line| line.strip_prefix(prefix))
            .map(|rest| rest.split_whitespace().map(|n| n.parse().expect("a number")).collect())
            .collect()
    };
    let (vertices, faces) = (numbers("v "), numbers("f "));
    assert_eq!(vertices.len(), mesh.positions.len());
    assert_eq!(faces.len(), 1200);
    for (written, position) in vertices.iter().zip(&mesh.positions) {
        assert_eq!(written.as_slice(), position.as_slice());
    }
    assert_eq!(text.lines().filter(|line| line.starts_with("g ")).count(), 5);
}

#[test]
fn developed_obj_is_the_reference_of_the_other_shapes() {
    let pattern = solved(&paper_design());
    let mesh = Mesh::new(&pattern, 3, Shape::Stowed(0.04)).expect("foldable");
    let surface = obj_reader::read(&obj::developed(&pattern, &mesh, "developed")).expect("OBJ");
    assert_eq!(surface.faces.len(), mesh.triangles.len());
    let mut area = 0.0;
    for (face, reference) in surface.faces.iter().zip(&mesh.reference) {
        let flat = [0, 1, 2].map(|k| surface.vertices[face.corners[k] as usize].xy());
        for k in 0..3 {
            let (drawn, real) =
                (flat[(k + 1) % 3] - flat[k], reference[(k + 1) % 3] - reference[k]);
            assert!((drawn.norm() - real.norm()).abs() < 1e-9, "{face:?}");
        }
        area += 0.5 * (flat[1] - flat[0]).perp(&(flat[2] - flat[0]));
    }
    assert!((area / pattern.film_area() - 1.0).abs() < 1e-9, "{area}");
    // One sheet, cut open along its seam, and two caps.
    let seam = 3 * pattern.design.storeys as usize + 1;
    let rings = 2 * 3 * pattern.design.panels as usize;
    assert_eq!(surface.vertices.len(), mesh.positions.len() + seam + rings);
}
