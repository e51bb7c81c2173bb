//! Orthographic projection of a surface: position on the page, drawing order, brightness.
//!
//! ```text
//! to the eye  e = (cos ε cos α, cos ε sin α, sin ε)        α azimuth, ε elevation
//! right       r = (−sin α, cos α, 0),   up  u = e × r
//! page        (x·r, x·u),   depth x·e,   brightness |n·l|
//! ```
//!
//! Smooth film has at each corner of an element the mean normal n of the elements there that are not behind a fold.
//!
//! Lengths across the line of sight have the same scale everywhere. Elements are drawn in the order of
//! [`super::painter`]; both sides of the film are drawn.

use billow_solver::output::frames::Frame;
use nalgebra::Vector3;

use super::painter::{self, Triangle};

/// Direction to the light in the basis (right, up, to the eye): upper left, on the side of the eye.
const LIGHT: [f64; 3] = [-0.45, 0.55, 0.7];

/// Smallest cosine of the angle between elements of smooth film; more is a fold. Chosen: 40°.
const MIN_COSINE: f64 = 0.766;

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
    /// Brightness at the corners, 0 to 1: equal ones unless the film is smooth.
    pub lights: [f64; 3],
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
    pub fn facets(&self, triangles: &[[u32; 3]], frame: &Frame, smooth: bool) -> Vec<Facet> {
        let light = (LIGHT[0] * self.right + LIGHT[1] * self.up + LIGHT[2] * self.eye).normalize();
        let mut facets = Vec::with_capacity(triangles.len());
        let mut projected = Vec::with_capacity(triangles.len());
        let position = |node: u32| Vector3::from(frame.positions[node as usize].map(f64::from));
        let normal = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(position);
            (b - a).cross(&(c - a))
        };
        let mut around: Vec<Vec<Vector3<f64>>> = vec![Vec::new(); frame.positions.len()];
        for triangle in triangles.iter().filter(|_| smooth) {
            for node in triangle {
                around[*node as usize].push(normal(triangle));
            }
        }
        for (element, triangle) in triangles.iter().enumerate() {
            let corners = triangle.map(|node| self.project(frame.positions[node as usize]));
            let positions = triangle.map(position);
            let normal = normal(triangle);
            if normal.norm() > 0.0 {
                let is_near = |other: &&Vector3<f64>| {
                    other.dot(&normal) > MIN_COSINE * other.norm() * normal.norm()
                };
                let lights = triangle.map(|node| {
                    let others = around[node as usize].iter().filter(is_near);
                    let mean = if smooth { others.sum() } else { normal };
                    (mean.dot(&light) / mean.norm()).abs().min(1.0)
                });
                let outside = normal.dot(&self.eye) >= 0.0;
                facets.push(Facet { element, corners, lights, outside });
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
            let facets = view.facets(&triangles, &frame, false);
            facets.iter().map(|facet| (facet.element, facet.outside)).collect()
        };
        assert_eq!(order(View::new(0.0, 0.3)), [(2, true), (0, true), (1, false)]);
        assert_eq!(order(View::new(PI, 0.3)), [(1, true), (0, false), (2, false)]);
    }

    #[test]
    fn smooth_film_has_one_brightness_at_a_common_node_unless_there_is_a_fold() {
        // Two elements at an edge along y; the second one rises with this slope.
        let at_edge = |slope: f32| {
            let nodes = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.5, 0.0], [1.0, 0.5, slope]];
            let (_, frame) = separate(&[[nodes[0], nodes[1], nodes[2]], [nodes[3]; 3]]);
            let facets = View::new(0.3, 0.2).facets(&[[0, 1, 2], [1, 0, 3]], &frame, true);
            let lights =
                |element| facets.iter().find(|facet| facet.element == element).unwrap().lights;
            (lights(0), lights(1))
        };
        let (flat, other) = at_edge(0.5);
        assert_eq!((flat[0], flat[1]), (other[1], other[0]));
        assert!((flat[2] - flat[0]).abs() > 0.01 && (other[2] - other[0]).abs() > 0.01);
        let (flat, other) = at_edge(2.0);
        assert_eq!((flat, other), ([flat[0]; 3], [other[0]; 3]));
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
            let facets = view.facets(&triangles, &shape, true);
            prop_assert!(facets.len() == 2 || facets.is_empty());
            for facet in &facets {
                for light in facet.lights {
                    prop_assert!((0.0..=1.0).contains(&light));
                    prop_assert!((light - facets[0].lights[0]).abs() < 1e-12);
                }
                prop_assert!(close(facet.corners[0], view.project(corners[0])));
            }
        }
    }
}
