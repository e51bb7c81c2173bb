//! The energy ledger and the gas balance: does the run's energy add up?
//!
//! ```text
//! film:   Δ(kinetic + strain + contact) + viscous + friction + damping = gas + ambient + gravity + support
//! gas:    Δm = mass in − mass out
//!         ΔU = enthalpy in − enthalpy out − gas work + heat
//!
//! residual(t) = |left − right| / (largest kinetic energy so far + Σ|external work| so far),
//!               the divisor at least 1 % of its value at the end
//! ```
//!
//! Every work is accumulated from its own force and displacement while the run goes; none is found
//! by difference. The energies on the left are functions of the state. The external works are
//! those of gas, ambient pressure, gravity and supports. The enthalpy let in, a hundred times the
//! kinetic energy, would hide any error and is no part of the film's divisor; the gas balances are
//! judged by what they move: m0 + mass in, U0 + enthalpy in + |heat| + |gas work|, with the same
//! floor. Residuals are judged on the stored series, once the end is known.

use serde::{Deserialize, Serialize};

/// The film's side of the ledger at one moment; all J.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ledger {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Elastic energy of the film.
    pub strain: f64,
    /// Elastic energy of contact.
    pub contact: f64,
    /// Work of the gas on the film.
    pub gas_work: f64,
    /// Work of the ambient pressure on the film.
    pub ambient_work: f64,
    /// Work of gravity on the film.
    pub gravity_work: f64,
    /// Work of moving supports and the lid on the film.
    pub support_work: f64,
    /// Energy dissipated by film viscosity.
    pub viscous_work: f64,
    /// Energy dissipated by friction.
    pub friction_work: f64,
    /// Energy dissipated by mass damping, which only statics has.
    pub damping_work: f64,
}

impl Ledger {
    fn stored(&self) -> f64 {
        self.kinetic + self.strain + self.contact
    }

    /// Energy that appeared from nowhere since `start`, J; negative where it was lost.
    pub fn defect(&self, start: &Self) -> f64 {
        let external = self.gas_work + self.ambient_work + self.gravity_work + self.support_work;
        let dissipated = self.viscous_work + self.friction_work + self.damping_work;
        (self.stored() - start.stored()) + dissipated - external
    }

    /// Σ|external work|, J.
    pub fn external(&self) -> f64 {
        self.gas_work.abs()
            + self.ambient_work.abs()
            + self.gravity_work.abs()
            + self.support_work.abs()
    }
}

/// The gas's side of the ledger at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasBalance {
    /// Mass inside, kg.
    pub mass: f64,
    /// Internal energy, J.
    pub internal_energy: f64,
    /// Mass let in since time 0, kg, by the schedule's closed form.
    pub mass_in: f64,
    /// Mass leaked since time 0, kg.
    pub mass_out: f64,
    /// Enthalpy let in since time 0, J.
    pub enthalpy_in: f64,
    /// Enthalpy leaked since time 0, J.
    pub enthalpy_out: f64,
    /// Heat given by the film since time 0, J.
    pub heat: f64,
    /// Work done on the film since time 0, J.
    pub gas_work: f64,
}

impl GasBalance {
    fn mass_defect(&self, start: &Self) -> f64 {
        (self.mass - start.mass) - self.mass_in + self.mass_out
    }

    fn energy_defect(&self, start: &Self) -> f64 {
        (self.internal_energy - start.internal_energy) - self.enthalpy_in + self.enthalpy_out
            - self.heat
            + self.gas_work
    }

    fn mass_moved(&self, start: &Self) -> f64 {
        start.mass + self.mass_in
    }

    fn energy_moved(&self, start: &Self) -> f64 {
        start.internal_energy + self.enthalpy_in + self.heat.abs() + self.gas_work.abs()
    }
}

/// The share of its final value below which a divisor never falls.
const DIVISOR_FLOOR: f64 = 0.01;

/// Kinetic energy below which film is at rest, J: some hundred times k T. Rounding alone moves film
/// that nothing loads (1e-27 J for a metre of it), and closes no ledger.
const REST: f64 = 1e-18;

/// Residual of the film's energy at every sample of a series.
pub fn residuals(series: &[Ledger]) -> Vec<f64> {
    let Some(start) = series.first() else { return Vec::new() };
    let mut peak_kinetic = REST;
    let moved: Vec<f64> = series
        .iter()
        .map(|ledger| {
            peak_kinetic = peak_kinetic.max(ledger.kinetic);
            peak_kinetic + ledger.external()
        })
        .collect();
    let defects: Vec<f64> = series.iter().map(|ledger| ledger.defect(start)).collect();
    relative(&defects, &moved)
}

/// Residual of the gas at every sample of a series: the larger of mass's and energy's.
pub fn gas_residuals(series: &[GasBalance]) -> Vec<f64> {
    let Some(start) = series.first() else { return Vec::new() };
    let column = |value: fn(&GasBalance, &GasBalance) -> f64| -> Vec<f64> {
        series.iter().map(|books| value(books, start)).collect()
    };
    let mass = relative(&column(GasBalance::mass_defect), &column(GasBalance::mass_moved));
    let energy = relative(&column(GasBalance::energy_defect), &column(GasBalance::energy_moved));
    mass.iter().zip(&energy).map(|(mass, energy)| mass.max(*energy)).collect()
}

fn relative(defects: &[f64], moved: &[f64]) -> Vec<f64> {
    let floor = DIVISOR_FLOOR * moved.last().copied().unwrap_or(0.0);
    let ratio = |(defect, moved): (&f64, &f64)| {
        // Nothing moved and nothing amiss is no error; something amiss where nothing moved is.
        if *defect == 0.0 { 0.0 } else { defect.abs() / moved.max(floor) }
    };
    defects.iter().zip(moved).map(ratio).collect()
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;

    fn at(kinetic: f64, gas_work: f64, viscous_work: f64) -> Ledger {
        Ledger { kinetic, gas_work, viscous_work, ..Ledger::default() }
    }

    #[test]
    fn a_closed_ledger_has_no_residual() {
        assert_eq!(residuals(&[at(0.0, 0.0, 0.0), at(3.0, 4.0, 1.0)]), [0.0, 0.0]);
    }

    #[test]
    fn energy_from_nowhere_shows_with_its_size() {
        let series = [at(0.0, 0.0, 0.0), at(3.0, 2.0, 0.0), at(1.0, 2.0, 1.0)];
        assert_eq!(residuals(&series), [0.0, 1.0 / 5.0, 0.0]);
    }

    #[test]
    fn early_noise_is_judged_by_a_hundredth_of_the_end() {
        let series = [at(0.0, 0.0, 0.0), at(1e-9, 0.0, 0.0), at(50.0, 50.0, 0.0)];
        assert!((residuals(&series)[1] - 1e-9).abs() < 1e-20);
    }

    #[test]
    fn every_entry_counts() {
        let entries: [fn(&mut Ledger); 10] = [
            |l| l.kinetic = 1.0,
            |l| l.strain = 1.0,
            |l| l.contact = 1.0,
            |l| l.gas_work = 1.0,
            |l| l.ambient_work = 1.0,
            |l| l.gravity_work = 1.0,
            |l| l.support_work = 1.0,
            |l| l.viscous_work = 1.0,
            |l| l.friction_work = 1.0,
            |l| l.damping_work = 1.0,
        ];
        let start = Ledger::default();
        for (index, set) in entries.into_iter().enumerate() {
            let mut ledger = start;
            set(&mut ledger);
            assert_eq!(ledger.defect(&start).abs(), 1.0, "entry {index}");
            assert_eq!(ledger.external(), f64::from(u8::from((3..7).contains(&index))));
        }
    }

    #[test]
    fn lost_gas_shows_in_mass_and_in_energy() {
        let start = GasBalance { mass: 1.0, internal_energy: 100.0, ..GasBalance::default() };
        let mut mass_lost = GasBalance { mass: 1.5, mass_in: 1.0, ..start };
        assert_eq!(gas_residuals(&[start, mass_lost]), [0.0, 0.25]);
        mass_lost.mass = 2.0;
        mass_lost.heat = 100.0;
        assert_eq!(gas_residuals(&[start, mass_lost]), [0.0, 0.5]);
    }

    #[test]
    fn a_run_without_anything_has_no_residual() {
        assert_eq!(residuals(&[Ledger::default(); 3]), [0.0; 3]);
        assert_eq!(gas_residuals(&[GasBalance::default(); 3]), [0.0; 3]);
        assert!(residuals(&[]).is_empty() && gas_residuals(&[]).is_empty());
    }
}
