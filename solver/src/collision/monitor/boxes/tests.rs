//! Tests of the search for overlapping boxes.

use nalgebra::Vector3;
use proptest::prelude::*;

use super::*;

/// All pairs whose boxes overlap, without a search and without rounding.
fn all_pairs(triangles: &[[u32; 3]], frames: &[&Field], reach: f64) -> Vec<[u32; 2]> {
    let ends = |corners: &[u32; 3]| {
        let mut ends = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for frame in frames {
            let shift = mean_displacement(frames[0], frame);
            for node in corners {
                let x = frame.get(*node as usize);
                for axis in 0..3 {
                    ends[0][axis] = ends[0][axis].min(x[axis] - shift[axis] - reach);
                    ends[1][axis] = ends[1][axis].max(x[axis] - shift[axis] + reach);
                }
            }
        }
        ends
    };
    let boxes: Vec<_> = triangles.iter().map(ends).collect();
    let mut pairs = Vec::new();
    for (a, [low, high]) in boxes.iter().enumerate() {
        for (b, [other_low, other_high]) in boxes.iter().enumerate().skip(a + 1) {
            let shared = triangles[a].iter().any(|node| triangles[b].contains(node));
            let overlap = (0..3).all(|k| low[k] <= other_high[k] && other_low[k] <= high[k]);
            if overlap && !shared {
                pairs.push([a, b].map(|index| u32::try_from(index).unwrap()));
            }
        }
    }
    pairs
}

/// Coordinates, some of them with no other values between: flat film, equal nodes, far nodes, NaN.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => -1.0..1.0_f64,
        2 => prop::sample::select(vec![0.0, 0.5, 1e-9, -1e3]),
    ]
}

fn points(nodes: usize) -> impl Strategy<Value = Vec<[f64; 3]>> {
    prop::collection::vec(prop::array::uniform3(coordinate()), nodes)
}

fn check(triangles: &[[u32; 3]], frames: &[&Field], reach: f64) {
    for set in InstructionSet::ALL {
        let mut search = BoxPairs::default();
        // The second search uses memory of the first.
        for _ in 0..2 {
            let mut found = Vec::new();
            let count = search
                .find(set, triangles, frames, reach, usize::MAX, |pairs| {
                    found.extend_from_slice(pairs);
                })
                .unwrap();
            assert_eq!(found.len(), count);
            found.sort_unstable();
            found.dedup();
            assert_eq!(found.len(), count, "a pair twice");
            let missing: Vec<_> = all_pairs(triangles, frames, reach)
                .into_iter()
                .filter(|pair| found.binary_search(pair).is_err())
                .collect();
            assert!(missing.is_empty(), "{missing:?}");
        }
    }
}

fn field(points: &[[f64; 3]], scale: [f64; 3]) -> Field {
    let scaled = |x: &[f64; 3]| Vector3::from(*x).component_mul(&Vector3::from(scale));
    Field::of(&points.iter().map(scaled).collect::<Vec<_>>())
}

proptest! {
    /// Small and large elements in any position, also flat film, film on a line and at a point.
    #[test]
    fn no_pair_of_overlapping_boxes_is_missed(
        triangles in prop::collection::vec(prop::array::uniform3(0..40_u32), 1..60),
        from in points(40),
        to in points(40),
        motion in prop::sample::select(vec![0.0, 0.01, 1.0]),
        size in prop::sample::select(vec![0.0, 0.05, 1.0]),
        scale in prop::array::uniform3(prop::sample::select(vec![0.0, 1e-6, 1.0, 1e6])),
        reach in prop::sample::select(vec![0.0, 0.02, 1.0]),
    ) {
        // Nodes of an element are near its first node if `size` is small.
        let mut points = from.clone();
        for [a, b, c] in &triangles {
            for node in [b, c] {
                for axis in 0..3 {
                    let start = from[*a as usize][axis];
                    points[*node as usize][axis] =
                        start + size * (from[*node as usize][axis] - start);
                }
            }
        }
        let moved: Vec<[f64; 3]> = points
            .iter()
            .zip(&to)
            .map(|(x, y)| core::array::from_fn(|k| x[k] + motion * (y[k] - x[k]) + 3.0))
            .collect();
        let (from, to) = (field(&points, scale), field(&moved, scale));
        check(&triangles, &[&from], reach);
        check(&triangles, &[&from, &to], reach);
    }
}

#[test]
fn positions_without_meaning_neither_stop_nor_panic() {
    let triangles = [[0, 1, 2], [3, 4, 5], [6, 7, 8]];
    let values = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, 0.0];
    for first in values {
        for second in values {
            let mut frame = Field::repeat(first, 9);
            for node in 4..9 {
                frame.set(node, Vector3::new(second, 0.1, first));
            }
            let mut search = BoxPairs::default();
            search.find(InstructionSet::detect(), &triangles, &[&frame, &frame], 0.1, 100, |_| ());
        }
    }
    let find = |triangles: &[[u32; 3]], nodes: usize| {
        let (mut search, frame) = (BoxPairs::default(), Field::zeros(nodes));
        search.find(InstructionSet::detect(), triangles, &[&frame], 0.0, 0, |_| ())
    };
    assert_eq!(find(&[], 0), Some(0));
    assert_eq!(find(&[[0, 1, 2]], 3), Some(0));
}

#[test]
fn pairs_come_in_batches_and_a_search_with_too_many_ends() {
    // Elements of which no two share a node: a hundred at each of nine places.
    let triangles: Vec<[u32; 3]> = (0..900).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let points: Vec<_> = (0..2700)
        .map(|k| {
            Vector3::ith(k % 3, 1.0) * 0.1
                + Vector3::new((k / 900) as f64, (k / 300 % 3) as f64, 0.0)
        })
        .collect();
    let (set, frame) = (InstructionSet::detect(), Field::of(&points));
    let mut search = BoxPairs::default();
    let mut find = |most: usize| {
        let mut batches = Vec::new();
        let found =
            search.find(set, &triangles, &[&frame], 0.0, most, |pairs| batches.push(pairs.len()));
        (found, batches)
    };
    let all = 9 * 100 * 99 / 2;
    let (found, batches) = find(all);
    assert_eq!(found, Some(all));
    assert_eq!(batches.iter().sum::<usize>(), all);
    // It ends in the last cell that has pairs, or in the first.
    let with_pairs: Vec<usize> = batches.into_iter().filter(|pairs| *pairs > 0).collect();
    assert!(with_pairs.len() > 1, "{with_pairs:?}");
    assert_eq!(find(all - 1), (None, with_pairs[..with_pairs.len() - 1].to_vec()));
    assert_eq!(find(1), (None, Vec::new()));
}
