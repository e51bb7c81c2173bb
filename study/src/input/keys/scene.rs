//! The keys of a scene file: those it shares with a study, and its own.

use std::sync::LazyLock;

use billow_solver::integrators::explicit::DEFAULT_CFL;

use super::Default::{Absent, Integer, Number, Required, Word};
use super::table::{CLOCK, FRACTION, KELVIN, KEYS, above, from, key};
use super::{Key, Kind, Quantity, Table};
use crate::input::units::Dimension;

/// The objects of a scene file that hold single values, in the order of the documentation.
const SECTIONS: &[(&str, &str)] = &[
    ("design", "The fold design of a capsule: this, or mesh."),
    ("film", "The film."),
    (
        "gas",
        "What presses from inside: a fixed `pressure`, or a gas with inflow windows, heat and leak. \
         Without it nothing presses.",
    ),
    ("gas.species", "A gas of its own: gas_constant and cp, both."),
    ("contact", "Film against film and against plates."),
    ("solver", "How it is computed."),
];

/// Keys that hold more than one value, beside the sections.
const STRUCTURED: &[&str] =
    &["mesh", "gas.windows", "contact.plates", "supports", "start", "gravity", "outputs"];

/// Keys of the study that a scene has too.
fn shared(path: &str) -> bool {
    let own = ["design.caps", "gas.mass_flow_rate", "gas.inflow_temperature", "gas.burst_rate"];
    let sections = ["design.", "film.", "gas.", "contact."];
    path == "solver.step_limit"
        || path == "seed"
        || (sections.iter().any(|section| path.starts_with(section))
            && !own.contains(&path)
            && !path.starts_with("gas.residual"))
}

/// The keys of a scene file.
pub static SCENE: LazyLock<Table> = LazyLock::new(|| {
    let all = || KEYS.iter().filter(|key| shared(key.path)).chain(OWN_KEYS);
    let below = |section: &'static str| {
        all().filter(move |key| {
            key.path.rsplit_once('.').map_or("", |(parent, _)| parent) == section
        })
    };
    let sections = std::iter::once("").chain(SECTIONS.iter().map(|(path, _)| *path));
    Table::new("a scene", sections.flat_map(below).collect(), SECTIONS, STRUCTURED)
});

const fn vector(dimension: Dimension, most: f64) -> Kind {
    Kind::Vector(Quantity { dimension, min: -most, above: false, max: most, words: &[] })
}

const PLACE: Kind = vector(Dimension::Length, 1e4);
const DIRECTION: Kind = vector(Dimension::Number, 1e6);
const SPEED: Kind = vector(Dimension::Velocity, 1e5);

/// Keys of a scene's sections that a study has not, or has otherwise.
#[rustfmt::skip]
static OWN_KEYS: &[Key] = &[
    key("format", Kind::Choice(&["billow-scene"]), Word("billow-scene"), "\"billow-scene\"",
        "Name of the file format."),
    key("version", Kind::Integer(1, 1), Integer(1), "1",
        "Version of the file format; a newer one is refused."),
    key("release_time", CLOCK, Number(0.0), "\"1 s\"",
        "Until when the film is packed: between a base and a lid at the contact distance from it, or, \
        without contact, with every node held where it starts."),

    key("design.caps", Kind::Choice(&["polygon", "circular"]), Word("polygon"), "\"polygon\"",
        "Shape of the end caps: N-gons sewn to the ring fold lines, or discs (shape erected only)."),
    key("design.shape", Kind::Choice(&["stowed", "erected"]),
        Absent("stowed; erected where solver.static is true"), "\"erected\"",
        "Where the capsule starts: folded to its stack, or rolled onto its cone."),

    key("gas.pressure", from(Dimension::Pressure, -1e9, 1e9), Absent("the gas decides"),
        "\"1 kPa\"", "A fixed overpressure that follows the surface, in place of a gas; the film may \
        be open."),
    key("gas.initial_mass", from(Dimension::Mass, 0.0, 1e6),
        Absent("that of initial_pressure, else none"), "\"0.05 g\"", "Gas inside at the start."),
    key("gas.initial_pressure", from(Dimension::Pressure, 0.0, 1e9),
        Absent("that of initial_mass"), "\"1 kPa\"",
        "Absolute pressure inside at the start, in place of initial_mass."),
    key("gas.initial_temperature", KELVIN, Absent("film.temperature"), "\"293 K\"",
        "Temperature of the gas inside at the start."),

    key("contact.enabled", Kind::Flag, Absent("true; false where solver.static is true"), "true",
        "Whether film is kept from passing through film; false lets it pass, uncounted."),
    key("contact.adhesion_range", above(Dimension::Length, 0.0, 0.1),
        Absent("contact.distance"), "\"1 mm\"",
        "How far beyond the contact distance adhesion pulls."),

    key("solver.end_time", above(Dimension::Time, 0.0, 1e6), Absent("needed unless static"),
        "\"0.3 s\"", "Simulated time."),
    key("solver.static", Kind::Flag, Absent("false"), "true",
        "Look for the state of rest under gas.pressure instead of moving."),
    key("solver.cfl", FRACTION, Number(DEFAULT_CFL), "0.45",
        "Share of the stable step film in motion takes (CFL number). Film that may meet film, has had \
         less than 5 % of its largest kinetic energy for 20 ms and touches nothing takes 16/9 of it, up \
         to 0.8."),
    key("solver.mass_damping", from(Dimension::Frequency, 0.0, 1e9), Number(0.0), "\"10 1/s\"",
        "Mass damping c in m a = f - c m v."),
];

/// The keys of a scene's inflow window.
#[rustfmt::skip]
pub static SCENE_WINDOW_KEYS: &[Key] = &[
    key("from", CLOCK, Number(0.0), "\"0 s\"", "Start."),
    key("to", CLOCK, Absent("solver.end_time"), "\"0.3 s\"", "End."),
    key("rate", from(Dimension::MassFlowRate, 0.0, 100.0), Required, "\"5 g/s\"",
        "Mass flow rate."),
    key("temperature", KELVIN, Number(293.0), "\"293 K\"", "Temperature of the gas let in."),
];

/// The keys of `mesh` that hold one value.
#[rustfmt::skip]
pub static MESH_KEYS: &[Key] = &[
    key("positions", Kind::Text, Required, "\"bag.obj\"",
        "OBJ file of the film where it starts, relative to the scene file: v and f lines, faces \
         counter-clockwise seen from outside; polygons are cut into fans."),
    key("scale", above(Dimension::Number, 0.0, 1e9), Number(1.0), "0.001",
        "Metres a unit of the OBJ files."),
    key("weld", from(Dimension::Length, 0.0, 1.0), Absent("nothing is welded"), "\"1 um\"",
        "Vertices of positions no further apart become one node; 0 welds those that coincide."),
];

/// The keys of a support that hold one value.
#[rustfmt::skip]
pub static SUPPORT_KEYS: &[Key] = &[
    key("on", Kind::Choice(&[
        "ring", "cap", "bottom_ring", "top_ring", "bottom_cap", "top_cap", "box", "nodes", "plane",
        "boundary", "all",
    ]), Required, "\"box\"",
        "What it acts on: ring or cap (designs; with which), box (nodes with min <= place <= max at the \
         start), nodes (by number), plane (nodes within tolerance of it at the start), boundary (nodes \
         on free edges of the film), all."),
    key("name", Kind::Text, Absent("the word of on, numbered where there are several"), "\"rim\"",
        "Name its reaction is told by."),
    key("which", Kind::Choice(&["bottom", "top"]), Absent("needed for ring and cap"), "\"bottom\"",
        "Which ring or cap."),
    key("min", PLACE, Absent("unbounded; so is a null part"), "[null, null, -0.001]",
        "Lower corner of the box."),
    key("max", PLACE, Absent("unbounded; so is a null part"), "[null, null, 0.001]",
        "Upper corner of the box."),
    key("point", PLACE, Absent("needed for plane"), "[0, 0, 0]", "A point on the plane."),
    key("normal", DIRECTION, Absent("needed for plane"), "[0, 0, 1]",
        "Normal of the plane, of any length."),
    key("tolerance", from(Dimension::Length, 0.0, 1e3), Absent("a millionth of the film's size"),
        "\"1 mm\"", "How far from the plane a node still belongs to it."),
    key("fix", Kind::Text, Absent("needed, but for plane: its normal component"), "\"xyz\"",
        "Displacement components held: letters of xyz, each once."),
];

/// The keys of a rigid plate that hold one value.
#[rustfmt::skip]
pub static PLATE_KEYS: &[Key] = &[
    key("name", Kind::Text, Absent("plate, numbered where there are several"), "\"floor\"",
        "Name its force is told by."),
    key("point", PLACE, Required, "[0, 0, 0]", "A point of it at the start."),
    key("normal", DIRECTION, Required, "[0, 0, 1]", "Normal towards the film, of any length."),
    key("until", CLOCK, Absent("it stays"), "\"0.1 s\"", "When it is gone."),
];

/// The keys of `body`: a rigid plane that moves along its normal.
#[rustfmt::skip]
pub static BODY_KEYS: &[Key] = &[
    key("mass", from(Dimension::Mass, 0.0, 1e9), Required, "\"50 g\"",
        "Mass without the film bound to it."),
    key("velocity", from(Dimension::Velocity, -1e5, 1e5), Number(0.0), "\"1 m/s\"",
        "Velocity along the normal at the start."),
    key("force", from(Dimension::Force, -1e12, 1e12), Number(0.0), "\"-10 N\"",
        "Constant force on it along the normal, weight included."),
];

/// The keys of `move` that hold one value.
#[rustfmt::skip]
pub static MOVE_KEYS: &[Key] = &[
    key("from", CLOCK, Number(0.0), "0", "Start."),
    key("to", CLOCK, Absent("solver.end_time"), "\"0.1 s\"", "End."),
    key("profile", Kind::Choice(&["linear", "smooth"]), Word("smooth"), "\"linear\"",
        "linear: constant velocity; smooth: 3 s^2 - 2 s^3, starts and ends at rest."),
    key("translation", PLACE, Absent("none"), "[0, 0, \"10 mm\"]", "Translation at the end."),
];

/// The keys of `rotation` of a move.
#[rustfmt::skip]
pub static ROTATION_KEYS: &[Key] = &[
    key("axis", DIRECTION, Required, "[0, 0, 1]", "Axis, of any length."),
    key("centre", PLACE, Absent("the origin"), "[0, 0, 0]", "A point on the axis."),
    key("angle", from(Dimension::Angle, -1e4, 1e4), Required, "\"30 deg\"",
        "Angle at the end, counter-clockwise seen against the axis."),
];

/// The keys of `start` that hold one value.
#[rustfmt::skip]
pub static START_KEYS: &[Key] = &[
    key("velocity", SPEED, Absent("at rest"), "[0, 0, \"1 m/s\"]", "Velocity of every node."),
    key("velocities", Kind::Text, Absent("none"), "\"velocities.obj\"",
        "OBJ file whose vertices are the velocities (m/s) of those of mesh.positions, added to the \
         others."),
];

/// The keys of `spin`: a rigid rotation at the start, added to the velocity.
#[rustfmt::skip]
pub static SPIN_KEYS: &[Key] = &[
    key("axis", DIRECTION, Required, "[0, 0, 1]", "Axis, of any length."),
    key("centre", PLACE, Absent("the origin"), "[0, 0, 0]", "A point on the axis."),
    key("rate", from(Dimension::AngularVelocity, -1e6, 1e6), Required, "\"10 rad/s\"",
        "Angular velocity."),
];

/// The keys of `outputs` that hold one value.
#[rustfmt::skip]
pub static OUTPUT_KEYS: &[Key] = &[
    key("sample_interval", above(Dimension::Time, 0.0, 1e6), Number(0.001), "\"1 ms\"",
        "Time between samples of the history; at most a million samples a run."),
    key("frames", Kind::Integer(0, 10_000), Integer(40), "40",
        "Shapes kept for --out, densest after the release; 0 for none."),
];

/// `gravity`: one number along z, or three.
#[rustfmt::skip]
pub(crate) static GRAVITY: [Key; 2] = [
    key("gravity", from(Dimension::Acceleration, -1000.0, 1000.0), Number(0.0), "\"-9.80665 m/s2\"",
        "Acceleration of gravity along z, upward: -9.80665 on the ground; or a list of three."),
    key("gravity", vector(Dimension::Acceleration, 1000.0), Absent("none"), "[0, 0, -9.80665]",
        "Acceleration of gravity."),
];

/// A place in `outputs`: the node or element nearest to it is meant.
pub(crate) static NEAR: Key = key("near", PLACE, Required, "[0, 0, 0.5]", "A place.");

/// Flat coordinates of a corner in `mesh.reference`.
pub(crate) static FLAT: Kind = from(Dimension::Length, -1e4, 1e4);
