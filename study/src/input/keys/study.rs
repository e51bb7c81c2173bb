//! The keys of a study file. To add a key, add a row: reading, default, errors, `billow keys --schema`,
//! `billow keys` and docs/reference/keys.md follow from it.
//!
//! Ranges are hard limits. Within them, a plausible range (`likely`) says what an inflatable capsule has;
//! chosen, generous. A value outside is used, with a warning that a unit may be missing.

use billow_solver::integrators::dormand_prince::DEFAULT_TOLERANCE;
use billow_solver::scene::DEFAULT_CFL;
use billow_solver::scene::paper::{LOSS_FACTOR, LOSS_FREQUENCY, NUMERICAL_DAMPING};

use super::key::Default::{Absent, Integer, Number, Required, Word};
use super::key::{Key, KeyKind};
use super::quantity::Quantity;
use super::row::{above, from, key, likely};
use super::words::{
    CAPS, CHIRALITIES, FITS, HEAT_TRANSFER_WORDS, INTEGRATORS, MODEL_KINDS, RESIDUAL_GAS, SPECIES,
    plain, words,
};
use crate::input::units::Dimension;

/// The objects of a study file that hold single values, in the order of the documentation.
pub const SECTIONS: &[(&str, &str)] = &[
    ("design", "The fold design: a six-fold-line pattern of N panels and M storeys on a cone."),
    ("film", "The film the capsule is made of."),
    (
        "creases",
        "Stiffness of the fold lines of film with bending. Without this section they turn freely.",
    ),
    ("gas", "The gas that deploys the capsule, and its exchange with the surroundings."),
    ("gas.species", "A gas by its constants: gas_constant and cp, both."),
    ("contact", "Contact of film with film."),
    ("solver", "How a job is computed."),
    ("solver.stepping", "How the step is chosen: adaptive (a tolerance) or fixed (a step)."),
    ("outputs", "What is stored."),
    ("outputs.thresholds", "Thresholds of the verdict."),
    (
        "job_limits",
        "Limits of every job. A job that reaches one has a row without measures and can go on with a \
         higher limit; they change no result and no job id.",
    ),
];

/// Keys of a study that hold more than one value, beside the sections, and their meanings.
pub(crate) const STRUCTURED: &[(&str, &str)] = &[
    (
        "design.mesh",
        "Film from a mesh in place of a fold design: the name of a file beside the study, or an object with the keys of a \
         scene's mesh (positions, reference, closure, weld, …). The fold's keys and measures are then absent.",
    ),
    ("design.unit", "Unit of length of the mesh, as in \"mm\". Default: m."),
    (
        "supports",
        "What holds the film. Default: the bottom ring of a capsule, in xyz. Film from a mesh: the supports of a scene \
         (box, nodes, plane, boundary, loop, all); none by default.",
    ),
    (
        "strategies",
        "Inflation strategies: named schedules. `direct` always exists: released at once, inflow \
         from release to the end.",
    ),
    (
        "solver.meshes",
        "Meshes (design.subdivisions) on which each point runs, two or three, as in [4, 8]. Its row has the promised \
         measures extrapolated from the two finest, with their error; --runs shows the runs. One, as in [4]: that mesh \
         alone, without pilots. Default: design.subdivisions, with pilots where a limit needs an error.",
    ),
    ("grid", "What varies: every combination of the axes, the first varying slowest."),
    (
        "samples",
        "Inputs that are not known exactly, as in {\"number\": 64, \"of\": {\"film.youngs_modulus\": {\"normal\": [\"3.45 GPa\", \
         \"5 %\"]}}}: every point runs with each sample, and the answer says how probable it is that it is safe, how its \
         measures spread, and which input makes the spread. {\"assumed\": true}: the range of what is assumed, and of \
         friction. method: sobol (default; more samples extend it) or \
         latin_hypercube; seed; correlations.",
    ),
    (
        "optimise",
        "A search of the point with the smallest measure that keeps the limits, as in {\"minimise\": \"peak_vz\", \"over\": \
         {\"mass_flow_rate\": [\"1 g/s\", \"10 g/s\"]}, \"budget\": 40}: two measures give the front between them; over has \
         ranges of quantities and whole numbers, and lists of words; budget is the number of points; batch; seed.",
    ),
    (
        "replicates",
        "Parameters whose values repeat each point, as in {\"seed\": 5} (seeds 1 to 5) or {\"seed\": [1, 2, 7]}. Each \
         run is a row; tables, comparisons and charts show median, range and proportions.",
    ),
    (
        "limits",
        "What a result must meet to be safe, as in {\"peak_speed\": \"< 25 m/s\", \"verdict\": \"deployed\"}: columns of the \
         table with <, <=, > or >= and a quantity, a verdict, true or false. They change no job.",
    ),
    (
        "assumed",
        "Ranges of what is assumed, as in {\"loss_factor\": [0.01, 0.02], \"heat_transfer\": [0.1, 1]}: the columns \
         <measure>_assumed and the limits count the change over them. Default: the ranges of the table of mesh errors, \
         loss factor 0.003 to 0.03, heat transfer 0.1 to 1 W/(m2 K). They change no job.",
    ),
    (
        "units",
        "Units in which tables, charts and answers show keys and columns, as in {\"mass_flow_rate\": \
         \"g/s\", \"t_90_z_rim\": \"ms\"}. Default: the unit that this file writes for the key, SI for a \
         column. Stored numbers, csv and json are SI.",
    ),
];

/// Largest whole number that every JSON reader keeps exactly, 2^53 − 1.
const MAX_EXACT_INTEGER: i64 = 9_007_199_254_740_991;

/// A radius or height of a capsule, m.
const RADIUS: KeyKind = likely(above(Dimension::Length, 0.0, 100.0), 0.01, 20.0);
/// A fraction above 0, up to 1.
pub(super) const FRACTION: KeyKind = above(Dimension::Number, 0.0, 1.0);
/// A temperature, K.
pub(super) const KELVIN: KeyKind = likely(from(Dimension::Temperature, 1.0, 5000.0), 50.0, 1500.0);
/// A time since the start of the run, s.
pub(super) const CLOCK: KeyKind = likely(from(Dimension::Time, 0.0, 1e6), 0.0, MAX_PLAUSIBLE_TIME);
/// A simulated time, s.
pub(super) const END_TIME: KeyKind =
    likely(above(Dimension::Time, 0.0, 1e6), 1e-3, MAX_PLAUSIBLE_TIME);
/// Time between samples, s.
pub(super) const SAMPLE_INTERVAL: KeyKind = likely(above(Dimension::Time, 0.0, 1e6), 1e-6, 1.0);
/// A mass flow rate, kg/s.
pub(super) const FLOW_RATE: KeyKind =
    likely(from(Dimension::MassFlowRate, 0.0, 100.0), 0.0, MAX_PLAUSIBLE_FLOW_RATE);
/// A mass of gas in a folded capsule, kg.
pub(super) const GAS_MASS: KeyKind = likely(from(Dimension::Mass, 0.0, 10.0), 0.0, 0.02);
/// A mass of gas that a window lets in, kg.
pub(super) const INFLOW_MASS: KeyKind = likely(above(Dimension::Mass, 0.0, 1e4), 0.0, 1.0);
/// Longest plausible run, s. Chosen: a deployment takes seconds, a slow one minutes.
const MAX_PLAUSIBLE_TIME: f64 = 300.0;
/// Largest plausible mass flow rate, kg/s. Chosen: it fills a capsule of 1 m3 in milliseconds.
const MAX_PLAUSIBLE_FLOW_RATE: f64 = 0.5;

/// The keys of a tank, of an inflow window.
#[rustfmt::skip]
pub(super) const TANK: [Key; 2] = [
    key("tank_pressure", likely(above(Dimension::Pressure, 0.0, 1e9), 1e3, 1e8), Absent("no tank"), "\"50 bar\"",
        "Pressure of a tank when it opens, in place of mass_flow_rate: `mass` of gas at `temperature` blows down through \
         orifice_area, without heat from its wall, until its pressure is gas.ambient_pressure."),
    key("orifice_area", likely(above(Dimension::Area, 0.0, 1.0), 1e-10, 1e-2), Absent("no tank"), "\"0.5 mm2\"",
        "Area of the orifice of the tank times its discharge coefficient."),
];

/// Every key that holds one value.
#[rustfmt::skip]
pub static KEYS: &[Key] = &[
    key("format", KeyKind::Choice(&[plain("billow-study")]),
        Word("billow-study"), "\"billow-study\"", "Name of the file format.")
        .study_only(),
    key("version", KeyKind::Integer(1, 1), Integer(1), "1",
        "Version of the file format; a newer one is refused.")
        .study_only(),
    key("name", KeyKind::Text, Absent("the name of the file without .json"), "\"first\"",
        "Name of the study and of its results folder: letters, digits, - _ and dots.")
        .study_only(),
    key("question", KeyKind::Text, Word(""), "\"Which N deploys fastest?\"",
        "The question the study answers.")
        .study_only(),

    key("design.fit", KeyKind::Choice(&words(&FITS)), Word("cone"), "\"height\"",
        "Which quantities of the fold are given, and which follow."),
    key("design.N", KeyKind::Integer(4, 1000), Required, "6", "Number of panels of a ring."),
    key("design.M", KeyKind::Integer(1, 1000), Required, "3", "Number of storeys."),
    key("design.bottom_radius", RADIUS, Required, "\"500 mm\"", "Radius of the bottom ring, r2."),
    key("design.top_radius", RADIUS, Absent("follows from the fit, where the fit allows"),
        "\"365 mm\"", "Radius of the top ring, r1: for cone, and nominal for angles."),
    key("design.height", RADIUS, Absent("follows from the fit, where the fit allows"), "\"1 m\"",
        "Height of the erected cone, H: for cone and height, and nominal for angles."),
    key("design.half_angle", likely(from(Dimension::Angle, -1.57, 1.57), -1.3, 1.3),
        Absent("follows from the fit, or from top_radius and height"), "\"7.7 deg\"",
        "Half top angle: for angles, in place of top_radius and height."),
    key("design.alpha1_over_phi", above(Dimension::Number, 0.0, 100.0),
        Absent("follows from the fit, where the fit allows"), "1",
        "Ratio of the angles alpha1 and phi of a panel: for angles and height."),
    key("design.stowed_height", likely(above(Dimension::Length, 0.0, 10.0), 1e-3, 1.0), Number(0.04), "\"40 mm\"",
        "Height of the stowed stack."),
    key("design.subdivisions", KeyKind::Integer(1, 1000), Integer(8), "8",
        "Mesh subdivisions of every facet edge. Models without a mesh ignore it."),
    key("design.chirality", KeyKind::Choice(&words(&CHIRALITIES)), Word("same"), "\"alternate\"",
        "Turning direction of successive storeys."),
    key("design.caps", KeyKind::Choice(&[words(&CAPS)[0]]), Word("polygon"), "\"polygon\"",
        "Shape of the end caps.")
        .study_only(),

    key("film.youngs_modulus", likely(from(Dimension::Pressure, 1e3, 1e13), 1e5, 1e12), Number(3.45e9),
        "\"3.45 GPa\"", "Young's modulus, E."),
    key("film.poisson_ratio", from(Dimension::Number, 0.0, 0.499), Number(0.3), "0.3",
        "Poisson's ratio."),
    key("film.density", likely(from(Dimension::Density, 1.0, 30_000.0), 100.0, 20_000.0), Number(1400.0),
        "\"1400 kg/m3\"", "Density."),
    key("film.thickness", likely(from(Dimension::Length, 1e-7, 0.01), 1e-6, 2e-3), Number(25.4e-6), "\"25.4 um\"",
        "Thickness."),
    key("film.compression", from(Dimension::Number, 0.0, 1.0), Number(0.0), "0",
        "Compression fraction c: 0 is the tension field, 1 the full membrane stiffness."),
    key("film.bending", KeyKind::Flag, Absent("false"), "true",
        "Bending stiffness E t^3/(12(1-nu^2)) of the film; without creases, fold lines turn freely. It needs film.compression 1."),
    key("film.yield_moment", likely(above(Dimension::Force, 0.0, 1e6), 1e-5, 1e3), Absent("the film does not yield"),
        "\"0.011 N\"", "Largest bending moment of film and creases for each metre of edge: yield stress times thickness^2 over 4. It needs film.bending."),
    key("film.loss_factor", from(Dimension::Number, 0.0, 0.5), Number(LOSS_FACTOR), "0.01",
        "Largest loss factor (tan delta) of the film's material. The default is assumed; polyimide: 0.003 to 0.03."),
    key("film.loss_frequency", likely(from(Dimension::Frequency, 0.1, 10_000.0), 0.1, 10_000.0), Number(LOSS_FREQUENCY),
        "\"100 Hz\"", "Frequency of the largest loss factor; the loss falls above and below it."),
    key("film.numerical_damping", from(Dimension::Number, 0.0, 1.0), Number(NUMERICAL_DAMPING),
        "1e-4", "Numerical damping ratio of an element's highest mode while it carries tension; no film property."),
    key("film.temperature", KELVIN, Number(293.0), "\"293 K\"", "Film temperature, constant."),

    key("creases.length_scale", likely(above(Dimension::Length, 0.0, 100.0), 1e-3, 1.0), Absent("fold lines turn freely"),
        "\"20 mm\"", "Length of flat film that bends as easily as the fold line, L*. Thin polymer: assumed 5 to 100 mm."),
    key("creases.rest_angle", likely(from(Dimension::Angle, 0.0, core::f64::consts::PI), 0.1, core::f64::consts::PI), Absent("the angle in which it is packed"), "\"90 deg\"",
        "Fold angle at rest, in the packed direction: 0 is flat. It needs creases.length_scale."),

    key("gas.species", KeyKind::Choice(&words(&SPECIES)), Word("nitrogen"), "\"nitrogen\"",
        "The gas: a name, or its formula (N2, He, Ar, CO2, H2), or an object of gas_constant and cp. cp of carbon dioxide changes with temperature.")
        .excludes(&["gas.species.gas_constant", "gas.species.cp"]),
    key("gas.species.gas_constant", likely(from(Dimension::SpecificHeat, 10.0, 10_000.0), 40.0, 4500.0),
        Absent("that of the named species"), "\"296.803052 J/(kg K)\"", "Specific gas constant, R."),
    key("gas.species.cp", likely(from(Dimension::SpecificHeat, 20.0, 50_000.0), 100.0, 20_000.0),
        Absent("that of the named species"), "\"1038.81 J/(kg K)\"",
        "Specific heat at constant pressure; above the gas constant."),
    key("gas.mass_flow_rate", FLOW_RATE,
        Absent("needed where an inflow window gives none"), "\"5 g/s\"",
        "Mass flow rate of every inflow window that gives none.")
        .study_only(),
    key("gas.inflow_temperature", KELVIN, Number(293.0), "\"293 K\"",
        "Temperature of the gas let in.")
        .study_only(),
    key("gas.residual_gas_mass", GAS_MASS, Number(0.0), "\"0.05 g\"",
        "Residual gas in the stowed capsule.")
        .study_only(),
    key("gas.residual_gas", KeyKind::Choice(&words(&RESIDUAL_GAS)), Word("burst"), "\"stored\"",
        "How residual gas enters. It is gas.species (nitrogen by default), also where it stands for air.")
        .study_only(),
    key("gas.burst_rate", likely(from(Dimension::MassFlowRate, 1e-9, 100.0), 1e-9, MAX_PLAUSIBLE_FLOW_RATE), Number(0.005), "\"5 g/s\"",
        "Mass flow rate of a burst of residual gas.")
        .study_only(),
    key("gas.ambient_pressure", likely(from(Dimension::Pressure, 0.0, 1e7), 0.0, 1e6), Number(0.0), "\"1 atm\"",
        "Pressure outside: 0 in orbit. Above 0 the stowed capsule must contain gas: residual_gas ambient."),
    key("gas.heat_transfer",
        KeyKind::Quantity(Quantity {
            dimension: Dimension::HeatTransfer,
            min: 0.0,
            above: false,
            max: 1e6,
            plausible: Some([0.0, 1e4]),
            words: HEAT_TRANSFER_WORDS,
        }),
        Number(0.3), "\"0.3 W/(m2 K)\"", "Heat transfer coefficient between gas and film."),
    key("gas.leak_area", likely(from(Dimension::Area, 0.0, 100.0), 0.0, 0.05), Number(0.0), "\"1 mm2\"",
        "Area of the leak orifice. It flows both ways: gas of the same species enters at film \
          temperature where ambient_pressure is above the pressure inside."),
    key("gas.discharge_coefficient", FRACTION, Number(1.0), "0.62",
        "Discharge coefficient of the leak orifice and of the vent."),
    key("gas.vent_area", likely(from(Dimension::Area, 0.0, 100.0), 0.0, 0.05), Number(0.0), "\"1 cm2\"",
        "Area of a vent beside the leak, when it is fully open."),
    key("gas.vent_from", CLOCK, Number(0.0), "\"0.2 s\"", "Time from which the vent can be open."),
    key("gas.vent_to", CLOCK, Absent("solver.end_time"), "\"0.25 s\"", "Time at which the vent closes."),
    key("gas.vent_opens_at", likely(from(Dimension::Pressure, 0.0, 1e9), 0.0, 1e7), Number(0.0), "\"2 kPa\"",
        "Overpressure at which the vent begins to open, as a relief valve does; 0: it is fully open at any pressure."),
    key("gas.vent_full_at", likely(from(Dimension::Pressure, 0.0, 1e9), 0.0, 1e7),
        Absent("1.1 times gas.vent_opens_at"), "\"3 kPa\"",
        "Overpressure at which the vent is fully open."),

    key("contact.distance", likely(above(Dimension::Length, 0.0, 0.1), 1e-6, 0.02),
        Absent("0.4 of the design's reference gap; of a mesh, 0.4 of its smallest gap"), "\"0.6 mm\"",
        "Distance at which contact starts to push layers of film apart. The reference gap is the \
         smallest stowed gap of the design at 16 subdivisions; it does not depend on the mesh."),
    key("contact.friction", from(Dimension::Number, 0.0, 10.0), Number(0.0), "0.2",
        "Coulomb friction coefficient."),
    key("contact.adhesion", likely(from(Dimension::Pressure, 0.0, 1e6), 0.0, 1e5), Number(0.0), "\"10 Pa\"",
        "Adhesive pull-off pressure."),

    key("gravity", likely(from(Dimension::Acceleration, -1000.0, 1000.0), -100.0, 100.0), Number(0.0),
        "\"-9.80665 m/s2\"",
        "Acceleration of gravity along the axis, upward: -9.80665 for a capsule that stands on the \
         ground.")
        .study_only(),
    key("strategy", KeyKind::Text, Word("direct"), "\"delayed\"",
        "The inflation strategy: one named under strategies, or direct (released at once, inflow \
         from release to the end).")
        .study_only(),

    key("solver.model", KeyKind::Choice(&words(&MODEL_KINDS)), Word("film"), "\"piston\"",
        "Which model computes the job.")
        .study_only(),
    key("solver.integrator", KeyKind::Choice(&words(&INTEGRATORS)), Word("explicit"), "\"explicit\"",
        "How film moves in time."),
    key("solver.end_time", END_TIME, Required, "\"0.5 s\"",
        "Simulated time.")
        .study_only(),
    key("solver.cfl", FRACTION, Number(DEFAULT_CFL), "0.45",
        "Fraction of the stable step that film takes (CFL number). Quiescent film (less than 5 % of \
         its largest kinetic energy for 20 ms) that touches nothing takes 16/9 of it, up to 0.8."),
    key("solver.stepping.adaptive", above(Dimension::Number, 0.0, 0.1), Number(DEFAULT_TOLERANCE), "1e-9",
        "Relative error tolerance of one step, for error-controlled steps. Model piston only.")
        .excludes(&["solver.stepping.fixed"])
        .study_only(),
    key("solver.stepping.fixed", likely(above(Dimension::Time, 0.0, 1.0), 1e-9, 0.01),
        Absent("the step is error-controlled"), "\"10 us\"", "A fixed step. Model piston only.")
        .excludes(&["solver.stepping.adaptive"])
        .study_only(),
    key("solver.step_limit", KeyKind::Integer(1, MAX_EXACT_INTEGER), Integer(10_000_000), "10000000",
        "Number of steps after which a run stops with the status step_limit."),

    key("outputs.sample_interval", SAMPLE_INTERVAL, Number(0.001), "\"1 ms\"",
        "Time between samples of the history; at most a million samples in a run.")
        .study_only(),
    key("outputs.frames", KeyKind::Integer(0, 10_000), Integer(40), "40",
        "Number of shapes kept of a run, densest after the release; 0 for none. Models without a \
         shape ignore it.")
        .study_only(),
    key("outputs.thresholds.deployed_volume", FRACTION, Number(0.93), "0.93",
        "A deployed capsule has at least this fraction of the reference volume.")
        .study_only(),
    key("outputs.thresholds.deployed_height", FRACTION, Number(0.95), "0.95",
        "A deployed capsule has at least this fraction of the reference height.")
        .study_only(),
    key("outputs.thresholds.stalled_volume", FRACTION, Number(0.85), "0.85",
        "A stalled capsule has a mean volume below this fraction of the reference volume.")
        .study_only(),
    key("outputs.thresholds.near_threshold_margin", from(Dimension::Number, 0.0, 1.0), Number(0.02), "0.02",
        "A verdict with a smaller margin is marked near_threshold.")
        .study_only(),

    key("job_limits.wall_time", likely(above(Dimension::Time, 0.0, 1e9), 1.0, 1e7), Absent("no limit"), "\"2 h\"",
        "Wall time of one attempt at a job; then its status is timeout.")
        .study_only(),
    key("job_limits.steps", KeyKind::Integer(1, MAX_EXACT_INTEGER), Absent("no limit"), "1000000",
        "Steps of a job; then its status is step_limit. A job within 128 steps of its end may finish.")
        .study_only(),
    key("job_limits.memory", likely(above(Dimension::Memory, 0.0, 1e15), 1e6, 1e13), Absent("no limit"), "\"2 GB\"",
        "Memory of a job, by its estimate; a job that needs more has the status out_of_memory.")
        .study_only(),

    key("seed", KeyKind::Integer(0, MAX_EXACT_INTEGER), Integer(0), "1",
        "Seed of the imperfection of the stowed shape. Models without one ignore it."),
    key("imperfection_amplitude", likely(above(Dimension::Length, 0.0, 0.1), 1e-9, 0.02),
        Absent("0.2 of the design's reference gap; of film from a mesh half of its contact distance"), "\"0.15 mm\"",
        "Amplitude of the imperfection: its largest displacement, of a capsule along z. Equal displacements on \
         every mesh of a design. Seed 0 has none."),
];

/// The keys of `grid`, and their meanings.
pub(crate) const GRID_MEANINGS: &[(&str, &str)] = &[
    (
        "grid.<key>",
        "An axis: any other key, by its last part or its whole path, with a list of values or a \
         range {\"from\", \"to\", \"steps\" (number of values, both ends counted) or \"step\", \
         \"spacing\": \"linear\" or \"log\"}.",
    ),
    (
        "grid.<key>.bisect",
        "A search: {\"bisect\": [low, high], \"on\": \"verdict\", \"safe\" or a limit, \"tolerance\": a percentage (of \
         high - low; with logarithmic spacing of the value), \"spacing\"}. It finds where the outcome \
         changes, for every combination of the other axes.",
    ),
    ("grid.zip", "Groups of keys that vary together: lists of equal length."),
    ("grid.points", "Single points, after the product."),
    (
        "grid.filter",
        "Condition that a point of the product must meet, as in \"feasible and M >= 3\".",
    ),
    ("strategies.<name>.inflow", "Inflow windows; overlapping ones add up."),
    ("strategies.<name>.inflow[].table", FLOW_TABLE),
    ("supports[].nodes", "Of film from a mesh: vertices by number, 0 for the first of the file."),
    (
        "supports[].body",
        "Of film from a mesh: a rigid plane of this mass that moves along its normal as a free body.",
    ),
    ("supports[].move", "Of film from a mesh: a prescribed motion of the nodes."),
    ("supports[].move.rotation", "A rotation about an axis."),
];

/// Meaning of a table of an inflow window.
pub(super) const FLOW_TABLE: &str = "Mass flow rate over time, in place of to and mass_flow_rate: points, as in [[\"0 s\", \"0 g/s\"], [\"0.2 s\", \
     \"5 g/s\"]], linear between them, times counted from `from`; or the name of a CSV file with columns of both (SI, or \
     units in parentheses in its first line).";
