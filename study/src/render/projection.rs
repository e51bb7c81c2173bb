//! Orthographic projection of a surface: position on the page, drawing order, brightness.
//!
//! ```text
//! to the eye  e = (cos ε cos α, cos ε sin α, sin ε)        α azimuth, ε elevation
//! right       r = (−sin α, cos α, 0),   up  u = e × r
//! page        (x·r, x·u),   depth x·e,   brightness |n·l|
//! ```
//!
//! Lengths across the line of sight have the same scale everywhere. Elements are drawn in the order of
//! [`super::painter`]; both sides of the film are drawn.

use billow_solver::output::frames::Frame;
use nalgebra::Vector3;

use super::painter::{self, Triangle};

/// Direction to the light in the basis (right, up, to the eye): upper left, on the side of the eye.
const LIGHT: [f64; 3] = [-0.45, 0.55, 0.7];

/// A line of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    right: Vector3<f64>,
    up: Vector3<f64>,
    eye: Vector3<f64>,
}

/// An element on the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facet {
    /// Index of the element.
    pub element: usize,
    /// Corners, to the right and up, m.
    pub corners: [[f64; 2]; 3],
    /// Brightness, 0 to 1.
    pub light: f64,
    /// Whether the outside is visible.
    pub outside: bool,
}

impl View {
    /// The view from this azimuth (from the x axis towards y) and elevation (above the ground), rad.
    pub fn new(azimuth: f64, elevation: f64) -> Self {
        let (sin, cos) = libm::sincos(azimuth);
        let (rise, run) = libm::sincos(elevation);
        Self {
            right: Vector3::new(-sin, cos, 0.0),
            up: Vector3::new(-rise * cos, -rise * sin, run),
            eye: Vector3::new(run * cos, run * sin, rise),
        }
    }

    /// Position of a point on the page: to the right and up, m.
    pub fn project(&self, point: [f32; 3]) -> [f64; 2] {
        let point = Vector3::from(point.map(f64::from));
        [point.dot(&self.right), point.dot(&self.up)]
    }

    /// The elements of a shape in drawing order. Elements without an area are ignored.
    pub fn facets(&self, triangles: &[[u32; 3]], frame: &Frame) -> Vec<Facet> {
        let light = (LIGHT[0] * self.right + LIGHT[1] * self.up + LIGHT[2] * self.eye).normalize();
        let mut facets = Vec::with_capacity(triangles.len());
        let mut projected = Vec::with_capacity(triangles.len());
        for (element, triangle) in triangles.iter().enumerate() {
            let nodes = triangle.map(|node| frame.positions[node as usize]);
            let corners = nodes.map(|node| self.project(node));
            let positions = nodes.map(|node| Vector3::from(node.map(f64::from)));
            let [a, b, c] = positions;
            let normal = (b - a).cross(&(c - a));
            let area = normal.norm();
            if area > 0.0 {
                let light = (normal.dot(&light) / area).abs().min(1.0);
                let outside = normal.dot(&self.eye) >= 0.0;
                facets.push(Facet { element, corners, light, outside });
                let depths = positions.map(|position| position.dot(&self.eye));
                projected.push(Triangle { corners, depths });
            }
        }
        painter::order(&projected).into_iter().map(|index| facets[index]).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use billow_solver::mechanics::material::Regime;
    use proptest::prelude::*;

    use super::*;

    fn close(a: [f64; 2], b: [f64; 2]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6)
    }

    /// Triangles that share no nodes.
    fn separate(triangles: &[[[f32; 3]; 3]]) -> (Vec<[u32; 3]>, Frame) {
        let numbers = (0..).step_by(3).take(triangles.len());
        let frame = Frame {
            time: 0.0,
            positions: triangles.as_flattened().to_vec(),
            regimes: vec![Regime::Taut; triangles.len()],
            velocities: Vec::new(),
            stresses: Vec::new(),
            gaps: Vec::new(),
        };
        (numbers.map(|first| [first, first + 1, first + 2]).collect(), frame)
    }

    #[test]
    fn views_along_the_axes_give_the_other_coordinates() {
        let point = [1.0, 2.0, 3.0];
        let from_x = View::new(0.0, 0.0);
        assert!(close(from_x.project(point), [2.0, 3.0]), "y to the right, z up");
        let from_y = View::new(FRAC_PI_2, 0.0);
        assert!(close(from_y.project(point), [-1.0, 3.0]));
        let from_above = View::new(-FRAC_PI_2, FRAC_PI_2);
        assert!(close(from_above.project(point), [1.0, 2.0]), "seen from above");
    }

    #[test]
    fn the_nearer_element_is_drawn_later_with_its_visible_side() {
        let at = |x: f32| [[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 0.0, 1.0]];
        let mut turned = at(2.0);
        turned.swap(0, 1);
        let (triangles, frame) = separate(&[at(1.0), turned, at(-3.0), [[0.0; 3]; 3]]);
        let order = |view: View| -> Vec<(usize, bool)> {
            let facets = view.facets(&triangles, &frame);
            facets.iter().map(|facet| (facet.element, facet.outside)).collect()
        };
        assert_eq!(order(View::new(0.0, 0.3)), [(2, true), (0, true), (1, false)]);
        assert_eq!(order(View::new(PI, 0.3)), [(1, true), (0, false), (2, false)]);
    }

    proptest! {
        #[test]
        fn lengths_on_the_page_are_kept_and_both_sides_are_equally_bright(
            azimuth in -10.0..10.0_f64, elevation in -1.6..1.6_f64,
            corners in prop::array::uniform3(prop::array::uniform3(-1.0_f32..1.0)),
        ) {
            let view = View::new(azimuth, elevation);
            // The three directions are orthonormal.
            let frame = nalgebra::Matrix3::from_columns(&[view.right, view.up, view.eye]);
            let identity = nalgebra::Matrix3::identity();
            prop_assert!((frame.transpose() * frame - identity).norm() < 1e-12);
            prop_assert!((frame.determinant() - 1.0).abs() < 1e-12, "right-handed");
            let mut turned = corners;
            turned.swap(1, 2);
            let (triangles, shape) = separate(&[corners, turned]);
            let facets = view.facets(&triangles, &shape);
            prop_assert!(facets.len() == 2 || facets.is_empty());
            for facet in &facets {
                prop_assert!((0.0..=1.0).contains(&facet.light));
                prop_assert!((facet.light - facets[0].light).abs() < 1e-12);
                prop_assert!(close(facet.corners[0], view.project(corners[0])));
            }
        }
    }
}
