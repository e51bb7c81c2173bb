//! The motion of a piston: constants, state, equations, run.

use super::{EndFilm, EndState, VolumeLaw};
use crate::integrators::dormand_prince::{Control, Integrator, System};
use crate::mechanics::gas::{Gas, GasState};
use crate::models::run::Model;
use crate::output::history::Sample;
use crate::output::ledger::{GasBalance, Ledger};
use crate::output::measures::{Reference, StaticShape};
use crate::output::outcome::{AuditKind, Failure};
use crate::scene::timeline::Phase;

/// Constants of a piston. Plain data, so that a piston in a tube, a rigid tank and a gas spring use the
/// same functions as a capsule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piston {
    /// V(z).
    pub volume: VolumeLaw,
    /// Accelerated mass, kg.
    pub mass: f64,
    /// Weight: constant force along z, N.
    pub weight: f64,
    /// Momentum of the film over the speed of the piston, kg.
    pub first_moment: f64,
    /// Weight of all film along z, N.
    pub film_weight: f64,
    /// The film at full height.
    pub end: EndFilm,
    /// The gas.
    pub gas: Gas,
}

/// State of a piston.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PistonState {
    /// z, m.
    pub height: f64,
    /// ż, m/s.
    pub speed: f64,
    /// Gas inside.
    pub gas: GasState,
}

// Components of the integrated state.
const HEIGHT: usize = 0;
const SPEED: usize = 1;
const MASS: usize = 2;
const INTERNAL_ENERGY: usize = 3;
const MASS_OUT: usize = 4;
const ENTHALPY_IN: usize = 5;
const ENTHALPY_OUT: usize = 6;
const HEAT: usize = 7;
const GAS_WORK: usize = 8;
const AMBIENT_WORK: usize = 9;
const GRAVITY_WORK: usize = 10;
const VISCOUS_WORK: usize = 11;
const STRAIN_WORK: usize = 12;
const COMPONENTS: usize = 13;

/// The equations of a piston during one phase.
#[derive(Debug, Clone, Copy)]
pub struct Motion<'a> {
    piston: &'a Piston,
    phase: &'a Phase,
    /// A smaller volume counts as zero, m³.
    min_volume: f64,
}

impl System<COMPONENTS> for Motion<'_> {
    type Branch = EndState;

    // Error scales: lengths, speeds, masses, energies of the gas, works on the film. All works share one
    // scale, so a small work, as that of the damper at its start, needs no small step.
    const GROUPS: [usize; COMPONENTS] = [0, 1, 2, 3, 2, 3, 3, 3, 4, 4, 4, 4, 4];

    fn rates(&self, branch: EndState, state: &[f64; COMPONENTS]) -> [f64; COMPONENTS] {
        let piston = self.piston;
        let z = state[HEIGHT];
        let speed = if self.phase.packed { 0.0 } else { state[SPEED] };
        let (volume, slope) = (piston.volume.volume(z), piston.volume.slope(z));
        let gas_state = GasState { mass: state[MASS], internal_energy: state[INTERNAL_ENERGY] };
        let gas = piston.gas.rates(gas_state, volume, slope * speed, self.phase.inflow);
        let ambient = -piston.gas.ambient_pressure * slope;
        let (elastic, viscous) = piston.end.pull(branch, z, speed);
        let force = piston.gas.pressure(gas_state, volume) * slope + ambient + piston.weight
            - elastic
            - viscous;

        let mut rates = [0.0; COMPONENTS];
        rates[HEIGHT] = speed;
        rates[SPEED] = if self.phase.packed { 0.0 } else { force / piston.mass };
        rates[MASS] = gas.mass;
        rates[INTERNAL_ENERGY] = gas.internal_energy;
        rates[MASS_OUT] = gas.mass_out;
        rates[ENTHALPY_IN] = gas.enthalpy_in;
        rates[ENTHALPY_OUT] = gas.enthalpy_out;
        rates[HEAT] = gas.heat;
        rates[GAS_WORK] = gas.work;
        rates[AMBIENT_WORK] = ambient * speed;
        rates[GRAVITY_WORK] = piston.weight * speed;
        rates[VISCOUS_WORK] = viscous * speed;
        rates[STRAIN_WORK] = elastic * speed;
        rates
    }

    fn margin(&self, branch: EndState, state: &[f64; COMPONENTS]) -> f64 {
        self.piston.end.margin(branch, state[HEIGHT], state[SPEED])
    }

    fn next_branch(&self, branch: EndState, state: &[f64; COMPONENTS]) -> EndState {
        self.piston.end.next(branch, state[HEIGHT], state[SPEED])
    }

    fn check(&self, state: &[f64; COMPONENTS]) -> Result<(), (AuditKind, &'static str)> {
        if state[HEIGHT] <= 0.0 {
            return Err((AuditKind::Volume, "height of the top ring"));
        }
        if self.piston.volume.volume(state[HEIGHT]) <= self.min_volume {
            return Err((AuditKind::Volume, "gas volume"));
        }
        Ok(())
    }
}

/// Lower bound of the volume, as a fraction of the initial volume. Chosen. Below it the run ends as
/// `inverted_volume`: a leaking capsule under pressure would take ever smaller steps towards volume 0.
const MIN_VOLUME_FRACTION: f64 = 1e-9;

/// Lower bound of the gas mass that scales errors, as a fraction of the moving mass. Chosen.
///
/// An empty capsule that begins to fill has no time scale: at time t the gas warms at the rate
/// (h A/(ṁ cv))/t. Without this bound no step would be short enough for a fast heat exchange.
const MIN_GAS_FRACTION: f64 = 1e-9;

/// Initial error scales of a run, by group.
fn initial_scales(piston: &Piston) -> [f64; COMPONENTS] {
    let mass = MIN_GAS_FRACTION * piston.mass;
    let energy = mass * piston.gas.cp * piston.gas.film_temperature;
    let speed = (2.0 * energy / piston.mass).sqrt();
    let mut scales = [0.0; COMPONENTS];
    scales[..5].copy_from_slice(&[0.0, speed, mass, energy, energy]);
    scales
}

/// A piston during a run.
#[derive(Debug, Clone, PartialEq)]
pub struct PistonRun {
    piston: Piston,
    control: Control,
    integrator: Integrator<COMPONENTS, EndState>,
    film_stress: f64,
    min_volume: f64,
}

impl PistonRun {
    /// A piston at this time (s) in this state.
    pub fn new(piston: Piston, time: f64, start: PistonState, control: Control) -> Self {
        let mut state = [0.0; COMPONENTS];
        state[HEIGHT] = start.height;
        state[SPEED] = start.speed;
        state[MASS] = start.gas.mass;
        state[INTERNAL_ENERGY] = start.gas.internal_energy;
        let branch = piston.end.state_at(start.height, start.speed);
        let integrator = Integrator::new(time, state, branch, initial_scales(&piston));
        let min_volume = MIN_VOLUME_FRACTION * piston.volume.volume(start.height);
        Self { piston, control, integrator, film_stress: 0.0, min_volume }
    }

    /// Its state now.
    pub fn state(&self) -> PistonState {
        let state = &self.integrator.state;
        let gas = GasState { mass: state[MASS], internal_energy: state[INTERNAL_ENERGY] };
        PistonState { height: state[HEIGHT], speed: state[SPEED], gas }
    }

    /// Its constants.
    pub fn piston(&self) -> &Piston {
        &self.piston
    }

    /// Work done on the end spring, J, integrated from force and speed. Equal to its strain energy if both
    /// are correct.
    pub fn strain_work(&self) -> f64 {
        self.integrator.state[STRAIN_WORK]
    }

    fn ledger(&self) -> Ledger {
        let state = &self.integrator.state;
        Ledger {
            kinetic: 0.5 * self.piston.mass * state[SPEED] * state[SPEED],
            strain: self.piston.end.strain_energy(state[HEIGHT]),
            gas_work: state[GAS_WORK],
            ambient_work: state[AMBIENT_WORK],
            gravity_work: state[GRAVITY_WORK],
            material_loss: state[VISCOUS_WORK],
            numerical_dissipation: 0.0,
            // No contact; bottom ring and lid hold film that does not move, so they do no work.
            contact: 0.0,
            contact_dissipation: 0.0,
            damping_work: 0.0,
            support_work: 0.0,
        }
    }

    fn gas_balance(&self) -> GasBalance {
        let state = &self.integrator.state;
        GasBalance {
            mass: state[MASS],
            internal_energy: state[INTERNAL_ENERGY],
            mass_out: state[MASS_OUT],
            enthalpy_in: state[ENTHALPY_IN],
            enthalpy_out: state[ENTHALPY_OUT],
            heat: state[HEAT],
            gas_work: state[GAS_WORK],
            ..GasBalance::default()
        }
    }
}

impl Model for PistonRun {
    fn advance_at_most(
        &mut self,
        target: f64,
        phase: &Phase,
        steps: &mut u64,
    ) -> Result<bool, Failure> {
        let piston = &self.piston;
        let film_stress = &mut self.film_stress;
        let motion = Motion { piston, phase, min_volume: self.min_volume };
        let mut accepted = |state: &[f64; COMPONENTS]| {
            let z = state[HEIGHT];
            let gas = GasState { mass: state[MASS], internal_energy: state[INTERNAL_ENERGY] };
            let pressure = piston.gas.pressure(gas, piston.volume.volume(z));
            let overpressure = pressure - piston.gas.ambient_pressure;
            *film_stress = film_stress.max(piston.end.stress(z, overpressure));
        };
        self.integrator.advance_at_most(&motion, target, &self.control, steps, &mut accepted)
    }

    fn sample(&self, phase: &Phase) -> Sample {
        let PistonState { height, speed, gas } = self.state();
        let volume = self.piston.volume.volume(height);
        let slope = self.piston.volume.slope(height);
        let pressure = self.piston.gas.pressure(gas, volume);
        let push = (pressure - self.piston.gas.ambient_pressure) * slope + self.piston.weight;
        Sample {
            time: self.integrator.time,
            z_centre: height,
            z_rim: height,
            z_max: height,
            vz: speed,
            volume,
            pressure,
            temperature: self.piston.gas.temperature(gas),
            // The lid can only push down. A force that presses the stack down acts on the stack.
            lid_force: if phase.packed { push.max(0.0) } else { 0.0 },
            support_impulse: self.piston.first_moment * speed
                - self.piston.film_weight * self.integrator.time,
            ledger: self.ledger(),
            gas: self.gas_balance(),
            ..Sample::default()
        }
    }

    /// z = H + p (dV/dz)/k: above H the volume is linear in z. Without gravity, so that a design has the
    /// same reference on the ground and in orbit.
    fn reference(&self, final_overpressure: f64) -> Option<Reference> {
        let end = &self.piston.end;
        if end.stiffness == 0.0 {
            return None;
        }
        let slope = self.piston.volume.slope(end.free_length);
        let shape = |overpressure: f64| {
            let height = end.free_length + overpressure * slope / end.stiffness;
            StaticShape { overpressure, volume: self.piston.volume.volume(height), height }
        };
        // Without overpressure the film has its free length.
        let at_end = shape(final_overpressure.max(0.0));
        Some(Reference { design: Ok(shape(end.design_overpressure)), end: Ok(at_end) })
    }

    fn film_stress(&self) -> f64 {
        self.film_stress
    }

    fn steps(&self) -> u64 {
        self.integrator.steps
    }
}
