//! The film at full height: a spring and damper that can only pull.
//!
//! ```text
//! k = 2π E t cos³φh (r2 − r1)/(H ln(r2/r1))         cylinder: 2π r E t/H
//! F = k (z − H) + c ż,  never below 0               c = 2ζ √(k m_eff)
//! S = k (z − H)/(2π t cosφh min(r1, r2))            meridional, largest at the smaller ring
//! S = (p − p_ambient) max(r1, r2)/(t cosφh)         hoop, while z ≥ H
//! ```
//!
//! k is the stiffness of a conical membrane in uniaxial tension, as strips in series: an axial force F
//! gives a strip the membrane force F/(2π r cosφh), and the energies of all strips add up to F²/(2k).
//! The hoop stress is the membrane stress of a cone under pressure. Where the damper would push
//! (c ż < −k (z − H)) the force is 0 and the film's strain energy is dissipated. So the end force never
//! pushes, and damping never adds energy.

use std::f64::consts::PI;

use crate::output::measures::design_overpressure;

/// Damping ratio of the end film on the piston's effective mass. Chosen: a piston has one motion, and the
/// energy that leaves it when the film snaps taut goes into waves of the film, which it does not have. The
/// ledger counts what the damper takes as material loss.
pub const END_DAMPING_RATIO: f64 = 0.1;

/// Constants of the end film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndFilm {
    /// H, m: height above which it is taut.
    pub free_length: f64,
    /// k, N/m.
    pub stiffness: f64,
    /// c, N s/m.
    pub damping: f64,
    /// Meridional stress per tension, Pa/N.
    pub meridional_stress: f64,
    /// Hoop stress per overpressure, Pa/Pa.
    pub hoop_stress: f64,
    /// Overpressure of the design shape, Pa.
    pub design_overpressure: f64,
}

/// State of the end film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndState {
    /// z ≤ H: no force.
    Slack,
    /// Spring and damper pull.
    Taut,
    /// Stretched, but it shortens so fast that the damper would push: no force.
    Recoiling,
}

impl EndFilm {
    /// The end film of a cone: `radii` bottom and top (m), height (m), film modulus (Pa), thickness
    /// (m) and damping ratio, on an effective mass (kg).
    pub fn of_cone(
        (bottom, top): (f64, f64),
        height: f64,
        (youngs_modulus, thickness): (f64, f64),
        damping_ratio: f64,
        mass: f64,
    ) -> Self {
        let taper = (bottom - top) / height;
        let cos = 1.0 / (1.0 + taper * taper).sqrt();
        let stiffness =
            2.0 * PI * youngs_modulus * thickness * cos * cos * cos * log_mean(bottom, top)
                / height;
        Self {
            free_length: height,
            stiffness,
            damping: 2.0 * damping_ratio * (stiffness * mass).sqrt(),
            meridional_stress: 1.0 / (2.0 * PI * thickness * cos * bottom.min(top)),
            hoop_stress: bottom.max(top) / (thickness * cos),
            design_overpressure: design_overpressure(
                0.5 * (bottom + top),
                youngs_modulus,
                thickness,
            ),
        }
    }

    /// No end film: a piston with unlimited travel.
    pub fn none() -> Self {
        Self {
            free_length: f64::INFINITY,
            stiffness: 0.0,
            damping: 0.0,
            meridional_stress: 0.0,
            hoop_stress: 0.0,
            design_overpressure: 0.0,
        }
    }

    /// Elastic and viscous part of the force towards H, N, at height z (m) and speed ż (m/s).
    pub fn pull(&self, state: EndState, z: f64, speed: f64) -> (f64, f64) {
        let elastic = self.stiffness * (z - self.free_length);
        match state {
            EndState::Slack => (0.0, 0.0),
            EndState::Taut => (elastic, self.damping * speed),
            EndState::Recoiling => (elastic, -elastic),
        }
    }

    /// Margin of a state, N: positive within the state, 0 at its end.
    pub fn margin(&self, state: EndState, z: f64, speed: f64) -> f64 {
        if self.stiffness == 0.0 {
            return f64::INFINITY;
        }
        let elastic = self.stiffness * (z - self.free_length);
        let pull = elastic + self.damping * speed;
        match state {
            EndState::Slack => -elastic,
            EndState::Taut => pull,
            EndState::Recoiling => elastic.min(-pull),
        }
    }

    /// The state after `state` has ended.
    pub fn next(&self, state: EndState, z: f64, speed: f64) -> EndState {
        let stretched = z > self.free_length;
        match state {
            EndState::Slack => EndState::Taut,
            EndState::Taut if stretched && self.damping * speed < 0.0 => EndState::Recoiling,
            // Recoil ends at one of two edges. Rounding leaves neither margin exactly at 0, so the
            // nearer edge decides.
            EndState::Recoiling if self.recoil_ends_taut(z, speed) => EndState::Taut,
            EndState::Taut | EndState::Recoiling => EndState::Slack,
        }
    }

    /// Whether a recoil that ends here becomes taut, not slack.
    fn recoil_ends_taut(&self, z: f64, speed: f64) -> bool {
        let elastic = self.stiffness * (z - self.free_length);
        -self.margin(EndState::Taut, z, speed) < elastic
    }

    /// The state at height z (m) and speed ż (m/s) without a previous state.
    pub fn state_at(&self, z: f64, speed: f64) -> EndState {
        if z <= self.free_length {
            EndState::Slack
        } else if self.margin(EndState::Taut, z, speed) >= 0.0 {
            EndState::Taut
        } else {
            EndState::Recoiling
        }
    }

    /// Elastic energy, J.
    pub fn strain_energy(&self, z: f64) -> f64 {
        let elongation = self.elongation(z);
        0.5 * self.stiffness * elongation * elongation
    }

    /// Largest principal stress at height z (m) and overpressure (Pa), Pa.
    pub fn stress(&self, z: f64, overpressure: f64) -> f64 {
        let meridional = self.meridional_stress * self.stiffness * self.elongation(z);
        let hoop = if z >= self.free_length { self.hoop_stress * overpressure } else { 0.0 };
        meridional.max(hoop).max(0.0)
    }

    /// Elongation z − H, m; 0 below H.
    fn elongation(&self, z: f64) -> f64 {
        (z - self.free_length).max(0.0)
    }
}

/// Logarithmic mean (a − b)/ln(a/b), accurate as a → b, where it is their common value.
fn log_mean(a: f64, b: f64) -> f64 {
    let excess = (a - b) / b;
    if excess == 0.0 { b } else { b * (excess / libm::log1p(excess)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Film;
    use proptest::prelude::*;

    /// Young's modulus times thickness of the paper's film, N/m.
    const STIFFNESS: f64 = Film::PAPER.youngs_modulus * Film::PAPER.thickness;

    fn film(bottom: f64, top: f64) -> EndFilm {
        let film = Film::PAPER;
        let modulus = (film.youngs_modulus, film.thickness);
        EndFilm::of_cone((bottom, top), 1.0, modulus, END_DAMPING_RATIO, 0.07)
    }

    #[test]
    fn the_stiffness_of_a_cone_tends_to_that_of_a_cylinder() {
        let cylinder = 2.0 * PI * 0.5 * STIFFNESS;
        assert!((film(0.5, 0.5).stiffness / cylinder - 1.0).abs() < 1e-15);
        for gap in [1e-15, 1e-12, 1e-9, 1e-6] {
            let stiffness = film(0.5, 0.5 * (1.0 - gap)).stiffness;
            assert!((stiffness / cylinder - 1.0).abs() < gap, "{gap:e}: {stiffness}");
        }
    }

    #[test]
    fn the_stiffness_of_a_cone_is_that_of_its_strips_in_series() {
        // Energy of a unit axial force, by the midpoint rule over the height.
        let (bottom, top, modulus) = (0.5, 0.2, STIFFNESS);
        let cos = 1.0 / (1.0 + 0.3 * 0.3_f64).sqrt();
        let n = 20_000;
        let compliance: f64 = (0..n)
            .map(|i| {
                let r = bottom + (top - bottom) * (f64::from(i) + 0.5) / f64::from(n);
                let resultant = 1.0 / (2.0 * PI * r * cos);
                resultant * resultant / modulus * 2.0 * PI * r / cos / f64::from(n)
            })
            .sum();
        assert!((film(bottom, top).stiffness * compliance - 1.0).abs() < 1e-8);
        assert!((film(top, bottom).stiffness / film(bottom, top).stiffness - 1.0).abs() < 1e-14);
    }

    proptest! {
        #[test]
        fn the_elastic_pull_is_the_derivative_of_the_energy(
            top in 0.1..0.9_f64,
            z in 0.9..1.1_f64,
        ) {
            let film = film(0.5, top);
            let gap = 1e-7;
            prop_assume!((z - 1.0_f64).abs() > gap);
            let slope = (film.strain_energy(z + gap) - film.strain_energy(z - gap)) / (2.0 * gap);
            let (elastic, _) = film.pull(film.state_at(z, 0.0), z, 0.0);
            prop_assert!((slope - elastic).abs() <= 1e-6 * film.stiffness * 0.1);
        }

        #[test]
        fn the_end_film_never_pushes_and_damping_never_adds_energy(
            z in 0.9..1.1_f64,
            speed in -50.0..50.0_f64,
        ) {
            let film = film(0.5, 0.365);
            let state = film.state_at(z, speed);
            let (elastic, viscous) = film.pull(state, z, speed);
            prop_assert!(elastic + viscous >= 0.0);
            prop_assert!(viscous * speed >= 0.0);
            prop_assert!(film.margin(state, z, speed) >= 0.0);
        }
    }
}
