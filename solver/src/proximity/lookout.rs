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

/// What a lookout is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sought {
    /// Nodes and elements, edges and edges, that share no node.
    Meetings,
    /// Edges and elements that share no node.
    Piercings,
}

/// A kind of pairs of primitives that share no node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Couple {
    /// A node and an element.
    NodeElement,
    /// Two edges, the lower number first.
    EdgeEdge,
    /// An edge and an element.
    EdgeElement,
}

impl Sought {
    /// The kinds of pairs sought.
    fn couples(self) -> [Option<Couple>; 2] {
        match self {
            Self::Meetings => [Some(Couple::NodeElement), Some(Couple::EdgeEdge)],
            Self::Piercings => [Some(Couple::EdgeElement), None],
        }
    }
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

/// Pairs of primitives, those of one kind apart from those of the other.
type Pairs = [Vec<[u32; 2]>; 2];

/// Two leaves, and how many pairs of primitives of each kind there were with them.
type Leaves = ([u32; 2], [usize; 2]);

/// Every pair of a film, each waiting for its time.
#[derive(Debug, Clone, PartialEq)]
pub struct Lookout {
    sought: Sought,
    patches: Bins,
    pairs: [Bins; 2],
    boxes: Boxes,
    // Room for what is due.
    later: Vec<[u32; 2]>,
    leaves: Vec<Leaves>,
    due: Pairs,
    waits: [Vec<f64>; 2],
}

impl Lookout {
    /// A lookout that has looked at nothing yet, at this path (m). `width`: path below which no pair is
    /// looked at twice, m.
    pub fn new(sought: Sought, width: f64, path: f64) -> Self {
        let bins = || Bins::new(width, path);
        let mut lookout = Self {
            sought,
            patches: bins(),
            pairs: [bins(), bins()],
            boxes: Boxes::default(),
            later: Vec::new(),
            leaves: Vec::new(),
            due: Pairs::default(),
            waits: <[Vec<f64>; 2]>::default(),
        };
        lookout.patches.put(path, [1, 1]);
        lookout
    }

    /// Has a pair of two nodes, elements or edges wait until the path is `due` (m).
    pub fn wait(&mut self, couple: Couple, pair: [u32; 2], due: f64) {
        let at = self.sought.couples().iter().position(|own| *own == Some(couple));
        self.pairs[at.unwrap_or(0)].put(due, pair);
    }

    /// Asks `due` of all pairs that could come nearer than the rule keeps while the path goes from
    /// `path` to `until` (m) how long each may wait (m of path); the film is at these places (m) where
    /// the path is `path`. Of two patches all pairs wait as long as the first of them.
    pub fn pass(
        &mut self,
        topology: &Topology,
        places: &Field,
        [path, until]: [f64; 2],
        rule: &Rule,
        mut due: impl FnMut(Couple, &[[u32; 2]], &mut Vec<f64>),
    ) {
        self.patches_due(topology, places, [path, until], rule);
        self.ask(&mut due);
        let mut from = [0; 2];
        for (pair, to) in &self.leaves {
            let wait = self.first(&from, to);
            if wait < f64::INFINITY {
                self.patches.put(wait, *pair);
            }
            from = *to;
        }
    }

    /// The same, but that pairs of near patches wait each for itself, and whatever is due by `soon` (m)
    /// is told to `take`, who sees to it from then on.
    pub fn fetch(
        &mut self,
        topology: &Topology,
        places: &Field,
        [path, until, soon]: [f64; 3],
        rule: &Rule,
        mut due: impl FnMut(Couple, &[[u32; 2]], &mut Vec<f64>),
        mut take: impl FnMut(Couple, [u32; 2]),
    ) {
        let couples = self.sought.couples();
        let mut sort = |bins: &mut [Bins; 2], kind: usize, pair: [u32; 2], due: f64| {
            if due > soon {
                bins[kind].put(due, pair);
            } else if let Some(couple) = couples[kind] {
                take(couple, pair);
            }
        };
        for kind in 0..2 {
            self.due[kind].clear();
            self.pairs[kind].take(until, &mut self.due[kind]);
        }
        self.ask(&mut due);
        for kind in 0..2 {
            for (pair, wait) in self.due[kind].iter().zip(&self.waits[kind]) {
                sort(&mut self.pairs, kind, *pair, *wait);
            }
        }
        self.patches_due(topology, places, [path, until], rule);
        self.ask(&mut due);
        let calm = until + rule.ahead + self.patches.width;
        let mut from = [0; 2];
        for (pair, to) in &self.leaves {
            let wait = self.first(&from, to);
            if wait > calm {
                if wait < f64::INFINITY {
                    self.patches.put(wait, *pair);
                }
            } else {
                for kind in 0..2 {
                    for at in from[kind]..to[kind] {
                        sort(&mut self.pairs, kind, self.due[kind][at], self.waits[kind][at]);
                    }
                }
            }
            from = *to;
        }
    }

    /// The first due of some pairs of each kind, m.
    fn first(&self, from: &[usize; 2], to: &[usize; 2]) -> f64 {
        let of = |kind: usize| &self.waits[kind][from[kind]..to[kind]];
        of(0).iter().chain(of(1)).copied().fold(f64::INFINITY, f64::min)
    }

    /// Asks how long what is due may wait.
    fn ask(&mut self, due: &mut impl FnMut(Couple, &[[u32; 2]], &mut Vec<f64>)) {
        for (kind, couple) in self.sought.couples().into_iter().enumerate() {
            self.waits[kind].clear();
            if let Some(couple) = couple {
                due(couple, &self.due[kind], &mut self.waits[kind]);
                // What is no number waits for nothing.
                for wait in self.waits[kind].iter_mut().filter(|wait| wait.is_nan()) {
                    *wait = f64::NEG_INFINITY;
                }
            }
        }
    }

    /// Takes pairs of patches that are due apart until each can wait; the leaves that are left, and
    /// their primitives, are then due.
    fn patches_due(
        &mut self,
        topology: &Topology,
        places: &Field,
        [path, until]: [f64; 2],
        rule: &Rule,
    ) {
        let Self { sought, patches, boxes, due, later, leaves, .. } = self;
        leaves.clear();
        due.iter_mut().for_each(Vec::clear);
        if patches.overdue.is_empty() && patches.reached > patches.number(until) {
            return;
        }
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
                primitives(*sought, topology, one, two, due);
                leaves.push(([a, b], [due[0].len(), due[1].len()]));
            } else if one == two {
                later.extend([[2 * a, 2 * a], [2 * a + 1, 2 * a + 1], [2 * a, 2 * a + 1]]);
            } else {
                for a in [2 * a, 2 * a + 1] {
                    later.extend([[a, 2 * b], [a, 2 * b + 1]]);
                }
            }
        }
    }
}

/// Adds the pairs of primitives of two leaves that share no node.
fn primitives(sought: Sought, topology: &Topology, one: usize, two: usize, pairs: &mut Pairs) {
    let patches = &topology.patches;
    let apart = |edge: u32, element: u32| {
        let corners = topology.triangles[element as usize];
        !topology.edges[edge as usize].iter().any(|node| corners.contains(node))
    };
    let [first, second] = pairs;
    let both = [(one, two), (two, one)];
    for (a, b) in both.into_iter().take(if one == two { 1 } else { 2 }) {
        for element in patches.elements(b) {
            match sought {
                Sought::Meetings => {
                    let corners = topology.triangles[*element as usize];
                    let nodes = patches.nodes(a).iter().filter(|node| !corners.contains(node));
                    first.extend(nodes.map(|node| [*node, *element]));
                }
                Sought::Piercings => {
                    let edges = patches.edges(a).iter().filter(|edge| apart(**edge, *element));
                    first.extend(edges.map(|edge| [*edge, *element]));
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
                    second.push([(*edge).min(*other), (*edge).max(*other)]);
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
    mut found: impl FnMut(Couple, [u32; 2]),
) {
    let leaves = topology.patches.leaves();
    let mut later = vec![[1_usize, 1]];
    let mut pairs = Pairs::default();
    while let Some([one, two]) = later.pop() {
        if one != two && boxes.separation(one, two) > radius {
            continue;
        }
        if one >= leaves {
            primitives(sought, topology, one, two, &mut pairs);
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
