//! The compliance Ĉ of the hinges.
//!
//! ```text
//! K_ij = 4 A D/(h_i h_j) ((1−ν)(n_i·n_j)² + ν)      C = K⁻¹      Ĉ = Σ_T C
//! ```
//!
//! A crease of length l and stiffness k for each metre adds 1/(k l) to its diagonal. The moment of an edge that is no
//! hinge is zero: its row is left out. A rigid element has no compliance. Without creases the hinges of different
//! facets are not coupled.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};

use super::hinges::Hinges;
use crate::factorisation::constant::Rows;
use crate::geometry::shell::Shell;
use crate::mechanics::film_model::FilmModel;

/// Ĉ by rows, 1/(N m), and an upper bound of Π over ½ (u − ū)² at each hinge, N m; `crease_stiffness`: N m/rad for each
/// metre.
pub(super) fn assembled(
    model: &FilmModel,
    hinges: &Hinges,
    rigid: &[bool],
    crease_stiffness: f64,
) -> (Rows, Vec<f64>) {
    let mut of_element: Vec<Vec<(usize, u32)>> = vec![Vec::new(); model.elements()];
    for (hinge, sides) in (0_u32..).zip(&hinges.sides) {
        for (element, corner) in sides {
            of_element[*element].push((*corner, hinge));
        }
    }
    let mut matrix: Rows = vec![BTreeMap::new(); hinges.len()];
    let mut bounds = vec![0.0; hinges.len()];
    // A crease turns by itself too, and the film beside it no more than all of its turn.
    for hinge in hinges.first_crease..hinges.len() {
        let row = u32::try_from(hinge).expect("under 2^32");
        matrix[hinge].insert(row, 1.0 / (crease_stiffness * hinges.lengths[hinge]));
        bounds[hinge] = crease_stiffness * hinges.lengths[hinge];
    }
    for (element, edges) in of_element.iter().enumerate().filter(|(element, _)| !rigid[*element]) {
        let stiffness = element_stiffness(model, element);
        let compliance = stiffness.try_inverse().expect("an element with an area");
        for (corner, hinge) in edges {
            // Both elements may take half of the turn; beside a rigid one, the other takes all of it.
            let alone = hinges.sides[*hinge as usize].iter().any(|(element, _)| rigid[*element]);
            let share = if alone { 1.0 } else { 0.5 };
            if (*hinge as usize) < hinges.first_crease {
                bounds[*hinge as usize] += share * share * stiffness.row(*corner).abs().sum();
            }
            for (other, column) in edges {
                let entry = matrix[*hinge as usize].entry(*column).or_insert(0.0);
                *entry += compliance[(*corner, *other)];
            }
        }
    }
    (matrix, bounds)
}

/// K of an element, N m.
fn element_stiffness(model: &FilmModel, element: usize) -> Matrix3<f64> {
    let [a, b, c, d] = model.inverse_shape.each_ref().map(|column| column[element]);
    // Gradients of the barycentric coordinates; that of a corner is −n/h of the edge opposite to it.
    let gradients = [[-(a + c), -(b + d)], [a, b], [c, d]];
    let material = &model.material;
    let poisson = material.poisson_ratio;
    let t = model.thickness;
    // A D: the volume carries the factor of the modulus of the element.
    let rigidity = model.volume[element] * material.plane_modulus() * t * t / 12.0;
    Matrix3::from_fn(|i, j| {
        let [p, q] = [gradients[i], gradients[j]];
        let dot = p[0] * q[0] + p[1] * q[1];
        let sizes = ((p[0] * p[0] + p[1] * p[1]) * (q[0] * q[0] + q[1] * q[1])).sqrt();
        4.0 * rigidity * ((1.0 - poisson) * dot * dot / sizes + poisson * sizes)
    })
}

/// The middle of each hinge's edge in the reference, m, for the dissection.
pub(super) fn middles(hinges: &Hinges, shell: &Shell) -> Vec<Vector3<f64>> {
    let middle = |[(element, corner), _]: &[(usize, usize); 2]| {
        let at = |step: usize| shell.reference[*element][(corner + step) % 3];
        (0.5 * (at(1) + at(2))).push(0.0)
    };
    hinges.sides.iter().map(middle).collect()
}
