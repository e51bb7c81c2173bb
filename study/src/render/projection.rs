//! A surface looked at from afar: where it lies on the page, in which order it is drawn, how bright it is.
//!
//! ```text
//! to the eye  e = (cos ε cos α, cos ε sin α, sin ε)        α azimuth, ε elevation
//! right       r = (−sin α, cos α, 0),   up  u = e × r
//! on the page (x·r, x·u),   depth x·e,   brightness |n·l|
//! ```
//!
//! Orthographic: lengths across the line of sight are the same everywhere. Elements are drawn in the
//! order of [`super::painter`], whichever side they show: film has no back.

use billow_solver::output::frames::Frame;
use nalgebra::Vector3;

use super::painter::{self, Patch};

/// Where the light comes from, in right, up and to the eye: from the upper left, over the shoulder.
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
    /// Number of the element.
    pub element: usize,
    /// Its corners, to the right and up, m.
    pub corners: [[f64; 2]; 3],
    /// Brightness, 0 to 1.
    pub light: f64,
    /// Whether its outside is seen.
    pub outside: bool,
}

impl View {
    /// Looking from this azimuth (from the x axis towards y) and elevation (above the ground), rad.
    pub fn new(azimuth: f64, elevation: f64) -> Self {
        let (sin, cos) = libm::sincos(azimuth);
        let (rise, run) = libm::sincos(elevation);
        Self {
            right: Vector3::new(-sin, cos, 0.0),
            up: Vector3::new(-rise * cos, -rise * sin, run),
            eye: Vector3::new(run * cos, run * sin, rise),
        }
    }

    /// Where a place lies on the page: to the right and up, m.
    pub fn project(&self, place: [f32; 3]) -> [f64; 2] {
        let place = Vector3::from(place.map(f64::from));
        [place.dot(&self.right), place.dot(&self.up)]
    }

    /// The elements of a shape in the order they are drawn. Elements without an area are left out.
    pub fn facets(&self, triangles: &[[u32; 3]], frame: &Frame) -> Vec<Facet> {
        let light = (LIGHT[0] * self.right + LIGHT[1] * self.up + LIGHT[2] * self.eye).normalize();
        let mut facets = Vec::with_capacity(triangles.len());
        let mut patches = Vec::with_capacity(triangles.len());
        for (element, triangle) in triangles.iter().enumerate() {
            let places = triangle.map(|node| frame.positions[node as usize]);
            let corners = places.map(|place| self.project(place));
            let places = places.map(|place| Vector3::from(place.map(f64::from)));
            let [a, b, c] = places;
            let normal = (b - a).cross(&(c - a));
            let area = normal.norm();
            if area > 0.0 {
                let light = (normal.dot(&light) / area).abs().min(1.0);
                let outside = normal.dot(&self.eye) >= 0.0;
                facets.push(Facet { element, corners, light, outside });
                patches.push(Patch { corners, depths: places.map(|place| place.dot(&self.eye)) });
            }
        }
        painter::order(&patches).into_iter().map(|at| facets[at]).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use billow_solver::mechanics::material::Regime;
    use proptest::prelude::*;

    use super::*;

    fn close(one: [f64; 2], other: [f64; 2]) -> bool {
        one.iter().zip(other).all(|(one, other)| (one - other).abs() < 1e-6)
    }

    /// Triangles of their own nodes.
    fn loose(triangles: &[[[f32; 3]; 3]]) -> (Vec<[u32; 3]>, Frame) {
        let numbers = (0..).step_by(3).take(triangles.len());
        let frame = Frame {
            time: 0.0,
            positions: triangles.as_flattened().to_vec(),
            regimes: vec![Regime::Taut; triangles.len()],
        };
        (numbers.map(|first| [first, first + 1, first + 2]).collect(), frame)
    }

    #[test]
    fn what_is_seen_from_where() {
        let place = [1.0, 2.0, 3.0];
        let from_x = View::new(0.0, 0.0);
        assert!(close(from_x.project(place), [2.0, 3.0]), "y to the right, z up");
        let from_y = View::new(FRAC_PI_2, 0.0);
        assert!(close(from_y.project(place), [-1.0, 3.0]));
        let from_above = View::new(-FRAC_PI_2, FRAC_PI_2);
        assert!(close(from_above.project(place), [1.0, 2.0]), "a map");
    }

    #[test]
    fn the_nearer_element_is_drawn_later_and_its_side_is_told() {
        let at = |x: f32| [[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 0.0, 1.0]];
        let mut turned = at(2.0);
        turned.swap(0, 1);
        let (triangles, frame) = loose(&[at(1.0), turned, at(-3.0), [[0.0; 3]; 3]]);
        let order = |view: View| -> Vec<(usize, bool)> {
            let facets = view.facets(&triangles, &frame);
            facets.iter().map(|facet| (facet.element, facet.outside)).collect()
        };
        assert_eq!(order(View::new(0.0, 0.3)), [(2, true), (0, true), (1, false)]);
        assert_eq!(order(View::new(PI, 0.3)), [(1, true), (0, false), (2, false)]);
    }

    proptest! {
        #[test]
        fn lengths_across_the_sight_are_kept_and_brightness_has_no_side(
            azimuth in -10.0..10.0_f64, elevation in -1.6..1.6_f64,
            corners in prop::array::uniform3(prop::array::uniform3(-1.0_f32..1.0)),
        ) {
            let view = View::new(azimuth, elevation);
            // The three directions stand at right angles and are as long as one.
            let frame = nalgebra::Matrix3::from_columns(&[view.right, view.up, view.eye]);
            let identity = nalgebra::Matrix3::identity();
            prop_assert!((frame.transpose() * frame - identity).norm() < 1e-12);
            prop_assert!((frame.determinant() - 1.0).abs() < 1e-12, "not seen in a mirror");
            let mut turned = corners;
            turned.swap(1, 2);
            let (triangles, shape) = loose(&[corners, turned]);
            let facets = view.facets(&triangles, &shape);
            prop_assert!(facets.len() == 2 || facets.is_empty());
            for facet in &facets {
                prop_assert!((0.0..=1.0).contains(&facet.light));
                prop_assert!((facet.light - facets[0].light).abs() < 1e-12);
                prop_assert!(close(facet.corners[0], view.project(corners[0])));
            }
        }

        #[test]
        fn shapes_apart_in_depth_are_drawn_far_to_near(
            depths in prop::collection::vec(-5.0_f32..5.0, 1..40), azimuth in -4.0..4.0_f64,
        ) {
            let view = View::new(azimuth, 0.4);
            let place = |depth: f32, right: f64, up: f64| {
                let place = f64::from(depth) * view.eye + right * view.right + up * view.up;
                #[expect(clippy::cast_possible_truncation, reason = "as frames have it")]
                [place.x as f32, place.y as f32, place.z as f32]
            };
            let triangle = |depth: &f32| {
                [place(*depth, 0.0, 0.0), place(*depth, 1.0, 0.0), place(*depth, 0.0, 1.0)]
            };
            let (triangles, frame) = loose(&depths.iter().map(triangle).collect::<Vec<_>>());
            let facets = view.facets(&triangles, &frame);
            prop_assert_eq!(facets.len(), depths.len());
            let drawn: Vec<f32> = facets.iter().map(|facet| depths[facet.element]).collect();
            prop_assert!(drawn.windows(2).all(|pair| pair[0] <= pair[1] + 1e-5));
        }
    }
}
