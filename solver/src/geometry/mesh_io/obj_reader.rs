//! Reads vertices and faces of Wavefront OBJ.
//!
//! Accepted: `v x y z` (a weight or colour after them is ignored); `f` with three or more corners written
//! `7`, `7/1`, `7//2` or `7/1/2`, 1-based or negative (counted back from the last vertex so far); names
//! of `g` and `o`; texture coordinates `vt u v` and their numbers in a face; comments; lines continued after a `\`;
//! any line ending. Normals, materials, lines and points are ignored.

use std::borrow::Cow;

use nalgebra::Vector3;

/// Surface of a mesh file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surface {
    /// Vertices, in the units of the file.
    pub vertices: Vec<Vector3<f64>>,
    /// Faces, in the order of the file.
    pub faces: Vec<Face>,
    /// Distinct lists of group and object names that apply to faces.
    pub names: Vec<Vec<String>>,
    /// Texture coordinates, in the units of the file.
    pub texture: Vec<[f64; 2]>,
}

/// A face as in the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Face {
    /// Its vertices in order, 0-based.
    pub corners: Vec<u32>,
    /// Its names, as an index into [`Surface::names`].
    pub names: usize,
    /// Its texture coordinates by number, 0-based, one for each corner; none where a corner has none.
    pub texture: Vec<u32>,
    /// Where it is in its file.
    pub place: Place,
}

/// Where a face is in its file: "on line 12", "number 3".
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Line, 1-based.
    Line(usize),
    /// Number among the faces, 1-based.
    Number(usize),
}

impl core::fmt::Display for Place {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Line(line) => write!(f, "on line {line}"),
            Self::Number(number) => write!(f, "number {number}"),
        }
    }
}

/// Why a text is not a valid surface.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {problem}; allowed: {allowed}")]
pub struct ObjError {
    /// Line, 1-based.
    pub line: usize,
    /// What is wrong.
    pub problem: String,
    /// What is allowed.
    pub allowed: &'static str,
}

const VERTEX: &str = "v and three finite numbers, as in `v 0.1 2e-3 -4`";
const FACE: &str = "three or more different vertices by number, 1 for the first or -1 for the last so \
                    far, as in `f 1 2 3` or `f 1/4 2/5 -1/6`";

/// Reads a surface.
pub fn read(text: &str) -> Result<Surface, ObjError> {
    let mut surface = Surface::default();
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let (mut vertices, mut textures) = (0, 0);
    for (_, line) in lines(text) {
        match line.split_whitespace().next() {
            Some("v") => vertices += 1,
            Some("vt") => textures += 1,
            _ => {}
        }
    }
    let (mut groups, mut object) = (Vec::new(), Vec::new());
    for (line, content) in lines(text) {
        let mut words = content.split_whitespace();
        let Some(keyword) = words.next() else { continue };
        match keyword {
            "v" => {
                let position =
                    vertex(words).map_err(|problem| ObjError { line, problem, allowed: VERTEX })?;
                surface.vertices.push(position);
            }
            "f" => {
                let so_far = surface.vertices.len();
                let texture = texture_of(words.clone(), textures, surface.texture.len());
                let corners = face(words, vertices, so_far).map_err(|problem| ObjError {
                    line,
                    problem,
                    allowed: FACE,
                })?;
                let names: Vec<String> = [&groups[..], &object[..]].concat();
                if surface.names.last() != Some(&names) {
                    surface.names.push(names);
                }
                let (names, place) = (surface.names.len() - 1, Place::Line(line));
                surface.faces.push(Face { corners, names, texture, place });
            }
            "g" => groups = words.map(str::to_owned).collect(),
            // An object name may contain spaces.
            "o" => object = vec![words.collect::<Vec<_>>().join(" ")],
            "vt" => {
                let numbers = words.take(2).map(str::parse);
                let numbers: Result<Vec<f64>, _> = numbers.collect();
                // A file whose texture is not asked for may have any.
                let [u, v] = numbers.ok().and_then(|n| n.try_into().ok()).unwrap_or([f64::NAN; 2]);
                surface.texture.push([u, v]);
            }
            // OBJ keywords that do not define the surface.
            "vn" | "vp" | "s" | "mg" | "usemtl" | "mtllib" | "usemap" | "maplib" | "l" | "p"
            | "bevel" | "c_interp" | "d_interp" | "lod" | "shadow_obj" | "trace_obj" | "ctech"
            | "stech" | "cstype" | "deg" | "bmat" | "step" | "curv" | "curv2" | "surf" | "parm"
            | "trim" | "hole" | "scrv" | "sp" | "end" | "con" | "call" | "csh" | "vc" => {}
            other => {
                let shown: String = other.chars().take(20).collect();
                return Err(ObjError {
                    line,
                    problem: format!("{shown:?} is not an OBJ keyword"),
                    allowed: "v, f, g, o, # and the other keywords of the OBJ format",
                });
            }
        }
    }
    Ok(surface)
}

/// Lines with their numbers, without comments; a line and its continuations after `\` are one.
fn lines(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    // A file with line ends of CR alone has no other.
    let end = if text.contains('\n') { '\n' } else { '\r' };
    let mut rest = (1..).zip(text.split(end));
    std::iter::from_fn(move || {
        let (number, first) = rest.next()?;
        let mut line = Cow::Borrowed(without_comment(first));
        while let Some(part) = line.trim_end().strip_suffix('\\') {
            let next = rest.next().map_or("", |(_, next)| without_comment(next));
            line = Cow::Owned(format!("{part} {next}"));
        }
        Some((number, line))
    })
}

/// A line without its comment.
fn without_comment(line: &str) -> &str {
    line.split('#').next().unwrap_or_default()
}

fn vertex<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<Vector3<f64>, String> {
    let mut position = [0.0; 3];
    for entry in &mut position {
        let word = words.next().ok_or("a vertex with fewer than three numbers")?;
        let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
        *entry = number.ok_or_else(|| format!("{:?} is not a finite number", shortened(word)))?;
    }
    Ok(position.into())
}

fn shortened(word: &str) -> String {
    word.chars().take(20).collect()
}

/// The texture coordinates of a face, of which there are `textures` in all and `so_far` above this line; none unless each
/// corner names one.
fn texture_of<'a>(
    words: impl Iterator<Item = &'a str>,
    textures: usize,
    so_far: usize,
) -> Vec<u32> {
    let index = |word: &str| {
        let number = word.split('/').nth(1)?.parse::<i64>().ok()?;
        let magnitude = usize::try_from(number.unsigned_abs()).ok()?;
        let index =
            if number > 0 { magnitude.checked_sub(1) } else { so_far.checked_sub(magnitude) };
        u32::try_from(index.filter(|index| *index < textures)?).ok()
    };
    words.map(index).collect::<Option<_>>().unwrap_or_default()
}

/// Corners of a face. `vertices` is the number of vertices in all, `so_far` that above this line.
fn face<'a>(
    words: impl Iterator<Item = &'a str>,
    vertices: usize,
    so_far: usize,
) -> Result<Vec<u32>, String> {
    let mut corners = Vec::new();
    for word in words {
        let number = word.split('/').next().and_then(|number| number.parse::<i64>().ok());
        let number =
            number.ok_or_else(|| format!("{:?} is not a vertex number", shortened(word)))?;
        let index = match number {
            0 => return Err("vertex 0: the first vertex is 1".to_owned()),
            1.. => usize::try_from(number - 1).ok().filter(|index| *index < vertices),
            _ => usize::try_from(number.unsigned_abs()).ok().and_then(|n| so_far.checked_sub(n)),
        };
        let index = index.and_then(|index| u32::try_from(index).ok());
        let index =
            index.ok_or_else(|| format!("vertex {number} does not exist: there are {vertices}"))?;
        if corners.contains(&index) {
            return Err(format!("names vertex {number} twice"));
        }
        corners.push(index);
    }
    if corners.len() < 3 {
        return Err(format!("a face with {} corners", corners.len()));
    }
    Ok(corners)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::mesh_io::obj;

    #[test]
    fn common_obj_syntax_is_read() {
        let text = "\u{feff}# a comment\r\nmtllib x.mtl\r\no Bag one\r\nv 0 0 0 1.0\r\nv 1e0 0 \\\r\n 0 \
                    0.2 0.3 0.4 # colour\r\nv +1 1. -.5\r\nvt 0 0\r\nvn 0 0 1\r\n\r\nusemtl \
                    skin\r\ns off\r\nf 1/1/1 2/2/1 3/3/1\r\ng lid top\r\nf -3//1 -1//1 4//1\r\nv 0 1 \
                    0\r\nf 1 2 3 4\r\nl 1 2\r\np 1\r\n";
        let surface = read(text).unwrap();
        assert_eq!(surface.vertices.len(), 4);
        assert_eq!(surface.vertices[1], Vector3::new(1.0, 0.0, 0.0));
        assert_eq!(surface.vertices[2], Vector3::new(1.0, 1.0, -0.5));
        let corners: Vec<&[u32]> = surface.faces.iter().map(|face| &face.corners[..]).collect();
        assert_eq!(corners, [&[0, 1, 2][..], &[0, 2, 3], &[0, 1, 2, 3]]);
        assert_eq!(surface.faces[0].place, Place::Line(13));
        let names = |face: usize| surface.names[surface.faces[face].names].clone();
        assert_eq!(names(0), ["Bag one"]);
        assert_eq!(names(2), ["lid", "top", "Bag one"]);
    }

    #[test]
    fn a_surface_that_is_written_is_read_back() {
        let text = "v 0.1 0 0\nv 1 1e-7 0\nv 1 1 0\nv 0 1 -3\nvt 0 0.5\nvt 1 0\nvt 0.3 1\ng a b\nf 1/1 2/2 3/3\ng c\nf 1 3 4\n";
        let surface = read(text).unwrap();
        let again = read(&obj::surface(&surface, &surface.vertices, "again")).unwrap();
        assert_eq!((&again.vertices, &again.texture), (&surface.vertices, &surface.texture));
        let faces = |surface: &Surface| -> Vec<_> {
            let names = |face: &Face| surface.names[face.names].clone();
            let faces = surface.faces.iter();
            faces.map(|face| (face.corners.clone(), face.texture.clone(), names(face))).collect()
        };
        assert_eq!(faces(&again), faces(&surface));
    }

    #[test]
    fn errors_name_line_and_problem() {
        for (text, line, problem) in [
            ("v 0 0\n", 1, "fewer than three"),
            ("\nv 0 0 x\n", 2, "\"x\" is not a finite number"),
            ("v 0 0 nan\n", 1, "not a finite number"),
            ("v 0 0 0\nf 1 1 1\n", 2, "twice"),
            ("v 0 0 0\nf 1 2 3\n", 2, "vertex 2 does not exist"),
            ("v 0 0 0\nf 0 2 3\n", 2, "the first vertex is 1"),
            ("v 0 0 0\nf -2 2 3\n", 2, "vertex -2 does not exist"),
            ("v 0 0 0\nv 1 0 0\nf 1 2\n", 3, "a face with 2 corners"),
            ("v 0 0 0\nf a b c\n", 2, "\"a\" is not a vertex number"),
            ("solid ascii\n", 1, "\"solid\" is not an OBJ keyword"),
        ] {
            let error = read(text).unwrap_err();
            assert_eq!(error.line, line, "{text:?}");
            assert!(error.problem.contains(problem), "{text:?}: {error}");
        }
    }

    proptest! {
        #[test]
        fn random_text_gives_a_valid_surface_or_an_error_with_its_line(text in "\\PC{0,200}") {
            match read(&text) {
                Ok(surface) => {
                    let finite = |x: &Vector3<f64>| x.iter().all(|component| component.is_finite());
                    prop_assert!(surface.vertices.iter().all(finite));
                    let count = surface.vertices.len();
                    let mut corners = surface.faces.iter().flat_map(|face| &face.corners);
                    prop_assert!(corners.all(|corner| (*corner as usize) < count));
                }
                Err(error) => {
                    prop_assert!((1..=text.lines().count() + 1).contains(&error.line), "{error}");
                    prop_assert!(!error.problem.is_empty() && !error.allowed.is_empty());
                }
            }
        }

        #[test]
        fn text_similar_to_obj_gives_a_valid_surface_or_an_error(
            text in "((v|f|g|o|#|vn|\\\\)[ \t]?(-?[0-9]{0,20}[/.e]?){0,5}[ \\\\\r]?\n?){0,20}"
        ) {
            if let Ok(surface) = read(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{text}")) {
                let vertices = surface.vertices.len();
                for face in &surface.faces {
                    prop_assert!(face.corners.len() >= 3);
                    prop_assert!(face.corners.iter().all(|c| (*c as usize) < vertices));
                }
            }
        }
    }
}
