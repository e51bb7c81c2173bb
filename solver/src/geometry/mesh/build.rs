//! Cutting a pattern into elements and placing its nodes.

use core::f64::consts::PI;
use std::collections::HashMap;

use nalgebra::{Vector2, Vector3};

use super::{Mesh, Part, Shape};
use crate::geometry::fold::{Caps, Corner, FoldError, FoldPattern, Polygon};

/// A triangle of the pattern to be cut: a facet of the lateral film or a wedge of a cap.
struct Piece {
    part: Part,
    corners: [Apex; 3],
}

/// A corner of a piece. `Ring` keeps the corner past the seam (corner N) apart for its place in the
/// developed film; as a node it is corner 0.
#[derive(Clone, Copy)]
enum Apex {
    Ring(Corner),
    BottomCentre,
    TopCentre,
}

/// Welding key of a node: its corners (ascending) with their weights in n-ths.
type Key = [(u32, u32); 3];

pub(super) fn mesh(
    pattern: &FoldPattern,
    subdivisions: u32,
    shape: Shape,
) -> Result<Mesh, FoldError> {
    let circular = pattern.design.caps == Caps::Circular;
    if circular && shape != Shape::Erected {
        return Err(FoldError::Invalid {
            key: "caps",
            problem: "circular caps cannot be folded: a disc sewn to a flat-folded N-gon strains; \
                      allowed: polygon"
                .to_owned(),
        });
    }
    let placing = Placing::new(pattern, subdivisions, shape);
    let mut mesh = Mesh {
        positions: Vec::new(),
        triangles: Vec::new(),
        reference: Vec::new(),
        parts: Vec::new(),
        bottom_ring: Vec::new(),
        top_ring: Vec::new(),
        bottom_centre: 0,
        top_centre: 0,
    };
    let mut welded: HashMap<Key, u32> = HashMap::new();
    for piece in &pieces(pattern) {
        let mut node = |weights: [u32; 3]| {
            let key = placing.key(piece, weights);
            let next = u32::try_from(mesh.positions.len()).expect("under 2^32 nodes");
            *welded.entry(key).or_insert_with(|| {
                mesh.positions.push(placing.position(piece, weights, key));
                next
            })
        };
        let n = subdivisions;
        for i in 0..n {
            for j in 0..n - i {
                let at = |i: u32, j: u32| [n - i - j, i, j];
                let mut cut = vec![[at(i, j), at(i + 1, j), at(i, j + 1)]];
                if i + j + 1 < n {
                    cut.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
                for weights in cut {
                    mesh.triangles.push(weights.map(&mut node));
                    mesh.reference.push(weights.map(|weights| placing.reference(piece, weights)));
                    mesh.parts.push(piece.part);
                }
            }
        }
    }
    let ring = |ring: u32| -> Vec<u32> {
        let panels = pattern.design.panels;
        (0..panels * subdivisions)
            .map(|step| {
                let (corner, along) = (step / subdivisions, step % subdivisions);
                let ends = [corner, (corner + 1) % panels].map(|c| ring * panels + c);
                welded[&welding_key([
                    (ends[0], subdivisions - along),
                    (ends[1], along),
                    (u32::MAX, 0),
                ])]
            })
            .collect()
    };
    mesh.bottom_ring = ring(0);
    mesh.top_ring = ring(pattern.design.storeys);
    let centre = |apex| {
        welded[&welding_key([(placing.id(apex), subdivisions), (u32::MAX, 0), (u32::MAX, 0)])]
    };
    mesh.bottom_centre = centre(Apex::BottomCentre);
    mesh.top_centre = centre(Apex::TopCentre);
    Ok(mesh)
}

fn pieces(pattern: &FoldPattern) -> Vec<Piece> {
    let lateral = pattern.facets().into_iter().map(|facet| Piece {
        part: Part::Storey(facet.storey),
        corners: facet.corners.map(Apex::Ring),
    });
    let wedge = |ring: u32, panel: u32| {
        [Corner { ring, corner: panel }, Corner { ring, corner: panel + 1 }].map(Apex::Ring)
    };
    let bottom = (0..pattern.design.panels).map(|panel| {
        let [p, q] = wedge(0, panel);
        Piece { part: Part::BottomCap, corners: [Apex::BottomCentre, q, p] }
    });
    let top = (0..pattern.design.panels).map(|panel| {
        let [p, q] = wedge(pattern.design.storeys, panel);
        Piece { part: Part::TopCap, corners: [Apex::TopCentre, p, q] }
    });
    lateral.chain(bottom).chain(top).collect()
}

fn welding_key(mut weights: Key) -> Key {
    for entry in &mut weights {
        if entry.1 == 0 {
            *entry = (u32::MAX, 0);
        }
    }
    weights.sort_unstable();
    weights
}

/// Where nodes go, and where they come from.
struct Placing<'a> {
    pattern: &'a FoldPattern,
    n: u32,
    /// Ring polygons of a folded shape; `None` for the erected one.
    polygons: Option<Vec<Polygon>>,
    circular: bool,
}

impl<'a> Placing<'a> {
    fn new(pattern: &'a FoldPattern, n: u32, shape: Shape) -> Self {
        let polygons = match shape {
            Shape::Flat => Some(pattern.flat_polygons()),
            Shape::Stowed(height) => Some(pattern.stowed_polygons(height)),
            Shape::Erected => None,
        };
        Self { pattern, n, polygons, circular: pattern.design.caps == Caps::Circular }
    }

    fn id(&self, apex: Apex) -> u32 {
        let (panels, storeys) = (self.pattern.design.panels, self.pattern.design.storeys);
        match apex {
            Apex::Ring(c) => c.ring * panels + c.corner % panels,
            Apex::BottomCentre => panels * (storeys + 1),
            Apex::TopCentre => panels * (storeys + 1) + 1,
        }
    }

    fn key(&self, piece: &Piece, weights: [u32; 3]) -> Key {
        let [a, b, c] = piece.corners.map(|apex| self.id(apex));
        welding_key([(a, weights[0]), (b, weights[1]), (c, weights[2])])
    }

    fn position(&self, piece: &Piece, weights: [u32; 3], key: Key) -> Vector3<f64> {
        match &self.polygons {
            Some(polygons) => self.folded(polygons, key),
            None => self.erected(piece, weights),
        }
    }

    /// Affine in the corners, summed in the order of the key so that both facets of an edge agree.
    fn folded(&self, polygons: &[Polygon], key: Key) -> Vector3<f64> {
        let panels = self.pattern.design.panels;
        key.iter().filter(|(_, weight)| *weight > 0).fold(Vector3::zeros(), |sum, &(id, weight)| {
            let ring = id / panels;
            let place = match polygons.get(ring as usize) {
                Some(polygon) => polygon.corner(id % panels, panels),
                None if id.is_multiple_of(panels) => Vector3::new(0.0, 0.0, polygons[0].z),
                None => Vector3::new(0.0, 0.0, polygons[polygons.len() - 1].z),
            };
            sum + place * (f64::from(weight) / f64::from(self.n))
        })
    }

    fn erected(&self, piece: &Piece, weights: [u32; 3]) -> Vector3<f64> {
        match piece.part {
            Part::Storey(_) => {
                let middle = self.middle(piece);
                self.pattern.roll(self.reference(piece, weights), middle)
            }
            Part::BottomCap | Part::TopCap => self.erected_cap(piece, weights),
        }
    }

    /// A cap node lies on the ray from the cap's centre to the ring point of its share, at its
    /// fraction of the way.
    fn erected_cap(&self, piece: &Piece, weights: [u32; 3]) -> Vector3<f64> {
        let pattern = self.pattern;
        let height = if piece.part == Part::TopCap { pattern.height } else { 0.0 };
        let centre = Vector3::new(0.0, 0.0, height);
        let outward = weights[1] + weights[2];
        let (Apex::Ring(p), Apex::Ring(q)) = (piece.corners[1], piece.corners[2]) else {
            unreachable!("a wedge has its centre first");
        };
        if outward == 0 {
            return centre;
        }
        let share = f64::from(weights[2]) / f64::from(outward);
        let rim = if self.circular {
            let (start, end) = (pattern.erected_angle(p), pattern.erected_angle(q));
            let (sin, cos) = libm::sincos(start + (end - start) * share);
            let radius = pattern.ring_radius(p.ring);
            Vector3::new(radius * cos, radius * sin, height)
        } else {
            let middle = pattern.erected_angle(p);
            let (a, b) = (pattern.developed(p, middle), pattern.developed(q, middle));
            pattern.roll(a + (b - a) * share, middle)
        };
        centre + (rim - centre) * (f64::from(outward) / f64::from(self.n))
    }

    /// The erected polar angle a piece of the lateral film is developed about.
    fn middle(&self, piece: &Piece) -> f64 {
        match piece.corners[0] {
            Apex::Ring(corner) => self.pattern.erected_angle(corner),
            Apex::BottomCentre | Apex::TopCentre => 0.0,
        }
    }

    /// Flat place of a node in the developed film, in coordinates of its own piece.
    fn reference(&self, piece: &Piece, weights: [u32; 3]) -> Vector2<f64> {
        let weights = weights.map(|weight| f64::from(weight) / f64::from(self.n));
        match piece.part {
            Part::Storey(_) => self.lateral_reference(piece, weights),
            Part::BottomCap | Part::TopCap => self.cap_reference(piece, weights),
        }
    }

    fn lateral_reference(&self, piece: &Piece, weights: [f64; 3]) -> Vector2<f64> {
        let pattern = self.pattern;
        let middle = self.middle(piece);
        let corners = piece.corners.map(|apex| match apex {
            Apex::Ring(corner) => corner,
            Apex::BottomCentre | Apex::TopCentre => unreachable!("lateral film has ring corners"),
        });
        if self.circular {
            // Straight in (slant, angle), so that the rings are arcs and neighbours still meet.
            let (mut slant, mut angle) = (0.0, 0.0);
            for (corner, weight) in corners.into_iter().zip(weights) {
                slant += weight * pattern.slant(corner.ring);
                angle += weight * (pattern.erected_angle(corner) - middle);
            }
            return pattern.develop(slant, angle);
        }
        corners
            .into_iter()
            .zip(weights)
            .fold(Vector2::zeros(), |sum, (c, weight)| sum + pattern.developed(c, middle) * weight)
    }

    fn cap_reference(&self, piece: &Piece, weights: [f64; 3]) -> Vector2<f64> {
        let ring = if piece.part == Part::TopCap { self.pattern.design.storeys } else { 0 };
        let wedge = 2.0 * PI / f64::from(self.pattern.design.panels);
        let at = |radius: f64, angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            Vector2::new(radius * cos, radius * sin)
        };
        if self.circular {
            let outward = weights[1] + weights[2];
            let share = if outward > 0.0 { weights[2] / outward } else { 0.0 };
            return at(self.pattern.ring_radius(ring) * outward, wedge * share);
        }
        let radius = self.pattern.polygon_radius(ring);
        at(radius, 0.0) * weights[1] + at(radius, wedge) * weights[2]
    }
}
