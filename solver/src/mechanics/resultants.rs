//! Membrane forces (stress resultants) of an element: force per width of film, N/m.
//!
//! ```text
//! N = t S                      per reference width, principal values N1 ≥ N2
//! P = t F S                    force per reference width: P1² + P2² = t² tr(S C S),
//!                              P1 P2 = J N1 N2
//! T = t F S Fᵀ/J               force per current width: T1 + T2 = t S:C/J,  T1 T2 = N1 N2
//! C = FᵀF = 1 + 2E,  J² = det C
//! ```
//!
//! Symbols: S second Piola-Kirchhoff stress (Pa) of film whose creep is over, E Green strain, t thickness (m)
//! of the stress-free film, J current area over reference area. T is the Cauchy stress times the current
//! thickness; the product needs no assumption on how the thickness changes.

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::mechanics::forces::membrane::strain;
use crate::mechanics::material::Regime;

/// Membrane forces of one element, N/m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resultants {
    /// Taut, wrinkled or slack.
    pub regime: Regime,
    /// Principal second Piola-Kirchhoff membrane forces, per reference width, the larger first.
    pub principal: [f64; 2],
    /// Principal nominal (first Piola-Kirchhoff) membrane forces, per reference width: singular values,
    /// the larger first.
    pub nominal: [f64; 2],
    /// Principal true (Cauchy) membrane forces, per current width, the larger first; zero where the
    /// current area is zero.
    pub cauchy: [f64; 2],
}

/// Membrane forces of an element at these positions (m).
pub fn resultants(model: &FilmModel, positions: &Field, element: usize) -> Resultants {
    let strain = strain(model, positions, element);
    let stress = model.material.stress(strain).tensor;
    let thickness = thickness(model, element);
    let (first, second) = stress.principal();
    let principal = [first * thickness, second * thickness];
    let [xx, yy, xy] = [1.0 + 2.0 * strain.xx, 1.0 + 2.0 * strain.yy, 2.0 * strain.xy];
    let area = (xx * yy - xy * xy).max(0.0).sqrt();
    // tr(S C S) = Σ of row C rowᵀ over the rows of S.
    let [p, q] = [[stress.xx, stress.xy], [stress.xy, stress.yy]];
    let squared = |[a, b]: [f64; 2]| a * a * xx + 2.0 * a * b * xy + b * b * yy;
    let half = 0.5 * thickness * thickness * (squared(p) + squared(q));
    let product = area * principal[0] * principal[1];
    let root = (half * half - product * product).max(0.0).sqrt();
    let nominal = [(half + root).sqrt(), (half - root).max(0.0).sqrt()];
    let cauchy = if area > 0.0 {
        let contracted = stress.xx * xx + stress.yy * yy + 2.0 * stress.xy * xy;
        let mean = 0.5 * thickness * contracted / area;
        let radius = (mean * mean - principal[0] * principal[1]).max(0.0).sqrt();
        [mean + radius, mean - radius]
    } else {
        [0.0; 2]
    };
    Resultants { regime: model.material.regime(strain), principal, nominal, cauchy }
}

/// Largest principal second Piola-Kirchhoff stress of the film at these positions (m), Pa; 0 of slack film.
pub fn largest_stress(model: &FilmModel, positions: &Field) -> f64 {
    let of = |element: usize| {
        resultants(model, positions, element).principal[0] / thickness(model, element)
    };
    (0..model.elements()).map(of).fold(0.0, f64::max)
}

/// Smallest and largest principal stretch of the film at these positions (m), with their elements.
pub fn stretches(model: &FilmModel, positions: &Field) -> [(f64, usize); 2] {
    let mut found = [(f64::INFINITY, 0), (0.0, 0)];
    for element in 0..model.elements() {
        let (first, second) = strain(model, positions, element).principal();
        let stretch = |strain: f64| (1.0 + 2.0 * strain).max(0.0).sqrt();
        if stretch(second) < found[0].0 {
            found[0] = (stretch(second), element);
        }
        if stretch(first) > found[1].0 {
            found[1] = (stretch(first), element);
        }
    }
    found
}

/// Thickness of an element in its stress-free reference, m.
pub fn thickness(model: &FilmModel, element: usize) -> f64 {
    let [a, b, c, d] = model.inverse_shape.each_ref().map(|column| column[element]);
    // A = 1/(2 det Dm⁻¹), and the model stores A t.
    2.0 * (a * d - b * c) * model.volume[element]
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix2, Matrix3x2, Rotation3, Vector2, Vector3};

    use super::*;
    use crate::scene::Film;

    const FILM: Film = Film { numerical_damping: 0.0, ..Film::PAPER };

    /// An element with this in-plane deformation gradient, rotated in space.
    fn element(gradient: Matrix2<f64>) -> (FilmModel, Field) {
        let flat = [Vector2::new(0.1, 0.2), Vector2::new(0.4, 0.25), Vector2::new(0.15, 0.5)];
        let model = FilmModel::new(&FILM, 3, &[[0, 1, 2]], &[flat]).expect("an element");
        let rotation = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
        let position = |x: Vector2<f64>| {
            let y = gradient * x;
            rotation * Vector3::new(y.x, y.y, 0.7)
        };
        (model, Field::of(&flat.map(position)))
    }

    #[test]
    fn resultants_of_taut_film_follow_from_the_tensors() {
        let gradient = Matrix2::new(1.02, 0.004, -0.003, 1.01);
        let (model, positions) = element(gradient);
        let found = resultants(&model, &positions, 0);
        assert_eq!(found.regime, Regime::Taut);
        assert!((thickness(&model, 0) / FILM.thickness - 1.0).abs() < 1e-14);
        // The same from the full tensors.
        let green = (gradient.transpose() * gradient - Matrix2::identity()) * 0.5;
        let k = FILM.youngs_modulus / (1.0 - 0.09) * FILM.thickness;
        let n = (green * 0.7 + Matrix2::identity() * (0.3 * green.trace())) * k;
        let wide = Matrix3x2::new(gradient.m11, gradient.m12, gradient.m21, gradient.m22, 0.0, 0.0);
        let t = wide * n * wide.transpose() / gradient.determinant();
        let nominal = (gradient * n).singular_values();
        assert!((found.nominal[0] - nominal.max()).abs() < 1e-9 * nominal.max());
        assert!((found.nominal[1] - nominal.min()).abs() < 1e-9 * nominal.max());
        let (n, t) = (n.symmetric_eigenvalues(), t.symmetric_eigenvalues());
        assert!((found.principal[0] - n.max()).abs() < 1e-9 * n.max());
        assert!((found.principal[1] - n.min()).abs() < 1e-9 * n.max());
        assert!((found.cauchy[0] - t.max()).abs() < 1e-9 * t.max());
        let middle = t.sum() - t.max() - t.min();
        assert!((found.cauchy[1] - middle).abs() < 1e-9 * t.max());
    }

    #[test]
    fn wrinkled_film_carries_one_principal_force_and_slack_film_none() {
        let (model, positions) = element(Matrix2::new(1.001, 0.0, 0.0, 0.9));
        let found = resultants(&model, &positions, 0);
        let expected = FILM.youngs_modulus * FILM.thickness * 0.5 * (1.001 * 1.001 - 1.0);
        assert_eq!(found.regime, Regime::Wrinkled);
        assert!((found.principal[0] / expected - 1.0).abs() < 1e-9);
        assert!(found.principal[1].abs() < 1e-9 * expected);
        assert!((found.cauchy[0] / (expected * 1.001 / 0.9) - 1.0).abs() < 1e-9);
        assert!(found.cauchy[1].abs() < 1e-9 * expected);
        let (model, positions) = element(Matrix2::new(0.9, 0.0, 0.0, 0.8));
        let found = resultants(&model, &positions, 0);
        assert_eq!(
            (found.regime, found.principal, found.cauchy),
            (Regime::Slack, [0.0; 2], [0.0; 2])
        );
    }
}
