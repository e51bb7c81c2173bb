//! Faces of a file to triangles: a fan where it covers the face, ears otherwise.
//!
//! A fan covers a face if all its triangles are wound as the face is. A convex face has the fan from its first corner;
//! another one a fan from a corner that does not turn inward, or else from one that does, and of several that with the
//! shortest diagonals: it does not matter which corner is the first. Where no fan covers it, the face is cut in the
//! plane of its mean normal ([`earcut`]).

use earcut::utils3d::project3d_to_2d;
use earcut::{Earcut, refine};
use nalgebra::Vector3;

/// Least area of a triangle over that of its face. Chosen: above rounding.
const MIN_AREA: f64 = 1e-9;

/// The triangles of a face with these corners, as indices of them; `None` if it has no area or crosses itself.
pub(super) fn triangles(corners: &[Vector3<f64>]) -> Option<Vec<[usize; 3]>> {
    let count = corners.len();
    let area = |[a, b, c]: [usize; 3]| (corners[b] - corners[a]).cross(&(corners[c] - corners[a]));
    let fan = |from: usize| -> Vec<[usize; 3]> {
        let corner = |k: usize| (from + k) % count;
        (1..count - 1).map(|k| [from, corner(k), corner(k + 1)]).collect()
    };
    if count == 3 {
        return Some(fan(0));
    }
    let whole: Vector3<f64> = fan(0).into_iter().map(area).sum();
    let least = MIN_AREA * whole.norm_squared();
    let covers = |triangles: &Vec<[usize; 3]>| {
        triangles.len() == count - 2 && triangles.iter().all(|of| area(*of).dot(&whole) > least)
    };
    let turns_inward =
        |k: &usize| area([(k + count - 1) % count, *k, (k + 1) % count]).dot(&whole) < 0.0;
    if !(0..count).any(|k| turns_inward(&k)) && covers(&fan(0)) {
        return Some(fan(0));
    }
    let diagonals =
        |from: &usize| -> f64 { (0..count).map(|k| (corners[k] - corners[*from]).norm()).sum() };
    let fans = (0..count).filter(|from| covers(&fan(*from)));
    let order = |from: &usize| (turns_inward(from), diagonals(from));
    let before = |a: &usize, b: &usize| {
        let (a, b) = (order(a), order(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    };
    if let Some(best) = fans.min_by(before) {
        return Some(fan(best));
    }
    let points: Vec<[f64; 3]> = corners.iter().map(|corner| (corner - corners[0]).into()).collect();
    let mut plane = Vec::new();
    if !project3d_to_2d(&points, count, &mut plane) {
        return None;
    }
    let mut ears: Vec<u32> = Vec::new();
    Earcut::new().earcut(plane.iter().copied(), &[], &mut ears);
    refine(&mut ears, &plane);
    // Corners in the order of the face: a triangle of it is wound as the face is.
    let ordered = |ear: &[u32]| {
        let mut ear = [ear[0] as usize, ear[1] as usize, ear[2] as usize];
        ear.sort_unstable();
        ear
    };
    Some(ears.chunks_exact(3).map(ordered).collect()).filter(covers)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn area(corners: &[Vector3<f64>], [a, b, c]: [usize; 3]) -> Vector3<f64> {
        (corners[b] - corners[a]).cross(&(corners[c] - corners[a])) * 0.5
    }

    #[test]
    fn a_convex_face_keeps_its_fan() {
        let square =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [1.0, 1.0, 0.0], [0.0, 1.0, 0.1]].map(Vector3::from);
        assert_eq!(triangles(&square).unwrap(), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn a_face_that_crosses_itself_has_no_triangles() {
        let bow =
            [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.1, 0.0]].map(Vector3::from);
        assert_eq!(triangles(&bow), None);
        let line =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]].map(Vector3::from);
        assert_eq!(triangles(&line), None);
    }

    proptest! {
        /// A star in any plane from any first corner: its triangles have its area, and none is turned.
        #[test]
        fn triangles_cover_a_star(
            radii in prop::collection::vec(0.2_f64..1.0, 4..12),
            turn in prop::array::uniform3(-3.0_f64..3.0),
            first in 0_usize..12,
        ) {
            let turn = nalgebra::Rotation3::from_euler_angles(turn[0], turn[1], turn[2]);
            let count = radii.len();
            let corner = |k: usize| {
                let angle = core::f64::consts::TAU * k as f64 / count as f64;
                let (sine, cosine) = libm::sincos(angle);
                turn * Vector3::new(radii[k] * cosine, radii[k] * sine, 0.0)
            };
            let corners: Vec<Vector3<f64>> = (0..count).map(|k| corner((k + first) % count)).collect();
            let whole: f64 = (0..count)
                .map(|k| 0.5 * corners[k].cross(&corners[(k + 1) % count]).norm())
                .sum();
            let triangles = triangles(&corners).unwrap();
            prop_assert_eq!(triangles.len(), count - 2);
            let normal = turn * Vector3::z();
            let parts: Vec<f64> =
                triangles.iter().map(|triangle| area(&corners, *triangle).dot(&normal)).collect();
            prop_assert!(parts.iter().all(|part| *part > 0.0), "{:?}", parts);
            prop_assert!((parts.iter().sum::<f64>() / whole - 1.0).abs() < 1e-12);
        }
    }
}
