//! A strip folded once, its arm B in motion along its arm A: the scene of [`super::moving_fold`].

use core::f64::consts::PI;

use billow_solver::geometry::shapes::{crossed_grid, moved, pseudo_random};
use billow_solver::integrators::FilmView;
use billow_solver::scene::Film;
use billow_solver::scene::film_scene::{FilmContact, FilmScene};
use billow_solver::scene::paper::free_film;
use nalgebra::Vector3;

use super::reference::number;
use super::rig::held;

/// Material of the strip.
pub const FILM: Film = Film::PAPER;
/// Length of an arm over the width of the strip.
const ASPECT: u32 = 5;
/// Largest coefficient of a mode of the perturbation, m. Chosen: all modes together stay below the
/// contact distance and strain the film by less than 1e-5.
const AMPLITUDE: f64 = 2e-5;
/// Number of modes of the perturbation along the strip.
const MODES: usize = 4;

/// A length (m) or speed (m/s) of the scene.
pub fn size(name: &str) -> f64 {
    number(&format!("moving_fold/{name}"))
}

/// A strip of square cells.
#[derive(Debug, Clone, Copy)]
pub struct Strip {
    /// Cells along one arm, a multiple of the aspect ratio of an arm.
    pub cells: u32,
}

impl Strip {
    /// Nodes along the strip.
    pub fn columns(self) -> u32 {
        2 * self.cells + 1
    }

    /// Cells across the strip.
    fn rows(self) -> u32 {
        self.cells / ASPECT
    }

    /// Width of the strip, m.
    pub fn width() -> f64 {
        size("arm") / f64::from(ASPECT)
    }

    /// Nodes across the strip in a column: 0 is the fixed end, the last the free one.
    pub fn nodes(self, column: u32) -> Vec<u32> {
        (0..=self.rows()).map(|row| row * self.columns() + column).collect()
    }

    /// The strip at time 0, with the perturbation of a seed. Over the length of the ramp behind the fold,
    /// the film rises from arm A to arm B without strain, and its speed rises from 0 to v0.
    pub fn scene(self, seed: u64) -> FilmScene {
        let [arm, gap, ramp, speed] = ["arm", "gap", "ramp", "speed"].map(size);
        let width = Self::width();
        let flat = crossed_grid(self.columns() - 1, self.rows(), 2.0 * arm, width);
        let rise = |s: f64| ((s - arm) / ramp).clamp(0.0, 1.0);
        let velocities = flat.positions.iter().map(|x| Vector3::x() * (speed * rise(x.x)));
        let velocities = velocities.collect();
        let modes = pseudo_random(MODES, seed);
        // Out of the plane, symmetric and antisymmetric across the strip, zero at both ends.
        let perturbation = |s: f64, y: f64| -> f64 {
            let mode = |(k, mode): (u32, &Vector3<f64>)| {
                let along = libm::sin(f64::from(k) * PI * s / (2.0 * arm));
                AMPLITUDE * along * (mode.x + mode.y * (2.0 * y / width - 1.0))
            };
            (1..).zip(&modes).map(mode).sum()
        };
        let shortening = ramp - (ramp * ramp - gap * gap).sqrt();
        let shell = moved(flat, |x| {
            let (s, y) = (x.x, x.y);
            let folded = if s <= arm { s } else { 2.0 * arm - s + shortening * rise(s) };
            Vector3::new(folded, y, gap * rise(s) + perturbation(s, y))
        });
        let contact =
            FilmContact { distance: Some(size("contact_distance")), ..FilmContact::default() };
        FilmScene {
            velocities,
            supports: vec![held(self.nodes(0), "xyz")],
            contact: Some(contact),
            ..free_film(shell, FILM)
        }
    }

    /// Kinetic energy of arm B as one body, J: of the columns from the free end on whose mean speed along
    /// the strip is at least half that of the end.
    pub fn body_energy(self, film: &FilmView<'_>) -> f64 {
        let velocities = &film.state.velocities;
        let column = |column: u32| {
            let nodes = self.nodes(column).into_iter().map(|node| node as usize);
            nodes.fold([0.0, 0.0], |[mass, momentum], node| {
                let added = film.system.model.mass[node];
                [mass + added, momentum + added * velocities.x[node]]
            })
        };
        let [mut mass, mut momentum] = column(self.columns() - 1);
        let least = 0.5 * momentum / mass;
        for [added, gained] in (0..self.columns() - 1).rev().map(column) {
            if gained < least * added {
                break;
            }
            mass += added;
            momentum += gained;
        }
        0.5 * momentum * momentum / mass
    }
}

#[cfg(test)]
mod tests {
    use super::super::Rig;
    use super::*;

    #[test]
    fn the_start_is_free_of_strain_and_moves_as_given() {
        let (strip, rig) = (Strip { cells: 20 }, Rig::default());
        let [first, second] = [1, 2].map(|seed| rig.start(&strip.scene(seed)).unwrap());
        let ledger = first.view().ledger();
        let [arm, ramp, speed] = ["arm", "ramp", "speed"].map(size);
        let moving = arm - 2.0 / 3.0 * ramp;
        let kinetic = 0.5 * FILM.area_density() * Strip::width() * moving * speed * speed;
        assert!((ledger.kinetic / kinetic - 1.0).abs() < 1e-2, "{}", ledger.kinetic);
        assert!(ledger.strain < 1e-6 * kinetic, "{}", ledger.strain);
        assert!((strip.body_energy(&first.view()) / kinetic - 1.0).abs() < 2e-2);
        let height =
            first.view().state.positions.z.iter().zip(second.view().state.positions.z.iter());
        let largest = height.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(largest > 1e-6 && largest < size("contact_distance"), "{largest}");
    }
}
