//! Gas in a rigid vessel and under a plate: by film with the explicit step, and by the model piston.
//!
//! ```text
//! filling from vacuum at T0:   m T = m0 T0 + (m − m0) γ T_in
//! blow-down, choked:           T/T0 = (1 + (γ−1) t/(2τ))^−2,  p/p0 = (T/T0)^(γ/(γ−1))
//!                              τ = V/(C_d A √(γ R T0) (2/(γ+1))^((γ+1)/(2(γ−1))))
//! cooling:                     T − T_film ~ exp(−h A t/(m cv))
//! injected:                    x = C t^1.5,  C² = ṁ cp T_in/(M (0.75/(γ−1) + 1.125)),  T = T_in 2γ/(3γ−1)
//! spring:                      M ẍ = p0 A ((L0/x)^γ − 1)             T_lin = 2π √(M L0/(γ p0 A))
//! ```
//!
//! Film: two plates close the volume with walls that are no film; a moving plate is a rigid plane.

use billow_solver::integrators::dormand_prince::{Control, DEFAULT_TOLERANCE};
use billow_solver::mechanics::gas::Gas;
use billow_solver::models::film::Rings;
use billow_solver::models::piston::{EndFilm, Piston, PistonRun, PistonState, VolumeLaw};
use billow_solver::models::run::Model;
use billow_solver::output::history::Sample;
use billow_solver::scene::Species;

use super::prelude::*;
use super::rig::{inflow, stopped};
use super::row::self_convergence_order;
use super::shapes::gas_column;

/// Nodes of the plates of a column of gas.
const LOWER: [u32; 4] = [0, 1, 2, 3];
const UPPER: [u32; 4] = [4, 5, 6, 7];
/// Area of a plate, m².
const AREA: f64 = 0.5;
/// Temperature of the film, K.
const FILM_TEMPERATURE: f64 = 293.0;

/// A vessel or a plate on gas.
struct Body {
    model: Box<dyn Model>,
    /// Start of the names of its quantities.
    prefix: &'static str,
    /// Whether it is a packed piston: a rigid vessel.
    packed: bool,
}

impl Body {
    fn film(film: FilmRun) -> Self {
        Self { model: Box::new(film), prefix: "", packed: false }
    }

    fn piston(piston: PistonRun, packed: bool) -> Self {
        Self { model: Box::new(piston), prefix: "model piston: ", packed }
    }

    /// Advances it to a time, s.
    fn advance(&mut self, target: f64, phase: &Phase) -> Result<Sample> {
        let phase = Phase { packed: self.packed, ..*phase };
        self.model.advance(target, &phase).map_err(|failure| stopped(&failure))?;
        Ok(self.model.sample(&phase))
    }
}

fn nitrogen() -> Gas {
    Gas::new(&nitrogen_supply(), FILM_TEMPERATURE, 1.0)
}

/// A piston on V = A z + V0 without an end.
fn tube(area: f64, offset: f64, mass: f64, gas: Gas) -> Piston {
    let volume = VolumeLaw::Uniform { area, offset };
    let (first_moment, weight, film_weight) = (mass, 0.0, 0.0);
    Piston { volume, mass, weight, first_moment, film_weight, end: EndFilm::none(), gas }
}

fn control(stepping: Stepping) -> Control {
    Control { stepping, step_limit: 10_000_000 }
}

/// A rigid vessel of this height (m) with gas of this mass (kg) and temperature (K): of film, and as a packed piston.
fn vessels(
    rig: &Rig,
    height: f64,
    supply: GasSupply,
    [mass, temperature]: [f64; 2],
) -> Result<[Body; 2]> {
    let shell = gas_column(AREA, height);
    let gas = Gas::new(&supply, FILM_TEMPERATURE, shell.reference_area());
    let state = PistonState { height: 1.0, speed: 0.0, gas: gas.at_temperature(mass, temperature) };
    let piston = tube(0.0, AREA * height, 1.0, gas);
    let run = PistonRun::new(piston, 0.0, state, control(Stepping::Adaptive(DEFAULT_TOLERANCE)));
    let supply = GasSupply { initial_mass: mass, ..supply };
    let filling = Filling::Gas { supply, initial_temperature: temperature };
    let supports = vec![held([LOWER, UPPER].concat(), "xyz")];
    let scene = FilmScene { filling, supports, ..free_film(shell, Film::PAPER_ELASTIC) };
    let film = FilmRun::with(rig.start(&scene)?, &scene, None);
    Ok([Body::film(film), Body::piston(run, true)])
}

/// Filling of a vessel that contains gas, and of an empty one.
pub fn tank_filling(rig: &Rig) -> Outcome {
    let (rate, height) = (5e-3, 0.6);
    let [initial, start, entering, band] = entry(
        "tank_filling",
        ["initial_mass", "initial_temperature", "inflow_temperature", "band"],
    );
    let phase = inflow(rate, entering);
    let mut judged = Vec::new();
    for mut tank in vessels(rig, height, nitrogen_supply(), [initial, start])? {
        for row in rows("tank_filling") {
            let now = tank.advance((row[0] - initial) / rate, &phase)?;
            let quantity = format!("{}T at {} kg, K", tank.prefix, row[0]);
            judged.push(Row::new(&quantity, now.temperature, row[1], band));
            let quantity = format!("{}mass defect at {} kg", tank.prefix, row[0]);
            judged.push(Row::at_most(&quantity, (now.gas.mass / row[0] - 1.0).abs(), 1e-12));
        }
    }
    let [mut empty, _] = vessels(rig, height, nitrogen_supply(), [0.0, start])?;
    for until in [1e-3, 1.0] {
        let now = empty.advance(until, &phase)?;
        let quantity = format!("T {until} s after the start from vacuum, K");
        judged.push(Row::new(&quantity, now.temperature, nitrogen().gamma() * entering, band));
    }
    Ok(judged)
}

/// Blow-down through a choked orifice into vacuum.
pub fn blow_down(rig: &Rig) -> Outcome {
    let (height, mass, start) = (1.0, 0.6, 300.0);
    let supply = GasSupply { leak_area: 1e-3, ..nitrogen_supply() };
    let (gamma, band) = (nitrogen().gamma(), number("blow_down/band"));
    let sound = (gamma * supply.species.gas_constant * start).sqrt();
    let choked = libm::pow(2.0 / (gamma + 1.0), (gamma + 1.0) / (2.0 * (gamma - 1.0)));
    let tau = AREA * height / (supply.discharge_coefficient * supply.leak_area * sound * choked);
    let mut judged = Vec::new();
    for mut tank in vessels(rig, height, supply, [mass, start])? {
        let first = tank.advance(0.0, &Phase::default())?;
        for share in [0.1, 0.5, 1.0, 3.0] {
            let now = tank.advance(share * tau, &Phase::default())?;
            let root = 1.0 + 0.5 * (gamma - 1.0) * share;
            let cooled = 1.0 / (root * root);
            let expanded = libm::pow(cooled, gamma / (gamma - 1.0));
            let name = |quantity| format!("{}{quantity} at {share} tau", tank.prefix);
            judged.push(Row::new(&name("T/T0"), now.temperature / start, cooled, band));
            let pressures = now.pressure / first.pressure;
            judged.push(Row::new(&name("p/p0"), pressures, expanded, band));
        }
    }
    Ok(judged)
}

/// The gas in a rigid vessel approaches the temperature of its film.
pub fn cooling(rig: &Rig) -> Outcome {
    let (coefficient, mass, start) = (5.0, 0.02, 450.0);
    let heat_transfer = HeatTransfer::Coefficient(coefficient);
    let supply = GasSupply { heat_transfer, ..nitrogen_supply() };
    let capacity = mass * (number("nitrogen/cp") - number("nitrogen/gas_constant"));
    let rate = coefficient * 2.0 * AREA / capacity;
    let band = number("cooling/band");
    let mut judged = Vec::new();
    for mut tank in vessels(rig, 1.0, supply, [mass, start])? {
        let mut heat = 0.0;
        for elapsed in [0.3, 1.0, 4.0] {
            let now = tank.advance(elapsed / rate, &Phase::default())?;
            let share = (now.temperature - FILM_TEMPERATURE) / (start - FILM_TEMPERATURE);
            let prefix = tank.prefix;
            let quantity =
                format!("{prefix}(T - T_film)/(T0 - T_film) at {elapsed} time constants");
            judged.push(Row::new(&quantity, share, libm::exp(-elapsed), band));
            heat = now.gas.heat;
        }
        let expected = capacity * (start - FILM_TEMPERATURE) * (libm::exp(-4.0) - 1.0);
        let quantity = format!("{}heat from the film, J", tank.prefix);
        judged.push(Row::new(&quantity, heat, expected, band));
    }
    Ok(judged)
}

/// A plate on gas.
struct Plate {
    area: f64,
    height: f64,
    mass: f64,
    speed: f64,
    force: f64,
    supply: GasSupply,
    temperature: f64,
}

impl Plate {
    /// As film, with an integrator at a CFL number.
    fn film(&self, rig: &Rig, integrator: IntegratorKind, cfl: f64) -> Result<FilmRun> {
        let shell = gas_column(self.area, self.height);
        // The mass of the plate includes its film.
        let of_film = 0.5 * shell.reference_area() * Film::PAPER_ELASTIC.area_density();
        let (mass, normal) = (self.mass - of_film, Vector3::z());
        let body = PlaneBody { normal, mass, velocity: self.speed, force: self.force };
        let plate = on_plane(UPPER.to_vec(), body);
        let supports = vec![held(LOWER.to_vec(), "xyz"), held(UPPER.to_vec(), "xy"), plate];
        let supply = self.supply.clone();
        let filling = Filling::Gas { supply, initial_temperature: self.temperature };
        let mut scene = FilmScene { supports, filling, ..free_film(shell, Film::PAPER_ELASTIC) };
        (scene.solver.cfl, scene.solver.integrator) = (cfl, integrator);
        let (top_ring, storeys) = (UPPER.to_vec(), Vec::new());
        let (stowed_height, pleats) = (0.0, Vec::new());
        let rings = Rings { top_ring, top_centre: UPPER[0], storeys, stowed_height, pleats };
        Ok(FilmRun::with(rig.start(&scene)?, &scene, Some(rings)))
    }

    /// As the model piston, from a time (s).
    fn piston(&self, from: f64, stepping: Stepping) -> PistonRun {
        let gas = Gas::new(&self.supply, FILM_TEMPERATURE, 1.0);
        let piston = Piston { weight: self.force, ..tube(self.area, 0.0, self.mass, gas) };
        let state = PistonState {
            height: self.height,
            speed: self.speed,
            gas: gas.at_temperature(self.supply.initial_mass, self.temperature),
        };
        PistonRun::new(piston, from, state, control(stepping))
    }
}

fn injection() -> Phase {
    inflow(number("injected_piston/rate"), number("injected_piston/inflow_temperature"))
}

/// Position, m, of the plate at a time, s: x = C t^1.5.
pub fn injected_exact(time: f64) -> f64 {
    let [mass, rate, entering] = entry("injected_piston", ["mass", "rate", "inflow_temperature"]);
    let (cp, gamma) = (number("nitrogen/cp"), nitrogen().gamma());
    let square = rate * cp * entering / (mass * (0.75 / (gamma - 1.0) + 1.125));
    square.sqrt() * libm::pow(time, 1.5)
}

/// The plate on the closed form at 1 ms.
fn injected_start() -> Plate {
    let [mass, rate, entering, c, start] =
        entry("injected_piston", ["mass", "rate", "inflow_temperature", "C", "start"]);
    let gamma = nitrogen().gamma();
    Plate {
        area: AREA,
        height: c * libm::pow(start, 1.5),
        mass,
        speed: 1.5 * c * start.sqrt(),
        force: 0.0,
        supply: GasSupply { initial_mass: rate * start, ..nitrogen_supply() },
        temperature: entering * 2.0 * gamma / (3.0 * gamma - 1.0),
    }
}

/// The plate driven by an inflow, from the closed form at 1 ms to 50 ms, by film with an integrator at a CFL number; and
/// its height, m.
pub fn injected(rig: &Rig, integrator: IntegratorKind, cfl: f64) -> Result<(FilmSimulation, f64)> {
    let [start, end] = entry("injected_piston", ["start", "end"]);
    let mut run = injected_start().film(rig, integrator, cfl)?;
    advance(&mut run.film, end - start, &injection())?;
    let height = run.view().state.positions.z[UPPER[0] as usize];
    Ok((run.film, height))
}

/// The same by the model piston: its steps, and its height, m.
pub fn injected_model(stepping: Stepping) -> Result<(u64, f64)> {
    let mut run = injected_start().piston(number("injected_piston/start"), stepping);
    let ended = run.advance(number("injected_piston/end"), &injection());
    ended.map_err(|failure| stopped(&failure))?;
    Ok((run.steps(), run.state().height))
}

/// The injected piston: film with the step halved twice, the model with adaptive and fixed steps.
pub fn injected_piston(rig: &Rig) -> Outcome {
    let [expected, band, least] = entry("injected_piston", ["position_at_50_ms", "band", "order"]);
    let run = |cfl| injected(rig, IntegratorKind::Explicit, cfl);
    let [(_, coarse), (_, middle), (finest, fine)] = [run(0.16)?, run(0.08)?, run(0.04)?];
    let [rate, entering, end] = entry("injected_piston", ["rate", "inflow_temperature", "end"]);
    let enthalpy = rate * end * number("nitrogen/cp") * entering;
    let mut judged = vec![
        Row::refined("x at 50 ms, m", [coarse, middle, fine], expected, band, Some(least)),
        Row::new(
            "kinetic energy over enthalpy in",
            finest.view().ledger().kinetic / enthalpy,
            number("injected_piston/kinetic_share_of_enthalpy"),
            number("injected_piston/offset_band"),
        ),
    ];
    for (name, stepping) in
        [("adaptive", Stepping::Adaptive(DEFAULT_TOLERANCE)), ("fixed step", Stepping::Fixed(2e-5))]
    {
        let quantity = format!("model piston: x at 50 ms, {name}, m");
        judged.push(Row::new(&quantity, injected_model(stepping)?.1, expected, band));
    }
    Ok(judged)
}

/// The injected piston from rest on an empty dead volume.
pub fn injected_piston_dead_volume(rig: &Rig) -> Outcome {
    let area = 0.1;
    let [volume, band, expected, mass, end] = entry(
        "injected_piston",
        ["offset_volume", "offset_band", "offset_position_at_50_ms", "mass", "end"],
    );
    let height = volume / area;
    let plate = Plate {
        area,
        height,
        mass,
        speed: 0.0,
        force: 0.0,
        supply: nitrogen_supply(),
        temperature: FILM_TEMPERATURE,
    };
    let run = |mut body: Body| Ok(body.advance(end, &injection())?.z_rim - height);
    let film = |cfl: f64| -> Result<f64> {
        run(Body::film(plate.film(rig, IntegratorKind::Explicit, cfl)?))
    };
    let values = [film(0.04)?, film(0.02)?, film(0.01)?];
    let piston = plate.piston(0.0, Stepping::Adaptive(DEFAULT_TOLERANCE));
    let model = run(Body::piston(piston, false))?;
    Ok(vec![
        Row::new("x at 50 ms, m", values[2], expected, band)
            .with_order(self_convergence_order(values)),
        Row::new("model piston: x at 50 ms, m", model, expected, band),
    ])
}

/// Period of a mass on gas against a constant force, at three amplitudes.
pub fn gas_spring(rig: &Rig) -> Outcome {
    let [gamma, band] = entry("gas_spring", ["gamma", "band"]);
    // cp/cv = γ exactly.
    let species = Species::constant(296.8, 296.8 * gamma / (gamma - 1.0));
    let (mass, length, area, pressure) = (0.4, 0.3, 0.02, 2000.0);
    let linear = TAU * (mass * length / (gamma * pressure * area)).sqrt();
    let initial_mass = pressure * area * length / (species.gas_constant * FILM_TEMPERATURE);
    let mut judged = Vec::new();
    for row in rows("gas_spring") {
        let (amplitude, ratio) = (row[0], row[1]);
        let plate = Plate {
            area,
            height: length * (1.0 + amplitude),
            mass,
            speed: 0.0,
            force: -pressure * area,
            supply: GasSupply { species, initial_mass, ..nitrogen_supply() },
            temperature: FILM_TEMPERATURE * libm::pow(1.0 + amplitude, 1.0 - gamma),
        };
        // After one period the plate is at rest: the remaining speed over the acceleration is the error of the period.
        let force = pressure * area * (libm::pow(1.0 + amplitude, -gamma) - 1.0);
        let period = |mut body: Body| -> Result<f64> {
            let speed = body.advance(ratio * linear, &Phase::default())?.vz;
            Ok(ratio - speed / (force / mass) / linear)
        };
        let film = |cfl: f64| period(Body::film(plate.film(rig, IntegratorKind::Explicit, cfl)?));
        let values = [film(0.8)?, film(0.4)?, film(0.2)?];
        let model = period(Body::piston(plate.piston(0.0, Stepping::Adaptive(1e-10)), false))?;
        let quantity = format!("period over linear period at amplitude {amplitude}");
        judged.push(
            Row::new(&quantity, values[2], ratio, band).with_order(self_convergence_order(values)),
        );
        judged.push(Row::new(&format!("model piston: {quantity}"), model, ratio, band));
    }
    Ok(judged)
}
