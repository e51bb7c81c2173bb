//! The columns of a row that do not depend on the study, in stored order. In the table the job id
//! and the parameters of the study stand before them.

/// Name, type, unit and meaning of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RowColumn {
    /// Name, as in the table.
    pub name: &'static str,
    /// Type of its cells; any cell may be null.
    pub kind: Kind,
    /// SI unit; "1" for a pure number, empty for what is none.
    pub unit: &'static str,
    /// Meaning, one line.
    pub meaning: &'static str,
    /// Whether it is compared bit for bit between runs of one job: false for what it cost and who
    /// made it.
    pub result: bool,
}

/// Type of the cells of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// True or false.
    Bool,
    /// Whole number.
    Integer,
    /// Number.
    Number,
    /// Text.
    Text,
}

/// Position of a column.
pub fn index(name: &str) -> Option<usize> {
    COLUMNS.iter().position(|column| column.name == name)
}

const fn text(name: &'static str, meaning: &'static str) -> RowColumn {
    RowColumn { name, kind: Kind::Text, unit: "", meaning, result: true }
}

const fn number(name: &'static str, unit: &'static str, meaning: &'static str) -> RowColumn {
    RowColumn { name, kind: Kind::Number, unit, meaning, result: true }
}

const fn count(name: &'static str, meaning: &'static str) -> RowColumn {
    RowColumn { name, kind: Kind::Integer, unit: "1", meaning, result: true }
}

const fn cost(name: &'static str, unit: &'static str, meaning: &'static str) -> RowColumn {
    RowColumn { name, kind: Kind::Number, unit, meaning, result: false }
}

/// Every column after the parameters, in stored order.
pub const COLUMNS: &[RowColumn] = &[
    text("status", "done, infeasible, pending, or how the job failed"),
    text("verdict", "deployed, partial or stalled; null unless done"),
    RowColumn {
        name: "close",
        kind: Kind::Bool,
        unit: "",
        meaning: "whether a threshold was met or missed by less than close_margin",
        result: true,
    },
    number("volume_ratio", "1", "mean volume of the last tenth of the run over the static volume"),
    number("height_ratio", "1", "least z_rim of the last tenth of the run over the static height"),
    number("t_50_z_rim", "s", "first time at half the static height that holds 5 ms"),
    number("t_90_z_rim", "s", "first time at nine tenths of the static height that holds 5 ms"),
    number("t_50_volume", "s", "first time at half the static volume that holds 5 ms"),
    number("t_90_volume", "s", "first time at nine tenths of the static volume that holds 5 ms"),
    number("t_deployed", "s", "first time from which both deployed thresholds hold 20 ms"),
    number("peak_vz", "m/s", "largest mean velocity of the top ring along z"),
    number("t_peak_vz", "s", "time of peak_vz"),
    number("peak_kinetic_energy", "J", "largest kinetic energy of the film"),
    number("overshoot", "1", "largest z_rim over the static height, less 1"),
    number("ringing_rms", "m/s", "root mean square of vz over 0.2 s after t_deployed"),
    number("ringing_frequency", "Hz", "largest spectral line of vz over 0.2 s after t_deployed"),
    number(
        "t_settled",
        "s",
        "first time from which the kinetic energy stays below 1e-4 of its peak for 50 ms",
    ),
    number("final_z_rim", "m", "last mean height of the top ring"),
    number("final_volume", "m3", "last volume"),
    number("final_pressure", "Pa", "last gas pressure"),
    number("final_temperature", "K", "last gas temperature"),
    number("film_stress", "Pa", "largest principal second Piola-Kirchhoff stress of the film"),
    number("peak_lid_force", "N", "largest force on the packing lid"),
    count("passages", "film through film, whole run; null for a model without film to pass"),
    count(
        "intersections",
        "intersections at the worst frame; null for a model without film to intersect",
    ),
    number(
        "interlayer_pressure",
        "Pa",
        "largest pressure of film on film at a sample; null for a model without contact",
    ),
    number(
        "contact_area_fraction",
        "1",
        "largest share of the film's area in contact at a sample; null for a model without contact",
    ),
    number(
        "smallest_gap",
        "m",
        "smallest distance of film from film at a sample; null for a model without contact",
    ),
    number("ledger_residual", "1", "largest energy ledger residual"),
    number("gas_residual", "1", "largest gas balance residual"),
    number("viscous_fraction", "1", "energy dissipated by film viscosity over the work of the gas"),
    number("reference_volume", "m3", "static volume at the final pressure"),
    number("reference_height", "m", "static z_rim at the final pressure"),
    number("deployed_volume_threshold", "1", "volume_ratio a deployed run needs"),
    number("deployed_height_threshold", "1", "height_ratio a deployed run needs"),
    number("stalled_volume_threshold", "1", "volume_ratio below which a run is stalled"),
    number("close_margin", "1", "margin under which a verdict is close"),
    number("phi", "rad", "angle KAD of the solved pattern"),
    number("half_angle", "rad", "half top angle of the solved pattern"),
    number("top_radius", "m", "radius of the top ring of the solved pattern"),
    number("height", "m", "height of the solved pattern, erected"),
    text("reason", "why the point is infeasible, or the job invalid or panicked"),
    text("nearest", "nearest feasible values (SI), each for a change of that key alone"),
    number("stop_time", "s", "simulated time at which a failed run stopped"),
    text("stop_place", "where a failed run stopped"),
    count("steps", "accepted steps"),
    count("elements", "elements of the mesh; 0 for a model without one"),
    text("content_hash", "SHA-256 of names, lengths and values of history and frames"),
    cost("wall_seconds", "s", "wall time of the job"),
    cost("ns_per_element_step", "ns", "wall time over elements and steps; null without elements"),
    RowColumn {
        result: false,
        ..text("program_version", "version of the program that ran the job")
    },
    RowColumn { result: false, ..text("commit", "commit of the program that ran the job") },
    count("physics_version", "version of the physics, part of the job id"),
];
