//! Files for other programs: FOLD and OBJ.

use std::collections::HashMap;

use billow_solver::geometry::fold::Assignment;
use billow_solver::geometry::mesh_io::{fold, obj};

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
fn developed_obj_has_the_area_of_the_film() {
    let pattern = solved(&paper_design());
    let text = obj::developed(&pattern, "developed");
    let mut vertices: Vec<[f64; 2]> = Vec::new();
    let mut area = 0.0;
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let at: Vec<f64> = words.map(|w| w.parse().expect("a number")).collect();
                vertices.push([at[0], at[1]]);
            }
            Some("f") => {
                let nodes: Vec<usize> = words.map(|w| w.parse().expect("an index")).collect();
                for (i, node) in nodes.iter().enumerate() {
                    let (p, q) = (vertices[node - 1], vertices[nodes[(i + 1) % nodes.len()] - 1]);
                    area += 0.5 * (p[0] * q[1] - p[1] * q[0]);
                }
            }
            _ => {}
        }
    }
    assert!((area / pattern.film_area() - 1.0).abs() < 1e-12, "{area}");
}
