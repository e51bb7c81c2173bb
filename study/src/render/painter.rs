//! Which of many triangles is drawn over which (painter's order), without cutting any.
//!
//! Where two overlap on the page, the one that is farther there comes first; all such pairs together are
//! an order to be met (Newell, Newell and Sancha). Depths of centroids alone would not do: of two layers
//! of packed film the lower one's near corners are nearer than the upper one's far ones. Triangles
//! that lie over one another in a ring cannot all be right: the farthest of them gives way.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A place on the page.
pub type Place = [f64; 2];

/// A triangle on the page; the larger a depth, the nearer to the eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Its corners.
    pub corners: [Place; 3],
    /// How near each corner is.
    pub depths: [f64; 3],
}

/// Share of the smaller triangle below which two only touch.
const SLIVER: f64 = 1e-6;

impl Patch {
    /// Twice its area on the page, positive when its corners run counter-clockwise.
    fn turn(&self) -> f64 {
        let [a, b, c] = self.corners;
        cross(a, b, c)
    }

    fn centroid(&self) -> f64 {
        self.depths.iter().sum::<f64>() / 3.0
    }

    /// How near it is at a place of the page.
    fn depth(&self, at: Place) -> f64 {
        let [a, b, c] = self.corners;
        let parts = [cross(at, b, c), cross(a, at, c), cross(a, b, at)];
        parts.iter().zip(self.depths).map(|(part, depth)| part * depth).sum::<f64>() / self.turn()
    }

    fn bounds(&self) -> [Place; 2] {
        let [a, b, c] = self.corners;
        let bound =
            |pick: fn(f64, f64) -> f64| [0, 1].map(|axis| pick(pick(a[axis], b[axis]), c[axis]));
        [bound(f64::min), bound(f64::max)]
    }
}

/// Twice the area of a triangle.
fn cross(a: Place, b: Place, c: Place) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Positions of the patches in the order they are drawn, the same each time.
pub fn order(patches: &[Patch]) -> Vec<usize> {
    let mut by_depth: Vec<usize> = (0..patches.len()).collect();
    by_depth.sort_by(|one, other| patches[*one].centroid().total_cmp(&patches[*other].centroid()));
    let mut rank = vec![0; patches.len()];
    for (at, patch) in by_depth.iter().enumerate() {
        rank[*patch] = at;
    }
    // What lies over a patch, and how many lie under it that are not drawn yet.
    let mut over = vec![Vec::new(); patches.len()];
    let mut under = vec![0_usize; patches.len()];
    for_each_near_pair(patches, |one, other| {
        let Some(at) = common(&patches[one], &patches[other]) else { return };
        let (low, high) = match patches[one].depth(at).total_cmp(&patches[other].depth(at)) {
            std::cmp::Ordering::Less => (one, other),
            std::cmp::Ordering::Greater => (other, one),
            std::cmp::Ordering::Equal => return,
        };
        over[low].push(high);
        under[high] += 1;
    });
    let mut drawn = vec![false; patches.len()];
    let mut order = Vec::with_capacity(patches.len());
    let mut free: BinaryHeap<Reverse<usize>> = by_depth
        .iter()
        .filter(|patch| under[**patch] == 0)
        .map(|patch| Reverse(rank[*patch]))
        .collect();
    let mut rest = by_depth.iter();
    while order.len() < patches.len() {
        let next = match free.pop() {
            Some(Reverse(at)) => by_depth[at],
            // A ring.
            None => match rest.find(|patch| !drawn[**patch]) {
                Some(patch) => *patch,
                None => break,
            },
        };
        if drawn[next] {
            continue;
        }
        drawn[next] = true;
        order.push(next);
        for high in &over[next] {
            under[*high] -= 1;
            if under[*high] == 0 && !drawn[*high] {
                free.push(Reverse(rank[*high]));
            }
        }
    }
    order
}

/// Calls for each pair of patches whose bounds overlap, once, the smaller number first. The page is cut
/// into cells about as large as a patch; those seen edge on cover nothing and are left out.
fn for_each_near_pair(patches: &[Patch], mut call: impl FnMut(usize, usize)) {
    let bounds: Vec<[Place; 2]> = patches.iter().map(Patch::bounds).collect();
    let count = patches.len().max(1) as f64;
    let low = [0, 1].map(|axis| bounds.iter().map(|b| b[0][axis]).fold(f64::INFINITY, f64::min));
    let high =
        [0, 1].map(|axis| bounds.iter().map(|b| b[1][axis]).fold(f64::NEG_INFINITY, f64::max));
    let cells = [0, 1].map(|axis| {
        let mean = bounds.iter().map(|b| b[1][axis] - b[0][axis]).sum::<f64>() / count;
        ((high[axis] - low[axis]) / mean).clamp(1.0, 1024.0).floor()
    });
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1024")]
    let cell = |place: Place| {
        [0, 1].map(|axis| {
            let share = (place[axis] - low[axis]) / (high[axis] - low[axis]).max(f64::MIN_POSITIVE);
            (share * cells[axis]).clamp(0.0, cells[axis] - 1.0) as usize
        })
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1024")]
    let [columns, rows] = cells.map(|number| number as usize);
    let mut lists: Vec<Vec<usize>> = vec![Vec::new(); columns * rows];
    for (number, patch) in patches.iter().enumerate() {
        if patch.turn() == 0.0 {
            continue;
        }
        let [from, to] = bounds[number].map(cell);
        for row in from[1]..=to[1] {
            for column in from[0]..=to[0] {
                lists[row * columns + column].push(number);
            }
        }
    }
    for (at, list) in lists.iter().enumerate() {
        for (position, one) in list.iter().enumerate() {
            for other in &list[position + 1..] {
                let [a, b] = [bounds[*one], bounds[*other]];
                let from = [0, 1].map(|axis| a[0][axis].max(b[0][axis]));
                let apart = (0..2).any(|axis| from[axis] >= a[1][axis].min(b[1][axis]));
                // Of the cells both lie in, that of their common corner speaks.
                let [column, row] = cell(from);
                if !apart && row * columns + column == at {
                    call(*one, *other);
                }
            }
        }
    }
}

/// A place in the middle of what two patches cover both; `None` where they cover no more in common than
/// their edges.
fn common(one: &Patch, other: &Patch) -> Option<Place> {
    let mut corners = one.corners.to_vec();
    let [mut a, b, mut c] = other.corners;
    if other.turn() < 0.0 {
        (a, c) = (c, a);
    }
    for [from, to] in [[a, b], [b, c], [c, a]] {
        let side = |place: Place| cross(from, to, place);
        let mut kept = Vec::with_capacity(corners.len() + 1);
        for (at, end) in corners.iter().enumerate() {
            let start = corners[(at + corners.len() - 1) % corners.len()];
            let (s, e) = (side(start), side(*end));
            if (s > 0.0 && e < 0.0) || (s < 0.0 && e > 0.0) {
                let share = s / (s - e);
                kept.push([0, 1].map(|axis| start[axis] + share * (end[axis] - start[axis])));
            }
            if e >= 0.0 {
                kept.push(*end);
            }
        }
        corners = kept;
    }
    let (mut area, mut middle) = (0.0, [0.0; 2]);
    for pair in corners.windows(2).skip(1) {
        let part = cross(corners[0], pair[0], pair[1]);
        area += part;
        for axis in 0..2 {
            middle[axis] += part * (corners[0][axis] + pair[0][axis] + pair[1][axis]) / 3.0;
        }
    }
    let smaller = one.turn().abs().min(other.turn().abs());
    (area.abs() > SLIVER * smaller).then(|| middle.map(|sum| sum / area))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A triangle of a plane that rises by `slope` to the right.
    fn patch(corners: [Place; 3], height: f64, slope: f64) -> Patch {
        Patch { corners, depths: corners.map(|[x, _]| height + slope * x) }
    }

    #[test]
    fn a_lower_layer_stays_below_though_its_middle_is_nearer() {
        // Seen aslant, both layers come nearer downwards; the lower one reaches further down.
        let slanted = |corners: [Place; 3], lift: f64| Patch {
            corners,
            depths: corners.map(|[_, y]| lift - 3.0 * y),
        };
        let lower = slanted([[-2.0, 0.5], [0.0, -4.0], [2.0, 0.5]], 0.0);
        let upper = slanted([[-1.0, 0.0], [1.0, 0.0], [0.0, 2.0]], 0.1);
        assert!(lower.centroid() > upper.centroid());
        assert_eq!(order(&[lower, upper]), [0, 1]);
        assert_eq!(order(&[upper, lower]), [1, 0]);
    }

    #[test]
    fn triangles_that_only_touch_are_free() {
        let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        assert_eq!(common(&patch([a, b, c], 0.0, 0.0), &patch([b, d, c], 0.0, 1.0)), None);
        let middle = common(&patch([a, b, c], 0.0, 0.0), &patch([c, b, a], 1.0, 0.0)).unwrap();
        assert!((middle[0] - 1.0 / 3.0).abs() < 1e-12 && (middle[1] - 1.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_ring_is_drawn_whole() {
        // Three bars, each over the next.
        let bar = |turn: f64, from: f64, to: f64| {
            let (sin, cos) = libm::sincos(turn);
            let place = |x: f64, y: f64| [cos * x - sin * y, sin * x + cos * y];
            Patch {
                corners: [place(-2.0, 0.9), place(2.0, 0.9), place(2.0, 1.1)],
                depths: [from, to, to],
            }
        };
        let third = std::f64::consts::TAU / 3.0;
        let bars = [bar(0.0, 0.0, 1.0), bar(third, 0.0, 1.0), bar(2.0 * third, 0.0, 1.0)];
        let mut drawn = order(&bars);
        assert_eq!(drawn, order(&bars));
        drawn.sort_unstable();
        assert_eq!(drawn, [0, 1, 2]);
    }

    fn covers(patch: &Patch, at: Place) -> bool {
        let [a, b, c] = patch.corners;
        let sides = [cross(a, b, at), cross(b, c, at), cross(c, a, at)];
        let clear = 1e-9 + 1e-3 * patch.turn().abs();
        sides.iter().all(|side| *side > clear) || sides.iter().all(|side| *side < -clear)
    }

    proptest! {
        #[test]
        fn what_is_drawn_last_at_a_place_is_the_nearest_there(
            shapes in prop::collection::vec(
                (prop::array::uniform3(prop::array::uniform2(-1.0..1.0_f64)), 0.02..1.0_f64, prop::array::uniform2(-3.0..3.0_f64)),
                1..40,
            ),
            slope in prop::array::uniform2(-2.0..2.0_f64),
            places in prop::collection::vec(prop::array::uniform2(-3.0..3.0_f64), 60),
        ) {
            // Layers of one slope, of all sizes: none passes through another.
            let layer = |(height, (corners, size, middle)): (usize, &([Place; 3], f64, Place))| {
                let corners = corners.map(|corner| [0, 1].map(|axis| middle[axis] + size * corner[axis]));
                let depth = |[x, y]: Place| 0.03 * height as f64 + slope[0] * x + slope[1] * y;
                Patch { corners, depths: corners.map(depth) }
            };
            let patches: Vec<Patch> = shapes.iter().enumerate().map(layer).collect();
            let order = order(&patches);
            prop_assert_eq!(order.len(), patches.len());
            for at in places {
                let covering: Vec<usize> =
                    order.iter().copied().filter(|number| covers(&patches[*number], at)).collect();
                // Layers are numbered upwards.
                prop_assert!(covering.is_sorted(), "{:?} at {:?}", covering, at);
            }
        }
    }
}
