//! Constants of the film during a run: elements, lumped masses, frequencies.
//!
//! ```text
//! Dm = [X1 − X0, X2 − X0]      A = det Dm/2      F = [x1 − x0, x2 − x0] Dm⁻¹
//! m_i = Σ_e ρ t A_e/3          ω_e: largest in-plane frequency of the element with lumped mass
//! ```
//!
//! Symbols: X flat reference positions and x current positions of an element's corners, m; F
//! deformation gradient (3×2); A reference area, m²; m lumped mass, kg.

use std::collections::BTreeSet;

use nalgebra::Vector2;

use crate::geometry::shell::Shell;
use crate::mechanics::closure::{ClosureError, ClosureNodes};
use crate::mechanics::material::Material;
use crate::mechanics::material_loss::Creep;
use crate::platform::fault_injection::{Fault, Term};
use crate::platform::simd::{Column, Corners};
use crate::scene::Film;

mod blocks;
mod frequency;
mod kites;

pub use blocks::ElementBlock;
pub use frequency::largest_frequency;

/// Why nodes and triangles do not form a film.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FilmError {
    /// The reference area of an element is zero, negative or not finite.
    #[error(
        "element {element}: reference area {area} m²; allowed: above 0, corners counter-clockwise"
    )]
    DegenerateElement {
        /// Element.
        element: usize,
        /// Its signed area, m².
        area: f64,
    },
    /// A node belongs to no element and so has no mass.
    #[error("node {node} belongs to no element; allowed: nodes of the film only")]
    LooseNode {
        /// Node.
        node: usize,
    },
    /// An element names a node that does not exist.
    #[error("element {element} names a node that does not exist; allowed: below {nodes}")]
    UnknownNode {
        /// Element.
        element: usize,
        /// Number of nodes.
        nodes: usize,
    },
    /// The rim of closing faces does not place one of their vertices.
    #[error(transparent)]
    Closure(#[from] ClosureError),
}

/// The film as constant-strain triangles: constant data of a run.
///
/// ```text
/// energy      Π = Σ_e A_e t W(E_e)                        E = (FᵀF − 1)/2
/// W_full      = E/(2(1−ν²)) (e1² + e2² + 2ν e1 e2)        e1 ≥ e2 principal values of E
/// W           = W_relaxed + c (W_full − W_relaxed)        W_relaxed: see [`Material`]
/// stress      S = ∂W/∂E        [f1, f2] = −A t F (S + D) Dm⁻ᵀ,  f0 = −(f1 + f2)
/// ```
///
/// Sizes: `N_e` elements, `N_n` nodes, `N_k` kites (pairs of elements that share an edge), `N_b` blocks
/// of eight kites.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmModel {
    /// Material.
    pub material: Material,
    /// Creep of the material: its loss.
    pub creep: Creep,
    /// ρ, kg/m³.
    pub density: f64,
    /// t, m.
    pub thickness: f64,
    /// Nodes of each element, counter-clockwise seen from outside; `N_e` × 3.
    pub triangles: Vec<[u32; 3]>,
    /// Nodes s, a, t, b of each kite, in the order in which forces are summed; `N_k` × 4.
    pub kites: Vec<[u32; 4]>,
    /// The same nodes by corner and lane; `N_b` blocks. Free lanes of the last block have zero volume.
    pub corners: Corners,
    /// Constants of the first and of the second element of each kite; `N_b` × 2 × 8.
    pub constants: Vec<[ElementBlock; 2]>,
    /// Nodes of the faces that close the volume and are not film; number of closing faces × 3.
    pub closure: Vec<[u32; 3]>,
    /// Vertices of those faces that belong to no film.
    pub closure_nodes: ClosureNodes,
    /// Dm⁻¹ of each element, row by row, 1/m; 4 × `N_e`.
    pub inverse_shape: [Vec<f64>; 4],
    /// A t of each element, m³; `N_e`. Times the factor of its modulus after [`Self::with_stiffness`].
    pub volume: Vec<f64>,
    /// `ω_e` of each element, rad/s; `N_e`.
    pub frequency: Vec<f64>,
    /// Largest entry of `frequency`, rad/s; kept because every step reads it.
    largest_frequency: f64,
    /// Square root of the reference area of the film, m.
    size: f64,
    /// `2ζ/ω_e` of each element, s; `N_e`.
    pub damping_time: Vec<f64>,
    /// m of each node, kg; `N_n`. Zero for a node of closing faces only.
    pub mass: Vec<f64>,
    /// 1/m of each node, 1/kg; `N_n`. Zero for a node without mass, so that no force moves it.
    pub inverse_mass: Column,
}

impl FilmModel {
    /// Film of these triangles with their flat reference positions (m), over `nodes` nodes.
    pub fn new(
        film: &Film,
        nodes: usize,
        triangles: &[[u32; 3]],
        reference: &[[Vector2<f64>; 3]],
    ) -> Result<Self, FilmError> {
        Self::build(film, nodes, triangles, reference, &[])
    }

    /// The film of a shell, with its closing faces. `held`: whether supports hold a node in all three
    /// directions.
    pub fn supported(
        film: &Film,
        shell: &Shell,
        held: impl Fn(u32) -> bool,
    ) -> Result<Self, FilmError> {
        let closure_nodes = ClosureNodes::new(shell, held)?;
        Ok(Self { closure_nodes, ..Self::of_shell(film, shell)? })
    }

    /// The film of a shell, with its closing faces. Their vertices without film are fixed in space.
    pub fn of_shell(film: &Film, shell: &Shell) -> Result<Self, FilmError> {
        let nodes = shell.positions.len();
        Self::build(film, nodes, &shell.triangles, &shell.reference, &shell.closure)
    }

    fn build(
        film: &Film,
        nodes: usize,
        triangles: &[[u32; 3]],
        reference: &[[Vector2<f64>; 3]],
        closure: &[[u32; 3]],
    ) -> Result<Self, FilmError> {
        let material = Material::new(film);
        let creep = Creep::new(film, &material);
        let mut model = Self {
            material,
            creep,
            density: film.density,
            thickness: film.thickness,
            triangles: triangles.to_vec(),
            kites: Vec::new(),
            corners: Corners::new(&[], nodes),
            constants: Vec::new(),
            closure: closure.to_vec(),
            closure_nodes: ClosureNodes::default(),
            inverse_shape: core::array::from_fn(|_| Vec::with_capacity(triangles.len())),
            volume: Vec::with_capacity(triangles.len()),
            frequency: Vec::with_capacity(triangles.len()),
            largest_frequency: 0.0,
            size: 0.0,
            damping_time: Vec::with_capacity(triangles.len()),
            mass: vec![0.0; nodes],
            inverse_mass: Column::default(),
        };
        for (element, (triangle, [a, b, c])) in triangles.iter().zip(reference).enumerate() {
            if triangle.iter().any(|node| *node as usize >= nodes) {
                return Err(FilmError::UnknownNode { element, nodes });
            }
            let (p, q) = (b - a, c - a);
            let determinant = p.perp(&q);
            // Written so that NaN is refused too.
            let positive = determinant > 0.0 && determinant.is_finite();
            if !positive {
                return Err(FilmError::DegenerateElement { element, area: 0.5 * determinant });
            }
            let inverse = [q.y, -q.x, -p.y, p.x].map(|entry| entry / determinant);
            for (column, entry) in model.inverse_shape.iter_mut().zip(inverse) {
                column.push(entry);
            }
            let volume = 0.5 * determinant * film.thickness;
            let frequency =
                largest_frequency(&material, film.density, inverse) * creep.frequency_factor();
            model.volume.push(volume);
            model.frequency.push(frequency);
            model.largest_frequency = model.largest_frequency.max(frequency);
            model.damping_time.push(2.0 * film.numerical_damping / frequency);
            for node in triangle {
                model.mass[*node as usize] += film.density * volume / 3.0;
            }
        }
        model.size = (model.volume.iter().sum::<f64>() / film.thickness).sqrt();
        let closure_nodes: BTreeSet<u32> = closure.iter().flatten().copied().collect();
        let loose = (0_u32..)
            .zip(&model.mass)
            .find(|(node, mass)| **mass == 0.0 && !closure_nodes.contains(node));
        if let Some((node, _)) = loose {
            return Err(FilmError::LooseNode { node: node as usize });
        }
        let inverse = |mass: &f64| if *mass > 0.0 { 1.0 / mass } else { 0.0 };
        model.inverse_mass = model.mass.iter().map(inverse).collect();
        let kites = kites::pair_elements(triangles);
        model.kites = kites.iter().map(|kite| kite.corners).collect();
        model.corners = Corners::new(&model.kites, nodes);
        model.constants = ElementBlock::all(&model, &kites);
        Ok(model)
    }

    /// The same film with the modulus of each element times its factor: several materials in one film. Masses stay.
    ///
    /// ```text
    /// A t → k A t in forces and energies        ω_e → √k ω_e,  2ζ/ω_e → 2ζ/(√k ω_e)
    /// ```
    ///
    /// Tensions are those of the factor; stresses, which are tensions over the thickness, are not: a recorded stress
    /// is that of the factor 1.
    ///
    /// # Panics
    /// If the number of factors is not that of the elements.
    #[must_use]
    pub fn with_stiffness(mut self, factors: &[f64]) -> Self {
        assert_eq!(factors.len(), self.elements(), "one factor an element");
        for (element, factor) in factors.iter().enumerate() {
            self.volume[element] *= factor;
            self.frequency[element] *= factor.sqrt();
            self.damping_time[element] /= factor.sqrt();
        }
        self.largest_frequency = self.frequency.iter().copied().fold(0.0, f64::max);
        self.constants = ElementBlock::all(&self, &kites::pair_elements(&self.triangles));
        self
    }

    /// Injects a fault into the constants, for tests only. Frequencies and damping times stay correct.
    pub fn inject_fault(&mut self, fault: Fault) {
        self.material.inject_fault(fault);
        if fault.term == Term::Creep {
            self.creep.time /= fault.factor;
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

    /// Nodes of the elements, then those of the closing faces.
    pub fn faces(&self) -> Vec<[u32; 3]> {
        self.triangles.iter().chain(&self.closure).copied().collect()
    }

    /// The largest `ω_e`, rad/s: an upper bound of all frequencies of the assembled film at rest
    /// (Rayleigh quotient: stiffness and mass of the film are sums over the elements).
    pub fn largest_frequency(&self) -> f64 {
        self.largest_frequency
    }

    /// Square root of the reference area of the film, m: the size of its motions.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Speed of a plane wave in the film, √(E/(ρ(1−ν²))), m/s.
    pub fn wave_speed(&self) -> f64 {
        (self.material.plane_modulus() / self.density).sqrt()
    }
}
