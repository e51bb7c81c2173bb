//! Dimensions of quantities, as powers of the base units.

/// Powers of m, kg, s, K, rad, B.
pub type Powers = [i8; 6];

/// Base units, in the order of [`Powers`].
const BASE: [&str; 6] = ["m", "kg", "s", "K", "rad", "B"];

/// The dimensions a key can have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// A pure number.
    Number,
    /// Length.
    Length,
    /// Area.
    Area,
    /// Volume.
    Volume,
    /// Mass.
    Mass,
    /// Time.
    Time,
    /// Absolute temperature.
    Temperature,
    /// Plane angle.
    Angle,
    /// Pressure, stress, modulus.
    Pressure,
    /// Mass per volume.
    Density,
    /// Mass per time.
    MassFlowRate,
    /// Length per time.
    Velocity,
    /// Length per time squared.
    Acceleration,
    /// Energy.
    Energy,
    /// Per time.
    Frequency,
    /// Angle per time.
    AngularVelocity,
    /// Force.
    Force,
    /// Heat per mass and temperature.
    SpecificHeat,
    /// Heat per time, area and temperature.
    HeatTransfer,
    /// Memory of a computer.
    Memory,
}

impl Dimension {
    /// Every dimension.
    pub const ALL: [Self; 20] = [
        Self::Number,
        Self::Length,
        Self::Area,
        Self::Volume,
        Self::Mass,
        Self::Time,
        Self::Temperature,
        Self::Angle,
        Self::Pressure,
        Self::Density,
        Self::MassFlowRate,
        Self::Velocity,
        Self::Acceleration,
        Self::Energy,
        Self::Frequency,
        Self::AngularVelocity,
        Self::Force,
        Self::SpecificHeat,
        Self::HeatTransfer,
        Self::Memory,
    ];

    /// Powers of the base units.
    pub fn powers(self) -> Powers {
        match self {
            Self::Number => [0, 0, 0, 0, 0, 0],
            Self::Length => [1, 0, 0, 0, 0, 0],
            Self::Area => [2, 0, 0, 0, 0, 0],
            Self::Volume => [3, 0, 0, 0, 0, 0],
            Self::Mass => [0, 1, 0, 0, 0, 0],
            Self::Time => [0, 0, 1, 0, 0, 0],
            Self::Temperature => [0, 0, 0, 1, 0, 0],
            Self::Angle => [0, 0, 0, 0, 1, 0],
            Self::Pressure => [-1, 1, -2, 0, 0, 0],
            Self::Density => [-3, 1, 0, 0, 0, 0],
            Self::MassFlowRate => [0, 1, -1, 0, 0, 0],
            Self::Velocity => [1, 0, -1, 0, 0, 0],
            Self::Acceleration => [1, 0, -2, 0, 0, 0],
            Self::Energy => [2, 1, -2, 0, 0, 0],
            Self::Frequency => [0, 0, -1, 0, 0, 0],
            Self::AngularVelocity => [0, 0, -1, 0, 1, 0],
            Self::Force => [1, 1, -2, 0, 0, 0],
            Self::SpecificHeat => [2, 0, -2, -1, 0, 0],
            Self::HeatTransfer => [0, 1, -3, -1, 0, 0],
            Self::Memory => [0, 0, 0, 0, 0, 1],
        }
    }

    /// Name with its article, for errors.
    pub fn name(self) -> &'static str {
        match self {
            Self::Number => "a pure number",
            Self::Length => "a length",
            Self::Area => "an area",
            Self::Volume => "a volume",
            Self::Mass => "a mass",
            Self::Time => "a time",
            Self::Temperature => "a temperature",
            Self::Angle => "an angle",
            Self::Pressure => "a pressure",
            Self::Density => "a density",
            Self::MassFlowRate => "a mass flow rate",
            Self::Velocity => "a velocity",
            Self::Acceleration => "an acceleration",
            Self::Energy => "an energy",
            Self::Frequency => "a frequency",
            Self::AngularVelocity => "an angular velocity",
            Self::Force => "a force",
            Self::SpecificHeat => "a specific heat",
            Self::HeatTransfer => "a heat transfer coefficient",
            Self::Memory => "a size of memory",
        }
    }

    /// Usual units, the SI unit first; any other unit of the dimension is read as well.
    pub fn units(self) -> &'static [&'static str] {
        match self {
            Self::Number => &["%"],
            Self::Length => &["m", "cm", "mm", "um", "in"],
            Self::Area => &["m2", "cm2", "mm2"],
            Self::Volume => &["m3", "cm3", "l"],
            Self::Mass => &["kg", "g", "mg"],
            Self::Time => &["s", "ms", "us", "min", "h"],
            Self::Temperature => &["K", "degC"],
            Self::Angle => &["rad", "deg"],
            Self::Pressure => &["Pa", "kPa", "MPa", "GPa", "mbar", "bar", "atm"],
            Self::Density => &["kg/m3", "g/cm3"],
            Self::MassFlowRate => &["kg/s", "g/s", "mg/s", "kg/h"],
            Self::Velocity => &["m/s", "mm/s", "km/h"],
            Self::Acceleration => &["m/s2", "mm/s2"],
            Self::Energy => &["J", "mJ", "kJ"],
            Self::Frequency => &["Hz", "kHz", "1/s"],
            Self::AngularVelocity => &["rad/s", "deg/s"],
            Self::Force => &["N", "mN", "kN"],
            Self::SpecificHeat => &["J/(kg K)", "kJ/(kg K)"],
            Self::HeatTransfer => &["W/(m2 K)", "mW/(cm2 K)"],
            Self::Memory => &["B", "kB", "MB", "GB", "KiB", "MiB", "GiB"],
        }
    }

    /// The SI unit; "1" for a pure number.
    pub fn si(self) -> &'static str {
        if self == Self::Number { "1" } else { self.units()[0] }
    }
}

/// Powers in words: the name of the dimension, or the base units where it has no name.
pub fn describe(powers: Powers) -> String {
    if let Some(dimension) = Dimension::ALL.into_iter().find(|known| known.powers() == powers) {
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
