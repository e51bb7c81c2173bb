//! A shape of the film as a model of other programs: OBJ, STL, and glTF with its motion.

use std::fmt::Write as _;

use billow_solver::output::frames::Frame;

mod glb;

pub use glb::glb;

/// A shape as OBJ: vertices in m, triangles counter-clockwise from outside, one group a storey.
pub fn obj(triangles: &[[u32; 3]], storeys: &[u32], frame: &Frame, title: &str) -> String {
    let title: String = title.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let mut text = format!("# {title}\n# m; {} s\n", frame.time);
    for [x, y, z] in &frame.positions {
        let _ = writeln!(text, "v {x} {y} {z}");
    }
    let mut last = None;
    for (triangle, storey) in triangles.iter().zip(storeys) {
        if last != Some(storey) {
            let _ = writeln!(text, "g storey_{storey}");
            last = Some(storey);
        }
        let [a, b, c] = triangle.map(|node| node + 1);
        let _ = writeln!(text, "f {a} {b} {c}");
    }
    text
}

/// A shape as binary STL, m.
///
/// # Errors
/// What the writer says.
pub fn stl(triangles: &[[u32; 3]], frame: &Frame) -> Result<Vec<u8>, String> {
    let corner = |node: u32| stl_io::Vector::new(frame.positions[node as usize]);
    let triangles = triangles.iter().map(|triangle| {
        let vertices = triangle.map(corner);
        let side = |k: usize| [0, 1, 2].map(|i| vertices[k][i] - vertices[0][i]);
        let (u, v) = (side(1), side(2));
        let normal = [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            u[j] * v[k] - u[k] * v[j]
        });
        let length = normal.iter().map(|x| x * x).sum::<f32>().sqrt();
        let unit = if length > 0.0 { normal.map(|x| x / length) } else { [0.0; 3] };
        stl_io::Triangle { normal: stl_io::Normal::new(unit), vertices }
    });
    let mut bytes = Vec::new();
    stl_io::write_stl(&mut bytes, triangles.collect::<Vec<_>>().iter())
        .map_err(|error| error.to_string())?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn frame(time: f64, height: f32) -> Frame {
        Frame {
            time,
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, height]],
            ..Frame::default()
        }
    }

    /// A tetrahedron, outside out.
    pub(super) const TRIANGLES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    #[test]
    fn obj_and_stl_hold_the_shape() {
        let frame = frame(0.25, 2.0);
        let text = obj(&TRIANGLES, &[0, 1, 1, 2], &frame, "a\nb");
        assert!(text.starts_with("# a b\n# m; 0.25 s\nv 0 0 0\n"), "{text}");
        assert_eq!(text.matches("\nf ").count(), 4);
        assert_eq!(text.matches("\ng storey_").count(), 3);
        let bytes = stl(&TRIANGLES, &frame).unwrap();
        let read = stl_io::read_stl(&mut std::io::Cursor::new(bytes)).unwrap();
        assert_eq!((read.vertices.len(), read.faces.len()), (4, 4));
        // The lowest face looks down.
        assert!((read.faces[0].normal[2] + 1.0).abs() < 1e-6);
    }
}
