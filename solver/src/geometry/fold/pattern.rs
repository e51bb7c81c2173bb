//! A solved fold pattern: every angle, length and area of a design.

use core::f64::consts::PI;

use super::fit::{self, geometric_sum};
use super::{FoldDesign, FoldError, Nearest, PanelAngles, scan, states};

/// A solved fold design.
#[derive(Debug, Clone, PartialEq)]
pub struct FoldPattern {
    /// The requested design.
    pub design: FoldDesign,
    /// φh, half top angle, rad; negative for a capsule that widens upward.
    pub half_angle: f64,
    /// Angles of a panel.
    pub angles: PanelAngles,
    /// r2, m.
    pub bottom_radius: f64,
    /// r1, m.
    pub top_radius: f64,
    /// H, height of the erected cone, m.
    pub height: f64,
}

/// Edge lengths of a panel, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lengths {
    /// Outer ring edge.
    pub ab: f64,
    /// Inner ring edge.
    pub de: f64,
    /// Panel side.
    pub ad: f64,
    /// Diagonal.
    pub ae: f64,
}

/// Maximum Green strain of a folded edge at the stowed height. Chosen: 1 %,
/// far above the 3.5e-5 of the paper's capsule.
const MAX_STOWED_STRAIN: f64 = 0.01;

impl FoldPattern {
    /// Solves a design that passed [`fit::check`] and [`fit::infeasibility`].
    pub(super) fn close(design: &FoldDesign) -> Result<Self, FoldError> {
        let fit::Solved { phi, half_angle } = fit::solve(design);
        let angles = PanelAngles::closing(design.panels, phi, half_angle);
        if !angles.is_panel() {
            return Err(FoldError::Infeasible {
                reason: format!(
                    "the panel degenerates (phi {phi:e} rad, alpha1 {:e} rad)",
                    angles.alpha1
                ),
                nearest: Vec::new(),
            });
        }
        let slant = angles.unit_slant * geometric_sum(angles.ring_ratio, design.storeys);
        let computed = (
            design.bottom_radius * power(angles.ring_ratio, design.storeys),
            design.bottom_radius * libm::cos(half_angle) * slant,
        );
        // A given radius or height is kept exactly; the others are computed.
        let (top_radius, height) = match design.fit {
            super::Fit::Cone => (design.top_radius, design.height),
            super::Fit::Angles => (None, None),
            super::Fit::Height => (None, design.height),
        };
        let pattern = Self {
            design: design.clone(),
            half_angle,
            angles,
            bottom_radius: design.bottom_radius,
            top_radius: top_radius.unwrap_or(computed.0),
            height: height.unwrap_or(computed.1),
        };
        pattern.check_stowed_height()?;
        Ok(pattern)
    }

    /// Refuses a stowed height that the pattern cannot be packed to. Lower stacks strain less, so the
    /// nearest feasible height is below.
    fn check_stowed_height(&self) -> Result<(), FoldError> {
        let stowed = self.design.stowed_height;
        let strain = self.stowed_strain(stowed);
        let reason = if stowed >= self.height {
            format!("stowed_height: {stowed} m is not below the height of {} m", self.height)
        } else if strain > MAX_STOWED_STRAIN {
            format!(
                "stowed_height: {stowed} m strains folded edges by {:.2} %; allowed: up to {} %; \
                 choose a lower height",
                100.0 * strain,
                100.0 * MAX_STOWED_STRAIN
            )
        } else {
            return Ok(());
        };
        let feasible = |height| {
            height < self.height
                // The check of one storey is cheap and refuses most heights.
                && self.smallest_storey_strain(height) <= MAX_STOWED_STRAIN
                && self.stowed_strain(height) <= MAX_STOWED_STRAIN
        };
        let nearest = scan::nearest_real(stowed, &[scan::Direction::Down], feasible);
        let nearest = nearest.map(|value| Nearest { key: "stowed_height", value });
        Err(FoldError::Infeasible { reason, nearest: nearest.into_iter().collect() })
    }

    /// Radius of ring `ring` of the cone, m; 0 is the bottom ring, M the top ring.
    pub fn ring_radius(&self, ring: u32) -> f64 {
        self.bottom_radius * power(self.angles.ring_ratio, ring)
    }

    /// Circumradius of ring `ring` folded to its regular N-gon, m. Folding keeps the perimeter, so it is
    /// larger than the radius of the cone.
    pub fn polygon_radius(&self, ring: u32) -> f64 {
        0.5 * self.ring_radius(ring) * self.angles.unit_lengths.ab
            / libm::sin(PI / f64::from(self.design.panels))
    }

    /// Edge lengths of the panels of storey `storey`, m; 0 is the lowest.
    pub fn lengths(&self, storey: u32) -> Lengths {
        let radius = self.ring_radius(storey);
        let unit = &self.angles.unit_lengths;
        Lengths {
            ab: radius * unit.ab,
            de: radius * unit.de,
            ad: radius * unit.ad,
            ae: radius * unit.ae,
        }
    }

    /// Closure error of a flat-folded storey, relative to |AB|. The two facets of a panel are placed from
    /// α1, β1 and their lengths and folded along AE. The rigid motion from (A, D) to (B, E), applied N
    /// times, must be the identity (Eq. 14 is the same condition in angles).
    pub fn closure_defect(&self) -> f64 {
        states::closure_defect(&self.angles, self.design.panels)
    }

    /// Height of ring `ring` when erected over that of the capsule: 0 for the bottom ring, 1 for the top
    /// ring.
    pub fn height_fraction(&self, ring: u32) -> f64 {
        let ratio = self.angles.ring_ratio;
        geometric_sum(ratio, ring) / geometric_sum(ratio, self.design.storeys)
    }

    /// Twist of a flat-folded storey: rotation of its upper ring relative to its lower one, rad,
    /// counter-clockwise in the lowest storey.
    pub fn flat_twist(&self) -> f64 {
        let angles = &self.angles;
        let outer = 0.5 * angles.unit_lengths.ab / libm::sin(PI / f64::from(self.design.panels));
        // In the triangle of centre, A and D the angle at A is ϕ + β1.
        let (side, at_a) = (angles.unit_lengths.ad, angles.phi + angles.beta1);
        libm::atan2(side * libm::sin(at_a), outer - side * libm::cos(at_a))
    }

    /// Twist of an erected storey, rad.
    pub fn erected_twist(&self) -> f64 {
        self.angles.erected_twist
    }

    /// Radius of the clear opening of a flat-folded storey, m: the distance of the diagonals AE from the
    /// axis, or that of the inner corners where the perpendicular foot lies beyond E.
    pub fn opening_radius(&self, storey: u32) -> f64 {
        let radius = self.polygon_radius(storey);
        let foot = radius * libm::cos(self.angles.phi);
        if foot <= self.lengths(storey).ae {
            radius * libm::sin(self.angles.phi)
        } else {
            self.polygon_radius(storey + 1)
        }
    }

    /// Areas of the two facets (ABE, AED) of one panel of a storey, m².
    pub fn facet_areas(&self, storey: u32) -> [f64; 2] {
        let Lengths { ab, ad, ae, .. } = self.lengths(storey);
        [
            0.5 * ab * ae * libm::sin(self.angles.alpha1),
            0.5 * ae * ad * libm::sin(self.angles.beta1),
        ]
    }

    /// Developed area of the lateral film, m².
    pub fn lateral_area(&self) -> f64 {
        if self.design.caps == super::Caps::Circular {
            // The sector between the arcs, not between the chords.
            let slant = self.slant(self.design.storeys);
            return PI * (self.ring_radius(0) + self.ring_radius(self.design.storeys)) * slant;
        }
        (0..self.design.storeys)
            .map(|storey| {
                let [abe, aed] = self.facet_areas(storey);
                f64::from(self.design.panels) * (abe + aed)
            })
            .sum()
    }

    /// Area of the cap on ring `ring`, m²: its N-gon, or a disc with the radius of the cone.
    pub fn cap_area(&self, ring: u32) -> f64 {
        match self.design.caps {
            super::Caps::Polygon => self.polygon_area(ring),
            super::Caps::Circular => {
                let radius = self.ring_radius(ring);
                PI * radius * radius
            }
        }
    }

    /// Area of the N-gon that ring `ring` folds to, m².
    pub fn polygon_area(&self, ring: u32) -> f64 {
        let (n, radius) = (f64::from(self.design.panels), self.polygon_radius(ring));
        0.5 * n * radius * radius * libm::sin(2.0 * PI / n)
    }

    /// Area of the film, m²: lateral film and both caps.
    pub fn film_area(&self) -> f64 {
        self.lateral_area() + self.cap_area(0) + self.cap_area(self.design.storeys)
    }

    /// Volume of the erected cone, m³.
    pub fn erected_volume(&self) -> f64 {
        let (r2, r1) = (self.bottom_radius, self.top_radius);
        PI / 3.0 * self.height * (r2 * r2 + r2 * r1 + r1 * r1)
    }
}

/// x^exponent by repeated multiplication.
pub(super) fn power(x: f64, exponent: u32) -> f64 {
    (0..exponent).fold(1.0, |product, _| product * x)
}
