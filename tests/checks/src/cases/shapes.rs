//! Shells of single reference cases: radial discs, capped frustums, columns of gas. The others are
//! [`billow_solver::geometry::shapes`].
//!
//! Every shape has one arithmetic and one numbering: bands of reference cases depend on their bits.

use billow_solver::geometry::shapes::revolved;

use super::prelude::*;

/// Nodes on the rim of a [`billow_solver::geometry::shapes::disc`] of this many rings.
pub fn disc_rim(rings: u32) -> Vec<u32> {
    (1 + 3 * rings * (rings - 1)..=3 * rings * (rings + 1)).collect()
}

/// A flat disc whose elements lie along its radii: `rings` equal steps outward, `around` nodes on
/// each ring. Ring 0 of the numbering is the rim; the last node is the centre.
pub fn radial_disc(rings: u32, around: u32, radius: f64) -> Shell {
    let shell = revolved(rings - 1, around, false, |k| {
        [radius * f64::from(rings - k) / f64::from(rings), 0.0]
    });
    let Shell { mut positions, mut triangles, .. } = shell;
    let centre = u32::try_from(positions.len()).expect("fewer than 2^32 nodes");
    positions.push(Vector3::zeros());
    let last = ring_nodes(rings - 1, around);
    for i in 0..around as usize {
        triangles.push([last[i], last[(i + 1) % around as usize], centre]);
    }
    Shell::relaxed(positions, triangles)
}

/// A frustum of film closed by two flat circular caps.
pub struct CappedFrustum {
    /// The film.
    pub shell: Shell,
    /// Nodes of the bottom and the top rim.
    pub rims: [Vec<u32>; 2],
    /// Nodes at the centre of the bottom and the top cap.
    pub poles: [u32; 2],
}

/// A frustum of these radii (m, bottom and top) and this height (m), closed by flat caps, bottom rim
/// at z = 0. It has `fine` steps from a cap's centre to its rim and twice as many along the side,
/// the smaller the nearer to a rim.
pub fn capped_frustum(fine: u32, [bottom, top]: [f64; 2], height: f64) -> CappedFrustum {
    let around = 6 * fine;
    let side = 2 * fine;
    // A cosine makes the steps at both rims small.
    let fraction = |k: u32, of: u32| 0.5 - 0.5 * libm::cos(PI * f64::from(k) / f64::from(of));
    // A quarter of a sine makes them small at the cap's rim alone.
    let outward = |k: u32| libm::sin(0.25 * TAU * f64::from(k) / f64::from(fine));
    let rings = 2 * (fine - 1) + side;
    let shell = revolved(rings, around, false, |k| {
        if k < fine {
            [bottom * outward(k + 1), 0.0]
        } else if k <= fine - 1 + side {
            let s = fraction(k + 1 - fine, side);
            [bottom + (top - bottom) * s, height * s]
        } else {
            [top * outward(rings + 1 - k), height]
        }
    });
    let Shell { mut positions, mut triangles, .. } = shell;
    let next = u32::try_from(positions.len()).expect("fewer than 2^32 nodes");
    let poles = [next, next + 1];
    positions.extend([Vector3::zeros(), Vector3::new(0.0, 0.0, height)]);
    let (first, last) = (ring_nodes(0, around), ring_nodes(rings, around));
    for i in 0..around as usize {
        let j = (i + 1) % around as usize;
        triangles.push([poles[0], first[j], first[i]]);
        triangles.push([poles[1], last[i], last[j]]);
    }
    let rims = [ring_nodes(fine - 1, around), ring_nodes(fine - 1 + side, around)];
    CappedFrustum { shell: Shell::relaxed(positions, triangles), rims, poles }
}

/// Two square plates of film of this area (m²), the upper one at this height (m); the walls between
/// them close the volume and are no film. Nodes 0 to 3 are the lower plate, 4 to 7 the upper one.
pub fn gas_column(area: f64, height: f64) -> Shell {
    let half = 0.5 * area.sqrt();
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
    let plate = |z: f64| corners.map(|(x, y)| Vector3::new(x, y, z));
    let positions = [plate(0.0), plate(height)].concat();
    let mut shell = Shell::relaxed(positions, vec![[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]]);
    for side in 0..4_u32 {
        let next = (side + 1) % 4;
        shell.closure.extend([[side, next, next + 4], [side, next + 4, side + 4]]);
    }
    shell
}
