//! Fold designs of the tests, and an intersection count that shares no code with the solver.

use billow_solver::scene::paper;

use crate::prelude::*;

/// The paper's capsule at n 5, fit `cone`.
pub fn paper_design() -> FoldDesign {
    paper::design(5)
}

/// The paper's capsule with α1/ϕ = 1, fit `angles` on the nominal cone.
pub fn paper_angles() -> FoldDesign {
    FoldDesign { fit: Fit::Angles, alpha1_over_phi: Some(1.0), ..paper_design() }
}

/// The paper's height with α1/ϕ = 1, fit `height`.
pub fn paper_height(storeys: u32) -> FoldDesign {
    FoldDesign {
        fit: Fit::Height,
        storeys,
        top_radius: None,
        alpha1_over_phi: Some(1.0),
        ..paper_design()
    }
}

pub fn solved(design: &FoldDesign) -> FoldPattern {
    FoldPattern::new(design).expect("a feasible design")
}

/// Number of proper edge-triangle crossings of a mesh, every edge against every triangle that
/// shares no node with it. Touching and coplanar pairs do not cross.
pub fn crossings(mesh: &Mesh) -> usize {
    let edges = mesh.edges();
    mesh.triangles
        .iter()
        .map(|triangle| {
            let corners = triangle.map(|node| mesh.positions[node as usize]);
            edges
                .iter()
                .filter(|edge| !edge.iter().any(|node| triangle.contains(node)))
                .filter(|edge| crosses(edge.map(|node| mesh.positions[node as usize]), corners))
                .count()
        })
        .sum()
}

fn crosses([p, q]: [Vector3<f64>; 2], [a, b, c]: [Vector3<f64>; 3]) -> bool {
    let six_volumes = |d: Vector3<f64>, e: Vector3<f64>, f: Vector3<f64>, g: Vector3<f64>| {
        (e - d).cross(&(f - d)).dot(&(g - d))
    };
    // Below this a point lies in the plane to within rounding.
    let scale = (b - a).norm().max((c - a).norm()).max((q - p).norm());
    let nothing = 1e-14 * scale * scale * scale;
    let side = |x: f64| {
        if x > nothing {
            1
        } else if x < -nothing {
            -1
        } else {
            0
        }
    };
    if side(six_volumes(a, b, c, p)) * side(six_volumes(a, b, c, q)) >= 0 {
        return false;
    }
    let around = [(a, b), (b, c), (c, a)].map(|(d, e)| side(six_volumes(p, q, d, e)));
    around.iter().all(|s| *s > 0) || around.iter().all(|s| *s < 0)
}
