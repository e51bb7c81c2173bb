//! The table itself. Ranges are what a capsule can plausibly be made of: wide enough for any study,
//! narrow enough to catch millimetres given as metres.

use billow_solver::integrators::dormand_prince::DEFAULT_TOLERANCE;
use billow_solver::integrators::explicit::DEFAULT_CFL;

use super::{Default, Key, Kind, Quantity};
use crate::input::units::Dimension;

use Default::{Absent, Integer, Number, Required, Word};

pub(super) const fn from(dimension: Dimension, min: f64, max: f64) -> Kind {
    Kind::Quantity(Quantity { dimension, min, above: false, max, words: &[] })
}

pub(super) const fn above(dimension: Dimension, min: f64, max: f64) -> Kind {
    Kind::Quantity(Quantity { dimension, min, above: true, max, words: &[] })
}

pub(super) const fn key(
    path: &'static str,
    kind: Kind,
    default: Default,
    example: &'static str,
    doc: &'static str,
) -> Key {
    Key { path, kind, default, doc, example }
}

/// The objects of a study file and what they are about, in the order of the documentation.
pub const SECTIONS: &[(&str, &str)] = &[
    ("design", "The fold design: a six-fold-line pattern of N panels and M storeys on a cone."),
    ("film", "The film the capsule is made of."),
    ("gas", "The gas that deploys it, and what it exchanges with its surroundings."),
    ("gas.species", "A gas of its own: gas_constant and cp, both."),
    ("contact", "Contact of film with film."),
    ("solver", "How a job is computed."),
    ("solver.stepping", "How the step is chosen: adaptive (a tolerance) or fixed (a step)."),
    ("outputs", "What is stored."),
    ("outputs.thresholds", "Thresholds of the verdict."),
];

/// Largest whole number every JSON reader keeps exactly.
const LARGEST: i64 = 9_007_199_254_740_991;

const RADIUS: Kind = above(Dimension::Length, 0.0, 100.0);
pub(super) const FRACTION: Kind = above(Dimension::Number, 0.0, 1.0);
pub(super) const KELVIN: Kind = from(Dimension::Temperature, 1.0, 5000.0);
pub(super) const CLOCK: Kind = from(Dimension::Time, 0.0, 1e6);

/// Every key that holds one value.
#[rustfmt::skip]
pub static KEYS: &[Key] = &[
    key("format", Kind::Choice(&["billow-study"]), Word("billow-study"), "\"billow-study\"",
        "Name of the file format."),
    key("version", Kind::Integer(1, 1), Integer(1), "1",
        "Version of the file format; a newer one is refused."),
    key("name", Kind::Text, Absent("the file's name without .json"), "\"first\"",
        "Name of the study and of its results folder: letters, digits, - _ and dots."),
    key("question", Kind::Text, Word(""), "\"Which N deploys fastest?\"",
        "The question the study answers."),

    key("design.fit", Kind::Choice(&["cone", "angles", "height"]), Word("cone"), "\"height\"",
        "Which quantities are given: cone (top_radius, height; phi follows), angles (half_angle, or \
         top_radius and height, and alpha1_over_phi; the cone follows), height (height, \
         alpha1_over_phi; half angle and top radius follow)."),
    key("design.N", Kind::Integer(4, 1000), Required, "6", "Panels round a ring."),
    key("design.M", Kind::Integer(1, 1000), Required, "3", "Storeys."),
    key("design.bottom_radius", RADIUS, Required, "\"500 mm\"", "Radius of the bottom ring, r2."),
    key("design.top_radius", RADIUS, Absent("follows from the fit, where the fit allows"),
        "\"365 mm\"", "Radius of the top ring, r1: for cone, and nominal for angles."),
    key("design.height", RADIUS, Absent("follows from the fit, where the fit allows"), "\"1 m\"",
        "Height of the erected cone, H: for cone and height, and nominal for angles."),
    key("design.half_angle", from(Dimension::Angle, -1.57, 1.57),
        Absent("follows from the fit, or from top_radius and height"), "\"7.7 deg\"",
        "Half top angle: for angles, in place of top_radius and height."),
    key("design.alpha1_over_phi", above(Dimension::Number, 0.0, 100.0),
        Absent("follows from the fit, where the fit allows"), "1",
        "Ratio of the angles alpha1 and phi of a panel: for angles and height."),
    key("design.stowed_height", above(Dimension::Length, 0.0, 10.0), Number(0.04), "\"40 mm\"",
        "Height of the stowed stack."),
    key("design.subdivisions", Kind::Integer(1, 1000), Integer(8), "8",
        "Mesh subdivisions of every facet edge; models without a mesh ignore it."),
    key("design.chirality", Kind::Choice(&["same", "alternate"]), Word("same"), "\"alternate\"",
        "Whether storeys turn the same way or alternate."),
    key("design.caps", Kind::Choice(&["polygon"]), Word("polygon"), "\"polygon\"",
        "Shape of the end caps: N-gons sewn to the ring fold lines."),

    key("film.youngs_modulus", from(Dimension::Pressure, 1e3, 1e13), Number(3.45e9),
        "\"3.45 GPa\"", "Young's modulus, E."),
    key("film.poisson_ratio", from(Dimension::Number, 0.0, 0.499), Number(0.3), "0.3",
        "Poisson's ratio."),
    key("film.density", from(Dimension::Density, 1.0, 30_000.0), Number(1400.0),
        "\"1400 kg/m3\"", "Density."),
    key("film.thickness", from(Dimension::Length, 1e-7, 0.01), Number(25.4e-6), "\"25.4 um\"",
        "Thickness."),
    key("film.compression", from(Dimension::Number, 0.0, 1.0), Number(0.0), "0",
        "Compression fraction c: 0 is the tension field, 1 the full membrane stiffness."),
    key("film.viscosity", from(Dimension::Number, 0.0, 1.0), Number(0.1), "0.1",
        "Viscous damping ratio."),
    key("film.temperature", KELVIN, Number(293.0), "\"293 K\"", "Film temperature, constant."),

    key("gas.species",
        Kind::Choice(&["nitrogen", "air", "helium", "argon", "carbon_dioxide", "hydrogen"]),
        Word("nitrogen"), "\"nitrogen\"",
        "The gas: a name, or an object of gas_constant and cp."),
    key("gas.species.gas_constant", from(Dimension::SpecificHeat, 10.0, 10_000.0),
        Absent("that of the named species"), "\"296.803052 J/(kg K)\"", "Specific gas constant, R."),
    key("gas.species.cp", from(Dimension::SpecificHeat, 20.0, 50_000.0),
        Absent("that of the named species"), "\"1038.81 J/(kg K)\"",
        "Specific heat at constant pressure; above the gas constant."),
    key("gas.mass_flow_rate", from(Dimension::MassFlowRate, 0.0, 100.0), Required, "\"5 g/s\"",
        "Mass flow rate of every inflow window that gives none itself."),
    key("gas.inflow_temperature", KELVIN, Number(293.0), "\"293 K\"",
        "Temperature of the gas let in."),
    key("gas.residual_gas_mass", from(Dimension::Mass, 0.0, 10.0), Number(0.0), "\"0.05 g\"",
        "Residual gas in the stowed capsule."),
    key("gas.residual_gas", Kind::Choice(&["burst", "stored"]), Word("burst"), "\"stored\"",
        "How residual gas enters: burst (let in at burst_rate from release on, at inflow \
         temperature) or stored (inside from the start, at film temperature)."),
    key("gas.burst_rate", from(Dimension::MassFlowRate, 1e-9, 100.0), Number(0.005), "\"5 g/s\"",
        "Mass flow rate of a burst of residual gas."),
    key("gas.ambient_pressure", from(Dimension::Pressure, 0.0, 1e7), Number(0.0), "\"1 atm\"",
        "Pressure outside: 0 in orbit."),
    key("gas.heat_transfer",
        Kind::Quantity(Quantity {
            dimension: Dimension::HeatTransfer,
            min: 0.0,
            above: false,
            max: 1e6,
            words: &[("adiabatic", 0.0), ("isothermal", f64::INFINITY)],
        }),
        Number(0.3), "\"0.3 W/(m2 K)\"", "Heat transfer coefficient between gas and film."),
    key("gas.leak_area", from(Dimension::Area, 0.0, 100.0), Number(0.0), "\"1 mm2\"",
        "Area of the leak orifice."),
    key("gas.discharge_coefficient", FRACTION, Number(1.0), "0.62",
        "Discharge coefficient of the leak orifice."),

    key("contact.distance", above(Dimension::Length, 0.0, 0.1),
        Absent("0.4 of the smallest stowed gap"), "\"0.6 mm\"",
        "Distance at which film is held apart."),
    key("contact.friction", from(Dimension::Number, 0.0, 10.0), Number(0.0), "0.2",
        "Coulomb friction coefficient."),
    key("contact.adhesion", from(Dimension::Pressure, 0.0, 1e6), Number(0.0), "\"10 Pa\"",
        "Adhesive pull-off pressure."),

    key("gravity", from(Dimension::Acceleration, -1000.0, 1000.0), Number(0.0),
        "\"-9.80665 m/s2\"", "Acceleration along the axis, upward: -9.80665 standing on the ground."),
    key("strategy", Kind::Text, Word("direct"), "\"delayed\"",
        "The inflation strategy: one named under strategies, or direct (released at once, inflow \
         from release to the end)."),

    key("solver.model", Kind::Choice(&["piston", "film"]), Word("film"), "\"piston\"",
        "Which model computes the job: film (the whole film, with contact) or piston (one moving \
         mass)."),
    key("solver.end_time", above(Dimension::Time, 0.0, 1e6), Required, "\"0.5 s\"",
        "Simulated time."),
    key("solver.cfl", FRACTION, Number(DEFAULT_CFL), "0.45",
        "Share of the stable step film in motion takes (CFL number). Film that may meet film, has had \
         less than 5 % of its largest kinetic energy for 20 ms and touches nothing takes 16/9 of it, up \
         to 0.8."),
    key("solver.stepping.adaptive", above(Dimension::Number, 0.0, 0.1), Number(DEFAULT_TOLERANCE), "1e-9",
        "Relative error tolerance a step of an error-controlled step; the piston's."),
    key("solver.stepping.fixed", above(Dimension::Time, 0.0, 1.0),
        Absent("the step is error-controlled"), "\"10 us\"", "A fixed step; the piston's."),
    key("solver.step_limit", Kind::Integer(1, LARGEST), Integer(10_000_000), "10000000",
        "Steps after which a run stops with the status step_limit."),

    key("outputs.sample_interval", above(Dimension::Time, 0.0, 1e6), Number(0.001), "\"1 ms\"",
        "Time between samples of the history; at most a million samples a run."),
    key("outputs.frames", Kind::Integer(0, 10_000), Integer(40), "40",
        "Shapes kept of a run, densest after the release; 0 for none. Models without a shape \
         ignore it."),
    key("outputs.thresholds.deployed_volume", FRACTION, Number(0.93), "0.93",
        "Deployed needs this fraction of the reference volume."),
    key("outputs.thresholds.deployed_height", FRACTION, Number(0.95), "0.95",
        "Deployed needs this fraction of the reference height."),
    key("outputs.thresholds.stalled_volume", FRACTION, Number(0.85), "0.85",
        "Stalled is a mean volume below this fraction of the reference volume."),
    key("outputs.thresholds.close_margin", from(Dimension::Number, 0.0, 1.0), Number(0.02), "0.02",
        "A verdict with a smaller margin is marked close."),

    key("seed", Kind::Integer(0, LARGEST), Integer(0), "1",
        "Seed of the imperfection of the stowed shape; models without one ignore it."),
];

/// The keys of a strategy; paths are those within `strategies.<name>`.
#[rustfmt::skip]
pub static STRATEGY_KEYS: &[Key] = &[
    key("release_time", CLOCK, Number(0.0), "\"1 s\"",
        "How long the lid holds the stowed capsule."),
    key("preinflation_mass", from(Dimension::Mass, 0.0, 10.0), Number(0.0), "\"0.15 g\"",
        "Gas stored before the start, at film temperature, on top of residual gas."),
];

/// The keys of an inflow window; paths are those within `strategies.<name>.inflow[]`.
#[rustfmt::skip]
pub static WINDOW_KEYS: &[Key] = &[
    key("from", CLOCK, Absent("the release time"), "\"5 s\"", "Start, since the start of the run."),
    key("to", CLOCK, Absent("the end time of the run"), "\"12 s\"",
        "End, since the start of the run."),
    key("rate", from(Dimension::MassFlowRate, 0.0, 100.0), Absent("gas.mass_flow_rate"),
        "\"1 g/s\"", "Mass flow rate."),
    key("temperature", KELVIN, Absent("gas.inflow_temperature"), "\"293 K\"",
        "Temperature of the gas let in."),
];
