//! The keys of a scene file's objects: mesh, inflow windows, supports, plates, moves, start, outputs.
//!
//! Paths are those within the object. Its reader asks for a key by name, in a `const` block, so that
//! a name without a row does not compile ([`super::key::named`]).

use super::key::Default::{Absent, Integer, Number, Required, Word};
use super::key::{Key, KeyKind};
use super::row::{above, from, key, likely, vector};
use super::study::{CLOCK, FLOW_RATE, FLOW_TABLE, INFLOW_MASS, KELVIN, SAMPLE_INTERVAL, TANK};
use super::words::{self, PROFILES, explained, plain, words};
use crate::input::units::Dimension;

/// A position, m.
const POSITION: KeyKind = vector(Dimension::Length, 1e4);
/// A direction, of any length.
const DIRECTION: KeyKind = vector(Dimension::Number, 1e6);
/// A velocity, m/s.
const VELOCITY: KeyKind = vector(Dimension::Velocity, 1e5);

/// What a support of a scene acts on.
const SUPPORT_TARGETS: &[words::Word] = &[
    explained("bottom_ring", "a ring of a design"),
    plain("top_ring"),
    explained("bottom_cap", "a cap of a design"),
    plain("top_cap"),
    explained("box", "nodes with min <= position <= max at the start"),
    explained("nodes", "nodes by number"),
    explained("plane", "nodes within tolerance of a plane at the start"),
    explained("boundary", "nodes on free edges of the film"),
    explained("loop", "nodes on one loop of free edges, by number"),
    explained("all", "every node of the film"),
];

/// The keys of a scene's inflow window.
#[rustfmt::skip]
pub static SCENE_WINDOW_KEYS: &[Key] = &[
    key("from", CLOCK, Number(0.0), "\"0 s\"", "Start."),
    key("to", CLOCK, Absent("solver.end_time"), "\"0.3 s\"", "End."),
    key("mass_flow_rate", FLOW_RATE, Absent("needed without table and tank"), "\"5 g/s\"",
        "Mass flow rate."),
    key("temperature", KELVIN, Number(293.0), "\"293 K\"", "Temperature of the gas let in."),
    key("mass", INFLOW_MASS, Absent("follows from the end"), "\"1 g\"",
        "Mass let in, in place of `to`; of a tank, the gas in it."),
    TANK[0],
    TANK[1],
];

/// The keys of `mesh` that hold one value.
#[rustfmt::skip]
pub static MESH_KEYS: &[Key] = &[
    key("positions", KeyKind::Text, Required, "\"bag.obj\"",
        "File of the film at the start, relative to this file: OBJ, STL, PLY, Gmsh (.msh) or FOLD, by its ending; \
         faces counter-clockwise seen from outside; polygons are cut into triangles."),
    key("scale", above(Dimension::Number, 0.0, 1e9), Number(1.0), "0.001",
        "Length of one unit of the mesh files, m."),
    key("unit", KeyKind::Text, Absent("that of scale"), "\"mm\"", "Unit of length of the mesh files, in place of scale."),
    key("texture_unit", likely(above(Dimension::Length, 0.0, 1e6), 1e-4, 1e3), Absent("texture coordinates are ignored"), "\"1 m\"",
        "Length of one unit of the texture coordinates (vt) of an OBJ file, which then are the stress-free shape."),
    key("weld", likely(from(Dimension::Length, 0.0, 1.0), 0.0, 0.1), Absent("nothing is welded"), "\"1 um\"",
        "Vertices of positions within this distance become one node; 0 joins vertices that coincide."),
    key("subdivisions", KeyKind::Integer(1, 1000), Integer(1), "2",
        "Pieces along each edge: every triangle is cut into the square of this number."),
];

/// The keys of a support that hold one value.
#[rustfmt::skip]
pub static SUPPORT_KEYS: &[Key] = &[
    key("on", KeyKind::Choice(SUPPORT_TARGETS), Required, "\"box\"", "What it acts on."),
    key("name", KeyKind::Text, Absent("the word of on, numbered where there are several"), "\"rim\"",
        "Name of its reaction in the summary."),
    key("min", POSITION, Absent("unbounded; so is a null component"), "[null, null, -0.001]",
        "Lower corner of the box."),
    key("max", POSITION, Absent("unbounded; so is a null component"), "[null, null, 0.001]",
        "Upper corner of the box."),
    key("point", POSITION, Absent("needed for plane"), "[0, 0, 0]", "A point on the plane."),
    key("normal", DIRECTION, Absent("needed for plane"), "[0, 0, 1]",
        "Normal of the plane, of any length."),
    key("tolerance", likely(from(Dimension::Length, 0.0, 1e3), 0.0, 1.0), Absent("a millionth of the film's size"),
        "\"1 mm\"", "Distance from the plane within which a node belongs to it."),
    key("loop", KeyKind::Integer(1, 1_000_000), Absent("needed for loop"), "1",
        "Number of a loop of free edges, as billow solve --check lists them."),
    key("fix", KeyKind::Text, Absent("needed; for plane, its normal component"), "\"xyz\"",
        "Displacement components it holds: letters of xyz, each once."),
];

/// The keys of a rigid plate that hold one value.
#[rustfmt::skip]
pub static PLATE_KEYS: &[Key] = &[
    key("name", KeyKind::Text, Absent("plate, numbered where there are several"), "\"floor\"",
        "Name of its force in the summary."),
    key("point", POSITION, Required, "[0, 0, 0]", "A point of the plate at the start."),
    key("normal", DIRECTION, Required, "[0, 0, 1]", "Normal towards the film, of any length."),
    key("until", CLOCK, Absent("to the end"), "\"0.1 s\"", "Time at which the plate is removed."),
];

/// The keys of `body`: a rigid plane that moves along its normal.
#[rustfmt::skip]
pub static BODY_KEYS: &[Key] = &[
    key("mass", likely(from(Dimension::Mass, 0.0, 1e9), 1e-6, 1e4), Required, "\"50 g\"",
        "Mass of the plane, without the film attached to it."),
    key("velocity", likely(from(Dimension::Velocity, -1e5, 1e5), -1e3, 1e3), Number(0.0), "\"1 m/s\"",
        "Velocity along the normal at the start."),
    key("force", likely(from(Dimension::Force, -1e12, 1e12), -1e6, 1e6), Number(0.0), "\"-10 N\"",
        "Constant force on it along the normal, weight included."),
];

/// The keys of `move` that hold one value.
#[rustfmt::skip]
pub static MOVE_KEYS: &[Key] = &[
    key("from", CLOCK, Number(0.0), "0", "Start."),
    key("to", CLOCK, Absent("solver.end_time"), "\"0.1 s\"", "End."),
    key("profile", KeyKind::Choice(&words(&PROFILES)), Word("smooth"), "\"linear\"",
        "How the motion grows from start to end."),
    key("translation", POSITION, Absent("none"), "[0, 0, \"10 mm\"]", "Translation at the end."),
];

/// The keys of `rotation` of a move.
#[rustfmt::skip]
pub static ROTATION_KEYS: &[Key] = &[
    key("axis", DIRECTION, Required, "[0, 0, 1]", "Axis, of any length."),
    key("centre", POSITION, Absent("the origin"), "[0, 0, 0]", "A point on the axis."),
    key("angle", likely(from(Dimension::Angle, -1e4, 1e4), -6.3, 6.3), Required, "\"30 deg\"",
        "Angle at the end, counter-clockwise seen against the axis."),
];

/// The keys of `start` that hold one value.
#[rustfmt::skip]
pub static START_KEYS: &[Key] = &[
    key("velocity", VELOCITY, Absent("at rest"), "[0, 0, \"1 m/s\"]", "Velocity of every node."),
];

/// The keys of `spin`: a rigid rotation at the start, added to the velocity.
#[rustfmt::skip]
pub static SPIN_KEYS: &[Key] = &[
    key("axis", DIRECTION, Required, "[0, 0, 1]", "Axis, of any length."),
    key("centre", POSITION, Absent("the origin"), "[0, 0, 0]", "A point on the axis."),
    key("rate", likely(from(Dimension::AngularVelocity, -1e6, 1e6), -1e3, 1e3), Required, "\"10 rad/s\"",
        "Angular velocity."),
];

/// The keys of `outputs` that hold one value.
#[rustfmt::skip]
pub static OUTPUT_KEYS: &[Key] = &[
    key("sample_interval", SAMPLE_INTERVAL, Number(0.001), "\"1 ms\"",
        "Time between samples of the history; at most a million samples in a run."),
    key("frames", KeyKind::Integer(0, 10_000), Integer(40), "40",
        "Number of shapes kept for --out, densest after the release; 0 for none."),
];

/// `gravity`: one number along z, or three.
#[rustfmt::skip]
pub(crate) static GRAVITY: [Key; 2] = [
    key("gravity", likely(from(Dimension::Acceleration, -1000.0, 1000.0), -100.0, 100.0), Number(0.0), "\"-9.80665 m/s2\"",
        "Acceleration of gravity along z, upward: -9.80665 on the ground; or a list of three."),
    key("gravity", vector(Dimension::Acceleration, 1000.0), Absent("none"), "[0, 0, -9.80665]",
        "Acceleration of gravity."),
];

/// A position in `outputs`: the nearest node or element is recorded.
pub(crate) static NEAR: Key = key("near", POSITION, Required, "[0, 0, 0.5]", "A position.");

/// The keys of objects that hold more than one value, and their meanings.
pub(crate) const OBJECT_MEANINGS: &[(&str, &str)] = &[
    (
        "mesh.reference",
        "Stress-free shape of the film: a file with the faces of positions in the same order \
         (of the film, or all; it has vertices of its own, so pieces may be cut apart). Default: \
         the shape at the start.",
    ),
    (
        "mesh.closure",
        "Faces that close the volume without being film: names of groups or objects of positions. \
         A vertex of no film moves with the rim of its faces, which takes its load. Default: none; \
         with gas, a fan over each free edge loop closes an open film.",
    ),
    ("gas.windows[].table", FLOW_TABLE),
    ("supports[].nodes", "Vertices by number, 0 for the first of the file."),
    ("supports[].body", "A rigid plane of this mass that moves along its normal as a free body."),
    ("supports[].move", "A prescribed motion of the nodes."),
    ("supports[].move.rotation", "A rotation about an axis."),
    ("contact.plates[].move", "A prescribed translation of the plate."),
    ("start.spin", "A rigid rotation, added to the velocity."),
    (
        "outputs.nodes",
        "Vertices recorded in history and summary: by number, 0 for the first of the file, or the \
         one nearest to a position; named by an object.",
    ),
    (
        "outputs.elements",
        "Triangles (of faces) recorded in history and summary: by number, 0 for the \
         first of the file, or the one nearest to a position; named by an object.",
    ),
];
