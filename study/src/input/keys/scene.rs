//! The keys of a scene file: those it shares with a study, and those of its own sections.

use super::key::Default::{Absent, Integer, Number, Word};
use super::key::{Key, KeyKind};
use super::row::{above, from, key, likely};
use super::study::{CLOCK, END_TIME, KELVIN};
use super::words::{CAPS, SHAPES, plain, words};
use crate::input::units::Dimension;

/// The objects of a scene file that hold single values, in the order of the documentation.
pub(super) const SCENE_SECTIONS: &[(&str, &str)] = &[
    ("design", "The fold design of a capsule: this, or mesh."),
    ("film", "The film."),
    ("creases", "Stiffness of the fold lines of a capsule's film with bending."),
    (
        "gas",
        "The pressure inside: a fixed `pressure`, or a gas with inflow windows, heat and leak. \
         Without this section there is none.",
    ),
    ("gas.species", "A gas by its constants: gas_constant and cp, both."),
    ("contact", "Contact of film with film and with plates."),
    ("solver", "How the scene is computed."),
];

/// Keys of a scene that hold more than one value, beside the sections, and their meanings.
pub(crate) const SCENE_STRUCTURED: &[(&str, &str)] = &[
    ("mesh", "Film of any shape, from files: this, or design."),
    ("gas.windows", "Inflow windows; overlapping ones add up. Default: none."),
    (
        "contact.plates",
        "Rigid plates the film touches, on the side their normal points to. Default: none.",
    ),
    (
        "supports",
        "What holds the film, or moves it. Default: a design stands on its bottom ring, held in \
         xyz; a mesh is free.",
    ),
    ("start", "Velocities at the start. Default: at rest."),
    ("gravity", "Acceleration of gravity: one number along z, upward, or a list of three."),
    ("outputs", "What is recorded."),
];

/// Keys of a scene's sections that a study does not have, or has with another meaning.
#[rustfmt::skip]
pub(super) static SCENE_KEYS: &[Key] = &[
    key("format", KeyKind::Choice(&[plain("billow-scene")]),
        Word("billow-scene"), "\"billow-scene\"", "Name of the file format."),
    key("version", KeyKind::Integer(1, 1), Integer(1), "1",
        "Version of the file format; a newer one is refused."),
    key("release_time", CLOCK, Number(0.0), "\"1 s\"",
        "Time until which the film is packed: between a base and a lid at the contact distance from \
        it or, without contact, with every node fixed at its start."),

    key("design.caps", KeyKind::Choice(&words(&CAPS)), Word("polygon"), "\"polygon\"",
        "Shape of the end caps."),
    key("design.shape", KeyKind::Choice(&words(&SHAPES)),
        Absent("stowed; erected where solver.static is true"), "\"erected\"",
        "Shape of the capsule at the start."),

    key("gas.pressure", likely(from(Dimension::Pressure, -1e9, 1e9), -1e7, 1e7), Absent("the gas decides"),
        "\"1 kPa\"", "A fixed overpressure that follows the surface, in place of a gas; the film may \
        be open."),
    key("gas.initial_mass", likely(from(Dimension::Mass, 0.0, 1e6), 0.0, 0.1),
        Absent("that of initial_pressure, else none"), "\"0.05 g\"", "Gas inside at the start."),
    key("gas.initial_pressure", likely(from(Dimension::Pressure, 0.0, 1e9), 0.0, 1e7),
        Absent("that of initial_mass"), "\"1 kPa\"",
        "Absolute pressure inside at the start, in place of initial_mass."),
    key("gas.initial_temperature", KELVIN, Absent("film.temperature"), "\"293 K\"",
        "Temperature of the gas inside at the start."),

    key("contact.enabled", KeyKind::Flag, Absent("true; false where solver.static is true"), "true",
        "Whether contact keeps film from passing through film; without it, passages are not counted."),
    key("contact.ignore_start", KeyKind::Flag, Absent("false"), "true",
        "Whether pairs of faces that touch or pass through each other at the start have no contact, and are not counted; \
         without it they are an error."),
    key("contact.adhesion_range", likely(above(Dimension::Length, 0.0, 0.1), 1e-6, 0.02),
        Absent("contact.distance"), "\"1 mm\"",
        "Range of adhesion beyond the contact distance."),

    key("solver.end_time", END_TIME, Absent("needed unless static"),
        "\"0.3 s\"", "Simulated time."),
    key("solver.static", KeyKind::Flag, Absent("false"), "true",
        "Solve static equilibrium under gas.pressure instead of motion."),
    key("solver.mass_damping", likely(from(Dimension::Frequency, 0.0, 1e9), 0.0, 1e6), Number(0.0), "\"10 1/s\"",
        "Mass damping c in m a = f - c m v."),
];
