//! The energy ledger of the film and the balance of the gas: does the energy of a run add up?
//!
//! ```text
//! film:   Δ(kinetic + strain + contact) + material loss + numerical + contact dissipation + damping
//!             = gas + ambient + gravity + support
//! gas:    Δm = mass in − mass out
//!         ΔU = enthalpy in − enthalpy out − gas work + heat
//!
//! residual(t) = |left − right| / (largest kinetic energy so far + Σ|external work| so far),
//!               the divisor at least 1 % of its value at the end
//! ```
//!
//! Each work is accumulated during the run from its own force and its own displacement; none is the
//! difference of others. The energies on the left are functions of the state, except the contact
//! energy, which is minus the accumulated work of the contact forces. The external works are those of
//! gas, ambient pressure, gravity and supports.
//!
//! The film's divisor leaves out the enthalpy let in: it is about a hundred times the kinetic energy
//! and would hide any error. The divisors of the gas are m0 + mass in and
//! U0 + enthalpy in + |heat| + |gas work|, with the same floor. Residuals are computed from the stored
//! series, after the end of the run.

use serde::{Deserialize, Serialize};

/// The energy ledger of the film at one moment. All entries in J.
///
/// Works are positive where they give energy to the film; dissipation is positive where the film loses
/// energy.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ledger {
    /// Kinetic energy of nodes and rigid planes now.
    pub kinetic: f64,
    /// Energy stored in the film now: elastic energy and that of creep.
    pub strain: f64,
    /// Elastic energy of contact of film with film and with plates: minus the work of the contact
    /// forces since time 0.
    pub contact: f64,
    /// Work of the gas pressure, or of a fixed overpressure, on the film since time 0.
    pub gas_work: f64,
    /// Work of the ambient pressure on the film since time 0: −`p_ambient` ΔV.
    pub ambient_work: f64,
    /// Work of gravity on the film since time 0.
    pub gravity_work: f64,
    /// Work of moving supports, of the constant forces on rigid planes and of moving plates (the lid
    /// is one) on the film since time 0. Supports that do not move do no work.
    pub support_work: f64,
    /// Energy lost in the film's material since time 0.
    pub material_loss: f64,
    /// Energy that numerical damping and the time step took from the film since time 0; negative where
    /// they gave energy.
    pub numerical_dissipation: f64,
    /// Energy dissipated by contact since time 0: by friction and by the impulses that resolve
    /// collisions. History files and tables call this column `friction_work`.
    pub contact_dissipation: f64,
    /// Energy dissipated by mass damping since time 0. A scene may ask for mass damping; static
    /// relaxation always uses it.
    pub damping_work: f64,
}

impl Ledger {
    /// Kinetic and stored energy now, J.
    pub fn stored(&self) -> f64 {
        self.kinetic + self.strain + self.contact
    }

    /// Energy error since `start`, J: positive where energy appeared without a source, negative where it
    /// disappeared.
    pub fn defect(&self, start: &Self) -> f64 {
        self.defect_since(start.stored())
    }

    /// [`Self::defect`] since a start with this kinetic and stored energy, J.
    pub fn defect_since(&self, start: f64) -> f64 {
        let external = self.gas_work + self.ambient_work + self.gravity_work + self.support_work;
        let dissipated = self.material_loss
            + self.numerical_dissipation
            + self.contact_dissipation
            + self.damping_work;
        (self.stored() - start) + dissipated - external
    }

    /// Sum of the magnitudes of the external works, J.
    pub fn external(&self) -> f64 {
        self.gas_work.abs()
            + self.ambient_work.abs()
            + self.gravity_work.abs()
            + self.support_work.abs()
    }
}

/// The mass and energy balance of the gas at one moment.
///
/// `*_in` is positive into the capsule, `*_out` positive out of it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasBalance {
    /// Mass inside now, kg.
    pub mass: f64,
    /// Internal energy now, J.
    pub internal_energy: f64,
    /// Mass let in since time 0, kg: the exact integral of the inflow schedule.
    pub mass_in: f64,
    /// Mass leaked since time 0, kg; negative where more entered through the leak.
    pub mass_out: f64,
    /// Enthalpy let in since time 0, J.
    pub enthalpy_in: f64,
    /// Enthalpy leaked since time 0, J.
    pub enthalpy_out: f64,
    /// Heat from the film to the gas since time 0, J; negative where the gas is warmer.
    pub heat: f64,
    /// Work of the gas on the film since time 0, J; the ledger of the film holds the same number.
    pub gas_work: f64,
}

impl GasBalance {
    /// Errors of mass (kg) and energy (J) since `start`.
    fn defects(&self, start: &Self) -> [f64; 2] {
        let energy = (self.internal_energy - start.internal_energy) - self.enthalpy_in
            + self.enthalpy_out
            - self.heat
            + self.gas_work;
        [(self.mass - start.mass) - self.mass_in + self.mass_out, energy]
    }

    /// Divisors of these errors, kg and J.
    fn moved(&self, start: &Self) -> [f64; 2] {
        let entered = [self.mass_out, self.enthalpy_out].map(|out| (-out).max(0.0));
        let energy = start.internal_energy + self.enthalpy_in + entered[1];
        [start.mass + self.mass_in + entered[0], energy + self.heat.abs() + self.gas_work.abs()]
    }
}

/// Lower bound of a divisor, as a fraction of its final value. Chosen: rounding at the start of a run,
/// when little has moved, is no error.
const MIN_DIVISOR_FRACTION: f64 = 0.01;

/// Lower bound of the film's divisor, J. Chosen: a few hundred times k T at room temperature. Rounding
/// moves film without any load (about 1e-27 J per metre of film), and such a ledger never closes.
const MIN_KINETIC_ENERGY: f64 = 1e-18;

/// Energy residual of the film at every sample of a series: |error| over energy moved so far.
pub fn residuals(series: &[Ledger]) -> Vec<f64> {
    let Some(start) = series.first() else { return Vec::new() };
    let mut peak_kinetic = MIN_KINETIC_ENERGY;
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

/// Residual of the gas at every sample of a series: the larger one of mass and energy.
pub fn gas_residuals(series: &[GasBalance]) -> Vec<f64> {
    let Some(start) = series.first() else { return Vec::new() };
    let [mass, energy] = [0, 1].map(|entry| {
        let defects: Vec<f64> = series.iter().map(|gas| gas.defects(start)[entry]).collect();
        let moved: Vec<f64> = series.iter().map(|gas| gas.moved(start)[entry]).collect();
        relative(&defects, &moved)
    });
    mass.iter().zip(&energy).map(|(mass, energy)| mass.max(*energy)).collect()
}

fn relative(defects: &[f64], moved: &[f64]) -> Vec<f64> {
    let floor = MIN_DIVISOR_FRACTION * moved.last().copied().unwrap_or(0.0);
    let ratio = |(defect, moved): (&f64, &f64)| {
        // 0/0 counts as no error; an error without any motion is infinite.
        if *defect == 0.0 { 0.0 } else { defect.abs() / moved.max(floor) }
    };
    defects.iter().zip(moved).map(ratio).collect()
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;

    fn at(kinetic: f64, gas_work: f64, material_loss: f64) -> Ledger {
        Ledger { kinetic, gas_work, material_loss, ..Ledger::default() }
    }

    #[test]
    fn residual_is_the_energy_error_over_the_energy_moved() {
        let series = [at(0.0, 0.0, 0.0), at(3.0, 2.0, 0.0), at(1.0, 2.0, 1.0)];
        assert_eq!(residuals(&series), [0.0, 1.0 / 5.0, 0.0]);
        // Early errors are divided by one percent of the final divisor.
        let early = [at(0.0, 0.0, 0.0), at(1e-9, 0.0, 0.0), at(50.0, 50.0, 0.0)];
        assert!((residuals(&early)[1] - 1e-9).abs() < 1e-20);
        assert_eq!(residuals(&[Ledger::default(); 3]), [0.0; 3]);
        assert_eq!(gas_residuals(&[GasBalance::default(); 3]), [0.0; 3]);
        assert!(residuals(&[]).is_empty() && gas_residuals(&[]).is_empty());
    }

    #[test]
    fn every_entry_enters_the_ledger() {
        let entries: [fn(&mut Ledger); 11] = [
            |l| l.kinetic = 1.0,
            |l| l.strain = 1.0,
            |l| l.contact = 1.0,
            |l| l.gas_work = 1.0,
            |l| l.ambient_work = 1.0,
            |l| l.gravity_work = 1.0,
            |l| l.support_work = 1.0,
            |l| l.material_loss = 1.0,
            |l| l.numerical_dissipation = 1.0,
            |l| l.contact_dissipation = 1.0,
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
    fn gas_residual_is_the_larger_of_mass_and_energy() {
        let start = GasBalance { mass: 1.0, internal_energy: 100.0, ..GasBalance::default() };
        let mut mass_lost = GasBalance { mass: 1.5, mass_in: 1.0, ..start };
        assert_eq!(gas_residuals(&[start, mass_lost]), [0.0, 0.25]);
        mass_lost.mass = 2.0;
        mass_lost.heat = 100.0;
        assert_eq!(gas_residuals(&[start, mass_lost]), [0.0, 0.5]);
    }
}
