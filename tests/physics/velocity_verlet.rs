//! Velocity Verlet: a second integrator of film, kept under tests. It shows that the interface of integrators
//! suffices for one that is written outside the solver.
//!
//! ```text
//! v½ = v + ½ h a        x' = x + h v½        gas: V → V'        v' = v½ + ½ h a'
//! h  = (target − t)/⌈(target − t)/h_stable⌉                h_stable = CFL 2/√(ω_film² + ω_gas² + ω_terms²)
//! Δ(½ Σ m v²) = ½ Σ (f + f')·Δx + ⅛ h² Σ m (|a'|² − |a|²)
//! ```
//!
//! The last term of the third line is what the step gave: the ledger has it, with the other sign, as numerical
//! dissipation. It goes to and fro and does not grow. Each step follows from the state alone, so a pause needs
//! no plan. Film in contact, film with loss or damping, and moving supports are refused.

use billow_solver::geometry::field::Field;
use billow_solver::geometry::shapes::{crossed_grid, icosphere, nodes_where, tube};
use billow_solver::integrators::energy_accounting::EnergyAccounting;
use billow_solver::integrators::{
    Advance, Budget, Computed, FilmSimulation, Integrator, Interval, SimulationSettings, StepAudit,
    StepMotion, StoredIntegrator,
};
use billow_solver::mechanics::forces::pressure::gas_frequency_squared;
use billow_solver::mechanics::gas::GasState;
use billow_solver::mechanics::supports::Supports;
use billow_solver::output::ledger::{Ledger, residuals};
use billow_solver::output::outcome::{AuditKind, Failure, FailureKind};
use billow_solver::platform::stopwatch::Stage;
use billow_solver::scene::Film;
use billow_solver::scene::film_support::{FilmSupport, Hold};
use billow_solver::scene::inflow::Inflow;
use billow_solver::scene::timeline::Phase;
use billow_solver::system::{Evaluation, FilmState, FilmSystem, PressureLoad, Workspace};
use nalgebra::{Matrix3, Vector3};

use crate::film_rig::{INFLOW, free, moving, nitrogen_gas};

/// Velocity Verlet.
#[derive(Debug, Clone)]
pub struct VelocityVerlet {
    /// CFL number: the step as a fraction of the stable step.
    cfl: f64,
    /// Forces now.
    workspace: Workspace,
    /// Energies now.
    evaluation: Evaluation,
    /// Scratch: the positions after a step, m.
    next: Field,
    accounting: EnergyAccounting,
}

impl VelocityVerlet {
    /// Starts at a state; `None` for a system with contact, loss, damping or moving supports.
    pub fn start(system: &FilmSystem, state: &FilmState, cfl: f64) -> Option<Self> {
        let dissipates = system.numerical_damping > 0.0
            || system.mass_damping > 0.0
            || system.model.creep.ratio > 0.0;
        let supports = &system.supports;
        let moves = !(supports.movers.is_empty() && supports.bodies.is_empty());
        if dissipates || moves || system.contact.is_some() {
            return None;
        }
        let mut workspace = Workspace::new(system, state);
        let evaluation = system.evaluate(state, &state.positions, state.time, &mut workspace);
        let accounting = EnergyAccounting::start(system, state);
        let next = state.positions.clone();
        let mut integrator = Self { cfl, workspace, evaluation, next, accounting };
        integrator.accounting.start_energy = integrator.ledger(system, state).stored();
        Some(integrator)
    }

    /// Adds half a step of `length` (s) to the velocities. Returns ⅛ h² Σ m |a|², J.
    fn half_kick(&self, system: &FilmSystem, state: &mut FilmState, length: f64) -> f64 {
        let (half, overpressure) = (0.5 * length, system.overpressure(state));
        let mut energy = 0.0;
        for node in 0..system.model.nodes() {
            let force = system.node_force(&self.workspace.forces, overpressure, node);
            let free = system.supports.projector(node) * force;
            let change = free * (system.model.inverse_mass[node] * half);
            state.velocities.set(node, state.velocities.get(node) + change);
            energy += 0.5 * system.model.mass[node] * change.norm_squared();
        }
        energy
    }

    /// A step of `length` (s) that ends at the time `end` (s).
    fn step(
        &mut self,
        system: &FilmSystem,
        state: &mut FilmState,
        (length, end): (f64, f64),
        inflow: Inflow,
        audit: &mut dyn StepAudit,
    ) -> Result<(), Failure> {
        let given_before = self.half_kick(system, state, length);
        audit.moved(StepMotion {
            start: state.time,
            length,
            from: &state.positions,
            velocities: &state.velocities,
            coefficients: [1.0, 1.0, 0.0],
        })?;
        let mut largest = 0.0_f64;
        for node in 0..system.model.nodes() {
            let displacement = state.velocities.get(node) * length;
            largest = largest.max(displacement.norm());
            self.next.set(node, state.positions.get(node) + displacement);
        }
        system.place_closing_nodes(&mut self.next);
        self.evaluation = system.evaluate(state, &self.next, end, &mut self.workspace);
        let volume = self.evaluation.volume;
        if largest > system.model.size() || !volume.is_finite() {
            return Err(failure(
                state,
                AuditKind::FiniteMotion,
                "farther than its size in one step",
            ));
        }
        match system.pressure_load {
            PressureLoad::Gas(_) if volume <= 0.0 => {
                return Err(failure(state, AuditKind::Volume, "gas volume"));
            }
            PressureLoad::Overpressure(pressure) => {
                self.accounting.works.gas += pressure * (volume - state.volume);
            }
            PressureLoad::Gas(_) => {}
        }
        let gas = system.gas_step(state, volume, length, inflow);
        self.accounting.commit_gas(system, state, gas, volume);
        self.workspace.commit(state, &self.next);
        let given_after = self.half_kick(system, state, length);
        self.accounting.works.numerical_dissipation += given_before - given_after;
        self.accounting.film_stress =
            self.accounting.film_stress.max(self.evaluation.largest_stress);
        Ok(())
    }
}

/// A failure at the time of a state.
fn failure(state: &FilmState, audit: AuditKind, place: &str) -> Failure {
    Failure::new(audit, state.time, place)
}

impl Integrator for VelocityVerlet {
    fn advance(
        &mut self,
        state: &mut FilmState,
        system: &FilmSystem,
        Interval { target, phase }: Interval<'_>,
        budget: Budget<'_>,
    ) -> Result<Advance, Failure> {
        while state.time < target {
            if *budget.steps == 0 {
                return Ok(Advance::Paused);
            }
            let remaining = target - state.time;
            let count = (remaining / self.next_step(system, state)).ceil().max(1.0);
            let length = remaining / count;
            let end = if count > 1.0 { state.time + length } else { target };
            let advances = end > state.time;
            if !advances || self.accounting.steps >= budget.step_limit {
                return Err(failure(state, AuditKind::StepLimit, "the whole film"));
            }
            *budget.steps -= 1;
            budget.stopwatch.begins(Stage::Update);
            if phase.packed {
                let gas = system.gas_step(state, state.volume, length, phase.inflow);
                self.accounting.commit_gas(system, state, gas, state.volume);
            } else {
                self.step(system, state, (length, end), phase.inflow, budget.audit)?;
            }
            state.time = end;
            self.accounting.steps += 1;
            budget.stopwatch.begins(Stage::Audit);
            budget.audit.record(system, state)?;
        }
        budget.audit.complete(system, state)?;
        Ok(Advance::Reached)
    }

    fn next_step(&self, system: &FilmSystem, state: &FilmState) -> f64 {
        let film = system.model.largest_frequency();
        let gas = match system.pressure_load {
            PressureLoad::Gas(gas) => {
                let stiffness = gas.gamma() * state.pressure;
                let (supports, forces) = (&system.supports, &self.workspace.forces);
                gas_frequency_squared(&system.model, supports, forces, stiffness, state.volume)
            }
            PressureLoad::Overpressure(_) => 0.0,
        };
        let terms = system.energy_terms.iter();
        let terms: f64 = terms.map(|term| term.frequency_squared(&system.model.mass)).sum();
        self.cfl * 2.0 / (film * film + gas + terms).sqrt()
    }

    fn computed(&self) -> Computed<'_> {
        Computed { workspace: &self.workspace, accounting: &self.accounting }
    }

    fn ledger(&self, system: &FilmSystem, state: &FilmState) -> Ledger {
        let of_node = |(mass, v): (&f64, Vector3<f64>)| 0.5 * mass * v.norm_squared();
        let kinetic = system.model.mass.iter().zip(state.velocities.iter()).map(of_node).sum();
        self.accounting.ledger(system, state, kinetic, self.evaluation.strain)
    }

    fn stored(&self) -> Option<StoredIntegrator> {
        None
    }

    fn boxed(&self) -> Box<dyn Integrator> {
        Box::new(self.clone())
    }
}

/// The same film at its state, with velocity Verlet at this CFL number.
pub fn with_velocity_verlet(film: FilmSimulation, cfl: f64) -> FilmSimulation {
    let (system, state, settings) = film.into_parts();
    let integrator = VelocityVerlet::start(&system, &state, cfl).unwrap();
    FilmSimulation::of(system, state, SimulationSettings { cfl, ..settings }, Box::new(integrator))
}

/// The ledgers of film at time 0 and at `samples` equal distances up to `end` (s).
pub fn ledgers(film: &mut FilmSimulation, end: f64, samples: u32, phase: &Phase) -> Vec<Ledger> {
    let mut series = vec![film.view().ledger()];
    for sample in 1..=samples {
        film.advance(end * f64::from(sample) / f64::from(samples), phase).unwrap();
        series.push(film.view().ledger());
    }
    series
}

/// The largest residual of a series of ledgers.
pub fn largest_residual(series: &[Ledger]) -> f64 {
    residuals(series).into_iter().fold(0.0, f64::max)
}

/// A sphere of film with the full stiffness under gas of 1 kPa, released without stress under gravity, with
/// central differences at this CFL number.
fn sphere(cfl: f64) -> FilmSimulation {
    let shell = icosphere(2, 0.5);
    let gas = nitrogen_gas();
    let film = Film { compression: 1.0, ..Film::PAPER_ELASTIC };
    let mass = 1000.0 * 0.5 / (296.8 * 293.0);
    let load = (PressureLoad::Gas(gas), gas.at_temperature(mass, 293.0));
    let still = Field::zeros(shell.positions.len());
    moving(&shell, &film, load, still, |system, settings| {
        system.gravity = Vector3::new(0.0, 300.0, -980.0);
        settings.cfl = cfl;
    })
}

/// A square sheet under tension, held at its edge, under a fixed overpressure and gravity, at rest in its plane.
struct HeldSheet {
    film: FilmSimulation,
    /// Frequency of its first mode, rad/s.
    frequency: f64,
    /// Amplitude of its first mode under the loads at rest, m.
    sag: f64,
}

const SIDE: f64 = 0.3;

fn first_mode(x: Vector3<f64>) -> f64 {
    let pi = std::f64::consts::PI;
    libm::sin(pi * x.x / SIDE) * libm::sin(pi * x.y / SIDE)
}

fn held_sheet(cfl: f64) -> HeldSheet {
    let (strain, overpressure, gravity) = (1e-3, 1.0, 9.8);
    let flat = crossed_grid(16, 16, SIDE, SIDE);
    let edge = nodes_where(&flat, |x| [x.x, x.y].iter().any(|x| *x < 1e-9 || *x > SIDE - 1e-9));
    let reference: Vec<_> = flat.positions.iter().map(|x| x / (1.0 + strain)).collect();
    let shell = flat.with_reference(&reference);
    let film = Film::PAPER_ELASTIC;
    let still = Field::zeros(shell.positions.len());
    let load = (PressureLoad::Overpressure(overpressure), GasState::default());
    let film_sheet = moving(&shell, &film, load, still, |system, settings| {
        system.supports.hold(&edge, "xyz");
        system.gravity = Vector3::new(0.0, 0.0, -gravity);
        settings.cfl = cfl;
    });
    let pi = std::f64::consts::PI;
    let stress = film.youngs_modulus * strain / (1.0 - film.poisson_ratio);
    let squared = stress / film.density * 2.0 * pi * pi / (SIDE * SIDE);
    let acceleration = overpressure / film.area_density() - gravity;
    let sag = 16.0 / (pi * pi) * acceleration / squared;
    HeldSheet { film: film_sheet, frequency: squared.sqrt(), sag }
}

/// Amplitude of the first mode of a sheet, m.
fn amplitude(film: &FilmSimulation) -> f64 {
    let (system, state) = (film.view().system, film.view().state);
    let (mut sum, mut norm) = (0.0, 0.0);
    for (mass, x) in system.model.mass.iter().zip(state.positions.iter()) {
        let shape = first_mode(x);
        sum += mass * shape * x.z;
        norm += mass * shape * shape;
    }
    sum / norm
}

#[test]
fn a_sphere_with_gas_closes_its_ledger_and_agrees_with_central_differences() {
    let end = 3e-3;
    let mut exact = sphere(0.005);
    exact.advance(end, &INFLOW).unwrap();
    let exact = exact.view().state;
    let off =
        |film: &FilmSimulation| film.view().state.positions.largest_displacement(&exact.positions);
    let moved = off(&sphere(0.4));
    let runs = [0.4, 0.2, 0.1].map(|cfl| {
        let mut film = with_velocity_verlet(sphere(cfl), cfl);
        let series = ledgers(&mut film, end, 30, &INFLOW);
        let mut central = sphere(cfl);
        ledgers(&mut central, end, 30, &INFLOW);
        let (now, last) = (film.view(), series[30]);
        let residual = largest_residual(&series);
        let pressure = now.state.pressure / exact.pressure - 1.0;
        let central = now.state.positions.largest_displacement(&central.view().state.positions);
        println!(
            "cfl {cfl}: {} steps, off {:e} m of {moved:e} m, off equal steps of central differences {central:e} m, \
             pressure {pressure:e}, ledger {residual:e}",
            now.steps(),
            off(&film),
        );
        assert!(last.gas_work > 1.0 && last.gravity_work > 0.1, "{last:?}");
        assert!(residual < 1e-4 * cfl * cfl, "{residual}");
        assert!(pressure.abs() < 3e-4 * cfl * cfl, "{pressure}");
        // With equal steps the two methods differ by rounding alone.
        assert!(central < 1e-6 * off(&film), "{central}");
        assert!((now.state.gas.mass / exact.gas.mass - 1.0).abs() < 1e-12);
        (now.steps() as f64, off(&film))
    });
    // The ends of the samples round the steps: they are not exactly halved.
    let orders: Vec<f64> = runs
        .windows(2)
        .map(|pair| libm::log(pair[0].1 / pair[1].1) / libm::log(pair[1].0 / pair[0].0))
        .collect();
    println!("orders {orders:?}");
    assert!(runs[2].1 < 1e-4 * moved, "{runs:?} of {moved}");
    assert!(orders.iter().all(|order| *order > 1.9 && *order < 2.1), "{orders:?}");
}

#[test]
fn a_held_sheet_swings_about_its_sag_with_the_period_of_a_membrane() {
    let HeldSheet { film, frequency, sag } = held_sheet(0.3);
    let central = film.clone();
    let mut film = with_velocity_verlet(film, 0.3);
    let period = 2.0 * std::f64::consts::PI / frequency;
    let start = film.view().state.positions.clone();
    let mut series = ledgers(&mut film, 0.5 * period, 20, &free());
    let lowest = amplitude(&film);
    let mut other = central;
    other.advance(0.5 * period, &free()).unwrap();
    let off = amplitude(&other) / lowest - 1.0;
    for sample in 1..=20 {
        film.advance(period * (0.5 + f64::from(sample) / 40.0), &free()).unwrap();
        series.push(film.view().ledger());
    }
    let back = amplitude(&film);
    let residual = largest_residual(&series);
    let last = series[20];
    println!(
        "half period {period:e}/2: {lowest:e} m of {:e}; period: {back:e}; explicit off {off:e}; residual {residual:e}; {} steps",
        2.0 * sag,
        film.view().steps(),
    );
    assert!((lowest / (2.0 * sag) - 1.0).abs() < 3e-3, "{lowest} {sag}");
    assert!(back.abs() < 1e-3 * sag.abs(), "{back} {sag}");
    assert!(off.abs() < 1e-9, "{off}");
    assert!(residual < 1e-7, "{residual}");
    assert!(last.gas_work > 0.0 && last.gravity_work < 0.0, "{last:?}");
    let now = film.view();
    for node in 0..start.len() {
        if now.system.supports.projector(node).norm() < 0.5 {
            assert_eq!(now.state.positions.get(node), start.get(node));
            assert_eq!(now.state.velocities.get(node), Vector3::zeros());
        }
    }
}

/// A tube with closing faces, whose lower rim slides in an oblique plane.
#[test]
fn closing_faces_and_oblique_supports_move_as_with_central_differences() {
    let cfl = 0.3;
    let start = || {
        let mut shell = tube(24, 6, 0.2, 0.4);
        assert_eq!(shell.close(|_| Matrix3::identity()).len(), 2);
        let gas = nitrogen_gas();
        let film = Film { compression: 1.0, ..Film::PAPER_ELASTIC };
        let gas_mass = 1000.0 * 0.05 / (296.8 * 293.0);
        let load = (PressureLoad::Gas(gas), gas.at_temperature(gas_mass, 293.0));
        let still = Field::zeros(shell.positions.len());
        moving(&shell, &film, load, still, |system, settings| {
            let support = FilmSupport {
                name: "rim".to_owned(),
                nodes: (0..24).collect(),
                hold: Hold::Plane(Vector3::new(0.0, 0.6, 0.8)),
                motion: None,
            };
            system.supports = Supports::new(&[support], &Field::of(&shell.positions));
            settings.cfl = cfl;
        })
    };
    let (mut central, mut film) = (start(), with_velocity_verlet(start(), cfl));
    let before = film.view().state.positions.clone();
    let series = ledgers(&mut film, 1e-3, 10, &free());
    ledgers(&mut central, 1e-3, 10, &free());
    let (now, residual) = (film.view().state, largest_residual(&series));
    let (moved, off) = (
        now.positions.largest_displacement(&before),
        now.positions.largest_displacement(&central.view().state.positions),
    );
    println!("tube: moved {moved:e} m, differs by {off:e} m, ledger {residual:e}");
    assert!(moved > 1e-3 && off < 1e-9 * moved, "{off} {moved}");
    assert!(residual < 1e-4, "{residual}");
    for node in 0..24 {
        let displacement = now.positions.get(node) - before.get(node);
        assert!(displacement.dot(&Vector3::new(0.0, 0.6, 0.8)).abs() < 1e-15, "{displacement}");
    }
}

#[test]
fn a_pause_changes_no_bit() {
    let whole = {
        let mut film = with_velocity_verlet(sphere(0.3), 0.3);
        film.advance(2e-3, &INFLOW).unwrap();
        film
    };
    let mut paused = with_velocity_verlet(sphere(0.3), 0.3);
    let mut pauses = 0;
    loop {
        let mut steps = 1 + pauses % 4;
        if paused.advance_at_most(2e-3, &INFLOW, &mut steps).unwrap() {
            break;
        }
        assert_eq!(steps, 0);
        pauses += 1;
    }
    assert!(pauses > 10, "{pauses}");
    let (a, b) = (whole.view(), paused.view());
    assert_eq!(a.state, b.state);
    assert_eq!(a.state.time.to_bits(), 2e-3_f64.to_bits());
    assert_eq!(a.accounting(), b.accounting());
    assert_eq!(a.ledger(), b.ledger());
}

#[test]
fn what_it_cannot_do_is_refused() {
    let starts = |change: fn(&mut FilmSystem)| {
        let (mut system, state, _) = sphere(0.3).into_parts();
        change(&mut system);
        VelocityVerlet::start(&system, &state, 0.3).is_some()
    };
    assert!(starts(|_| ()));
    assert!(!starts(|system| system.mass_damping = 1.0));
    assert!(!starts(|system| system.numerical_damping = 0.05));
    assert!(!starts(|system| system.model.creep.ratio = 0.1));
    let (system, state, settings) = sphere(0.3).into_parts();
    let integrator = VelocityVerlet::start(&system, &state, 0.3).unwrap();
    let settings = SimulationSettings { step_limit: 3, ..settings };
    let mut film = FilmSimulation::of(system, state, settings, Box::new(integrator));
    let failed = film.advance(1.0, &free()).unwrap_err();
    assert_eq!((failed.kind, film.view().steps()), (FailureKind::StepLimit, 3));
}
