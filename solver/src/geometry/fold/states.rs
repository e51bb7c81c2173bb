//! The states of a pattern: flat folded, stowed at a height, erected, developed.
//!
//! Flat folded, ring k is a regular N-gon of its own side |AB| ρ^k, turned against the ring below
//! by the flat twist. Stowed at height h, the same N-gons stand h/M apart and each storey turns a
//! little less (`packed`).

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
    pub turn: f64,
    /// Height, m.
    pub z: f64,
}

impl Polygon {
    /// Position of corner `corner` of `corners`, m.
    pub fn corner(&self, corner: u32, corners: u32) -> Vector3<f64> {
        let (sin, cos) =
            libm::sincos(self.turn + 2.0 * PI * f64::from(corner) / f64::from(corners));
        Vector3::new(self.radius * cos, self.radius * sin, self.z)
    }
}

/// A corner of the crease pattern: corner `corner` (0 to N; N is corner 0 again, across the seam)
/// of ring `ring`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Corner {
    /// 0 is the bottom ring.
    pub ring: u32,
    /// Counter-clockwise seen from above.
    pub corner: u32,
}

/// A facet of the lateral film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Facet {
    /// 0 is the lowest.
    pub storey: u32,
    /// Panel, 0 to N − 1.
    pub panel: u32,
    /// Whether two of its corners lie on the lower ring (ABE) or on the upper (AED).
    pub on_lower_ring: bool,
    /// Corners, counter-clockwise seen from outside.
    pub corners: [Corner; 3],
}

impl FoldPattern {
    /// +1 for a storey that turns counter-clockwise going up (folded), −1 for one that turns the
    /// other way.
    pub fn turn_sign(&self, storey: u32) -> f64 {
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
                // A mirrored storey runs its diagonal the other way; both wind outward.
                let (abe, aed) = if self.turn_sign(storey) > 0.0 {
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

    /// The rings flat folded: all at z = 0.
    pub fn flat_polygons(&self) -> Vec<Polygon> {
        let twist = self.flat_twist();
        self.stack(|_| (0.0, twist))
    }

    /// The rings stowed at stack height `height`, m, storeys equally high.
    pub fn stowed_polygons(&self, height: f64) -> Vec<Polygon> {
        let rise = height / f64::from(self.design.storeys);
        let packed = PackedStorey::of(self);
        self.stack(|storey| (rise, packed.twist(rise / self.polygon_radius(storey))))
    }

    /// Largest Green strain of a folded edge, in magnitude, at stack height `height`, m.
    pub fn stowed_strain(&self, height: f64) -> f64 {
        let rise = height / f64::from(self.design.storeys);
        let packed = PackedStorey::of(self);
        (0..self.design.storeys)
            .map(|storey| packed.strain(rise / self.polygon_radius(storey)))
            .fold(0.0, f64::max)
    }

    /// The same of the smallest storey alone, as a rule the largest: storeys are alike but for their
    /// size and equally high.
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
        let place = |c: Corner| polygons[c.ring as usize].corner(c.corner % n, n);
        let lateral: f64 = self
            .facets()
            .iter()
            .map(|facet| {
                let [a, b, c] = facet.corners.map(place);
                a.dot(&b.cross(&c)) / 6.0
            })
            .sum();
        // The bottom cap lies in z = 0 and adds nothing.
        lateral + self.polygon_area(self.design.storeys) * height / 3.0
    }

    fn stack(&self, storey_rise_and_twist: impl Fn(u32) -> (f64, f64)) -> Vec<Polygon> {
        let mut polygons = vec![Polygon { radius: self.polygon_radius(0), turn: 0.0, z: 0.0 }];
        for storey in 0..self.design.storeys {
            let below = polygons[storey as usize];
            let (rise, twist) = storey_rise_and_twist(storey);
            polygons.push(Polygon {
                radius: self.polygon_radius(storey + 1),
                turn: below.turn + self.turn_sign(storey) * twist,
                z: below.z + rise,
            });
        }
        polygons
    }

    /// Polar angle on the erected cone, rad, of a corner of the pattern.
    pub fn erected_angle(&self, corner: Corner) -> f64 {
        let turned: f64 = (0..corner.ring).map(|storey| self.turn_sign(storey)).sum();
        2.0 * PI * f64::from(corner.corner) / f64::from(self.design.panels)
            + turned * self.erected_twist()
    }

    /// Distance of ring `ring` from the bottom ring along the cone, m.
    pub fn slant(&self, ring: u32) -> f64 {
        let angles = &self.angles;
        self.bottom_radius * angles.unit_slant * geometric_sum(angles.ring_ratio, ring)
    }

    /// Place of a corner in the developed plane, seen from outside: x to the right (counter-clockwise
    /// round the capsule), y up towards the top ring, from the bottom ring's middle, m. `middle` is
    /// the polar angle on the erected cone that is put at x = 0.
    pub fn developed(&self, corner: Corner, middle: f64) -> Vector2<f64> {
        self.develop(self.slant(corner.ring), self.erected_angle(corner) - middle)
    }

    /// Developed place of the point of the cone at distance `slant` from the bottom ring along the
    /// cone, at polar angle `angle` from x = 0.
    pub fn develop(&self, slant: f64, angle: f64) -> Vector2<f64> {
        let s = libm::sin(self.half_angle);
        let radius = self.bottom_radius - s * slant;
        // R2 − R cos a = (R2 − R) + 2 R sin²(a/2), with R = r/s and a = s·angle.
        let bend = 2.0 * radius * sine_over(0.5 * angle, s) * libm::sin(0.5 * angle * s);
        Vector2::new(radius * sine_over(angle, s), slant + bend)
    }

    /// The point of the erected cone a developed point rolls onto (isometrically), m; `middle` as in
    /// [`Self::developed`].
    pub fn roll(&self, developed: Vector2<f64>, middle: f64) -> Vector3<f64> {
        let (s, c) = libm::sincos(self.half_angle);
        let (x, y) = (developed.x, developed.y);
        // With R = r/s: r = |(r2 − s y, s x)|, and R2 − R without the difference of large numbers.
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
    let at = |length: f64, angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        Vector2::new(length * cos, length * sin)
    };
    let b = Vector2::new(ab, 0.0);
    let e = at(ae, angles.alpha1);
    // Folded over AE, D lies on B's side of it.
    let d = at(ad, angles.alpha1 - angles.beta1);
    // The motion z → w z + b carries A to B; w carries D (from A) to E (from B).
    let (from, to) = (d, e - b);
    let w = Vector2::new(from.dot(&to), from.perp(&to)) / from.norm_squared();
    let mut place = Vector2::zeros();
    let mut heading = Vector2::new(1.0, 0.0);
    for _ in 0..panels {
        place += ab * heading;
        heading =
            Vector2::new(heading.x * w.x - heading.y * w.y, heading.x * w.y + heading.y * w.x);
    }
    (place.norm() / ab).max((heading - Vector2::new(1.0, 0.0)).norm())
}
