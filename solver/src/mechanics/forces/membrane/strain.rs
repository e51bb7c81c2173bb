//! Deformation gradient, strain and elastic energy of single elements.
//!
//! ```text
//! F = [x1 − x0, x2 − x0] Dm⁻¹     E = (FᵀF − 1)/2     energy = Σ A t W(E)
//! ```

use nalgebra::Vector3;

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::material::PlaneTensor;

/// Columns of F of an element.
pub fn deformation_gradient(model: &FilmModel, field: &Field, element: usize) -> [Vector3<f64>; 2] {
    let [x0, x1, x2] = field.at(model.triangles[element]);
    let [a, b, c, d] = model.inverse_shape.each_ref().map(|column| column[element]);
    gradient([x1 - x0, x2 - x0], [[a, b], [c, d]])
}

/// Columns of F of an element with these edges (m) and this Dm⁻¹ (row by row, 1/m).
fn gradient([p, q]: [Vector3<f64>; 2], [[a, b], [c, d]]: [[f64; 2]; 2]) -> [Vector3<f64>; 2] {
    [p * a + q * c, p * b + q * d]
}

/// Green strain of an element with these edges (m) and this Dm⁻¹ (row by row, 1/m).
pub(super) fn of_edges(edges: [Vector3<f64>; 2], inverse_shape: [[f64; 2]; 2]) -> PlaneTensor {
    green_strain(gradient(edges, inverse_shape))
}

/// Green strain of an element with these corners (m) and this Dm⁻¹ (row by row, 1/m).
pub fn strain_of([x0, x1, x2]: [Vector3<f64>; 3], [a, b, c, d]: [f64; 4]) -> PlaneTensor {
    of_edges([x1 - x0, x2 - x0], [[a, b], [c, d]])
}

/// Edges p and q of the two elements of a kite.
pub(super) fn edges_of_kite(field: &Field, kite: &[u32; 4]) -> [[Vector3<f64>; 2]; 2] {
    let [s, a, t, b] = field.at(*kite);
    [[a - s, t - s], [t - s, b - s]]
}

/// E = (`FᵀF` − 1)/2 of the columns of F.
fn green_strain([f, g]: [Vector3<f64>; 2]) -> PlaneTensor {
    PlaneTensor { xx: (f.dot(&f) - 1.0) * 0.5, yy: (g.dot(&g) - 1.0) * 0.5, xy: f.dot(&g) * 0.5 }
}

/// Green strain of an element at these positions (m).
pub fn strain(model: &FilmModel, positions: &Field, element: usize) -> PlaneTensor {
    green_strain(deformation_gradient(model, positions, element))
}

/// Elastic energy Σ A t W of film without creep at these positions (m), J.
pub fn strain_energy(model: &FilmModel, positions: &Field) -> f64 {
    (0..model.elements())
        .map(|element| {
            let strain = strain(model, positions, element);
            model.volume[element] * model.material.energy_density(strain)
        })
        .sum()
}
