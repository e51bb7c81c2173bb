//! Film against film: it is pushed apart, and never passes through itself.
//!
//! ```text
//! pair energy  k (o − d)³/(6 o)  while d < o     force k (o − d)²/(2 o) along the line between closest points
//! k = κ ω² m                                      ω: the film's fastest mode; m: mass of the pair
//! ```
//!
//! Symbols: d distance of a node from a feature of the film (element, edge, node), or of two edges, m;
//! o the pair's offset, m: the contact distance, or the gap it had where it became a pair sideways or
//! was closer from the start, so that becoming a pair creates no energy. The force sets in without a kink:
//! a pair met in the middle of a step costs little accuracy. Its stiffness grows to k at d = 0.
//!
//! - **Adhesion** pulls over a range beyond the offset; **friction** takes tangential motion out of
//!   what is pressed together, at most μ times the force that presses it ([`friction`]).
//! - A node meets a feature where the feature is a nearest part of its neighbourhood: an edge or
//!   node counts only if every element there agrees that it is nearest, and then once. A contact that
//!   slides to a bordering feature keeps offset and stiffness.
//! - Two edges meet where their closest points lie inside both, at half the distance.
//! - **Search.** A pair far off is not looked at again before the largest displacement of any node
//!   could have brought it near; film far off is looked at patch by patch ([`crate::collision::broad_phase`]).
//! - **Guard.** Before nodes move, each near pair is swept along its straight paths. A pair that
//!   would close more than nine tenths of its distance has its approach taken out by an impulse that
//!   keeps momentum; what energy that takes is counted. So no accepted step lets film through.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::geometry::field::Field;
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::InstructionSet;

pub mod candidates;
pub mod ccd;
pub mod collision_response;
pub mod contacts;
pub mod distance;
pub mod distance_batch;
pub mod friction;
pub mod intersections;
pub mod plates;
pub mod pressure;
pub mod separating_planes;
pub mod topology;

use crate::scene::plate::Plate;
use distance::{Closest, point_triangle, segment_segment};
use topology::Topology;

/// The two kinds of pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A node and an element.
    NodeTriangle,
    /// Two edges.
    EdgeEdge,
}

/// Two primitives that may meet: node and element, or two edges, the lower first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Pair {
    /// Kind.
    pub kind: Kind,
    /// Node, or lower edge.
    pub first: u32,
    /// Element, or higher edge.
    pub second: u32,
}

impl Pair {
    /// Its four nodes; the first [`Self::left`] are of the one side.
    #[inline]
    pub fn nodes(self, topology: &Topology) -> [u32; 4] {
        match self.kind {
            Kind::NodeTriangle => {
                let [a, b, c] = topology.triangles[self.second as usize];
                [self.first, a, b, c]
            }
            Kind::EdgeEdge => {
                let [a, b] = topology.edges[self.first as usize];
                let [c, d] = topology.edges[self.second as usize];
                [a, b, c, d]
            }
        }
    }

    /// Nodes of the first side.
    pub fn left(self) -> usize {
        match self.kind {
            Kind::NodeTriangle => 1,
            Kind::EdgeEdge => 2,
        }
    }

    /// Closest points of the pair at these places of its nodes.
    #[inline]
    pub fn closest(self, x: &[Vector3<f64>; 4]) -> Closest {
        match self.kind {
            Kind::NodeTriangle => point_triangle(x),
            Kind::EdgeEdge => segment_segment(x),
        }
    }
}

/// The vectors of four nodes.
#[inline]
pub fn at(field: &Field, nodes: [u32; 4]) -> [Vector3<f64>; 4] {
    nodes.map(|node| field.get(node as usize))
}

/// What contact is made of: constant during a run.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactModel {
    /// What borders on what.
    pub topology: Topology,
    /// Distance at which film is held apart, m.
    pub distance: f64,
    /// k over the mass of the pair: κ ω², 1/s².
    pub stiffness: f64,
    /// Mean edge length, m.
    pub edge_length: f64,
    /// Rigid plates the film lies against.
    pub plates: Vec<Plate>,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Adhesion.
    pub adhesion: Adhesion,
    /// Mass of film per area, kg/m².
    pub area_density: f64,
    /// Whether edges meet edges: `false` in tests of the audit only.
    pub edges: bool,
    /// What displacement bounds are multiplied by: 1 but in tests of the audit.
    pub bounds: f64,
    /// Instruction set; the bits are the same on each.
    pub path: InstructionSet,
}

/// Adhesion of film to film: a pull that grows from nothing at the offset to the pull-off pressure in
/// the middle of its range, and back.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Adhesion {
    /// Pull-off pressure, Pa.
    pub pressure: f64,
    /// Range beyond the offset, m.
    pub range: f64,
}

/// κ at most: with it contact leaves the step of a CFL number up to 0.54 as it is.
const STIFFNESS: f64 = 0.8;
/// Least share of a step that contact leaves.
const STEP_LEFT: f64 = 0.8;
/// How many times the stiffness of one pair may act on a mode.
const AT_ONCE: f64 = 3.0;

/// Share of the smallest gap that is the contact distance where none is given.
pub const OF_GAP: f64 = 0.4;
/// Most of the mean edge length it can be then: in unfolded film the smallest gap is an element's height.
const OF_EDGE: f64 = 0.02;

impl ContactModel {
    /// Contact of a film at these places (m), at this distance (m), or at 0.4 of the smallest gap of a
    /// node and an element, at most a fiftieth of the mean edge length.
    pub fn of_film(
        model: &FilmModel,
        places: &Field,
        distance: Option<f64>,
        instruction_set: InstructionSet,
    ) -> Self {
        let topology = Topology::new(model.nodes(), &model.triangles);
        let length = |[a, b]: &[u32; 2]| (places.get(*a as usize) - places.get(*b as usize)).norm();
        let edge = topology.edges.iter().map(length).sum::<f64>() / topology.edges.len() as f64;
        let mut law = Self::new(topology, OF_EDGE * edge, model.largest_frequency(), edge);
        law.path = instruction_set;
        let area: f64 = model.volume.iter().sum::<f64>() / model.thickness;
        law.area_density = model.mass.iter().sum::<f64>() / area;
        let distance = distance.unwrap_or_else(|| {
            let mut smallest = f64::INFINITY;
            law.pairs_within(places, OF_EDGE * edge / OF_GAP, |pair, gap| {
                if pair.kind == Kind::NodeTriangle {
                    smallest = smallest.min(gap);
                }
            });
            (OF_GAP * smallest).min(OF_EDGE * edge)
        });
        law.distance = distance;
        law
    }

    /// Contact of film of these elements, at this distance (m), whose fastest mode is ω (rad/s) and
    /// whose edges have this mean length (m).
    pub fn new(topology: Topology, distance: f64, frequency: f64, edge: f64) -> Self {
        Self {
            topology,
            distance,
            stiffness: STIFFNESS * frequency * frequency,
            edge_length: edge,
            plates: Vec::new(),
            friction: 0.0,
            adhesion: Adhesion::default(),
            area_density: 1.0,
            edges: true,
            bounds: 1.0,
            path: InstructionSet::detect(),
        }
    }

    /// What contact adds to the square of any mode's frequency at most, where a few pairs at a node are
    /// pressed to the full, rad²/s².
    pub fn frequency_squared(&self) -> f64 {
        AT_ONCE * self.stiffness
    }

    /// Makes contact so soft that it takes at most a fifth of a step of this CFL number.
    pub fn soften(&mut self, cfl: f64) {
        let whole = 1.0 / (STEP_LEFT * cfl);
        let allowed = (whole * whole - 1.0) / AT_ONCE;
        self.stiffness *= (allowed / STIFFNESS).min(1.0);
    }

    /// Distance at which a kind of pair is held apart, m.
    pub fn distance_of(&self, kind: Kind) -> f64 {
        match kind {
            Kind::NodeTriangle => self.distance,
            Kind::EdgeEdge => 0.5 * self.distance,
        }
    }
}

/// A near pair and how far apart it was when last looked at, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CandidatePair {
    /// The pair.
    pub pair: Pair,
    /// Its distance, m.
    pub gap: f64,
}

/// What changes of contact: with places and velocities it says all that follows.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactState {
    /// Sum over the steps of the largest displacement of any node, m.
    pub path: f64,
    /// Contacts now, in order.
    pub contacts: Vec<contacts::Contact>,
    /// What each plate bears.
    pub plates: Vec<plates::Pressed>,
    /// Room for the next contacts.
    #[serde(skip)]
    spare: Vec<contacts::Contact>,
    /// Searches for what is near from nothing so far.
    pub searches: u64,
    /// Approaches taken out so far.
    pub impulses: u64,
    /// Energy they took, J.
    pub taken: f64,
    /// Energy friction took, J.
    pub rubbed: f64,
}
