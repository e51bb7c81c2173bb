//! Dimensions of quantities, as powers of the base units.

/// Powers of m, kg, s, K, rad, B.
pub type Powers = [i8; 6];

/// Base units, in the order of [`Powers`].
const BASE: [&str; 6] = ["m", "kg", "s", "K", "rad", "B"];

/// The dimensions a key can have.
#[expect(missing_docs, reason = "the table below names them")]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Dimension {
    Number,
    Length,
    Area,
    Volume,
    Mass,
    Time,
    Temperature,
    Angle,
    Pressure,
    Density,
    MassFlowRate,
    Velocity,
    Acceleration,
    Energy,
    Frequency,
    AngularVelocity,
    Force,
    SpecificHeat,
    HeatTransfer,
    Memory,
}

/// Dimension, name with its article, powers of the base units, usual units with the SI unit first. Any other
/// unit of the dimension is read as well.
type Row = (Dimension, &'static str, Powers, &'static [&'static str]);

/// One row for each dimension, in their order.
#[rustfmt::skip]
const ROWS: [Row; 20] = [
    (Dimension::Number, "a pure number", [0, 0, 0, 0, 0, 0], &["%"]),
    (Dimension::Length, "a length", [1, 0, 0, 0, 0, 0], &["m", "cm", "mm", "um", "in"]),
    (Dimension::Area, "an area", [2, 0, 0, 0, 0, 0], &["m2", "cm2", "mm2"]),
    (Dimension::Volume, "a volume", [3, 0, 0, 0, 0, 0], &["m3", "cm3", "l"]),
    (Dimension::Mass, "a mass", [0, 1, 0, 0, 0, 0], &["kg", "g", "mg"]),
    (Dimension::Time, "a time", [0, 0, 1, 0, 0, 0], &["s", "ms", "us", "min", "h"]),
    (Dimension::Temperature, "a temperature", [0, 0, 0, 1, 0, 0], &["K", "degC"]),
    (Dimension::Angle, "an angle", [0, 0, 0, 0, 1, 0], &["rad", "deg"]),
    (Dimension::Pressure, "a pressure", [-1, 1, -2, 0, 0, 0], &["Pa", "kPa", "MPa", "GPa", "mbar", "bar", "atm"]),
    (Dimension::Density, "a density", [-3, 1, 0, 0, 0, 0], &["kg/m3", "g/cm3"]),
    (Dimension::MassFlowRate, "a mass flow rate", [0, 1, -1, 0, 0, 0], &["kg/s", "g/s", "mg/s", "kg/h"]),
    (Dimension::Velocity, "a velocity", [1, 0, -1, 0, 0, 0], &["m/s", "mm/s", "km/h"]),
    (Dimension::Acceleration, "an acceleration", [1, 0, -2, 0, 0, 0], &["m/s2", "mm/s2"]),
    (Dimension::Energy, "an energy", [2, 1, -2, 0, 0, 0], &["J", "mJ", "kJ"]),
    (Dimension::Frequency, "a frequency", [0, 0, -1, 0, 0, 0], &["Hz", "kHz", "1/s"]),
    (Dimension::AngularVelocity, "an angular velocity", [0, 0, -1, 0, 1, 0], &["rad/s", "deg/s"]),
    (Dimension::Force, "a force", [1, 1, -2, 0, 0, 0], &["N", "mN", "kN"]),
    (Dimension::SpecificHeat, "a specific heat", [2, 0, -2, -1, 0, 0], &["J/(kg K)", "kJ/(kg K)"]),
    (Dimension::HeatTransfer, "a heat transfer coefficient", [0, 1, -3, -1, 0, 0], &["W/(m2 K)", "mW/(cm2 K)"]),
    (Dimension::Memory, "a size of memory", [0, 0, 0, 0, 0, 1], &["B", "kB", "MB", "GB", "KiB", "MiB", "GiB"]),
];

impl Dimension {
    /// Every dimension.
    pub fn all() -> impl Iterator<Item = Self> {
        ROWS.iter().map(|row| row.0)
    }

    /// Powers of the base units.
    pub fn powers(self) -> Powers {
        ROWS[self as usize].2
    }

    /// Name with its article, for errors.
    pub fn name(self) -> &'static str {
        ROWS[self as usize].1
    }

    /// Usual units, the SI unit first.
    pub fn units(self) -> &'static [&'static str] {
        ROWS[self as usize].3
    }

    /// The SI unit; "1" for a pure number.
    pub fn si(self) -> &'static str {
        if self == Self::Number { "1" } else { self.units()[0] }
    }
}

/// Powers in words: the name of the dimension, or the base units where it has no name.
pub fn describe(powers: Powers) -> String {
    if let Some(dimension) = Dimension::all().find(|known| known.powers() == powers) {
        return dimension.name().to_owned();
    }
    let power = |name: &str, power: i8| match power {
        1 => name.to_owned(),
        _ => format!("{name}^{power}"),
    };
    let parts: Vec<String> =
        BASE.iter().zip(powers).filter(|(_, p)| *p != 0).map(|(name, p)| power(name, p)).collect();
    format!("a quantity in {}", parts.join(" "))
}
