//! The sparse Cholesky factorisation of billow beside that of faer, on the same matrices: `cargo bench`.
//!
//! ```text
//! statics     K + μ ω² M      the erected capsule in equilibrium, 100 Pa
//! implicit    K + w M         the stowed capsule, steps of 1 ms
//! ```
//!
//! The paper's capsule at n 8 and 16. The order of elimination and everything that depends on the pattern alone are
//! computed once. Both run on one thread. First the bits of the solutions are compared, then times are measured.

use std::hint::black_box;
use std::time::Duration;

use billow_solver::platform::simd::InstructionSet;
use criterion::Criterion;

mod film_matrix;
mod peer;

use film_matrix::FilmMatrix;
use peer::{Order, Peer};

/// 64 bits that differ where bits of a solution differ (FNV-1a).
fn hash(solution: &[f64]) -> u64 {
    let bytes = solution.iter().flat_map(|value| value.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// Prints fill, error and bits of every solution of a matrix.
fn compare(name: &str, matrix: &mut FilmMatrix, peers: &mut [Peer]) {
    let forces = matrix.forces();
    println!(
        "{name}: {} unknowns, {} entries below the diagonal",
        forces.len(),
        matrix.below_diagonal()
    );
    println!("  bits of the matrix {:016x}", hash(&matrix.values()));
    let fill = matrix.fill();
    println!("  billow: {} entries of L, {} stored", fill.entries, fill.stored);
    for set in InstructionSet::ALL.into_iter().filter(|set| set.available()) {
        assert!(matrix.factor(set));
        let solution = matrix.solve(set, &forces);
        let (error, bits) = (matrix.error(&solution, &forces), hash(&solution));
        println!("  billow, {}: residual {error:.1e}, bits {bits:016x}", set.name());
    }
    let values = matrix.values();
    for peer in peers {
        println!("  faer, {}: {} stored", peer.name, peer.stored());
        for threads in [1, 2] {
            peer.threads(threads);
            peer.factor(&values);
            let solution = peer.solve(&forces);
            let (error, bits) = (matrix.error(&solution, &forces), hash(&solution));
            println!(
                "  faer, {}, threads {threads}: residual {error:.1e}, bits {bits:016x}",
                peer.name
            );
        }
        peer.threads(1);
    }
}

fn measure(criterion: &mut Criterion, name: &str, mut matrix: FilmMatrix) {
    let mut peers = Order::ALL.map(|order| Peer::new(&matrix, order));
    compare(name, &mut matrix, &mut peers);
    let (forces, values) = (matrix.forces(), matrix.values());
    let mut group = criterion.benchmark_group(name);
    for set in InstructionSet::ALL.into_iter().filter(|set| set.available()) {
        group.bench_function(format!("billow, {}: assemble and factor", set.name()), |bencher| {
            bencher.iter(|| black_box(matrix.factor(set)));
        });
        group.bench_function(format!("billow, {}: solve", set.name()), |bencher| {
            bencher.iter(|| black_box(matrix.solve(set, &forces)));
        });
    }
    group.bench_function("faer: assemble", |bencher| bencher.iter(|| black_box(matrix.values())));
    for peer in &mut peers {
        group.bench_function(format!("faer, {}: factor", peer.name), |bencher| {
            bencher.iter(|| peer.factor(black_box(&values)));
        });
        group.bench_function(format!("faer, {}: solve", peer.name), |bencher| {
            bencher.iter(|| black_box(peer.solve(&forces)));
        });
    }
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default()
        .sample_size(15)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .configure_from_args();
    for subdivisions in [8, 16] {
        measure(
            &mut criterion,
            &format!("statics n {subdivisions}"),
            FilmMatrix::statics(subdivisions),
        );
        measure(
            &mut criterion,
            &format!("implicit n {subdivisions}"),
            FilmMatrix::implicit(subdivisions),
        );
    }
    criterion.final_summary();
}
