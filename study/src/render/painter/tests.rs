//! Drawing orders of layers, cycles and random triangles.

use proptest::prelude::*;

use super::*;

/// A triangle of a plane that rises by `slope` to the right.
fn triangle(corners: [Position; 3], height: f64, slope: f64) -> Triangle {
    Triangle { corners, depths: corners.map(|[x, _]| height + slope * x) }
}

#[test]
fn a_lower_layer_stays_below_even_if_its_centroid_is_nearer() {
    // In an oblique view both layers are nearer at their lower end; the lower layer extends further.
    let slanted = |corners: [Position; 3], lift: f64| Triangle {
        corners,
        depths: corners.map(|[_, y]| lift - 3.0 * y),
    };
    let lower = slanted([[-2.0, 0.5], [0.0, -4.0], [2.0, 0.5]], 0.0);
    let upper = slanted([[-1.0, 0.0], [1.0, 0.0], [0.0, 2.0]], 0.1);
    assert!(lower.centroid_depth() > upper.centroid_depth());
    assert_eq!(order(&[lower, upper]), [0, 1]);
    assert_eq!(order(&[upper, lower]), [1, 0]);
}

#[test]
fn triangles_that_only_touch_have_no_order() {
    let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    assert_eq!(
        common_position(&triangle([a, b, c], 0.0, 0.0), &triangle([b, d, c], 0.0, 1.0)),
        None
    );
    let middle =
        common_position(&triangle([a, b, c], 0.0, 0.0), &triangle([c, b, a], 1.0, 0.0)).unwrap();
    assert!((middle[0] - 1.0 / 3.0).abs() < 1e-12 && (middle[1] - 1.0 / 3.0).abs() < 1e-12);
}

#[test]
fn every_triangle_of_a_cycle_is_drawn() {
    // Three bars, each over the next.
    let bar = |angle: f64, from: f64, to: f64| {
        let (sin, cos) = libm::sincos(angle);
        let position = |x: f64, y: f64| [cos * x - sin * y, sin * x + cos * y];
        Triangle {
            corners: [position(-2.0, 0.9), position(2.0, 0.9), position(2.0, 1.1)],
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

fn covers(triangle: &Triangle, p: Position) -> bool {
    let [a, b, c] = triangle.corners;
    let sides = [cross(a, b, p), cross(b, c, p), cross(c, a, p)];
    let clear = 1e-9 + 1e-3 * triangle.signed_double_area().abs();
    sides.iter().all(|side| *side > clear) || sides.iter().all(|side| *side < -clear)
}

proptest! {
    #[test]
    fn the_last_triangle_drawn_at_a_position_is_the_nearest_there(
        shapes in prop::collection::vec(
            (prop::array::uniform3(prop::array::uniform2(-1.0..1.0_f64)), 0.02..1.0_f64, prop::array::uniform2(-3.0..3.0_f64)),
            1..40,
        ),
        slope in prop::array::uniform2(-2.0..2.0_f64),
        positions in prop::collection::vec(prop::array::uniform2(-3.0..3.0_f64), 60),
    ) {
        // Parallel layers of any size do not intersect.
        let layer = |(height, (corners, size, middle)): (usize, &([Position; 3], f64, Position))| {
            let corners = corners.map(|corner| [0, 1].map(|axis| middle[axis] + size * corner[axis]));
            let depth = |[x, y]: Position| 0.03 * height as f64 + slope[0] * x + slope[1] * y;
            Triangle { corners, depths: corners.map(depth) }
        };
        let triangles: Vec<Triangle> = shapes.iter().enumerate().map(layer).collect();
        let order = order(&triangles);
        prop_assert_eq!(order.len(), triangles.len());
        for position in positions {
            let covering: Vec<usize> =
                order.iter().copied().filter(|number| covers(&triangles[*number], position)).collect();
            // Layers are numbered upwards.
            prop_assert!(covering.is_sorted(), "{:?} at {:?}", covering, position);
        }
    }
}
