//! The film of a scene before its gas: a folded capsule, or film from a mesh.

use std::sync::Arc;

use nalgebra::Vector3;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::error::SceneError;
use super::film_support::FilmSupport;
use crate::geometry::fold::{FoldDesign, FoldPattern};
use crate::geometry::shell::Shell;

/// What the film of a scene is.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Design {
    /// A capsule, folded by its pattern.
    Capsule(FoldDesign),
    /// Film of any shape.
    Mesh(MeshDesign),
}

/// Film of any shape, with what its mesh decides. Copies share it.
#[derive(Debug, Clone)]
pub struct MeshDesign {
    /// Hash of the film: it stands for it in the id of a job, and where two are compared.
    pub hash: String,
    /// Pieces along each edge of its mesh.
    pub subdivisions: u32,
    /// The film.
    pub film: Arc<MeshFilm>,
}

/// The film of a [`MeshDesign`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshFilm {
    /// Positions at the start, stress-free shape, triangles, closing faces.
    pub shell: Shell,
    /// Positions of the nodes where the film is free of stress, m: static equilibria are searched from there. `None` where
    /// they are those at the start, or not those of one closed surface.
    pub unstressed: Option<Vec<Vector3<f64>>>,
    /// Supports of its nodes.
    pub supports: Vec<FilmSupport>,
    /// Contact distance where the scene gives none, m.
    pub contact_distance: f64,
    /// Amplitude of the imperfection where the scene gives none, m: the same on finer meshes of a file.
    pub imperfection_amplitude: f64,
    /// Pairs of elements without contact: they touch at the start.
    pub ignored: Vec<[u32; 2]>,
}

impl Serialize for MeshDesign {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Identity<'a> {
            mesh: &'a str,
        }
        Identity { mesh: &self.hash }.serialize(serializer)
    }
}

impl PartialEq for MeshDesign {
    fn eq(&self, other: &Self) -> bool {
        self.hash == other.hash
    }
}

/// Reads the design of a capsule: a mesh is not stored in a scene.
impl<'de> Deserialize<'de> for Design {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        FoldDesign::deserialize(deserializer).map(Self::Capsule)
    }
}

impl From<FoldDesign> for Design {
    fn from(design: FoldDesign) -> Self {
        Self::Capsule(design)
    }
}

/// The error of a scene whose film is not folded by a pattern.
fn not_folded() -> SceneError {
    let problem = "film from a mesh has no panels and storeys; allowed: film";
    SceneError::invalid("solver.model", problem)
}

impl Design {
    /// The design of a capsule.
    ///
    /// # Errors
    /// [`SceneError::Invalid`] for film from a mesh, as in [`Self::folded_mut`] and [`Self::pattern`].
    pub fn folded(&self) -> Result<&FoldDesign, SceneError> {
        match self {
            Self::Capsule(design) => Ok(design),
            Self::Mesh(_) => Err(not_folded()),
        }
    }

    /// The design of a capsule, to change it.
    pub fn folded_mut(&mut self) -> Result<&mut FoldDesign, SceneError> {
        match self {
            Self::Capsule(design) => Ok(design),
            Self::Mesh(_) => Err(not_folded()),
        }
    }

    /// The fold pattern of a capsule.
    pub fn pattern(&self) -> Result<FoldPattern, SceneError> {
        Ok(FoldPattern::new(self.folded()?)?)
    }

    /// Subdivisions of a facet edge, or of an edge of the mesh.
    pub fn subdivisions(&self) -> u32 {
        match self {
            Self::Capsule(design) => design.subdivisions,
            Self::Mesh(design) => design.subdivisions,
        }
    }

    /// Number of elements of film.
    pub fn elements(&self) -> u64 {
        match self {
            Self::Capsule(design) => design.elements(),
            Self::Mesh(design) => design.film.shell.triangles.len() as u64,
        }
    }

    /// Mean radius of the rings of a capsule; of any other film that of a sphere of its area, m.
    pub fn mean_radius(&self) -> Result<f64, SceneError> {
        match self {
            Self::Capsule(_) => {
                let pattern = self.pattern()?;
                Ok(0.5 * (pattern.bottom_radius + pattern.top_radius))
            }
            Self::Mesh(design) => {
                let area = design.film.shell.reference_area();
                Ok((area / (4.0 * core::f64::consts::PI)).sqrt())
            }
        }
    }
}
