//! A linear spring between two nodes: a further energy of film, kept under tests. It shows that the trait
//! [`EnergyTerm`] suffices for an energy that is written outside the solver.
//!
//! ```text
//! d = x_b − x_a     n = d/|d|     Π = ½ k (|d| − L)²     f_a = k (|d| − L) n = −f_b
//! ∂²Π/∂x_a² = k n nᵀ + k (1 − L/|d|)(1 − n nᵀ) = −∂²Π/∂x_a∂x_b
//! ω² ≤ k (1/m_a + 1/m_b)
//! ```

use std::sync::Arc;

use billow_solver::geometry::shapes::{grid, joined, moved, nodes_where};
use billow_solver::mechanics::energy_term::{EnergyTerm, Prepared};

use crate::film_rig::{free, largest_residual, ledgers, moving, unloaded};
use crate::prelude::*;

/// A linear spring between two different nodes.
#[derive(Debug, Clone, Copy)]
pub struct Spring {
    pub nodes: [u32; 2],
    /// k, N/m.
    pub stiffness: f64,
    /// L, m.
    pub rest_length: f64,
}

impl Spring {
    /// ∂²Π/∂x² of the first node, N/m.
    fn block(&self, positions: &Field) -> Matrix3<f64> {
        let between = self.between(positions);
        let length = between.norm();
        let along = between * between.transpose() / (length * length);
        let across = (Matrix3::identity() - along) * (1.0 - self.rest_length / length);
        (along + across) * self.stiffness
    }

    /// Vector from the first node to the second (m).
    fn between(&self, positions: &Field) -> Vector3<f64> {
        let [a, b] = positions.at(self.nodes);
        b - a
    }
}

impl EnergyTerm for Spring {
    fn energy(&self, positions: &Field, _: &[f64]) -> f64 {
        let extension = self.between(positions).norm() - self.rest_length;
        0.5 * self.stiffness * extension * extension
    }

    fn add_forces(&self, positions: &Field, _: &[f64], forces: &mut Field) {
        let between = self.between(positions);
        let length = between.norm();
        let pull = between * (self.stiffness * (length - self.rest_length) / length);
        for (node, force) in self.nodes.into_iter().zip([pull, -pull]) {
            let node = node as usize;
            forces.set(node, forces.get(node) + force);
        }
    }

    fn patches(&self) -> Vec<Vec<u32>> {
        vec![self.nodes.to_vec()]
    }

    fn stiffness(&self, positions: &Field, _: &[f64], patches: &mut [DMatrix<f64>]) {
        let block = self.block(positions);
        for (corners, sign) in [([0, 0], 1.0), ([1, 1], 1.0), ([0, 1], -1.0), ([1, 0], -1.0)] {
            let [i, j] = corners.map(|corner| 3 * corner);
            patches[0].fixed_view_mut::<3, 3>(i, j).copy_from(&(block * sign));
        }
    }

    fn add_product(&self, at: &Prepared<'_>, displacements: &Field, products: &mut Field) {
        let [a, b] = self.nodes.map(|node| node as usize);
        let pull = self.block(at.positions) * (displacements.get(b) - displacements.get(a));
        products.set(a, products.get(a) - pull);
        products.set(b, products.get(b) + pull);
    }

    fn frequency_squared(&self, mass: &[f64]) -> f64 {
        self.nodes.into_iter().map(|node| self.stiffness / mass[node as usize]).sum()
    }
}

/// Distance of the middles of the two pieces, m.
const DISTANCE: f64 = 0.5;
/// Speed of each piece at time 0, m/s.
const SPEED: f64 = 0.05;
/// CFL number of these films.
const CFL: f64 = 0.4;

/// Two flat pieces of film, 0.1 m × 0.1 m and 0.2 m × 0.1 m, in one plane, with their middles at these nodes.
/// The spring (N/m) joins the middles without tension. The pieces move apart.
fn joined_pieces(stiffness: f64) -> (FilmSimulation, [u32; 2]) {
    let half = Vector3::new(0.05, 0.05, 0.0);
    let first = moved(grid(4, 4, 0.1, 0.1), |x| x - half);
    let second = moved(grid(8, 4, 0.2, 0.1), |x| {
        x + Vector3::new(DISTANCE, 0.0, 0.0) - Vector3::new(2.0 * half.x, half.y, 0.0)
    });
    let shell = joined(&[first, second]);
    let middle = |at: f64| {
        let nodes = nodes_where(&shell, |x| (x - Vector3::new(at, 0.0, 0.0)).norm() < 1e-9);
        assert_eq!(nodes.len(), 1);
        nodes[0]
    };
    let nodes = [middle(0.0), middle(DISTANCE)];
    let speed = |x: &Vector3<f64>| if x.x < 0.5 * DISTANCE { -SPEED } else { SPEED };
    let velocities: Vec<_> = shell.positions.iter().map(|x| Vector3::x() * speed(x)).collect();
    let film = Film { compression: 1.0, ..Film::PAPER_ELASTIC };
    let film = moving(&shell, &film, unloaded(), Field::of(&velocities), |system, settings| {
        let spring = Spring { nodes, stiffness, rest_length: DISTANCE };
        system.energy_terms.push(Arc::new(spring));
        settings.cfl = CFL;
    });
    (film, nodes)
}

/// Mass (kg) and centre of mass (m) along x of the two pieces.
fn bodies(film: &FilmSimulation) -> [[f64; 2]; 2] {
    let (system, state) = (film.view().system, film.view().state);
    let mut sums = [[0.0; 2]; 2];
    for (mass, x) in system.model.mass.iter().zip(state.positions.iter()) {
        let [sum, moment] = &mut sums[usize::from(x.x > 0.5 * DISTANCE)];
        *sum += mass;
        *moment += mass * x.x;
    }
    sums.map(|[mass, moment]| [mass, moment / mass])
}

/// Change of the distance of the two centres, m.
fn extension(film: &FilmSimulation) -> f64 {
    let [[_, first], [_, second]] = bodies(film);
    second - first - DISTANCE
}

#[test]
fn two_pieces_on_a_spring_swing_with_the_period_of_two_bodies() {
    let stiffness = 10.0;
    let (mut film, nodes) = joined_pieces(stiffness);
    let [[m1, _], [m2, _]] = bodies(&film);
    let reduced = m1 * m2 / (m1 + m2);
    let frequency = (stiffness / reduced).sqrt();
    let period = 2.0 * std::f64::consts::PI / frequency;
    let largest = 2.0 * SPEED / frequency;
    let (mut series, mut extensions) = (vec![film.view().ledger()], vec![extension(&film)]);
    let samples = 48_u32;
    let (mut crossings, mut peak) = (Vec::new(), 0.0_f64);
    for sample in 1..=samples {
        let at = |sample: u32| 2.2 * period * f64::from(sample) / f64::from(samples);
        film.advance(at(sample), &free()).unwrap();
        let (last, now) = (extensions[extensions.len() - 1], extension(&film));
        // The extension at time 0 is 0 but for rounding: that is no crossing.
        if sample > 1 && (last > 0.0) != (now > 0.0) {
            let part = last / (last - now);
            crossings.push(at(sample - 1) + part * (at(sample) - at(sample - 1)));
        }
        let spring = Spring { nodes, stiffness, rest_length: DISTANCE };
        peak = peak.max(spring.energy(&film.view().state.positions, &[]));
        extensions.push(now);
        series.push(film.view().ledger());
    }
    assert_eq!(crossings.len(), 4, "{crossings:?}");
    let found = crossings[3] - crossings[1];
    assert!((found / period - 1.0).abs() < 1e-3, "{found} {period}");
    let energy = 0.5 * stiffness * largest * largest;
    assert!((peak / energy - 1.0).abs() < 0.01, "{peak} {energy}");
    let residual = largest_residual(&series);
    assert!(residual < 1e-8, "{residual}");
    // The ledger holds the energy of the spring: film alone stores far less.
    let stored = series.iter().map(|ledger| ledger.strain).fold(0.0, f64::max);
    assert!(stored >= peak && stored < 1.05 * peak, "{stored} {peak}");
}

#[test]
fn a_stiff_spring_shortens_the_step() {
    let ((soft, nodes), (mut stiff, _)) = (joined_pieces(10.0), joined_pieces(3e6));
    let model = &stiff.view().system.model;
    let film = model.largest_frequency();
    let added: f64 = nodes.iter().map(|node| 3e6 / model.mass[*node as usize]).sum();
    let (long, short) = (soft.view().next_step(), stiff.view().next_step());
    let expected = CFL * 2.0 / (film * film + added).sqrt();
    assert!(short < 0.5 * long, "{short} {long}");
    assert!((short / expected - 1.0).abs() < 1e-12, "{short} {expected}");
    // Without the bound the step would be unstable.
    assert!(CFL * 2.0 / film * added.sqrt() > 2.0);
    let series = ledgers(&mut stiff, 200.0 * short, 10, &free());
    let steps = stiff.view().steps();
    assert!((200..=210).contains(&steps), "{steps}");
    assert!(largest_residual(&series) < 1e-8, "{}", largest_residual(&series));
}
