use std::fmt::Write as _;

use super::*;

/// A tetrahedron: vertices, and faces that point outward.
const VERTICES: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -0.0, 1.0]];
const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

fn vertices() -> impl Iterator<Item = String> {
    VERTICES.iter().map(|[x, y, z]| format!("{x} {y} {z}"))
}

fn faces(first: u32) -> impl Iterator<Item = String> {
    FACES.iter().map(move |face| face.map(|corner| (corner + first).to_string()).join(" "))
}

fn lines(lines: impl Iterator<Item = String>) -> String {
    lines.fold(String::new(), |text, line| text + &line + "\n")
}

fn numbered(lines: impl Iterator<Item = String>, between: &str) -> String {
    (1..).zip(lines).fold(String::new(), |mut text, (number, line)| {
        let _ = writeln!(text, "{number} {between}{line}");
        text
    })
}

fn stl_text() -> String {
    let facet = |face: &[u32; 3]| {
        let corner = |corner: &u32| {
            let [x, y, z] = VERTICES[*corner as usize];
            format!("vertex {x} {y} {z}\n")
        };
        let corners: String = face.iter().map(corner).collect();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    format!("solid s\n{}endsolid s\n", FACES.iter().map(facet).collect::<String>())
}

fn stl_bytes() -> Vec<u8> {
    let mut bytes = [vec![0; 80], 4_u32.to_le_bytes().to_vec()].concat();
    for face in FACES {
        bytes.extend([0.0_f32; 3].iter().flat_map(|x| x.to_le_bytes()));
        let corners = face.iter().flat_map(|corner| VERTICES[*corner as usize]);
        bytes.extend(corners.flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

fn ply_head(format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
         element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    )
}

fn ply_text() -> String {
    ply_head("ascii") + &lines(vertices()) + &lines(faces(0).map(|face| format!("3 {face}")))
}

fn ply_bytes() -> Vec<u8> {
    let mut bytes = ply_head("binary_big_endian").into_bytes();
    bytes.extend(VERTICES.iter().flatten().flat_map(|x| x.to_be_bytes()));
    for face in FACES {
        bytes.push(3);
        bytes.extend(face.iter().flat_map(|corner| corner.to_be_bytes()));
    }
    bytes
}

fn msh_old() -> String {
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n{}$EndNodes\n$Elements\n4\n{}$EndElements\n",
        numbered(vertices(), ""),
        numbered(faces(1), "2 2 9 7 ")
    )
}

fn msh_new() -> String {
    format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n2 7 0 4\n1\n2\n3\n4\n{}$EndNodes\n$Elements\n2 5 1 5\n\
         0 1 15 1\n5 1\n2 7 2 4\n{}$EndElements\n",
        lines(vertices()),
        numbered(faces(1), "")
    )
}

fn fold_text() -> String {
    let list = |items: Vec<String>| format!("[{}]", items.join(","));
    let item = |line: String| format!("[{}]", line.replace(' ', ","));
    format!(
        "{{\"file_spec\": 1.1, \"vertices_coords\": {}, \"faces_vertices\": {}}}",
        list(vertices().map(item).collect()).replace("-0", "0"),
        list(faces(0).map(item).collect())
    )
}

fn obj_text() -> String {
    lines(vertices().map(|vertex| format!("v {vertex}")))
        + &lines(faces(1).map(|face| format!("f {face}")))
}

#[test]
fn a_tetrahedron_is_the_same_in_every_format() {
    let files: [(&str, Vec<u8>); 10] = [
        ("a.obj", obj_text().into_bytes()),
        ("A.OBJ", obj_text().replace('\n', "\r").into_bytes()),
        ("without_ending", obj_text().into_bytes()),
        ("a.stl", stl_text().into_bytes()),
        ("a.STL", stl_bytes()),
        ("a.ply", ply_text().into_bytes()),
        ("b.ply", ply_bytes()),
        ("a.msh", msh_old().into_bytes()),
        ("b.msh", msh_new().into_bytes()),
        ("a.fold", fold_text().into_bytes()),
    ];
    for (name, bytes) in files {
        let read = read(name, &bytes).unwrap_or_else(|(problem, _)| panic!("{name}: {problem}"));
        let is_stl = name.to_ascii_lowercase().ends_with("stl");
        assert_eq!(read.note.is_some(), is_stl, "{name}");
        let at = |corner: &u32| read.surface.vertices[*corner as usize];
        assert_eq!(read.surface.vertices.len(), 4, "{name}");
        for (face, given) in read.surface.faces.iter().zip(FACES) {
            let expected =
                given.map(|corner| Vector3::from(VERTICES[corner as usize].map(f64::from)));
            assert_eq!(face.corners.iter().map(at).collect::<Vec<_>>(), expected, "{name}");
        }
        let named = name.contains("msh").then(|| "surface_7".to_owned());
        assert_eq!(
            read.surface.names[read.surface.faces[0].names].first(),
            named.as_ref(),
            "{name}"
        );
    }
}

#[test]
fn what_is_not_such_a_file_is_refused_by_what_is_wrong() {
    let other = |text: String, from: &str, to: &str| {
        assert!(text.contains(from), "{text}");
        text.replacen(from, to, 1).into_bytes()
    };
    let files: [(&str, Vec<u8>, &str); 12] = [
        ("a.stl", b"solid s\nfacet normal 0 0 0\n".to_vec(), ""),
        ("a.stl", stl_bytes()[..120].to_vec(), ""),
        ("a.ply", other(ply_text(), "property float z\n", ""), ""),
        ("a.ply", other(ply_text(), "3 0 2 1", "3 0 2 9"), "the face number 1 names vertex 9 of 4"),
        ("a.ply", other(ply_text(), "vertex_indices", "corners"), "a face without vertex_indices"),
        ("a.msh", other(msh_new(), "4.1 0", "4.1 1"), "version 4.1, binary"),
        ("a.msh", other(msh_new(), "4.1 0", "4.0 0"), "version 4.0"),
        ("a.msh", other(msh_old(), "$Elements", "$Element"), "has no $Elements"),
        ("a.msh", other(msh_new(), "2 7 2 4", "2 7 9 4"), "elements of kind 9"),
        ("a.msh", msh_old().into_bytes()[..90].to_vec(), ""),
        ("a.fold", other(fold_text(), "faces_vertices", "faces"), "has no faces_vertices"),
        (
            "a.fold",
            other(fold_text(), "[0,2,1]", "[0,2,2]"),
            "the face number 1 has fewer than three",
        ),
    ];
    for (name, bytes, problem) in files {
        match read(name, &bytes) {
            Ok(read) => panic!("{name}: {:?}", read.surface),
            Err((found, allowed)) => {
                assert!(found.contains(problem), "{name}: {found}");
                assert!(allowed.starts_with('a'), "{allowed}");
            }
        }
    }
}
