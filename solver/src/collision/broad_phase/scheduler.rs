//! Schedules distance queries: a pair of tree nodes is pending until its two parts may have met.
//!
//! ```text
//! due = b + d        while b is below due, the two parts are still apart
//! ```
//!
//! Symbols: b upper bound of how far two motion clusters have approached each other so far
//! ([`super::clusters`]), m; d lower bound of the distance of two tree nodes in these clusters, m.
//!
//! A due pair is either pushed again with its new distance, or refined into the pairs of its
//! children, down to pairs of leaves. The candidates of due leaves are measured; they are either
//! pushed again or given to the caller. Elements that share a node are never far apart, so they are
//! pending by the deformation around that node ([`super::adjacent`]).

use core::ops::Range;

use nalgebra::Vector3;

use super::adjacent::PendingAdjacentPairs;
use super::clusters::MotionClusters;
use super::collision_mesh::CollisionMesh;
use super::hierarchy::push_child_pairs;
use super::kdop::KDops;
use super::query::{Candidates, PairKind, push_candidates};
use super::queue::PairQueue;
use crate::geometry::field::Field;
use crate::platform::simd::InstructionSet;

/// Two elements, and the queue that they are pending in.
#[derive(Debug, Clone, Copy, PartialEq)]
enum PendingPair {
    /// Two leaves, and the pair of motion clusters that they are in.
    Leaves { leaves: [u32; 2], clusters: usize },
    /// A pair of elements that share a node.
    Adjacent { pair: usize, node: usize },
}

/// Two elements that are due, and the end of their candidates of each kind in the list of all due
/// candidates.
type DuePair = (PendingPair, [usize; 2]);

/// What [`CandidateScheduler::query_within`] looks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProximityQuery {
    /// Largest displacement of any node until the next query, m.
    pub max_displacement: f64,
    /// Distance within which a candidate matters, m.
    pub radius: f64,
    /// Factor on the length for which a pair is pending. It is 1 except in tests that inject a fault.
    pub bound_factor: f64,
}

/// Bins in the queue of a pair of motion clusters; a power of two. Chosen: a pair that is due beyond
/// 32 bins is looked at early, which costs little.
const QUEUE_BINS: usize = 32;

/// Parts of the film of which a fault can leave one out.
const PARTS: usize = 32;

/// Number of candidates after which they are measured, before others are collected. Chosen: large against
/// the cost of a batch, small against the memory of a film.
const MAX_BATCH: usize = 16_384;

/// All candidates of a film, pending until they may have met.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateScheduler {
    instruction_set: InstructionSet,
    clusters: MotionClusters,
    /// Leaves without pairs; only in tests that inject a fault.
    skipped: Range<usize>,
    /// b of each pair of motion clusters since the last restart, m.
    approach_bounds: Vec<f64>,
    /// Pending pairs of tree nodes, one queue per pair of motion clusters.
    queues: Vec<PairQueue>,
    /// Pending pairs of elements that share a node.
    adjacent: PendingAdjacentPairs,
    kdops: KDops,
    // Scratch memory: displacements of the nodes since the last query, m.
    displacements: Vec<Vector3<f64>>,
    // Scratch memory: pairs of tree nodes that are due, their children, and their separations.
    due_nodes: Vec<[u32; 2]>,
    children: Vec<[u32; 2]>,
    separations: Vec<f32>,
    // Scratch memory: pairs of elements that are due, their candidates, and the distances of these.
    due_pairs: Vec<DuePair>,
    candidates: Candidates,
    distances: [Vec<f64>; 2],
}

impl CandidateScheduler {
    /// A scheduler in which every pair is due. No pair of tree nodes is looked at twice while the
    /// film approaches by less than `bin_width` (m).
    pub fn new(mesh: &CollisionMesh, bin_width: f64, instruction_set: InstructionSet) -> Self {
        let clusters = MotionClusters::new(&mesh.hierarchy);
        let pairs = clusters.pairs();
        let mut scheduler = Self {
            instruction_set,
            clusters,
            skipped: 0..0,
            approach_bounds: vec![0.0; pairs],
            queues: vec![PairQueue::new(bin_width, QUEUE_BINS, 0.0); pairs],
            adjacent: PendingAdjacentPairs::new(&mesh.adjacent_pairs),
            kdops: KDops::default(),
            displacements: Vec::new(),
            due_nodes: Vec::new(),
            children: Vec::new(),
            separations: Vec::new(),
            due_pairs: Vec::new(),
            candidates: Candidates::default(),
            distances: <[Vec<f64>; 2]>::default(),
        };
        scheduler.restart();
        scheduler
    }

    /// Leaves out all pairs of one of 32 parts of the film, except of elements that share a node. Only for tests
    /// that inject a fault.
    pub fn skip_part(&mut self, mesh: &CollisionMesh, part: usize) {
        let leaves = mesh.hierarchy.leaves();
        let start = |part: usize| leaves.start + part * leaves.len() / PARTS;
        self.skipped = start(part)..start(part + 1);
    }

    /// Makes every pair due at once, as in a new scheduler.
    pub fn reset(&mut self) {
        self.restart();
        self.adjacent.restart();
    }

    /// Starts again from the pairs of motion clusters; each is due at once. Pairs of elements that
    /// share a node stay pending.
    fn restart(&mut self) {
        self.approach_bounds.fill(0.0);
        self.queues.iter_mut().for_each(|queue| queue.restart(0.0));
        let clusters = self.clusters.tree_nodes();
        for a in clusters.clone() {
            for b in a..clusters.end {
                let pair = [a, b].map(|index| u32::try_from(index).expect("few clusters"));
                self.queues[self.clusters.pair_of(a, b)].push(0.0, pair);
            }
        }
    }

    /// Takes account of a motion of all nodes, without a query.
    pub fn advance(&mut self, mesh: &CollisionMesh, from: &Field, to: &Field) {
        self.displacements.clear();
        self.displacements.extend(to.iter().zip(from.iter()).map(|(to, from)| to - from));
        self.clusters.add_approach_bounds(&self.displacements, &mut self.approach_bounds);
        self.adjacent.add_motion(&mesh.topology.edges, &self.displacements);
    }

    /// Calls `take` with every candidate that can come within `query.radius` of each other until the
    /// next query, and its distance (m). The caller is then responsible for these candidates; they
    /// are pending no longer.
    pub fn query_within(
        &mut self,
        mesh: &CollisionMesh,
        positions: &Field,
        query: ProximityQuery,
        mut distances: impl FnMut(PairKind, &[[u32; 2]], &mut Vec<f64>),
        mut take: impl FnMut(PairKind, [u32; 2], f64),
    ) {
        let ProximityQuery { max_displacement, radius, bound_factor } = query;
        let reach = 2.0 * max_displacement;
        self.refine(mesh, positions, reach, radius, bound_factor, |scheduler| {
            scheduler.measure(&mut distances);
            scheduler.take_due(reach, radius, bound_factor, &mut take);
        });
    }

    /// Gives the due candidates that can come within `radius` (m) while the film approaches by `reach` (m) to
    /// `take`, and makes the other pairs pending again.
    fn take_due(
        &mut self,
        reach: f64,
        radius: f64,
        bound_factor: f64,
        take: &mut impl FnMut(PairKind, [u32; 2], f64),
    ) {
        let mut start = [0; 2];
        let due_pairs = core::mem::take(&mut self.due_pairs);
        for (pair, end) in &due_pairs {
            let of_kind = |kind: usize| &self.distances[kind][start[kind]..end[kind]];
            let smallest =
                of_kind(0).iter().chain(of_kind(1)).copied().fold(f64::INFINITY, f64::min);
            let slack = bound_factor * (smallest - radius);
            if slack > reach {
                // A pair without candidates is never due again.
                if slack == f64::INFINITY {
                    start = *end;
                    continue;
                }
                self.push(*pair, slack);
            } else {
                for (kind, pair_kind) in PairKind::ALL.into_iter().enumerate() {
                    for index in start[kind]..end[kind] {
                        take(pair_kind, self.candidates[kind][index], self.distances[kind][index]);
                    }
                }
            }
            start = *end;
        }
        self.due_pairs = due_pairs;
    }

    /// Makes two elements due after they have approached by `length` (m) more.
    fn push(&mut self, pair: PendingPair, length: f64) {
        match pair {
            PendingPair::Leaves { leaves, clusters } => {
                self.queues[clusters].push(self.approach_bounds[clusters] + length, leaves);
            }
            PendingPair::Adjacent { pair, node } => self.adjacent.push(node, pair, length),
        }
    }

    /// Measures the distances of the due candidates. NaN counts as touching.
    fn measure(&mut self, distances: &mut impl FnMut(PairKind, &[[u32; 2]], &mut Vec<f64>)) {
        for (kind, pair_kind) in PairKind::ALL.into_iter().enumerate() {
            let of_kind = &mut self.distances[kind];
            of_kind.clear();
            distances(pair_kind, &self.candidates[kind], of_kind);
            for distance in of_kind.iter_mut().filter(|distance| distance.is_nan()) {
                *distance = f64::NEG_INFINITY;
            }
        }
    }

    /// Finds the pairs of elements that can come within `radius` (m) of each other while the film
    /// approaches by `reach`, and collects their candidates. Due pairs of tree nodes that stay
    /// farther apart are pushed again; the others are refined into pairs of children.
    ///
    /// Calls `resolve` whenever [`MAX_BATCH`] candidates are collected, and at the end. A batch ends between two
    /// pairs of clusters or two nodes, so each queue gets its pairs in the same order whatever the batches.
    fn refine(
        &mut self,
        mesh: &CollisionMesh,
        positions: &Field,
        reach: f64,
        radius: f64,
        bound_factor: f64,
        mut resolve: impl FnMut(&mut Self),
    ) {
        self.clear_due();
        self.kdops.fit(&mesh.hierarchy, positions);
        for clusters in 0..self.queues.len() {
            self.refine_clusters(mesh, clusters, reach, radius, bound_factor);
            self.resolve_batch(&mut resolve);
        }
        for node in 0..mesh.topology.nodes() {
            let Self { adjacent, due_pairs, candidates, .. } = &mut *self;
            adjacent.pop_due(&mesh.adjacent_pairs, node, reach, |pair, adjacent| {
                for (candidates, adjacent) in candidates.iter_mut().zip(adjacent) {
                    candidates.extend_from_slice(adjacent);
                }
                let ends = [candidates[0].len(), candidates[1].len()];
                due_pairs.push((PendingPair::Adjacent { pair, node }, ends));
            });
            self.resolve_batch(&mut resolve);
        }
        resolve(self);
    }

    /// Calls `resolve` if [`MAX_BATCH`] candidates are collected, and forgets them.
    #[inline]
    fn resolve_batch(&mut self, resolve: &mut impl FnMut(&mut Self)) {
        if self.candidates[0].len() + self.candidates[1].len() > MAX_BATCH {
            resolve(self);
            self.clear_due();
        }
    }

    /// Forgets the due pairs.
    fn clear_due(&mut self) {
        self.due_pairs.clear();
        self.candidates.iter_mut().for_each(Vec::clear);
    }

    /// The part of [`Self::refine`] for one pair of motion clusters.
    fn refine_clusters(
        &mut self,
        mesh: &CollisionMesh,
        clusters: usize,
        reach: f64,
        radius: f64,
        bound_factor: f64,
    ) {
        let Self {
            kdops, due_nodes, children, separations, due_pairs, candidates, skipped, ..
        } = self;
        let (approach, queue) = (self.approach_bounds[clusters], &mut self.queues[clusters]);
        let first_leaf = mesh.hierarchy.first_leaf();
        queue.pop_until(approach + reach, due_nodes);
        // Each pass handles the children of the pass before: one row of the tree for pairs of one row.
        while !due_nodes.is_empty() {
            kdops.separations(self.instruction_set, due_nodes, separations);
            for (pair, separation) in due_nodes.drain(..).zip(&*separations) {
                let [a, b] = pair.map(|index| index as usize);
                if a != b {
                    let slack = bound_factor * (f64::from(*separation) - radius);
                    // A tree node whose leaves are all empty is infinitely far from all others.
                    if slack == f64::INFINITY {
                        continue;
                    }
                    if slack > reach + queue.bin_width {
                        queue.push(approach + slack, pair);
                        continue;
                    }
                }
                if a < first_leaf {
                    push_child_pairs(pair, children);
                } else if !mesh.hierarchy.share_mesh_node(a, b)
                    && !skipped.contains(&a)
                    && !skipped.contains(&b)
                {
                    push_candidates(&mesh.hierarchy, a, b, candidates);
                    let ends = [candidates[0].len(), candidates[1].len()];
                    due_pairs.push((PendingPair::Leaves { leaves: pair, clusters }, ends));
                }
            }
            core::mem::swap(due_nodes, children);
        }
    }
}
