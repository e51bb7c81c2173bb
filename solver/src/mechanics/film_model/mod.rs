//! What is constant while film moves: elements, masses.
//!
//! ```text
//! Dm = [X1 − X0, X2 − X0]      A = det Dm/2      F = [x1 − x0, x2 − x0] Dm⁻¹
//! m_i = Σ_e ρ t A_e/3          ω_e: largest in-plane frequency of the lumped element
//! ```
//!
//! Symbols: X flat reference, x current places of an element's corners, m; F deformation gradient
//! (3×2); A reference area, m²; m lumped mass, kg. One `Vec` a quantity; element quantities are
//! indexed by element, node quantities by node, those of the pass over elements by kite.

use std::collections::BTreeSet;

use nalgebra::Vector2;

use crate::geometry::shell::Shell;
use crate::mechanics::material::Material;
use crate::platform::fault_injection::{Fault, Term};
use crate::platform::simd::{Column, Corners};
use crate::scene::Film;

mod blocks;
mod frequency;
mod kites;

pub use blocks::ElementBlock;
pub use frequency::largest_frequency;

/// Why nodes and triangles are no film.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FilmError {
    /// An element's reference has no area, or is turned over.
    #[error(
        "element {element}: reference area {area} m²; allowed: above 0, corners counter-clockwise"
    )]
    Degenerate {
        /// Element.
        element: usize,
        /// Its signed area, m².
        area: f64,
    },
    /// A node belongs to no element and so has no mass.
    #[error("node {node} belongs to no element; allowed: nodes of the film only")]
    Loose {
        /// Node.
        node: usize,
    },
    /// An element names a node that is not there.
    #[error("element {element} names a node that is not there; there are {nodes} nodes")]
    Unknown {
        /// Element.
        element: usize,
        /// Nodes there are.
        nodes: usize,
    },
}

/// Film of triangles: constant data of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmModel {
    /// Material.
    pub material: Material,
    /// ρ, kg/m³.
    pub density: f64,
    /// t, m.
    pub thickness: f64,
    /// Nodes of each element, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The corners of elements two by two, in the order in which forces are added up.
    pub kites: Vec<[u32; 4]>,
    /// The same by corner, eight kites a block; the last is filled up with kites of no volume.
    pub blocks: Corners,
    /// What else is constant of those blocks: of first halves and of second.
    pub constants: Vec<[ElementBlock; 2]>,
    /// Faces that close the volume and are no film.
    pub closure: Vec<[u32; 3]>,
    /// Dm⁻¹ of each element, row by row, 1/m.
    pub inverse_shape: [Vec<f64>; 4],
    /// A t of each element, m³.
    pub volume: Vec<f64>,
    /// `ω_e` of each element, rad/s.
    pub frequency: Vec<f64>,
    /// The largest of them, which every step asks for.
    largest_frequency: f64,
    /// `2ζ/ω_e` of each element, s.
    pub viscous_time: Vec<f64>,
    /// m of each node, kg; 0 where only closing faces meet.
    pub mass: Vec<f64>,
    /// 1/m of each node, 1/kg; 0 where it has no mass, so that no force moves it.
    pub inverse_mass: Column,
}

impl FilmModel {
    /// Film of these triangles with their flat references (m), over `nodes` nodes.
    ///
    /// # Errors
    /// [`FilmError`].
    pub fn new(
        film: &Film,
        nodes: usize,
        triangles: &[[u32; 3]],
        reference: &[[Vector2<f64>; 3]],
    ) -> Result<Self, FilmError> {
        Self::closed_by(film, nodes, triangles, reference, &[])
    }

    /// The film of a shell, with its closing faces.
    ///
    /// # Errors
    /// [`FilmError`].
    pub fn of_shell(film: &Film, shell: &Shell) -> Result<Self, FilmError> {
        let nodes = shell.positions.len();
        Self::closed_by(film, nodes, &shell.triangles, &shell.reference, &shell.closure)
    }

    fn closed_by(
        film: &Film,
        nodes: usize,
        triangles: &[[u32; 3]],
        reference: &[[Vector2<f64>; 3]],
        closure: &[[u32; 3]],
    ) -> Result<Self, FilmError> {
        let material = Material::new(film);
        let mut model = Self {
            material,
            density: film.density,
            thickness: film.thickness,
            triangles: triangles.to_vec(),
            blocks: Corners::new(&[], nodes),
            kites: Vec::new(),
            constants: Vec::new(),
            closure: closure.to_vec(),
            inverse_shape: core::array::from_fn(|_| Vec::with_capacity(triangles.len())),
            volume: Vec::with_capacity(triangles.len()),
            frequency: Vec::with_capacity(triangles.len()),
            largest_frequency: 0.0,
            viscous_time: Vec::with_capacity(triangles.len()),
            mass: vec![0.0; nodes],
            inverse_mass: Column::default(),
        };
        for (element, (triangle, [a, b, c])) in triangles.iter().zip(reference).enumerate() {
            if triangle.iter().any(|node| *node as usize >= nodes) {
                return Err(FilmError::Unknown { element, nodes });
            }
            let (p, q) = (b - a, c - a);
            let determinant = p.perp(&q);
            // Written so that a reference that is no number is refused too.
            let sound = determinant > 0.0 && determinant.is_finite();
            if !sound {
                return Err(FilmError::Degenerate { element, area: 0.5 * determinant });
            }
            let inverse = [q.y, -q.x, -p.y, p.x].map(|entry| entry / determinant);
            for (column, entry) in model.inverse_shape.iter_mut().zip(inverse) {
                column.push(entry);
            }
            let volume = 0.5 * determinant * film.thickness;
            let frequency = largest_frequency(&material, film.density, inverse);
            model.volume.push(volume);
            model.frequency.push(frequency);
            model.largest_frequency = model.largest_frequency.max(frequency);
            model.viscous_time.push(2.0 * film.viscosity / frequency);
            for node in triangle {
                model.mass[*node as usize] += film.density * volume / 3.0;
            }
        }
        let closing: BTreeSet<u32> = closure.iter().flatten().copied().collect();
        let loose = (0_u32..)
            .zip(&model.mass)
            .find(|(node, mass)| **mass == 0.0 && !closing.contains(node));
        if let Some((node, _)) = loose {
            return Err(FilmError::Loose { node: node as usize });
        }
        let inverse = |mass: &f64| if *mass > 0.0 { 1.0 / mass } else { 0.0 };
        model.inverse_mass = model.mass.iter().map(inverse).collect();
        let kites = kites::kites(triangles);
        model.kites = kites.iter().map(|kite| kite.corners).collect();
        model.blocks = Corners::new(&model.kites, nodes);
        model.constants = ElementBlock::all(&model, &kites);
        Ok(model)
    }

    /// A fault of the constants: tests only. Step and viscous times stay those of the sound film.
    pub fn suffer(&mut self, fault: Fault) {
        self.material.suffer(fault);
        if fault.term == Term::PlaneModulus {
            for block in self.constants.iter_mut().flatten() {
                block.drag.0.iter_mut().for_each(|drag| *drag *= fault.factor);
            }
        }
        if fault.term == Term::Mass {
            self.mass.iter_mut().for_each(|mass| *mass *= fault.factor);
            self.inverse_mass.iter_mut().for_each(|inverse| *inverse /= fault.factor);
        }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.mass.len()
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.triangles.len()
    }

    /// `ω_max` bound: the largest `ω_e`, rad/s. No frequency of the assembled film at rest is above it
    /// (Rayleigh quotient: element stiffnesses and element masses add up alike).
    pub fn largest_frequency(&self) -> f64 {
        self.largest_frequency
    }

    /// Speed of a plane wave in the film, √(E/(ρ(1−ν²))), m/s.
    pub fn wave_speed(&self) -> f64 {
        (self.material.plane_modulus() / self.density).sqrt()
    }
}
