//! A strip of the capsule from the centre of the bottom cap to the centre of the top cap: its nodes and
//! elements.
//!
//! ```text
//! cap      3 segments from the centre to the ring; stress-free: a disc with the mean radius of the N-gon
//! storey   2 segments: lower ring, middle, upper ring; stress-free: the developed cone
//! stowed   r, θ of a node: means over its line around the folded stack; then at rest (see `rest`)
//! ```
//!
//! A node stands for one line around the film, a ring or the line half way up a storey. Where the film is
//! folded, the line is a polygon: its sides lie on the facets ABE and AED. The node has the mean radius of
//! the line and its mean turn against the erected capsule. The film is then too long for this smooth
//! shape, so it is slack; what the folds do within a line is left out.

use core::f64::consts::PI;

use nalgebra::{Vector2, Vector3};

use super::STRIPS;
use crate::geometry::fold::{Corner, FoldPattern};
use crate::mechanics::material::Material;
use crate::mechanics::material_loss::Creep;
use crate::scene::Film;

/// Segments of a cap between its centre and its ring. Chosen: with 2 or 4 the time to half the height moves
/// by 3 %; more make steps shorter.
const CAP_SEGMENTS: u32 = 3;
/// Segments of a storey. Chosen: one is too stiff to fold (times 40 % late); with 3 the time to half the
/// height is 5 % later.
const STOREY_SEGMENTS: u32 = 2;
/// Smallest radius of a node over its radius on the cone, below which the film resists. Chosen: half of
/// the smallest radius that a ring of the paper's capsule has as film, 0.2 m of 0.365 m.
const MIN_RADIUS_FRACTION: f64 = 0.2;
/// Stiffness of that resistance times Δt²/m. Chosen: far below 4, the limit of stability.
const BARRIER_STIFFNESS: f64 = 0.05;
/// Points on one side of a line around the stack. Chosen: the mean radius errs by less than 1e-5.
const LINE_POINTS: u32 = 200;

/// Constants of one node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StripNode {
    /// Mass of one strip, kg.
    pub mass: f64,
    /// 1/mass where it is free across the axis, else 0.
    pub across: f64,
    /// 1/mass where it is free along z, else 0.
    pub along: f64,
    /// Radius below which the film resists, m.
    pub min_radius: f64,
    /// Stiffness of that resistance, N/m.
    pub barrier: f64,
}

/// Constants of the element between a node and the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StripElement {
    /// 1/L², L its stress-free length, 1/m².
    pub length: f64,
    /// 1/(Ra² + Rb²) of the stress-free radii, 1/m².
    pub hoop: f64,
    /// 1/(R L), R the mean of the radii, 1/m².
    pub shear: f64,
    /// Minus the volume of its film in one strip, m³.
    pub minus_volume: f64,
    /// 2ζ/ω of the numerical damping, s.
    pub damping_time: f64,
}

/// A strip.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    /// Nodes, from the centre of the bottom cap to that of the top cap.
    pub nodes: Vec<StripNode>,
    /// Elements.
    pub elements: Vec<StripElement>,
    /// The film, of compression fraction 0.
    pub material: Material,
    /// Its loss.
    pub creep: Creep,
    /// 2/ω of the stiffest element, s: the stable step without gas.
    pub stable_step: f64,
    /// Index of the bottom ring.
    pub bottom_ring: usize,
    /// Index of the top ring.
    pub top_ring: usize,
}

/// A node's place: radius (m), turn against the erected capsule (rad), height (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Radius, m.
    pub radius: f64,
    /// Turn, rad.
    pub turn: f64,
    /// Height, m.
    pub z: f64,
}

impl Place {
    /// Position in a half plane at this polar angle (rad), m.
    pub fn position(self, angle: f64) -> Vector3<f64> {
        let (sin, cos) = libm::sincos(angle + self.turn);
        Vector3::new(self.radius * cos, self.radius * sin, self.z)
    }
}

/// Stress-free radii and length of an element, m.
struct Piece {
    radii: [f64; 2],
    length: f64,
}

impl Piece {
    fn area(&self) -> f64 {
        PI * (self.radii[0] + self.radii[1]) * self.length
    }

    /// Shares of its mass at its two nodes: those of a ring whose width varies linearly.
    fn shares(&self) -> [f64; 2] {
        let [a, b] = self.radii;
        let first = (2.0 * a + b) / (3.0 * (a + b));
        [first, 1.0 - first]
    }
}

impl Strip {
    /// The strip of a pattern in this film; `loss` multiplies the loss factor of the film.
    pub fn new(pattern: &FoldPattern, film: &Film, loss: f64) -> Self {
        let film = Film { compression: 0.0, loss_factor: loss * film.loss_factor, ..*film };
        let material = Material::new(&film);
        let creep = Creep::new(&film, &material);
        let pieces = pieces(pattern);
        let bottom_ring = CAP_SEGMENTS as usize;
        let top_ring = pieces.len() - CAP_SEGMENTS as usize;
        let mut masses = vec![0.0; pieces.len() + 1];
        let strips = STRIPS as f64;
        for (index, piece) in pieces.iter().enumerate() {
            let mass = film.area_density() * piece.area() / strips;
            for (node, share) in piece.shares().into_iter().enumerate() {
                masses[index + node] += mass * share;
            }
        }
        let frequencies: Vec<f64> = pieces
            .iter()
            .enumerate()
            .map(|(index, piece)| {
                let inverse = 1.0 / masses[index] + 1.0 / masses[index + 1];
                let stiffness = material.plane_modulus() * film.thickness * piece.area() / strips;
                let radius = 0.5 * (piece.radii[0] + piece.radii[1]);
                let along = 1.0 / (piece.length * piece.length);
                let around = 0.25 / (radius * radius);
                (stiffness * (along + around) * inverse).sqrt()
            })
            .collect();
        let largest = frequencies.iter().copied().fold(0.0, f64::max) * creep.frequency_factor();
        let stable_step = 2.0 / largest;
        let elements = pieces
            .iter()
            .zip(&frequencies)
            .map(|(piece, frequency)| StripElement {
                length: 1.0 / (piece.length * piece.length),
                hoop: 1.0 / (piece.radii[0] * piece.radii[0] + piece.radii[1] * piece.radii[1]),
                shear: 2.0 / ((piece.radii[0] + piece.radii[1]) * piece.length),
                minus_volume: -film.thickness * piece.area() / strips,
                damping_time: 2.0 * film.numerical_damping / frequency,
            })
            .collect();
        let last = masses.len() - 1;
        let radius_of = |node: usize| match node {
            0 => 0.0,
            node => pieces[node - 1].radii[1],
        };
        let nodes = masses
            .iter()
            .enumerate()
            .map(|(node, mass)| {
                let (centre, held) = (node == 0 || node == last, node == bottom_ring);
                StripNode {
                    mass: *mass,
                    across: if centre || held { 0.0 } else { 1.0 / mass },
                    along: if held { 0.0 } else { 1.0 / mass },
                    min_radius: if centre { 0.0 } else { MIN_RADIUS_FRACTION * radius_of(node) },
                    barrier: BARRIER_STIFFNESS * mass / (stable_step * stable_step),
                }
            })
            .collect();
        Self { nodes, elements, material, creep, stable_step, bottom_ring, top_ring }
    }
}

/// Mean radius of a regular N-gon, m, from its circumradius (m): mean over its sides.
fn mean_radius(panels: u32, radius: f64) -> f64 {
    // ∫ √(a² + x²) dx over half a side, a the inradius.
    let (sin, cos) = libm::sincos(PI / f64::from(panels));
    radius * 0.5 * (1.0 + cos * cos / sin * libm::asinh(sin / cos))
}

/// The stress-free film, from the centre of the bottom cap to that of the top cap.
fn pieces(pattern: &FoldPattern) -> Vec<Piece> {
    let (panels, storeys) = (pattern.design.panels, pattern.design.storeys);
    let fraction = |index: u32, of: u32| f64::from(index) / f64::from(of);
    let cap = |ring: u32, index: u32| {
        let radius = mean_radius(panels, pattern.polygon_radius(ring));
        let at = |index: u32| radius * fraction(index, CAP_SEGMENTS);
        Piece { radii: [at(index), at(index + 1)], length: radius / f64::from(CAP_SEGMENTS) }
    };
    let mut pieces: Vec<Piece> = (0..CAP_SEGMENTS).map(|index| cap(0, index)).collect();
    for storey in 0..storeys {
        let (lower, upper) = (pattern.ring_radius(storey), pattern.ring_radius(storey + 1));
        let at = |index: u32| lower + (upper - lower) * fraction(index, STOREY_SEGMENTS);
        let slant = pattern.slant(storey + 1) - pattern.slant(storey);
        pieces.extend((0..STOREY_SEGMENTS).map(|index| Piece {
            radii: [at(index), at(index + 1)],
            length: slant / f64::from(STOREY_SEGMENTS),
        }));
    }
    pieces.extend((0..CAP_SEGMENTS).rev().map(|index| {
        let Piece { radii: [inner, outer], length } = cap(storeys, index);
        Piece { radii: [outer, inner], length }
    }));
    pieces
}

/// Places of the nodes of the stowed stack.
pub fn stowed(pattern: &FoldPattern) -> Vec<Place> {
    let panels = pattern.design.panels;
    let polygons = pattern.stowed_polygons(pattern.design.stowed_height);
    let ring = |ring: u32| {
        let polygon = polygons[ring as usize];
        Place {
            radius: mean_radius(panels, polygon.radius),
            turn: polygon.angle - pattern.erected_angle(Corner { ring, corner: 0 }),
            z: polygon.z,
        }
    };
    let mut places = disc(ring(0));
    for storey in 0..pattern.design.storeys {
        places.push(ring(storey));
        let (lower, upper) = (polygons[storey as usize], polygons[storey as usize + 1]);
        let sign = pattern.twist_sign(storey);
        let twist = sign * (upper.angle - lower.angle);
        for index in 1..STOREY_SEGMENTS {
            let fraction = f64::from(index) / f64::from(STOREY_SEGMENTS);
            let (radius, turn) = line(pattern, [lower.radius, upper.radius], twist, fraction);
            places.push(Place {
                radius,
                turn: ring(storey).turn + sign * turn,
                z: lower.z + (upper.z - lower.z) * fraction,
            });
        }
    }
    let top = ring(pattern.design.storeys);
    places.push(top);
    places.extend(disc(top).into_iter().rev());
    places
}

/// Places of a cap with this ring, without the ring: from the centre outwards.
fn disc(ring: Place) -> Vec<Place> {
    (0..CAP_SEGMENTS)
        .map(|index| {
            let radius = ring.radius * f64::from(index) / f64::from(CAP_SEGMENTS);
            Place { radius, ..ring }
        })
        .collect()
}

/// Mean radius (m) of the line at this fraction of the height of a folded storey, and its mean turn against
/// the erected storey (rad), both relative to the lower ring. `twist`: of the folded storey, rad.
fn line(pattern: &FoldPattern, radii: [f64; 2], twist: f64, fraction: f64) -> (f64, f64) {
    let panel = 2.0 * PI / f64::from(pattern.design.panels);
    let corner = |radius: f64, angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        Vector2::new(radius * cos, radius * sin)
    };
    let (a, b) = (corner(radii[0], 0.0), corner(radii[0], panel));
    let (d, e) = (corner(radii[1], twist), corner(radii[1], twist + panel));
    let erected = pattern.erected_twist();
    // Where the line crosses AD, AE and BE: folded positions, and polar angles of the erected storey.
    let crossings = [
        (a.lerp(&d, fraction), fraction * erected),
        (a.lerp(&e, fraction), fraction * (erected + panel)),
        (b.lerp(&e, fraction), panel + fraction * erected),
    ];
    let weights = [fraction * pattern.angles.ring_ratio, 1.0 - fraction];
    let (mut radius, mut turn) = (0.0, 0.0);
    for (side, weight) in weights.into_iter().enumerate() {
        let [(from, angle), (to, end)] = [crossings[side], crossings[side + 1]];
        for index in 0..LINE_POINTS {
            let at = (f64::from(index) + 0.5) / f64::from(LINE_POINTS);
            let point = from.lerp(&to, at);
            let difference = libm::atan2(point.y, point.x) - (angle + (end - angle) * at);
            radius += weight * point.norm();
            turn += weight * (difference - 2.0 * PI * libm::rint(difference / (2.0 * PI)));
        }
    }
    let total = (weights[0] + weights[1]) * f64::from(LINE_POINTS);
    (radius / total, turn / total)
}

/// Places of the nodes of the erected capsule, its bottom ring as in [`stowed`].
pub fn erected(pattern: &FoldPattern) -> Vec<Place> {
    let panels = pattern.design.panels;
    let bottom =
        Place { radius: mean_radius(panels, pattern.polygon_radius(0)), turn: 0.0, z: 0.0 };
    let mut places = disc(bottom);
    places.push(bottom);
    let at = |ring: u32| Place {
        radius: pattern.ring_radius(ring),
        turn: 0.0,
        z: pattern.height * pattern.height_fraction(ring),
    };
    for storey in 0..pattern.design.storeys {
        let (lower, upper) = (at(storey), at(storey + 1));
        places.extend((1..=STOREY_SEGMENTS).map(|index| {
            let fraction = f64::from(index) / f64::from(STOREY_SEGMENTS);
            Place {
                radius: lower.radius + (upper.radius - lower.radius) * fraction,
                turn: 0.0,
                z: lower.z + (upper.z - lower.z) * fraction,
            }
        }));
    }
    let top = at(pattern.design.storeys);
    places.extend(disc(top).into_iter().rev());
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::paper;

    fn pattern() -> FoldPattern {
        FoldPattern::new(&paper::design(8)).unwrap()
    }

    #[test]
    fn a_strip_has_its_part_of_the_film() {
        let (pattern, film) = (pattern(), Film::PAPER);
        let strip = Strip::new(&pattern, &film, 1.0);
        let mass: f64 = strip.nodes.iter().map(|node| node.mass).sum::<f64>() * STRIPS as f64;
        // Discs with the mean radius of the caps' N-gons, and the lateral cone instead of its facets.
        let expected = pattern.film_area() * film.area_density();
        assert!((mass / expected - 1.0).abs() < 0.02, "{mass} {expected}");
        assert_eq!(strip.nodes.len(), strip.elements.len() + 1);
        assert!(strip.stable_step > 1e-5 && strip.stable_step < 1e-3);
    }

    #[test]
    fn the_mean_radius_of_an_n_gon_is_that_of_its_sides() {
        let n = 6_u32;
        let (sin, cos) = libm::sincos(PI / f64::from(n));
        let count = 100_000;
        let sum: f64 = (0..count)
            .map(|k| sin * (2.0 * (f64::from(k) + 0.5) / f64::from(count) - 1.0))
            .map(|x| (cos * cos + x * x).sqrt())
            .sum();
        assert!((mean_radius(n, 1.0) - sum / f64::from(count)).abs() < 1e-9);
    }

    #[test]
    fn stowed_and_erected_strips_have_the_heights_of_the_capsule() {
        let pattern = pattern();
        let (stowed, erected) = (stowed(&pattern), erected(&pattern));
        assert_eq!(stowed.len(), erected.len());
        assert_eq!(stowed.len(), Strip::new(&pattern, &Film::PAPER, 1.0).nodes.len());
        let top = |places: &[Place]| places.last().unwrap().z;
        assert!((top(&stowed) - pattern.design.stowed_height).abs() < 1e-15);
        assert!((top(&erected) - pattern.height).abs() < 1e-15);
        // Folded, each storey turns by 53.0° instead of 29.7°.
        let turn = stowed.last().unwrap().turn.to_degrees();
        assert!((turn - 3.0 * (53.0 - 29.7)).abs() < 0.2, "{turn}");
    }
}
