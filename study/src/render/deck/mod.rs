//! The film of a job as a deck: the input of another explicit finite element code.
//!
//! A deck starts when the lid releases the capsule. It holds the film with the stress-free reference of every element, a
//! law of fabric, the gas in a control volume with its inflow, self contact, supports, and what is to be written. What
//! billow has and such a code has not is said in comments at its head ([`Deck::differences`]).
//!
//! The control volumes of these codes hold ambient gas at the start and no other. So the gas that is inside beyond it
//! flows in within 0.1 ms. A vessel that was empty is then at T = γ `T_in`, so it flows in at T/γ.

use std::fmt::Write as _;

use billow_solver::scene::film_scene::{Filling, FilmScene};
use billow_solver::scene::film_support::Hold;
use billow_solver::scene::{GasSupply, HeatTransfer};

mod dyna;
mod radioss;

pub use dyna::keyword_file;
pub use radioss::{engine_file, starter_file};

/// Time in which the gas that is inside at the start flows in, s. Chosen: film hardly moves in it.
const FILL_TIME: f64 = 1e-4;
/// Time in which gas that has film temperature at all times takes it in a deck, s. Chosen: short against a deployment,
/// long against a step.
const EXCHANGE_TIME: f64 = 1e-3;
/// External pressure where there is none, Pa: 0 may mean that of the atmosphere.
const VACUUM: f64 = 1e-6;
/// Part of a mass that counts as none. Chosen: far above rounding of a volume.
const MAX_MISSING: f64 = 1e-3;
/// Universal gas constant, J/(mol K) (CODATA 2018).
const MOLAR_GAS_CONSTANT: f64 = 8.314_462_618;

/// What a deck is made of.
#[derive(Debug)]
pub struct Deck<'a> {
    /// Study, job and parameters.
    pub title: &'a str,
    /// Name of the run: the beginning of the job's id, after "job_".
    pub name: &'a str,
    /// The film at the start, with contact, and its gas.
    pub film: &'a FilmScene,
    /// Storey of each element, 0 the bottom cap; empty for film without storeys.
    pub storeys: &'a [u32],
    /// Nodes whose motion is written: of a capsule the centre of the top, then the top ring.
    pub followed: &'a [u32],
    /// The gas inside when the lid releases the capsule: kg, K.
    pub gas: [f64; 2],
}

/// A flow of gas into the volume: points of time (s) and mass since the start (kg), and its temperature, K.
struct Inflow {
    mass: Vec<[f64; 2]>,
    temperature: f64,
}

/// A set of nodes that a support holds in some directions.
struct Held<'a> {
    name: &'a str,
    nodes: &'a [u32],
    directions: [bool; 3],
}

impl<'a> Deck<'a> {
    /// The deck, if these codes can have it.
    ///
    /// # Errors
    /// What of the film a deck cannot hold, and what it can.
    pub fn checked(self) -> Result<Self, String> {
        let FilmScene { shell, filling, .. } = self.film;
        if !matches!(filling, Filling::Gas { .. }) {
            return Err("its film is under a given pressure; allowed: film with gas".to_owned());
        }
        if !shell.is_closed() || !shell.closure.is_empty() {
            return Err("its film is open; allowed: film that encloses its volume".to_owned());
        }
        if self.duration() <= 0.0 {
            let problem = "it ends before the lid releases the capsule";
            return Err(format!("{problem}; allowed: solver.end_time after the release"));
        }
        if self.gas[0] < (1.0 - MAX_MISSING) * self.ambient_mass() {
            let problem = "it starts with less gas than ambient gas in its volume";
            return Err(format!("{problem}; allowed: residual gas \"ambient\", or more"));
        }
        if self.inflows().is_empty() {
            return Err("no gas flows in after the release; allowed: film with gas".to_owned());
        }
        Ok(self)
    }

    fn supply(&self) -> &'a GasSupply {
        match &self.film.filling {
            Filling::Gas { supply, .. } => supply,
            Filling::Pressure(_) => unreachable!("a deck is checked"),
        }
    }

    /// The ambient gas that fills the volume at the start, kg.
    fn ambient_mass(&self) -> f64 {
        let FilmScene { shell, film, .. } = self.film;
        let volume = shell.volume(|node| shell.positions[node as usize]);
        let supply = self.supply();
        supply.ambient_pressure * volume / (supply.species.gas_constant * film.temperature)
    }

    /// The gas inside at the start beyond the ambient gas, kg.
    fn beyond_ambient(&self) -> f64 {
        let beyond = self.gas[0] - self.ambient_mass();
        if beyond > MAX_MISSING * self.gas[0] { beyond } else { 0.0 }
    }

    /// Time from the release to the end, s.
    fn duration(&self) -> f64 {
        self.film.solver.end_time - self.film.release_time
    }

    /// Time between two stored shapes, s.
    fn frame_interval(&self) -> f64 {
        self.duration() / f64::from(self.film.outputs.frames.max(1))
    }

    /// Shear modulus of the film, Pa.
    fn shear_modulus(&self) -> f64 {
        let film = &self.film.film;
        film.youngs_modulus / (2.0 * (1.0 + film.poisson_ratio))
    }

    /// Molar mass of the gas, kg/mol, and its specific heat cp at film temperature, J/(kg K).
    fn molar_mass_and_cp(&self) -> [f64; 2] {
        let species = self.supply().species;
        let vibrations = species.vibration_heat_capacity(self.film.film.temperature);
        [MOLAR_GAS_CONSTANT / species.gas_constant, species.cp + vibrations]
    }

    /// Numbers of the parts.
    fn part_numbers(&self) -> impl Iterator<Item = usize> {
        self.parts().into_iter().map(|(part, _)| part as usize)
    }

    /// Node number in the deck of the reference of a corner of an element; nodes of film are numbered from 1.
    fn reference_node(&self, element: usize, corner: usize) -> usize {
        self.film.shell.positions.len() + 3 * element + corner + 1
    }

    /// Every node with its number: those of the film, then three of the reference for each element, flat.
    fn nodes(&self) -> impl Iterator<Item = (usize, [f64; 3])> + '_ {
        let shell = &self.film.shell;
        let film = shell.positions.iter().map(|x| [x.x, x.y, x.z]);
        let reference = shell.reference.iter().flatten().map(|x| [x.x, x.y, 0.0]);
        film.chain(reference).enumerate().map(|(index, position)| (index + 1, position))
    }

    /// The elements of each part: part number, elements. A part is a cap or a storey.
    fn parts(&self) -> Vec<(u32, Vec<usize>)> {
        let mut parts: Vec<(u32, Vec<usize>)> = Vec::new();
        for element in 0..self.film.shell.triangles.len() {
            let part = self.storeys.get(element).map_or(1, |storey| storey + 1);
            match parts.iter_mut().find(|(known, _)| *known == part) {
                Some((_, elements)) => elements.push(element),
                None => parts.push((part, vec![element])),
            }
        }
        parts.sort_unstable_by_key(|(part, _)| *part);
        parts
    }

    fn part_name(&self, part: u32) -> String {
        let last = self.storeys.iter().max().copied().unwrap_or(0);
        match part - 1 {
            _ if self.storeys.is_empty() => "film".to_owned(),
            0 => "bottom cap".to_owned(),
            storey if storey == last => "top cap".to_owned(),
            storey => format!("storey {storey}"),
        }
    }

    /// The gas inside at the start, then one flow for each window that is open after the release.
    fn inflows(&self) -> Vec<Inflow> {
        let (supply, release) = (self.supply(), self.film.release_time);
        let (mass, temperature) = (self.beyond_ambient(), self.gas[1]);
        let mut inflows = Vec::new();
        if mass > 0.0 {
            let gamma = supply.species.gamma(temperature);
            let mass = vec![[0.0, 0.0], [FILL_TIME, mass], [2.0 * self.duration(), mass]];
            inflows.push(Inflow { mass, temperature: temperature / gamma });
        }
        for window in &supply.windows {
            let from = (window.from - release).max(0.0);
            let to = (window.to - release).min(2.0 * self.duration());
            if to <= from || window.mass_flow_rate <= 0.0 {
                continue;
            }
            let total = (to - from) * window.mass_flow_rate;
            let mut mass =
                vec![[0.0, 0.0], [from, 0.0], [to, total], [2.0 * self.duration(), total]];
            // A curve has each time once.
            mass.dedup_by(|next, known| next[0] <= known[0]);
            inflows.push(Inflow { mass, temperature: window.temperature });
        }
        inflows
    }

    /// Heat transfer coefficient, W/(m² K).
    fn heat_transfer(&self) -> f64 {
        let supply = self.supply();
        match supply.heat_transfer {
            HeatTransfer::Coefficient(coefficient) => coefficient,
            HeatTransfer::Isothermal => {
                let mass: f64 = self.inflows().iter().map(|i| i.mass[i.mass.len() - 1][1]).sum();
                mass * supply.species.cv() / (self.film.shell.reference_area() * EXCHANGE_TIME)
            }
        }
    }

    fn supports(&self) -> impl Iterator<Item = Held<'_>> {
        self.film.supports.iter().filter_map(|support| {
            let directions = match support.hold {
                Hold::Components(directions) => directions,
                Hold::Plane(normal) => [normal.x, normal.y, normal.z].map(|n| n.abs() > 1.0 - 1e-9),
                Hold::Body(_) => [false; 3],
            };
            let held = directions.contains(&true) && support.motion.is_none();
            held.then_some(Held { name: &support.name, nodes: &support.nodes, directions })
        })
    }

    /// What differs from the job: one sentence each.
    pub fn differences(&self) -> Vec<String> {
        let FilmScene { film, supports, contact, release_time, .. } = self.film;
        let supply = self.supply();
        let mut lines = vec![
            format!(
                "Time 0 is {release_time} s of the job, when the lid releases the capsule; base and lid are left out."
            ),
            format!("Compression fraction of the job: {}.", film.compression),
        ];
        let (mass, temperature) = (self.beyond_ambient(), self.gas[1]);
        if mass > 0.0 {
            lines.push(format!(
                "The {mass:.6e} kg of gas inside at {temperature} K, beyond ambient gas, flow in within {FILL_TIME} s."
            ));
        }
        if *release_time > 0.0 {
            lines.push(
                "Shape and velocities are those of time 0 of the job, stowed and at rest."
                    .to_owned(),
            );
        }
        let mut left_out = |is: bool, what: &str| {
            if is {
                lines.push(format!("{what}: left out."));
            }
        };
        left_out(film.loss_factor > 0.0, "Loss factor of the film");
        left_out(film.bending, "Bending stiffness of the film and of its creases");
        left_out(supply.vent.is_some(), "The vent");
        left_out(supply.species.vibrates(), "Change of cp with temperature");
        left_out(contact.is_none(), "Contact: the job has none, and so has the deck");
        if let Some(contact) = contact {
            left_out(contact.adhesion > 0.0, "Adhesion");
            left_out(!contact.plates.is_empty(), "Plates");
            left_out(!contact.ignored.is_empty(), "Pairs of elements without contact");
        }
        let held = self.supports().count();
        left_out(
            held < supports.len(),
            "Supports that move, that are free bodies, or that hold along an oblique normal",
        );
        if supply.heat_transfer == HeatTransfer::Isothermal {
            lines.push(format!(
                "Isothermal gas: a heat transfer of {:.3} W/(m2 K).",
                self.heat_transfer()
            ));
        }
        lines
    }
}

/// A number in at most `width` characters, with as many digits as fit.
fn number(value: f64, width: usize) -> String {
    let exact = format!("{value:e}");
    if exact.len() <= width {
        return exact;
    }
    let rounded = (0..width).rev().map(|digits| format!("{value:.digits$e}"));
    rounded.into_iter().find(|text| text.len() <= width).unwrap_or(exact)
}

/// A line of these numbers, each in 20 columns.
fn wide(values: &[f64]) -> String {
    let mut line = String::new();
    for value in values {
        let _ = write!(line, "{:>20}", number(*value, 19));
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_has_as_many_digits_as_fit() {
        assert_eq!(number(0.1, 9), "1e-1");
        assert_eq!(number(-1.0 / 3.0, 9), "-3.333e-1");
        assert_eq!(number(1.0 / 3.0, 19), "3.33333333333333e-1");
        assert_eq!(number(-1.234_567_8e-100, 9), "-1.2e-100");
        assert_eq!(wide(&[1.0, -0.5]), format!("{:>20}{:>20}", "1e0", "-5e-1"));
    }
}
