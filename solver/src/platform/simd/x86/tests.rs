use crate::platform::simd::{InstructionSet, Lanes, Vectors, WIDTH, Wide, dispatch_wide};

/// Every operation on the first eight and the last eight values; results as bits, NaN as 1. The
/// payload of a NaN may differ between instruction sets: no result depends on it.
#[inline(always)]
fn kernel<L: Wide>(values: &[f64], indices: &[u32; WIDTH], out: &mut Vec<u64>) {
    let (a, b) = (L::load(values, 0), L::load(values, WIDTH));
    // SAFETY: the indices of the test are below 16, the number of values.
    let gathered = unsafe { L::gather(values, indices) };
    let results = [
        a + b,
        a - b,
        a * b,
        a * 0.3,
        -a,
        a.over(b),
        a.sqrt(),
        a.max(b),
        b.max(a),
        a.if_positive(b, L::splat(7.0)),
        gathered,
    ];
    for lanes in results {
        for value in lanes.lanes().0 {
            out.push(if value.is_nan() { 1 } else { value.to_bits() });
        }
    }
    let film = Vectors { x: a.max(L::splat(0.0)), y: gathered, z: L::splat(3.0) };
    let normal = Vectors { x: gathered, y: L::splat(5.0), z: a.max(L::splat(0.0)) };
    let rows = L::to_node_sums(&film, &normal);
    for row in &rows {
        for value in row.film.into_iter().chain(row.normal) {
            out.push(if value.is_nan() { 1 } else { value.to_bits() });
        }
    }
    for Vectors { x, y, z } in L::from_node_sums(&rows) {
        for value in [x, y, z].into_iter().flat_map(|column| column.lanes().0) {
            out.push(if value.is_nan() { 1 } else { value.to_bits() });
        }
    }
}
dispatch_wide! { fn run / kernel(values: &[f64], indices: &[u32; WIDTH], out: &mut Vec<u64>) }

#[test]
fn vector_registers_give_the_bits_of_scalar_operations() {
    let special = [0.0, -0.0, f64::NAN, f64::INFINITY, -1.5, 2.5e-310, 3.7, -f64::INFINITY];
    for shift in 0..WIDTH {
        let shifted = (0..WIDTH).map(|lane| special[(lane + shift) % WIDTH]);
        let values: Vec<f64> = special.into_iter().chain(shifted).collect();
        let indices = [3, 15, 0, 9, 9, 1, 12, 6];
        let mut scalar = Vec::new();
        kernel::<Lanes>(&values, &indices, &mut scalar);
        assert_eq!(scalar.len(), 25 * WIDTH);
        for instruction_set in InstructionSet::ALL {
            let mut bits = Vec::new();
            run(instruction_set, &values, &indices, &mut bits);
            assert_eq!(bits, scalar, "{}", instruction_set.name());
        }
    }
}
