//! The keys of the objects of a study: strategies, inflow windows, supports, ranges, searches.

use super::key::Default::{Absent, Integer, Number, Required, Word};
use super::key::{Key, KeyKind};
use super::row::{from, key};
use super::study::{CLOCK, FLOW_RATE, GAS_MASS, INFLOW_MASS, KELVIN, TANK};
use super::words::{self, SUPPORT_PLACES, explained, words};
use crate::input::units::Dimension;

/// The keys of a strategy; paths are those within `strategies.<name>`.
#[rustfmt::skip]
pub static STRATEGY_KEYS: &[Key] = &[
    key("release_time", CLOCK, Number(0.0), "\"1 s\"",
        "Time until which the lid holds the stowed capsule."),
    key("preinflation_mass", GAS_MASS, Number(0.0), "\"0.15 g\"",
        "Gas inside from the start, at film temperature, in addition to residual gas."),
];

/// The keys of an inflow window; paths are those within `strategies.<name>.inflow[]`.
#[rustfmt::skip]
pub static WINDOW_KEYS: &[Key] = &[
    key("from", CLOCK, Absent("the release time; of a later window the end of the one before"), "\"5 s\"",
        "Start, since the start of the run."),
    key("to", CLOCK, Absent("the end time of the run"), "\"12 s\"",
        "End, since the start of the run."),
    key("mass", INFLOW_MASS, Absent("follows from the end"), "\"1 g\"",
        "Mass let in, in place of `to`: the window ends when it is inside."),
    key("mass_flow_rate", FLOW_RATE, Absent("gas.mass_flow_rate"),
        "\"1 g/s\"", "Mass flow rate."),
    key("end_mass_flow_rate", FLOW_RATE, Absent("mass_flow_rate"), "\"5 g/s\"",
        "Mass flow rate at its end: in between it changes evenly, a ramp."),
    key("temperature", KELVIN, Absent("gas.inflow_temperature"), "\"293 K\"",
        "Temperature of the gas let in."),
    TANK[0],
    TANK[1],
];

/// The keys of a support of a study; paths are those within `supports[]`.
#[rustfmt::skip]
pub static CAPSULE_SUPPORT_KEYS: &[Key] = &[
    key("on", KeyKind::Choice(&words(&SUPPORT_PLACES)), Required, "\"bottom_ring\"", "Where it acts."),
    key("fix", KeyKind::Text, Required, "\"xyz\"",
        "Displacement components it holds: letters of xyz, each once."),
];

/// How the values of an axis are spaced.
const SPACINGS: &[words::Word] =
    &[explained("linear", "evenly"), explained("log", "evenly in their logarithm")];

/// The keys of a range, beside `from`, `to` and `step`, which the varied key reads.
#[rustfmt::skip]
pub static RANGE_KEYS: &[Key] = &[
    key("steps", KeyKind::Integer(2, u32::MAX as i64), Absent("step is given"), "5",
        "Number of values, both ends counted."),
    key("spacing", KeyKind::Choice(SPACINGS), Word("linear"), "\"log\"", "How its values are spaced."),
];

/// The keys of the search of an optimum, beside `minimise` and `over`.
#[rustfmt::skip]
pub static OPTIMISE_KEYS: &[Key] = &[
    key("budget", KeyKind::Integer(4, 400), Required, "60", "Number of points in all, each with its replicates and samples."),
    key("batch", KeyKind::Integer(1, 64), Integer(4), "8",
        "Number of points that are planned together after the first: as many as keep the threads busy."),
    key("seed", KeyKind::Integer(0, u32::MAX as i64), Integer(1), "2", "Another seed tries other points."),
];

/// The keys of a search, beside `bisect`, which the varied key reads.
#[rustfmt::skip]
pub static SEARCH_KEYS: &[Key] = &[
    key("on", KeyKind::Text, Required, "\"verdict\"", "What changes: verdict, safe, or a measure with a limit."),
    key("tolerance", from(Dimension::Number, 1e-6, 1.0), Number(0.05), "\"5 %\"",
        "Width of the border, as a fraction of high - low; with logarithmic spacing of the value."),
    key("spacing", KeyKind::Choice(SPACINGS), Word("linear"), "\"log\"", "How its values are spaced."),
];
