//! Which pairs may have come near each other, looked at no more often than they can have moved.
//!
//! ```text
//! due = way + d        film of two zones that came towards each other by less than d since is still apart
//! ```
//!
//! Symbols: way how far two zones of the film have come towards each other so far at most
//! ([`super::clusters`]), m; d distance of two patches of theirs, m, or a lower bound of it. Two patches
//! wait as one until they are due; then they are looked at closer, or taken apart. Elements that share
//! a node are never far apart, and wait by what moves round that node alone ([`super::adjacent`]).

use super::adjacent::PendingAdjacentPairs;
use super::clusters::MotionClusters;
use super::kdop::KDops;
pub use super::query::{CandidateKind, QueryKind};
use super::query::{Pairs, primitives};
use super::queue::PairQueue;
use crate::collision::contact::topology::Topology;
use crate::geometry::field::Field;
use crate::platform::simd::InstructionSet;

/// Where two elements wait.
#[derive(Debug, Clone, Copy, PartialEq)]
enum PendingPair {
    /// Leaves with their pair of zones.
    MotionClusters { pair: [u32; 2], zones: usize },
    /// A pair of a star with the node they share.
    Star { pair: usize, node: usize },
}

/// Two elements, and how many pairs of primitives of each kind there were with them.
type Leaves = (PendingPair, [usize; 2]);

/// How far film may come towards each other now, m.
struct Reach {
    /// Of each pair of zones.
    zones: Vec<f64>,
    /// Round each node.
    stars: Vec<f64>,
}

impl Reach {
    fn of(&self, waiter: PendingPair) -> f64 {
        match waiter {
            PendingPair::MotionClusters { zones, .. } => self.zones[zones],
            PendingPair::Star { node, .. } => self.stars[node],
        }
    }
}

/// Bins of a pair of zones.
const RING: usize = 32;
/// Bins after which all is looked for anew: what came near once and went far away need not be
/// followed leaf by leaf for ever.
const RENEWAL: f64 = 128.0;

/// Every pair of a film, each waiting for its time.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateScheduler {
    sought: QueryKind,
    zones: MotionClusters,
    /// How far each pair of zones has come towards each other so far at most, m.
    ways: Vec<f64>,
    /// Patches waiting, by their pair of zones.
    waiting: Vec<PairQueue>,
    /// Elements that share a node.
    stars: PendingAdjacentPairs,
    width: f64,
    /// Sum of the largest displacements since all was looked for anew, m.
    path: f64,
    boxes: KDops,
    // Room for what is due.
    later: Vec<[u32; 2]>,
    next: Vec<[u32; 2]>,
    apart: Vec<f32>,
    leaves: Vec<Leaves>,
    due: Pairs,
    gaps: [Vec<f64>; 2],
}

impl CandidateScheduler {
    /// A lookout that has looked at nothing yet. `width`: way below which no pair of patches is looked
    /// at twice, m.
    pub fn new(sought: QueryKind, topology: &Topology, width: f64) -> Self {
        let zones = MotionClusters::new(&topology.patches);
        let pairs = zones.pairs();
        let mut lookout = Self {
            sought,
            zones,
            ways: vec![0.0; pairs],
            waiting: vec![PairQueue::new(width, RING, 0.0); pairs],
            stars: PendingAdjacentPairs::new(topology.stars(sought)),
            width,
            path: 0.0,
            boxes: KDops::default(),
            later: Vec::new(),
            next: Vec::new(),
            apart: Vec::new(),
            leaves: Vec::new(),
            due: Pairs::default(),
            gaps: <[Vec<f64>; 2]>::default(),
        };
        lookout.begin();
        lookout
    }

    /// Forgets all: every pair waits for nothing.
    pub fn forget(&mut self) {
        self.begin();
        self.stars.begin();
    }

    /// Has every pair of zones wait for nothing.
    fn begin(&mut self) {
        self.path = 0.0;
        self.ways.fill(0.0);
        self.waiting.iter_mut().for_each(|bins| bins.begin(0.0));
        let zones = self.zones.first()..2 * self.zones.first();
        for one in zones.clone() {
            for two in one..zones.end {
                let pair = [one, two].map(|zone| u32::try_from(zone).expect("few zones"));
                self.waiting[self.zones.pair(one, two)].put(0.0, pair);
            }
        }
    }

    /// The film goes from one place of its nodes to another.
    pub fn travel(&mut self, topology: &Topology, from: &Field, to: &Field) {
        self.path += self.zones.travel(from, to, &mut self.ways);
        self.stars.travel(&topology.edges, from, to);
        self.stars.arrive();
    }

    /// Looks at all pairs that could come together on the straight way from one place of all nodes to
    /// another, and goes there: of those pairs `meet` is told. `gaps`: distances of pairs of one kind at
    /// the first place, m.
    pub fn pass(
        &mut self,
        topology: &Topology,
        [from, to]: [&Field; 2],
        gaps: impl FnMut(CandidateKind, &[[u32; 2]], &mut Vec<f64>),
        meet: impl FnMut(CandidateKind, [u32; 2]),
    ) {
        self.renew();
        let mut reach = self.reach(0.0);
        let largest = self.zones.travel(from, to, &mut reach.zones);
        reach.stars.copy_from_slice(self.stars.travel(&topology.edges, from, to));
        self.look(topology, from, &reach, gaps, meet);
        self.path += largest;
        for (way, reach) in self.ways.iter_mut().zip(reach.zones) {
            *way += reach;
        }
        self.stars.arrive();
    }

    /// The same reach (m) everywhere.
    fn reach(&self, reach: f64) -> Reach {
        Reach { zones: vec![reach; self.ways.len()], stars: vec![reach; self.stars.nodes()] }
    }

    /// Has two elements wait for a length (m) more.
    fn put(&mut self, waiter: PendingPair, length: f64) {
        match waiter {
            PendingPair::MotionClusters { pair, zones } => {
                self.waiting[zones].put(self.ways[zones] + length, pair);
            }
            PendingPair::Star { pair, node } => self.stars.put(node, pair, length),
        }
    }

    /// Looks at all pairs that are together now, at these places (m): of those `meet` is told.
    pub fn now(
        &mut self,
        topology: &Topology,
        places: &Field,
        gaps: impl FnMut(CandidateKind, &[[u32; 2]], &mut Vec<f64>),
        meet: impl FnMut(CandidateKind, [u32; 2]),
    ) {
        self.renew();
        let reach = self.reach(0.0);
        self.look(topology, places, &reach, gaps, meet);
    }

    /// Begins anew, now and then.
    fn renew(&mut self) {
        if self.path > RENEWAL * self.width {
            self.begin();
        }
    }

    /// Tells `meet` of the pairs that come together where film comes towards each other so far.
    fn look(
        &mut self,
        topology: &Topology,
        places: &Field,
        reach: &Reach,
        mut gaps: impl FnMut(CandidateKind, &[[u32; 2]], &mut Vec<f64>),
        mut meet: impl FnMut(CandidateKind, [u32; 2]),
    ) {
        self.take_apart(topology, places, reach, 0.0, 1.0);
        self.ask(&mut gaps);
        let couples = self.sought.couples();
        let mut from = [0; 2];
        let leaves = core::mem::take(&mut self.leaves);
        for (waiter, to) in &leaves {
            let (mut first, reach) = (f64::INFINITY, reach.of(*waiter));
            for kind in 0..2 {
                for at in from[kind]..to[kind] {
                    let gap = self.gaps[kind][at];
                    first = first.min(gap);
                    if gap <= reach
                        && let Some(couple) = couples[kind]
                    {
                        meet(couple, self.due[kind][at]);
                    }
                }
            }
            if first < f64::INFINITY {
                self.put(*waiter, first);
            }
            from = *to;
        }
        self.leaves = leaves;
    }

    /// The pairs of all patches that could come within `keep` (m) of each other while no node moves
    /// farther than `ahead` (m) from these places (m): `take` is told of each, and its distance (m), and
    /// sees to it from then on.
    #[expect(clippy::too_many_arguments, reason = "one pass over what is due")]
    pub fn fetch(
        &mut self,
        topology: &Topology,
        places: &Field,
        ahead: f64,
        keep: f64,
        bounds: f64,
        mut gaps: impl FnMut(CandidateKind, &[[u32; 2]], &mut Vec<f64>),
        mut take: impl FnMut(CandidateKind, [u32; 2], f64),
    ) {
        let reach = 2.0 * ahead;
        self.take_apart(topology, places, &self.reach(reach), keep, bounds);
        self.ask(&mut gaps);
        let couples = self.sought.couples();
        let mut from = [0; 2];
        let leaves = core::mem::take(&mut self.leaves);
        for (waiter, to) in &leaves {
            let of = |kind: usize| &self.gaps[kind][from[kind]..to[kind]];
            let first = of(0).iter().chain(of(1)).copied().fold(f64::INFINITY, f64::min);
            let free = bounds * (first - keep);
            if free > reach {
                // Leaves without pairs of primitives wait for nothing.
                if free == f64::INFINITY {
                    from = *to;
                    continue;
                }
                self.put(*waiter, free);
            } else {
                for kind in 0..2 {
                    let Some(couple) = couples[kind] else { continue };
                    for at in from[kind]..to[kind] {
                        take(couple, self.due[kind][at], self.gaps[kind][at]);
                    }
                }
            }
            from = *to;
        }
        self.leaves = leaves;
    }

    /// Asks how far what is due is apart.
    fn ask(&mut self, gaps: &mut impl FnMut(CandidateKind, &[[u32; 2]], &mut Vec<f64>)) {
        for (kind, couple) in self.sought.couples().into_iter().enumerate() {
            self.gaps[kind].clear();
            if let Some(couple) = couple {
                gaps(couple, &self.due[kind], &mut self.gaps[kind]);
                // What is no number waits for nothing.
                for gap in self.gaps[kind].iter_mut().filter(|gap| gap.is_nan()) {
                    *gap = f64::NEG_INFINITY;
                }
            }
        }
    }

    /// Takes pairs of patches that are due apart until each can wait; the leaves that are left, and
    /// their primitives, are then due.
    fn take_apart(
        &mut self,
        topology: &Topology,
        places: &Field,
        reach: &Reach,
        keep: f64,
        bounds: f64,
    ) {
        self.leaves.clear();
        self.due.iter_mut().for_each(Vec::clear);
        self.boxes.fit(&topology.patches, places);
        let path = InstructionSet::detect();
        let Self { sought, ways, waiting, stars, boxes, due, later, next, apart, leaves, .. } =
            self;
        let first_leaf = topology.patches.leaves();
        for (zones, bins) in waiting.iter_mut().enumerate() {
            let (way, reach) = (ways[zones], reach.zones[zones]);
            bins.take(way + reach, later);
            // Row by row down the tree.
            while !later.is_empty() {
                boxes.separations(path, later, apart);
                for (pair, apart) in later.drain(..).zip(&*apart) {
                    let [a, b] = pair;
                    if a != b {
                        let free = bounds * (f64::from(*apart) - keep);
                        // A place for patches that no patch is in is apart from everything.
                        if free == f64::INFINITY {
                            continue;
                        }
                        if free > reach + bins.width {
                            bins.put(way + free, pair);
                            continue;
                        }
                    }
                    if a as usize >= first_leaf {
                        if !topology.patches.share(a as usize, b as usize) {
                            primitives(*sought, &topology.patches, a as usize, b as usize, due);
                            let waiter = PendingPair::MotionClusters { pair, zones };
                            leaves.push((waiter, [due[0].len(), due[1].len()]));
                        }
                    } else if a == b {
                        next.extend([[2 * a, 2 * a], [2 * a + 1, 2 * a + 1], [2 * a, 2 * a + 1]]);
                    } else {
                        for a in [2 * a, 2 * a + 1] {
                            next.extend([[a, 2 * b], [a, 2 * b + 1]]);
                        }
                    }
                }
                core::mem::swap(later, next);
            }
        }
        stars.take(topology.stars(*sought), &reach.stars, |node, pair, own| {
            for (due, own) in due.iter_mut().zip(own) {
                due.extend_from_slice(own);
            }
            leaves.push((PendingPair::Star { pair, node }, [due[0].len(), due[1].len()]));
        });
    }
}

/// Every pair whose boxes are nearer than `radius` (m).
pub fn nearer(
    sought: QueryKind,
    topology: &Topology,
    boxes: &KDops,
    radius: f64,
    mut found: impl FnMut(CandidateKind, [u32; 2]),
) {
    let leaves = topology.patches.leaves();
    let mut later = vec![[1_usize, 1]];
    let mut pairs = Pairs::default();
    while let Some([one, two]) = later.pop() {
        if one != two && boxes.separation(one, two) > radius {
            continue;
        }
        if one >= leaves {
            primitives(sought, &topology.patches, one, two, &mut pairs);
            for (couple, pairs) in sought.couples().into_iter().zip(&mut pairs) {
                let Some(couple) = couple else { continue };
                for pair in pairs.drain(..) {
                    found(couple, pair);
                }
            }
        } else if one == two {
            later.extend([[2 * one, 2 * one], [2 * one + 1, 2 * one + 1], [2 * one, 2 * one + 1]]);
        } else {
            for one in [2 * one, 2 * one + 1] {
                later.extend([[one, 2 * two], [one, 2 * two + 1]]);
            }
        }
    }
}
