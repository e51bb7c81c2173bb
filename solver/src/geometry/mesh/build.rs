//! Subdivides a pattern into elements and computes the node positions.

use core::f64::consts::PI;
use std::collections::HashMap;

use nalgebra::{Vector2, Vector3};

use super::pieces::{Piece, PieceCorner, pieces};
use super::pleats::pleats;
use super::{Mesh, Part, Shape};
use crate::geometry::fold::{Caps, FoldError, FoldPattern, Polygon};

/// Identity of a node: its corners, ascending, each with its barycentric weight times n.
type NodeKey = [(u32, u32); 3];

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
    let placement = NodePlacement::new(pattern, subdivisions, shape);
    let mut mesh = Mesh {
        positions: Vec::new(),
        triangles: Vec::new(),
        reference: Vec::new(),
        parts: Vec::new(),
        facets: Vec::new(),
        bottom_ring: Vec::new(),
        top_ring: Vec::new(),
        bottom_centre: 0,
        top_centre: 0,
        pleats: Vec::new(),
    };
    let mut nodes: HashMap<NodeKey, u32> = HashMap::new();
    let mut facet = 0;
    let pieces = pieces(pattern);
    for (index, piece) in pieces.iter().enumerate() {
        // A cap is one flat sheet of several wedges.
        let same_sheet =
            !matches!(piece.part, Part::Storey(_)) && mesh.parts.last() == Some(&piece.part);
        if index > 0 && !same_sheet {
            facet += 1;
        }
        let mut node = |weights: [u32; 3]| {
            let key = placement.key(piece, weights);
            let next = u32::try_from(mesh.positions.len()).expect("under 2^32 nodes");
            *nodes.entry(key).or_insert_with(|| {
                mesh.positions.push(placement.position(piece, weights, key));
                next
            })
        };
        let n = subdivisions;
        for i in 0..n {
            for j in 0..n - i {
                let corner = |i: u32, j: u32| [n - i - j, i, j];
                let mut elements = vec![[corner(i, j), corner(i + 1, j), corner(i, j + 1)]];
                if i + j + 1 < n {
                    elements.push([corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]);
                }
                for weights in elements {
                    mesh.triangles.push(weights.map(&mut node));
                    mesh.reference.push(weights.map(|weights| placement.reference(piece, weights)));
                    mesh.parts.push(piece.part);
                    mesh.facets.push(facet);
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
                nodes[&node_key([(ends[0], subdivisions - along), (ends[1], along), (u32::MAX, 0)])]
            })
            .collect()
    };
    mesh.bottom_ring = ring(0);
    mesh.top_ring = ring(pattern.design.storeys);
    let centre = |corner| {
        nodes[&node_key([(placement.id(corner), subdivisions), (u32::MAX, 0), (u32::MAX, 0)])]
    };
    mesh.bottom_centre = centre(PieceCorner::BottomCentre);
    mesh.top_centre = centre(PieceCorner::TopCentre);
    mesh.pleats = pleats(pattern, &pieces, &mesh, |corners| {
        let [from, to] = corners.map(|corner| placement.id(corner));
        let node =
            |step| nodes[&node_key([(from, subdivisions - step), (to, step), (u32::MAX, 0)])];
        (0..=subdivisions).map(node).collect()
    });
    Ok(mesh)
}

fn node_key(mut weights: NodeKey) -> NodeKey {
    for entry in &mut weights {
        if entry.1 == 0 {
            *entry = (u32::MAX, 0);
        }
    }
    weights.sort_unstable();
    weights
}

/// Computes the position of each node in a shape, and in the developed film.
struct NodePlacement<'a> {
    pattern: &'a FoldPattern,
    n: u32,
    /// Ring polygons of a folded shape; `None` for the erected shape.
    polygons: Option<Vec<Polygon>>,
    circular: bool,
}

impl<'a> NodePlacement<'a> {
    fn new(pattern: &'a FoldPattern, n: u32, shape: Shape) -> Self {
        let polygons = match shape {
            Shape::Flat => Some(pattern.flat_polygons()),
            Shape::Stowed(height) => Some(pattern.stowed_polygons(height)),
            Shape::Erected => None,
        };
        Self { pattern, n, polygons, circular: pattern.design.caps == Caps::Circular }
    }

    fn id(&self, corner: PieceCorner) -> u32 {
        let (panels, storeys) = (self.pattern.design.panels, self.pattern.design.storeys);
        match corner {
            PieceCorner::Ring(c) => c.ring * panels + c.corner % panels,
            PieceCorner::BottomCentre => panels * (storeys + 1),
            PieceCorner::TopCentre => panels * (storeys + 1) + 1,
        }
    }

    fn key(&self, piece: &Piece, weights: [u32; 3]) -> NodeKey {
        let [a, b, c] = piece.corners.map(|corner| self.id(corner));
        node_key([(a, weights[0]), (b, weights[1]), (c, weights[2])])
    }

    fn position(&self, piece: &Piece, weights: [u32; 3], key: NodeKey) -> Vector3<f64> {
        match &self.polygons {
            Some(polygons) => self.folded(polygons, key),
            None => self.erected(piece, weights),
        }
    }

    /// Affine in the corners. The sum is in the order of the key, so that both facets of an edge give the
    /// same bits.
    fn folded(&self, polygons: &[Polygon], key: NodeKey) -> Vector3<f64> {
        let panels = self.pattern.design.panels;
        key.iter().filter(|(_, weight)| *weight > 0).fold(Vector3::zeros(), |sum, &(id, weight)| {
            let ring = id / panels;
            let position = match polygons.get(ring as usize) {
                Some(polygon) => polygon.corner(id % panels, panels),
                None if id.is_multiple_of(panels) => Vector3::new(0.0, 0.0, polygons[0].z),
                None => Vector3::new(0.0, 0.0, polygons[polygons.len() - 1].z),
            };
            sum + position * (f64::from(weight) / f64::from(self.n))
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

    /// A cap node is on the line from the centre of the cap to a point of the ring, at its barycentric
    /// fraction.
    fn erected_cap(&self, piece: &Piece, weights: [u32; 3]) -> Vector3<f64> {
        let pattern = self.pattern;
        let height = if piece.part == Part::TopCap { pattern.height } else { 0.0 };
        let centre = Vector3::new(0.0, 0.0, height);
        let outward = weights[1] + weights[2];
        let (PieceCorner::Ring(p), PieceCorner::Ring(q)) = (piece.corners[1], piece.corners[2])
        else {
            unreachable!("the first corner of a wedge is the centre");
        };
        if outward == 0 {
            return centre;
        }
        let fraction = f64::from(weights[2]) / f64::from(outward);
        let rim = if self.circular {
            let (start, end) = (pattern.erected_angle(p), pattern.erected_angle(q));
            let (sin, cos) = libm::sincos(start + (end - start) * fraction);
            let radius = pattern.ring_radius(p.ring);
            Vector3::new(radius * cos, radius * sin, height)
        } else {
            let middle = pattern.erected_angle(p);
            let (a, b) = (pattern.developed(p, middle), pattern.developed(q, middle));
            pattern.roll(a + (b - a) * fraction, middle)
        };
        centre + (rim - centre) * (f64::from(outward) / f64::from(self.n))
    }

    /// Polar angle on the erected cone, rad, that has x = 0 in the development of a piece.
    fn middle(&self, piece: &Piece) -> f64 {
        match piece.corners[0] {
            PieceCorner::Ring(corner) => self.pattern.erected_angle(corner),
            PieceCorner::BottomCentre | PieceCorner::TopCentre => 0.0,
        }
    }

    /// Position of a node in the developed film, m, in coordinates of its piece.
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
        let corners = piece.corners.map(|corner| match corner {
            PieceCorner::Ring(corner) => corner,
            PieceCorner::BottomCentre | PieceCorner::TopCentre => {
                unreachable!("all corners of lateral film are on rings")
            }
        });
        if self.circular {
            // Linear in (slant, angle): the rings become arcs, and neighbouring pieces still match.
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
        let polar = |radius: f64, angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            Vector2::new(radius * cos, radius * sin)
        };
        if self.circular {
            let outward = weights[1] + weights[2];
            let fraction = if outward > 0.0 { weights[2] / outward } else { 0.0 };
            return polar(self.pattern.ring_radius(ring) * outward, wedge * fraction);
        }
        let radius = self.pattern.polygon_radius(ring);
        polar(radius, 0.0) * weights[1] + polar(radius, wedge) * weights[2]
    }
}
