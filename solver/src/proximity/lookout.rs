//! Which pairs may have come near each other, looked at no more often than they can have moved.
//!
//! ```text
//! due = path + (d − keep)/2     two points that each moved by less than (d − keep)/2 are still keep apart
//! ```
//!
//! Symbols: path sum of the largest displacement of any node, step by step, m; d distance of a pair,
//! or a lower bound of it, m. Two patches wait as one until they are due; then they are taken apart,
//! down to pairs of primitives, which wait each for itself. Who looks says for how long.

use super::boxes::Boxes;
use crate::contact::topology::Topology;
use crate::state::Field;

/// stats
pub static STATS: [[std::sync::atomic::AtomicU64; 6]; 4] =
    [const { [const { std::sync::atomic::AtomicU64::new(0) }; 6] }; 4];
/// What a lookout is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sought {
    /// Nodes and elements, edges and edges, that share no node.
    Meetings,
    /// Edges and elements that share no node.
    Piercings,
}

/// A pair of primitives that share no node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Candidate {
    /// A node and an element.
    NodeElement(u32, u32),
    /// Two edges, the lower number first.
    EdgeEdge(u32, u32),
    /// An edge and an element.
    EdgeElement(u32, u32),
}

/// How long pairs may wait.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rule {
    /// Distance pairs must not come nearer than unseen, m.
    pub keep: f64,
    /// What displacement bounds are multiplied by: 1 but in tests of the audit.
    pub bounds: f64,
    /// Patches that are due within so much more path are looked at as well, m.
    pub ahead: f64,
}

/// Things waiting for the path to reach their number, in bins.
#[derive(Debug, Clone, PartialEq, Default)]
struct Bins {
    /// Path of a bin, m.
    width: f64,
    /// First bin not taken yet, counted from path 0.
    reached: u64,
    /// A ring of bins; what is due beyond its end waits in the last.
    ring: Vec<Vec<[u32; 2]>>,
    /// What was put into a bin taken already.
    overdue: Vec<[u32; 2]>,
}

/// Bins of a ring.
const RING: usize = 1024;

impl Bins {
    fn new(width: f64, path: f64) -> Self {
        let ring = vec![Vec::new(); RING];
        let mut bins = Self { width, reached: 0, ring, overdue: Vec::new() };
        bins.reached = bins.number(path);
        bins
    }

    /// The bin of a path (m); the first where it is past, or no number.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    fn number(&self, path: f64) -> u64 {
        (path / self.width) as u64
    }

    fn put(&mut self, due: f64, pair: [u32; 2]) {
        let bin = self.number(due).min(self.reached + (RING as u64 - 1));
        if bin < self.reached {
            self.overdue.push(pair);
        } else {
            self.ring[place(bin)].push(pair);
        }
    }

    /// Moves to `due` what is due until then (m).
    fn take(&mut self, until: f64, due: &mut Vec<[u32; 2]>) {
        due.append(&mut self.overdue);
        let last = self.number(until);
        // One round empties the ring.
        for _ in 0..RING {
            if self.reached > last {
                return;
            }
            due.append(&mut self.ring[place(self.reached)]);
            self.reached += 1;
        }
        self.reached = self.reached.max(last + 1);
    }
}

#[expect(clippy::cast_possible_truncation, reason = "below the length of the ring")]
fn place(bin: u64) -> usize {
    (bin % RING as u64) as usize
}

/// Kind of a pair of primitives, in the upper bits of its first number.
const EDGES: u32 = 1 << 30;
const PIERCING: u32 = 2 << 30;
const NUMBER: u32 = EDGES - 1;

/// Every pair of a film, each waiting for its time.
#[derive(Debug, Clone, PartialEq)]
pub struct Lookout {
    sought: Sought,
    patches: Bins,
    pairs: Bins,
    boxes: Boxes,
    /// Room for what is due.
    due: Vec<[u32; 2]>,
    later: Vec<[u32; 2]>,
}

impl Lookout {
    /// A lookout that has looked at nothing yet, at this path (m). `width`: path below which no pair is
    /// looked at twice, m.
    ///
    /// # Panics
    /// For film of 2^30 elements or more.
    pub fn new(sought: Sought, topology: &Topology, width: f64, path: f64) -> Self {
        assert!(topology.edges.len() < NUMBER as usize, "under 2^30 edges");
        let mut lookout = Self {
            sought,
            patches: Bins::new(width, path),
            pairs: Bins::new(width, path),
            boxes: Boxes::default(),
            due: Vec::new(),
            later: Vec::new(),
        };
        lookout.patches.put(path, [1, 1]);
        lookout
    }

    /// Has a pair wait until the path is `due` (m).
    pub fn wait(&mut self, candidate: Candidate, due: f64) {
        let pair = match candidate {
            Candidate::NodeElement(node, element) => [node, element],
            Candidate::EdgeEdge(edge, other) => [edge | EDGES, other],
            Candidate::EdgeElement(edge, element) => [edge | PIERCING, element],
        };
        self.pairs.put(due, pair);
    }

    /// Asks `due` of every pair that could come nearer than the rule keeps while the path goes from
    /// `path` to `until` (m) how long it may wait (m of path); the film is at these places (m) where the
    /// path is `path`. Of two patches all pairs wait as long as the first of them.
    pub fn pass(
        &mut self,
        topology: &Topology,
        places: &Field,
        [path, until]: [f64; 2],
        rule: &Rule,
        mut due: impl FnMut(Candidate) -> f64,
    ) {
        self.patches_due(topology, places, [path, until], rule, |patches, pair, primitives| {
            // Written so that what is no number waits for nothing.
            let first = |a: f64, b: f64| if a < b { a } else { b };
            let wait = primitives.iter().map(|own| due(candidate(*own))).fold(f64::INFINITY, first);
            if wait < f64::INFINITY {
                patches.put(wait, pair);
            }
        });
    }

    /// The same, but that pairs of near patches wait each for itself, and whatever is due by `soon` (m)
    /// is told to `take`, who sees to it from then on.
    pub fn fetch(
        &mut self,
        topology: &Topology,
        places: &Field,
        [path, until, soon]: [f64; 3],
        rule: &Rule,
        mut due: impl FnMut(Candidate) -> f64,
        mut take: impl FnMut(Candidate),
    ) {
        let mut sort = |pairs: &mut Bins, pair: [u32; 2], due: f64| {
            // Written so that what is no number is taken.
            if due > soon { pairs.put(due, pair) } else { take(candidate(pair)) }
        };
        let mut all = core::mem::take(&mut self.due);
        self.pairs.take(until, &mut all);
        for pair in all.drain(..) {
            sort(&mut self.pairs, pair, due(candidate(pair)));
        }
        self.due = all;
        let mut singles = core::mem::take(&mut self.pairs);
        let mut waits = Vec::new();
        self.patches_due(topology, places, [path, until], rule, |patches, pair, primitives| {
            waits.clear();
            waits.extend(primitives.iter().map(|own| due(candidate(*own))));
            let calm = until + rule.ahead + patches.width;
            if waits.iter().all(|wait| *wait > calm) {
                let first = waits.iter().copied().fold(f64::INFINITY, f64::min);
                if first < f64::INFINITY {
                    patches.put(first, pair);
                }
            } else {
                for (own, wait) in primitives.iter().zip(&waits) {
                    sort(&mut singles, *own, *wait);
                }
            }
        });
        self.pairs = singles;
    }

    /// Takes pairs of patches that are due apart until each can wait; `leaves` is told of every pair of
    /// leaves left, and its primitives.
    fn patches_due(
        &mut self,
        topology: &Topology,
        places: &Field,
        [path, until]: [f64; 2],
        rule: &Rule,
        mut leaves: impl FnMut(&mut Bins, [u32; 2], &[[u32; 2]]),
    ) {
        if self.patches.overdue.is_empty() && self.patches.reached > self.patches.number(until) {
            return;
        }
        let Self { sought, patches, boxes, due, later, .. } = self;
        patches.take(until + rule.ahead, later);
        if later.is_empty() {
            return;
        }
        boxes.fit(&topology.patches, places);
        let first_leaf = topology.patches.leaves();
        while let Some([a, b]) = later.pop() {
            let (one, two) = (a as usize, b as usize);
            if one != two {
                let free = boxes.separation(one, two) - rule.keep;
                // A place for patches that no patch is in is apart from everything.
                if free == f64::INFINITY {
                    continue;
                }
                let wait = path + 0.5 * rule.bounds * free;
                // Never into a bin taken already: patches are looked at by whole bins.
                if wait > until + rule.ahead + patches.width {
                    patches.put(wait, [a, b]);
                    continue;
                }
            }
            if one >= first_leaf {
                due.clear();
                primitives(*sought, topology, one, two, due);
                leaves(patches, [a, b], due);
            } else if one == two {
                later.extend([[2 * a, 2 * a], [2 * a + 1, 2 * a + 1], [2 * a, 2 * a + 1]]);
            } else {
                for a in [2 * a, 2 * a + 1] {
                    later.extend([[a, 2 * b], [a, 2 * b + 1]]);
                }
            }
        }
        due.clear();
    }
}

fn candidate([first, second]: [u32; 2]) -> Candidate {
    let number = first & NUMBER;
    match first & !NUMBER {
        EDGES => Candidate::EdgeEdge(number, second),
        PIERCING => Candidate::EdgeElement(number, second),
        _ => Candidate::NodeElement(number, second),
    }
}

/// Adds the pairs of primitives of two leaves that share no node.
fn primitives(
    sought: Sought,
    topology: &Topology,
    one: usize,
    two: usize,
    pairs: &mut Vec<[u32; 2]>,
) {
    let patches = &topology.patches;
    let apart = |edge: u32, element: u32| {
        let corners = topology.triangles[element as usize];
        !topology.edges[edge as usize].iter().any(|node| corners.contains(node))
    };
    let both = [(one, two), (two, one)];
    for (a, b) in both.into_iter().take(if one == two { 1 } else { 2 }) {
        for element in patches.elements(b) {
            match sought {
                Sought::Meetings => {
                    let corners = topology.triangles[*element as usize];
                    let nodes = patches.nodes(a).iter().filter(|node| !corners.contains(node));
                    pairs.extend(nodes.map(|node| [*node, *element]));
                }
                Sought::Piercings => {
                    let edges = patches.edges(a).iter().filter(|edge| apart(**edge, *element));
                    pairs.extend(edges.map(|edge| [*edge | PIERCING, *element]));
                }
            }
        }
    }
    if sought == Sought::Meetings {
        for (at, edge) in patches.edges(one).iter().enumerate() {
            let [p, q] = topology.edges[*edge as usize];
            let others =
                if one == two { &patches.edges(two)[at + 1..] } else { patches.edges(two) };
            for other in others {
                let [r, s] = topology.edges[*other as usize];
                if p != r && p != s && q != r && q != s {
                    pairs.push([(*edge).min(*other) | EDGES, (*edge).max(*other)]);
                }
            }
        }
    }
}

/// Every pair whose boxes are nearer than `radius` (m).
pub fn nearer(
    sought: Sought,
    topology: &Topology,
    boxes: &Boxes,
    radius: f64,
    mut found: impl FnMut(Candidate),
) {
    let leaves = topology.patches.leaves();
    let mut later = vec![[1_usize, 1]];
    let mut pairs = Vec::new();
    while let Some([one, two]) = later.pop() {
        if one != two && boxes.separation(one, two) > radius {
            continue;
        }
        if one >= leaves {
            primitives(sought, topology, one, two, &mut pairs);
            pairs.drain(..).for_each(|pair| found(candidate(pair)));
        } else if one == two {
            later.extend([[2 * one, 2 * one], [2 * one + 1, 2 * one + 1], [2 * one, 2 * one + 1]]);
        } else {
            for one in [2 * one, 2 * one + 1] {
                later.extend([[one, 2 * two], [one, 2 * two + 1]]);
            }
        }
    }
}
