//! The parameters of contact, and the distances that they lead to.

use super::broad_phase_fault::BroadPhaseFault;
use super::distance_batch::distances;
use super::pair::{Pair, PairKind};
use crate::collision::broad_phase::collision_mesh::{CollisionMesh, pairs_within_bounds};
use crate::collision::broad_phase::kdop::KDops;
use crate::geometry::field::Field;
use crate::geometry::topology::Topology;
use crate::mechanics::film_model::FilmModel;
use crate::platform::simd::InstructionSet;
use crate::scene::plate::Plate;

/// Parameters of contact; constant during a run.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactModel {
    /// The mesh of the film.
    pub mesh: CollisionMesh,
    /// Contact distance: the largest offset of a node and a feature, m.
    pub distance: f64,
    /// Stiffness k over the mass of the pair: κ ω², 1/s².
    pub stiffness_per_mass: f64,
    /// Mean edge length, m.
    pub edge_length: f64,
    /// Rigid plates.
    pub plates: Vec<Plate>,
    /// Coulomb friction coefficient μ.
    pub friction: f64,
    /// Adhesion.
    pub adhesion: Adhesion,
    /// Mass of the film per area, kg/m².
    pub area_density: f64,
    /// A fault in the search for pairs; `None` except in tests of the monitor.
    pub broad_phase_fault: Option<BroadPhaseFault>,
    /// Instruction set of the distance kernels. Results are the same bits with each.
    pub instruction_set: InstructionSet,
}

/// Adhesion between films: an attraction that grows from zero at the offset to the pull-off pressure
/// in the middle of its range, and falls to zero at the end of the range.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Adhesion {
    /// Pull-off pressure, Pa.
    pub pressure: f64,
    /// Range beyond the offset, m.
    pub range: f64,
}

/// Largest κ = k/(ω² m). Chosen: with [`MAX_ACTIVE_PAIRS`] it leaves steps up to the CFL number
/// 1/√(1 + 3 · 0.8) = 0.54 stable.
const MAX_STIFFNESS_RATIO: f64 = 0.8;

/// Share of a step at a larger CFL number that must stay stable: contact is softened to reach it.
/// Chosen: contact then shortens a step by at most a fifth.
const MIN_STEP_SHARE: f64 = 0.8;

/// Largest number of fully compressed pairs that are assumed to act on one mode at the same time.
/// Chosen: a few, because a pair has its full stiffness only at zero gap.
const MAX_ACTIVE_PAIRS: f64 = 3.0;

/// Default contact distance over the smallest gap of a node and an element at the start. Chosen:
/// well below 1, so that no pair is in contact at the start.
pub const DISTANCE_PER_GAP: f64 = 0.4;

/// Largest default contact distance over the mean edge length. Chosen: in unfolded film the smallest
/// gap is the height of an element, which is far too large for a contact distance.
const MAX_DISTANCE_PER_EDGE: f64 = 0.02;

impl ContactModel {
    /// Contact of a film at `positions` (m), without plates, friction and adhesion.
    ///
    /// `distance` (m) is the contact distance; `None` for the [`default_distance`] of these positions. `ignored`: pairs
    /// of elements without contact.
    pub fn of_film(
        film: &FilmModel,
        positions: &Field,
        distance: Option<f64>,
        ignored: &[[u32; 2]],
        instruction_set: InstructionSet,
    ) -> Self {
        let mut mesh = CollisionMesh::new(film.nodes(), &film.triangles);
        mesh.topology.ignore(ignored);
        let edge_length = mean_edge_length(&mesh, positions);
        let distance =
            distance.unwrap_or_else(|| default_distance(&mesh, positions, MIN_NODES_NEAR));
        let frequency = film.largest_frequency();
        let mut model = Self::new(mesh, distance, frequency, edge_length, instruction_set);
        let area: f64 = film.volume.iter().sum::<f64>() / film.thickness;
        model.area_density = film.mass.iter().sum::<f64>() / area;
        model
    }

    /// Contact at this contact distance (m) of a film with this highest natural frequency ω (rad/s)
    /// and this mean edge length (m), without plates, friction and adhesion.
    pub fn new(
        mesh: CollisionMesh,
        distance: f64,
        frequency: f64,
        edge_length: f64,
        instruction_set: InstructionSet,
    ) -> Self {
        Self {
            mesh,
            distance,
            stiffness_per_mass: MAX_STIFFNESS_RATIO * frequency * frequency,
            edge_length,
            plates: Vec::new(),
            friction: 0.0,
            adhesion: Adhesion::default(),
            area_density: 1.0,
            broad_phase_fault: None,
            instruction_set,
        }
    }

    /// Upper bound of what contact adds to the square of a natural frequency, rad²/s², if at most three
    /// fully compressed pairs act on a mode.
    pub fn added_frequency_squared(&self) -> f64 {
        MAX_ACTIVE_PAIRS * self.stiffness_per_mass
    }

    /// Reduces the stiffness until contact shortens a step of this CFL number by at most a fifth.
    pub fn soften(&mut self, cfl: f64) {
        let step_ratio = 1.0 / (MIN_STEP_SHARE * cfl);
        let allowed = (step_ratio * step_ratio - 1.0) / MAX_ACTIVE_PAIRS;
        self.stiffness_per_mass *= (allowed / MAX_STIFFNESS_RATIO).min(1.0);
    }

    /// Contact distance of a kind of pair, m.
    pub fn distance_of(&self, kind: PairKind) -> f64 {
        match kind {
            PairKind::NodeElement => self.distance,
            PairKind::EdgeEdge => 0.5 * self.distance,
        }
    }

    /// Calls `visit` with every pair closer than `radius` (m) at these positions (m), and its gap (m).
    pub fn pairs_within(&self, positions: &Field, radius: f64, visit: impl FnMut(Pair, f64)) {
        let kinds = if self.has_edge_contacts() { &PairKind::ALL[..] } else { NODE_ELEMENT };
        pairs_within(&self.mesh, positions, radius, kinds, visit);
    }

    /// Factor on all bounds of how far a pair is from contact: 1 without a fault.
    pub fn bound_factor(&self) -> f64 {
        match self.broad_phase_fault {
            Some(BroadPhaseFault::ScaledBounds(factor)) => factor,
            _ => 1.0,
        }
    }

    /// Whether edges can be in contact with edges.
    pub(super) fn has_edge_contacts(&self) -> bool {
        self.broad_phase_fault != Some(BroadPhaseFault::NoEdgeContacts)
    }

    /// Whether pending pairs never come due at this path length (m).
    pub(super) fn queues_stopped(&self, path_length: f64) -> bool {
        match self.broad_phase_fault {
            Some(BroadPhaseFault::StoppedQueues(length)) => path_length > length,
            _ => false,
        }
    }

    /// Appends the gaps (m) of pairs of one kind at these positions (m) to `gaps`. If edges cannot be
    /// in contact, their gaps are infinite.
    pub(super) fn append_gaps(
        &self,
        positions: &Field,
        kind: PairKind,
        pairs: &[[u32; 2]],
        gaps: &mut Vec<f64>,
    ) {
        if kind == PairKind::EdgeEdge && !self.has_edge_contacts() {
            gaps.resize(gaps.len() + pairs.len(), f64::INFINITY);
        } else {
            let (topology, before) = (&self.mesh.topology, gaps.len());
            distances(self.instruction_set, kind, topology, positions, pairs, gaps);
            if topology.has_ignored() {
                for (pair, gap) in pairs.iter().zip(&mut gaps[before..]) {
                    // They never come due.
                    if is_ignored(topology, kind, *pair) {
                        *gap = f64::INFINITY;
                    }
                }
            }
        }
    }
}

/// Whether a pair has no contact.
fn is_ignored(topology: &Topology, kind: PairKind, [first, second]: [u32; 2]) -> bool {
    match kind {
        PairKind::NodeElement => topology.ignores_node(first, second),
        PairKind::EdgeEdge => topology.ignores_edges(first, second),
    }
}

/// Proportion of the nodes that have a gap as small as the smallest that counts, for film from a file. Chosen: one bad spot
/// of a mesh has far fewer, a layer far more.
const MIN_NODES_NEAR: f64 = 0.01;

/// The default contact distance of film at these positions (m), m: 0.4 of the smallest gap of a node and an element up to
/// twice of which this proportion of the nodes, at least one, have theirs; but at most 0.02 of the mean edge length.
/// Pairs that start closer keep their gap as offset.
pub fn default_distance(mesh: &CollisionMesh, positions: &Field, proportion: f64) -> f64 {
    let max_distance = MAX_DISTANCE_PER_EDGE * mean_edge_length(mesh, positions);
    let mut gap_of = vec![f64::INFINITY; mesh.topology.nodes()];
    pairs_within(mesh, positions, max_distance / DISTANCE_PER_GAP, NODE_ELEMENT, |pair, gap| {
        let of_node = &mut gap_of[pair.first as usize];
        *of_node = of_node.min(gap);
    });
    let mut gaps: Vec<f64> = gap_of.iter().copied().filter(|gap| gap.is_finite()).collect();
    gaps.sort_by(f64::total_cmp);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number")]
    let needed = (libm::ceil(proportion * gap_of.len() as f64) as usize).max(1);
    let counts = |gap: &f64| gaps.partition_point(|other| *other <= 2.0 * gap) >= needed;
    let gap = gaps.iter().copied().find(counts).unwrap_or(f64::INFINITY);
    (DISTANCE_PER_GAP * gap).min(max_distance)
}

/// Mean edge length, m.
fn mean_edge_length(mesh: &CollisionMesh, positions: &Field) -> f64 {
    let edges = &mesh.topology.edges;
    let length =
        |[a, b]: &[u32; 2]| (positions.get(*a as usize) - positions.get(*b as usize)).norm();
    edges.iter().map(length).sum::<f64>() / edges.len() as f64
}

/// The pairs of a node and an element alone.
const NODE_ELEMENT: &[PairKind] = &[PairKind::NodeElement];

/// Calls `visit` with every pair of these kinds closer than `radius` (m) at these positions (m), and its gap (m).
fn pairs_within(
    mesh: &CollisionMesh,
    positions: &Field,
    radius: f64,
    kinds: &[PairKind],
    mut visit: impl FnMut(Pair, f64),
) {
    let kdops = KDops::new(&mesh.hierarchy, positions);
    pairs_within_bounds(mesh, &kdops, radius, |kind, [first, second]| {
        if !kinds.contains(&kind) {
            return;
        }
        let pair = Pair { kind, first, second };
        let gap = pair.closest(&positions.at(pair.nodes(&mesh.topology))).squared.sqrt();
        if gap < radius && !is_ignored(&mesh.topology, kind, [first, second]) {
            visit(pair, gap);
        }
    });
}
