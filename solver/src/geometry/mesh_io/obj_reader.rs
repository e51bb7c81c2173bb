//! Reading Wavefront OBJ: vertices and faces, whatever program wrote them.
//!
//! Read: `v x y z` (a weight or a colour after them is ignored), `f` of three or more corners written
//! `7`, `7/1`, `7//2` or `7/1/2`, 1-based or negative (counted back from the last vertex so far), `g`
//! and `o` names, comments, lines that go on after a `\`, any line end. Texture, normals, materials,
//! lines and points are passed over. A polygon is cut into a fan from its first corner.

use std::borrow::Cow;

use nalgebra::Vector3;

/// What an OBJ file says of a surface.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surface {
    /// Vertices, in the file's units.
    pub vertices: Vec<Vector3<f64>>,
    /// Faces, in the order of the file.
    pub faces: Vec<Face>,
    /// Lists of group and object names in force at a face.
    pub names: Vec<Vec<String>>,
}

/// A face as written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Face {
    /// Its vertices in order, 0-based.
    pub corners: Vec<u32>,
    /// Names in force, a position in [`Surface::names`].
    pub names: usize,
    /// Line of the file, 1-based.
    pub line: usize,
}

impl Face {
    /// The triangles of its fan, as positions in [`Self::corners`].
    pub fn fan(&self) -> impl Iterator<Item = [usize; 3]> {
        (1..self.corners.len() - 1).map(|corner| [0, corner, corner + 1])
    }
}

/// Why a text is no surface.
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

/// Keywords that say nothing of the surface.
const PASSED_OVER: [&str; 36] = [
    "vt",
    "vn",
    "vp",
    "s",
    "mg",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "l",
    "p",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "cstype",
    "deg",
    "bmat",
    "step",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "call",
    "csh",
    "vc",
];

const VERTEX: &str = "v and three finite numbers, as in `v 0.1 2e-3 -4`";
const FACE: &str = "three or more different vertices by number, 1 for the first or -1 for the last so \
                    far, as in `f 1 2 3` or `f 1/4 2/5 -1/6`";

/// Reads a surface. Where the text has no vertices of its own, its faces are over `given` ones.
///
/// # Errors
/// [`ObjError`] at the first line that is none.
pub fn read(text: &str, given: usize) -> Result<Surface, ObjError> {
    let mut surface = Surface::default();
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let is_vertex = |line: &str| line.split_whitespace().next() == Some("v");
    let own = lines(text).filter(|(_, line)| is_vertex(line)).count();
    let known = if own > 0 { own } else { given };
    let (mut groups, mut object) = (Vec::new(), Vec::new());
    for (line, content) in lines(text) {
        let mut words = content.split_whitespace();
        let Some(keyword) = words.next() else { continue };
        match keyword {
            "v" => {
                let place =
                    vertex(words).map_err(|problem| ObjError { line, problem, allowed: VERTEX })?;
                surface.vertices.push(place);
            }
            "f" => {
                let so_far = if own > 0 { surface.vertices.len() } else { given };
                let corners = face(words, known, so_far).map_err(|problem| ObjError {
                    line,
                    problem,
                    allowed: FACE,
                })?;
                let in_force: Vec<String> = [&groups[..], &object[..]].concat();
                if surface.names.last() != Some(&in_force) {
                    surface.names.push(in_force);
                }
                surface.faces.push(Face { corners, names: surface.names.len() - 1, line });
            }
            "g" => groups = words.map(str::to_owned).collect(),
            // An object's name may hold blanks.
            "o" => object = vec![words.collect::<Vec<_>>().join(" ")],
            other if PASSED_OVER.contains(&other) => {}
            other => {
                let shown: String = other.chars().take(20).collect();
                return Err(ObjError {
                    line,
                    problem: format!("{shown:?} is no keyword of an OBJ file"),
                    allowed: "v, f, g, o, # and what other programs put beside them",
                });
            }
        }
    }
    Ok(surface)
}

/// Lines with their numbers, those that go on after a `\` as one, without comments.
fn lines(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut rest = (1..).zip(text.lines());
    std::iter::from_fn(move || {
        let (number, first) = rest.next()?;
        let mut line = Cow::Borrowed(bare(first));
        while let Some(part) = line.trim_end().strip_suffix('\\') {
            let next = rest.next().map_or("", |(_, next)| bare(next));
            line = Cow::Owned(format!("{part} {next}"));
        }
        Some((number, line))
    })
}

/// A line without its comment.
fn bare(line: &str) -> &str {
    line.split('#').next().unwrap_or_default()
}

fn vertex<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<Vector3<f64>, String> {
    let mut place = [0.0; 3];
    for part in &mut place {
        let word = words.next().ok_or("a vertex of fewer than three numbers")?;
        let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
        *part = number.ok_or_else(|| format!("{:?} is no finite number", brief(word)))?;
    }
    Ok(place.into())
}

fn brief(word: &str) -> String {
    word.chars().take(20).collect()
}

/// Corners of a face: `known` vertices in the file, `so_far` of them above it.
fn face<'a>(
    words: impl Iterator<Item = &'a str>,
    known: usize,
    so_far: usize,
) -> Result<Vec<u32>, String> {
    let mut corners = Vec::new();
    for word in words {
        let number = word.split('/').next().and_then(|number| number.parse::<i64>().ok());
        let number = number.ok_or_else(|| format!("{:?} is no corner", brief(word)))?;
        let index = match number {
            0 => return Err("vertex 0: vertices are counted from 1".to_owned()),
            1.. => usize::try_from(number - 1).ok().filter(|index| *index < known),
            _ => usize::try_from(number.unsigned_abs()).ok().and_then(|n| so_far.checked_sub(n)),
        };
        let index = index.and_then(|index| u32::try_from(index).ok());
        let index = index.ok_or_else(|| format!("vertex {number} of {known}"))?;
        if corners.contains(&index) {
            return Err(format!("names vertex {number} twice"));
        }
        corners.push(index);
    }
    if corners.len() < 3 {
        return Err(format!("a face of {} corners", corners.len()));
    }
    Ok(corners)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn what_programs_write_is_read() {
        let text = "\u{feff}# a comment\r\nmtllib x.mtl\r\no Bag one\r\nv 0 0 0 1.0\r\nv 1e0 0 \\\r\n 0 \
                    0.2 0.3 0.4 # colour\r\nv +1 1. -.5\r\nvt 0 0\r\nvn 0 0 1\r\n\r\nusemtl \
                    skin\r\ns off\r\nf 1/1/1 2/2/1 3/3/1\r\ng lid top\r\nf -3//1 -1//1 4//1\r\nv 0 1 \
                    0\r\nf 1 2 3 4\r\nl 1 2\r\np 1\r\n";
        let surface = read(text, 0).unwrap();
        assert_eq!(surface.vertices.len(), 4);
        assert_eq!(surface.vertices[1], Vector3::new(1.0, 0.0, 0.0));
        assert_eq!(surface.vertices[2], Vector3::new(1.0, 1.0, -0.5));
        let corners: Vec<&[u32]> = surface.faces.iter().map(|face| &face.corners[..]).collect();
        assert_eq!(corners, [&[0, 1, 2][..], &[0, 2, 3], &[0, 1, 2, 3]]);
        let fan: Vec<_> = surface.faces[2].fan().collect();
        assert_eq!(fan, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(surface.faces[0].line, 13);
        let names = |face: usize| surface.names[surface.faces[face].names].clone();
        assert_eq!(names(0), ["Bag one"]);
        assert_eq!(names(2), ["lid", "top", "Bag one"]);
    }

    #[test]
    fn faces_over_given_vertices_need_none_of_their_own() {
        assert_eq!(read("f 1 2 -1\n", 7).unwrap().faces[0].corners, [0, 1, 6]);
        assert_eq!(read("f 1 2 8\n", 7).unwrap_err().problem, "vertex 8 of 7");
    }

    #[test]
    fn errors_name_their_line() {
        for (text, line, problem) in [
            ("v 0 0\n", 1, "fewer than three"),
            ("\nv 0 0 x\n", 2, "\"x\" is no finite number"),
            ("v 0 0 nan\n", 1, "no finite number"),
            ("v 0 0 0\nf 1 1 1\n", 2, "twice"),
            ("v 0 0 0\nf 1 2 3\n", 2, "vertex 2 of 1"),
            ("v 0 0 0\nf 0 2 3\n", 2, "counted from 1"),
            ("v 0 0 0\nf -2 2 3\n", 2, "vertex -2 of 1"),
            ("v 0 0 0\nv 1 0 0\nf 1 2\n", 3, "a face of 2 corners"),
            ("v 0 0 0\nf a b c\n", 2, "\"a\" is no corner"),
            ("solid ascii\n", 1, "\"solid\" is no keyword"),
        ] {
            let error = read(text, 0).unwrap_err();
            assert_eq!(error.line, line, "{text:?}");
            assert!(error.problem.contains(problem), "{text:?}: {error}");
        }
    }

    proptest! {
        #[test]
        fn random_text_gives_a_valid_surface_or_an_error_with_its_line(text in "\\PC{0,200}") {
            match read(&text, 3) {
                Ok(surface) => {
                    let finite = |x: &Vector3<f64>| x.iter().all(|component| component.is_finite());
                    prop_assert!(surface.vertices.iter().all(finite));
                    let count = if surface.vertices.is_empty() { 3 } else { surface.vertices.len() };
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
            if let Ok(surface) = read(&text, 3) {
                let vertices = if surface.vertices.is_empty() { 3 } else { surface.vertices.len() };
                for face in &surface.faces {
                    prop_assert!(face.fan().count() + 2 == face.corners.len());
                    prop_assert!(face.corners.iter().all(|c| (*c as usize) < vertices));
                }
            }
        }
    }
}
