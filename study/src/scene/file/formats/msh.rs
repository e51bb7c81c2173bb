//! Gmsh files of version 2.2 and 4.1 in text: nodes, and the triangles and quadrangles among the elements.
//!
//! ```text
//! 2.2   $Nodes n, {tag x y z}                               $Elements n, {tag kind k, k tags, nodes}
//! 4.1   $Nodes blocks n min max, {dim entity par n, n tags, n × x y z}
//!       $Elements blocks n min max, {dim entity kind n, n × tag nodes}
//! ```

use std::collections::HashMap;
use std::str::{FromStr, SplitWhitespace};

use billow_solver::geometry::mesh_io::obj_reader::Surface;
use nalgebra::Vector3;

use super::{Fault, surface};

const ALLOWED: &str = "a Gmsh file of version 2.2 or 4.1 in text (Mesh.Binary = 0), with linear triangles or quadrangles";

/// Kinds of elements with their numbers of nodes, and whether they are film: lines and points are not.
const KINDS: [(u32, usize, bool); 4] = [(15, 1, false), (1, 2, false), (2, 3, true), (3, 4, true)];

fn fault(problem: impl Into<String>) -> Fault {
    (problem.into(), ALLOWED)
}

/// The words of a section.
struct Section<'a> {
    name: &'static str,
    words: SplitWhitespace<'a>,
}

impl<'a> Section<'a> {
    fn find(text: &'a str, name: &'static str) -> Result<Self, Fault> {
        let mut words = text.split_whitespace();
        let found = words.any(|word| word == name);
        if found { Ok(Self { name, words }) } else { Err(fault(format!("has no {name}"))) }
    }

    fn next<T: FromStr>(&mut self) -> Result<T, Fault> {
        let next = self.words.next().and_then(|word| word.parse().ok());
        next.ok_or_else(|| fault(format!("ends within {}, or has a word there", self.name)))
    }

    fn several<T: FromStr>(&mut self, number: usize) -> Result<Vec<T>, Fault> {
        (0..number).map(|_| self.next()).collect()
    }
}

/// The parts of a surface as they are read.
#[derive(Default)]
struct Parts {
    vertices: Vec<Vector3<f64>>,
    /// Index of each vertex by its tag.
    tags: HashMap<u64, u32>,
    faces: Vec<(Vec<u32>, usize)>,
    names: Vec<Vec<String>>,
}

impl Parts {
    fn add_node(&mut self, tag: u64, section: &mut Section<'_>) -> Result<(), Fault> {
        let index = u32::try_from(self.vertices.len()).map_err(|_| fault("has too many nodes"))?;
        self.tags.insert(tag, index);
        self.vertices.push(Vector3::from_vec(section.several(3)?));
        Ok(())
    }

    /// Adds an element of a kind on an entity of the geometry.
    fn add(&mut self, kind: u32, entity: u64, section: &mut Section<'_>) -> Result<(), Fault> {
        let known = KINDS.iter().find(|(known, ..)| *known == kind);
        let (_, corners, film) = known.ok_or_else(|| {
            fault(format!(
                "has elements of kind {kind}, no triangles or quadrangles of straight sides"
            ))
        })?;
        let tags: Vec<u64> = section.several(*corners)?;
        if !film {
            return Ok(());
        }
        let corner = |tag: &u64| {
            let index = self.tags.get(tag).copied();
            index.ok_or_else(|| fault(format!("an element names node {tag}, which is not there")))
        };
        let corners: Vec<u32> = tags.iter().map(corner).collect::<Result<_, _>>()?;
        let name = vec![format!("surface_{entity}")];
        let index = self.names.iter().position(|known| *known == name).unwrap_or_else(|| {
            self.names.push(name);
            self.names.len() - 1
        });
        self.faces.push((corners, index));
        Ok(())
    }
}

/// Reads the film of a Gmsh file. The faces of each surface of its geometry have the name `surface_TAG`.
pub(super) fn read(text: &str) -> Result<Surface, Fault> {
    let mut format = Section::find(text, "$MeshFormat")?;
    let (version, binary): (String, u32) = (format.next()?, format.next()?);
    if binary != 0 || !["2.2", "4.1"].contains(&version.as_str()) {
        return Err(fault(format!(
            "is of version {version}{}",
            if binary == 0 { "" } else { ", binary" }
        )));
    }
    let mut parts = Parts::default();
    let mut nodes = Section::find(text, "$Nodes")?;
    let blocks: usize = nodes.next()?;
    let mut elements = Section::find(text, "$Elements")?;
    let elements_or_blocks: usize = elements.next()?;
    if version == "2.2" {
        for _ in 0..blocks {
            let tag = nodes.next()?;
            parts.add_node(tag, &mut nodes)?;
        }
        for _ in 0..elements_or_blocks {
            let (_, kind, number): (u64, u32, usize) =
                (elements.next()?, elements.next()?, elements.next()?);
            // The physical group, then the entity.
            let tags: Vec<u64> = elements.several(number)?;
            parts.add(kind, tags.get(1).copied().unwrap_or_default(), &mut elements)?;
        }
    } else {
        nodes.several::<u64>(3)?;
        for _ in 0..blocks {
            nodes.several::<i64>(3)?;
            let number = nodes.next()?;
            for tag in nodes.several(number)? {
                parts.add_node(tag, &mut nodes)?;
            }
        }
        elements.several::<u64>(3)?;
        for _ in 0..elements_or_blocks {
            let (_, entity, kind, number): (u32, u64, u32, usize) =
                (elements.next()?, elements.next()?, elements.next()?, elements.next()?);
            for _ in 0..number {
                elements.next::<u64>()?;
                parts.add(kind, entity, &mut elements)?;
            }
        }
    }
    surface(parts.vertices, parts.faces, parts.names, ALLOWED)
}
