//! The states of a pattern: flat-folded, stowed at a height, erected, developed.
//!
//! Flat-folded, ring k is a regular N-gon with side |AB| ρ^k, rotated relative to the ring below by the
//! flat twist. Stowed at height h, the same N-gons are h/M apart and each storey twists slightly less
//! (`packed`).

use core::f64::consts::PI;

use nalgebra::{Vector2, Vector3};

use super::angles::{angle_over, sine_over};
use super::fit::geometric_sum;
use super::packed::PackedStorey;
use super::{Chirality, FoldPattern, Lengths, PanelAngles};

/// A ring folded to a regular N-gon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polygon {
    /// Circumradius, m.
    pub radius: f64,
    /// Polar angle of corner 0, rad.
    pub angle: f64,
    /// Height, m.
    pub z: f64,
}

impl Polygon {
    /// Position of corner `corner` of an N-gon with N = `corners`, m.
    pub fn corner(&self, corner: u32, corners: u32) -> Vector3<f64> {
        let (sin, cos) =
            libm::sincos(self.angle + 2.0 * PI * f64::from(corner) / f64::from(corners));
        Vector3::new(self.radius * cos, self.radius * sin, self.z)
    }
}

/// A corner of the crease pattern: corner `corner` (0 to N) of ring `ring`. Corner N is corner 0 on the
/// other side of the seam.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Corner {
    /// Ring, 0 the bottom ring.
    pub ring: u32,
    /// Corner, counter-clockwise seen from above.
    pub corner: u32,
}

/// A facet of the lateral film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Facet {
    /// Storey, 0 the lowest.
    pub storey: u32,
    /// Panel, 0 to N − 1.
    pub panel: u32,
    /// Whether two of its corners are on the lower ring (ABE) or on the upper one (AED).
    pub on_lower_ring: bool,
    /// Corners, counter-clockwise seen from outside.
    pub corners: [Corner; 3],
}

impl FoldPattern {
    /// Twist direction of a folded storey: +1 where its upper ring is rotated counter-clockwise, −1
    /// clockwise.
    pub fn twist_sign(&self, storey: u32) -> f64 {
        match self.design.chirality {
            Chirality::Alternate if storey % 2 == 1 => -1.0,
            _ => 1.0,
        }
    }

    /// Every facet of the lateral film: storey by storey, panel by panel, ABE then AED.
    pub fn facets(&self) -> Vec<Facet> {
        let mut facets = Vec::new();
        for storey in 0..self.design.storeys {
            for panel in 0..self.design.panels {
                let lower = |step| Corner { ring: storey, corner: panel + step };
                let upper = |step| Corner { ring: storey + 1, corner: panel + step };
                // The diagonal of a mirrored storey has the other direction; both facets wind outward.
                let (abe, aed) = if self.twist_sign(storey) > 0.0 {
                    ([lower(0), lower(1), upper(1)], [lower(0), upper(1), upper(0)])
                } else {
                    ([lower(0), lower(1), upper(0)], [lower(1), upper(1), upper(0)])
                };
                for (on_lower_ring, corners) in [(true, abe), (false, aed)] {
                    facets.push(Facet { storey, panel, on_lower_ring, corners });
                }
            }
        }
        facets
    }

    /// The flat-folded rings, all at z = 0.
    pub fn flat_polygons(&self) -> Vec<Polygon> {
        let twist = self.flat_twist();
        self.stack(|_| (0.0, twist))
    }

    /// The rings stowed at stack height `height`, m; all storeys have the same rise.
    pub fn stowed_polygons(&self, height: f64) -> Vec<Polygon> {
        let rise = height / f64::from(self.design.storeys);
        let packed = PackedStorey::of(self);
        self.stack(|storey| (rise, packed.twist(rise / self.polygon_radius(storey))))
    }

    /// Largest magnitude of the Green strain of a folded edge at stack height `height`, m.
    pub fn stowed_strain(&self, height: f64) -> f64 {
        let rise = height / f64::from(self.design.storeys);
        let packed = PackedStorey::of(self);
        (0..self.design.storeys)
            .map(|storey| packed.strain(rise / self.polygon_radius(storey)))
            .fold(0.0, f64::max)
    }

    /// The same for the smallest storey alone, which usually strains most: storeys are similar and have
    /// the same rise.
    pub(super) fn smallest_storey_strain(&self, height: f64) -> f64 {
        let rise = height / f64::from(self.design.storeys);
        let last = self.design.storeys - 1;
        let smallest = self.polygon_radius(0).min(self.polygon_radius(last));
        PackedStorey::of(self).strain(rise / smallest)
    }

    /// Volume enclosed by the stowed shape at stack height `height`, m³, with flat facets and caps.
    pub fn stowed_volume(&self, height: f64) -> f64 {
        let polygons = self.stowed_polygons(height);
        let n = self.design.panels;
        let position = |c: Corner| polygons[c.ring as usize].corner(c.corner % n, n);
        let lateral: f64 = self
            .facets()
            .iter()
            .map(|facet| {
                let [a, b, c] = facet.corners.map(position);
                a.dot(&b.cross(&c)) / 6.0
            })
            .sum();
        // The bottom cap is at z = 0 and contributes nothing.
        lateral + self.polygon_area(self.design.storeys) * height / 3.0
    }

    fn stack(&self, storey_rise_and_twist: impl Fn(u32) -> (f64, f64)) -> Vec<Polygon> {
        let mut polygons = vec![Polygon { radius: self.polygon_radius(0), angle: 0.0, z: 0.0 }];
        for storey in 0..self.design.storeys {
            let below = polygons[storey as usize];
            let (rise, twist) = storey_rise_and_twist(storey);
            polygons.push(Polygon {
                radius: self.polygon_radius(storey + 1),
                angle: below.angle + self.twist_sign(storey) * twist,
                z: below.z + rise,
            });
        }
        polygons
    }

    /// Polar angle of a corner of the pattern on the erected cone, rad.
    pub fn erected_angle(&self, corner: Corner) -> f64 {
        let twists: f64 = (0..corner.ring).map(|storey| self.twist_sign(storey)).sum();
        2.0 * PI * f64::from(corner.corner) / f64::from(self.design.panels)
            + twists * self.erected_twist()
    }

    /// Distance of ring `ring` from the bottom ring along the surface of the cone, m.
    pub fn slant(&self, ring: u32) -> f64 {
        let angles = &self.angles;
        self.bottom_radius * angles.unit_slant * geometric_sum(angles.ring_ratio, ring)
    }

    /// Position of a corner in the developed plane, m, seen from outside: x to the right
    /// (counter-clockwise around the capsule), y towards the top ring. `middle` is the polar angle on the
    /// erected cone, rad, that has x = 0; the origin is on the bottom ring.
    pub fn developed(&self, corner: Corner, middle: f64) -> Vector2<f64> {
        self.develop(self.slant(corner.ring), self.erected_angle(corner) - middle)
    }

    /// Developed position, m, of the point of the cone at distance `slant` (m) from the bottom ring along
    /// the surface, at polar angle `angle` (rad) from x = 0.
    pub fn develop(&self, slant: f64, angle: f64) -> Vector2<f64> {
        let s = libm::sin(self.half_angle);
        let radius = self.bottom_radius - s * slant;
        // R2 − R cos a = (R2 − R) + 2 R sin²(a/2), with R = r/s and a = s·angle.
        let bend = 2.0 * radius * sine_over(0.5 * angle, s) * libm::sin(0.5 * angle * s);
        Vector2::new(radius * sine_over(angle, s), slant + bend)
    }

    /// Position on the erected cone, m, of a developed point: the isometric inverse of
    /// [`Self::developed`], with its `middle`.
    pub fn roll(&self, developed: Vector2<f64>, middle: f64) -> Vector3<f64> {
        let (s, c) = libm::sincos(self.half_angle);
        let (x, y) = (developed.x, developed.y);
        // R = r/s: r = |(r2 − s y, s x)|; R2 − R is written without a difference of large numbers.
        let along = self.bottom_radius - s * y;
        let radius = libm::sqrt(along * along + s * x * s * x);
        let slant =
            (2.0 * self.bottom_radius * y - s * (x * x + y * y)) / (self.bottom_radius + radius);
        let (sin, cos) = libm::sincos(middle + angle_over(x, along, s));
        Vector3::new(radius * cos, radius * sin, slant * c)
    }
}

/// See [`FoldPattern::closure_defect`].
pub(super) fn closure_defect(angles: &PanelAngles, panels: u32) -> f64 {
    let Lengths { ab, ad, ae, .. } = angles.unit_lengths;
    let polar = |length: f64, angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        Vector2::new(length * cos, length * sin)
    };
    let b = Vector2::new(ab, 0.0);
    let e = polar(ae, angles.alpha1);
    // Folded along AE, D is on the same side of AE as B.
    let d = polar(ad, angles.alpha1 - angles.beta1);
    // The motion z → w z + b maps A to B; w rotates AD to BE.
    let (from, to) = (d, e - b);
    let w = Vector2::new(from.dot(&to), from.perp(&to)) / from.norm_squared();
    let mut position = Vector2::zeros();
    let mut heading = Vector2::new(1.0, 0.0);
    for _ in 0..panels {
        position += ab * heading;
        heading =
            Vector2::new(heading.x * w.x - heading.y * w.y, heading.x * w.y + heading.y * w.x);
    }
    (position.norm() / ab).max((heading - Vector2::new(1.0, 0.0)).norm())
}
