//! The moving mass.
//!
//! ```text
//! m_eff = ∫ ξ² dm           ∫_triangle ξ² dA = A/6 (Σ ξ_i² + Σ_{i<j} ξ_i ξ_j)
//! m_1   = ∫ ξ dm            ∫_triangle ξ dA  = A/3 Σ ξ_i
//! ```
//!
//! ξ is the height of a film point over the erected height: at ring vertices that of the ring
//! ([`FoldPattern::height_fraction`]), linear over each facet, 1 on the top cap, 0 on the bottom cap.
//! Points move with ξ ż, so the kinetic energy is `m_eff` ż²/2 and the force of gravity g `m_1`.

use crate::geometry::fold::FoldPattern;

/// Mass of the film and its moments over height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingMass {
    /// Mass of the whole film, kg.
    pub total: f64,
    /// ∫ξ dm, kg: gravity acts on it.
    pub first_moment: f64,
    /// ∫ξ² dm, kg: the accelerated mass.
    pub effective: f64,
    /// Area of the lateral film and both caps, m².
    pub area: f64,
}

impl MovingMass {
    /// Of a pattern whose film has the mass `area_density` per area (kg/m²).
    pub fn new(pattern: &FoldPattern, area_density: f64) -> Self {
        let panels = f64::from(pattern.design.panels);
        let storeys = pattern.design.storeys;
        let top = pattern.cap_area(storeys);
        let mut area = pattern.cap_area(0) + top;
        let (mut first, mut second) = (top, top);
        for storey in 0..storeys {
            let outer = pattern.height_fraction(storey);
            let inner = pattern.height_fraction(storey + 1);
            // ABE has two vertices on the outer ring, AED two on the inner.
            let [abe, aed] = pattern.facet_areas(storey);
            for (facet, corners) in [(abe, [outer, outer, inner]), (aed, [outer, inner, inner])] {
                let [mean, square] = moments(corners);
                area += panels * facet;
                first += panels * facet * mean;
                second += panels * facet * square;
            }
        }
        Self {
            total: area_density * area,
            first_moment: area_density * first,
            effective: area_density * second,
            area,
        }
    }
}

/// Means of ξ and ξ² over a triangle with ξ linear between its corners.
fn moments([a, b, c]: [f64; 3]) -> [f64; 2] {
    [(a + b + c) / 3.0, (a * a + b * b + c * c + a * b + b * c + c * a) / 6.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_agree_with_a_fine_subdivision() {
        let corners = [0.2, 0.5, 0.9];
        let n = 400_i32;
        let (mut count, mut one, mut two) = (0.0, 0.0, 0.0);
        // Centroids of the n² congruent parts of the triangle.
        for i in 0..n {
            for j in 0..(n - i) {
                for third in [1.0, 2.0] {
                    if third > 1.5 && j + 1 >= n - i {
                        continue;
                    }
                    let u = (f64::from(i) + third / 3.0) / f64::from(n);
                    let v = (f64::from(j) + third / 3.0) / f64::from(n);
                    let xi = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
                    count += 1.0;
                    one += xi;
                    two += xi * xi;
                }
            }
        }
        let [mean, square] = moments(corners);
        assert!((one / count - mean).abs() < 1e-12, "{} {mean}", one / count);
        assert!((two / count - square).abs() < 1e-6, "{} {square}", two / count);
    }
}
